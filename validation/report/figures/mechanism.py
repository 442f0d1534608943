"""Figures of any mechanism: its picture, what gives way over its path, how it vibrates."""

from collections.abc import Callable, Mapping, Sequence
from io import BytesIO
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from lumped.arrays import Array
from lumped.mechanism.mechanism import Posture
from lumped.requirement import STATIC_QUANTITIES
from validation.adequacy.mechanism.dynamics import (
    dynamic_reference,
    model_vibration,
    offered,
    simplified_vibration,
)
from validation.adequacy.mechanism.path import coordinates, path_postures
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.statics import compliances, is_serial, static_reference
from validation.cases.mechanism import GROUP, MODES, SECTION
from validation.context import Context
from validation.exhibits import Drawing, Figure
from validation.kinematics.picture import picture
from validation.models.options import ModelName, ModelOptions
from validation.report.figures.curves.lines import from_zero, legend_above
from validation.report.figures.pictures.portrait import ID as PORTRAIT
from validation.report.figures.style import (
    MODELS,
    OTHERS,
    PURPLE,
    Look,
    canvas,
    csv_of,
    marked,
    plot_style,
    svg_of,
)

FORCE, MOMENT = 1000.0, 100.0
_DOTS = 200  # per inch
_HALF = 4.2  # in, beside the errors
_EULER = ModelOptions(theory="euler-bernoulli")
_TITLE = "Deflection over the path"
_FREQUENCIES = "Natural frequencies over the path"
_CURVES: Mapping[str, tuple[ModelName, ModelOptions, Look]] = {
    "simplified": ("simplified", ModelOptions(), MODELS["simplified"]),
    "vjm": ("vjm", ModelOptions(), MODELS["vjm"]),
    "links": ("links", ModelOptions(), Look(PURPLE, "D", ":")),
    "segments": ("segments", ModelOptions(), MODELS["segments"]),
    "beam": ("beam", ModelOptions(), MODELS["beam"]),
    "beam-euler-bernoulli": ("beam", _EULER, Look(MODELS["beam"].colour, "P", ":")),
}
Curves = Mapping[str, tuple[Array, Look]]


def drawings() -> tuple[Drawing, ...]:
    """The picture, deflections and frequencies over the path."""
    return (
        Drawing(PORTRAIT, "The mechanism", portrait, section=SECTION, group="pictures"),
        _drawing("mechanism.deflections", _TITLE, deflections, 3.0),
        _drawing("mechanism.frequencies", _FREQUENCIES, frequencies, 3.0),
    )


def _drawing(name: str, title: str, draw: Callable[[Context], Figure], effort: float) -> Drawing:
    return Drawing(name, title, draw, section=SECTION, group=GROUP, effort=effort)


