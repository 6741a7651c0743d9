#!/usr/bin/env python3
"""Writes block.msh beside this script: a block of hexahedra with a skin on top and a tendon that leaves one end.

    python3 scenes/skin_and_tendon/make_block.py

The block is 80 x 20 x 20 mm in 16 x 4 x 4 cells. The skin are the quadrangles on y = 20 mm, on nodes of the block. The
tendon are edges along the axis of the block, from x = 40 mm (on nodes of the block) to x = 120 mm (on its own).
Physical groups: "block", "skin", "tendon", "clamp" (the quadrangles on x = 0).

MSH 2.2 text, in millimetres: https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format-version-2-_0028Legacy_0029
"""

from pathlib import Path

CELLS = (16, 4, 4)
EDGE = 5
BEYOND = 8  # edges of the tendon outside the block


def node(i, j, k):
    """Number of a grid point, from 1."""
    return 1 + i + (CELLS[0] + 1) * (j + (CELLS[1] + 1) * k)


def main():
    nx, ny, nz = CELLS
    points = [(EDGE * i, EDGE * j, EDGE * k) for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)]
    bottom = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    elements = []  # (gmsh type, group, nodes)
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                corners = [node(i + a, j + b, k + c + top) for top in (0, 1) for a, b, c in bottom]
                elements.append((5, 1, corners))
    for k in range(nz):
        for i in range(nx):
            elements.append((3, 2, [node(i, ny, k), node(i, ny, k + 1), node(i + 1, ny, k + 1), node(i + 1, ny, k)]))
    line = [node(i, ny // 2, nz // 2) for i in range(nx // 2, nx + 1)]
    for step in range(1, BEYOND + 1):
        points.append((EDGE * (nx + step), EDGE * ny // 2, EDGE * nz // 2))
        line.append(len(points))
    elements += [(1, 3, list(pair)) for pair in zip(line, line[1:])]
    for k in range(nz):
        for j in range(ny):
            elements.append((3, 4, [node(0, j, k), node(0, j, k + 1), node(0, j + 1, k + 1), node(0, j + 1, k)]))
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "4"]
    text += ['3 1 "block"', '2 2 "skin"', '1 3 "tendon"', '2 4 "clamp"', "$EndPhysicalNames"]
    text += ["$Nodes", str(len(points))] + [f"{n} {x} {y} {z}" for n, (x, y, z) in enumerate(points, 1)] + ["$EndNodes"]
    text += ["$Elements", str(len(elements))]
    for number, (kind, group, nodes) in enumerate(elements, 1):
        text.append(f"{number} {kind} 2 {group} {group} {' '.join(map(str, nodes))}")
    text.append("$EndElements")
    Path(__file__).with_name("block.msh").write_text("\n".join(text) + "\n")


if __name__ == "__main__":
    main()
