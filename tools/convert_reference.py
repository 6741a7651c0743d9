#!/usr/bin/env python3
"""Turns the CalculiX cantilevers into the meshes and reference tables that the validation scenes compare with.

    python3 tools/convert_reference.py DECKS SCENES

DECKS holds, for each mesh, `C3D8_48x8x8.mesh` (Abaqus text) and the printed displacements
`C3D8_48x8x8_{lin,stvk}_nu0.dat.gz` of a CalculiX 2.20 run. Into SCENES (usually scenes/validation) go

    meshes/cantilever_{hex8,tet4,prism6}.msh             MSH 4.1, physical groups "bar", "clamp" (x = 0), "tip" (x = 8)
    reference/cantilever_{...}_{hooke,stvk}.csv          node, ux, uy, uz

Node and element order are the deck's, so displacements compare node by node. The decks print twelve digits; the
meshes are regular, so the multiples of the cell size are put back exactly. The script stops when a coordinate is
further than 1e-6 m from such a multiple, when the clamped nodes are not the nodes at x = 0, when an element has a
negative volume, or when a displacement is missing.
"""

import gzip
import sys
from pathlib import Path

import msh41

SIZE = (8.0, 1.0, 1.0)  # m
CASES = [
    # Souple's name, deck, cells along each axis, Abaqus name, integration that reproduces it
    ("hex8", "C3D8_48x8x8", (48, 8, 8), "C3D8", "2 x 2 x 2 Gauss points"),
    ("tet4", "C3D4_32x4x4", (32, 4, 4), "C3D4", "1 point"),
    ("prism6", "C3D6_24x8x8", (24, 8, 8), "C3D6", "2 points: 1 in the triangle x 2 along the axis (reduced)"),
]
LAWS = [
    # id, suffix of the run, what the solver was told, energy density
    ("hooke", "lin", "*ELASTIC", "small strain"),
    ("stvk", "stvk", "*ELASTIC with NLGEOM", "St.Venant-Kirchhoff, total Lagrangian"),
]


def read_deck(path):
    """Nodes, elements and the set NFIX of an Abaqus deck: [(x, y, z)], [(node tags)], set of tags."""
    points, elements, fixed, section = {}, [], set(), None
    for number, line in enumerate(path.read_text().splitlines(), start=1):
        if line.startswith("*"):
            section = line.split(",")[0].strip().upper()
            continue
        fields = [field for field in (f.strip() for f in line.split(",")) if field]
        if section == "*NODE":
            points[int(fields[0])] = tuple(float(x) for x in fields[1:4])
        elif section == "*ELEMENT":
            elements.append(tuple(int(n) for n in fields[1:]))
        elif section == "*NSET":
            fixed.update(int(n) for n in fields)
        else:
            sys.exit(f"{path}:{number}: a line of the unexpected section {section}")
    if sorted(points) != list(range(1, len(points) + 1)):
        sys.exit(f"{path}: node tags are not 1..{len(points)}")
    return [points[tag] for tag in range(1, len(points) + 1)], elements, fixed


def exact(value, size, cells, where):
    """The multiple of size/cells that `value` was printed from."""
    multiple = size * round(value * cells / size) / cells
    if abs(multiple - value) > 1e-6:
        sys.exit(f"{where}: {value} is no multiple of {size}/{cells}")
    return multiple


def corner_volume(points, nodes, name):
    """Six times the volume of the tetrahedron at corner 0: positive when the element is not turned inside out."""
    a, b, c = {"tet4": (1, 2, 3), "prism6": (1, 2, 3), "hex8": (1, 3, 4)}[name]
    o, p, q, r = (points[nodes[i]] for i in (0, a, b, c))
    u, v, w = ([e - f for e, f in zip(end, o)] for end in (p, q, r))
    return (
        u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])
    )


def read_displacements(path, count):
    """The last printed set of displacements, as text: [(ux, uy, uz)]."""
    rows, reading = {}, False
    for line in gzip.open(path, "rt"):
        fields = line.split()
        if "displacements" in line:
            rows, reading = {}, True
        elif "forces" in line:
            reading = False
        elif reading and len(fields) == 4:
            rows[int(fields[0])] = tuple(fields[1:])
    if sorted(rows) != list(range(1, count + 1)):
        sys.exit(f"{path}: displacements of {len(rows)} nodes, the mesh has {count}")
    return [rows[tag] for tag in range(1, count + 1)]


def short(text):
    """-3.142170E-03 as -3.142170e-3: the same digits, fewer characters."""
    mantissa, exponent = text.split("E")
    return "0" if float(text) == 0.0 else f"{mantissa}e{int(exponent)}"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    decks, scenes = Path(sys.argv[1]), Path(sys.argv[2])
    (scenes / "meshes").mkdir(parents=True, exist_ok=True)
    (scenes / "reference").mkdir(parents=True, exist_ok=True)

    for name, deck, cells, abaqus, integration in CASES:
        source = decks / f"{deck}.mesh"
        printed, tags, fixed = read_deck(source)
        points = [
            tuple(exact(p[axis], SIZE[axis], cells[axis], f"{source}: node {tag}") for axis in range(3))
            for tag, p in enumerate(printed, start=1)
        ]
        elements = [tuple(tag - 1 for tag in nodes) for nodes in tags]
        if fixed != {tag for tag, p in enumerate(points, start=1) if p[0] == 0.0}:
            sys.exit(f"{source}: NFIX is not the set of nodes at x = 0")
        inverted = [i for i, nodes in enumerate(elements) if corner_volume(points, nodes, name) <= 0.0]
        if inverted:
            sys.exit(f"{source}: {len(inverted)} elements have a negative volume, the first one is {inverted[0] + 1}")

        outside = msh41.boundary_faces([(name, elements)])
        ends = [
            ([group], [face for face in outside if all(points[n][0] == x for n in face)])
            for group, x in (("clamp", 0.0), ("tip", SIZE[0]))
        ]
        target = scenes / "meshes" / f"cantilever_{name}.msh"
        msh41.write(target, points, [(name, elements)], "bar", ends)
        print(f"{target}: {len(points)} nodes, {len(elements)} {name}, clamp {len(ends[0][1])}, tip {len(ends[1][1])} faces")

        for law, run, told, energy in LAWS:
            rows = read_displacements(decks / f"{deck}_{run}_nu0.dat.gz", len(points))
            target = scenes / "reference" / f"cantilever_{name}_{law}.csv"
            with open(target, "w", encoding="ascii", newline="\n") as out:
                out.write(
                    f"# Nodal displacements in metres, seven digits as printed by the solver.\n"
                    f"# solver: CalculiX CrunchiX 2.20 (ccx), static, element {abaqus}, {integration}\n"
                    f"# law: {law} ({told}: {energy}), young 1e8 Pa, poisson 0\n"
                    f"# mesh: meshes/cantilever_{name}.msh (8 x 1 x 1 m, {' x '.join(map(str, cells))} cells,"
                    f" {len(elements)} elements); node = its tag there\n"
                    f"# load: clamped at x = 0 in all axes; gravity 9.81 m/s2 along -y on 1000 kg/m3, dead load\n"
                    f"node,ux,uy,uz\n"
                )
                out.writelines(f"{tag},{','.join(short(u) for u in row)}\n" for tag, row in enumerate(rows, start=1))
            print(f"{target}: {len(rows)} nodes")


if __name__ == "__main__":
    main()
