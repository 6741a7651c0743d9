#!/usr/bin/env python3
"""Draws docs/pictures/organ_mesh.png: the organ from outside with its regions, and cut open, coloured by element.

    pip install pyvista meshio
    python3 scenes/organ/draw_organ.py

Yellow hexahedra, green pyramids, red tetrahedra; blue is the region "clamp", pale yellow the region "tip".
"""

from pathlib import Path

import meshio
import numpy as np
import pyvista as pv

HERE = Path(__file__).resolve().parent
COLOUR = {"hexahedron": "#e0ab45", "pyramid": "#4f9d69", "tetra": "#c0605a"}
VTK_TYPE = {"hexahedron": 12, "pyramid": 14, "tetra": 10}
REGION = {"clamp": "#3b6fb5", "tip": "#efe08a"}


def show(plotter, mesh, colour):
    plotter.add_mesh(mesh.extract_surface(algorithm="dataset_surface"), color=colour, show_edges=True, edge_color="#3a2a2a")


def look(plotter, eye, centre, zoom):
    plotter.camera_position = [eye, centre, (0, 1, 0)]
    plotter.camera.zoom(zoom)


def main():
    mesh = meshio.read(HERE / "organ.msh")
    solids = pv.from_meshio(meshio.Mesh(mesh.points, [(c.type, c.data) for c in mesh.cells if c.type in COLOUR]))
    faces = {
        name: np.vstack([c.data for c, own in zip(mesh.cells, mesh.cell_sets[name]) if len(own)])
        for name in ("surface", *REGION)
    }
    plain = set(map(tuple, faces["surface"])) - {tuple(f) for name in REGION for f in faces[name]}
    faces["surface"] = np.array(sorted(plain))

    plotter = pv.Plotter(off_screen=True, window_size=(1600, 560), shape=(1, 2), border=False)
    plotter.subplot(0, 0)
    for name, triangles in faces.items():
        cells = np.column_stack([np.full(len(triangles), 3), triangles]).ravel()
        show(plotter, pv.PolyData(mesh.points, cells).cast_to_unstructured_grid(), REGION.get(name, COLOUR["tetra"]))
    look(plotter, (-0.02, 0.42, -0.30), (0, 0.01, 0), 1.3)

    plotter.subplot(0, 1)
    behind = solids.cell_centers().points[:, 2] < 0.0
    for kind, colour in COLOUR.items():
        show(plotter, solids.extract_cells(np.flatnonzero(behind & (solids.celltypes == VTK_TYPE[kind]))), colour)
    look(plotter, (0.05, 0.22, 0.44), (0, 0.01, -0.02), 1.3)

    plotter.set_background("white")
    plotter.screenshot(HERE.parents[1] / "docs" / "pictures" / "organ_mesh.png")


if __name__ == "__main__":
    main()
