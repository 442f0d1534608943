"""Whatever is typed, in whatever files: an exit code that says what it was, and lines in words."""

import os
import re
import shutil
import subprocess
import sys
import warnings
from collections import Counter
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from time import perf_counter

import pytest
from random_commands import random_commands

from validation import cli

ROOT = Path(__file__).parents[3]
PROGRAM = "import sys; from validation.cli import main; sys.exit(main())"
# Of so many commands one is a process of its own.
APART = 75
# Seconds that a command may take, and MB that it may add to what the process has.
LONGEST, LARGEST = 60.0, 500.0
# One of what there are several of: nouns of this program.
ONE_OF_SEVERAL = re.compile(
    r"(?<![\w.,:/+-])1 (?:bodies|joints|poses|points|numbers|modes|faces|elements|nodes|cases"
    r"|robots|faults|doubts|constraints|entries|interfaces|verdicts|comparisons|motions|meshes)\b"
)


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
    lines, several = err.splitlines(), ONE_OF_SEVERAL.search(out + err)
    wrong = {
        f"exit code {code}": code not in {0, 1, 2, 3},
        "a traceback": "Traceback" in out + err or "fault of flexproof itself" in err,
        "lines of somebody else's": not all(
            line.startswith("flexproof: ") and line.isprintable() for line in lines
        ),
        "many or long lines": len(lines) > 50 or any(len(line) > 600 for line in lines),
        f"one of several: {several}": several is not None,
        "refused with results, or without a reason": code == 2 and (out or not lines),
    }
    return next((reason for reason, found in wrong.items() if found), "")


def peak(*, anew=False):
    """Most memory (MB) that this process has had since this was asked for `anew`."""
    if anew:
        Path("/proc/self/clear_refs").write_text("5")
    (kilobytes,) = re.findall(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())
    return int(kilobytes) / 1e3


@pytest.mark.parametrize(
    ("seed", "count"),
    [
        (30, 150),
        pytest.param(29, 350, marks=pytest.mark.exhaustive),
        *(pytest.param(seed, 500, marks=pytest.mark.soak) for seed in range(31, 41)),
    ],
)
def test_no_input_ends_in_a_fault_of_flexproof(seed, count, tmp_path, monkeypatch, capfd):
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    outcomes, wrong, slowest, largest = Counter(), [], (0.0, ""), (0.0, "")
    for number, command in enumerate(random_commands(count, seed)):
        laid_out(command, folder)
        os.chdir(folder)
        before, begun = peak(anew=True), perf_counter()
        in_process = number % APART < APART - 1
        code, out, err = here(command, capfd) if in_process else apart(command, folder)
        said = " ".join(word[:60] for word in command.words)
        slowest = max(slowest, (perf_counter() - begun, said))
        largest = max(largest, (peak() - before, said))
        outcomes[command.words[0], code] += 1
        if reason := amiss(code, out, err):
            wrong.append(f"{number}: {said}: {reason}: {err[-600:]}")
    # Commands of their own, and processes that read parts.
    of_others = getrusage(RUSAGE_CHILDREN).ru_maxrss / 1e3
    with capfd.disabled():
        table = ", ".join(f"{name} {code}: {n}" for (name, code), n in sorted(outcomes.items()))
        sys.stderr.write(
            f"\n{table}\nslowest {slowest[0]:.1f} s: {slowest[1]}\nlargest {largest[0]:.0f} MB "
            f"more: {largest[1]}\nlargest process of its own {of_others:.0f} MB\n"
        )
    assert not wrong, "\n\n".join(wrong[:20])
    assert {code for _, code in outcomes} >= {0, 2}
    assert slowest[0] <= LONGEST, slowest
    assert largest[0] <= LARGEST, largest
