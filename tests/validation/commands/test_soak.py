"""Whatever is typed, in whatever files: an exit code that says what it was, and lines in words."""

import os
import shutil
import subprocess
import sys
import warnings
from collections import Counter
from pathlib import Path
from time import perf_counter

import pytest
from random_commands import random_commands

from validation import cli

ROOT = Path(__file__).parents[3]
PROGRAM = "import sys; from validation.cli import main; sys.exit(main())"
SEED = 30
# Of so many commands one is a process of its own.
APART = 250


def laid_out(command, folder):
    shutil.rmtree(folder, ignore_errors=True)
    for name, content in command.files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


def here(command, capfd):
    """Exit code, stdout and stderr, with what numpy would have warned of on it."""
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        code = cli.main(command.words)
    printed = capfd.readouterr()
    return code, printed.out, printed.err + "".join(f"{one.message}\n" for one in warned)


def apart(command, folder):
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *command.words],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    return done.returncode, done.stdout, done.stderr


def amiss(code, out, err):
    """What is wrong with an outcome; "" if nothing is."""
    lines = err.splitlines()
    if code not in {0, 1, 2, 3}:
        return f"exit code {code}"
    if "Traceback" in out + err or "fault of flexproof itself" in err:
        return "a traceback"
    if not all(line.startswith("flexproof: ") and line.isprintable() for line in lines):
        return "lines of somebody else's"
    if len(lines) > 50 or any(len(line) > 600 for line in lines):
        return "many or long lines"
    if code == 2 and (out or not lines):
        return "refused with results, or without a reason"
    return ""


@pytest.mark.parametrize("count", [500, pytest.param(5000, marks=pytest.mark.soak)])
def test_no_input_ends_in_a_fault_of_flexproof(count, tmp_path, monkeypatch, capfd):
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    outcomes, wrong, slowest = Counter(), [], (0.0, "")
    for number, command in enumerate(random_commands(count, SEED)):
        laid_out(command, folder)
        os.chdir(folder)
        begun = perf_counter()
        in_process = number % APART < APART - 1
        code, out, err = here(command, capfd) if in_process else apart(command, folder)
        said = " ".join(word[:60] for word in command.words)
        slowest = max(slowest, (perf_counter() - begun, said))
        outcomes[command.words[0], code] += 1
        if reason := amiss(code, out, err):
            wrong.append(f"{number}: {said}: {reason}: {err[-600:]}")
    with capfd.disabled():
        table = ", ".join(f"{name} {code}: {n}" for (name, code), n in sorted(outcomes.items()))
        sys.stderr.write(f"\n{table}\nslowest {slowest[0]:.1f} s: {slowest[1]}\n")
    assert not wrong, "\n\n".join(wrong[:20])
    assert {code for _, code in outcomes} >= {0, 1, 2}
