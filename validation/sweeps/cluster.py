"""Units of work on a Dask cluster (optional extra `cluster`).

A unit whose worker is lost goes to another one; results come to this process as they are
finished, so that nothing is lost with a worker.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from threading import Lock
from types import ModuleType
from typing import Any

from lumped.errors import ComputationError, InputError
from validation.results.provenance import suite_digest
from validation.sweeps.runner import Executor, Finished, Work

# How long (s) to wait for the scheduler and for the first worker.
_PATIENCE = 20.0
# Workers may have several threads; gmsh has one model and a unit is to have its core to itself.
_ONE_AT_A_TIME = Lock()


@contextmanager
def on_cluster(address: str) -> Iterator[Executor]:
    """An executor on the Dask cluster whose scheduler is at `address` ("tcp://host:port").

    Raises InputError where Dask is not installed, where no scheduler answers, where it has no
    workers, and where a worker has other sources of this program; the executor raises what a call
    raises, and ComputationError where workers are lost faster than units are finished.
    """
    distributed = _distributed()
    client = _connected(distributed, address)
    try:
        _require_same_program(client, address)

        def execute(calls: Sequence[Work]) -> Finished:
            return _execute(distributed, client, calls)

        yield execute
    finally:
        client.close()


def _execute(distributed: ModuleType, client: Any, calls: Sequence[Work]) -> Finished:
    futures = client.map(_alone, calls, pure=False, batch_size=None)
    numbers = {future.key: number for number, future in enumerate(futures)}
    try:
        for future in distributed.as_completed(futures, loop=client.loop):
            yield numbers[future.key], future.result()
    except distributed.KilledWorker as error:
        raise ComputationError(
            "--cluster: one unit of the sweep was lost with several workers, one after the other, "
            "probably for want of memory; what was finished is kept"
        ) from error
    except distributed.client.FutureCancelledError as error:
        raise ComputationError(
            "--cluster: the scheduler is gone; what was finished is kept"
        ) from error
    finally:
        client.cancel(futures)


def _alone(call: Work) -> Any:
    with _ONE_AT_A_TIME:
        return call()


def _distributed() -> ModuleType:
    try:
        import distributed  # noqa: PLC0415  an optional extra, and slow to import
    except ImportError as error:
        raise InputError(
            "--cluster: Dask is not installed; pip install 'flexproof[cluster]' brings it"
        ) from error
    module: ModuleType = distributed
    return module


def _connected(distributed: ModuleType, address: str) -> Any:
    try:
        client = distributed.Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise InputError(
            f"--cluster {address}: no Dask scheduler answers there (expected tcp://host:port)"
        ) from error
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
    except TimeoutError as error:
        client.close()
        raise InputError(
            f"--cluster {address}: the scheduler has no workers; start some with 'dask worker'"
        ) from error
    return client


def _require_same_program(client: Any, address: str) -> None:
    found, own = client.run(suite_digest, on_error="return"), suite_digest()
    faults = [
        f"--cluster {address}: worker {worker} has another flexproof, or none; install this one"
        for worker, digest in sorted(found.items())
        if digest != own
    ]
    if faults:
        raise InputError(faults)
