"""The matrix of adequacy in one sentence, by rules: what holds, what does not and by how much.

Models of which the same is to be said share a clause. What holds comes first, then what is off,
the least first, then what a model does not know at all and what could not be judged.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from validation.adequacy.matrix import Entry, Matrix
from validation.drawing.text import number
from validation.report.first_screen.deflections import (
    ABSENT,
    OFF,
    how_much,
    kind_of_deflection,
    said_of_deflections,
)
from validation.report.first_screen.words import (
    at_most,
    capital,
    is_rotation,
    is_static,
    listed,
    place_of,
    subject,
)

# What holds to a thousandth simply holds.
_WORTH_SAYING = 1e-3


@dataclass(frozen=True)
class _Opinion:
    """What is to be said of a model in statics or dynamics: quantities by kind of verdict."""

    model: str
    entries: tuple[Entry, ...]

    def those(self, *kinds: str) -> tuple[Entry, ...]:
        return tuple(entry for entry in self.entries if _kind(entry) in kinds)

    @property
    def key(self) -> tuple[tuple[str, str], ...]:
        return tuple((entry.quantity, _kind(entry)) for entry in self.entries)

    @property
    def size(self) -> float:
        """Larger for what is worse."""
        if self.those("absent"):
            return 1e9
        off = [abs(entry.error or 0.0) for entry in self.entries if entry.verdict == "inadequate"]
        return max(off) if off else 1e8 if self.those("undecided") else 0.0


def sentence(matrix: Matrix) -> str:
    """The verdict of the matrix, one sentence."""
    static = _clauses(matrix, is_static, partial(_static_predicate, matrix))
    dynamic = _clauses(matrix, lambda quantity: not is_static(quantity), _dynamic_predicate)
    decided = [e for e in matrix.entries if not is_static(e.quantity) and e.verdict != "undecided"]
    if matrix.supposed and decided:
        dynamic[-1] += f" ({matrix.supposed})"
    said = "; ".join([*static, *_formulation(matrix), *dynamic])
    return f"{capital(said)}." if said else "No model could be judged."


def _formulation(matrix: Matrix) -> list[str]:
    """Which models fail by their legs alone: adequate against solids of the legs they model."""
    if matrix.formulation is None:
        return []
    others = [note.model for note in matrix.formulation.models]
    found = {
        model: entries
        for model in others
        if (entries := _off_by_their_legs(matrix, matrix.formulation, model))
        and all(entry.verdict == "adequate" for entry in entries)
    }
    if not found:
        return []
    moved, turned = (
        [
            abs(entry.error or 0.0) + (entry.uncertainty or 0.0)
            for entries in found.values()
            for entry in entries
            if is_rotation(entry.quantity) == rotation
        ]
        for rotation in (False, True)
    )
    within = at_most(max(moved or turned))
    if not moved:
        within += " in rotation"
    elif turned:
        within += f" ({at_most(max(turned))} in rotation)"
    who, singular = subject(list(found))
    who = "all models on equivalent legs" if len(found) == len(others) > 1 else who
    return [
        f"{who} {'is' if singular else 'are'} within {within} of solids of the same "
        "equivalent legs: the formulation holds, the idealisation of the legs does not"
    ]


def _off_by_their_legs(matrix: Matrix, formulation: Matrix, model: str) -> list[Entry]:
    """Entries of the formulation where the model is inadequate for the robot."""
    return [
        entry
        for entry in formulation.of_model(model)
        if (total := matrix.entry(model, entry.quantity)) and total.verdict == "inadequate"
    ]


def _kind(entry: Entry) -> str:
    if entry.verdict != "inadequate":
        return entry.verdict
    if is_static(entry.quantity):
        return kind_of_deflection(entry)
    if entry.error is None:
        return "absent"
    if entry.error < -1.0 - ABSENT:
        return "opposite"
    return "low" if entry.error < 0.0 else "high"


def _clauses(
    matrix: Matrix,
    wanted: Callable[[str], bool],
    predicate: Callable[[Sequence[_Opinion], bool], str],
) -> list[str]:
    """What is said of the `wanted` quantities."""
    opinions = []
    for note in matrix.models:
        entries = tuple(e for e in matrix.of_model(note.model) if wanted(e.quantity))
        if entries:
            opinions.append(_Opinion(note.model, entries))
    unjudged = _nothing_known(opinions)
    if unjudged:
        return [unjudged]
    groups: dict[tuple[tuple[str, str], ...], list[_Opinion]] = {}
    for opinion in sorted(opinions, key=lambda opinion: opinion.size):
        groups.setdefault(opinion.key, []).append(opinion)
    said = []
    order = [note.model for note in matrix.models]
    for group in groups.values():
        models = sorted((opinion.model for opinion in group), key=order.index)
        who, singular = subject(models)
        said.append(f"{who} {predicate(group, singular)}")
    return said


def _nothing_known(opinions: Sequence[_Opinion]) -> str:
    """The clause where nothing that any model has could be decided, for one and the same reason."""
    entries = [
        entry
        for opinion in opinions
        for entry in opinion.entries
        if entry.quantity != "order" and _kind(entry) != "absent"
    ]
    reasons = {entry.reason for entry in entries}
    if not entries or len(reasons) > 1 or any(e.verdict != "undecided" for e in entries):
        return ""
    what = "deflections" if is_static(entries[0].quantity) else "frequencies"
    return f"{what} cannot be judged" + (f": {reasons.pop()}" if any(reasons) else "")


def _static_predicate(
    matrix: Matrix,
    group: Sequence[_Opinion],
    singular: bool,  # noqa: FBT001  grammar
) -> str:
    off = [entry for opinion in group for entry in opinion.those(*OFF)]
    whole = [entry.quantity for entry in group[0].entries if _kind(entry) != "absent"]
    said = said_of_deflections(matrix, off, whole, singular=singular)
    return _rounded_off(group, said, "deflections", singular)


def _dynamic_predicate(group: Sequence[_Opinion], singular: bool) -> str:  # noqa: FBT001  grammar
    gives = "gives" if singular else "give"
    said = []
    for kind, how in (("low", "too low"), ("high", "too high")):
        found = [
            entry for opinion in group for entry in opinion.those(kind) if entry.quantity != "order"
        ]
        if found:
            names = place_of(dict.fromkeys(entry.quantity for entry in found))
            said.append(
                f"{gives} {names} {how_much([entry.error or 0.0 for entry in found])} {how}"
            )
    turned = [entry.quantity for entry in group[0].those("opposite")]
    if turned:
        said.append(f"{gives} {place_of(turned)} the other sign")
    lacking = [entry for entry in group[0].those("absent") if entry.quantity != "order"]
    if lacking:
        lack = "lacks" if singular else "lack"
        said.append(f"{lack} the modes of {place_of(e.quantity for e in lacking)}")
    has = "has" if singular else "have"
    said += [
        f"{has} the modes in another order{_misled(entry)}"
        for entry in group[0].those("low", "high", "absent")
        if entry.quantity == "order"
    ]
    return _rounded_off(group, said, "frequencies", singular)


def _misled(order: Entry) -> str:
    """How far a mode's number leads astray where it is worst; "" where it has no frequency."""
    if order.error is None or order.value is None or order.expected is None:
        return ""
    return f" ({number(order.value, 3)} Hz where {number(order.expected, 3)} Hz are due)"


def _rounded_off(
    group: Sequence[_Opinion],
    said: list[str],
    what: str,
    singular: bool,  # noqa: FBT001  grammar
) -> str:
    """What is off, after what holds and before what is open."""
    good, open_ = group[0].those("adequate"), group[0].those("undecided")
    holds = "holds" if singular else "hold"
    if good and not said and not open_:
        return f"{holds} for {what}{_within(group)}"
    kept = f"{holds} {place_of(entry.quantity for entry in good)}" if _named(good) else ""
    left = [*said]
    if open_:
        left.append(f"cannot be judged {place_of(e.quantity for e in open_)}".rstrip())
    return " but ".join(filter(None, [kept, listed(left)]))


def _within(group: Sequence[_Opinion]) -> str:
    """How far what holds may be off, all that is left open included."""
    sizes = [
        abs(entry.error or 0.0) + (entry.uncertainty or 0.0)
        for opinion in group
        for entry in opinion.those("adequate")
        if entry.quantity != "order"
    ]
    widest = max(sizes, default=0.0)
    return f" within {at_most(widest)}" if widest >= _WORTH_SAYING else ""


def _named(entries: Sequence[Entry]) -> bool:
    return any(entry.quantity != "order" for entry in entries)
