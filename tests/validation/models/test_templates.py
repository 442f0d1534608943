"""Robots of `flexproof new` that are written in mm: mobility and one deflection of each by hand."""

from math import pi

import numpy as np
import pytest

from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from validation import api

E_ALUMINIUM, E_STEEL = 7.0e10, 2.1e11
# Rounding of the solution, times its condition number (1e4 and less).
ROUNDING = 1e-9


def compliance(robot):
    """Compliance (6×6, SI) of the tool in the reference posture, by model `links`."""
    mechanism = load_robot(robot).mechanism
    moves, per_metre = mechanism.tool.moves, mechanism.lengths.per_metre
    pose = [
        value * (per_metre if move in "xyz" else 1.0)
        for move, value in zip(moves, mechanism.reference_pose, strict=True)
    ]
    (answer,) = api.solve(robot, "links", poses=[pose]).answers
    return np.array(answer.compliance)


def box(width, height, thickness, nu):
    """Area, Iy, Iz and κ along y and z of a hollow rectangle; κ of Cowper's thin-walled box.

    Flange and web between the middle lines, Cowper (1966).
    """
    inner = width - 2.0 * thickness, height - 2.0 * thickness
    area = width * height - inner[0] * inner[1]
    second_y = (width * height**3 - inner[0] * inner[1] ** 3) / 12.0
    second_z = (height * width**3 - inner[1] * inner[0] ** 3) / 12.0
    b, h = width - thickness, height - thickness

    def kappa(flange, web):
        m = n = flange / web
        numerator = 10.0 * (1.0 + nu) * (1.0 + 3.0 * m) ** 2
        return numerator / (
            12.0
            + 72.0 * m
            + 150.0 * m**2
            + 90.0 * m**3
            + nu * (11.0 + 66.0 * m + 135.0 * m**2 + 90.0 * m**3)
            + 10.0 * n**2 * ((3.0 + nu) * m + 3.0 * m**2)
        )

    return area, second_y, second_z, kappa(h, b), kappa(b, h)


def tip(length, second, kappa_area, E, nu):
    """Tip deflection (m/N) of a Timoshenko cantilever, `second` moment (m⁴), κA `kappa_area`."""
    return length**3 / (3.0 * E * second) + length * 2.0 * (1.0 + nu) / (E * kappa_area)


@pytest.mark.parametrize(
    ("robot", "motions", "redundant"),
    [
        ("scara", 4, 0),
        # Two rails whose trucks a bridge joins rigidly: one drive too many, five constraints.
        ("gantry", 3, 5),
        ("stage", 2, 0),
        ("5R", 2, 3),
        ("tricept", 3, 0),
        # Six rods spin about themselves.
        ("linear-delta", 9, 0),
    ],
)
def test_template_has_expected_mobility(robot, motions, redundant):
    """Grübler: 6 (bodies) − constraints, plus redundant constraints."""
    mechanism = load_robot(robot).mechanism
    mechanism_mobility = mobility(reference_posture(mechanism))
    bodies = len(mechanism.bodies) - 1
    assert (mechanism_mobility.mobility, mechanism_mobility.redundant) == (motions, redundant)
    assert mechanism_mobility.mobility == 6 * bodies - (
        mechanism_mobility.constraints - mechanism_mobility.redundant
    )


def test_scara_deflects_as_arms_and_quill():
    """With arms at a right angle, both arms bend, and the forearm's lever twists the upper arm."""
    nu, L1, L2 = 0.33, 0.35, 0.25
    A1, Iy1, _, _, kz1 = box(0.12, 0.09, 0.012, nu)
    A2, Iy2, _, _, kz2 = box(0.09, 0.07, 0.01, nu)
    b, h, t = 0.108, 0.078, 0.012
    torsion = 2.0 * (b * h) ** 2 * t / (b + h)
    G = E_ALUMINIUM / 2.0 / (1.0 + nu)
    quill = pi / 4.0 * (0.025**2 - 0.015**2)
    down = (
        # Bearing of the shoulder: 2e-9 m/N along z, 1.2e-6 rad/(N m) about x and y.
        2e-9
        + 1.2e-6 * (L1**2 + L2**2)
        + tip(L1, Iy1, kz1 * A1, E_ALUMINIUM, nu)
        + L2**2 * L1 / (G * torsion)
        + tip(L2, Iy2, kz2 * A2, E_ALUMINIUM, nu)
        + 1.0 / 1e7
        + 0.3 / (E_STEEL * quill)
    )
    assert compliance("scara")[2, 2] == pytest.approx(down, rel=ROUNDING, abs=0.0)


