"""Run CalculiX on a deck and read the results that it prints."""

import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fem.calculix.deck import Deck, deck_text
from lumped.arrays import Array
from lumped.errors import ComputationError

PROGRAMS = ("ccx", "ccx_2.20")

_JOB = "deck"
# Fortran omits the E of exponents with three digits.
_NUMBER = re.compile(r"([+-]?\d+\.\d+)E?([+-]\d+)")


class CalculixMissing(Exception):  # noqa: N818  not an error: a comparison that cannot be made here
    """CalculiX is not installed on this machine."""


@dataclass(frozen=True, eq=False)
class CalculixResults:
    """Results of a deck as printed by CalculiX, with seven digits.

    `displacements` (load cases × watched nodes × 3, in m or rad) are rounded by up to 5e-7 of their
    value. `frequencies` (Hz, ascending) follow from printed eigenvalues and are rounded by up to
    2.5e-7 of their value.
    """

    displacements: Array
    frequencies: Array


def calculix_program() -> str:
    """Path of the CalculiX program. Raises CalculixMissing if it is not installed."""
    for name in PROGRAMS:
        path = shutil.which(name)
        if path is not None:
            return path
    raise CalculixMissing(
        f"CalculiX ({' or '.join(PROGRAMS)}) is not installed; on Debian: package calculix-ccx"
    )


@cache
def calculix_version() -> str | None:
    """Version of CalculiX, as printed by the program.

    None if CalculiX is not installed or does not print a version.
    """
    try:
        output = subprocess.run(  # noqa: S603  found on the path, without arguments of others
            [calculix_program(), "-v"], capture_output=True, text=True, timeout=10.0, check=False
        ).stdout
    except (CalculixMissing, OSError, subprocess.TimeoutExpired):
        return None
    match = re.search(r"Version\s+(\S+)", output)
    return match[1] if match else None


def run_calculix(deck: Deck, timeout: float = 600.0) -> CalculixResults:
    """Solve a deck in a temporary folder, with one thread, in at most `timeout` seconds.

    Raises CalculixMissing if CalculiX is not installed, InputError for a deck with elements that
    CalculiX does not have, ComputationError if CalculiX fails or takes too long.
    """
    program = calculix_program()
    with TemporaryDirectory(prefix="calculix-") as folder:
        job = Path(folder) / _JOB
        job.with_suffix(".inp").write_text(deck_text(deck), encoding="ascii", errors="replace")
        output = _run(program, job, deck.title, timeout)
        printed = job.with_suffix(".dat")
        text = printed.read_text(encoding="ascii") if printed.exists() else ""
    try:
        return read_results(text, deck)
    except ComputationError as error:
        last = next((line for line in reversed(output.splitlines()) if line.strip()), "nothing")
        raise ComputationError(f"{error}; its output ends with: {last.strip()}") from None


def _run(program: str, job: Path, title: str, timeout: float) -> str:
    """Run CalculiX on a deck and return its output.

    `job` is the path of the deck without its suffix, `title` the name in messages. Raises
    ComputationError with the first error that CalculiX prints, or if it takes more than `timeout`
    (s).
    """
    thread_variables = ("OMP_NUM_THREADS", "CCX_NPROC_EQUATION_SOLVER", "CCX_NPROC_STIFFNESS")
    environment = os.environ | dict.fromkeys(thread_variables, "1")
    try:
        # The program is found on the search path, and its arguments are not from the user.
        result = subprocess.run(  # noqa: S603
            [program, "-i", job.name],
            cwd=job.parent,
            env=environment,
            timeout=timeout,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise ComputationError(f"{title}: CalculiX took more than {timeout:g} s") from None
    except OSError as error:
        raise ComputationError(f"{title}: CalculiX cannot be started: {error}") from error
    complaint = first_error(result.stdout + result.stderr)
    if complaint is not None:
        raise ComputationError(f"{title}: CalculiX stopped with {complaint}")
    if result.returncode != 0:
        raise ComputationError(f"{title}: CalculiX ended with exit code {result.returncode}")
    return result.stdout


def first_error(output: str) -> str | None:
    """First *ERROR message in the output of CalculiX, with continuation lines.

    None if the output has no such message.
    """
    lines = output.splitlines()
    for start, line in enumerate(lines):
        if line.lstrip().startswith("*ERROR"):
            message = [line.strip()]
            for continuation in lines[start + 1 :]:
                if not continuation.startswith("  ") or not continuation.strip():
                    break
                message.append(continuation.strip())
            return " ".join(message)
    return None


def read_results(printed: str, deck: Deck) -> CalculixResults:
    """Results of a deck from the text of its .dat file.

    Raises ComputationError if results are missing or not finite.
    """
    displacements = _displacements(printed, deck)
    frequencies = _frequencies(printed, deck)
    if not (np.isfinite(displacements).all() and np.isfinite(frequencies).all()):
        raise ComputationError(f"{deck.title}: CalculiX gave results that are not finite")
    return CalculixResults(displacements, frequencies)


def _numbers(line: str) -> list[float]:
    return [float(f"{digits}e{exponent}") for digits, exponent in _NUMBER.findall(line)]


def _displacements(printed: str, deck: Deck) -> Array:
    blocks = re.split(r"^ displacements .*$", printed, flags=re.MULTILINE)[1:]
    cases = len(deck.load_cases)
    if len(blocks) < cases:
        raise ComputationError(
            f"{deck.title}: CalculiX printed {len(blocks)} of {cases} load cases"
        )
    rows = {node + 1: row for row, node in enumerate(deck.watched)}
    displacements = np.full((cases, len(rows), 3), np.nan)
    for case, block in enumerate(blocks[:cases]):
        for line in block.splitlines():
            number, values = line.split()[:1], _numbers(line)
            if len(values) == 3 and number[0].isdigit() and int(number[0]) in rows:
                displacements[case, rows[int(number[0])]] = values
    return displacements


def _frequencies(printed: str, deck: Deck) -> Array:
    """Frequencies (Hz) √λ/2π from the printed eigenvalues λ (rad²/s²)."""
    _, _, after = printed.partition("E I G E N V A L U E   O U T P U T")
    table, _, _ = after.partition("P A R T I C I P A T I O N")
    eigenvalues = [row[0] for row in map(_numbers, table.splitlines()) if len(row) == 4]
    if len(eigenvalues) < deck.modes:
        raise ComputationError(
            f"{deck.title}: CalculiX printed {len(eigenvalues)} of {deck.modes} frequencies"
        )
    with np.errstate(invalid="ignore"):
        return np.asarray(np.sqrt(eigenvalues[: deck.modes]) / (2.0 * np.pi))
