"""Where a mechanism is looked at, and what its robot file leaves open about its legs."""

from collections.abc import Mapping

import numpy as np

from lumped.legs import Ends, GivenLeg, Leg
from lumped.mechanism.body import Given, Prism
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.mechanism.part import Part
from lumped.models.bodies import legs_of
from validation.adequacy.legs import HOLD
from validation.case import Skip
from validation.context import Context, Preset
from validation.kinematics.poses import postures_of
from validation.models.mechanism import constant_legs
from validation.models.options import DEFAULT_OPTIONS

# Poses of a long path, of a grid say, are looked at in even steps.
MOST_POSES: Mapping[Preset, int] = {"quick": 9, "standard": 25, "fine": 81}
SAY_ENDS = """say how the prisms' end faces are held: ends = "rigid" or "free" in [bodies]"""


def path_postures(context: Context) -> tuple[Posture, ...]:
    """The postures of the path, first and last among them, once per run and process.

    Raises Skip for a mechanism of CAD parts, whose models a run does not hold against each other.
    """
    mechanism = context.robot_file.mechanism
    parts = [name for name, body in mechanism.bodies.items() if isinstance(body.shape, Part)]
    if parts:
        raise Skip(f"{', '.join(parts)}: runs do not judge CAD parts; solve and identify take them")
    return context.get(_postures, mechanism, MOST_POSES[context.preset])


def _postures(mechanism: Mechanism, most: int) -> tuple[Posture, ...]:
    count = len(mechanism.poses)
    chosen = np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))
    return tuple(postures_of(mechanism, mechanism.poses[chosen]))


def coordinates(mechanism: Mechanism) -> tuple[str, ...]:
    """What a pose prescribes, with units."""
    return tuple(
        f"{move} ({'rad' if move.startswith('phi') else 'm'})" for move in mechanism.tool.moves
    )


def holds(mechanism: Mechanism) -> dict[str, dict[str, Ends]]:
    """Ends of every leg by the name of the alternative: what is said, and what is not."""
    said = {name: _said(mechanism, name) for name in legs_of(mechanism)}
    if all(said.values()):
        return {"ends as said": {name: ends or "rigid" for name, ends in said.items()}}
    return {f"ends {hold}": {name: ends or hold for name, ends in said.items()} for hold in HOLD}


def _said(mechanism: Mechanism, name: str) -> Ends | None:
    shape = mechanism.bodies[name].shape
    # The 6×6 of a given leg has its ends in it.
    return shape.ends if isinstance(shape, Prism) else "rigid"


def known_legs(mechanism: Mechanism) -> dict[str, Leg]:
    """Every leg by name, prisms that are alike the same."""
    prisms = {name: leg for name, leg, _ in constant_legs(mechanism, DEFAULT_OPTIONS)}
    return {
        name: leg if isinstance(leg, GivenLeg) else prisms[name]
        for name, leg in legs_of(mechanism).items()
    }


def has_given(mechanism: Mechanism) -> bool:
    """Whether any leg is known by its 6×6 alone."""
    return any(isinstance(body.shape, Given) for body in mechanism.bodies.values())
