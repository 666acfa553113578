"""Our pile beside that of another MPM code, which ran the same column: a row for each code and law.

The bands are those within which a law is acceptable to grains. What is left beyond our copy of a set-up belongs to what
the codes do differently; the notes say what that is.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error, upper_bound
from grainlaw.validation.cases.mpm.set_ups import (
    AS_HYDRAX,
    DYNAMIC_FRICTION,
    EXPLICIT,
    FRICTION_OF_TABLE_1,
    HEAVIER,
    drucker_prager,
    one_preconsolidation_pressure,
)
from grainlaw.validation.grains.material_points import grain_density, snapshot_of_bodies
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.observe import observe
from grainlaw.validation.grains.run_observation import as_grains, spacing_of_points
from grainlaw.validation.mpm.peers import Peer, peers
from grainlaw.validation.mpm.piles import PileDistance, compare_piles
from grainlaw.validation.scenes import advance, shipped_simulation

# Twice the bands of `grains.distance`: E_A, half width, top.
BANDS = (0.12, 0.12, 0.10)
GRAIN_DIAMETER, GRAIN_DENSITY = 0.005, 2450.0
COARSER = {Effort.QUICK: 2.0, Effort.FULL: 1.0}
Changes = Mapping[str, Any]


@dataclass(frozen=True)
class SetUp:
    """A shipped scene with values by dotted key on top; made when it is run."""

    scene: str
    changes: Callable[[], Changes] = dict


@dataclass(frozen=True)
class Row:
    """A code beside ours.

    ours      the set-up that is as theirs, as far as it is known
    mistaken  the set-up of the negative control, with the `mistake` in words
    others    set-ups by name that tell what a difference is due to; measured in full, stated, not judged
    """

    name: str
    proves: str
    ours: SetUp
    mistake: str
    mistaken: SetUp
    others: Mapping[str, SetUp] = field(default_factory=dict)

    @property
    def peer(self) -> Peer:
        """The other code."""
        return peers()[self.name]

    def measure(self, effort: Effort) -> Evidence:
        """The pile at their time, and in full the others."""
        found = beside(self.peer, self.ours, effort, "set up as theirs")
        others = self.others if effort is Effort.FULL else {}
        stated = [beside(self.peer, other, effort, name) for name, other in others.items()]
        notes = (
            f"{self.peer.title}: {found.verdict}; what it did differently: {'; '.join(self.peer.differs)}",
            *map(_in_words, (found, *stated)),
        )
        return Evidence(measurements(found), figures=(_figure(self.peer, (found, *stated)),), notes=notes)

    def control(self, effort: Effort) -> tuple[Measurement, ...]:
        """The mistaken set-up, on the coarse grid."""
        return measurements(beside(self.peer, self.mistaken, Effort.QUICK, self.mistake))


def beside(peer: Peer, set_up: SetUp, effort: Effort, label: str) -> PileDistance:
    """Run a set-up to the time of a peer's pile, on cells as large as theirs or twice that, and compare the two."""
    run, width = _observed(set_up, COARSER[effort] * peer.cell_size, peer.time, label)
    return compare_piles(run, peer.observed(width), width)


def measurements(found: PileDistance) -> tuple[Measurement, ...]:
    """E_A, half width and top in their bands."""
    area, *lengths = found.distances
    relative = (
        relative_error(name, "m", one.measured, one.reference, band)
        for name, one, band in zip(("half width", "top"), lengths, BANDS[1:], strict=True)
    )
    return (upper_bound("E_A", "1", area.measured, BANDS[0]), *relative)


def _observed(set_up: SetUp, cell_size: float, end: float, label: str) -> tuple[Observation, float]:
    """The column at the start and at `end` [s], and the width of the kernel that spread it [m]."""
    changes = {"grid.cell_size": cell_size, "time.end": end, "output.fields": [], **set_up.changes()}
    simulation = shipped_simulation(set_up.scene, changes)
    density = grain_density(simulation.bodies, GRAIN_DENSITY)
    width = max(GRAIN_DIAMETER, spacing_of_points(simulation.scene))
    setting, _ = as_grains(simulation.scene, simulation.bodies, (), width, density)
    snapshots = [snapshot_of_bodies(0.0, simulation.bodies, density)]
    advance(simulation, end)
    snapshots.append(snapshot_of_bodies(end, simulation.bodies, density))
    return observe(snapshots, setting, {"label": label}), width


