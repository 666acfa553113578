"""The benchmarks run and say what they measured; a step allocates nothing per point, however large the domain."""

import json
import subprocess
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from scenes_for_tests import CAM_CLAY, COLUMN, simulation

from benchmarks.__main__ import Part
from benchmarks.columns import cell_size_for, make_steps, moving_column
from benchmarks.cylinders import cylinder
from benchmarks.roofline import Roofline
from benchmarks.yardstick import Yardstick
from benchmarks.yardstick_3d import Yardstick3D
from grainlaw.mpm_core.parallel.threads import cores
from grainlaw.validation.cases.collapses.column import collapse

ROOT = Path(__file__).resolve().parent.parent
CLAY = {"material": {"modified_cam_clay": CAM_CLAY}, "body.0.material": "modified_cam_clay"}


def test_one_command_measures_prints_and_stores_what_is_asked(tmp_path):
    # In 3D kernels compile for minutes; the yardstick there has a test of its own.
    asked = [part for part in Part if part not in (Part.YARDSTICK_3D, Part.PASSES_3D)]
    command = [sys.executable, "-m", "benchmarks", *asked, "--quick", "--out", tmp_path, "--material", "mu(I)-LC"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    numbers = json.loads((tmp_path / "benchmark.json").read_text())
    page = (tmp_path / "benchmark.md").read_text()
    one_core = {Part.CORES, Part.SWEEP} if cores() == 1 else set()
    assert set(numbers) == {"machine", "roofline", *asked} - one_core
    for tables in numbers.values():
        for title in tables:
            assert title in done.stdout
            assert f"### {title}" in page
    (passes,) = numbers["passes"].values()
    assert {"grid update", "P2G", "G2P", "stress update", "rest"} <= {found["name"] for found in passes}
    assert sum(found["share"] for found in passes) == pytest.approx(1.0)
    (race,) = numbers["yardstick"].values()
    assert race[-1]["name"] == "yardstick"
    assert all(found["steps"] > 0 and found["rate"] > 0.0 for found in race)
    (machine,) = numbers["machine"].values()
    assert all(machine.values())


def test_the_yardstick_is_no_straw_man_and_comes_to_the_pile_of_the_library():
    cell_size = 0.0125
    library = collapse("mu(I)-LC", cell_size, {"transfer.scheme": "apic", "transfer.volume_projection": False})
    yardstick = Yardstick(library)
    library.advance_to(0.4)
    yardstick.advance_to(0.4)
    heights = library.bodies[0].positions[1].mean(), (yardstick.x + yardstick.lower)[:, 1].mean()
    widths = library.bodies[0].positions[0].std(), yardstick.x[:, 0].std()
    # Its floor holds the nodes and not the material: about half a cell.
    assert heights[1] == pytest.approx(heights[0], abs=0.6 * cell_size)
    assert widths[1] == pytest.approx(widths[0], rel=0.04)
    assert heights[0] < 0.2  # from 0.45 m at the start


def test_the_yardstick_in_three_dimensions_comes_to_the_pile_of_the_library():
    cell_size = 0.025
    library = cylinder("mu(I)-LC", cell_size, {"transfer.scheme": "apic", "transfer.volume_projection": False})
    yardstick = Yardstick3D(library)
    library.advance_to(0.25)
    yardstick.advance_to(0.25)
    places, others = library.bodies[0].positions, (yardstick.x + yardstick.lower).T
    assert others[2].mean() == pytest.approx(places[2].mean(), abs=0.6 * cell_size)
    assert others[:2].std(axis=1) == pytest.approx(places[:2].std(axis=1), rel=0.04)
    assert places[2].mean() < 0.12  # from 0.15 m at the start


def test_bandwidth_between_measured_sizes():
    roofline = Roofline({2**20: 100.0, 2**24: 20.0}, {"double": 1.0})
    assert roofline.bandwidth(2**20) == 100.0
    assert roofline.bandwidth(2**22) == pytest.approx(60.0)
    assert roofline.bandwidth(2**30) == 20.0


@pytest.mark.parametrize("points", [1e4, 1e5, 4e6])
def test_cell_sizes_for_a_number_of_points_divide_the_domain(points):
    cell_size = cell_size_for(points)
    assert 1.0 / cell_size == pytest.approx(round(1.0 / cell_size))
    assert 3.2 / cell_size == pytest.approx(round(3.2 / cell_size))
    assert 4 * 0.27 / cell_size**2 == pytest.approx(points, rel=0.5)


@pytest.mark.parametrize("law", [{}, CLAY], ids=["mu(I)-LC", "Cam Clay"])
def test_a_step_allocates_nothing_per_point(law):
    def largest_allocation(points_per_cell):
        """Peak of the memory that steps take on top of what there is, between two sorts [bytes]."""
        found = simulation(COLUMN, {**law, "body.0.points_per_cell": points_per_cell})
        make_steps(found, 3)
        tracemalloc.start()
        before = tracemalloc.get_traced_memory()[0]
        tracemalloc.reset_peak()
        make_steps(found, 5)
        peak = tracemalloc.get_traced_memory()[1] - before
        tracemalloc.stop()
        assert found.drift > 0.0
        return found.bodies[0].count, peak

    (few, small), (many, large) = largest_allocation(1), largest_allocation(16)
    assert many == 16 * few
    # Less than half a byte for each further point: per block of points, and Python's own objects.
    assert large - small < 0.5 * (many - few)


def test_compiled_passes_allocate_nothing_per_point():
    from numba.core.runtime import _nrt_python, rtsys

    def allocations(points_per_cell):
        found = simulation(COLUMN, {"body.0.points_per_cell": points_per_cell})
        make_steps(found, 3)
        before = rtsys.get_allocation_stats()
        make_steps(found, 5)
        return found.bodies[0].count, rtsys.get_allocation_stats().alloc - before.alloc

    _nrt_python.memsys_enable_stats()
    (few, small), (many, large) = allocations(1), allocations(16)
    # The arrays that a call hands over, the same for any number of points, and two buffers for each block of points.
    assert large - small < (many - few) / 100


def test_work_and_memory_follow_the_material_and_not_the_domain():
    small, large = (moving_column("mu(I)-LC", 0.05, domain_factor=factor) for factor in (1, 10))
    assert large.grid.cells == (10 * small.grid.cells[0], 10 * small.grid.cells[1])
    for found in (small, large):
        make_steps(found, 20)
    assert large.active.nodes == small.active.nodes
    assert large.bodies[0].points.shape == small.bodies[0].points.shape
    for row, twin in zip(large.bodies[0].points, small.bodies[0].points, strict=True):
        np.testing.assert_allclose(row, twin, rtol=1e-9, atol=1e-9)
    touched = [np.count_nonzero(found.grid.nodes) for found in (small, large)]
    assert touched[0] == touched[1]
