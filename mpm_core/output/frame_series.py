"""The frames of a run for ParaView: numbered VTU files and `run.pvd`, which gives each its time."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from xml.etree import ElementTree

from grainlaw.materials import InputError, atomic
from grainlaw.mpm_core.output.frame import Frame
from grainlaw.mpm_core.output.vtu import write_vtu

COLLECTION_NAME = "run.pvd"


@dataclass(frozen=True)
class FrameFile:
    """Where the frame at `time` [s] lies."""

    time: float
    path: Path


class FrameSeries:
    """Writes the frames of one run into its folder; `run.pvd` lists them all after each."""

    def __init__(self, folder: Path) -> None:
        """Continue the series that the folder holds, or start an empty one."""
        self.folder = folder
        self.files = list(read_collection(folder)) if (folder / COLLECTION_NAME).exists() else []

    def write(self, frame: Frame) -> Path:
        """Write the frame as the next VTU file, then list it; return the path of the file."""
        path = self.folder / f"points_{len(self.files):06d}.vtu"
        write_vtu(path, frame)
        self.files.append(FrameFile(frame.time, path))
        self._write_collection()
        return path

    def drop_after(self, time: float) -> None:
        """Forget and remove the frames later than `time` [s], that of the checkpoint from which the run resumes."""
        self.files = [file for file in self.files if file.time <= time]
        self._write_collection()
        kept = {file.path for file in self.files}
        for path in self.folder.glob("points_*.vtu"):
            if path not in kept:
                path.unlink()

    def _write_collection(self) -> None:
        write_collection(self.folder / COLLECTION_NAME, self.files)


def write_collection(path: Path, files: Iterable[FrameFile]) -> None:
    """Write a list of files with their times; those of one time are its parts."""
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    collection = ElementTree.SubElement(root, "Collection")
    for _, of_time in groupby(files, key=lambda file: file.time):
        for part, file in enumerate(of_time):
            ElementTree.SubElement(collection, "DataSet", timestep=repr(file.time), part=str(part), file=file.path.name)
    ElementTree.indent(root)
    atomic.write_bytes(path, ElementTree.tostring(root, xml_declaration=True))


def read_collection(folder: Path, name: str = COLLECTION_NAME) -> tuple[FrameFile, ...]:
    """Time and path of each frame that a list in `folder`, by default `run.pvd`, holds, in order of time.

    Raises InputError if there is no such file or it cannot be read.
    """
    path = folder / name
    if not path.is_file():
        raise InputError(f"{folder} holds no {name}: no frame of a run was written there")
    try:
        entries = ElementTree.parse(path).getroot().iter("DataSet")
        return tuple(FrameFile(float(entry.attrib["timestep"]), folder / entry.attrib["file"]) for entry in entries)
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        raise InputError(f"{path} cannot be read as a ParaView collection: {error}") from error
