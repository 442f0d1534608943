"""Where a mechanism is looked at, and what its robot file leaves open about its legs."""

from collections.abc import Mapping

import numpy as np

from lumped.legs import ConstantLeg, Ends, GivenLeg, Leg
from lumped.mechanism.body import Given, Prism
from lumped.mechanism.mechanism import UNITS_OF_MOVES, Mechanism, Posture
from lumped.models.bodies import legs_of
from validation.adequacy.legs import HOLD, OPEN_ENDS
from validation.adequacy.matrix import Coordinate
from validation.adequacy.subject.posed import Holds, Open
from validation.context import Context, Preset
from validation.kinematics.poses import postures_of
from validation.models.mechanism import constant_legs
from validation.models.options import DEFAULT_OPTIONS
from validation.models.parts import is_held_as_said

# Poses of a long path, of a grid say, are looked at in even steps.
MOST_POSES: Mapping[Preset, int] = {"quick": 9, "standard": 25, "fine": 81}
_OPEN_PARTS = "how the parts' interfaces are held"
SAY_PARTS = 'say how the faces of parts are held: coupling = "rigid", "average" or "pin"'
SAY_ENDS = """say how the prisms' end faces are held: ends = "rigid" or "free" in [bodies]"""


def path_postures(context: Context) -> tuple[Posture, ...]:
    """The postures of the path, first and last among them, once per run and process."""
    return context.get(_postures, context.robot_file.mechanism, MOST_POSES[context.preset])


def _postures(mechanism: Mechanism, most: int) -> tuple[Posture, ...]:
    count = len(mechanism.poses)
    chosen = np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))
    return tuple(postures_of(mechanism, mechanism.poses[chosen]))


def offered(judged: int) -> int:
    """How many modes of each model are looked at to judge so many.

    Legs that are alike have theirs in clusters, which a model must not show in part.
    """
    return max(12, 6 * judged)


def coordinates(mechanism: Mechanism) -> tuple[Coordinate, ...]:
    """What a pose prescribes."""
    return tuple(Coordinate(move, UNITS_OF_MOVES[move]) for move in mechanism.tool.moves)


def left_open(mechanism: Mechanism) -> Open:
    """How legs and parts are held: what is said, and what is not."""
    said = {name: _said(mechanism, name) for name in legs_of(mechanism)}
    parts: dict[str, Ends | None] = {
        name: "rigid" if is_held_as_said(body) else None for name, body in mechanism.parts.items()
    }
    everything = {**said, **parts}
    if all(everything.values()):
        name = "interfaces as said" if parts and not said else "ends as said"
        return Open("", "", {name: {name: one or "rigid" for name, one in everything.items()}})
    open_ends, open_parts = (not all(one.values()) for one in (said, parts))
    kinds = [name for name, is_open in (("ends", open_ends), ("interfaces", open_parts)) if is_open]
    words = {"rigid": "rigid", "free": "free" if open_ends else "averaged"}
    return Open(
        " and ".join(
            text for text, is_open in ((OPEN_ENDS, open_ends), (_OPEN_PARTS, open_parts)) if is_open
        ),
        "; ".join(
            text for text, is_open in ((SAY_ENDS, open_ends), (SAY_PARTS, open_parts)) if is_open
        ),
        {
            f"{' and '.join(kinds)} {words[hold]}": {
                name: one or hold for name, one in everything.items()
            }
            for hold in HOLD
        },
    )


def holds(mechanism: Mechanism) -> Mapping[str, Holds]:
    """Ends of every leg and part by the name of the alternative."""
    return left_open(mechanism).holds


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


def distinct_legs(mechanism: Mechanism) -> tuple[str, ...]:
    """The legs by name, of those that are alike the first alone."""
    first: dict[object, str] = {}
    for name, leg in known_legs(mechanism).items():
        first.setdefault(leg if isinstance(leg, ConstantLeg) else name, name)
    return tuple(first.values())


def has_given(mechanism: Mechanism) -> bool:
    """Whether any leg is known by its 6×6 alone."""
    return any(isinstance(body.shape, Given) for body in mechanism.bodies.values())
