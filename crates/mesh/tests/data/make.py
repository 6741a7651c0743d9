"""Makes the sample files in this folder with the programs that people use: Gmsh, VTK and meshio.

    pip install gmsh==4.15.2 meshio==5.3.5 vtk==9.7.2
    python make.py

One small body of every shape: a hexahedron, a prism and a pyramid on two of its faces, and a tetrahedron on the
pyramid. Volume 1 + 1/2 + 1/3 + 1/6 = 2. Its group "fixed" is the side x = 0 (a quadrangle and a triangle).
Files named mixed-* hold this body; the others are described where they are made.
"""

import gmsh
import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

POINTS = np.array(
    [
        [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1],
        [0, 2, 0], [1, 2, 0],  # ridge of the prism
        [2, 0.5, 0.5],  # apex of the pyramid
        [1.5, -0.5, 1.5],  # top of the tetrahedron, on the pyramid's face 1 5 10
    ],
    dtype=float,
)
HEX = [[0, 1, 2, 3, 4, 5, 6, 7]]
PRISM = [[3, 8, 7, 2, 9, 6]]
PYRAMID = [[1, 2, 6, 5, 10]]
TET = [[1, 10, 5, 11]]
QUAD = [[0, 4, 7, 3]]
TRI = [[3, 7, 8]]
CELLS = {"hexahedron": HEX, "wedge": PRISM, "pyramid": PYRAMID, "tetra": TET, "quad": QUAD, "triangle": TRI}


def tag(i):
    """Sparse and unordered node tags."""
    return 7 + 10 * ((5 * i) % 12)


def gmsh_model(without=()):
    gmsh.model.add("mixed")
    for dim, t in [(3, 1), (3, 2), (2, 1), (0, 5)]:
        gmsh.model.addDiscreteEntity(dim, t)
    gmsh.model.mesh.addNodes(3, 1, [tag(i) for i in range(len(POINTS))], POINTS.flatten())
    number = iter(range(100, 200))
    for dim, entity, kind, cells in [
        (3, 1, 5, HEX), (3, 2, 6, PRISM), (3, 2, 7, PYRAMID), (3, 2, 4, TET), (2, 1, 3, QUAD), (2, 1, 2, TRI),
        (0, 5, 15, [[11]]),
    ]:
        if kind in without:
            continue
        tags = [[tag(i) for i in c] for c in cells]
        gmsh.model.mesh.addElementsByType(entity, kind, [next(number) for _ in cells], sum(tags, []))
    gmsh.model.addPhysicalGroup(3, [1, 2], 1, name="body")
    gmsh.model.addPhysicalGroup(3, [1], 2, name="stiff part")
    gmsh.model.addPhysicalGroup(2, [1], 3, name="fixed")
    gmsh.model.addPhysicalGroup(0, [5], 42)


def write_gmsh(name, version, binary, suffix=".msh"):
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", binary)
    gmsh.write(name + suffix)


