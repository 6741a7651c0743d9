#!/usr/bin/env python3
"""Makes organ.msh: a liver-like solid of hexahedra inside, pyramids around them and tetrahedra under the surface.

    pip install gmsh==4.15.2 numpy
    python3 scenes/organ/make_organ.py [organ.msh]

The shape is the image of the unit ball under `organ_from_ball`: no medical image and no other project's geometry is
behind it. x runs from the right lobe to the tip of the left one, y up, z to the front; lengths in metres.

Stages:

    1. surface   the unit sphere, mapped, is meshed by Gmsh with triangles of one size
    2. core      a box of cells, rounded and mapped into the inside of the organ: hexahedra
    3. shell     one pyramid stands on each outer face of the core, its apex pointing outwards
    4. filling   Gmsh fills between the pyramids' triangles and the surface with tetrahedra and improves them
    5. check     conformity and Jacobians of what is about to be written; nothing is written when one of them fails
    6. regions   "organ" (all), "surface", "clamp" (where the vena cava leaves), "tip" (free edge of the left lobe)

Why not let Gmsh make the whole mesh? It recombines no volume of this shape into hexahedra, and it puts no pyramids on
a hexahedral core with curved faces.

The result is the same for the same version of Gmsh: one thread, a fixed seed, nothing random here.
"""

import sys
from pathlib import Path

import gmsh
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import msh41  # noqa: E402

EDGE = 0.016  # m, edge length of the triangles of the surface
CELLS = (12, 7, 4)  # of the core along x, z, y
# The box of the core in the coordinates of the ball, [axis][low, high] along x, z, y.
CORE = ((-0.70, 0.54), (-0.64, 0.48), (-0.53, 0.53))
ROUNDING = 0.4  # 0: the core is a box, 1: a ball
APEX = 0.5  # height of the pyramids over the square root of their base's area


def organ_from_ball(ball):
    """Positions in the organ of points of the unit ball, [point, axis].

    With (u, v, w) in the ball, lengths in metres:

        x = 0.14 u
        y = 0.041 v t(u) (1 − 0.38 w) + dome(u, w)      thick at the right and at the back, thin at the front edge
        z = 0.091 w s(u) − notch(u, w)                  the left lobe is narrower; a notch parts the lobes at the front
    """
    u, v, w = ball.T
    # 0 at the right end, 1 at the left end, flat at both.
    left = 0.5 + 0.75 * np.clip(u, -1, 1) - 0.25 * np.clip(u, -1, 1) ** 3
    thickness = 0.041 * (1.06 - 0.50 * left) * (1 - 0.38 * w)
    width = 0.091 * (1.02 - 0.36 * left)
    dome = 0.012 - 0.022 * u**2 - 0.014 * w**2 - 0.012 * w
    notch = 0.020 * np.exp(-(((u - 0.30) / 0.16) ** 2)) * np.clip(w, 0, 1) ** 2
    return np.stack([0.14 * u, v * thickness + dome, w * width - notch], axis=1)


def ball_from_box(box):
    """Rounds the box [−1, 1]³ towards the ball inside it, by the share ROUNDING."""
    a, b, c = box.T
    round_ = np.stack(
        [
            a * np.sqrt(1 - b**2 / 2 - c**2 / 2 + b**2 * c**2 / 3),
            b * np.sqrt(1 - c**2 / 2 - a**2 / 2 + c**2 * a**2 / 3),
            c * np.sqrt(1 - a**2 / 2 - b**2 / 2 + a**2 * b**2 / 3),
        ],
        axis=1,
    )
    return (1 - ROUNDING) * box + ROUNDING * round_


def surface():
    """Stage 1: nodes [node, axis] and triangles [triangle, corner] of the surface, turning outwards."""
    gmsh.model.add("surface")
    # A fine triangulation of the sphere, mapped, is what Gmsh then parametrises and meshes anew.
    gmsh.model.occ.addSphere(0, 0, 0, 1)
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.06)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.06)
    gmsh.model.mesh.generate(2)
    points, triangles = nodes_and_elements(2, 2)

    gmsh.model.add("remeshed")
    discrete(points, triangles, map_points=organ_from_ball)
    gmsh.model.mesh.classifySurfaces(np.pi, True, True, np.pi)
    gmsh.model.mesh.createGeometry()
    gmsh.option.setNumber("Mesh.MeshSizeMax", EDGE)
    gmsh.option.setNumber("Mesh.MeshSizeMin", EDGE)
    gmsh.option.setNumber("Mesh.Algorithm", 6)
    gmsh.model.mesh.generate(2)
    points, triangles = nodes_and_elements(2, 2)
    if signed_volume(points, triangles) < 0:
        triangles = triangles[:, ::-1]
    return points, triangles


