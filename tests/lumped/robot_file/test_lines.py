"""Tapered and curved legs in robot files: geometry, mass, copies, and faults."""

import numpy as np
import pytest

from lumped.errors import InputError
from lumped.legs import LineLeg, given_compliance
from lumped.robot_file import load_robot
from lumped.robot_file.load import robot_of
from lumped.robot_file.places import numbers_of, unit_of, value_at, with_value

STEEL = {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}
STOUT = {"shape": "rectangle", "width": 0.06, "height": 0.04}
SLENDER = {"shape": "rectangle", "width": 0.03, "height": 0.03}
TAPER = [{"at": 0.0, **STOUT}, {"at": 1.0, **SLENDER}]


def tables(points=None, **leg):
    """Return the tables of a cantilever from A to B that has a leg along a line."""
    leg_table = {"from": "A", "to": "B", "material": STEEL, **leg}
    return {
        "schema": 2,
        "name": "arm",
        "points": {"A": [0.0, 0.0, 0.0], "B": [0.6, 0.3, 0.0], **(points or {})},
        "bodies": {"arm": leg_table},
        "joints": {"root": {"type": "fixed", "between": ["ground", "arm"], "at": "A"}},
        "tool": {"body": "arm", "point": "B", "moves": []},
    }


def leg_of(**leg):
    points = leg.pop("points", None)
    shape = robot_of(tables(points, **leg)).mechanism.bodies["arm"].shape
    assert isinstance(shape, LineLeg)
    return shape


def test_line_length_of_corner_and_arc():
    """0.3 m straight, then a quarter circle of radius 0.3 m: a length of 0.3 + 0.15 π m."""
    middle = [0.3 + 0.3 * np.sqrt(0.5), 0.3 * (1.0 - np.sqrt(0.5)), 0.0]
    leg = leg_of(points={"K": [0.3, 0.0, 0.0]}, through=["K", {"arc": middle}], section=STOUT)
    assert leg.line.length == pytest.approx(0.3 + 0.15 * np.pi, rel=1e-12)
    assert leg.line.smallest_radius == pytest.approx(0.3, rel=1e-9)
    assert leg.line.corners == ()
    assert leg.length == pytest.approx(np.hypot(0.6, 0.3), rel=1e-12)
    bent = leg_of(through=[[0.3, 0.0, 0.0]], section=STOUT)
    assert bent.line.corners == pytest.approx((0.3,))


def test_stations_are_fractions_or_points():
    """`at` of a section: a fraction of the length, or a point on the line."""
    leg = leg_of(
        points={"K": [0.4, 0.2, 0.0]},
        through=["K"],
        sections=[{"at": "A", **STOUT}, {"at": "K", **STOUT}, {"at": "B", **SLENDER}],
    )
    assert [position for position, _ in leg.stations] == pytest.approx(
        [0.0, np.hypot(0.4, 0.2), np.hypot(0.6, 0.3)]
    )
    half = leg_of(sections=[{"at": 0.0, **STOUT}, {"at": 0.5, **SLENDER}, {"at": 1.0, **SLENDER}])
    assert half.stations[1][0] == pytest.approx(0.5 * np.hypot(0.6, 0.3))
    assert half.section_at(0.25 * half.line.length).width == pytest.approx(0.045)


def test_tapered_leg_mass_is_exact():
    """∫ b h over the length fraction with linear b and h is (b₀h₀ + b₁h₁ + (b₀h₁ + b₁h₀)/2)/3."""
    length = np.hypot(0.6, 0.3)
    area = (0.06 * 0.04 + 0.03 * 0.03 + 0.5 * (0.06 * 0.03 + 0.03 * 0.04)) / 3.0
    assert leg_of(sections=TAPER).mass == pytest.approx(7850.0 * area * length, rel=1e-12)
    weighed = {key: value for key, value in STEEL.items() if key != "rho"}
    assert leg_of(sections=TAPER, material=weighed, mass=2.5).mass == pytest.approx(2.5, rel=1e-12)


def test_tapered_leg_in_mm_is_equal():
    """One tapered leg in a file in m and in a file in mm: equal compliances."""
    file = tables(through=[[0.3, 0.0, 0.0]], sections=TAPER)
    small = tables(through=[[300.0, 0.0, 0.0]])
    small |= {"units": "mm", "points": {"A": [0.0, 0.0, 0.0], "B": [600.0, 300.0, 0.0]}}
    small["bodies"]["arm"]["sections"] = [
        {"at": 0.0, "shape": "rectangle", "width": 60.0, "height": 40.0},
        {"at": 1.0, "shape": "rectangle", "width": 30.0, "height": 30.0},
    ]
    legs = [robot_of(entry).mechanism.bodies["arm"].shape for entry in (file, small)]
    assert given_compliance(legs[0]) == pytest.approx(given_compliance(legs[1]), rel=1e-12)


def test_sizes_at_stations_have_keys():
    """The key sections[2].width can be read, has a unit, and can be varied."""
    file = tables(sections=TAPER)
    key = "bodies.arm.sections[2].width"
    assert dict(numbers_of(file))[key] == 0.03
    assert value_at(file, key) == 0.03
    assert unit_of(file, key) == "m"
    changed = robot_of(with_value(file, key, 0.05)).mechanism.bodies["arm"].shape
    assert changed.stations[-1][1].width == 0.05


