"""One style for all plots: a model has the same colour, marker and line wherever it appears.

Colours of Okabe and Ito (Color Universal Design, 2008), told apart by colour-blind readers; line
style and marker tell the models apart in black and white. Text is drawn as outlines, so that a
plot looks the same everywhere, and equal plots give equal files.
"""

import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure as Canvas

WIDTH = 7.4  # in, of every plot
LINE_HEIGHT = 0.165  # in, of a line in a legend
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, VERMILLION, PURPLE = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"
BROWN = "#6B4226"  # dark, as orange and vermillion are not


@dataclass(frozen=True)
class Look:
    """How a curve is drawn."""

    colour: str
    marker: str
    line: str = "-"

    def options(self) -> dict[str, Any]:
        """Keyword arguments for `Axes.plot`."""
        return {"color": self.colour, "marker": self.marker, "linestyle": self.line}


# Every model and reference of every figure by its name; no two have the same marker and line.
LOOKS: Mapping[str, Look] = {
    "simplified": Look("#666666", "x", ":"),
    "vjm": Look(BLUE, "o", "--"),
    "vjm-equivalent": Look(BLUE, "<"),
    "vjm-equivalent-euler-bernoulli": Look(BLUE, "4", ":"),
    "links": Look(PURPLE, ">", ":"),
    "segments": Look(ORANGE, "s", "--"),
    "segments-euler-bernoulli": Look(ORANGE, "v", ":"),
    "segments-printed": Look(PURPLE, "h", ":"),
    "segments-stepped": Look(BROWN, "*"),
    "segments-condensed": Look(SKY, "X", "-."),
    "beam": Look(GREEN, "^", "-."),
    "beam-euler-bernoulli": Look(GREEN, "P", ":"),
    # References: rigid ends and interfaces, or as the file says; free or averaged ones; with the
    # masses that legs known by a 6×6 plausibly have.
    "solid": Look(VERMILLION, "D"),
    "solid, free": Look(VERMILLION, "p", "--"),
    "own 6×6": Look(BLACK, "H"),
    "mass as in a prism": Look(VERMILLION, "1", "-."),
    "mass as in a prism, free": Look(VERMILLION, "2", "--"),
    "mass and inertia as given": Look(BLACK, "3", ":"),
    "mass and inertia as given, free": Look(BLACK, "+", "--"),
    "measured": Look(BLACK, "d", "none"),
}
# Names in the figures of the paper, whose virtual joints stand for legs of constant section.
_AS_WELL = {
    "VJM": "vjm-equivalent",
    "VJM, Timoshenko": "vjm-equivalent",
    "VJM, Euler–Bernoulli": "vjm-equivalent-euler-bernoulli",
    "segments, Timoshenko": "segments",
    "segments, Euler–Bernoulli": "segments-euler-bernoulli",
    "beam, Timoshenko": "beam",
    "beam, Euler–Bernoulli": "beam-euler-bernoulli",
    "legs' own 6×6": "own 6×6",
}
_REFERENCE = re.compile(r"^(solid|ends|interfaces|mass)\b")
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
    name = _AS_WELL.get(name, name)
    if name in LOOKS or not _REFERENCE.search(name):
        return name
    mass = next((key for key in LOOKS if key.startswith("mass") and name.endswith(key)), "solid")
    return f"{mass}, free" if re.search("free|averaged", name) else mass


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
}


@contextmanager
def plot_style() -> Iterator[None]:
    """The style of all plots while the context lasts; create, draw and save inside it."""
    with mpl.rc_context(_SETTINGS):
        yield


def canvas(
    rows: int = 1, columns: int = 1, height: float = 3.3, heights: Sequence[float] | None = None
) -> tuple[Canvas, list[Axes]]:
    """An empty picture as wide as the page and its axes, row by row; they make room for texts.

    `heights` of the rows, in proportion; alike if left out.
    """
    picture = Canvas(figsize=(WIDTH, height), layout="constrained")
    axes = picture.subplots(rows, columns, squeeze=False, height_ratios=heights)
    return picture, list(axes.flat)


@dataclass(frozen=True)
class Frame:
    """Room (in) around and between the axes of a plot; `entries` are the lines of its legend."""

    left: float
    between: float
    entries: int
    bottom: float = 0.55
    right: float = 0.2

    @property
    def top(self) -> float:
        """Room for the legend."""
        return 0.2 + LINE_HEIGHT * self.entries


def framed_canvas(frame: Frame, columns: int, height: float) -> tuple[Canvas, list[Axes]]:
    """A picture with axes `height` inches high, side by side, and a fixed frame around them.

    Unlike those of `canvas`, its axes need not be fitted, which is half the time of a plot: the
    report draws dozens of these when all else is finished.
    """
    whole = frame.bottom + height + frame.top
    picture = Canvas(figsize=(WIDTH, whole))
    left, right = frame.left / WIDTH, 1.0 - frame.right / WIDTH
    width = (WIDTH - frame.left - frame.right - frame.between * (columns - 1)) / columns
    axes = picture.subplots(
        1,
        columns,
        squeeze=False,
        gridspec_kw={
            "left": left,
            "right": right,
            "bottom": frame.bottom / whole,
            "top": 1.0 - frame.top / whole,
            "wspace": frame.between / width,
        },
    )
    return picture, list(axes.flat)


def framed_legend(
    picture: Canvas, frame: Frame, handles: Sequence[Any], labels: Sequence[str], columns: int
) -> None:
    """The legend above the axes of a framed canvas."""
    picture.legend(
        handles,
        labels,
        loc="upper left",
        bbox_to_anchor=(0.4 * frame.left / WIDTH, 1.0),
        ncols=columns,
        fontsize=8.0,
        handlelength=3.2,
        borderaxespad=0.3,
    )


def svg_of(picture: Canvas) -> str:
    """The picture as SVG markup, without date and document header."""
    # A page has dozens of plots: laying them out by Agg's metrics of text and drawing them once
    # takes a third of the time of `savefig`, which measures by outlines and draws twice.
    engine = picture.get_layout_engine()
    if engine is not None:
        FigureCanvasAgg(picture)
        engine.execute(picture)
        picture.set_layout_engine("none")
    buffer = io.StringIO()
    drawing: Any = FigureCanvasSVG(picture)  # untyped in matplotlib
    drawing.print_svg(buffer, metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    return text[text.index("<svg") :]


def marked(points: int, rank: int, ranks: int) -> list[int]:
    """Which of `points` points carry a marker of line `rank` of `ranks`.

    About four per line, evenly spread, and no point has markers of two lines while there are
    points enough.
    """
    if points < ranks:
        return [rank % points]
    spacing = max(ranks, (points - 1) // 4)
    offset = round(rank * spacing / ranks)
    return list(range(offset, points, spacing))


def csv_of(columns: Mapping[str, Sequence[float | str]]) -> str:
    """Columns of equal length as CSV, numbers with all their digits."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    return buffer.getvalue()
