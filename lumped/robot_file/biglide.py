"""Conversion of robot files of schema 1 (the biglide) to a mechanism of bodies and joints."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from lumped.errors import naming
from lumped.mechanism.biglide import biglide, family_member
from lumped.mechanism.length_unit import LENGTH_UNITS, UnitOfLength
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file.mechanism.build import leg_of, loss_of
from lumped.robot_file.mechanism.draft import LegDraft
from lumped.robot_file.mechanism.relations import leg_faults
from lumped.robot_file.rules.tables.robots import (
    BiglideEntry,
    BiglideLegEntry,
    length_unit_of,
    rules_of,
)

_LEGS = ("leg1", "leg2")


def biglide_entry(tables: Mapping[str, Any]) -> tuple[list[str], BiglideEntry | None]:
    """Faults of the tables of a robot file of schema 1, and the record into which they are read.

    Each fault is a line that begins with the key. The record is None if there are faults.
    """
    rules = rules_of(tables)
    faults, values = rules.checked_within(tables)
    entry: BiglideEntry | None = None if faults else rules.entry(values)
    for name in _LEGS:
        if (leg := values.get(name)) is not None:
            faults += leg_faults(_leg_draft(name, leg, length_unit_of(tables)))
    return faults, None if faults else entry


def _leg_draft(key: str, leg: BiglideLegEntry, unit: UnitOfLength) -> LegDraft:
    return LegDraft(key, leg, unit, leg.length, leg.section, leg.material, f"{key}.material")


def biglide_of(entry: BiglideEntry) -> Mechanism:
    """Biglide from the record of a robot file without faults.

    Its legs are `alpha` (table [geometry]) times as long as in the file.

    Raises InputError if the legs cannot meet.
    """
    unit, a, alpha = LENGTH_UNITS[entry.units], entry.geometry.a, entry.geometry.alpha
    drafts = [_leg_draft(*leg, unit) for leg in (("leg1", entry.leg1), ("leg2", entry.leg2))]
    leg1, leg2 = (leg_of(leg, f"leg {number}") for number, leg in enumerate(drafts, start=1))
    location = "geometry.a, leg1.length, leg2.length"
    if alpha != 1.0:
        a, leg1, leg2 = family_member(a, leg1, leg2, alpha)
        location = f"geometry.alpha = {alpha:g}"
    foot, tool = entry.foot, entry.tool
    with naming(location):
        robot = biglide(
            entry.name,
            a,
            leg1,
            leg2,
            platform_mass=entry.platform.mass,
            drive_stiffness=entry.actuators.stiffness,
            tool_offset=np.array(entry.geometry.tool_offset),
            foot_compliance=None if foot is None else foot.compliance,
            tool_compliance=tool.compliance if tool and tool.active else None,
        )
    losses = {draft.key: loss_of(draft) for draft in drafts}
    foot_loss, tool_loss = (spring.loss if spring else 0.0 for spring in (foot, tool))
    joint_losses = {"foot1": foot_loss, "foot2": foot_loss, "spring": tool_loss}
    joints = []
    for joint in robot.joints:
        drive = joint.drive and replace(joint.drive, loss=entry.actuators.loss)
        joints.append(replace(joint, drive=drive, loss=joint_losses.get(joint.name, 0.0)))
    bodies = {
        name: replace(body, loss=losses[name]) if name in losses else body
        for name, body in robot.bodies.items()
    }
    return replace(robot, bodies=bodies, joints=tuple(joints), lengths=unit)