def test_gantry_deflects_as_clamped_bridge():
    """Deflection in the middle of a beam with both ends clamped: L³/(192 EI) + L/(4 κGA).

    The compliances in series with the beam along z are added.
    """
    nu, L = 0.33, 1.2
    area, Iy, _, _, kappa = box(0.12, 0.16, 0.015, nu)
    bridge = L**3 / (192.0 * E_ALUMINIUM * Iy)
    bridge += L / 4.0 * 2.0 * (1.0 + nu) / (E_ALUMINIUM * kappa * area)
    ram = 0.6 / (E_STEEL * (0.08**2 - 0.064**2))
    down = bridge + 2e-9 + 1.0 / 5e7 + ram
    assert compliance("gantry")[2, 2] == pytest.approx(down, rel=ROUNDING, abs=0.0)


def test_stage_deflects_as_springs_in_series():
    """Compliances in series: drive or guide along the force, tilting of both guides, post.

    The guides lie 230 and 290 mm below the loaded point.
    """
    nu, L = 0.3, 0.2
    area = pi / 4.0 * (0.04**2 - 0.028**2)
    second = pi / 64.0 * (0.04**4 - 0.028**4)
    tool_compliance = compliance("stage")
    # κ of a tube, Cowper: m = inner / outer diameter.
    m = 0.7
    kappa = 6.0 * (1.0 + nu) * (1.0 + m**2) ** 2
    kappa /= (7.0 + 6.0 * nu) * (1.0 + m**2) ** 2 + (20.0 + 12.0 * nu) * m**2
    post = tip(L, second, kappa * area, E_STEEL, nu)
    lower, upper = 0.29**2, 0.23**2
    x = 1.0 / 1e8 + 1e-9 + 1e-6 * lower + 3e-9 + 2e-6 * upper + post
    y = 3e-9 + 2e-6 * lower + 1.0 / 8e7 + 1e-9 + 1e-6 * upper + post
    assert tool_compliance[0, 0] == pytest.approx(x, rel=ROUNDING, abs=0.0)
    assert tool_compliance[1, 1] == pytest.approx(y, rel=ROUNDING, abs=0.0)


def test_5r_deflects_as_axial_rods():
    """Rods at right angles to the cranks, along ±(0.6, 0.8): C = c (1/(2·0.6²), 1/(2·0.8²)).

    The compliance c along one rod is the sum of those of motor and crank (0.3 m) under a transverse
    force and those of elbow and rod under an axial force.
    """
    nu, crank, rod = 0.33, 0.3, 0.4
    area, _, Iz, kappa, _ = box(0.05, 0.06, 0.006, nu)
    along = crank**2 / 3e4 + tip(crank, Iz, kappa * area, E_ALUMINIUM, nu)
    along += 4e-9 + rod / (E_ALUMINIUM * box(0.04, 0.05, 0.005, nu)[0])
    tool_compliance = compliance("5R")
    assert tool_compliance[0, 0] == pytest.approx(along / (2.0 * 0.6**2), rel=ROUNDING, abs=0.0)
    assert tool_compliance[1, 1] == pytest.approx(along / (2.0 * 0.8**2), rel=ROUNDING, abs=0.0)


def test_tricept_deflects_as_three_legs():
    """Legs between a cardan and a ball joint carry axial force only: 1/(3 k cos² β) along z.

    k is the axial stiffness of a leg, and β its angle to the z axis.
    """
    length = np.hypot(0.18, 0.9)
    strut = pi / 4.0 * (0.08**2 - 0.07**2)
    screw = pi / 4.0 * 0.04**2
    part = 0.6 * length
    leg = part / (E_STEEL * strut) + 1.0 / 8e7 + part / (E_STEEL * screw)
    assert compliance("tricept")[2, 2] == pytest.approx(
        leg / (3.0 * (0.9 / length) ** 2), rel=ROUNDING, abs=0.0
    )


def test_linear_delta_deflects_as_axial_rods():
    """Six rods of 500 mm, 400 mm high, share the force. Three screws carry a third each."""
    rod = 0.5 / (E_ALUMINIUM * pi / 4.0 * (0.02**2 - 0.016**2))
    down = rod / (6.0 * 0.8**2) + 1.0 / (3.0 * 2e7)
    assert compliance("linear-delta")[2, 2] == pytest.approx(down, rel=ROUNDING, abs=0.0)
