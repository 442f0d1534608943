"""Writes docs/guide/verification.md: published numbers beside those of this program.

    python docs/pictures/verification.py

The benchmarks are those of `flexproof selftest` and, behind them, those of the tests alone. A test
says when the page is old. CalculiX and EXUDYN must be installed.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from textwrap import fill

ROOT = Path(__file__).resolve().parents[2]
# Where the tests find what they share.
sys.path.insert(0, str(ROOT / "tests" / "helpers" / "plain"))

import further_benchmarks  # noqa: E402

from validation.selftest.benchmarks import (  # noqa: E402
    Benchmark,
    BenchmarkOutcome,
    KnownNumber,
    benchmarks,
    outcome,
)

PAGE = ROOT / "docs" / "guide" / "verification.md"
HEAD = (
    "Problems whose answers stand in the literature, follow from a formula or come from another "
    "program, and what flexproof answers, with the libraries that `requirements.lock` names. "
    "`flexproof selftest` solves the first {own} on your machine, tests solve all. Differences are "
    "relative; *explained* is what the two theories are known to differ by, computed on its own, "
    "and the rest must be within what is *allowed*. The page is written by "
    "docs/pictures/verification.py from the benchmarks' own tables, validation/selftest and "
    "tests/helpers/plain/further_benchmarks.py."
)
# Differences below this are left to rounding, which is another on every machine.
ROUNDING = 1e-6
# Letters of a line of the page.
WIDTH = 150


def listed() -> tuple[tuple[Benchmark, ...], tuple[Benchmark, ...]]:
    """The benchmarks of the self-test, and those of the tests alone."""
    return benchmarks(), further_benchmarks.benchmarks()


def section(number: int, found: BenchmarkOutcome) -> str:
    """A benchmark's part of the page."""
    benchmark = found.benchmark
    lines = [
        f"## {number}. {benchmark.title}",
        "",
        fill(benchmark.problem, WIDTH),
        "",
        "| quantity | known | flexproof | difference | explained | allowed |",
        "|---|---|---|---|---|---|",
        *map(_row, found.compared),
        "",
        fill(f"Known from: {benchmark.source}.", WIDTH),
        "",
        fill(f"Allowed: {benchmark.tolerance_reason}.", WIDTH),
    ]
    return "\n".join(lines) + "\n"


def head() -> str:
    """The page's first lines."""
    return f"# Verification\n\n{fill(HEAD.format(own=len(listed()[0])), WIDTH)}\n"


def page(outcomes: Sequence[BenchmarkOutcome]) -> str:
    """The whole page."""
    sections = [section(number, found) for number, found in enumerate(outcomes, start=1)]
    return "\n".join([head(), *sections])


def _row(one: KnownNumber) -> str:
    unit = "" if one.unit == "1" else f" {one.unit}"
    cells = (
        one.quantity,
        f"{one.known:.6g}{unit}",
        f"{one.ours:.6g}{unit}",
        _share(one.difference),
        _share(one.explained) if one.explained else "",
        f"{one.tolerance:.1g}",
    )
    return f"| {' | '.join(cells)} |"


def _share(difference: float) -> str:
    return f"{difference:+.1e}" if abs(difference) >= ROUNDING else "rounding"


if __name__ == "__main__":
    outcomes = [outcome(one) for group in listed() for one in group]
    missing = [f"{one.benchmark.title}: {one.message}" for one in outcomes if one.message]
    if missing:
        sys.exit("\n".join(missing))
    PAGE.write_text(page(outcomes), encoding="utf-8")
