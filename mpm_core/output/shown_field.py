"""The field by which pictures, films and pages of a run are coloured, and where its colours end."""

from grainlaw.mpm_core.output.frame import Frame
from grainlaw.mpm_core.output.run_folder import RunFolder

USUAL_FIELD, _USUAL_LIMITS = "shear_strain", (0.0, 3.0)


def shown_field(run: RunFolder, frame: Frame) -> str:
    """`output.picture_field` of the scene, or else the shear strain, or else the first field that the frame holds."""
    chosen = run.scene.get("output", {}).get("picture_field")
    if chosen:
        return str(chosen)
    held = [field.name for field in frame.fields]
    return held[0] if held and USUAL_FIELD not in held else USUAL_FIELD


def usual_limits(field: str) -> tuple[float, float] | None:
    """The ends of the colours of a field; None where they follow from its values."""
    return _USUAL_LIMITS if field == USUAL_FIELD else None
