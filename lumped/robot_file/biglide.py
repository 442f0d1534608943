"""Robot files of schema 1, which describe the biglide, as a mechanism of bodies and joints."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from lumped.errors import naming
from lumped.mechanism.biglide import biglide, family_member
from lumped.mechanism.length_unit import LENGTH_UNITS
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file.mechanism.build import leg_of, loss_of
from lumped.robot_file.rules.relations import leg_faults
from lumped.robot_file.rules.tables import length_unit_of, rules_of

_LEGS = ("leg1", "leg2")


def biglide_faults(tables: Mapping[str, Any]) -> list[str]:
    """Faults of the tables of a robot file of schema 1, one line each, beginning with the key."""
    rules = rules_of(tables)
    faults = rules.faults_within(tables)
    for name in _LEGS:
        rule = rules.keys[name].kind
        derived = {"key": name, "lengths": length_unit_of(tables)}
        if name in tables and not rule.faults(tables[name], name):
            faults += leg_faults(rule.read(tables[name]) | derived)
    return faults


def biglide_of(read: Mapping[str, Any]) -> Mechanism:
    """Biglide described by tables without faults. Legs are `alpha` times as long as in the file.

    Raises InputError if the legs cannot meet.
    """
    a, alpha = read["geometry"]["a"], read["geometry"]["alpha"]
    leg1, leg2 = leg_of(read["leg1"], "leg 1"), leg_of(read["leg2"], "leg 2")
    location = "geometry.a, leg1.length, leg2.length"
    if alpha != 1.0:
        a, leg1, leg2 = family_member(a, leg1, leg2, alpha)
        location = f"geometry.alpha = {alpha:g}"
    foot, tool = read["foot"], read["tool"]
    with naming(location):
        robot = biglide(
            read["name"],
            a,
            leg1,
            leg2,
            platform_mass=read["platform"]["mass"],
            drive_stiffness=read["actuators"]["stiffness"],
            tool_offset=np.array(read["geometry"]["tool_offset"]),
            foot_compliance=foot and foot["compliance"],
            tool_compliance=tool["compliance"] if tool and tool["active"] else None,
        )
    return _with_losses(robot, read)


def _with_losses(robot: Mechanism, read: Mapping[str, Any]) -> Mechanism:
    bodies = {
        name: replace(body, loss=loss_of(read[name])) if name in _LEGS else body
        for name, body in robot.bodies.items()
    }
    foot, tool = (read[name]["loss"] if read[name] else 0.0 for name in ("foot", "tool"))
    joint_losses = {"foot1": foot, "foot2": foot, "spring": tool}
    joints = []
    for joint in robot.joints:
        drive = joint.drive and replace(joint.drive, loss=read["actuators"]["loss"])
        joints.append(replace(joint, drive=drive, loss=joint_losses.get(joint.name, 0.0)))
    lengths = LENGTH_UNITS[read["units"]]
    return replace(robot, bodies=bodies, joints=tuple(joints), lengths=lengths)
