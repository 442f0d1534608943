"""Random commands and files: each ends with a documented exit code and readable lines."""

import os
import re
import shutil
import warnings
from collections import Counter
from resource import RUSAGE_SELF, getrusage
from time import perf_counter

import pytest
from support.random.random_commands import random_commands

from validation import cli

# Seconds that a command may take, and MB that all may add to what the process has.
LONGEST, LARGEST = 60.0, 500.0
# One of what there are several of: nouns of this program.
ONE_OF_SEVERAL = re.compile(
    r"(?<![\w.,:/+-])1 (?:bodies|joints|poses|points|numbers|modes|faces|elements|nodes|cases"
    r"|robots|faults|doubts|constraints|entries|interfaces|verdicts|comparisons|motions|meshes)\b"
)


def outcome(command, folder, capfd):
    """Exit code, stdout and stderr of a command, with warnings of numpy added to stderr."""
    shutil.rmtree(folder, ignore_errors=True)
    for name, content in command.files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    os.chdir(folder)
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        code = cli.main(command.words)
    printed = capfd.readouterr()
    return code, printed.out, printed.err + "".join(f"{warning.message}\n" for warning in warned)


def amiss(code, out, err):
    """Faults of a command with exit code `code`, stdout `out` and stderr `err`."""
    lines, several = err.splitlines(), ONE_OF_SEVERAL.search(out + err)
    ours = all(line.startswith("flexproof: ") and line.isprintable() for line in lines)
    wrong = {
        f"exit code {code}": code not in {0, 1, 2, 3},
        "a traceback": "Traceback" in out + err or "error in flexproof itself" in err,
        "lines of somebody else's": not ours,
        "many or long lines": len(lines) > 50 or any(len(line) > 600 for line in lines),
        f"one of several: {several}": several is not None,
        "refused with results, or without a reason": code == 2 and (out or not lines),
    }
    return [reason for reason, applies in wrong.items() if applies]


@pytest.mark.parametrize(
    ("seed", "count"),
    [
        (30, 60),
        pytest.param(29, 150, marks=pytest.mark.exhaustive),
        *(pytest.param(seed, 500, marks=pytest.mark.soak) for seed in range(31, 41)),
    ],
)
def test_random_input_causes_no_program_error(seed, count, tmp_path, monkeypatch, capfd):
    """Each random command ends with a documented exit code, within limits of time and memory."""
    monkeypatch.chdir(tmp_path)
    codes, wrong, before = Counter(), [], getrusage(RUSAGE_SELF).ru_maxrss
    for command in random_commands(count, seed):
        begun = perf_counter()
        code, out, err = outcome(command, tmp_path / "here", capfd)
        codes[code] += 1
        reasons, seconds = amiss(code, out, err), perf_counter() - begun
        if reasons or seconds > LONGEST:
            command_text = " ".join(word[:60] for word in command.words)
            wrong.append(f"{command_text} ({seconds:.1f} s): {reasons}: {err[-600:]}")
    assert not wrong, "\n\n".join(wrong[:20])
    assert codes.keys() >= {0, 2}
    assert (getrusage(RUSAGE_SELF).ru_maxrss - before) / 1e3 <= LARGEST
