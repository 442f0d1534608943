"""Write docs/guide/verification.md: published numbers beside those of this program.

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
sys.path.insert(0, str(ROOT / "tests"))

from support.oracles import further_benchmarks  # noqa: E402

from validation.selftest.benchmarks import (  # noqa: E402
    Benchmark,
    BenchmarkOutcome,
    KnownNumber,
    benchmarks,
    outcome,
)

PAGE = ROOT / "docs" / "guide" / "verification.md"
HEAD = """After this page you can see how far flexproof is from published values, closed formulas
and other programs, and repeat these numbers.

`flexproof selftest` solves the first {own} problems on your machine. The tests solve all. The
numbers below are those with the libraries that `requirements.lock` names.

- **known**: value of the source.
- **difference**: (flexproof − known)/known. If it is below 1e-6, the table has the word rounding.
- **explained**: known difference between the two theories, computed independently.
- **allowed**: largest accepted remainder, which is the difference minus its explained part.

The tables are written by `docs/pictures/verification.py` from the benchmarks in
`validation/selftest` and `tests/support/oracles/further_benchmarks.py`.
"""
FOOT = """**Next:** [Comparisons of a run](cases.md) lists the checks of your own robot.
[Known values](known-values.md) has further numbers for the built-in robot.
"""
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
        *map(_row, found.numbers),
        "",
        fill(f"Known from: {benchmark.source}.", WIDTH),
        "",
        fill(f"Allowed: {benchmark.tolerance_reason}.", WIDTH),
    ]
    return "\n".join(lines) + "\n"


def head() -> str:
    """The page's first lines."""
    return f"# Verification\n\n{HEAD.format(own=len(listed()[0]))}"


def page(outcomes: Sequence[BenchmarkOutcome]) -> str:
    """The whole page."""
    sections = [section(number, found) for number, found in enumerate(outcomes, start=1)]
    return "\n".join([head(), *sections, FOOT])


def _row(one: KnownNumber) -> str:
    unit = "" if one.unit == "1" else f" {one.unit}"
    cells = (
        one.quantity,
        f"{one.known:.6g}{unit}",
        f"{one.computed:.6g}{unit}",
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
