"""Runs of `flexproof` on the catalogues of toy_catalogue, in this and in other processes."""

import json
import os
import pty
import select
import subprocess
import sys
import time
from pathlib import Path

from validation.record_fields import plain_data
from validation.run.runner import execute

HERE = Path(__file__).parent
ENVIRONMENT = os.environ | {
    "PYTHONPATH": os.pathsep.join([str(HERE.parents[2]), str(HERE.parents[1])]),
    "OMP_NUM_THREADS": "1",
}
# How long (s) to wait for what should take two: the machine may be busy with other work. The
# endless catalogue would take longer.
PATIENCE = 30.0
# The command line with the function of toy_catalogue that its first argument names.
PROGRAM = """
import sys
from types import SimpleNamespace
from support.fakes import toy_catalogue
from validation.cli import main
catalogue = getattr(toy_catalogue, sys.argv[1])
sys.modules["validation.catalogue"] = SimpleNamespace(catalogue=catalogue)
sys.exit(main(sys.argv[2:]))
"""


def command(catalogue, *arguments):
    return [sys.executable, "-c", PROGRAM, catalogue, *map(str, arguments)]


def started(line):
    """Start the `flexproof` command `line` as a process in a new session."""
    return subprocess.Popen(
        line,
        env=ENVIRONMENT,
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


def run_on_terminal(arguments, environment, *, pressed):
    """Run a process on a new terminal. Return its exit code and the text on the screen.

    Ctrl-C is sent once `pressed(screen)` is true.
    """
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


def refusing(number):
    """Function that raises the error `number` of the operating system for any arguments."""

    def refuse(*_arguments, **_named):
        raise OSError(number, os.strerror(number))

    return refuse


def partial(path):
    """Folder of the incomplete run that becomes `path` when it is complete."""
    return path.with_name(f"{path.name}.partial")


def lines(path):
    """Lines of the finished results of a complete or an incomplete run."""
    files = [folder / "results.jsonl" for folder in (partial(path), path)]
    file = next((file for file in files if file.exists()), None)
    return file.read_bytes().splitlines() if file else []


def content(path):
    """Contents of the files in a folder by relative path, except locks."""
    files = (file for file in path.rglob("*") if file.is_file() and file.name != ".lock")
    return {str(file.relative_to(path)): file.read_bytes() for file in files}


def numbers(path):
    """Cases and studies of a run, without times and notes, which contain process numbers."""
    record = json.loads((path / "results.json").read_text())
    for entry in record["cases"]:
        del entry["seconds"], entry["notes"]
    return record["cases"], record["studies"]


def run_in_this_process(_catalogue, context, tasks, *, keep, progress, **_):
    """Replacement of runner.run that computes in this process, for tests not about workers."""
    for task in tasks:
        progress.started(task)
        keep(record := plain_data(execute(task, context)))
        progress.finished(task, record)
