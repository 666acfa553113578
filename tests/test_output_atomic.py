"""A file that a run writes is either complete or as it was before."""

import pytest

from grainlaw.materials import atomic


def test_text_and_bytes_arrive_and_leave_nothing_beside(tmp_path):
    atomic.write_text(tmp_path / "a.txt", "µ\n")
    atomic.write_bytes(tmp_path / "b.bin", b"\x00\x01")
    assert (tmp_path / "a.txt").read_bytes() == "µ\n".encode()
    assert (tmp_path / "b.bin").read_bytes() == b"\x00\x01"
    assert {path.name for path in tmp_path.iterdir()} == {"a.txt", "b.bin"}


def test_a_writer_that_fails_half_way_leaves_the_old_file(tmp_path):
    path = tmp_path / "frame.vtu"
    path.write_text("old")
    with pytest.raises(TypeError), atomic.replacing(path) as partial:
        partial.open("w").writelines(["half", 1])
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_the_path_to_write_to_keeps_the_ending_and_the_folder(tmp_path):
    with atomic.replacing(tmp_path / "final.png") as partial:
        assert (partial.suffix, partial.parent) == (".png", tmp_path)
        partial.write_bytes(b"")
