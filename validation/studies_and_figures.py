"""Data records of a run's convergence studies and figures, which the report displays.

Input: curves, drawings and captions. Output: `Study`, `Figure` and `PlannedFigure`. The page
displays a figure with title, caption and table of data; drawings are defined in
`validation.drawing`. SVG is checked, because the page embeds it unchanged.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, TypeAlias

import msgspec

from validation.context import Context, ScheduledTask
from validation.record_fields import RESULTS, JsonKey, json_object

# Headings of the report's sections, used by cases and figures.
AGREEMENT = "All formulations on the same legs"
CONVERGENCE = "Convergence with element count"
MESHES = "Convergence with mesh"
STROKE = "The robot over its stroke"
PATH = "The mechanism over its path"
MODES = "Modes by shape and strain energy"
PARAMETERS = "Design parameters"
FAMILY = "Robots with longer legs"

# Id of the picture of the robot on the first screen.
PORTRAIT = "robot.portrait"

# Allowed elements of drawings: no scripts, foreign content, event handlers or comments with tags.
_ELEMENTS = (
    "svg|metadata|rdf:RDF|cc:Work|cc:Agent|dc:[a-z]+|defs|style|g|path|use|clipPath|rect|circle|"
    "line|image|text|tspan|pattern"
)
_INERT = re.compile(
    rf"<!-- [^<>]*-->|</(?:{_ELEMENTS})>|"
    rf'<(?:{_ELEMENTS})(?:\s+(?!on)[\w:-]+="[^"<>]*")*\s*/?>',
    re.IGNORECASE,
)
# Links may lead to other elements of the drawing, or to embedded pictures.
_LINK = re.compile(r"(?:href=\"|url\()([^\")]*)", re.IGNORECASE)
_INTERNAL = re.compile(r"#|data:image/png;base64,")
_FOREIGN_STYLE = re.compile(r"<style[^<>]*>[^<]*(?:@|url)[^<]*", re.IGNORECASE)


@dataclass(frozen=True)
class Study:
    """Convergence study: curves of values over the element count, divisions or element size `x`.

    `series`: values of each curve by name, as many as `x`, in `unit`. `orders`: observed order of
    each curve, and `uncertainties`: numerical uncertainty of its finest value (in `unit`). A curve
    without both is outside its asymptotic range, as a line of `notes` states. `limits`: value to
    which each curve tends, exact or extrapolated; zero for curves that are relative errors. Equal
    studies of several cases are displayed once.

    Studies of one `family` have the same x and are drawn in the same axes, under `family_title`;
    their curves are labelled by the `variant` of their study. If studies name a `panel`, the family
    has a panel for each name, with its own x. A panel shows magnitudes of deviations from the
    limits, or the values if there are no limits.
    """

    id: Annotated[str, RESULTS]
    title: Annotated[str, RESULTS]
    x_label: Annotated[str, RESULTS]
    y_label: Annotated[str, RESULTS]
    unit: Annotated[str, RESULTS]
    x: Annotated[tuple[float, ...], RESULTS]
    series: Annotated[Mapping[str, tuple[float, ...]], RESULTS]
    formal_order: Annotated[float | None, RESULTS] = None
    orders: Annotated[Mapping[str, float], JsonKey("results.json", "order")] = field(
        default_factory=dict
    )
    uncertainties: Annotated[Mapping[str, float], JsonKey("results.json", "uncertainty")] = field(
        default_factory=dict
    )
    limits: Annotated[Mapping[str, float], JsonKey("results.json", "limit")] = field(
        default_factory=dict
    )
    notes: Annotated[tuple[str, ...], RESULTS] = ()
    family: str = ""
    family_title: str = ""
    variant: str = ""
    panel: str = ""

    def __post_init__(self) -> None:
        _require_file_name(self.id)
        if self.family:
            _require_file_name(self.family)
        for name, values in self.series.items():
            if len(values) != len(self.x):
                raise ValueError(
                    f"study {self.id}: {name} has {len(values)} values for {len(self.x)} x"
                )


class ElementStudy(msgspec.Struct, frozen=True, kw_only=True, tag_field="kind", tag="convergence"):
    """Convergence of one quantity with the element count `x`: entry of "studies" in results.json.

    `series` and all other mappings have the formulation as key.

    Fields with the names of fields of `Study` have the same meaning. A value of `series` is None if
    the count was not computed. `needed`: for each formulation, the smallest count from which on the
    relative error stays below each of several limits; the key is the limit as text, such as "0.01".
    The count is None if it exceeds the largest computed count. `stated`: element count from which
    on the error limit of `[agree]` applies. `body`: None for the robot.
    """

    id: str
    body: str | None
    quantity: str
    title: str = ""
    x_label: str = ""
    y_label: str = ""
    unit: str = "1"
    x: tuple[int, ...]
    series: Mapping[str, tuple[float | None, ...]]
    formal_order: Mapping[str, float] = {}
    order: Mapping[str, float] = {}
    uncertainty: Mapping[str, float] = {}
    limit: Mapping[str, float]
    theory: Mapping[str, str]
    needed: Mapping[str, Mapping[str, int | None]]
    stated: int
    notes: tuple[str, ...] = ()


class WorstValue(msgspec.Struct, frozen=True):
    """Worst value of a map, and its pose."""

    pose: tuple[float, ...]
    value: float


class MapStudy(msgspec.Struct, frozen=True, kw_only=True, tag_field="kind", tag="map"):
    """Quantity of a model over a grid of poses: an entry of "studies" in results.json.

    `x`: coordinates along each of the `moves`. `values` are nested in the order of the moves; None
    in poses out of reach.
    """

    id: str
    title: str
    unit: str
    model: str
    moves: tuple[str, ...]
    x: tuple[tuple[float, ...], ...]
    values: tuple[Any, ...]
    worst: WorstValue


FigureStudy: TypeAlias = ElementStudy | MapStudy


@dataclass(frozen=True)
class InteractiveScene:
    """A 3-D scene that can be turned. `state` is the packed input of the page's viewer."""

    title: str
    state: bytes


