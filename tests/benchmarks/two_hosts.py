"""Two hosts as two network namespaces: runs on a Dask worker in each, against local runs.

    sudo .venv/bin/python tests/benchmarks/two_hosts.py --robots ifw delta --preset quick

Scheduler, run and first worker are in the namespace flexproof-a (10.83.0.1), the second worker is
in flexproof-b (10.83.0.2), with a cache of its own. Each robot is run on this machine with one
process, on both workers, and on both workers of which the second is killed (SIGKILL) after a fifth
of the tasks. The table has the wall time of each run and the largest difference of a number of
results.json from the local run, relative to the larger one of the pair; times are left out. Needs
the rights of root, iproute2 and the extra `cluster`.
"""

# ruff: noqa: T201  a script that prints its figures

import argparse
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ADDRESSES = {"flexproof-a": "10.83.0.1", "flexproof-b": "10.83.0.2"}
FIRST, SECOND = ADDRESSES
SCHEDULER = f"tcp://{ADDRESSES[FIRST]}:8786"
# Entries of results.json that describe the run, not the robot.
IGNORED = {"run", "seconds", "notes", "cpu_seconds"}


def ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True)  # noqa: S607  iproute2 of the system


@contextmanager
def two_hosts() -> Iterator[None]:
    """Context with two namespaces that are connected by a pair of virtual network cards."""
    with ExitStack() as stack:
        for host in ADDRESSES:
            ip("netns", "add", host)
            stack.callback(ip, "netns", "del", host)
        ip("link", "add", "fp-a", "netns", FIRST, "type", "veth", "peer", "fp-b", "netns", SECOND)
        for (host, address), card in zip(ADDRESSES.items(), ("fp-a", "fp-b"), strict=True):
            ip("-n", host, "addr", "add", f"{address}/24", "dev", card)
            for name in ("lo", card):
                ip("-n", host, "link", "set", name, "up")
        yield


def started(
    words: list[str], folder: Path, host: str | None = None, log: str = "log"
) -> subprocess.Popen[bytes]:
    """Process in the namespace `host` (None: outside both), with cache and output in `folder`."""
    inside = ["ip", "netns", "exec", host] if host else []
    environment = os.environ | {
        "PYTHONPATH": str(ROOT),
        "XDG_CACHE_HOME": str(folder / f"cache-{host}"),
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
    }
    with (folder / f"{log}.txt").open("ab") as output:
        return subprocess.Popen(
            [*inside, sys.executable, "-m", *words],
            env=environment,
            stdout=output,
            stderr=subprocess.STDOUT,
            cwd=folder,
        )


@contextmanager
def dask(folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Context with a scheduler and two workers. Yields the worker of the second host."""
    always = ["--no-dashboard"]
    server = ["distributed.cli.dask_scheduler", "--host", ADDRESSES[FIRST], "--port", "8786"]
    processes = [started([*server, "--no-show", *always], folder, FIRST, "scheduler")]
    for host, address in ADDRESSES.items():
        words = ["distributed.cli.dask_worker", SCHEDULER, "--host", address, "--nthreads", "1"]
        words += ["--no-nanny", "--memory-limit", "0", "--local-directory", str(folder / host)]
        processes.append(started([*words, *always], folder, host, f"worker-{host}"))
    try:
        yield processes[-1]
    finally:
        for process in processes:
            process.kill()
            process.wait()


def run(robot: str, preset: str, folder: Path, name: str, *, killed: bool = False) -> float:
    """Wall time (s) of a run, locally or on the two hosts, into the folder `name`."""
    words = ["validation.cli", "run", robot, "--preset", preset, "--out", name, "--quiet"]
    begun = time.monotonic()
    if name == "local":
        process = started([*words, "--jobs", "1"], folder)
        finish(process, folder)
        return time.monotonic() - begun
    with dask(folder) as second:
        process = started([*words, "--cluster", SCHEDULER], folder, FIRST)
        if killed:
            planned = len(json.loads((folder / "local" / "results.json").read_text())["cases"])
            lines = folder / f"{name}.partial" / "results.jsonl"
            while not lines.exists() or lines.read_bytes().count(b"\n") < planned // 5:
                time.sleep(0.05)
            second.send_signal(signal.SIGKILL)
        finish(process, folder)
    return time.monotonic() - begun


def finish(process: subprocess.Popen[bytes], folder: Path) -> None:
    if process.wait() > 1:
        sys.exit((folder / "log.txt").read_text())


def largest_difference(first: object, second: object) -> float:
    """Largest relative difference of numbers. Infinite if anything else differs."""
    if isinstance(first, dict) and isinstance(second, dict):
        names = (first.keys() | second.keys()) - IGNORED
        return max((largest_difference(first.get(n), second.get(n)) for n in names), default=0.0)
    if isinstance(first, list) and isinstance(second, list) and len(first) == len(second):
        pairs = [pair for pair in zip(first, second, strict=True) if not is_time(pair[0])]
        return max((largest_difference(*pair) for pair in pairs), default=0.0)
    if isinstance(first, float | int) and isinstance(second, float | int):
        if first == second or (math.isnan(first) and math.isnan(second)):
            return 0.0
        return abs(first - second) / max(abs(first), abs(second))
    return 0.0 if first == second else math.inf


def is_time(entry: object) -> bool:
    """True for a curve of measured times, which is no result."""
    return isinstance(entry, dict) and ".seconds." in str(entry.get("id"))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robots", nargs="+", default=["ifw", "delta"])
    parser.add_argument("--preset", default="quick")
    parser.add_argument("--folder", type=Path, help="keep the runs in this new folder")
    options = parser.parse_args()
    print("| robot | run | wall time (s) | largest relative difference |\n|---|---|---|---|")
    with two_hosts(), tempfile.TemporaryDirectory() as temporary:
        for robot in options.robots:
            folder = (options.folder or Path(temporary)).resolve() / robot
            folder.mkdir(parents=True)
            for name in ("local", "two-hosts", "one-killed"):
                seconds = run(robot, options.preset, folder, name, killed=name == "one-killed")
                results, local = (
                    json.loads((folder / run / "results.json").read_text())
                    for run in (name, "local")
                )
                difference = f"{largest_difference(local, results):.1e}"
                print(f"| {robot}, {options.preset} | {name} | {seconds:.0f} | {difference} |")


if __name__ == "__main__":
    main()
