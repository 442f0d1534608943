"""A picture of a mechanism: one posture in full, the others as their lines, everything named.

A mechanism whose joints lie in one plane is seen along its normal, any other from above and aside,
both without perspective.
"""

from collections.abc import Sequence
from itertools import permutations

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import Side
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from validation.drawing.scene import ABOVE, DARK, DrawnBody, Label, Marks, Scene, Wire
from validation.drawing.style import VERMILLION
from validation.kinematics.solids import (
    COLOURS,
    SYMBOL,
    in_one_plane,
    is_leg,
    on_ground,
    solids,
    symbol_at,
    tool_place,
)

_ASIDE = np.array([0.45, -0.80, 0.40]), np.array([0.0, 0.0, 1.0])
_OTHER_LEG, _LINES = "#b5cbb7", "#b4c1cc"


def scene(mechanism: Mechanism, postures: Sequence[Posture], *, named: bool = True) -> Scene:
    """The middle one of the postures in full, the others as lines.

    A small picture has no room for names, and stands beside words that say which posture it is.
    """
    shown = postures[len(postures) // 2]
    drawn, other = solids(shown), _other_legs(mechanism)
    bodies = [
        DrawnBody(one.surface, _OTHER_LEG if other & {one.name} else COLOURS[one.matter])
        for one in drawn
    ]
    place = shown_pose(mechanism, shown.pose) or "reference posture"
    way = np.array([tool_place(posture) for posture in postures])
    base = [
        interface_position(shown, Side(GROUND, name))
        for name in mechanism.bodies[GROUND].interfaces
    ]
    feet = np.reshape(base, (-1, 3))
    wires = [*_lines(postures), *_rails(postures), _joined(way, VERMILLION, 2.5)]
    return Scene(
        bodies,
        ABOVE if in_one_plane(shown) else _ASIDE,
        wires,
        f"{mechanism.name}, {place}" if named else mechanism.name,
        marks=[
            Marks(feet, "ground"),
            Marks(way, "dot", VERMILLION),
            Marks(tool_place(shown)[None], "cross", VERMILLION),
        ],
        labels=_names(shown) if named else (),
        inside=[*(one.points for one in wires), feet - SYMBOL * mechanism.size],
    )


def _other_legs(mechanism: Mechanism) -> set[str]:
    """Legs in a second colour, so that those that meet stand out from each other."""
    others: set[str] = set()
    legs = [name for name, body in mechanism.bodies.items() if is_leg(body)]
    for number, name in enumerate(legs):
        plain = set(legs[:number]) - others
        pairs = [(one.first.body, one.second.body) for one in mechanism.joints]
        if any(a == name and b in plain for pair in pairs for a, b in permutations(pair)):
            others.add(name)
    return others


def _lines(postures: Sequence[Posture]) -> list[Wire]:
    """Between the interfaces of the bodies in all postures."""
    found = []
    for posture in postures:
        for name, body in posture.mechanism.bodies.items():
            points = [(posture.frames[name] @ place).position for place in body.interfaces.values()]
            if name != GROUND and len(points) == 2:
                found.append(_joined(np.array(points), _LINES, 2.0))
            elif name != GROUND:
                middle = np.mean(points, axis=0)
                found += [_joined(np.array([middle, point]), _LINES, 2.0) for point in points]
    return found


def _rails(postures: Sequence[Posture]) -> list[Wire]:
    """Along ground, as far as the joints on it slide in all postures."""
    return [
        _joined(np.array([interface_position(one, joint.second) for one in postures]), DARK, 3.0)
        for joint in postures[0].mechanism.joints
        if on_ground(joint)
    ]


def _joined(points: Array, colour: str, width: float) -> Wire:
    numbers = np.arange(len(points))
    return Wire(points, np.column_stack([numbers[:-1], numbers[1:]]), colour, width)


def _names(posture: Posture) -> list[Label]:
    """Names of bodies (upright) and joints (slanted)."""
    found = []
    for name, body in posture.mechanism.bodies.items():
        if name != GROUND:
            places = [(posture.frames[name] @ one).position for one in body.interfaces.values()]
            found.append(Label(name, np.mean(places, axis=0), "#1c3d5a"))
    return found + [
        Label(joint.name, interface_position(posture, symbol_at(joint)), "#8a3b00", slanted=True)
        for joint in posture.mechanism.joints
        if joint.kind != "fixed"
    ]
