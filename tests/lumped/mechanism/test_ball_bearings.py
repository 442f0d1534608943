"""Ball bearings: Hertz's closed form, examples of Harris, and rings moved by small amounts."""

import numpy as np
import pytest
from support.robots.robot_from_text import described

from lumped.errors import InputError
from lumped.mechanism.catalogue.ball_contact import (
    BallBearing,
    bearing_of_size,
    bearing_stiffness,
    curvature_difference,
    hertz_constant,
    static_load,
)
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.system.assembly import assemble
from lumped.system.solution import compliance, solved

# Of bearing steel, in both bodies: E/2(1 − ν²).
E_STAR = 2.075e11 / (2.0 * (1.0 - 0.3**2))


def test_sphere_contact_equals_hertz():
    """Q = (4/3) E* √R δ^(3/2) with 1/R = 1/R₁ + 1/R₂ (Johnson, Contact Mechanics, eq. 4.23)."""
    first, second = 5e-3, 8e-3
    radius = 1.0 / (1.0 / first + 1.0 / second)
    constant = hertz_constant((1.0 / first, 1.0 / first, 1.0 / second, 1.0 / second))
    assert constant == pytest.approx(4.0 / 3.0 * E_STAR * np.sqrt(radius), rel=1e-9)


@pytest.mark.parametrize(
    ("size", "inner", "outer"),
    [("6209", (202.0, 0.9399), (138.0, 0.9120)), ("7218", (108.0, 0.9260), (83.2, 0.9038))],
)
def test_curvatures_equal_harris(size, inner, outer):
    """Harris, Rolling Bearing Analysis, bearings 209 and 218: Σρ (1/m) and F(ρ), three digits."""
    bearing = bearing_of_size(size)
    D = bearing.ball_diameter
    gamma = D * np.cos(bearing.angle) / bearing.pitch_diameter
    along = {"inner": gamma / (1.0 - gamma), "outer": -gamma / (1.0 + gamma)}
    for side, (total, difference) in (("inner", inner), ("outer", outer)):
        groove = -1.0 / (getattr(bearing, side) * D)
        curvatures = (2.0 / D, 2.0 / D, 2.0 / D * along[side], groove)
        assert sum(curvatures) == pytest.approx(total, rel=3e-3)
        assert curvature_difference(curvatures) == pytest.approx(difference, abs=5e-4)


def test_steel_contact_equals_harris():
    """K = 2.15e5 Σρ^(−1/2) δ*^(−3/2) N/mm^1.5; inner contact of 218: 0.108/mm, δ* 0.634."""
    bearing = bearing_of_size("7218")
    D = bearing.ball_diameter
    gamma = D * np.cos(bearing.angle) / bearing.pitch_diameter
    constant = hertz_constant(
        (2.0 / D, 2.0 / D, 2.0 / D * gamma / (1.0 - gamma), -1.0 / (bearing.inner * D))
    )
    expected = 2.15e5 * 0.108**-0.5 * 0.634**-1.5 * 1e3**1.5
    assert constant == pytest.approx(expected, rel=5e-3)


def test_thrust_contact_angle_is_near_harris():
    """Bearing 218 under 17.8 kN: 41.6° by Harris, with contacts 10 % softer by Jones' chart."""
    angle, _ = bearing_of_size("7218").under_preload(17.8e3)
    assert np.degrees(angle) == pytest.approx(41.6, abs=0.15)
    # With the constant of the chart, K = 896.7 N/mm² of Q = K D² (cos α₀/cos α − 1)^1.5.
    angles = np.radians(np.linspace(41.0, 42.0, 100_001))
    stretch = np.cos(np.radians(40.0)) / np.cos(angles) - 1.0
    thrust = 16.0 * 896.7 * 22.23**2 * stretch**1.5 * np.sin(angles)
    chart = np.degrees(angles[np.argmin(np.abs(thrust - 17.8e3))])
    assert chart == pytest.approx(41.6, abs=0.05)


BEARINGS = {
    "angular": (BallBearing(12, 10e-3, 60e-3, np.radians(25.0), 0.52, 0.53), 600.0),
    "deep groove": (bearing_of_size("6205"), 300.0),
}


