#!/usr/bin/env python3
"""Draws a result of `souple run`: the body coloured by kind of element, over the outline of its rest shape.

    pip install pyvista
    cargo run --release -- run scenes/mixed_bar.toml --out out/mixed_bar
    python3 tools/draw_scene.py out/mixed_bar/bar.pvd docs/pictures/mixed_bar.png
    cargo run --release -- run scenes/organ.toml --out out/organ
    python3 tools/draw_scene.py out/organ/organ.pvd docs/pictures/organ.png --eye -0.1 0.28 -0.55 --cut z

A `.pvd` series is drawn at its last time, or at the one nearest to `--time`; a `.vtu` file as it is.
The field `displacement` must be in the file: it leads back to the rest shape.
"""

import argparse
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pyvista as pv
from PIL import Image

# VTK cell types of each family, whatever the degree, with the colour used in every picture of the project.
FAMILIES = {
    "hexahedra": ({12, 25, 29}, "#e0ab45"),
    "prisms": ({13, 26, 32}, "#3b6fb5"),
    "pyramids": ({14, 27}, "#4f9d69"),
    "tetrahedra": ({10, 24, 71}, "#c0605a"),
}
EDGE = "#33302e"
REST = "#8d8d8d"
# Height in pixels of the strip above the body that holds the legend.
LEGEND = 120


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result", type=Path, help="a .pvd series or a .vtu file")
    parser.add_argument("picture", type=Path, help="the PNG file to write")
    parser.add_argument("--time", type=float, help="simulated time in s; the last one without it")
    parser.add_argument("--eye", type=float, nargs=3, default=(-0.6, 0.35, 1.0), help="direction towards the viewer")
    parser.add_argument("--cut", choices="xyz", help="show only what lies behind the middle along this axis")
    parser.add_argument("--width", type=int, default=1400, help="width of the picture in pixels")
    return parser.parse_args()


def frame(result, time):
    """The VTU file to draw."""
    if result.suffix != ".pvd":
        return result
    entries = [(float(e.get("timestep")), e.get("file")) for e in ET.parse(result).iter("DataSet")]
    if not entries:
        raise SystemExit(f"{result}: no DataSet in the series")
    at = entries[-1] if time is None else min(entries, key=lambda e: abs(e[0] - time))
    return result.parent / at[1]


def axes(eye):
    """Unit vectors to the right, upwards and towards the viewer; y is up."""
    eye = eye / np.linalg.norm(eye)
    right = np.cross((0.0, 1.0, 0.0), eye)
    right /= np.linalg.norm(right)
    return right, np.cross(eye, right), eye


def total_length(lines):
    """Sum of the lengths of all lines of a mesh."""
    return lines.compute_cell_sizes(area=False, volume=False).cell_data["Length"].sum() if lines.n_cells else 0.0


def behind(mesh, rest, axis, eye):
    """Cells whose centre at rest lies on the far side of the middle."""
    k = "xyz".index(axis)
    centres = rest.cell_centers().points[:, k]
    middle = 0.5 * (rest.bounds[2 * k] + rest.bounds[2 * k + 1])
    return mesh.extract_cells(np.flatnonzero((centres - middle) * eye[k] < 0))


def main():
    options = arguments()
    mesh = pv.read(frame(options.result, options.time))
    if "displacement" not in mesh.point_data:
        raise SystemExit(f'{options.result}: no field "displacement"; add it to `fields` in the scene\'s [output]')
    rest = mesh.copy()
    rest.points = mesh.points - mesh.point_data["displacement"]
    solids = behind(mesh, rest, options.cut, options.eye) if options.cut else mesh

    right, up, eye = axes(np.array(options.eye))
    every = np.vstack([mesh.points, rest.points])
    spans = [(every @ axis).min() for axis in (right, up)], [(every @ axis).max() for axis in (right, up)]
    low, high = np.array(spans[0]), np.array(spans[1])
    middle = every.mean(axis=0)
    middle = middle + sum((0.5 * (low + high)[k] - middle @ axis) * axis for k, axis in enumerate((right, up)))
    extent = 1.06 * (high - low)
    height = round(options.width * extent[1] / extent[0]) + LEGEND

    plotter = pv.Plotter(off_screen=True, window_size=(options.width, height))
    plotter.set_background("white")
    for name, (types, colour) in FAMILIES.items():
        cells = np.flatnonzero(np.isin(solids.celltypes, list(types)))
        if len(cells) == 0:
            continue
        part = solids.extract_cells(cells).extract_surface(algorithm="dataset_surface")
        plotter.add_mesh(part, color=colour, show_edges=True, edge_color=EDGE, label=name, ambient=0.25)
    known = set().union(*(types for types, _ in FAMILIES.values()))
    solid = rest.extract_cells(np.flatnonzero(np.isin(rest.celltypes, list(known))))
    surface = solid.extract_surface(algorithm="dataset_surface").triangulate()
    sharp = surface.extract_feature_edges(40, boundary_edges=False, non_manifold_edges=False, manifold_edges=False)
    if total_length(sharp) > 2 * surface.length:
        plotter.add_mesh(sharp, color=REST, line_width=2)
    else:
        # A round body has no edges worth drawing; its outline is what tells the shape.
        plotter.add_silhouette(surface, color=REST, line_width=3)

    per_pixel = extent[0] / options.width
    centre = middle + 0.5 * LEGEND * per_pixel * up
    plotter.enable_parallel_projection()
    plotter.camera_position = [centre + 5 * np.linalg.norm(extent) * eye, centre, up]
    plotter.camera.parallel_scale = 0.5 * height * per_pixel
    plotter.reset_camera_clipping_range()
    plotter.add_legend(bcolor=None, face="rectangle", size=(0.15, 0.95 * LEGEND / height), loc="upper right")
    plotter.enable_anti_aliasing("ssaa")
    pixels = plotter.screenshot(return_img=True)
    # A palette makes the file three times smaller and nothing that an eye would miss.
    Image.fromarray(pixels).quantize(128).save(options.picture, optimize=True)
    print(f"{options.picture}: {options.picture.stat().st_size // 1024} kB")


if __name__ == "__main__":
    main()
