"""Robot files of schema 1: what they say of the biglide, said of bodies and joints."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from lumped.legs import Leg
from lumped.mechanism.biglide import Stroke, biglide, lengthened
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file.leg_table import leg_faults, leg_of
from lumped.robot_file.rules.tables import BIGLIDE

_LEGS = ("leg1", "leg2")


def biglide_faults(tables: Mapping[str, Any]) -> list[str]:
    """Every fault of a robot file's tables, one line each, starting with its key."""
    faults = BIGLIDE.faults_within(tables)
    for name in _LEGS:
        rule = BIGLIDE.keys[name].kind
        if name in tables and not rule.faults(tables[name], name):
            leg = rule.read(tables[name])
            faults += leg_faults(leg, leg["length"], name)
    return faults or _reach_faults(BIGLIDE.read(tables))


def biglide_of(read: Mapping[str, Any]) -> Mechanism:
    """The biglide that tables without faults describe."""
    a, leg1, leg2 = _member(read)
    foot, tool = read["foot"], read["tool"]
    return biglide(
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


def _given(read: Mapping[str, Any]) -> tuple[float, Leg, Leg]:
    """Distance of the slides (m) and both legs as they stand in the file."""
    leg1, leg2 = (
        leg_of(read[name], read[name]["length"], f"leg {number}")
        for number, name in enumerate(_LEGS, start=1)
    )
    return read["geometry"]["a"], leg1, leg2


def _member(read: Mapping[str, Any]) -> tuple[float, Leg, Leg]:
    """Distance of the slides (m) and both legs, `alpha` times as long."""
    alpha = read["geometry"]["alpha"]
    given = _given(read)
    return given if alpha == 1.0 else lengthened(*given, alpha)


def _reach_faults(read: Mapping[str, Any]) -> list[str]:
    """Why the legs cannot meet: as they are, or `alpha` times as long."""
    places = {
        "geometry.a, leg1.length, leg2.length": _given(read),
        f"geometry.alpha = {read['geometry']['alpha']:g}": _member(read),
    }
    for place, (a, leg1, leg2) in places.items():
        if faults := Stroke(a, leg1.length, leg2.length).faults():
            return [f"{place}: {fault}" for fault in faults]
    return []
