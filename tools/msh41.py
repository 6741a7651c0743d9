"""Writes meshes of linear elements as Gmsh MSH 4.1 text.

What it is: the one writer shared by the scripts that produce the meshes kept in this repository.
What it is not: a mesh library. It writes one volume and any number of named surfaces made of its faces, which is all
that those scripts need; nodes and elements keep the order in which they are given, so that files can be compared
node by node with what they were made from.

The corner orders of Gmsh, VTK and Abaqus agree for tet4, hex8, prism6 and pyramid5, and so do those of tri3 and quad4.

Layout of the file: https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format
"""

GMSH_TYPE = {"tri3": 2, "quad4": 3, "tet4": 4, "hex8": 5, "prism6": 6, "pyramid5": 7}
NODE_COUNT = {"tri3": 3, "quad4": 4, "tet4": 4, "hex8": 8, "prism6": 6, "pyramid5": 5}

# Faces with corners turning counter-clockwise seen from outside.
FACES = {
    "tet4": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)],
    "hex8": [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
    "prism6": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    "pyramid5": [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
}


def boundary_faces(blocks):
    """Faces that belong to one element only, in element order.

    blocks: list of (element name, list of node tuples). Raises ValueError when three elements share a face.
    """
    seen = {}
    for name, elements in blocks:
        for nodes in elements:
            for face in FACES[name]:
                corners = tuple(nodes[i] for i in face)
                seen.setdefault(frozenset(corners), []).append(corners)
    crowded = [faces for faces in seen.values() if len(faces) > 2]
    if crowded:
        raise ValueError(f"{len(crowded)} faces are shared by more than two elements, the first one is {crowded[0][0]}")
    return [faces[0] for faces in seen.values() if len(faces) == 1]


def write(path, points, blocks, volume_name, surfaces, coordinate=repr):
    """Writes one volume and its named surfaces.

    points: list of (x, y, z) in metres, node tag = position + 1.
    blocks: list of (element name, list of node tuples, counted from 0).
    surfaces: list of (physical group names, list of faces as node tuples counted from 0). The lists may not overlap:
        a face that belongs to two groups stands in a list that bears both names.
    coordinate: how a number is printed; the default loses nothing.
    """
    names = []
    for group in surfaces:
        names += [name for name in group[0] if name not in names]
    tag_of = {name: tag for tag, name in enumerate(names, start=1)}

    with open(path, "w", encoding="ascii", newline="\n") as out:
        out.write("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")

        out.write(f"$PhysicalNames\n{len(names) + 1}\n")
        for name in names:
            out.write(f'2 {tag_of[name]} "{name}"\n')
        out.write(f'3 1 "{volume_name}"\n$EndPhysicalNames\n')

        box = " ".join(coordinate(f(p[axis] for p in points)) for f in (min, max) for axis in range(3))
        out.write(f"$Entities\n0 0 {len(surfaces)} 1\n")
        for entity, (groups, faces) in enumerate(surfaces, start=1):
            corners = [points[n] for face in faces for n in face]
            own = " ".join(coordinate(f(p[axis] for p in corners)) for f in (min, max) for axis in range(3))
            tags = " ".join(str(tag_of[name]) for name in groups)
            out.write(f"{entity} {own} {len(groups)} {tags} 0\n")
        bounding = " ".join(str(entity) for entity in range(1, len(surfaces) + 1))
        out.write(f"1 {box} 1 1 {len(surfaces)} {bounding}".rstrip() + "\n$EndEntities\n")

        count = len(points)
        out.write(f"$Nodes\n1 {count} 1 {count}\n3 1 0 {count}\n")
        out.writelines(f"{tag}\n" for tag in range(1, count + 1))
        out.writelines(" ".join(coordinate(x) for x in p) + "\n" for p in points)
        out.write("$EndNodes\n")

        # The volume comes first, so that its element tags count from 1 in the order given.
        parts = [(3, 1, name, elements) for name, elements in blocks if elements]
        for entity, (_, faces) in enumerate(surfaces, start=1):
            for name in ("tri3", "quad4"):
                chosen = [face for face in faces if len(face) == NODE_COUNT[name]]
                if chosen:
                    parts.append((2, entity, name, chosen))
        total = sum(len(elements) for *_, elements in parts)
        out.write(f"$Elements\n{len(parts)} {total} 1 {total}\n")
        tag = 0
        for dimension, entity, name, elements in parts:
            out.write(f"{dimension} {entity} {GMSH_TYPE[name]} {len(elements)}\n")
            for nodes in elements:
                tag += 1
                out.write(f"{tag} " + " ".join(str(n + 1) for n in nodes) + "\n")
        out.write("$EndElements\n")
