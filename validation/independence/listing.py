"""The comparisons of every headline number by what their two sides rest on, as rows and as text."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from validation.independence.headlines import HeadlineNumber
from validation.independence.trace import BASICS, Independence, is_basic

SECTION = "Independence"
NOTHING = "nothing"
_UNCOMPARED = "no comparison"
_UNTOLD = "not told: one number holds both sides"
_BY_HAND = "closed forms of the comparison itself"


@dataclass(frozen=True)
class Row:
    """Comparisons of one number that rest on the same: value, reference, both (modules)."""

    shown: str
    number: str
    comparisons: str
    value: str
    reference: str
    shared: str

    @property
    def independent(self) -> bool:
        """Whether the two sides share nothing."""
        return self.shared == NOTHING


def rows(numbers: Sequence[HeadlineNumber], found: Sequence[Independence]) -> tuple[Row, ...]:
    """Number by number, what is independent first."""
    listed = []
    for number in numbers:
        own = [one for one in found if number.is_compared_by(one.case)]
        alike: dict[tuple[str, str, str], list[str]] = {}
        for one in own:
            alike.setdefault(_sides(one), []).append(one.case.id)
        made = [
            Row(number.shown, number.number, _told(ids), *sides) for sides, ids in alike.items()
        ]
        missing = Row(number.shown, number.number, _UNCOMPARED, "", "", _UNCOMPARED)
        listed += sorted(made, key=lambda row: not row.independent) or [missing]
    return tuple(listed)


def without(
    numbers: Sequence[HeadlineNumber], found: Sequence[Independence]
) -> tuple[HeadlineNumber, ...]:
    """Headline numbers that no independent comparison is about."""
    good = [one.case for one in found if one.independent]
    return tuple(n for n in numbers if not any(n.is_compared_by(case) for case in good))


_HEADINGS = {
    "shown": "shown",
    "number": "number",
    "comparisons": "compared by",
    "value": "value rests on",
    "reference": "reference rests on",
    "shared": "both rest on",
}


def as_table(listed: Sequence[Row]) -> dict[str, tuple[str, ...]]:
    """The rows as columns by heading."""
    return {
        heading: tuple(getattr(row, name) for row in listed) for name, heading in _HEADINGS.items()
    }


def from_table(columns: Mapping[str, Sequence[float | str]]) -> tuple[Row, ...]:
    """The rows of such columns."""
    texts = ([str(entry) for entry in columns.get(h, ())] for h in _HEADINGS.values())
    return tuple(Row(*row) for row in zip(*texts, strict=True))


def as_text(listed: Sequence[Row], wanting: Sequence[HeadlineNumber]) -> str:
    """A paragraph for each number, and which have no independent comparison."""
    lines: list[str] = []
    before = ""
    for row in listed:
        if (head := f"{row.number} ({row.shown})") != before:
            lines += ["", head]
            before = head
        lines += [
            f"  {'✓' if row.independent else '–'} {row.comparisons}",
            f"      value rests on      {row.value}",
            f"      reference rests on  {row.reference}",
            f"      both rest on        {row.shared}",
        ]
    basics = ", ".join(f"{module} ({what})" for module, what in BASICS.items())
    names = "; ".join(f"{one.number} ({one.shown})" for one in wanting) or "none"
    last = ["", f"without an independent comparison: {names}", "", f"named basics: {basics}"]
    return "\n".join([*lines[1:], *last])


def _told(ids: Sequence[str]) -> str:
    return ids[0] if len(ids) == 1 else f"{ids[0]} and {len(ids) - 1} more"


def _sides(one: Independence) -> tuple[str, str, str]:
    if not (one.value and one.reference):
        return _modules(one.value | one.reference), "", _UNTOLD
    return (
        _modules(one.value - one.reference),
        _modules(one.reference - one.value),
        _modules(one.shared, NOTHING),
    )


def _modules(functions: frozenset[str], none: str = _BY_HAND) -> str:
    own = {one.partition(":")[0] for one in functions if not is_basic(one)}
    return ", ".join(sorted(own)) or none
