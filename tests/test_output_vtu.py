"""The frames of a run as ParaView reads them: VTU files and their collection."""

import numpy as np
import pytest
import pyvista
from synthetic_run import FRAMES, frame, write_run
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray
from vtkmodules.vtkCommonDataModel import VTK_VERTEX
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.frame import Frame
from grainlaw.mpm_core.output.frame_series import FrameSeries, read_collection
from grainlaw.mpm_core.output.vtu import read_vtu, write_vtu


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return write_run(tmp_path_factory.mktemp("vtu") / "run")


def vtk_grid(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()


@pytest.mark.parametrize("number", [0, 4, FRAMES - 1])
def test_the_reader_of_paraview_gets_points_vertices_vectors_units_and_time(run, number):
    written = frame(number)
    grid = vtk_grid(run / f"points_{number:06d}.vtu")
    assert grid.GetNumberOfPoints() == grid.GetNumberOfCells() == len(written.positions)
    assert set(vtk_to_numpy(grid.GetCellTypes())) == {VTK_VERTEX}
    assert vtk_to_numpy(grid.GetPoints().GetData()).dtype == np.float64
    np.testing.assert_array_equal(vtk_to_numpy(grid.GetPoints().GetData()), written.positions)
    data = grid.GetPointData()
    assert [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())] == ["shear_strain", "pressure", "velocity"]
    for field in written.fields:
        array = data.GetArray(field.name)
        assert array.GetInformation().Get(vtkDataArray.UNITS_LABEL()) == field.unit
        np.testing.assert_allclose(vtk_to_numpy(array), field.values, rtol=1e-7)
    assert data.GetArray("velocity").GetNumberOfComponents() == 3
    assert grid.GetFieldData().GetArray("TimeValue").GetValue(0) == written.time


def test_pyvista_opens_each_frame_at_its_time_through_the_collection(run):
    reader = pyvista.get_reader(str(run / "run.pvd"))
    assert reader.time_values == [frame(number).time for number in range(FRAMES)]
    for number in (0, FRAMES - 1):
        reader.set_active_time_point(number)
        grid = reader.read()[0]
        np.testing.assert_array_equal(grid.points, frame(number).positions)
        assert set(grid.celltypes) == {VTK_VERTEX}
        assert all(np.isfinite(array).all() for array in grid.point_data.values())


def test_every_file_opens_in_pyvista(run):
    for path in run.glob("*.vtu"):
        assert pyvista.read(path).n_points == len(frame(0).positions)


def test_a_frame_reads_back_as_it_was(tmp_path):
    written = frame(3)
    write_vtu(tmp_path / "a.vtu", written)
    read = read_vtu(tmp_path / "a.vtu", {field.name: (field.unit, field.doc) for field in written.fields})
    assert (read.time, read.step) == (written.time, written.step)
    np.testing.assert_array_equal(read.positions, written.positions)
    for before, after in zip(written.fields, read.fields, strict=True):
        assert (after.name, after.unit, after.doc) == (before.name, before.unit, before.doc)
        assert after.values.dtype == np.float64
        np.testing.assert_array_equal(after.values, before.stored_values())


def test_a_scene_that_asks_for_no_field_gets_none(tmp_path):
    write_vtu(tmp_path / "a.vtu", Frame(0.0, 0, frame(0).positions, ()))
    assert vtk_grid(tmp_path / "a.vtu").GetPointData().GetNumberOfArrays() == 0
    assert read_vtu(tmp_path / "a.vtu", {}).fields == ()


def test_a_cut_off_file_is_refused_in_one_line(tmp_path):
    write_vtu(tmp_path / "a.vtu", frame(0))
    (tmp_path / "a.vtu").write_bytes((tmp_path / "a.vtu").read_bytes()[:5000])
    with pytest.raises(InputError, match=r"^frame .*a\.vtu cannot be read: [^\n]*$"):
        read_vtu(tmp_path / "a.vtu", {})


def test_resuming_forgets_later_frames_and_overwrites_their_numbers(tmp_path):
    folder = write_run(tmp_path / "run")
    (folder / "points_000011.vtu").write_text("written, but the run died before it was listed")
    series = FrameSeries(folder)
    series.drop_after(frame(4).time)
    assert sorted(path.name for path in folder.glob("*.vtu")) == [f"points_{n:06d}.vtu" for n in range(5)]
    assert [file.time for file in read_collection(folder)] == [frame(n).time for n in range(5)]
    assert series.write(frame(5)).name == "points_000005.vtu"
    assert [file.time for file in read_collection(folder)] == [frame(n).time for n in range(6)]
