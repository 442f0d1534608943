"""Scene of a mechanism: one posture with all surfaces, the other postures as lines, with names.

Input: a mechanism and its postures. Output: a `Scene` for `validation.drawing`. Rule: a mechanism
whose joints lie in one plane is seen along the normal of that plane, any other obliquely from
above. The projection is parallel.
"""

from collections.abc import Sequence
from itertools import permutations

import numpy as np

from lumped.arrays import Array
from lumped.legs import LineLeg
from lumped.mechanism.body import Frame
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
    symbol_side,
    tool_position,
)

# Direction towards the viewer, and upward direction, of the oblique view.
_OBLIQUE = np.array([0.45, -0.80, 0.40]), np.array([0.0, 0.0, 1.0])
_SECOND_LEG_COLOUR, _LINE_COLOUR = "#b5cbb7", "#b4c1cc"
# Number of points drawn along the centre line of a leg.
_LINE_POINTS = 41


def scene(mechanism: Mechanism, postures: Sequence[Posture], *, named: bool = True) -> Scene:
    """Scene with the middle posture as surfaces and the other postures as lines.

    If not `named`, names of bodies and joints and the pose are omitted, for small pictures next to
    a text with the posture.
    """
    full_posture = postures[len(postures) // 2]
    second_colour = _second_colour_legs(mechanism)
    bodies = [
        DrawnBody(
            solid.surface,
            _SECOND_LEG_COLOUR if solid.name in second_colour else COLOURS[solid.matter],
        )
        for solid in solids(full_posture)
    ]
    pose = shown_pose(mechanism, full_posture.pose) or "reference posture"
    tool_path = np.array([tool_position(posture) for posture in postures])
    base = [
        interface_position(full_posture, Side(GROUND, name))
        for name in mechanism.bodies[GROUND].interfaces
    ]
    feet = np.reshape(base, (-1, 3))
    wires = [*_body_lines(postures), *_rails(postures), _polyline(tool_path, VERMILLION, 2.5)]
    return Scene(
        bodies,
        ABOVE if in_one_plane(full_posture) else _OBLIQUE,
        wires,
        f"{mechanism.name}, {pose}" if named else mechanism.name,
        marks=[
            Marks(feet, "ground"),
            Marks(tool_path, "dot", VERMILLION),
            Marks(tool_position(full_posture)[None], "cross", VERMILLION),
        ],
        labels=_names(full_posture) if named else (),
        inside=[*(wire.points for wire in wires), feet - SYMBOL * mechanism.size],
    )


def _second_colour_legs(mechanism: Mechanism) -> set[str]:
    """Names of legs to be drawn in the second colour, so that legs that meet in a joint differ."""
    second_colour: set[str] = set()
    legs = [name for name, body in mechanism.bodies.items() if is_leg(body)]
    pairs = [(joint.first.body, joint.second.body) for joint in mechanism.joints]
    for index, name in enumerate(legs):
        first_colour = set(legs[:index]) - second_colour
        if any(a == name and b in first_colour for pair in pairs for a, b in permutations(pair)):
            second_colour.add(name)
    return second_colour


def _body_lines(postures: Sequence[Posture]) -> list[Wire]:
    """Lines between the interfaces of each body, in all postures."""
    wires = []
    for posture in postures:
        for name, body in posture.mechanism.bodies.items():
            frame = posture.frames[name]
            points = [(frame @ interface).position for interface in body.interfaces.values()]
            if isinstance(body.shape, LineLeg):
                wires.append(_polyline(_line_points(body.shape, frame), _LINE_COLOUR, 2.0))
            elif name != GROUND and len(points) == 2:
                wires.append(_polyline(np.array(points), _LINE_COLOUR, 2.0))
            elif name != GROUND:
                middle = np.mean(points, axis=0)
                wires += [
                    _polyline(np.array([middle, point]), _LINE_COLOUR, 2.0) for point in points
                ]
    return wires


def _line_points(leg: LineLeg, frame: Frame) -> Array:
    """Points (n×3, m, base axes) of the centre line of a leg, including its midpoint."""
    points, _ = leg.line.frames(np.linspace(0.0, leg.line.length, _LINE_POINTS))
    return frame.position + points @ frame.rotation.T


def _rails(postures: Sequence[Posture]) -> list[Wire]:
    """Rails on the ground, through the positions of each sliding joint in all postures."""
    return [
        _polyline(
            np.array([interface_position(posture, joint.second) for posture in postures]), DARK, 3.0
        )
        for joint in postures[0].mechanism.joints
        if on_ground(joint)
    ]


def _polyline(points: Array, colour: str, width: float) -> Wire:
    numbers = np.arange(len(points))
    return Wire(points, np.column_stack([numbers[:-1], numbers[1:]]), colour, width)


def _names(posture: Posture) -> list[Label]:
    """Labels of bodies (upright) and joints (slanted)."""
    labels = []
    for name, body in posture.mechanism.bodies.items():
        if name != GROUND:
            frame = posture.frames[name]
            points = [(frame @ interface).position for interface in body.interfaces.values()]
            middle = (
                _line_points(body.shape, frame)[_LINE_POINTS // 2]
                if isinstance(body.shape, LineLeg)
                else np.mean(points, axis=0)
            )
            labels.append(Label(name, middle, "#1c3d5a"))
    return labels + [
        Label(joint.name, interface_position(posture, symbol_side(joint)), "#8a3b00", slanted=True)
        for joint in posture.mechanism.joints
        if joint.kind != "fixed"
    ]