@pytest.mark.parametrize("kind", BEARINGS)
def test_ring_stiffness_is_force_derivative(kind):
    """Ball forces from the distance of the groove centres, differentiated by moving a ring 1 nm."""
    bearing, preload = BEARINGS[kind]
    angle, approach = bearing.under_preload(preload)
    stiffness = bearing.stiffness(preload, 1.0, 0.0)
    offset = (bearing.inner - 0.5) * bearing.ball_diameter
    radius = 0.5 * bearing.pitch_diameter + offset * np.cos(bearing.angle)
    start = (bearing.distance + approach) * np.sin(angle) - bearing.distance * np.sin(bearing.angle)

    def wrench(move):
        total = np.zeros(6)
        for turned in 2.0 * np.pi * np.arange(bearing.balls) / bearing.balls:
            radial = np.array([0.0, np.cos(turned), np.sin(turned)])
            axial = np.array([1.0, 0.0, 0.0])
            arm = radius * radial + offset * np.sin(bearing.angle) * axial
            displacement = move[:3] + np.cross(move[3:], arm) + start * axial
            line = bearing.distance * np.array([np.sin(bearing.angle), np.cos(bearing.angle)])
            line = line + np.array([displacement @ axial, displacement @ radial])
            length = np.linalg.norm(line)
            load = bearing.contact_constant * (length - bearing.distance) ** 1.5
            force = load / length * (line[0] * axial + line[1] * radial)
            total += np.concatenate([force, np.cross(arm, force)])
        return total

    assert wrench(np.zeros(6))[0] == pytest.approx(preload, rel=1e-9)
    steps = 1e-9 * np.eye(6)
    steps[3:] /= radius
    numeric = np.column_stack(
        [(wrench(step) - wrench(-step)) / (2.0 * np.abs(step).max()) for step in steps]
    )
    unit = np.array([1.0, 1.0, 1.0, radius, radius, radius])
    size = np.abs(stiffness / np.outer(unit, unit)).max()
    # Differences of 1e-9 m in forces of 1e2 N: 1e-6.
    assert np.abs((stiffness - numeric) / np.outer(unit, unit)).max() <= 1e-5 * size


def test_bearing_pair_is_twice_as_stiff():
    """O and X arrangements: axial and radial stiffness 2k, no coupling; O is stiffer in tilting."""
    bearing, preload = BEARINGS["angular"]
    single = bearing.stiffness(preload, 1.0, 0.0)
    matrices = {
        kind: bearing_stiffness(bearing, preload, 2, kind, 0.03) for kind in ("O", "X", "tandem")
    }
    for kind in ("O", "X"):
        np.testing.assert_allclose(np.diag(matrices[kind])[:3], 2.0 * np.diag(single)[:3])
        off_diagonal = matrices[kind] - np.diag(np.diag(matrices[kind]))
        assert np.abs(off_diagonal).max() <= 1e-9 * matrices[kind].max()
    assert matrices["O"][4, 4] > 2.0 * matrices["X"][4, 4]
    assert abs(matrices["tandem"][1, 5]) > 1e-3 * matrices["tandem"][1, 1] * 0.03
    assert not single[3:, 3].any() or abs(single[3, 3]) <= 1e-9 * single[4, 4]


def test_stiffness_grows_with_cube_root():
    """dF/dx ∝ F^(1/3) at a constant contact angle.

    Here the contact angle grows by 0.3°, which adds 1 to 2 %.
    """
    bearing, _ = BEARINGS["angular"]
    soft, stiff = (bearing.stiffness(preload, 1.0, 0.0)[0, 0] for preload in (1.0, 8.0))
    assert 2.0 < stiff / soft < 2.05


def test_static_load_of_spheres_equals_hertz():
    """p = (6 Q E*²/π³R²)^(1/3) = 4200 MPa (Johnson, Contact Mechanics, eq. 4.24)."""
    first, second = 5e-3, 8e-3
    radius = 1.0 / (1.0 / first + 1.0 / second)
    expected = (4.2e9 * np.pi) ** 3 * radius**2 / (6.0 * E_STAR**2)
    load = static_load((1.0 / first, 1.0 / first, 1.0 / second, 1.0 / second))
    assert load == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("size", "printed"), [("6203", 4.75e3), ("6205", 7.8e3)])