def core():
    """Stage 2: nodes and hexahedra of the core, in VTK's corner order."""
    nx, nz, ny = CELLS
    i, k, j = np.meshgrid(np.arange(nx + 1), np.arange(nz + 1), np.arange(ny + 1), indexing="ij")
    box = np.stack([2 * i / nx - 1, 2 * k / nz - 1, 2 * j / ny - 1], axis=-1).reshape(-1, 3)
    low, high = np.array(CORE).T
    along_xzy = low + (ball_from_box(box) + 1) / 2 * (high - low)
    points = organ_from_ball(along_xzy[:, [0, 2, 1]])

    number = np.arange(len(points)).reshape(nx + 1, nz + 1, ny + 1)
    at = lambda di, dk, dj: number[di : di + nx, dk : dk + nz, dj : dj + ny].ravel()  # noqa: E731
    # x, then y, then z is right-handed: the bottom face of the VTK order lies at the smaller z.
    corners = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1), (0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1)]
    return points, np.stack([at(*c) for c in corners], axis=1)


def pyramids(points, hexahedra):
    """Stage 3: apexes, and pyramids on the outer faces of the core."""
    faces = np.array(msh41.boundary_faces([("hex8", hexahedra.tolist())]))
    a, b, c, d = points[faces].transpose(1, 0, 2)
    normal = np.cross(c - a, d - b) / 2  # length: area of the face
    apexes = (a + b + c + d) / 4 + APEX * normal / np.sqrt(np.linalg.norm(normal, axis=1, keepdims=True))
    numbers = len(points) + np.arange(len(faces))
    # The face turns outwards as seen from the hexahedron, and so do the base's corners as seen from the apex.
    return apexes, np.column_stack([faces, numbers])


def filling(outer, outer_triangles, inner, inner_triangles):
    """Stage 4: nodes and tetrahedra between two closed surfaces; the nodes start with `outer`, then `inner`."""
    gmsh.model.add("filling")
    discrete(outer, outer_triangles, entity=1)
    discrete(inner, inner_triangles, entity=2, first_node=len(outer) + 1)
    outside, inside = gmsh.model.geo.addSurfaceLoop([1]), gmsh.model.geo.addSurfaceLoop([2])
    gmsh.model.geo.addVolume([outside, inside])
    gmsh.model.geo.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", 1.35 * EDGE)
    gmsh.option.setNumber("Mesh.MeshSizeMin", EDGE)
    gmsh.option.setNumber("Mesh.Algorithm3D", 1)
    gmsh.model.mesh.generate(3)
    for method in ("", "Relocate3D", ""):
        gmsh.model.mesh.optimize(method, niter=5)
    points, tetrahedra = nodes_and_elements(3, 4)
    given = np.vstack([outer, inner])
    if not np.array_equal(points[: len(given)], given):
        sys.exit("Gmsh moved or renumbered nodes of the surfaces that it was given")
    return points, tetrahedra


def discrete(points, triangles, entity=None, first_node=1, map_points=lambda p: p):
    """A surface of the current Gmsh model that is nothing but these triangles."""
    surface_tag = gmsh.model.addDiscreteEntity(2, -1 if entity is None else entity)
    tags = np.arange(first_node, first_node + len(points))
    gmsh.model.mesh.addNodes(2, surface_tag, tags, map_points(points).ravel())
    gmsh.model.mesh.addElementsByType(surface_tag, 2, [], (triangles + first_node).ravel())


