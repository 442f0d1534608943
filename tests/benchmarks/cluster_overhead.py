"""Tasks per second and overhead of Dask, for the first frequency of a robot in 1000 poses.

    python tests/benchmarks/cluster_overhead.py [--poses 1000]

Each pose of the five-bar linkage is a task of its own. It is solved by beams in this process, in
one and two local worker processes, and on one and two Dask workers of this machine. CPU time is
that of all processes, scheduler included, per task; the excess over the first row is overhead.
Rates are by wall time, and depend on other work of the machine (last column). All frequencies must
be equal. Needs the extra `cluster`.
"""

# ruff: noqa: T201, E402  a script that prints its figures

import argparse
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from time import perf_counter

os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
sys.path[:0] = [str(Path(__file__).resolve().parents[2]), str(Path(__file__).parent)]

import numpy as np
import psutil

from lumped.robot_file import load_robot
from validation.run.cluster import on_cluster
from validation.run.executor import Executor, in_order, in_turn, on_cores
from validation.solve.model_answers import solve
from validation.solve.question import Question


def frequency(pose: str) -> float:
    """First frequency (Hz) of the five-bar linkage in a pose."""
    question = Question(load_robot("five-bar"), "beam", {}, 1, (), (pose,), digits=False)
    return float(solve(question).answers[0].frequencies[0])


@contextmanager
def on_dask(workers: int) -> Iterator[Executor]:
    """Context with an executor on new workers of one thread each."""
    from distributed import LocalCluster  # noqa: PLC0415  needs the extra `cluster`

    os.environ["PYTHONPATH"] = os.pathsep.join(sys.path)
    options = {"threads_per_worker": 1, "dashboard_address": "", "memory_limit": 0}
    with (
        LocalCluster(workers, **options) as cluster,
        on_cluster(cluster.scheduler_address, print) as executor,
    ):
        yield executor


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poses", type=int, default=1000)
    count = parser.parse_args().poses
    grid = load_robot("five-bar").mechanism.poses
    low, high = grid.min(axis=0), grid.max(axis=0)
    poses = low + np.linspace(0.0, 1.0, count)[:, None] * (high - low)
    calls = [partial(frequency, ",".join(map(repr, pose.tolist()))) for pose in poses]
    print("| executor | processes | tasks per second | CPU per task (ms) | load |")
    print("|---|---|---|---|---|")
    frequencies = []
    for name, context, processes in (
        ("this process", lambda _: nullcontext(in_turn), 1),
        *(
            (*row, processes)
            for row in (("cores", on_cores), ("Dask", on_dask))
            for processes in (1, 2)
        ),
    ):
        with context(processes) as executor:
            # Processes start with the first tasks.
            in_order(executor, calls[: 4 * processes])
            begun, used = perf_counter(), processor_time()
            frequencies.append(in_order(executor, calls))
            seconds, used = perf_counter() - begun, processor_time() - used
        assert frequencies[-1] == frequencies[0]
        row = f"| {name} | {processes} | {count / seconds:.1f} | {1e3 * used / count:.1f}"
        print(f"{row} | {os.getloadavg()[0]:.0f} |", flush=True)


def processor_time() -> float:
    """CPU time (s) of this process and of all that descend from it."""
    process = psutil.Process()
    times = [running.cpu_times() for running in (process, *process.children(recursive=True))]
    return sum(cpu_times.user + cpu_times.system for cpu_times in times)


if __name__ == "__main__":
    # Other processes find the function of a task by the name of its module.
    import cluster_overhead

    cluster_overhead.main()
