"""The temporal VTKHDF file: what vtkHDFReader gets, and what survives a crash or a resume."""

import fcntl
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from synthetic_run import frame
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

from grainlaw.mpm_core.output.vtkhdf import VTKHDF_NAME, append_frame, drop_after

STEPS = 5


@pytest.fixture
def path(tmp_path):
    for number in range(STEPS):
        append_frame(tmp_path / VTKHDF_NAME, frame(number))
    return tmp_path / VTKHDF_NAME


def opened(path):
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    return reader


def at_step(reader, number):
    reader.SetStep(number)
    reader.Update()
    return reader.GetOutputDataObject(0)


def times(reader):
    return list(reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()))


def assert_holds_steps(path, count):
    reader = opened(path)
    assert times(reader) == [frame(number).time for number in range(count)]
    for number in range(count):
        written, data = frame(number), at_step(reader, number)
        assert data.GetClassName() == "vtkPolyData"
        assert data.GetNumberOfVerts() == data.GetNumberOfCells() == len(written.positions)
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPoints().GetData()), written.positions)
        np.testing.assert_array_equal(
            vtk_to_numpy(data.GetVerts().GetConnectivityArray()), np.arange(len(written.positions))
        )
        assert data.GetPointData().GetNumberOfArrays() == len(written.fields)
        for field in written.fields:
            values = vtk_to_numpy(data.GetPointData().GetArray(field.name))
            np.testing.assert_array_equal(values, field.stored_values())


def test_each_step_holds_its_own_points_and_fields(path):
    assert_holds_steps(path, STEPS)


def test_the_points_move_from_step_to_step(path):
    reader = opened(path)
    bounds = np.array([at_step(reader, number).GetBounds() for number in range(STEPS)])
    assert (np.diff(bounds[:, 1]) > 0).all()
    assert (np.diff(bounds[:, 3]) < 0).all()


def test_a_run_killed_while_it_appends_keeps_the_earlier_steps(path):
    """The process dies when all data of the step are written and the step is about to be counted."""
    script = """
import os, signal, sys, h5py
from pathlib import Path
from synthetic_run import frame
from grainlaw.mpm_core.output import vtkhdf
count = h5py.AttributeManager.__setitem__
def die(attributes, name, value):
    os.kill(os.getpid(), signal.SIGKILL)
h5py.AttributeManager.__setitem__ = die
vtkhdf.append_frame(Path(sys.argv[1]), frame(int(sys.argv[2])))
"""
    arguments = [sys.executable, "-c", script, str(path), str(STEPS)]
    assert subprocess.run(arguments, cwd=Path(__file__).parent, check=False).returncode == -9
    assert_holds_steps(path, STEPS)
    append_frame(path, frame(STEPS))
    assert_holds_steps(path, STEPS + 1)


def test_appending_does_not_fail_while_a_viewer_has_the_file_open(path):
    with path.open("rb") as viewer:
        fcntl.flock(viewer, fcntl.LOCK_SH)  # what HDF5 holds in a process that reads
        append_frame(path, frame(STEPS))
    assert_holds_steps(path, STEPS + 1)


def test_a_resumed_run_takes_the_place_of_dropped_frames(path):
    drop_after(path, frame(2).time)
    assert_holds_steps(path, 3)
    append_frame(path, frame(3))
    assert_holds_steps(path, 4)