@dataclass(frozen=True)
class Figure:
    """Picture with caption and data: `svg` (markup) or `png` (bytes), and `data` as CSV.

    If this machine cannot draw it, `left_out` is the reason; data and scenes exist nevertheless.
    `id` is also the stem of its file names. `section`: heading of the report under which it stands.
    `scenes`: the panels of the picture in three dimensions. `computed_by`: names of the functions
    that computed its numbers. `studies`: its entries of "studies" in results.json.
    """

    id: str
    title: str
    caption: str
    section: str
    svg: str = ""
    png: bytes = b""
    data: str = ""
    left_out: str = ""
    scenes: tuple[InteractiveScene, ...] = ()
    computed_by: tuple[str, ...] = ()
    studies: tuple[FigureStudy, ...] = ()

    def __post_init__(self) -> None:
        _require_file_name(self.id)
        if [bool(self.svg), bool(self.png), bool(self.left_out)].count(True) != 1:
            raise ValueError(f"figure {self.id}: must have exactly one of svg, png and left_out")
        _require_inert(self.svg, self.id)

    @property
    def files(self) -> Mapping[str, str | bytes]:
        """Contents of the figure's files by file name."""
        contents: dict[str, str | bytes] = {"svg": self.svg, "png": self.png, "csv": self.data}
        return {f"{self.id}.{ending}": content for ending, content in contents.items() if content}


@dataclass(frozen=True)
class PlannedFigure(ScheduledTask):
    """Figure that a run computes with the function `draw`."""

    draw: Callable[[Context], Figure]


def study_record(study: Study) -> dict[str, Any]:
    """Record of the study for results.json. A number that is not finite is null there."""
    return {"kind": "convergence", **json_object(study, "results.json")}


def _require_inert(svg: str, name: str) -> None:
    """Raise ValueError if SVG markup contains more than drawing elements.

    Figures are also read from records of earlier runs, which anybody may have written or changed.
    """
    for tag in (*re.findall(r"<[^<>]*>?", svg), *_FOREIGN_STYLE.findall(svg)):
        if not _INERT.fullmatch(tag) or any(
            not _INTERNAL.match(link) for link in _LINK.findall(tag)
        ):
            raise ValueError(f"figure {name}: {tag[:60]} is not allowed in a drawing")


def _require_file_name(identifier: str) -> None:
    if not re.fullmatch(r"\w[\w.+=-]*", identifier):
        raise ValueError(f"{identifier!r} names files: letters, digits and . _ + = - only")
