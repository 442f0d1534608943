"""Style of all plots, in which a model has the same colour, marker and line everywhere.

Input: names of models and curves. Output: their looks, and a context that sets matplotlib. Colours
are those of Okabe and Ito (Color Universal Design, 2008), which colour-blind readers can
distinguish; in black and white, line style and marker distinguish the models. Text is drawn as
outlines, so that a plot looks the same on all machines and equal plots give equal files.
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
COLOUR_MAP = "viridis"  # legible for colour-blind readers, and monotonic in grey
BROWN = "#6B4226"  # darker than orange and vermillion

# First characters of cells that spreadsheets evaluate as formulas (OWASP, CSV injection), including
# the wide forms of East Asian text. The patterns match numbers, coordinates and percentages, which
# stay unchanged.
_FORMULA = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?"
_NUMBERS = re.compile(rf"{_NUMBER}(?:[, ]+{_NUMBER})*(?:\s?%)?", re.IGNORECASE)


@dataclass(frozen=True)
class Look:
    """Colour, marker and line style of a curve."""

    colour: str
    marker: str
    line: str = "-"


# Looks of all models and references by name. No two have the same marker and line.
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
    # References: with ends and interfaces rigid or as specified in the robot file; with free ends
    # or averaged interfaces; with a mass distribution assumed for legs known by a 6×6.
    "solid": Look(VERMILLION, "D"),
    "solid, free": Look(VERMILLION, "p", "--"),
    "specified 6×6 of the legs": Look(BLACK, "H"),
    "mass along the legs": Look(VERMILLION, "1", "-."),
    "mass along the legs, free": Look(VERMILLION, "2", "--"),
    "measured": Look(BLACK, "d", "none"),
    "measured response": Look(BLACK, "d"),
    "tetrahedra, held ends": Look(SKY, "^"),
    "tetrahedra, free ends": Look(SKY, "v", "--"),
    # Comparisons: the difference, and the uncertainty of its unexplained part.
    "difference": Look(BLACK, "D", "none"),
    "numerical uncertainty of model and reference": Look(BLACK, "o", "none"),
    "slope": Look("#999999", ""),
    # Convergence with element count: the paper's layout; lines at a stated error and element count.
    "segments, literal layout": Look(VERMILLION, "h", "--"),
    "segments-euler-bernoulli, literal layout": Look(VERMILLION, "8", ":"),
    "stated error": Look("#777777", "", "--"),
    "stated count": Look("#777777", "", ":"),
}
# Keys of `LOOKS` for the labels in the figures of the paper and of meshes.
_LABELS = {
    "VJM, legs as given": "vjm",
    "VJM, equivalent legs": "vjm-equivalent",
    "beam FE": "beam",
    "hexahedra, held ends": "solid",
    "hexahedra, free ends": "solid, free",
}
# Fill colours of bars by label. Other labels have the first unused colours of `_OTHER_FILLS`.
FILLS: Mapping[str, str] = {
    "drives": BLUE,
    "joint compliance": GREEN,
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
# Suffix of the key in `LOOKS` for the end conditions in the name of a reference.
_END_CONDITIONS: Mapping[str, str] = {
    f"{bodies} {ends}": free
    for bodies in ("ends", "interfaces", "ends and interfaces")
    for ends, free in (
        ("as in the robot file", ""),
        ("rigid", ""),
        ("free", ", free"),
        ("averaged", ", free"),
    )
}
_MASS = "mass along the legs"
_REFERENCES: Mapping[str, str] = {
    **{f"solid, {ends}": f"solid{free}" for ends, free in _END_CONDITIONS.items()},
    **{f"{ends}, {_MASS}": f"{_MASS}{free}" for ends, free in _END_CONDITIONS.items()},
}
# Looks of curves that do not belong to models (modes, components), different from those above.
# Yellow is too pale.
OTHERS: tuple[Look, ...] = (
    Look(BLUE, "o"),
    Look(VERMILLION, "s", "-."),
    Look(GREEN, "^", "--"),
    Look(PURPLE, "D", ":"),
    Look(ORANGE, "v"),
    Look(SKY, "P", "--"),
    Look(BLACK, "x", "-."),
    Look("#666666", "D", "--"),
    Look(BROWN, "o", ":"),
    Look(BLUE, "^", ":"),
    Look(VERMILLION, "x"),
    Look(GREEN, "s"),
    Look(PURPLE, "v", "-."),
    Look(ORANGE, "D", "-."),
)


def look_key(name: str) -> str:
    """Key in `LOOKS` for the name of a model or reference. A name without a look is unchanged."""
    return _LABELS.get(name) or _REFERENCES.get(name, name)


def looks_of(names: Iterable[str]) -> Mapping[str, Look]:
    """Look of each name: the one in `LOOKS`, or a look that no model has."""
    other_looks = cycle(OTHERS)
    return {name: LOOKS.get(look_key(name)) or next(other_looks) for name in dict.fromkeys(names)}


def fills_of(names: Collection[str]) -> Mapping[str, str]:
    """Fill colour of each name.

    It is the one in `FILLS`, otherwise a colour that no other name has, as long as there are enough
    colours.
    """
    used = {FILLS[name] for name in names if name in FILLS}
    unused = cycle([colour for colour in _OTHER_FILLS if colour not in used])
    return {name: FILLS.get(name) or next(unused) for name in dict.fromkeys(names)}


# Typed as Any, since matplotlib's type of the settings is a list of all their names.
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
    # A robot's name can contain dollar signs.
    "text.parse_math": False,
}


@contextmanager
def plot_style() -> Iterator[None]:
    """Context with the style of all plots, in which they are created, drawn and saved."""
    from matplotlib import rc_context  # noqa: PLC0415  slow to import, and makes folders

    with rc_context(_SETTINGS):
        yield


def marker_positions(points: int, rank: int, ranks: int) -> tuple[int, int]:
    """Index of the first point with a marker, and spacing of markers, for line `rank` of `ranks`.

    Each line of `points` points has about four markers. If there are enough points, no point has
    markers of two lines.
    """
    spacing = max(ranks, (points - 1) // 4)
    return (round(rank * spacing / ranks) if points >= ranks else rank % points), spacing


def csv_of(columns: Mapping[str, Sequence[float | str | None]]) -> str:
    """CSV text of columns of equal length. Numbers have all their digits; None is an empty cell.

    A text that a spreadsheet would evaluate as a formula gets a leading apostrophe.
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
