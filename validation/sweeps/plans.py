"""Which units make up a sweep: over the stroke of one robot, and over the family of eq. (10)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from lumped.biglide import Biglide, scaled
from lumped.errors import InputError, each
from lumped.legs import equivalent_leg
from meshes.section.section_mesh import require_leg
from validation.models.options import Ends, ModelName, ModelOptions
from validation.sweeps.units import PostureUnit, chunks, expected_highest, posture_unit

# Postures per unit: about a tenth of a second, so that little is lost with a unit.
CHUNK = 100
# What the paper follows over the family (Fig. 13).
FREQUENCIES = 2
# First frequencies of a leg to 1e-5; statics is exact for any number.
_BEAM_ELEMENTS = 8
_ANY_DIVISIONS = 4


@dataclass(frozen=True)
class SweptModel:
    """One model in a sweep, by the `label` under which it is shown."""

    label: str
    model: ModelName
    options: ModelOptions


RIGID, FREE, COARSE = "solid", "solid, ends free to warp", "solid, coarser mesh"


def lumped_models(segments: int) -> tuple[SweptModel, ...]:
    """Simplified, VJM, legs in `segments` and beams, all with the same equivalent legs."""
    return (
        SweptModel("simplified", "simplified", ModelOptions()),
        SweptModel("VJM", "vjm", ModelOptions(legs="equivalent")),
        SweptModel("segments", "segments", ModelOptions(elements=segments)),
        SweptModel("beam", "beam", ModelOptions(elements=_BEAM_ELEMENTS)),
    )


def solid_model(label: str, ends: Ends, divisions: int) -> SweptModel:
    """Legs as solids with `divisions` elements across the smaller side of their section."""
    return SweptModel(label, "solid", ModelOptions(ends=ends, divisions=divisions))


def stroke_stations(robot: Biglide, count: int) -> tuple[float, ...]:
    """`count` positions x of B (m) over the stroke, ends included, denser towards them.

    Deflections go like √(L² − x²) at the ends of the stroke, which is smooth in the angle.
    """
    first, last = robot.stroke
    x = first + (last - first) * 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, count)))
    return tuple(np.clip(x, first, last).tolist())


def stroke_units(
    swept: SweptModel, robot: Biglide, x: Sequence[float], frequencies: int
) -> tuple[PostureUnit, ...]:
    """Units for one model of one robot in the postures `x` (m).

    Raises InputError for postures outside the stroke.
    """
    unit = posture_unit(swept.model, robot, tuple(x), frequencies, swept.options)
    return chunks(unit, CHUNK)


def member_units(
    models: Sequence[SweptModel], robot: Biglide, alpha: float, fractions: Sequence[float]
) -> tuple[PostureUnit, ...]:
    """A unit per model: family member `alpha` at `fractions` (0 to 1) of its stroke.

    All ask for the same two frequencies, so that all studies of a family share its reduced legs.
    Raises InputError where the legs cannot meet.
    """
    members = {
        by: scaled(robot, alpha, by) for by in {swept.options.equivalent for swept in models}
    }
    highest = {by: expected_highest(member, FREQUENCIES) for by, member in members.items()}
    units = []
    for swept in models:
        member = members[swept.options.equivalent]
        first, last = member.stroke
        x = tuple(float(np.clip(first + f * (last - first), first, last)) for f in fractions)
        allowed = highest[swept.options.equivalent]
        units.append(
            posture_unit(swept.model, member, x, FREQUENCIES, swept.options, highest=allowed)
        )
    return tuple(units)


def feasible_alphas(
    robot: Biglide, alphas: Sequence[float]
) -> tuple[tuple[float, ...], tuple[str, ...]]:
    """The α at which the robot can be built, and for each of the others why it cannot.

    The legs must meet, and be at least as long as their section is large. Raises InputError, with
    all the reasons, where no α is possible.
    """
    feasible, faults = each(partial(_feasible, robot), alphas)
    if not feasible:
        raise InputError(faults or ["no relative leg length α is given"])
    return tuple(feasible), tuple(faults)


def _feasible(robot: Biglide, alpha: float) -> float:
    member = scaled(robot, alpha)
    faults: list[str] = []
    for number, leg in ((1, equivalent_leg(member.leg1)), (2, equivalent_leg(member.leg2))):
        try:
            require_leg(leg.section, leg.length, _ANY_DIVISIONS)
        except InputError as error:
            faults += (f"α = {alpha:g}, leg {number}: {fault}" for fault in error.faults)
    if faults:
        raise InputError(faults)
    return alpha
