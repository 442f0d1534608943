"""`flexproof` on catalogues of toy_catalogue, in processes of their own."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

from validation.results.outcome import plain
from validation.session.runner import execute

HERE = Path(__file__).parent
ENVIRONMENT = os.environ | {
    "PYTHONPATH": os.pathsep.join([str(HERE.parents[2]), str(HERE)]),
    "OMP_NUM_THREADS": "1",
}
# How long (s) to wait for what should take two: the machine may be busy with other work. The
# endless catalogue would take longer.
PATIENCE = 30.0


def command(catalogue, *arguments):
    program = str(HERE / "command_line.py")
    return [sys.executable, program, catalogue, *(str(argument) for argument in arguments)]


def started(line, **changes):
    """A process in a session of its own; `changes` are those of the environment."""
    return subprocess.Popen(
        line,
        env=ENVIRONMENT | changes,
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def completed(catalogue, *arguments):
    line = command(catalogue, *arguments)
    return subprocess.run(line, env=ENVIRONMENT, capture_output=True, text=True, check=False)


def wait_for(condition):
    begun = time.monotonic()
    while not condition():
        assert time.monotonic() - begun < PATIENCE
        time.sleep(0.02)


def partial(path):
    """Where a run is written that is not whole yet."""
    return path.with_name(f"{path.name}.partial")


def lines(path):
    """The lines of what a run has finished, in its folder or where it is written."""
    files = [folder / "results.jsonl" for folder in (partial(path), path)]
    file = next((file for file in files if file.exists()), None)
    return file.read_bytes().splitlines() if file else []


def run_here(_catalogue, context, tasks, *, keep, progress, **_):
    """In place of runner.run, where workers are not what is tested: in this process."""
    for task in tasks:
        progress.started(task)
        keep(record := plain(execute(task, context)))
        progress.finished(task, record)


def numbers(path):
    """The cases and studies of a run, but for times, and process numbers in notes."""
    content = json.loads((path / "results.json").read_text())
    for entry in content["cases"]:
        del entry["seconds"], entry["notes"]
    return content["cases"], content["studies"]
