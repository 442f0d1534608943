"""Stresses of a leg of two materials under a load of a robot file, by hand."""

import json

import pytest

from validation import api
from validation.forces.record import as_text

WIDTH, LOWER, UPPER, LENGTH, FORCE = 0.02, 0.006, 0.004, 0.3, 50.0
E_LOWER, E_UPPER = 7.0e10, 2.1e11


def strip(height, E, at):
    section = {"shape": "rectangle", "width": WIDTH, "height": height}
    return {"section": section, "material": {"E": E, "nu": 0.3, "rho": 5000.0}, "at": [0.0, at]}


def test_bimetal_cantilever_has_stresses_of_both_parts():
    """σ = E_i F L z/EI in the outer fibre of each part at the clamp (Timoshenko)."""
    upper_middle = 0.5 * (LOWER + UPPER)
    arm = {"from": "A", "to": "P"}
    arm["section"] = {
        "shape": "composite",
        "parts": [strip(LOWER, E_LOWER, 0.0), strip(UPPER, E_UPPER, upper_middle)],
    }
    robot = {
        "schema": 2,
        "name": "bimetal",
        "points": {"A": [0.0, 0.0, 0.0], "P": [LENGTH, 0.0, 0.0]},
        "bodies": {"arm": arm},
        "joints": {"root": {"type": "fixed", "between": ["ground", "arm"], "at": "A"}},
        "tool": {"body": "arm", "point": "P", "moves": []},
        "loads": [{"name": "push", "wrench": [0.0, 0.0, -FORCE, 0.0, 0.0, 0.0]}],
    }
    forces = api.forces(robot)
    stress = forces.poses[0].loads["push"].stresses["arm"]
    EA = WIDTH * (E_LOWER * LOWER + E_UPPER * UPPER)
    axis = E_UPPER * WIDTH * UPPER * upper_middle / EA
    EI = E_LOWER * WIDTH * (LOWER**3 / 12.0 + LOWER * axis**2)
    EI += E_UPPER * WIDTH * (UPPER**3 / 12.0 + UPPER * (upper_middle - axis) ** 2)
    aluminium, steel = (
        E * FORCE * LENGTH * fibre / EI
        for E, fibre in ((E_LOWER, 0.5 * LOWER + axis), (E_UPPER, 0.5 * LOWER + UPPER - axis))
    )
    assert stress.parts == pytest.approx((aluminium, steel), rel=1e-4)
    assert stress.largest == pytest.approx(max(aluminium, steel), rel=1e-4)
    assert stress.half_width < 0.01 * stress.largest
    assert stress.station == 0.0
    (load,) = json.loads(forces.json())["results"][0]["loads"].values()
    assert load["stresses"]["arm"]["parts"] == pytest.approx([aluminium, steel], rel=1e-4)
    assert "largest in each part" in as_text(forces)
