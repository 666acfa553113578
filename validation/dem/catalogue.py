"""The cases that the reference set is made of, in the order of their worth."""

from grainlaw.validation.dem.description import (
    AnyCase,
    Collapse,
    Compression,
    Contact,
    CylinderCollapse,
    Floor,
    Grains,
    PlaneShear,
    ShearStage,
    ShearStart,
)

END_TIMES = {1: 1.0, 2: 1.2, 4: 1.5, 6: 1.8}
CYLINDER_END_TIMES = {0.5: 0.75, 1: 1.1, 2: 1.1}
FOUR, TWO = (1, 2, 3, 4), (1, 2)


def column(aspect_ratio: int, floor: Floor, liggghts_seeds: tuple[int, ...], yade_seeds: tuple[int, ...]) -> Collapse:
    """The column of half width 0.15 m with one aspect ratio on one floor."""
    return Collapse(
        name=f"collapse-a{aspect_ratio}-{floor}",
        purpose=f"column with H0/L0 = {aspect_ratio} released on a {floor} floor",
        aspect_ratio=aspect_ratio,
        floor=floor,
        end=END_TIMES[aspect_ratio],
        liggghts_seeds=liggghts_seeds,
        yade_seeds=yade_seeds,
    )


def variant(name: str, purpose: str, **changes: object) -> Collapse:
    """The column a = 2 on the glued floor with something else about it."""
    reference = column(2, "glued", (1, 2), ())
    return reference.model_copy(update={"name": f"collapse-a2-glued-{name}", "purpose": purpose, **changes})


def cylinder(aspect_ratio: float, radius: float) -> CylinderCollapse:
    """The cylinder with one aspect ratio on the glued floor, of some ten thousand grains."""
    return CylinderCollapse(
        name=f"cylinder-a{aspect_ratio:g}-glued",
        purpose=f"cylinder with H0/r0 = {aspect_ratio:g} released on a glued floor",
        aspect_ratio=aspect_ratio,
        radius=radius,
        floor="glued",
        end=CYLINDER_END_TIMES[aspect_ratio],
        liggghts_seeds=TWO,
    )


# Up to the fastest flow in steps, so that the wall never jerks, then down to the slowest.
SHEAR_STAGES = tuple(
    ShearStage(nominal_inertial_number=number, transient_strain=transient, average_strain=average)
    for number, transient, average in (
        (0.14, 5.0, 12.0),
        (0.45, 15.0, 30.0),
        (1.0, 40.0, 60.0),
        (2.0, 80.0, 120.0),
        (3.5, 140.0, 200.0),
        (0.04, 2.0, 6.0),
        (0.013, 0.8, 3.0),
        (0.004, 0.4, 1.8),
    )
)

CASES: tuple[AnyCase, ...] = (
    column(2, "glued", FOUR, TWO),
    PlaneShear(
        name="shear",
        purpose="friction and solid fraction over the inertial number at 5 kPa",
        stages=SHEAR_STAGES,
        liggghts_seeds=(1, 2, 3),
    ),
    ShearStart(
        name="shear-start",
        purpose="peak and dilation of a packing as dense as the columns, at 5 kPa",
        liggghts_seeds=FOUR,
    ),
    Compression(name="compression", purpose="isotropic compression and unloading up to 200 kPa", liggghts_seeds=(1, 2)),
    column(1, "glued", FOUR, TWO),
    column(4, "glued", FOUR, TWO),
    column(6, "glued", FOUR, ()),
    column(2, "flat", FOUR, TWO),
    column(1, "flat", FOUR, TWO),
    column(4, "flat", FOUR, TWO),
    column(6, "flat", FOUR, ()),
    cylinder(0.5, radius=0.27),
    cylinder(1, radius=0.225),
    cylinder(2, radius=0.225),
    variant("stiff", "Young's modulus 1e9 Pa", contact=Contact(youngs_modulus=1e9), time_step=1e-5),
    variant("deep", "depth of 8 mean diameters", depth=0.12),
    variant(
        "fine",
        "grains of 8 to 12 mm",
        grains=Grains(smallest_diameter=0.008, largest_diameter=0.012),
        depth=0.04,
        time_step=2e-5,
    ),
)
