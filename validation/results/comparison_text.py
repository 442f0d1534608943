"""A comparison of two runs as text: plain tables that any terminal, pager and mail can show."""

from collections.abc import Sequence

from lumped.text import counted
from validation.results.compare import AdequacyChange, Judged, RunComparison, Timing
from validation.results.records import RunRecord

# How many cases the text lists by the change of their time; --json has all of them.
_SLOWEST = 10


def as_text(before: RunRecord, after: RunRecord, comparison: RunComparison) -> str:
    """What changed, the gravest first."""
    blocks = [_heads(before, after, comparison), sentence(comparison)]
    if comparison.inputs and not comparison.different_robots:
        blocks.append("The input differs: two robots, whose numbers may differ without any drift.")
        blocks += _block(
            "Input",
            ["key", "before", "after"],
            [[c.key, _given(c.before), _given(c.after)] for c in comparison.inputs],
        )
    blocks += _block(
        "Adequacy",
        ["model", "quantity", "before", "", "after", ""],
        [
            [c.model, c.quantity, *_judged(c.before), *_judged(c.after)]
            for c in comparison.adequacy
            # All of different inputs; of the same input what changed its verdict.
            if comparison.inputs or comparison.different_robots or _rejudged(c)
        ],
    )
    worst_first = sorted(comparison.verdicts, key=lambda change: not change.worse)
    blocks += _block(
        "Verdicts that changed",
        ["", "before", "after", "case"],
        [["worse" if c.worse else "", c.before, c.after, c.id] for c in worst_first],
    )
    numbers = "{0.before:.10g} {0.after:.10g} {0.drift:+.2g} {0.allowed:.2g}"
    blocks += _block(
        "Drifted beyond their uncertainty",
        ["before", "after", "drift", "allowed", "unit", "", "case"],
        [[*numbers.format(d).split(), d.unit, d.what, d.id] for d in comparison.drifted],
    )
    blocks += _block("New cases", ["case"], [[identifier] for identifier in comparison.new])
    blocks += _block("Removed cases", ["case"], [[identifier] for identifier in comparison.removed])
    if comparison.seconds:
        blocks.append(_times(comparison.seconds))
    return "\n\n".join(blocks)


def _heads(before: RunRecord, after: RunRecord, comparison: RunComparison) -> str:
    told = ("robot", "preset", "started")
    rows = [
        [name, *(str(run.run.get(key, "?")) for key in told), counted(len(run.cases), "case")]
        for name, run in (("before", before), ("after", after))
    ]
    differs = [name.replace("_", " ") for name in comparison.differs]
    note = f"\nThe runs differ in {', '.join(differs)}." if differs else ""
    return table(["", "robot", "preset", "started", ""], rows) + note


def _given(value: object) -> str:
    return "not given" if value is None else str(value)


def _judged(entry: Judged | None) -> list[str]:
    if entry is None:
        return ["", ""]
    if entry.error is None:
        return ["", entry.verdict]
    # The error of a whole displacement has no sign; its part along the load has.
    sign = "" if entry.along is not None else "+"
    along = "" if entry.along is None else f" ({100.0 * entry.along:+.2f} % along)"
    return [f"{100.0 * entry.error:{sign}.2f} %{along}", entry.verdict]


def _rejudged(change: AdequacyChange) -> bool:
    before, after = change.before, change.after
    return before is None or after is None or before.verdict != after.verdict


def sentence(comparison: RunComparison) -> str:
    """What changed, counted; of two different robots, that nothing can be."""
    if comparison.different_robots:
        first, second = comparison.different_robots
        return (
            f"Two different robots, {first} and {second}: none of their cases is better or worse, "
            "and only the adequacy of their models stands side by side."
        )
    worse = sum(change.worse for change in comparison.verdicts)
    drifted = len({entry.id for entry in comparison.drifted})
    parts = [
        f"{counted(worse, 'verdict')} worse",
        f"{len(comparison.verdicts) - worse} better",
        f"{counted(drifted, 'case')} drifted",
        f"{len(comparison.new)} new",
        f"{len(comparison.removed)} removed",
    ]
    return ", ".join(parts) + "."


def _times(times: Sequence[Timing]) -> str:
    foremost = sorted(times, key=lambda timing: -abs(timing.after - timing.before))[:_SLOWEST]
    total = Timing("all", sum(t.before for t in times), sum(t.after for t in times))
    rows = [
        [f"{t.before:.2f}", f"{t.after:.2f}", f"{t.after - t.before:+.2f}", t.id]
        for t in (*foremost, total)
    ]
    heading = "Time per case (s)"
    if len(times) > len(foremost):
        heading += f", the {len(foremost)} of {len(times)} that changed most"
    return "\n".join(_block(heading, ["before", "after", "change", "case"], rows))


def _block(heading: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [f"{heading}\n{table(columns, rows)}"] if rows else []


def table(columns: Sequence[str], rows: Sequence[Sequence[str]], indent: str = "  ") -> str:
    """Columns set off by two blanks; numbers to the right, texts to the left."""
    lines = [list(columns), *[list(row) for row in rows]]
    widths = [max(len(line[k]) for line in lines) for k in range(len(columns))]
    numeric = [all(_is_number(row[k]) for row in rows) for k in range(len(columns))]
    return "\n".join(
        indent
        + "  ".join(
            entry.rjust(width) if right else entry.ljust(width)
            for entry, width, right in zip(line, widths, numeric, strict=True)
        ).rstrip()
        for line in lines
    )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