def portrait(context: Context) -> Figure:
    """The middle pose in full, the first and the last as lines."""
    postures = path_postures(context)
    shown = [postures[0], postures[len(postures) // 2], postures[-1]]
    content = BytesIO()
    with plot_style():
        drawn = picture(context.robot_file.mechanism, shown, _HALF, named=False)
        drawn.savefig(content, dpi=_DOTS, format="png")
    return Figure(
        id=PORTRAIT,
        title="The mechanism",
        caption="In the middle of its path; thin lines: first and last pose. Driven joints are "
        "orange, the loaded point red.",
        section=SECTION,
        png=content.getvalue(),
    )


def deflections(context: Context) -> Figure:
    """A panel for each direction, under a force or a moment along it."""
    postures = path_postures(context)
    found: dict[str, tuple[Array, Look]] = {}
    for name, (model, options, look) in _CURVES.items():
        if model != "vjm" or not is_serial(postures):
            response = compliances(postures, model, options)
            found[name] = _own(response.compliance), look
    for one, line in zip(
        static_reference(context, postures).alternatives, ("-", "--"), strict=False
    ):
        solid = MODELS["solid"]
        found[f"solid, {one.name}"] = (
            _own(one.response.compliance),
            Look(solid.colour, solid.marker, line),
        )
    panels = {}
    for place, name in enumerate(STATIC_QUANTITIES):
        turns = name.startswith("phi")
        title = f"about {name[-1]} (µrad)" if turns else f"along {name} (µm)"
        factor = 1e6 * (MOMENT if turns else FORCE)
        panels[title] = {key: (factor * one[:, place], look) for key, (one, look) in found.items()}
    return _figure(
        context,
        "mechanism.deflections",
        f"{_TITLE}: along its own force of {FORCE:g} N, about its own moment of {MOMENT:g} N m",
        "Of the loaded point. Solid legs with end faces as the file says; where it does not, "
        "kept plane and free to warp.",
        panels,
    )


def frequencies(context: Context) -> Figure:
    """A panel for each of the first frequencies, in ascending order at each pose."""
    postures = path_postures(context)
    judged = context.robot_file.requirement.modes
    count = offered(judged)
    found: dict[str, tuple[Array, Look]] = {}
    rigid = simplified_vibration(samples_of(postures[0].mechanism), postures, count)
    if rigid is not None:
        found["simplified"] = rigid.frequencies, MODELS["simplified"]
    for name in ("segments", "beam", "beam-euler-bernoulli"):
        model, options, look = _CURVES[name]
        vibration = context.get(model_vibration, postures, model, options, count)
        found[name] = vibration.frequencies, look
    reference = dynamic_reference(context, postures, judged)
    looks = cycle(OTHERS) if reference.bracket else iter(_SOLID)
    for one, look in zip(reference.alternatives, looks, strict=False):
        if one.response.vibration is not None:
            label = one.name if reference.bracket else f"solid, {one.name}"
            found[label] = one.response.vibration.frequencies, look
    panels = {
        f"f{mode + 1} (Hz)": {key: (one[:, mode], look) for key, (one, look) in found.items()}
        for mode in range(min(MODES, judged))
    }
    return _figure(
        context,
        "mechanism.frequencies",
        _FREQUENCIES,
        "In ascending order at each pose; the matrix pairs modes by their shapes.",
        panels,
        columns=2,
    )


_SOLID = (MODELS["solid"], Look(MODELS["solid"].colour, MODELS["solid"].marker, "--"))


def _own(compliance: Array | None) -> Array:
    if compliance is None:
        raise ValueError("a static model has a compliance")
    return np.diagonal(compliance, axis1=1, axis2=2)


def _figure(
    context: Context,
    name: str,
    title: str,
    caption: str,
    panels: Mapping[str, Curves],
    columns: int = 3,
) -> Figure:
    postures = path_postures(context)
    x, label = _abscissa(context, postures)
    rows = -(-len(panels) // columns)
    with plot_style():
        drawn, places = canvas(rows, columns, 0.8 + 2.1 * rows)
        for axes, (heading, curves) in zip(places, panels.items(), strict=False):
            _draw(axes, x, curves)
            axes.set_title(heading)
            axes.set_xlabel(label)
            axes.xaxis.set_major_locator(MaxNLocator(integer=label == "pose"))
        for axes in places[len(panels) :]:
            axes.set_axis_off()
        legend_above(drawn, columns=4)
        svg = svg_of(drawn)
    table: dict[str, Sequence[float]] = {
        named: [float(at.pose[place]) for at in postures]
        for place, named in enumerate(coordinates(context.robot_file.mechanism))
    }
    for heading, curves in panels.items():
        table |= {f"{key}: {heading}": values.tolist() for key, (values, _) in curves.items()}
    return Figure(
        id=name, title=title, caption=caption, section=SECTION, svg=svg, data=csv_of(table)
    )


def _draw(axes: Axes, x: Array, curves: Curves) -> None:
    for rank, (name, (values, look)) in enumerate(curves.items()):
        axes.plot(
            x,
            values,
            label=name,
            linewidth=3.0 - 2.0 * rank / max(len(curves) - 1, 1),
            markevery=marked(len(x), rank, len(curves)),
            **look.options(),
        )
    from_zero(axes)


def _abscissa(context: Context, postures: Sequence[Posture]) -> tuple[Array, str]:
    """The poses' only coordinate, or their number along the path."""
    named = coordinates(context.robot_file.mechanism)
    if len(named) == 1:
        return np.array([at.pose[0] for at in postures]), named[0]
    return np.arange(1.0, len(postures) + 1.0), "pose"
