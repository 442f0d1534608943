"""Models, quantities and errors in words."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from math import ceil

from lumped.acceptance.requirement import (
    ANY_FORCE,
    AXES,
    FREQUENCIES,
    ROTATIONS,
    STATIC_QUANTITIES,
)
from validation.adequacy.matrix import Entry
from validation.drawing.text import number, percent

# With its verb's number: singular names take "is", plural ones "are".
_MODELS: Mapping[str, tuple[str, bool]] = {
    "simplified": ("the simplified model", True),
    "vjm": ("VJM with the legs as given", True),
    "vjm-equivalent": ("VJM on equivalent legs", True),
    "links": ("links", False),
    "segments": ("segments", False),
    "beam": ("beams", False),
    "segments-euler-bernoulli": ("Euler–Bernoulli segments", False),
    "beam-euler-bernoulli": ("Euler–Bernoulli beams", False),
    "segments-condensed": ("condensed segments", False),
    "segments-stepped": ("stepped segments", False),
}
_BY_OTHER_THEORY: Mapping[str, str] = {
    "segments": "segments-euler-bernoulli",
    "beam": "beam-euler-bernoulli",
}
SIGNS: Mapping[str, str] = {"phi_x": "φx", "phi_y": "φy", "phi_z": "φz", ANY_FORCE: "any force"}


def is_static(quantity: str) -> bool:
    """Whether the quantity is a displacement or rotation under a unit wrench."""
    return quantity in STATIC_QUANTITIES


def is_rotation(quantity: str) -> bool:
    """Whether the quantity is a rotation under a unit moment."""
    return quantity in ROTATIONS


def is_frequency(quantity: str) -> bool:
    """Whether the quantity is a natural frequency."""
    return quantity in FREQUENCIES


def model_name(model: str) -> str:
    """The model as the subject of a sentence."""
    return _MODELS.get(model, (model, True))[0]


def subject(models: Sequence[str]) -> tuple[str, bool]:
    """Several models as one subject, and whether its verb is singular.

    A model that is there by both theories is named once.
    """
    twice = [model for model, other in _BY_OTHER_THEORY.items() if {model, other} <= set(models)]
    told = {*twice, *(_BY_OTHER_THEORY[model] for model in twice)}
    once = [model for model in models if model not in told]
    names = [model_name(model) for model in once]
    singular = len(models) == 1 and _MODELS.get(models[0], ("", True))[1]
    if twice:
        both = f"{listed([model_name(model) for model in twice])} of either theory"
        return ", ".join([*names, both]), singular
    return listed(names), singular


def capital(text: str) -> str:
    """The text with a capital first letter, the rest as it is."""
    return f"{text[:1].upper()}{text[1:]}"


def listed(words: Sequence[str]) -> str:
    """Words with commas and a final "and"."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} and {words[-1]}"


def error_text(error: float, *, signed: bool = True) -> str:
    """An error in percent, two digits; "0 %" below what could matter to anyone."""
    return percent(error, signed=signed) if abs(error) >= _NOTHING else "0\u00a0%"


def force_text(entry: Entry) -> str:
    """The worst direction of any force: "(0.71, −0.7, 0.02)"; "" of any other quantity."""
    return f"({', '.join(number(one, 2) for one in entry.force)})" if entry.force else ""


_NOTHING = 5e-5


def place_of(quantities: Iterable[str]) -> str:
    """Where deflections are meant: "along x and z, about y"; frequencies and order by name."""
    known = list(quantities)
    along = [q for q in known if q in AXES and not is_rotation(q)]
    about = [ROTATIONS[q] for q in known if is_rotation(q)]
    parts = [f"along {listed(along)}"] if along else []
    parts += [f"about {listed(about)}"] if about else []
    parts += ["under any force"] if ANY_FORCE in known else []
    parts += [listed(_frequencies(known))] if any(map(is_frequency, known)) else []
    others = [q for q in known if not (is_static(q) or is_frequency(q) or q == "order")]
    parts += [listed(others)] if others else []
    return ", ".join(parts)


def _frequencies(quantities: Sequence[str]) -> list[str]:
    """Names of frequencies, runs of three and more in short: "f1", "f3 to f6"."""
    numbers = sorted(FREQUENCIES[q] for q in quantities if is_frequency(q))
    runs = [
        [value for _, value in run]
        for _, run in groupby(enumerate(numbers), key=lambda pair: pair[1] - pair[0])
    ]
    return [
        word
        for run in runs
        for word in ([f"f{run[0]} to f{run[-1]}"] if len(run) > 2 else [f"f{n}" for n in run])
    ]


def amount(low: float, high: float) -> str:
    """A range of relative sizes of errors, 0 < low ≤ high: "15 to 17 %", "12 %"."""
    first, last = (number(100.0 * value, 2) for value in (low, high))
    return f"{last}\u00a0%" if first == last else f"{first} to {last}\u00a0%"


def at_most(size: float) -> str:
    """A bound of relative sizes, rounded up to a tenth of a percent: "2.1 %"."""
    return f"{number(ceil(1000.0 * size - _NOTHING) / 10.0, 3)}\u00a0%"


def times(low: float, high: float) -> str:
    """A range of factors: "7.2 to 9 times", "1.8 times"."""
    first, last = (number(value, 2) for value in (low, high))
    return f"{last} times" if first == last else f"{first} to {last} times"
