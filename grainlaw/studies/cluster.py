"""The processes that runs are handed to: on this machine, or those of a Dask scheduler."""

import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import dask
from distributed import Client, LocalCluster

from grainlaw.materials import InputError
from grainlaw.materials.errors import InputWarning
from grainlaw.mpm_core.parallel.threads import cores

# How long a scheduler may take to answer [s].
PATIENCE = 10


@contextmanager
def workers_of(scheduler: str | None, workers: int | None) -> Iterator[Client]:
    """The client of a scheduler at an address, or of one on this machine with so many processes, by default its cores.

    Each process of this machine has one thread and its share of the memory, beyond which it is started again.
    Raises InputError for an address that does not answer, and where processes here do not start.
    """
    _quieten()
    if scheduler is None:
        with _own_cluster(workers or cores()) as cluster, Client(cluster) as client:
            yield client
    else:
        with _client_of(scheduler) as client:
            _warn_of_workers(client, scheduler)
            yield client


def _own_cluster(workers: int) -> LocalCluster:
    try:
        with dask.config.set({"distributed.worker.profile.enabled": False}):
            return LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                memory_limit="auto",
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
            )
    except RuntimeError as error:
        # Each process imports the script that starts it.
        hint = "a script has to call this below `if __name__ == '__main__':`"
        raise InputError(f"workers = {workers}: the processes do not start ({error}); {hint}") from error


def _client_of(scheduler: str) -> Client:
    try:
        return Client(scheduler, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        reason = str(error) or type(error).__name__
        raise InputError(f"no scheduler answers at {scheduler} within {PATIENCE} s: {reason}") from error


def _warn_of_workers(client: Client, scheduler: str) -> None:
    found = client.scheduler_info(n_workers=-1)["workers"].values()
    if not found:
        warnings.warn(f"the scheduler at {scheduler} has no worker yet; runs wait for one", InputWarning, stacklevel=1)
    elif any(worker["nthreads"] > 1 for worker in found):
        text = f"workers of {scheduler} have several threads, which take turns; --nthreads 1 --nworkers N uses N cores"
        warnings.warn(text, InputWarning, stacklevel=1)


def _quieten() -> None:
    """Keep Dask from logging connections and workers that come and go: what matters of it is told as an outcome.

    For good, because connections that are given up are still logged after their end.
    """
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
