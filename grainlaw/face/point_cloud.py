"""A frame as points of pyvista."""

from pyvista import PolyData

from grainlaw.mpm_core.output.frame import Frame


def point_cloud(frame: Frame) -> PolyData:
    """The points of a frame with an array for each field, and its time [s] among the field data."""
    cloud = PolyData(frame.positions)
    for field in frame.fields:
        cloud.point_data[field.name] = field.values
    cloud.field_data["time"] = [frame.time]
    return cloud
