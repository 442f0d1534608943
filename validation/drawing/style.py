"""One style for all plots: a model has the same colour, marker and line wherever it appears.

Colours of Okabe and Ito (Color Universal Design, 2008), told apart by colour-blind readers; line
style and marker tell the models apart in black and white. Text is drawn as outlines, so that a
plot looks the same everywhere, and equal plots give equal files.
"""

import csv
import io
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import cycle
from typing import Any

WIDTH = 7.4  # in, of every plot
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, VERMILLION, PURPLE = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"
COLOUR_MAP = "viridis"  # told apart by colour-blind readers, and light against dark in grey
BROWN = "#6B4226"  # dark, as orange and vermillion are not

# Beginnings of cells that spreadsheets take for formulas (OWASP, CSV injection), in the wide forms
# of East Asian text, too; and texts that are numbers, coordinates or percentages all the same.
_FORMULA = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?"
_NUMBERS = re.compile(rf"{_NUMBER}(?:[, ]+{_NUMBER})*(?:\s?%)?", re.IGNORECASE)


@dataclass(frozen=True)
class Look:
    """How a curve is drawn."""

    colour: str
    marker: str
    line: str = "-"


# Every model and reference of every figure by its name; no two have the same marker and line.
LOOKS: Mapping[str, Look] = {
    "simplified": Look("#666666", "x", ":"),
    "vjm": Look(BLUE, "o", "--"),
    "vjm-equivalent": Look(BLUE, "<"),
    "links": Look(PURPLE, ">", ":"),
    "segments": Look(ORANGE, "s", "--"),
    "segments-euler-bernoulli": Look(ORANGE, "v", ":"),
    "segments, eq. (25) as printed": Look(PURPLE, "h", ":"),
    "segments-stepped": Look(BROWN, "*"),
    "segments-condensed": Look(SKY, "X", "-."),
    "beam": Look(GREEN, "^", "-."),
    "beam-euler-bernoulli": Look(GREEN, "P", ":"),
    # References: rigid ends and interfaces, or as the file says; free or averaged ones; with the
    # masses that legs known by a 6×6 plausibly have.
    "solid": Look(VERMILLION, "D"),
    "solid, free": Look(VERMILLION, "p", "--"),
    "legs' own 6×6": Look(BLACK, "H"),
    "mass along the legs": Look(VERMILLION, "1", "-."),
    "mass along the legs, free": Look(VERMILLION, "2", "--"),
    "measured": Look(BLACK, "d", "none"),
    "measured response": Look(BLACK, "d"),
    "tetrahedra, held ends": Look(SKY, "^"),
    "tetrahedra, free ends": Look(SKY, "v", "--"),
    # Of comparisons: the difference as measured, and what no cause explains of it.
    "difference E": Look(BLACK, "D", "none"),
    "numerical uncertainty of both sides": Look(BLACK, "o", "none"),
    "slope": Look("#999999", ""),
    # Of convergence with element count: its limits, and the layout of the paper's text.
    "segments, literal layout": Look(VERMILLION, "h", "--"),
    "segments-euler-bernoulli, literal layout": Look(VERMILLION, "8", ":"),
    "stated error": Look("#777777", "", "--"),
    "stated count": Look("#777777", "", ":"),
}
# Names in the figures of the paper.
_AS_WELL = {
    "VJM, legs as given": "vjm",
    "VJM, equivalent legs": "vjm-equivalent",
    "beam FE": "beam",
    "hexahedra, held ends": "solid",
    "hexahedra, free ends": "solid, free",
}
# Fills of bars by what they stand for; anything else takes the first colours that are free.
FILLS: Mapping[str, str] = {
    "drives": BLUE,
    "give of joints": GREEN,
    "bending y": VERMILLION,
    "bending z": ORANGE,
    "torsion": PURPLE,
    "tension": SKY,
    "parts": "#7a7f87",
    "unexplained": VERMILLION,
}
_OTHER_FILLS = (
    *(BLUE, ORANGE, GREEN, PURPLE, SKY, "#666666", YELLOW),
    *("#8c6d46", "#b9a7d6", "#7f9f3f", "#444444", "#a8c7c9", "#c98ca7", "#5b5ea6"),
)
# End conditions in names of references, which look as references with rigid ends or free ones.
_HELD: Mapping[str, str] = {
    f"{bodies} {ends}": free
    for bodies in ("ends", "interfaces", "ends and interfaces")
    for ends, free in {"as given": "", "rigid": "", "free": ", free", "averaged": ", free"}.items()
}
_MASS = "mass along the legs"
_REFERENCES: Mapping[str, str] = {
    **{f"solid, {held}": f"solid{free}" for held, free in _HELD.items()},
    **{f"{held}, {_MASS}": f"{_MASS}{free}" for held, free in _HELD.items()},
}
# For curves that are no models (modes, components), unlike any of these; yellow is too pale.
OTHERS: tuple[Look, ...] = (
    Look(BLUE, "o"),
    Look(VERMILLION, "s", "-."),
    Look(GREEN, "^", "--"),
    Look(PURPLE, "D", ":"),
    Look(ORANGE, "v"),
    Look(SKY, "P", "--"),
    Look(BLACK, "x", "-."),
)