def gmsh_files():
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh_model()
    for version, text in [(4.1, "41"), (2.2, "22")]:
        for binary, encoding in [(0, "text"), (1, "binary")]:
            write_gmsh(f"mixed-gmsh{text}-{encoding}", version, binary)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    gmsh.model.mesh.setOrder(2)
    write_gmsh("mixed2-gmsh41-text", 4.1, 0)
    write_gmsh("mixed2-gmsh22-binary", 2.2, 1)
    gmsh.model.remove()
    # Complete second order: 27-node hexahedron, 18-node prism, 14-node pyramid.
    gmsh_model()
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 0)
    gmsh.model.mesh.setOrder(2)
    write_gmsh("complete2-gmsh41-binary", 4.1, 1)
    write_gmsh("complete2-gmsh22-text", 2.2, 0)
    gmsh.model.remove()
    # Third order: the tetrahedron and the triangle are elements here, the hexahedron and the quadrangle are not.
    gmsh_model(without=[6, 7])
    gmsh.model.mesh.setOrder(3)
    write_gmsh("cubic-gmsh41-binary", 4.1, 1)
    write_gmsh("cubic-gmsh22-text", 2.2, 0)
    gmsh.model.remove()
    # A geometry: several groups per entity, a reversed group, points, parameters, partitions.
    gmsh.model.add("box")
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMin", 2)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 2)
    gmsh.model.addPhysicalGroup(3, [1], 7, name="body")
    gmsh.model.addPhysicalGroup(3, [1], 8, name="also body")
    gmsh.model.addPhysicalGroup(2, [-1], 3, name="left, reversed")
    gmsh.model.addPhysicalGroup(2, [1, 2], 4, name="x sides")
    gmsh.model.addPhysicalGroup(2, [-3], 5, name="front, reversed")
    gmsh.model.addPhysicalGroup(0, [1, 3], 9)
    gmsh.model.mesh.generate(3)
    gmsh.option.setNumber("Mesh.SaveParametric", 1)
    write_gmsh("box-gmsh41-parametric-text", 4.1, 0)
    write_gmsh("box-gmsh41-parametric-binary", 4.1, 1)
    gmsh.option.setNumber("Mesh.SaveParametric", 0)
    write_gmsh("box-gmsh22-text", 2.2, 0)
    write_gmsh("box-gmsh22-binary", 2.2, 1)
    gmsh.model.mesh.partition(2)
    write_gmsh("box-gmsh41-partitioned-text", 4.1, 0)
    write_gmsh("box-gmsh41-partitioned-binary", 4.1, 1)
    gmsh.model.remove()
    # The same geometry with quadratic tetrahedra, in the other formats that Gmsh writes.
    gmsh.model.add("quadratic")
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    gmsh.write("quadratic-gmsh.mesh")
    gmsh.write("quadratic-gmsh.inp")
    gmsh.write("quadratic-gmsh.vtk")
    gmsh.finalize()


def vtk_grid(floats=np.float64):
    grid = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(POINTS.astype(floats), deep=1))
    grid.SetPoints(points)
    for kind, cells in [(12, HEX), (13, PRISM), (14, PYRAMID), (10, TET), (9, QUAD), (5, TRI)]:
        for c in cells:
            grid.InsertNextCell(kind, len(c), c)

    def add(data, name, values):
        array = numpy_to_vtk(np.array(values), deep=1)
        array.SetName(name)
        data.AddArray(array)

    add(grid.GetCellData(), "material_id", np.array([1, 2, 2, 2, 0, 0], dtype=np.int32))
    add(grid.GetCellData(), "fixed", np.array([0, 0, 0, 0, 1, 1], dtype=np.uint8))
    add(grid.GetCellData(), "stress xx", np.arange(6, dtype=np.float64))
    add(grid.GetPointData(), "clamped", (POINTS[:, 0] == 0).astype(np.int8))
    add(grid.GetPointData(), "displacement", (POINTS * 0.1).astype(np.float32))
    names = vtk.vtkStringArray()
    names.SetName("label text")
    for i in range(6):
        names.InsertNextValue(f"cell {i}")
    grid.GetCellData().AddArray(names)
    return grid


def vtk_files():
    for mode in ["ascii", "inline", "appended", "appended64"]:
        for zlib in [0, 1]:
            if mode == "ascii" and zlib:
                continue
            writer = vtk.vtkXMLUnstructuredGridWriter()
            # The variants share the widths of their numbers out among themselves.
            wide = zlib == 1
            writer.SetInputData(vtk_grid(np.float64 if wide else np.float32))
            writer.SetHeaderTypeToUInt64() if wide else writer.SetHeaderTypeToUInt32()
            writer.SetIdTypeToInt64() if wide else writer.SetIdTypeToInt32()
            {"ascii": writer.SetDataModeToAscii, "inline": writer.SetDataModeToBinary}.get(
                mode, writer.SetDataModeToAppended
            )()
            writer.SetEncodeAppendedData(mode == "appended64")
            writer.SetCompressorTypeToZLib() if zlib else writer.SetCompressorTypeToNone()
            writer.SetBlockSize(64)
            writer.SetFileName(f"mixed-vtk-{mode}{'-zlib' if zlib else ''}.vtu")
            writer.Write()
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(vtk_grid())
    writer.SetByteOrderToBigEndian()
    writer.SetFileName("mixed-vtk-bigendian.vtu")
    writer.Write()
    for version in [42, 51]:
        for binary in [0, 1]:
            writer = vtk.vtkUnstructuredGridWriter()
            writer.SetInputData(vtk_grid())
            writer.SetFileVersion(version)
            writer.SetFileType(2 if binary else 1)
            writer.SetFileName(f"mixed-vtk{version}-{'binary' if binary else 'text'}.vtk")
            writer.Write()
    kinds_file()
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputData(vtk_grid())
    surface.Update()
    for version in [42, 51]:
        writer = vtk.vtkPolyDataWriter()
        writer.SetInputData(surface.GetOutput())
        writer.SetFileVersion(version)
        writer.SetFileType(2)
        writer.SetFileName(f"surface-vtk{version}.vtk")
        writer.Write()


