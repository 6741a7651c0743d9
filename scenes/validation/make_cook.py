#!/usr/bin/env python3
"""Writes the meshes of Cook's membrane, meshes/cook_{tri3,tri6,quad4,quad8}.msh beside this script.

    python3 scenes/validation/make_cook.py

The membrane has the corners (0, 0), (48, 44), (48, 60), (0, 44) in metres and 8 x 8 cells, equal along each side.
Triangles are cut along the diagonal from the lower left to the upper right corner of each cell. Corner nodes come
first, x running fastest, then the nodes amid edges; these lie halfway between the two corners. Physical groups:
"membrane" (elements), "clamp" (edges at x = 0), "load" (edges at x = 48 m).

MSH 4.1 text: https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format
"""

from pathlib import Path

CELLS = 8
CORNERS = ((0.0, 0.0), (48.0, 44.0), (48.0, 60.0), (0.0, 44.0))
GMSH_TYPE = {"tri3": 2, "quad4": 3, "tri6": 9, "quad8": 16}
GMSH_EDGE = {1: 1, 2: 8}  # by degree


def point(i, j):
    """The grid point (i, j), from 0 to CELLS in each direction: bilinear in the corners."""
    s, t = i / CELLS, j / CELLS
    weights = ((1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t)
    return tuple(sum(w * c[axis] for w, c in zip(weights, CORNERS)) for axis in (0, 1))


def membrane(element):
    """Points, elements, and the edges of both groups; nodes are counted from 0."""
    points = [point(i, j) for j in range(CELLS + 1) for i in range(CELLS + 1)]
    degree = 2 if element in ("tri6", "quad8") else 1
    amid = {}

    def with_edges(corners, closed=True):
        """The corners, and the nodes amid their edges when the element is quadratic."""
        nodes = list(corners)
        if degree == 2:
            following = corners[1:] + corners[:1] if closed else corners[1:]
            for a, b in zip(corners, following):
                edge = (min(a, b), max(a, b))
                if edge not in amid:
                    amid[edge] = len(points)
                    points.append(tuple((points[a][axis] + points[b][axis]) / 2 for axis in (0, 1)))
                nodes.append(amid[edge])
        return nodes

    def corner(i, j):
        return i + (CELLS + 1) * j

    elements = []
    for j in range(CELLS):
        for i in range(CELLS):
            a, b, c, d = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
            shapes = ((a, b, c), (a, c, d)) if element.startswith("tri") else ((a, b, c, d),)
            elements += [with_edges(shape) for shape in shapes]
    clamp = [with_edges((corner(0, j), corner(0, j + 1)), closed=False) for j in range(CELLS)]
    load = [with_edges((corner(CELLS, j), corner(CELLS, j + 1)), closed=False) for j in range(CELLS)]
    return points, elements, clamp, load, degree


def block(dimension, tag, kind, start, elements):
    """A block of $Elements: its head, then one line per element."""
    lines = [f"{dimension} {tag} {kind} {len(elements)}"]
    for number, nodes in enumerate(elements, start=start):
        lines.append(f"{number} " + " ".join(str(node + 1) for node in nodes))
    return lines


def write(path, element):
    points, elements, clamp, load, degree = membrane(element)
    edge = GMSH_EDGE[degree]
    total = len(elements) + len(clamp) + len(load)
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", "3"]
    lines += ['1 1 "clamp"', '1 2 "load"', '2 3 "membrane"', "$EndPhysicalNames"]
    lines += ["$Entities", "0 2 1 0", "1 0.0 0.0 0.0 0.0 44.0 0.0 1 1 0", "2 48.0 44.0 0.0 48.0 60.0 0.0 1 2 0"]
    lines += ["1 0.0 0.0 0.0 48.0 60.0 0.0 1 3 2 1 2", "$EndEntities"]
    lines += ["$Nodes", f"1 {len(points)} 1 {len(points)}", f"2 1 0 {len(points)}"]
    lines += [str(tag) for tag in range(1, len(points) + 1)]
    lines += [f"{x!r} {y!r} 0.0" for x, y in points]
    lines += ["$EndNodes", "$Elements", f"3 {total} 1 {total}"]
    lines += block(1, 1, edge, 1, clamp)
    lines += block(1, 2, edge, 1 + len(clamp), load)
    lines += block(2, 1, GMSH_TYPE[element], 1 + len(clamp) + len(load), elements)
    lines += ["$EndElements", ""]
    path.write_text("\n".join(lines), encoding="ascii")


if __name__ == "__main__":
    folder = Path(__file__).resolve().parent / "meshes"
    for name in GMSH_TYPE:
        write(folder / f"cook_{name}.msh", name)