def known_as(name: str) -> str:
    """The entry in `LOOKS` of a model or of an alternative of the reference, else the name."""
    return _AS_WELL.get(name) or _REFERENCES.get(name, name)


def looks_of(names: Iterable[str]) -> Mapping[str, Look]:
    """A look for every name: that of the model in `LOOKS`, else one that no other has."""
    others = cycle(OTHERS)
    return {name: LOOKS.get(known_as(name)) or next(others) for name in dict.fromkeys(names)}


def fills_of(names: Collection[str]) -> Mapping[str, str]:
    """A colour for every name: its own in `FILLS`, else one that no other of them has."""
    taken = {FILLS[name] for name in names if name in FILLS}
    free = cycle([colour for colour in _OTHER_FILLS if colour not in taken])
    return {name: FILLS.get(name) or next(free) for name in dict.fromkeys(names)}


# Any: the type of the settings is a list of all their names, which says no more.
_SETTINGS: Any = {
    "svg.fonttype": "path",
    "svg.hashsalt": "flexproof",
    "font.size": 9.5,
    "axes.titlesize": 10.5,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.6,
    "lines.markersize": 4.5,
    "lines.markerfacecolor": "white",
    "lines.markeredgewidth": 1.2,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "figure.facecolor": "white",
    # A robot's name may have dollar signs.
    "text.parse_math": False,
}


@contextmanager
def plot_style() -> Iterator[None]:
    """The style of all plots while the context lasts; create, draw and save inside it."""
    from matplotlib import rc_context  # noqa: PLC0415  slow to import, and makes folders

    with rc_context(_SETTINGS):
        yield


def marked(points: int, rank: int, ranks: int) -> tuple[int, int]:
    """Which of `points` points carry a marker of line `rank` of `ranks`: the first, and every nth.

    About four per line, and no point has markers of two lines while there are points enough.
    """
    spacing = max(ranks, (points - 1) // 4)
    return (round(rank * spacing / ranks) if points >= ranks else rank % points), spacing


def csv_of(columns: Mapping[str, Sequence[float | str | None]]) -> str:
    """Columns of equal length as CSV, numbers with all their digits, nothing for None.

    A text that a spreadsheet would compute gets an apostrophe in front, which makes it a text.
    """
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(map(_inert, columns))
    writer.writerows(map(_inert, row) for row in zip(*columns.values(), strict=True))
    return buffer.getvalue()


def _inert(cell: float | str | None) -> float | str | None:
    if not isinstance(cell, str) or _NUMBERS.fullmatch(cell):
        return cell
    return f"'{cell}" if cell.lstrip().startswith(_FORMULA) else cell
