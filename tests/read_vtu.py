"""Reads back what write_vtu wrote: read_vtu.py plots|vtk FOLDER. Exit status 77: the reader is not installed."""

import itertools
import json
import os
import sys

try:
    import numpy as np
except ImportError:
    sys.exit(77)

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "examples", "common"))
from vtu_reader import HEXAHEDRON, VERTEX, Grid, read_history, read_series


def trilinear_volume(x):
    """Sum of the volumes of hexahedra (n, 8, 3) in VTK's order, and the least of them."""
    corner = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
    volumes = np.zeros(len(x))
    for s in itertools.product([0.5 - 0.5 / 3**0.5, 0.5 + 0.5 / 3**0.5], repeat=3):
        shape = np.where(corner == 1, s, 1.0 - np.array(s))
        slope = np.stack([np.prod(np.where(np.arange(3) == j, 2.0 * corner - 1.0, shape), axis=1) for j in range(3)])
        volumes += np.linalg.det(np.einsum("jc,nci->nij", slope, x)) / 8.0
    return volumes.sum(), volumes.min()


def check_plots(grid, summary, part):
    hexahedra = grid.cells(HEXAHEDRON)
    assert len(grid.points) == summary[f"points_{part}"]
    assert len(hexahedra) == summary[f"hexahedra_{part}"]
    assert np.array_equal(grid.cells(VERTEX)[:, 0], np.arange(len(grid.points)))
    total, least = trilinear_volume(grid.points[hexahedra])
    assert least > 0.0 and abs(total / summary[f"volume_{part}"] - 1.0) < 1e-12, (total, least)
    assert len(grid.surface()) == summary[f"facets_{part}"]
    # The surface is closed and points outwards: its flux of x is three times the volume of its polyhedron.
    x = grid.points[grid.surface()]
    flux = np.einsum("ni,ni->", x.mean(axis=1), np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])) / 2.0
    assert abs(flux / 3.0 / summary[f"volume_{part}"] - 1.0) < 1e-2
    data = grid.point_data
    assert np.array_equal(data["gap"], grid.points[:, 2])
    assert np.array_equal(data["effective_stress"], 1e3 + 2e8 * np.abs(grid.points[:, 2]))
    assert np.array_equal(data["velocity"], np.tile([1.0, 2.0, 3.0], (len(grid.points), 1)))
    assert data["region"].dtype == np.int32
    assert np.array_equal(grid.cell_data["kind"] > 0, grid.types == HEXAHEDRON)


def check_vtk(path, grid, summary, part):
    try:
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
    except ImportError:
        print("VTK for Python is not installed")
        sys.exit(77)
    problems = []
    reader = vtk.vtkXMLUnstructuredGridReader()
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda *_: problems.append(event))
    assert reader.CanReadFile(path)
    reader.SetFileName(path)
    reader.Update()
    output = reader.GetOutput()
    assert not problems, problems
    assert output.GetNumberOfPoints() == len(grid.points) and output.GetNumberOfCells() == len(grid.types)
    assert np.array_equal(vtk_to_numpy(output.GetPoints().GetData()), grid.points)
    assert output.GetFieldData().GetArray("TimeValue").GetValue(0) == grid.time
    for ours, theirs in ((grid.point_data, output.GetPointData()), (grid.cell_data, output.GetCellData())):
        assert theirs.GetNumberOfArrays() == len(ours)
        for name, values in ours.items():
            assert np.array_equal(vtk_to_numpy(theirs.GetArray(name)), values), name
    size = vtk.vtkCellSizeFilter()
    size.SetInputData(output)
    size.Update()
    volumes = vtk_to_numpy(size.GetOutput().GetCellData().GetArray("Volume"))[grid.types == HEXAHEDRON]
    assert volumes.min() > 0.0 and abs(volumes.sum() / summary[f"volume_{part}"] - 1.0) < 1e-2
    quality = vtk.vtkMeshQuality()
    quality.SetInputData(output)
    quality.SetHexQualityMeasureToScaledJacobian()
    quality.Update()
    jacobians = vtk_to_numpy(quality.GetOutput().GetCellData().GetArray("Quality"))[grid.types == HEXAHEDRON]
    assert jacobians.min() > 0.0, jacobians.min()


def check_pieces(path, summary):
    import vtk

    reader = vtk.vtkXMLPUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    output = reader.GetOutput()
    points = summary["points_cell"] + summary["points_substrate"]
    assert output.GetNumberOfPoints() == points
    assert output.GetNumberOfCells() == points + summary["hexahedra_cell"] + summary["hexahedra_substrate"]
    assert output.GetPointData().GetArray("effective_stress").GetNumberOfTuples() == points
    assert output.GetPointData().GetArray("velocity").GetNumberOfComponents() == 3


def main():
    reader, folder = sys.argv[1:]
    with open(os.path.join(folder, "summary.json")) as file:
        summary = json.load(file)
    frames = read_series(os.path.join(folder, "fields.pvd"))
    assert [time for time, _ in frames] == [0.0, 2.5e-6, 5e-6]
    time, parts = frames[-1]
    assert sorted(parts) == ["cell", "substrate"]
    assert list(read_history(os.path.join(folder, "history.csv"))["time"]) == [0.0, 2.5e-6, 5e-6]
    for part, path in parts.items():
        grid = Grid(path)
        assert grid.time == time
        if reader == "plots":
            check_plots(grid, summary, part)
        else:
            check_vtk(path, grid, summary, part)
            check_pieces(os.path.join(folder, "pieces.pvtu"), summary)
        print(f"{reader}: {part} with {len(grid.points)} points and {len(grid.types)} cells")


main()