def test_copied_tapered_leg_is_rotated():
    """Three copies of a curved leg about z have equal compliances in their own axes."""
    three = {"about": "z", "count": 3}
    file = tables(points={"K": {"at": [0.3, 0.0, 0.1], "pattern": three}})
    for name in ("A", "B"):
        file["points"][name] = {"at": [0.1, 0.0, 0.0] if name == "A" else [0.6, 0.3, 0.0]}
        file["points"][name]["pattern"] = three
    file["bodies"]["arm"] |= {
        "through": ["K", {"arc": [0.5, 0.1, 0.1]}],
        "sections": [{"at": 0.0, **STOUT}, {"at": "K", **STOUT}, {"at": 1.0, **SLENDER}],
        "pattern": three,
    }
    file["joints"]["root"]["pattern"] = three
    file["bodies"]["plate"] = {"points": ["B1", "B2", "B3"]}
    file["joints"]["tip"] = {
        "type": "fixed",
        "between": ["arm", "plate"],
        "at": "B",
        "pattern": three,
    }
    file["tool"] = {"body": "plate", "point": "B1", "moves": []}
    bodies = robot_of(file).mechanism.bodies
    first, *rotated_copies = (given_compliance(bodies[f"arm{n}"].shape) for n in (1, 2, 3))
    for other in rotated_copies:
        assert np.abs(other - first).max() < 1e-9 * np.abs(first).max()


FAULTS = {
    "arm.sections[1].at = 0.2: must be 0": {"sections": [{"at": 0.2, **STOUT}, TAPER[1]]},
    "arm.sections[2].at = 0.9: must be 1": {"sections": [TAPER[0], {"at": 0.9, **SLENDER}]},
    "arm.sections[1].at: missing": {"sections": [STOUT, TAPER[1]]},
    "arm.sections[2].at = 2.0: must be at most 1": {"sections": [TAPER[0], {"at": 2.0, **SLENDER}]},
    'arm.sections[2].at = "C": must be a corner or an end of the line (A, B)': {
        "sections": [TAPER[0], {"at": "C", **SLENDER}]
    },
    'arm.sections[2].shape = "circle": must be "rectangle"': {
        "sections": [TAPER[0], {"at": 1.0, "shape": "circle", "diameter": 0.03}]
    },
    "arm.sections[2].width: missing": {
        "sections": [TAPER[0], {"at": 1.0, "shape": "rectangle", "height": 0.03}]
    },
    "arm.sections[3].at = 0.3: must not come before": {
        "sections": [TAPER[0], {"at": 0.5, **STOUT}, {"at": 0.3, **STOUT}, TAPER[1]]
    },
    "arm.sections[4]: the third section at one position": {
        "sections": [TAPER[0], *3 * [{"at": 0.5, **STOUT}], TAPER[1]]
    },
    "arm: has section and sections and material": {"section": STOUT, "sections": TAPER},
    "arm.through[1].arc: lies in line": {"through": [{"arc": [0.4, 0.2, 0.0]}], "section": STOUT},
    "arm.through[2].arc: follows another arc": {
        "through": [{"arc": [0.3, 0.3, 0.0]}, {"arc": [0.4, 0.3, 0.0]}],
        "section": STOUT,
    },
    "arm.through[1]: must be apart": {"through": [[0.0, 0.0, 0.0]], "section": STOUT},
    "arm.up: missing; the default, [0, 0, 1], lies along": {
        "through": [[0.0, 0.0, 0.2]],
        "section": STOUT,
    },
    "arm.section: 0.06 m across; must be below the diameter": {
        "through": [[0.58, 0.3, 0.0], {"arc": [0.59, 0.31, 0.0]}],
        "section": STOUT,
    },
    'arm.section.shape = "angle": must have two axes': {
        "through": [{"arc": [0.4, 0.0, 0.0]}],
        "section": {"shape": "angle", "width": 0.03, "height": 0.03, "flange": 0.003, "web": 0.003},
    },
    "arm.through: must be left out, because bodies.arm.compliance": {
        "through": [[0.3, 0.0, 0.0]],
        "compliance": (1e-6 * np.eye(6)).tolist(),
        "mass": 1.0,
        "material": None,
    },
    "arm.sections[1]: 0.9 m across": {
        "sections": [
            {"at": station, "shape": "circle", "diameter": size}
            for station, size in ((0.0, 0.9), (1.0, 0.1))
        ]
    },
    "arm.sections[2]: a properties has no sizes": {
        "sections": [
            {"at": station, "shape": "properties", "A": area, "Iy": 1e-8, "Iz": 1e-8, "J": 1e-8}
            for station, area in ((0.0, 1e-3), (1.0, 2e-3))
        ]
    },
}


@pytest.mark.parametrize("fault", FAULTS)
def test_invalid_tapered_leg_is_refused(fault):
    """Each fault gives one line that begins with its key."""
    leg = {"material": STEEL, **FAULTS[fault]}
    file = tables(**{key: value for key, value in leg.items() if value is not None})
    if leg["material"] is None:
        del file["bodies"]["arm"]["material"]
    with pytest.raises(InputError) as error:
        robot_of(file)
    assert len(error.value.faults) == 1, error.value.faults
    assert error.value.faults[0].startswith(f"dictionary: bodies.{fault}"), error.value.faults


def test_equal_sections_give_prism():
    """A leg with one `section` is a prism; equal `sections` give a line leg of equal compliance."""
    prism = robot_of(tables(section=STOUT)).mechanism.bodies["arm"].shape
    assert not isinstance(prism, LineLeg)
    line = leg_of(sections=[{"at": 0.0, **STOUT}, {"at": 1.0, **STOUT}])
    assert given_compliance(line) == pytest.approx(given_compliance(prism), rel=1e-12, abs=1e-20)


def test_built_in_robots_have_prisms():
    """Robots without `sections` have legs of constant section, as before."""
    assert not any(
        isinstance(body.shape, LineLeg) for body in load_robot("delta").mechanism.bodies.values()
    )
