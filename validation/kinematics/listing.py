"""Mobility and joint coordinates of a mechanism, as text and as JSON.

Input: a mechanism and its postures. Output: lines for a terminal (degrees, mm) or JSON (rad, m).
"""

import json
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from lumped.mechanism.joint import COORDINATES, Joint
from lumped.mechanism.kinematics.closure import Closure
from lumped.mechanism.kinematics.mobility import Mobility, mobility
from lumped.mechanism.kinematics.postures import reference_posture, shown_pose
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.text import counted


def mobility_text(mechanism: Mechanism) -> str:
    """Three lines on bodies and joints, mobility, and constraints in the reference posture."""
    motions = mobility(reference_posture(mechanism))
    kinds = Counter(joint.kind for joint in mechanism.joints)
    driven = sum(joint.drive is not None for joint in mechanism.joints)
    joints = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    moving = len(mechanism.bodies) - (GROUND in mechanism.bodies)
    bodies = counted(moving, "body", "bodies")
    constraints = counted(motions.constraints, "constraint")
    moves = ", ".join(mechanism.tool.moves) or "none"
    idle = f", and {counted(motions.idle, 'idle motion')}" if motions.idle else ""
    return "\n".join(
        [
            f"{bodies}, {counted(len(mechanism.joints), 'joint')} ({joints}), {driven} driven",
            f"mobility {motions.mobility}: moves of the tool {moves}{idle}",
            f"{constraints}, {motions.redundant or 'none'} of them redundant",
        ]
    )


def as_text(mechanism: Mechanism, postures: Sequence[Posture]) -> str:
    """Mobility, then the coordinates of all joints in each posture, in degrees and mm.

    Coordinates are zero in the reference posture.
    """
    lines = [f"{mechanism.name}: {mobility_text(mechanism)}"]
    for number, posture in enumerate(postures, start=1):
        lines += ["", f"pose {number}: {shown_pose(mechanism, posture.pose) or 'the reference'}"]
        motions = mobility(posture)
        if motions.at_limit:
            lines.append(
                f"  singular: the tool cannot move along {', '.join(motions.barred)}, "
                f"while {', '.join(motions.stirring)} can move without the tool"
            )
        width = max((len(joint.name) for joint in mechanism.joints), default=0)
        lines += [
            f"  {joint.name:{width}}  {joint.kind:11}  {_coordinates(joint, posture)}"
            + ("  driven" if joint.drive else "")
            for joint in mechanism.joints
            if joint.kind != "fixed"
        ]
    return "\n".join(lines)


def as_json(mechanism: Mechanism, postures: Sequence[Posture]) -> str:
    """Mobility and joint coordinates as JSON (schema 1), in m and rad.

    The residual is the largest gap of the closed loops relative to the size of the mechanism.
    """
    closure = Closure(mechanism)
    document = {
        "schema": 1,
        "robot": mechanism.name,
        "moves": list(mechanism.tool.moves),
        "size": mechanism.size,
        "joints": {
            joint.name: {"type": joint.kind, "driven": joint.drive is not None}
            for joint in mechanism.joints
        },
        "reference": _mobility_json(mobility(reference_posture(mechanism))),
        "results": [
            {
                "pose": posture.pose.tolist(),
                "residual": float(np.abs(gaps).max(initial=0.0)) / closure.size,
                **_mobility_json(mobility(posture)),
                "coordinates": {n: values.tolist() for n, values in posture.coordinates.items()},
            }
            for posture in postures
            for gaps in [closure.residual(closure.placement(posture))]
        ],
    }
    return json.dumps(document, indent=1)


def _mobility_json(motions: Mobility) -> dict[str, Any]:
    names = ("mobility", "idle", "constraints", "redundant", "at_limit", "stirring", "barred")
    return {name: getattr(motions, name) for name in names}


def _coordinates(joint: Joint, posture: Posture) -> str:
    return ", ".join(
        f"{np.degrees(value):+9.3f}°" if unit == "rad" else f"{1e3 * value:+9.3f} mm"
        for value, unit in zip(
            posture.coordinates[joint.name], COORDINATES[joint.kind], strict=True
        )
    )
