"""`flexproof` on catalogues of toy_catalogue, in processes of their own."""

import json
import os
import pty
import select
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


def on_terminal(arguments, environment, *, pressed):
    """Exit code and screen of a process on a terminal of its own, Ctrl-C once `pressed(screen)`."""
    process, terminal = pty.fork()
    if process == 0:
        os.execve(arguments[0], arguments, environment | {"TERM": "xterm"})  # noqa: S606
    screen, interrupted, begun = b"", False, time.monotonic()
    while time.monotonic() - begun < 2.0 * PATIENCE:
        if select.select([terminal], [], [], 0.05)[0]:
            try:
                screen += os.read(terminal, 65536)
            except OSError:
                break
        if not interrupted and pressed(screen.decode(errors="replace")):
            # As under a shell, the terminal sends it to all processes in front.
            os.write(terminal, b"\x03")
            interrupted = True
    os.close(terminal)
    _, status = os.waitpid(process, 0)
    assert interrupted, screen.decode(errors="replace")
    return os.waitstatus_to_exitcode(status), screen.decode(errors="replace")


def partial(path):
    """Where a run is written that is not whole yet."""
    return path.with_name(f"{path.name}.partial")


def lines(path):
    """The lines of what a run has finished, in its folder or where it is written."""
    files = [folder / "results.jsonl" for folder in (partial(path), path)]
    file = next((file for file in files if file.exists()), None)
    return file.read_bytes().splitlines() if file else []


def content(*folders):
    """What folders hold, by name, but for locks."""
    return {
        str(file.relative_to(path)): file.read_bytes()
        for path in folders
        for file in path.rglob("*")
        if file.is_file() and file.name != ".lock"
    }


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
