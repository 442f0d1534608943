"""Robot files of schema 1: the mechanism of a biglide, or every fault of its description."""

from collections.abc import Mapping
from typing import Any

import msgspec
import numpy as np

from lumped.acceptance.measured import Measured, measured_faults, pose_faults
from lumped.legs import Leg
from lumped.mechanism.biglide import Stroke, biglide, lengthened
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file.biglide.corrections import can_be_scaled, correction_faults, value_at
from lumped.robot_file.leg_table import leg_faults, leg_of, symmetric
from lumped.robot_file.table_faults import table_faults
from lumped.robot_file.tables import (
    Correction,
    InputUncertainty,
    Length,
    MeasuredTable,
    RobotTables,
)
from lumped.text import shown


def biglide_faults(tables: Mapping[str, Any]) -> list[str]:
    """Every fault of a robot file's tables, one line each, starting with its key."""
    faults = table_faults(RobotTables, tables)
    for leg in ("leg1", "leg2"):
        faults += leg_faults(tables.get(leg), leg)
    faults += _geometry_faults(tables)
    faults = faults or _family_faults(msgspec.convert(tables, RobotTables))
    return faults or [
        *correction_faults(tables, corrections_of(tables)),
        *evidence_faults(tables, biglide_of(tables)),
    ]


def evidence_faults(tables: Mapping[str, Any], robot: Mechanism) -> list[str]:
    """Measured values that this robot cannot have, uncertainties of what stands nowhere."""
    faults = []
    for number, one in enumerate(measured_of(tables), start=1):
        place = f"measured[{number}]"
        faults += measured_faults(one, place) or pose_faults(robot, one, place)
    return faults + [
        f"input_uncertainty[{number}].key = {shown(one.key)}: must name a number or a matrix "
        'of this file, like "leg1.length" or "foot.compliance"'
        for number, one in enumerate(input_uncertainties_of(tables), start=1)
        if not can_be_scaled(tables, one.key)
    ]


def corrections_of(tables: Mapping[str, Any]) -> tuple[Correction, ...]:
    """Corrections of misprints that sound tables carry; none in a file of schema 2."""
    return tuple(msgspec.convert(tables.get("corrections", []), list[Correction]))


def measured_of(tables: Mapping[str, Any]) -> tuple[Measured, ...]:
    """Measured values that sound tables carry."""
    found = msgspec.convert(tables.get("measured", []), list[MeasuredTable])
    return tuple(
        Measured(one.quantity, one.value, one.uncertainty, one.source, tuple(one.pose), one.load)
        for one in found
    )


def input_uncertainties_of(tables: Mapping[str, Any]) -> tuple[InputUncertainty, ...]:
    """What sound tables say of how well their numbers are known."""
    return tuple(msgspec.convert(tables.get("input_uncertainty", []), list[InputUncertainty]))


def biglide_of(tables: Mapping[str, Any]) -> Mechanism:
    """The biglide that tables without faults describe."""
    return _robot(msgspec.convert(tables, RobotTables))


def _geometry_faults(tables: Mapping[str, Any]) -> list[str]:
    """Why the legs cannot meet; silent while a length itself is missing or wrong."""
    try:
        a, length1, length2 = (
            msgspec.convert(value_at(tables, key), Length)
            for key in ("geometry.a", "leg1.length", "leg2.length")
        )
    except (LookupError, msgspec.ValidationError):
        return []
    place = "geometry.a, leg1.length, leg2.length"
    return [f"{place}: {fault}" for fault in Stroke(a, length1, length2).faults()]


def _family_faults(tables: RobotTables) -> list[str]:
    """Why legs of `geometry.alpha` times their length cannot meet."""
    a, leg1, leg2 = _member(tables)
    alpha = tables.geometry.alpha
    faults = Stroke(a, leg1.length, leg2.length).faults()
    return [f"geometry.alpha = {alpha:g}: {fault}" for fault in faults]


def _member(tables: RobotTables) -> tuple[float, Leg, Leg]:
    """Distance of the slides (m) and both legs; where `alpha` is 1 they are as given."""
    geometry = tables.geometry
    given = geometry.a, leg_of(tables.leg1, "leg 1"), leg_of(tables.leg2, "leg 2")
    return given if geometry.alpha == 1.0 else lengthened(*given, geometry.alpha)


def _robot(tables: RobotTables) -> Mechanism:
    foot, tool = tables.foot, tables.tool
    a, leg1, leg2 = _member(tables)
    return biglide(
        tables.name,
        a,
        leg1,
        leg2,
        platform_mass=tables.platform.mass,
        drive_stiffness=tables.actuators.stiffness,
        tool_offset=np.array(tables.geometry.tool_offset, dtype=float),
        foot_compliance=None if foot is None else symmetric(foot.compliance),
        tool_compliance=symmetric(tool.compliance) if tool and tool.active else None,
    )