def nodes_and_elements(dimension, gmsh_type):
    """What the current model holds, with nodes numbered from 0 in the order of their tags."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    tags, points = tags[order], coordinates.reshape(-1, 3)[order]
    _, corners = gmsh.model.mesh.getElementsByType(gmsh_type)
    used = np.unique(corners)
    points, tags = points[np.isin(tags, used)], tags[np.isin(tags, used)]
    return points, np.searchsorted(tags, corners).reshape(-1, dimension + 1)


def signed_volume(points, triangles):
    """Volume inside a closed surface; negative when its triangles turn inwards."""
    a, b, c = points[triangles].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


# For each element: corner, and its three neighbours along the edges, right-handed.
CORNERS = {
    "tet4": [(0, 1, 2, 3), (1, 0, 3, 2), (2, 0, 1, 3), (3, 0, 2, 1)],
    "pyramid5": [(0, 1, 3, 4), (1, 2, 0, 4), (2, 3, 1, 4), (3, 0, 2, 4)],
    "hex8": [(0, 1, 3, 4), (1, 2, 0, 5), (2, 3, 1, 6), (3, 0, 2, 7), (4, 7, 5, 0), (5, 4, 6, 1), (6, 5, 7, 2), (7, 6, 4, 3)],
}


def scaled_jacobians(points, name, elements):
    """Smallest corner Jacobian over the product of its three edge lengths, per element; a cube has 1."""
    scaled = []
    for o, a, b, c in CORNERS[name]:
        u, v, w = (points[elements[:, i]] - points[elements[:, o]] for i in (a, b, c))
        lengths = np.prod([np.linalg.norm(e, axis=1) for e in (u, v, w)], axis=0)
        scaled.append(np.einsum("ij,ij->i", np.cross(u, v), w) / lengths)
    return np.min(scaled, axis=0)


def check(points, blocks):
    """Stage 5: stops when an element is inverted, or a face is not shared as it should be."""
    for name, elements in blocks:
        quality = scaled_jacobians(points, name, elements)
        tail = ", ".join(f"{p} %: {np.percentile(quality, p):.3f}" for p in (1, 10, 50))
        print(f"{name:9} {len(elements):5}  smallest scaled corner Jacobian {quality.min():.3f} ({tail})")
        if quality.min() <= 0:
            sys.exit(f"{name} {int(quality.argmin())} is inverted")
    outside = msh41.boundary_faces([(name, elements.tolist()) for name, elements in blocks])
    if any(len(face) != 3 for face in outside):
        sys.exit("a quadrangle lies on the boundary: the core is not closed by pyramids")
    # A face that does not meet its neighbour would appear here as boundary, so the boundary must be closed and bear
    # the volume of the elements, and its Euler characteristic must be that of a sphere.
    edges = {frozenset(pair) for f in outside for pair in ((f[0], f[1]), (f[1], f[2]), (f[2], f[0]))}
    corners = {n for f in outside for n in f}
    if len(corners) - len(edges) + len(outside) != 2:
        sys.exit("the boundary is no sphere: some interior faces are not shared")
    return outside


def regions(points, outside):
    """Stage 6: the boundary's faces by the groups that they belong to."""
    centres = np.array([points[list(face)].mean(axis=0) for face in outside])
    # Upper back, somewhat right of the middle.
    clamp = np.linalg.norm(centres - organ_from_ball(np.array([[-0.10, 0.55, -0.83]])), axis=1) < 0.036
    # The front edge of the left lobe.
    tip = np.linalg.norm(centres - organ_from_ball(np.array([[0.90, 0.0, 0.43]])), axis=1) < 0.026
    parts = [(["surface"], ~clamp & ~tip), (["surface", "clamp"], clamp), (["surface", "tip"], tip)]
    return [(names, [outside[i] for i in np.flatnonzero(chosen)]) for names, chosen in parts]


def main():
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("organ.msh")
    gmsh.initialize([])
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.option.setNumber("Mesh.RandomSeed", 1)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)

    skin, skin_triangles = surface()
    grid, hexahedra = core()
    apexes, pyramid_nodes = pyramids(grid, hexahedra)
    inside = np.vstack([grid, apexes])
    inner = np.array([[p[a], p[b], p[4]] for p in pyramid_nodes for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))])
    # Only the core's outer nodes belong to the filling's inner surface.
    on_shell, inner_triangles = np.unique(inner, return_inverse=True)
    points, tetrahedra = filling(skin, skin_triangles, inside[on_shell], inner_triangles.reshape(-1, 3))
    gmsh.finalize()

    # One numbering: the core's nodes, then all others of the filling.
    global_of = np.full(len(points), -1)
    global_of[len(skin) : len(skin) + len(on_shell)] = on_shell
    new = np.flatnonzero(global_of < 0)
    global_of[new] = len(inside) + np.arange(len(new))
    points = np.vstack([inside, points[new]])
    blocks = [("hex8", hexahedra), ("pyramid5", pyramid_nodes), ("tet4", global_of[tetrahedra])]
    points, blocks = along_x(points, blocks)
    points = np.round(points, 9)  # a nanometre

    outside = check(points, blocks)
    named = regions(points, outside)
    volume = signed_volume(points, np.array(outside))
    size = points.max(axis=0) - points.min(axis=0)
    total = sum(len(elements) for _, elements in blocks)
    print(f"{total} elements, {len(points)} nodes, volume {1e3 * volume:.4f} l, size {size.round(4).tolist()} m")
    print(", ".join(f"{'+'.join(names)}: {len(faces)} faces" for names, faces in named))
    lists = [(name, elements.tolist()) for name, elements in blocks]
    msh41.write(target, points.tolist(), lists, "organ", named, coordinate=lambda x: f"{x + 0.0:.9f}")
    print(f"written to {target}")


def along_x(points, blocks):
    """Numbers nodes and elements along x, so that neighbours lie near each other in memory."""
    order = np.lexsort((points[:, 2], points[:, 1], points[:, 0]))
    rank = np.empty(len(points), dtype=int)
    rank[order] = np.arange(len(points))
    sorted_blocks = []
    for name, elements in blocks:
        elements = rank[elements]
        sorted_blocks.append((name, elements[np.argsort(elements.min(axis=1), kind="stable")]))
    return points[order], sorted_blocks


if __name__ == "__main__":
    main()
