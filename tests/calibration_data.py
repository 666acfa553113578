"""Synthetic measurements: a law's own answer with noise of a known size."""

from dataclasses import replace

import numpy as np

from grainlaw.materials.calibration.data import DataSet, Measured
from grainlaw.materials.calibration.experiments import get_experiment
from grainlaw.materials.calibration.model import ForwardModel, answer


def planned(test, control, abscissa, standard_errors, **statements):
    """A test that has not been measured yet; `standard_errors` by name of what it will measure."""
    measured = tuple(
        Measured(name, np.zeros(len(abscissa)), np.full(len(abscissa), error))
        for name, error in standard_errors.items()
    )
    return DataSet(test, get_experiment(test), control, np.array(abscissa), statements, measured)


def exact(law, tests, values):
    """The tests with what the law says."""
    model = ForwardModel(law, tuple(tests))
    histories = [(test, model.history(test, values, test.abscissa)) for test in tests]
    return [
        replace(test, measured=tuple(replace(found, values=answer(history, found)) for found in test.measured))
        for test, history in histories
    ]


def with_noise(tests, random):
    """The tests with normal noise of their standard errors."""
    return [
        replace(
            test,
            measured=tuple(
                replace(found, values=found.values + random.normal(0.0, found.standard_errors))
                for found in test.measured
            ),
        )
        for test in tests
    ]
