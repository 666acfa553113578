"""What several files of tests share, and the order in which files are handed to the workers of `make test`."""

import os
from pathlib import Path

import pytest
from installation import Installation, installed_once

# What takes longest comes first, so that no worker is left alone with it at the end. The kernels that most tests need
# are compiled once: the second file compiles its own in another environment meanwhile.
FIRST = ("test_run.py", "test_package.py", "test_docs.py", "test_template_package.py", "test_validation_command.py")


@pytest.fixture(scope="session")
def installation(tmp_path_factory) -> Installation:
    """grainlaw installed from a wheel into an environment of its own, once for all tests and all workers."""
    own = tmp_path_factory.getbasetemp()
    shared = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own
    return installed_once(shared / "installation")


@pytest.fixture(scope="session", autouse=True)
def silent_compilation():
    """Whether kernels are on disk already is no matter of most tests, which read what commands say on stderr."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("grainlaw.progress.say_that_it_compiles", lambda: None)
        yield


def pytest_collection_modifyitems(items):
    items.sort(key=lambda item: FIRST.index(name) if (name := Path(item.path).name) in FIRST else len(FIRST))