def test_static_rating_equals_catalogue(size, printed):
    """Radial static load rating C₀ = Z Q₀/5 (ISO 76), printed in catalogues with two digits."""
    bearing = bearing_of_size(size)
    assert bearing.balls * bearing.static_load / 5.0 == pytest.approx(printed, rel=0.01)


@pytest.mark.parametrize("size", ["6203", "7218"])
def test_largest_preload_has_static_load(size):
    """Under it, each ball carries the load of the static rating."""
    bearing = bearing_of_size(size)
    _, approach = bearing.under_preload(bearing.largest_preload)
    load = bearing.contact_constant * approach**1.5
    assert load == pytest.approx(bearing.static_load, rel=1e-9)


ARM = """
schema = 2
name = "arm"
points = { A = [0.0, 0.0, 0.0], P = [0.3, 0.0, 0.0] }
bodies.arm = { points = ["A", "P"], mass = 3.0, centre = "P" }
tool = { body = "arm", point = "P", moves = ["y"] }
[joints.a]
type = "revolute"
between = ["ground", "arm"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = "rigid" }
bearing = { BEARING }
"""


def test_bearing_joint_yields_as_rings():
    """A joint on two angular contact bearings: the compliance of the tool along x is 1/(2k)."""
    inside = "balls = 12, ball_diameter = 10e-3, pitch_diameter = 60e-3, contact_angle = 25.0"
    text = ARM.replace("BEARING", f"{inside}, preload = 600.0, rows = 2, distance = 0.03")
    tool_compliance = compliance(solved(assemble(reference_posture(described(text)), {})))
    matrix = bearing_stiffness(*BEARINGS["angular"], 2, "O", 0.03)
    assert tool_compliance[0, 0] == pytest.approx(1.0 / matrix[1, 1], rel=1e-9)
    assert tool_compliance[2, 2] == pytest.approx(
        1.0 / matrix[0, 0] + 0.3**2 / matrix[4, 4], rel=1e-9
    )
    sized = ARM.replace("BEARING", 'size = "6205", preload = 300.0')
    tool_compliance = compliance(solved(assemble(reference_posture(described(sized)), {})))
    assert 1e-9 < tool_compliance[0, 0] < 1e-7


FAULTS = {
    'size = "6205"': (
        "joints.a.bearing.preload: missing; must be a number above 0 N and at most 1e+07 N"
    ),
    'size = "6205", preload = 100.0, balls = 9': (
        "joints.a.bearing.balls: must be left out, because joints.a.bearing.size determines it"
    ),
    "balls = 9, ball_diameter = 0.01, preload = 100.0": (
        "joints.a.bearing.pitch_diameter: missing; must be given, or joints.a.bearing.size"
    ),
    "balls = 29, ball_diameter = 0.01, pitch_diameter = 0.06, preload = 100.0": (
        "joints.a.bearing.balls = 29: do not fit into their circle"
    ),
    'size = "6205", preload = 100.0, rows = 2': (
        "joints.a.bearing.distance: must be given for several rows, and left out for one"
    ),
    'size = "6205", preload = 20000.0': (
        "joints.a.bearing.preload = 20000.0: must be at most 1.98e+04 N, at which the balls reach "
        "the contact pressure of the static load rating, 4200 MPa (ISO 76)"
    ),
    'size = "6299", preload = 100.0': (
        'joints.a.bearing.size = "6299": must be "6203" or "6205" or "6209" or "7218"'
    ),
}


@pytest.mark.parametrize("bearing", FAULTS)
def test_invalid_bearing_is_refused(bearing):
    """Each fault of `bearings` gives one line with key, value and range."""
    with pytest.raises(InputError) as error:
        described(ARM.replace("BEARING", bearing))
    assert error.value.faults == (FAULTS[bearing],)
