"""Damaged HDF5 and VTK files: one line within seconds, where a library would go on for ever, crash or believe them."""

import base64
import json
import os
import signal
import struct

import h5py
import numpy as np
import pytest
from scenes_for_tests import BLOCK, changed, write_scene

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene, run
from grainlaw.mpm_core.output import damaged_files
from grainlaw.mpm_core.output.hdf5_file import USER_BLOCK, is_sealed
from grainlaw.mpm_core.output.hdf5_reading import existing_hdf5, numbers_of
from grainlaw.mpm_core.output.vtkhdf import drop_after
from grainlaw.validation.grains.observation import is_observation
from grainlaw.validation.grains.reference_file import load_reference


@pytest.fixture(autouse=True)
def _soon(monkeypatch):
    monkeypatch.setattr(damaged_files, "LONGEST_STEP", 0.5)


def write_endless(path, group="/"):
    """A file with a text among whose neighbours is one of no length, at which the library stays for ever."""
    with h5py.File(path, "w") as file:
        file.require_group(group).attrs["description"] = "x" * 50
        file["x"] = [1.0]
    data = bytearray(path.read_bytes())
    # In the heap of texts: 16 bytes, the text's own 16, and its 50 filled up to 56.
    free = data.index(b"GCOL") + 16 + 16 + 56
    data[free : free + 16] = bytes(16)
    path.write_bytes(data)


@pytest.mark.parametrize("read", [is_observation, load_reference, drop_after], ids=lambda read: read.__name__)
def test_a_file_without_end_is_refused(tmp_path, read):
    path = tmp_path / "file.h5"
    write_endless(path)
    with pytest.raises(InputError, match=r"file\.h5 is damaged: HDF5 comes to no end with a part of it within 0\.5 s"):
        read(path, *[0.0] * (read is drop_after))


@pytest.mark.parametrize("group", ["/", "VTKHDF", "a/b/c"])
def test_all_groups_are_gone_through(tmp_path, group):
    path = tmp_path / "file.h5"
    write_endless(path, group)
    with pytest.raises(InputError, match="comes to no end"), existing_hdf5(path):
        pass


@pytest.mark.parametrize("name", ["body.med", "body.h5m", "body.cgns", "body.hmf", "body.xdmf"])
def test_a_mesh_without_end_is_refused(tmp_path, name):
    write_endless(tmp_path / ("parts.h5" if name == "body.xdmf" else name))
    if name == "body.xdmf":
        (tmp_path / name).write_text("<Xdmf><DataItem>\n  parts.h5:/x\n</DataItem></Xdmf>")
    scene = changed(BLOCK, {"body.0.shape": {"kind": "mesh", "file": name}})
    with pytest.raises(InputError, match=r"is damaged: HDF5 comes to no end"):
        Scene.load(write_scene(tmp_path / "scene.toml", scene))


VTK_OF_ONE_ENDLESS_BLOCK = """<?xml version="1.0"?>
<VTKFile type="PolyData" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">
<PolyData><Piece NumberOfPoints="1" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
<PointData><DataArray type="Float64" Name="radius" format="binary">{}AAAA</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0</DataArray></Points>
</Piece></PolyData></VTKFile>"""


def test_a_vtk_file_of_which_the_library_dies_is_refused(tmp_path):
    header = base64.b64encode(struct.pack("<4Q", 1, 2**61, 2**61, 8)).decode()
    (tmp_path / "grains0.vtp").write_text(VTK_OF_ONE_ENDLESS_BLOCK.format(header))
    frames = [{"file": "grains0.vtp", "time": 0.0}]
    (tmp_path / "run.json").write_text(json.dumps({"depth": 0.06, "grain_density": 2450.0, "frames": frames}))
    with pytest.raises(InputError, match=r"grains0\.vtp is damaged: VTK crashes on it \(SIGABRT\)"):
        load_reference(tmp_path)


def test_a_file_after_one_without_end_is_read(tmp_path):
    write_endless(tmp_path / "bad.h5")
    with h5py.File(tmp_path / "good.h5", "w") as file:
        file["x"] = [1.0]
        file["loop"] = file["/"]
        file["elsewhere"] = h5py.ExternalLink("nowhere.h5", "/x")
    with pytest.raises(InputError, match="comes to no end"), existing_hdf5(tmp_path / "bad.h5"):
        pass
    for _ in range(2):
        with existing_hdf5(tmp_path / "good.h5") as file:
            assert numbers_of(file["x"]) == [1.0]
        # Whoever ends the process that goes through files.
        os.kill(damaged_files._walker._process.pid, signal.SIGKILL)
        damaged_files._walker._process.wait()


def test_what_a_file_cannot_hold_is_refused(tmp_path):
    with h5py.File(tmp_path / "file.h5", "w") as file:
        file.create_dataset("endless", (10**9, 3), float, chunks=(1000, 3))
        file["text"] = "a"
        file["packed"] = file.create_dataset("zeros", (10**6,), float, data=np.zeros(10**6), compression="gzip")
    with existing_hdf5(tmp_path / "file.h5") as file:
        with pytest.raises(ValueError, match=r"/endless claims the shape \(1000000000, 3\), more than"):
            numbers_of(file["endless"])
        for name in ("text", "/"):
            with pytest.raises(TypeError, match="does not hold numbers"):
                numbers_of(file[name])
        assert not numbers_of(file["packed"]).any()


def test_a_changed_checkpoint_is_refused_and_one_without_a_seal_is_read(tmp_path):
    class StoppedError(Exception):
        pass

    def stop(simulation, _):
        if simulation.time > 0.05:
            raise StoppedError

    scene = Scene.from_dict(changed(BLOCK, {"body.0.velocity": [0.1, 0.0], "output.interval": 0.03}))
    with pytest.raises(StoppedError):
        run(scene, tmp_path, progress=stop)
    checkpoint = tmp_path / "checkpoint.h5"
    whole = checkpoint.read_bytes()
    assert is_sealed(checkpoint)
    with h5py.File(checkpoint) as file:
        place = whole.index(file["body/0/points"][:].tobytes())
    for position in (place + 7, len(whole) - 1, USER_BLOCK):
        changed_one = bytearray(whole)
        changed_one[position] ^= 1
        checkpoint.write_bytes(changed_one)
        with pytest.raises(InputError, match=r"checkpoint\.h5 is damaged: it is not as it was written"):
            run(scene, tmp_path, resume=True)
    checkpoint.write_bytes(whole[USER_BLOCK:])
    assert not is_sealed(checkpoint)
    assert run(scene, tmp_path, resume=True).simulated_time == pytest.approx(0.1)
