"""Writes gmsh.txt and vtk.txt beside it: where each format puts the nodes of its reference element, in its own order.

`pip install gmsh vtk && python generate.py`; the numbers come from the programs themselves, not from their manuals.
Each block is `type NUMBER` and one line of coordinates per node.
More types are listed than there are elements today, so that a new element finds its nodes here.
"""

from pathlib import Path

import gmsh
import vtk

HERE = Path(__file__).parent


def block(number, points):
    lines = [f"type {number}"]
    lines += [" ".join(f"{x + 0.0:.15g}" for x in (*point, 0.0, 0.0)[:3]) for point in points]
    return "\n".join(lines) + "\n"


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
text = f"# Gmsh {gmsh.__version__}: getElementProperties, local node coordinates.\n"
for number in (*range(1, 15), *range(16, 22), 23, 26, 27, 29, 30, 36, 92):
    _, dimension, _, count, x, _ = gmsh.model.mesh.getElementProperties(number)
    text += block(number, [tuple(float(v) for v in x[i * dimension : (i + 1) * dimension]) for i in range(count)])
(HERE / "gmsh.txt").write_text(text)

FIXED = [
    vtk.vtkLine, vtk.vtkTriangle, vtk.vtkQuad, vtk.vtkTetra, vtk.vtkHexahedron, vtk.vtkWedge, vtk.vtkPyramid,
    vtk.vtkQuadraticEdge, vtk.vtkQuadraticTriangle, vtk.vtkQuadraticQuad, vtk.vtkBiQuadraticQuad,
    vtk.vtkQuadraticTetra, vtk.vtkQuadraticHexahedron, vtk.vtkTriQuadraticHexahedron, vtk.vtkQuadraticWedge,
    vtk.vtkQuadraticPyramid, vtk.vtkQuadraticLinearQuad, vtk.vtkQuadraticLinearWedge,
    vtk.vtkBiQuadraticQuadraticWedge, vtk.vtkBiQuadraticQuadraticHexahedron, vtk.vtkBiQuadraticTriangle,
    vtk.vtkCubicLine, vtk.vtkTriQuadraticPyramid,
]  # fmt: skip
ANY_DEGREE = [
    (vtk.vtkLagrangeCurve, 4), (vtk.vtkLagrangeCurve, 5), (vtk.vtkLagrangeTriangle, 10), (vtk.vtkLagrangeTriangle, 15),
    (vtk.vtkLagrangeTetra, 20), (vtk.vtkLagrangeTetra, 35),
]  # fmt: skip
text = f"# VTK {vtk.vtkVersion().GetVTKVersion()}: GetParametricCoords.\n"
for make, count in [(make, None) for make in FIXED] + ANY_DEGREE:
    cell = make()
    if count:
        cell.GetPointIds().SetNumberOfIds(count)
        cell.GetPoints().SetNumberOfPoints(count)
        cell.Initialize()
    count = cell.GetNumberOfPoints()
    x = cell.GetParametricCoords()
    text += block(cell.GetCellType(), [tuple(x[3 * i + j] for j in range(3)) for i in range(count)])
(HERE / "vtk.txt").write_text(text)
