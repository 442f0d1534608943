"""Deflections and frequencies over the path by all models, and how far they are apart."""

from collections.abc import Callable, Iterator, Mapping
from itertools import cycle

import numpy as np

from lumped.acceptance.requirement import STATIC_QUANTITIES
from validation.adequacy.mechanism.compared import (
    Compared,
    compared_compliances,
    compared_frequencies,
    is_model,
)
from validation.adequacy.mechanism.path import coordinates, has_given, path_postures
from validation.adequacy.response import UNSOLVED
from validation.case import Skip
from validation.context import Context
from validation.drawing.style import (
    MODELS,
    OTHERS,
    PURPLE,
    Look,
)
from validation.exhibits import PATH, Drawing, Figure
from validation.models.mechanism import JUDGED_MODES
from validation.report.figures.mechanism.panels import POSE, Abscissa, Panel, compared_figure
from validation.solids.robots import SHARED_SOLIDS

FORCE, MOMENT = 1000.0, 100.0
OWN_LOADS = f"along its own force of {FORCE:g} N, about its own moment of {MOMENT:g} N m"
HELD = (
    "Solids with ends and interfaces held as the file says; where it does not, rigidly, and free "
    "to warp or averaged."
)
ONE_SHAPE = "In ascending order; differences are those of modes of one shape."
_TITLE = "Deflection over the path"
_FREQUENCIES = "Natural frequencies over the path"
_LOOKS: Mapping[str, Look] = {
    "simplified": MODELS["simplified"],
    "vjm": MODELS["vjm"],
    "links": Look(PURPLE, "D", ":"),
    "segments": MODELS["segments"],
    "segments-stepped": Look(MODELS["segments"].colour, "^", ":"),
    "segments-condensed": Look(MODELS["vjm"].colour, "s", "-."),
    "beam": MODELS["beam"],
    "beam-euler-bernoulli": Look(MODELS["beam"].colour, "P", ":"),
}
_SOLID = (MODELS["solid"], Look(MODELS["solid"].colour, MODELS["solid"].marker, "--"))


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
    try:
        found = compared_compliances(context, path_postures(context))
    except UNSOLVED as error:
        raise Skip(str(error)) from error
    return compared_figure(
        "mechanism.deflections",
        f"{_TITLE}: {OWN_LOADS}",
        f"Of the loaded point. {HELD}",
        PATH,
        _over_path(context),
        deflection_panels(found),
        found.against,
    )


def frequencies(context: Context) -> Figure:
    """A panel for each of the first frequencies, in ascending order at each pose."""
    judged = context.robot_file.requirement.modes
    try:
        found = compared_frequencies(context, path_postures(context), judged)
    except UNSOLVED as error:
        raise Skip(str(error)) from error
    return compared_figure(
        "mechanism.frequencies",
        _FREQUENCIES,
        ONE_SHAPE,
        PATH,
        _over_path(context),
        frequency_panels(found, bracket=has_given(context.robot_file.mechanism)),
        found.against,
        columns=2,
    )


def deflection_panels(found: Compared) -> dict[str, Panel]:
    """Compliances (p×6, SI) as deflections under `FORCE` and `MOMENT`, a panel each."""
    panels = {}
    for place, name in enumerate(STATIC_QUANTITIES):
        turns = name.startswith("phi")
        title = f"about {name[-1]} (µrad)" if turns else f"along {name} (µm)"
        panels[title] = _panel(found, place, 1e6 * (MOMENT if turns else FORCE), iter(_SOLID))
    return panels


def frequency_panels(found: Compared, *, bracket: bool) -> dict[str, Panel]:
    """The first frequencies (p×k, Hz), a panel each; a `bracket` has many alternatives."""
    count = min(JUDGED_MODES, found.values[found.against].shape[1])
    return {
        f"f{mode + 1} (Hz)": _panel(found, mode, 1.0, cycle(OTHERS) if bracket else iter(_SOLID))
        for mode in range(count)
    }


def _panel(found: Compared, place: int, factor: float, others: Iterator[Look]) -> Panel:
    looks = {name: _LOOKS[name] if is_model(name) else next(others) for name in found.values}
    return Panel(
        {name: (factor * values[:, place], looks[name]) for name, values in found.values.items()},
        {
            name: (100.0 * values[:, place], looks[name])
            for name, values in found.differences.items()
        },
    )


def _over_path(context: Context) -> Abscissa:
    """The only coordinate that changes along the path, or the poses' numbers along it."""
    named = coordinates(context.robot_file.mechanism)
    poses = np.array([at.pose for at in path_postures(context)])
    columns = {name: poses[:, place].tolist() for place, name in enumerate(named)}
    changing = np.flatnonzero(np.ptp(poses, axis=0) > 0.0)
    if len(changing) == 1:
        return Abscissa(poses[:, changing[0]], named[changing[0]], columns)
    return Abscissa(np.arange(1.0, len(poses) + 1.0), POSE, columns)
