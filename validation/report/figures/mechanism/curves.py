"""Deflections and frequencies over the path by all models, and how far they are apart."""

from collections.abc import Callable, Mapping, Sequence
from itertools import cycle

import numpy as np

from lumped.acceptance.requirement import STATIC_QUANTITIES
from lumped.arrays import Array
from lumped.legs import ConstantLeg
from lumped.mechanism.mechanism import Posture
from validation.adequacy.mechanism.dynamics import (
    dynamic_reference,
    model_vibration,
    simplified_vibration,
)
from validation.adequacy.mechanism.path import coordinates, known_legs, offered, path_postures
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.statics import compliances, static_reference, unanswered
from validation.adequacy.mechanism.subject import mechanism_models
from validation.adequacy.partners import partners
from validation.context import Context
from validation.drawing.style import (
    MODELS,
    OTHERS,
    PURPLE,
    Look,
    csv_of,
)
from validation.exhibits import PATH, Drawing, Figure
from validation.models.mechanism import JUDGED_MODES
from validation.models.options import ModelName, ModelOptions
from validation.models.parts import parts_of
from validation.report.figures.mechanism.panels import (
    POSE,
    Panel,
    columns_of,
    compared_svg,
    differences,
)
from validation.solids.robots import SHARED_SOLIDS

FORCE, MOMENT = 1000.0, 100.0
_EULER = ModelOptions(theory="euler-bernoulli")
_TITLE = "Deflection over the path"
_FREQUENCIES = "Natural frequencies over the path"
_CURVES: Mapping[str, tuple[ModelName, ModelOptions, Look]] = {
    "simplified": ("simplified", ModelOptions(), MODELS["simplified"]),
    "vjm": ("vjm", ModelOptions(), MODELS["vjm"]),
    "links": ("links", ModelOptions(), Look(PURPLE, "D", ":")),
    "segments": ("segments", ModelOptions(), MODELS["segments"]),
    "segments-stepped": (
        "segments",
        ModelOptions(parts="stepped"),
        Look(MODELS["segments"].colour, "^", ":"),
    ),
    "segments-condensed": (
        "segments",
        ModelOptions(parts="condensed"),
        Look(MODELS["vjm"].colour, "s", "-."),
    ),
    "beam": ("beam", ModelOptions(), MODELS["beam"]),
    "beam-euler-bernoulli": ("beam", _EULER, Look(MODELS["beam"].colour, "P", ":")),
}
_DYNAMIC = ("segments", "segments-stepped", "segments-condensed", "beam", "beam-euler-bernoulli")


def drawings() -> tuple[Drawing, ...]:
    """Deflections and frequencies over the path."""
    return (
        _drawing("mechanism.deflections", _TITLE, deflections, 3.0),
        _drawing("mechanism.frequencies", _FREQUENCIES, frequencies, 3.0),
    )


def _drawing(name: str, title: str, draw: Callable[[Context], Figure], effort: float) -> Drawing:
    return Drawing(name, title, draw, section=PATH, group=SHARED_SOLIDS, effort=effort)


def deflections(context: Context) -> Figure:
    """A panel for each direction, under a force or a moment along it."""
    postures = path_postures(context)
    found: dict[str, tuple[Array, Look]] = {}
    reference = static_reference(context, postures)
    judged = mechanism_models(context.robot_file.mechanism)
    for name, (model, options, look) in _CURVES.items():
        if name in judged and not unanswered(postures, model, options):
            response = compliances(postures, model, options)
            found[name] = _own(response.compliance), look
    legs = known_legs(context.robot_file.mechanism).values()
    parts = parts_of(context.robot_file.mechanism)
    solid = bool(parts) or any(isinstance(leg, ConstantLeg) for leg in legs)
    against = ""
    for one, look in zip(reference.alternatives, _SOLID, strict=False):
        name = f"solid, {one.name}" if solid else "legs' own 6×6"
        found[name] = _own(one.response.compliance), look
        against = against or name
    panels = {}
    for place, name in enumerate(STATIC_QUANTITIES):
        turns = name.startswith("phi")
        title = f"about {name[-1]} (µrad)" if turns else f"along {name} (µm)"
        factor = 1e6 * (MOMENT if turns else FORCE)
        curves = {key: (factor * one[:, place], look) for key, (one, look) in found.items()}
        panels[title] = Panel(curves, differences(curves, against))
    return _figure(
        context,
        "mechanism.deflections",
        f"{_TITLE}: along its own force of {FORCE:g} N, about its own moment of {MOMENT:g} N m",
        "Of the loaded point. Solids with ends and interfaces held as the file says; where it does "
        "not, rigidly, and free to warp or averaged.",
        panels,
        against,
    )


def frequencies(context: Context) -> Figure:
    """A panel for each of the first frequencies, in ascending order at each pose."""
    postures = path_postures(context)
    judged = context.robot_file.requirement.modes
    count = offered(judged)
    found = {}
    rigid = simplified_vibration(samples_of(postures[0].mechanism), postures, count)
    if rigid is not None:
        found["simplified"] = rigid, MODELS["simplified"]
    models = mechanism_models(context.robot_file.mechanism)
    for name in _DYNAMIC:
        model, options, look = _CURVES[name]
        if name not in models or unanswered(postures, model, options):
            continue
        vibration = context.get(model_vibration, postures, model, options, count)
        found[name] = vibration, look
    reference = dynamic_reference(context, postures, judged)
    looks = cycle(OTHERS) if reference.bracket else iter(_SOLID)
    against = ""
    for one, look in zip(reference.alternatives, looks, strict=False):
        if one.response.vibration is not None:
            label = one.name if reference.bracket else f"solid, {one.name}"
            found[label] = one.response.vibration, look
            against = against or label
    first, weights = found[against][0], samples_of(context.robot_file.mechanism).weights
    own = first.frequencies[:, :judged]
    paired = {
        name: 100.0 * (partners(first, one, weights, judged).frequency / own - 1.0)
        for name, (one, _) in found.items()
        if name != against
    }
    panels = {}
    for mode in range(min(JUDGED_MODES, judged)):
        panels[f"f{mode + 1} (Hz)"] = Panel(
            {key: (one.frequencies[:, mode], look) for key, (one, look) in found.items()},
            {key: (one[:, mode], found[key][1]) for key, one in paired.items()},
        )
    return _figure(
        context,
        "mechanism.frequencies",
        _FREQUENCIES,
        "In ascending order at each pose; differences are those of modes of one shape.",
        panels,
        against,
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
    panels: Mapping[str, Panel],
    against: str,
    columns: int = 3,
) -> Figure:
    postures = path_postures(context)
    x, label = _abscissa(context, postures)
    table: dict[str, list[float]] = {
        named: [float(at.pose[place]) for at in postures]
        for place, named in enumerate(coordinates(context.robot_file.mechanism))
    }
    return Figure(
        id=name,
        title=title,
        caption=f"{caption} Below each: what the others differ from {against}, in percent.",
        section=PATH,
        svg=compared_svg(x, label, panels, columns),
        data=csv_of(table | columns_of(panels)),
    )


def _abscissa(context: Context, postures: Sequence[Posture]) -> tuple[Array, str]:
    """The only coordinate that changes along the path, or the poses' numbers along it."""
    named = coordinates(context.robot_file.mechanism)
    poses = np.array([at.pose for at in postures])
    changing = np.flatnonzero(np.ptp(poses, axis=0) > 0.0)
    if len(changing) == 1:
        return poses[:, changing[0]], named[changing[0]]
    return np.arange(1.0, len(postures) + 1.0), POSE
