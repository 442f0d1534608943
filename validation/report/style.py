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
from matplotlib.figure import Figure as Canvas

from validation.exhibits import Figure, Study

BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, VERMILLION, PURPLE = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"


@dataclass(frozen=True)
class Look:
    """How a curve is drawn."""

    colour: str
    marker: str
    line: str = "-"

    def options(self) -> dict[str, Any]:
        """Keyword arguments for `Axes.plot`."""
        return {"color": self.colour, "marker": self.marker, "linestyle": self.line}


MODELS: Mapping[str, Look] = {
    "simplified": Look("#666666", "x", ":"),
    "vjm": Look(BLUE, "o"),
    "segments": Look(ORANGE, "s", "--"),
    "beam": Look(GREEN, "^", "-."),
    "solid": Look(VERMILLION, "D"),
    "closed form": Look(BLACK, "", (0, (1, 1))),  # type: ignore[arg-type]
}
# For curves that are no models (mode numbers, components): yellow is too pale on white.
OTHERS: tuple[Look, ...] = (
    Look(BLUE, "o"),
    Look(VERMILLION, "s", "--"),
    Look(GREEN, "^", "-."),
    Look(PURPLE, "D", ":"),
    Look(ORANGE, "v"),
    Look(SKY, "P", "--"),
    Look(BLACK, "x", "-."),
)

# Any: the type of the settings is a list of all their names, which says no more.
_SETTINGS: Any = {
    "svg.fonttype": "path",
    "svg.hashsalt": "flexproof",
    "figure.constrained_layout.use": True,
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


def canvas(rows: int = 1, columns: int = 1, height: float = 3.3) -> tuple[Canvas, list[Axes]]:
    """An empty picture as wide as the page (7.4 in) and its axes, row by row."""
    picture = Canvas(figsize=(7.4, height))
    return picture, list(picture.subplots(rows, columns, squeeze=False).flat)


def look_of(name: str, others: Iterator[Look]) -> Look:
    """The look of a model named in `name` ("solid, leg 1"), else the next of `others`."""
    for model, look in MODELS.items():
        if re.match(rf"{re.escape(model)}\b", name, re.IGNORECASE):
            return look
    return next(others)


def svg_of(picture: Canvas) -> str:
    """The picture as SVG markup, without date and document header."""
    buffer = io.StringIO()
    picture.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    return text[text.index("<svg") :]


def csv_of(columns: Mapping[str, Sequence[float | str]]) -> str:
    """Columns of equal length as CSV, numbers with all their digits."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    return buffer.getvalue()


def study_plot(study: Study) -> Figure:
    """The plot of a study alone, with its data."""
    # Families of studies are drawn in this style, so that they import this module.
    from validation.report.families import alone, family_plot  # noqa: PLC0415

    return family_plot(alone(study))
