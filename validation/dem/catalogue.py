"""The cases that the reference set is made of, in the order of their worth."""

from typing import Any

from grainlaw.validation.dem.description import (
    AnyCase,
    Collapse,
    Compression,
    Contact,
    CylinderCollapse,
    Floor,
    Grains,
    PlaneShear,
    RoughDrum,
    ShearStage,
    ShearStep,
    ShearSteps,
    SlotHopper,
    Triaxial,
    WallShear,
)

END_TIMES = {1: 1.0, 2: 1.2, 4: 1.5, 6: 1.8}
CYLINDER_END_TIMES = {0.5: 0.75, 1: 1.1, 2: 1.1}
FOUR, TWO = (1, 2, 3, 4), (1, 2)
# Packings that need not come to rest for long before they are sheared.
SHORT: dict[str, Any] = {"resting_time": 0.3, "liggghts_seeds": TWO}


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


def hopper(opening: float) -> SlotHopper:
    """The silo with a slot of one width [m]."""
    return SlotHopper(
        name=f"hopper-w{opening:g}",
        purpose=f"flat silo that empties through a slot of {opening:g} m",
        opening=opening,
        liggghts_seeds=TWO,
    )


def drum(radius: float) -> RoughDrum:
    """The half-full drum of one radius [m]; all have the same Froude number."""
    return RoughDrum(
        name=f"drum-r{radius:g}",
        purpose=f"half-full rough drum of {radius:g} m radius that turns steadily",
        radius=radius,
        # Contacts are softer under a few kPa.
        time_step=5e-5,
        liggghts_seeds=TWO,
    )


def stages(*strains: tuple[float, float, float]) -> tuple[ShearStage, ...]:
    """Stages of nominal inertial number, strain of the transient, strain of the average."""
    return tuple(
        ShearStage(nominal_inertial_number=number, transient_strain=transient, average_strain=average)
        for number, transient, average in strains
    )


def start_of_shear(name: str, says: str, **changes: Any) -> ShearSteps:
    """The start of shear, at a nominal I of 0.03, of a packing that was pressed together with some friction."""
    return ShearSteps(
        name=name,
        purpose=f"start of shear of a packing {says}, at 5 kPa",
        steps=(ShearStep(nominal_inertial_number=0.03, strain=1.0, block_strain=0.025),),
        **changes,
    )


# Up to the fastest flow in steps, so that the wall never jerks, then down to the slowest.
SHEAR_STAGES = stages(
    (0.14, 5.0, 12.0),
    (0.45, 15.0, 30.0),
    (1.0, 40.0, 60.0),
    (2.0, 80.0, 120.0),
    (3.5, 140.0, 200.0),
    (0.04, 2.0, 6.0),
    (0.013, 0.8, 3.0),
    (0.004, 0.4, 1.8),
)

# Steady at first; then the rate drops to a tenth, returns, rises, and drops to less than a fortieth. The wall bounces
# every 0.035 s after a jump: blocks of fast stages are as long, and the fastest is ten times as long.
RATE_STEPS = (
    ShearStep(nominal_inertial_number=0.14, strain=4.0, block_strain=0.5),
    ShearStep(nominal_inertial_number=0.014, strain=0.6, block_strain=0.02),
    ShearStep(nominal_inertial_number=0.14, strain=4.0, block_strain=0.5),
    ShearStep(nominal_inertial_number=0.6, strain=20.0, block_strain=2.0),
    ShearStep(nominal_inertial_number=0.014, strain=0.6, block_strain=0.02),
)
REVERSAL = (
    ShearStep(nominal_inertial_number=0.14, strain=4.0, block_strain=0.5),
    ShearStep(nominal_inertial_number=0.03, strain=0.5, block_strain=0.05),
    ShearStep(nominal_inertial_number=-0.03, strain=1.0, block_strain=0.025),
)

CASES: tuple[AnyCase, ...] = (
    column(2, "glued", FOUR, TWO),
    PlaneShear(
        name="shear",
        purpose="friction and solid fraction over the inertial number at 5 kPa",
        stages=SHEAR_STAGES,
        liggghts_seeds=(1, 2, 3),
    ),
    start_of_shear("shear-start", "as dense as the columns", liggghts_seeds=FOUR),
    start_of_shear("shear-start-medium", "of medium density", packing_friction=0.3, **SHORT),
    start_of_shear("shear-start-loose", "as loose as can be", packing_friction=5.0, **SHORT),
    ShearSteps(
        name="shear-rate-steps",
        purpose="drops and jumps of the rate in steady shear, at 5 kPa",
        packing_friction=0.7,
        steps=RATE_STEPS,
        **SHORT,
    ),
    ShearSteps(
        name="shear-reversal",
        purpose="slow shear turned back, at 5 kPa",
        packing_friction=0.7,
        steps=REVERSAL,
        **SHORT,
    ),
    PlaneShear(
        name="shear-500Pa",
        purpose="steady shear at 0.5 kPa, slow and faster",
        normal_stress=500.0,
        # Contacts are softer.
        time_step=5e-5,
        stages=stages((0.14, 3.0, 6.0), (0.02, 0.5, 1.5)),
        liggghts_seeds=TWO,
    ),
    PlaneShear(
        name="shear-50kPa",
        purpose="steady shear at 50 kPa, slow and faster",
        normal_stress=50e3,
        stages=stages((0.14, 5.0, 12.0), (0.013, 0.8, 3.0)),
        liggghts_seeds=TWO,
    ),
    WallShear(
        name="wall-shear",
        purpose="friction of a flat plane and slip along it, at 5 kPa",
        stages=stages((0.14, 4.0, 4.0), (0.4, 8.0, 8.0), (0.04, 1.0, 2.0), (0.01, 0.3, 0.6)),
        liggghts_seeds=TWO,
    ),
    Compression(name="compression", purpose="isotropic compression and unloading up to 200 kPa", liggghts_seeds=(1, 2)),
    Triaxial(name="triaxial", purpose="drained compression of a dense cube at 5 kPa", liggghts_seeds=TWO),
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
    *(hopper(opening) for opening in (0.15, 0.2, 0.25)),
    *(drum(radius) for radius in (0.3, 0.45)),
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
