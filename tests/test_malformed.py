"""Spoilt inputs of every kind: refused in one line, or read; no traceback, no warning of a library, no hang."""

import pytest
from grains_for_tests import write_run
from inputs_to_spoil import subjects
from malformed import FAULTS, attempt, trials

from grainlaw.materials import InputError
from grainlaw.validation.grains.reference_file import load_reference

COUNT, SEED = 120, 20


def test_the_good_inputs_are_read(tmp_path):
    for kind, subject in subjects().items():
        for name, write in subject.good.items():
            folder = tmp_path / f"{kind} {name}"
            folder.mkdir()
            assert attempt(subject.read, write(folder)).outcome == "read", (kind, name)


def test_spoilt_inputs_are_refused_in_a_line_or_read(tmp_path):
    found = list(trials(COUNT, SEED, tmp_path))
    for name, path, trial in found:
        assert trial.outcome not in FAULTS, f"{name}, {path}: {trial.text}"
    outcomes = [trial.outcome for _, _, trial in found]
    assert outcomes.count("refused") > COUNT / 2
    assert outcomes.count("read") > COUNT / 20


def test_a_message_is_one_line_whatever_it_quotes(tmp_path):
    with pytest.raises(InputError, match=r"/a b does not exist$"):
        load_reference(tmp_path / "a\nb")


@pytest.mark.parametrize(("column", "message"), [("vx", r"a velocity of 1e\+200"), ("x", r"a position of 1e\+200")])
def test_numbers_of_no_grains_are_refused(tmp_path, column, message):
    folder = write_run(tmp_path / "run", "csv")
    path = folder / "grains0.csv"
    header, first, *rest = path.read_text().splitlines()
    cells = first.split(",")
    cells[header.split(",").index(column)] = "1e200"
    path.write_text("\n".join([header, ",".join(cells), *rest]))
    with pytest.raises(InputError, match=message):
        load_reference(folder)


@pytest.mark.parametrize("error", [KeyError("x"), InputError("")])
def test_a_fault_is_seen(tmp_path, error):
    def read(path):
        raise error

    assert attempt(read, tmp_path).outcome in FAULTS
