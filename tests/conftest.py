"""What several files of tests share."""

import os

import pytest
from installation import Installation, installed_once


@pytest.fixture(scope="session")
def installation(tmp_path_factory) -> Installation:
    """grainlaw installed from a wheel into an environment of its own, once for all tests and all workers."""
    own = tmp_path_factory.getbasetemp()
    shared = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own
    return installed_once(shared / "installation")