def _in_words(found: PileDistance) -> str:
    area, half_width, top = found.distances
    return (
        f"{found.run}, t = {found.time:g} s: E_A {100.0 * area.measured:.1f} %, half width {half_width.measured:.3f} m "
        f"({100.0 * half_width.distance:+.1f} % of {half_width.reference:.3f}), top {top.measured:.3f} m "
        f"({100.0 * top.distance:+.1f} % of {top.reference:.3f}), E_A of shapes of one area "
        f"{100.0 * found.shape_distance:.1f} %"
    )


def _figure(peer: Peer, found: tuple[PileDistance, ...]) -> Figure:
    theirs = found[0].theirs
    curves = (curve(one.run, one.ours.x, one.ours.h) for one in found)
    title = f"{peer.title}, t = {peer.time:g} s"
    return Figure(title, "x [m]", "h [m]", (curve(peer.code, theirs.x, theirs.h, "reference"), *curves))


def _case(row: Row) -> Case:
    return Case(
        name=row.name,
        title=f"beside {row.peer.title}",
        proves=row.proves,
        reference=f"its pile at t = {row.peer.time:g} s: {row.peer.code} {row.peer.version}, {row.peer.run}",
        norm="area between the surfaces over the mean area below them; relative differences of half width and top",
        mistake=row.mistake,
        measure=row.measure,
        control=row.control,
    )


ROWS = (
    Row(
        "hydrax_mu_i_lc",
        "the paper's pile of mu(I)-LC comes out of the law as published, integrated as published",
        SetUp("collapse_mu_i_lc_viscous", lambda: EXPLICIT),
        "mu_d = 1.247 of Table 1 instead of 3.741",
        SetUp("collapse_mu_i_lc_viscous", lambda: {**EXPLICIT, DYNAMIC_FRICTION: FRICTION_OF_TABLE_1}),
        {"with an elastic predictor, our transfer": SetUp("collapse_mu_i_lc_published")},
    ),
    Row(
        "hydrax_cam_clay",
        "the paper's pile of Cam Clay comes out of p_c = p and its heavier points",
        SetUp("collapse_mcc_ocr1_published", lambda: HEAVIER),
        "p_c = 4 p",
        SetUp("collapse_mcc_ocr4_published", lambda: AS_HYDRAX),
        {
            "masses as the stress, our transfer": SetUp("collapse_mcc_ocr1_published"),
            "p_c through the stress, our transfer": SetUp("collapse_mcc_ocr1"),
        },
    ),
    Row(
        "matter_cam_clay",
        "Cam Clay at finite strain and in rate form make the same pile",
        SetUp("collapse_mcc_ocr1"),
        "M = 0.7 instead of 1.2",
        SetUp("collapse_mcc_ocr1", lambda: {"material.modified_cam_clay.critical_state_ratio": 0.7}),
        {"one p_c, that of the bottom": SetUp("collapse_mcc_ocr1", one_preconsolidation_pressure)},
    ),
    Row(
        "geotaichi_cam_clay",
        "another code in rate form makes the same pile of Cam Clay",
        SetUp("collapse_mcc_ocr1"),
        "floor friction 0.2 instead of 0.7",
        SetUp("collapse_mcc_ocr1", lambda: {"boundary.bottom.coefficient": 0.2}),
    ),
    Row(
        "newton_drucker_prager",
        "explicit and implicit integration make the same pile of Drucker-Prager",
        SetUp("collapse_mu_i_lc", drucker_prager),
        "friction 0.35 instead of 0.6928",
        SetUp("collapse_mu_i_lc", lambda: drucker_prager(0.35)),
    ),
)
CASES = {row.name: _case(row) for row in ROWS}
