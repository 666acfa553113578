"""The shape of the project: imports run one way, laws use the public names only, listing laws stays light."""

import ast
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from grainlaw import materials
from grainlaw.mpm_core.kernels.sources import KERNEL_ROOMS

ROOT = Path(__file__).resolve().parent.parent
ALLOWED = {
    "materials": {"materials"},
    "plugins": {"materials", "plugins"},
    "mpm_core": {"materials", "mpm_core"},
    "validation": {"materials", "plugins", "mpm_core", "validation"},
    "grainlaw": {"materials", "plugins", "mpm_core", "validation", "grainlaw"},
}
HEAVY = {"h5py", "matplotlib", "meshio", "numba", "numpy", "pyvista", "scipy", "trimesh", "vtk", "vtkmodules"}


def modules(folder: str) -> list[Path]:
    """The files of a folder, but not those that a link in it leads to."""
    return [path for path in sorted((ROOT / folder).rglob("*.py")) if path.resolve() == path]


def owner(module: str) -> str:
    """The folder that a module of ours belongs to; empty for anybody else's."""
    package, *inner = module.split(".")
    if package != "grainlaw":
        return ""
    return inner[0] if inner and inner[0] in ALLOWED else package


def imports(path: Path) -> list[tuple[str, str]]:
    """(module, name) for every import anywhere in a file; the name is empty for `import module`."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [(alias.name, "") for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            found += [(node.module or "", alias.name) for alias in node.names]
    return found


@pytest.mark.parametrize("folder", ALLOWED)
def test_imports_run_one_way(folder):
    forbidden = ALLOWED.keys() - ALLOWED[folder]
    wrong = [
        f"{path.relative_to(ROOT)} imports {module}"
        for path in modules(folder)
        for module, _ in imports(path)
        if owner(module) in forbidden
    ]
    assert wrong == []


@pytest.mark.parametrize("path", modules("plugins"), ids=lambda path: path.stem)
def test_laws_use_public_names_of_materials_and_their_family_only(path):
    used = [(module, name) for module, name in imports(path) if owner(module) == "materials"]
    assert {module for module, _ in used} <= {"grainlaw.materials", "grainlaw.materials.elementary"}
    assert [name for module, name in used if module == "grainlaw.materials" and name not in materials.__all__] == []


def test_the_mark_of_compiled_code_covers_what_kernels_are_made_from():
    makers = ("@njit", "@register_jitable", "@intrinsic")
    found = {
        path.relative_to(ROOT / "mpm_core").parts[0]
        for path in modules("mpm_core")
        if any(maker in path.read_text(encoding="utf-8") for maker in makers)
    }
    assert found <= set(KERNEL_ROOMS)


@pytest.mark.parametrize("room", KERNEL_ROOMS)
def test_kernels_take_nothing_from_the_core_that_their_mark_does_not_cover(room):
    covered = {f"grainlaw.mpm_core.{name}" for name in ("layout", "space", *KERNEL_ROOMS)}
    taken = {(module, name) for path in modules(f"mpm_core/{room}") for module, name in imports(path)}
    beyond = {
        (module, name)
        for module, name in taken
        if owner(module) == "mpm_core" and not any(module == one or module.startswith(f"{one}.") for one in covered)
    }
    # compiled code sees a body's arrays only
    assert beyond <= {("grainlaw.mpm_core.body", "Body")}


def test_public_names_exist_once():
    assert sorted(set(materials.__all__)) == sorted(materials.__all__)
    assert [name for name in materials.__all__ if not hasattr(materials, name)] == []


def test_numbers_of_rows_stay_in_the_core():
    files = [path for folder in (*ALLOWED, "benchmarks") if folder != "mpm_core" for path in modules(folder)]
    used = {name for path in files for module, name in imports(path) if module == "grainlaw.mpm_core.layout"}
    assert used <= {"allocate"}


def test_no_module_is_a_drawer_for_odds_and_ends():
    names = {"utils", "util", "helpers", "common", "misc"}
    assert [path for folder in ALLOWED for path in modules(folder) if names & {path.stem, path.parent.name}] == []


def test_every_built_in_law_has_its_entry_point():
    files = {path.stem for path in (ROOT / "plugins").glob("*.py")} - {"__init__"}
    declared = {found.value for found in entry_points(group="grainlaw.materials")}
    assert {f"grainlaw.plugins.{name}" for name in files} <= declared


@pytest.mark.parametrize("path", sorted((ROOT / "plugins").glob("[!_]*.py")), ids=lambda path: path.stem)
def test_law_begins_with_equations_source_conventions_and_range(path):
    header = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    assert any(line.startswith("    ") and "=" in line for line in header.splitlines())
    assert "\nSource: " in header
    assert "\nConventions" in header
    assert "\nValid f" in header or "range of validity: as" in header


@pytest.mark.parametrize("arguments", [["--help"], ["materials"], ["materials", "mu_i_lc", "--json"]])
def test_listing_laws_imports_no_heavy_library(arguments):
    program = f"""
import sys
from grainlaw.cli.main import main
sys.argv = ["grainlaw", *{arguments!r}]
try:
    main()
finally:
    print("imported:", *{{name.partition(".")[0] for name in sys.modules}}, file=sys.stderr)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    imported = done.stderr.rpartition("imported:")[2].split()
    assert "grainlaw" in imported
    assert HEAVY & set(imported) == set()
