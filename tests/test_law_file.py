"""Laws from files of their own, which import files beside them: neither another's neighbour nor an installed module."""

import sys

import pytest
from stretched_law import COMPILED_STEP, printed, write_constant, write_law

from grainlaw.materials import InputError
from grainlaw.materials.registry import Registry

IMPORTS = {
    "of a name": ("from constants import C", "C"),
    "of a module": ("import constants", "constants.factor()"),
    "of a module by another name": ("import constants as numbers", "numbers.C"),
    "relative": ("from .constants import C as own", "own"),
    "relative of a module": ("from . import constants", "constants.C"),
    "of all names": ("from constants import *", "C"),
    "through another file": ("from tables import TWICE", "0.5 * TWICE"),
}


def law_from(path):
    found = Registry()
    found.load_file(path)
    return found.get("stretched").law


def factor_of(law):
    """What the law's own functions find, uncompiled: the wave speed of E = 1 Pa at 1 kg/m3."""
    return law.sound_speed(None, 1.0, law.state(), law.parameters(1.0))


@pytest.mark.parametrize("way", IMPORTS)
def test_a_law_imports_a_file_beside_it(way, tmp_path):
    write_constant(tmp_path, "3.0")
    (tmp_path / "tables.py").write_text("import constants\nTWICE = 2.0 * constants.C\n")
    assert factor_of(law_from(write_law(tmp_path / "law.py", *IMPORTS[way]))) == 3.0
    assert {"constants", "tables"} & sys.modules.keys() == set()


def test_an_import_within_a_function_finds_the_file_too(tmp_path):
    write_constant(tmp_path, "3.0")
    above = "def late():\n    from constants import C\n\n    return C\n"
    assert factor_of(law_from(write_law(tmp_path / "law.py", above, "late()"))) == 3.0


@pytest.mark.parametrize("through", ["of a name", "through another file"])
def test_equal_laws_in_two_folders_have_each_its_own_neighbours(through, tmp_path):
    laws = []
    for folder, value in (("one", "1.0"), ("other", "2.0")):
        write_constant(tmp_path / folder, value)
        (tmp_path / folder / "tables.py").write_text("import constants\nTWICE = 2.0 * constants.C\n")
        laws.append(law_from(write_law(tmp_path / folder / "law.py", *IMPORTS[through])))
    assert [factor_of(law) for law in laws] == [1.0, 2.0]


def test_an_edit_of_a_neighbour_makes_another_module_even_at_once(tmp_path):
    path, found = write_law(tmp_path / "law.py", *IMPORTS["of a name"]), []
    for value in ("1.0", "2.0"):
        write_constant(tmp_path, value)
        found.append(factor_of(law_from(path)))
    assert found == [1.0, 2.0]


def test_files_that_import_one_another_are_imported(tmp_path):
    (tmp_path / "constants.py").write_text("C = 3.0\nimport tables\n")
    (tmp_path / "tables.py").write_text("import constants\nTWICE = 2.0 * constants.C\n")
    assert factor_of(law_from(write_law(tmp_path / "law.py", *IMPORTS["through another file"]))) == 3.0


def test_a_neighbour_comes_before_a_module_of_the_working_folder(tmp_path, monkeypatch):
    for folder, value in (("laws", "3.0"), ("here", "4.0")):
        write_constant(tmp_path / folder, value)
    monkeypatch.syspath_prepend(tmp_path / "here")
    assert factor_of(law_from(write_law(tmp_path / "laws" / "law.py", *IMPORTS["of a name"]))) == 3.0


@pytest.mark.parametrize(
    ("name", "meant"), [("math", "the module of Python"), ("pluggy", "the installed"), ("grainlaw", "of this library")]
)
def test_a_file_with_the_name_of_an_installed_module_is_refused_where_a_law_imports_that_name(name, meant, tmp_path):
    (tmp_path / f"{name}.py").write_text("C = 1.0\n")
    assert factor_of(law_from(write_law(tmp_path / "law.py", "", "1.0"))) == 1.0
    with pytest.raises(InputError, match=rf"'{name}' may mean .*{name}.py or .*{meant}.*; rename the file"):
        law_from(write_law(tmp_path / "law.py", f"import {name}", f"{name}.C"))


def test_a_law_may_stand_in_a_file_of_any_name(tmp_path):
    assert factor_of(law_from(write_law(tmp_path / "law-2.1 (new).py", "", "3.0"))) == 3.0


def test_a_missing_neighbour_is_named(tmp_path):
    with pytest.raises(InputError, match="No module named 'constants'"):
        law_from(write_law(tmp_path / "law.py", *IMPORTS["of a name"]))


def test_states_from_a_neighbour_are_found_again_in_the_disk_cache(tmp_path):
    """The cache names a state by its module, which has to be there under the same name in the next process."""
    text = "from typing import NamedTuple\n\n\nclass Row(NamedTuple):\n    c: float\n\n\nROW = Row(3.0)\n"
    (tmp_path / "constants.py").write_text(text)
    law = write_law(tmp_path / "law.py", "from constants import ROW", "ROW.c")
    environment = {"NUMBA_CACHE_DIR": tmp_path / "cache", "NUMBA_DEBUG_CACHE": 1}
    assert "data saved to" in printed("-c", COMPILED_STEP, law, **environment)
    again = printed("-c", COMPILED_STEP, law, **environment)
    assert "data saved to" not in again
    assert float(again.splitlines()[-1]) == pytest.approx(3.0)