def kinds_file():
    """Cells that are converted or skipped: pixel, voxel, strip, polyline, polygons, vertex, polyhedron, Lagrange."""
    grid = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    for k in range(3):
        for j in range(3):
            for i in range(3):
                points.InsertNextPoint(i / 2, j / 2, k / 2)
    points.InsertNextPoint(2, 2, 2)
    grid.SetPoints(points)
    grid.InsertNextCell(8, 4, [0, 1, 3, 4])
    grid.InsertNextCell(11, 8, [0, 1, 3, 4, 9, 10, 12, 13])
    grid.InsertNextCell(6, 5, [0, 1, 3, 4, 6])
    grid.InsertNextCell(4, 4, [0, 1, 2, 5])
    grid.InsertNextCell(7, 3, [0, 1, 3])
    grid.InsertNextCell(7, 4, [0, 1, 4, 3])
    grid.InsertNextCell(7, 5, [0, 1, 2, 4, 3])
    grid.InsertNextCell(1, 1, [27])
    grid.InsertNextCell(73, 6, [0, 1, 3, 9, 10, 12])
    tri_quadratic = vtk.vtkTriQuadraticHexahedron()
    lagrange = vtk.vtkLagrangeHexahedron()
    lagrange.SetUniformOrderFromNumPoints(27)
    at = {}
    for k in range(3):
        for j in range(3):
            for i in range(3):
                at[lagrange.PointIndexFromIJK(i, j, k)] = i + 3 * j + 9 * k
    grid.InsertNextCell(72, 27, [at[n] for n in range(27)])
    coordinates = tri_quadratic.GetParametricCoords()
    node = [round(2 * coordinates[3 * n]) + 3 * round(2 * coordinates[3 * n + 1]) + 9 * round(2 * coordinates[3 * n + 2]) for n in range(27)]
    grid.InsertNextCell(29, 27, node)
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetDataModeToAscii()
    writer.SetFileName("kinds-vtk.vtu")
    writer.Write()


def meshio_files():
    mesh = meshio.Mesh(
        POINTS,
        [(kind, np.array(cells)) for kind, cells in CELLS.items()],
        cell_data={"material_id": [[1], [2], [2], [2], [0], [0]]},
    )
    mesh.write("mixed-meshio-text.vtu", binary=False)
    mesh.write("mixed-meshio-zlib.vtu")
    mesh.write("mixed-meshio-plain.vtu", compression=None)
    mesh.write("mixed-meshio42.vtk", file_format="vtk42")
    mesh.write("mixed-meshio51.vtk", file_format="vtk51")
    mesh.write("mixed-meshio22.msh", file_format="gmsh22", binary=False)
    meshio.Mesh(POINTS, [("hexahedron", np.array(HEX))]).write("hex-meshio41.msh", file_format="gmsh", binary=True)
    solids = meshio.Mesh(POINTS, [("hexahedron", np.array(HEX)), ("wedge", np.array(PRISM)), ("tetra", np.array(TET))])
    solids.write("solids-meshio.inp")
    medit = meshio.Mesh(
        POINTS,
        [(k, np.array(c)) for k, c in CELLS.items() if k != "pyramid"],
        cell_data={"medit:ref": [[1], [2], [2], [4], [4]]},
        point_data={"medit:ref": np.zeros(len(POINTS), dtype=int)},
    )
    medit.write("solids-meshio.mesh")
    surface = meshio.Mesh(POINTS[:8], [("triangle", np.array(
        [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4],
         [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]]))])
    surface.write("cube-text.stl", binary=False)
    surface.write("cube-binary.stl", binary=True)
    surface.write("cube-text.ply", binary=False)
    surface.write("cube-binary.ply", binary=True)
    surface.write("cube.obj")


if __name__ == "__main__":
    gmsh_files()
    vtk_files()
    meshio_files()
