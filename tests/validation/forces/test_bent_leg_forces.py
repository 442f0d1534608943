"""Section forces and stresses of bent, curved and stepped legs, against closed forms."""

from pathlib import Path

import numpy as np
import pytest
from support.robots.hook import HOOK_LEG, HOOK_POINTS
from support.robots.robot_from_text import described

from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from fem.bodies.stresses import nodal_stresses, von_mises
from fem.sections.saint_venant import section_quadrature
from fem.sections.stresses import curved_stresses
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import LineLeg, Material
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from lumped.robot_file.load import robot_of
from lumped.sections import Circle, HollowRectangle, ISection, Polygon, Rectangle, Tube
from lumped.sections.composite import outline as drawn
from lumped.sections.polygons import wall_thickness
from lumped.system.members import MemberForces
from meshes.section.section_mesh import section_mesh
from validation.forces.analysis import forces
from validation.forces.stresses import member_stress
from validation.models.loads.statics import load_forces
from validation.models.options import ModelOptions
from validation.solve.question import Question

SWAN_NECK = Path(__file__).parents[3] / "examples" / "tapered-arm" / "robot.toml"
STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
RADIUS, FORCE, WEIGHT = 0.15, 300.0, 9.81
# A quarter circle about (0, R, 0), which starts along x.
ARC = f"""
schema = 2
name = "hook"
points.A = [0.0, 0.0, 0.0]
points.M = [{RADIUS * np.sqrt(0.5)}, {RADIUS * (1.0 - np.sqrt(0.5))}, 0.0]
points.P = [{RADIUS}, {RADIUS}, 0.0]
materials.steel = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}
tool = {{ body = "hook", point = "P", moves = [] }}
joints.clamp = {{ type = "fixed", between = ["ground", "hook"], at = "A" }}
[bodies.hook]
from = "A"
to = "P"
through = [{{ arc = "M" }}]
section = {{ shape = "rectangle", width = 0.1, height = 0.04 }}
material = "steel"
"""


def load(**keys):
    """Return the table of a load in a robot file."""
    values = "\n".join(f"{key} = {value}" for key, value in keys.items())
    return f'[[loads]]\nname = "load"\n{values}\n'


def solved(text, model="beam"):
    """Return leg, section forces and reaction of a clamped leg under its load."""
    robot = described(text)
    ((result,),) = load_forces(model, [reference_posture(robot)], ModelOptions(elements=4))
    (member,), (reaction,) = result.members, result.reactions
    return robot.bodies[member.leg].shape, member, reaction


def arc(radius, angle):
    """Return an arc with the x axis as its chord, which bulges along y."""
    chord, rise = 2.0 * radius * np.sin(angle / 2.0), radius * (1.0 - np.cos(angle / 2.0))
    piece = LinePiece((0.0, 0.0, 0.0), (chord, 0.0, 0.0), (chord / 2.0, rise, 0.0))
    return CentreLine((piece,), (0.0, 0.0, 1.0))


@pytest.mark.parametrize("model", ["beam", "segments", "links", "simplified"])
def test_quarter_circle_forces_are_closed_form(model):
    """Under F along the tip's tangent and across the plane, at the angle a from the root.

    N = F sin a, Qy = F cos a, Mz = FR(1 − sin a); Qz = F, T = FR(1 − sin a), My = −FR cos a.
    """
    text = ARC + load(wrench=[0.0, FORCE, FORCE, 0.0, 0.0, 0.0])
    _, member, _ = solved(text, model)
    sine, cosine = np.sin(member.stations / RADIUS), np.cos(member.stations / RADIUS)
    moment = FORCE * RADIUS
    expected = np.column_stack(
        [
            FORCE * sine,
            FORCE * cosine,
            np.full(len(sine), FORCE),
            moment * (1.0 - sine),
            -moment * cosine,
            moment * (1.0 - sine),
        ]
    )
    assert np.abs(member.forces - expected).max() < 1e-9 * FORCE
    assert member.half_width.max() < 1e-9 * FORCE


@pytest.mark.parametrize(("share", "column", "angle"), [(0.75, 4, 0.6435), (-0.75, 3, 0.9273)])
def test_extremes_of_moments_across_arc_are_exact(share, column, angle):
    """A quarter circle under F across its plane and the moment mFR across its tip.

    My = −FR (cos a + m sin a), T = FR (1 − sin a + m cos a). Qz = F has no zero. My has its extreme
    at tan a = m, and T at tan a = −1/m.
    """
    moment = FORCE * RADIUS
    _, member, _ = solved(ARC + load(wrench=[0.0, 0.0, FORCE, share * moment, 0.0, 0.0]))
    root = np.hypot(1.0, share)
    expected = moment * (1.0 - root if column == 3 else -root)
    values = member.forces[:, column]
    row = int(np.argmin(values))
    assert values[row] == pytest.approx(expected, rel=1e-9)
    assert member.stations[row] == pytest.approx(RADIUS * angle, rel=1e-4)


def test_curved_bar_stress_is_winklers():
    """σ = M (rₙ − r)/A e r with rₙ = h/ln(rₒ/rᵢ), e = R − rₙ (Timoshenko, Strength of Materials).

    With R = 1.5 h the stress at the inside is 1.3 times that of a straight bar.
    """
    leg, member, _ = solved(ARC + load(wrench=[0.0, 0.0, 0.0, 0.0, 0.0, FORCE]))
    stress = member_stress(leg, member)
    inner, outer = RADIUS - 0.05, RADIUS + 0.05
    neutral = 0.1 / np.log(outer / inner)
    expected = FORCE * (neutral - inner) / (0.1 * 0.04 * (RADIUS - neutral) * inner)
    assert 1.25 < expected / (6.0 * FORCE / (0.04 * 0.1**2)) < 1.35
    # Integrals of 1/r on the section's mesh.
    assert stress.largest == pytest.approx(expected, rel=1e-6)
    assert stress.normal == pytest.approx(-expected, rel=1e-6)
    # The centre of the arc lies along y.
    assert stress.point[0] == pytest.approx(0.05, rel=1e-9)


def hook_stress(section, wrench, radius=RADIUS):
    """Return the stress of a section of a hook under a wrench in the axes of the section."""
    line = arc(radius, 1.0)
    leg = LineLeg(line, ((0.0, section), (line.length, section)), STEEL)
    runs = np.zeros(1, dtype=int)
    member = MemberForces("hook", np.zeros(1), np.array([wrench]), np.zeros(6), runs)
    return member_stress(leg, member)


@pytest.mark.parametrize("ratio", [1.1, 1.5, 2.0, 4.0, 10.0])
def test_half_width_contains_error_of_winklers_bar(ratio):
    """Golovin's exact stresses of a narrow ring sector under M, and under N = F with M = FR.

    σ = −4M/N (−(a²b²/r²) ln b/a + b² ln r/b + a² ln a/r + b² − a²) and
    σ = F/N' (a²b²/r³ + (a² + b²)/r − 3r), Timoshenko and Goodier, Theory of Elasticity, ch. 4.
    """
    height, thickness = 0.1, 1e-3
    a = height / (ratio - 1.0)
    b = ratio * a
    r, log = np.array([a, b]), np.log(ratio)
    constant = (b**2 - a**2) ** 2 - 4.0 * (a * b * log) ** 2
    bending = (a * b / r) ** 2 * log - b**2 * np.log(r / b) - a**2 * np.log(a / r) - b**2 + a**2
    bending *= 4.0 / constant
    force = (a * b) ** 2 / r**3 + (a**2 + b**2) / r - 3.0 * r
    force /= a**2 - b**2 + (a**2 + b**2) * log
    radius = 0.5 * (a + b)
    for exact, wrench in (
        (bending, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
        (force, [1.0, 0.0, 0.0, 0.0, 0.0, radius]),
        # A normal force alone.
        (force - radius * bending, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    ):
        stress = hook_stress(Rectangle(height, thickness), wrench, radius)
        error = abs(np.abs(exact).max() / thickness - stress.largest)
        assert error < stress.half_width
        if ratio < 3.0:
            assert stress.half_width < 3.0 * error


def test_polygon_has_half_width_of_its_walls():
    """Walls of tubes and an I-section on an arc bend as much if they are drawn as polygons."""
    for section in (HollowRectangle(0.04, 0.03, 0.002), ISection(0.03, 0.04, 0.002, 0.002)):
        outline, *holes = (tuple(map(tuple, loop.tolist())) for loop in drawn(section))
        wrench = [0.0, 0.0, 0.0, 0.0, FORCE, FORCE]
        shape, polygon = (
            hook_stress(section, wrench),
            hook_stress(Polygon(outline, tuple(holes)), wrench),
        )
        assert polygon.half_width == pytest.approx(shape.half_width, rel=0.03)
        assert polygon.half_width > 0.5 * polygon.largest
    assert wall_thickness(drawn(Tube(0.04, 0.002))) == pytest.approx(0.002, rel=0.01)
    solid = Polygon(((0.0, 0.0), (0.04, 0.0), (0.04, 0.03), (0.0, 0.03)))
    bar = hook_stress(Rectangle(0.04, 0.03), wrench)
    assert hook_stress(solid, wrench).half_width == pytest.approx(bar.half_width, rel=0.03)


def test_slender_arc_tends_to_straight_formula():
    """The largest stress of a rectangle exceeds Mh/2I by h/3R: doubling R halves the excess."""
    leg, _, _ = solved(ARC + load(wrench=[0.0, 0.0, 0.0, 0.0, 0.0, FORCE]))
    mesh = section_mesh(leg.spans[0].first, 4)
    curvatures = [0.5, 0.25]
    states = [curved_stresses(mesh, leg.material, (curvature, 0.0)) for curvature in curvatures]
    straight = curved_stresses(mesh, leg.material, (0.0, 0.0))
    largest = np.array([np.abs(state.normal[:, 5]).max() for state in states])
    excess = largest / np.abs(straight.normal[:, 5]).max() - 1.0
    assert excess == pytest.approx(0.1 * np.array(curvatures) / 3.0, rel=0.03)
    # The integrals of the stress are the section forces.
    quad = section_quadrature(mesh)
    normal = states[0].normal[:, [0, 4, 5]].T
    fields = np.array([quad.value(column) for column in normal])
    y, z = quad.points
    forces = [[quad.integral(field * arm) for field in fields] for arm in (np.ones_like(y), z, -y)]
    assert np.array(forces) == pytest.approx(np.eye(3), abs=2e-6)


LEVER, ARM = 0.4, 0.25
FRAME = f"""
schema = 2
name = "frame"
points.A = [0.0, 0.0, 0.0]
points.K = [0.0, {LEVER}, 0.0]
points.P = [{ARM}, {LEVER}, 0.0]
materials.steel = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}
tool = {{ body = "frame", point = "P", moves = [] }}
joints.clamp = {{ type = "fixed", between = ["ground", "frame"], at = "A" }}
[bodies.frame]
from = "A"
to = "P"
through = ["K"]
section = {{ shape = "rectangle", width = 0.02, height = 0.05 }}
material = "steel"
"""


def test_frame_corner_has_forces_of_both_pieces():
    """A column of height H carries an arm of length a with the tip force −F along the column.

    In the column N = −F, Mz = −Fa. In the arm Qy = −F, Mz = −F (a − x). The stress is largest in
    the column: F/A + Fa h/2I.
    """
    leg, member, reaction = solved(FRAME + load(wrench=[0.0, -FORCE, 0.0, 0.0, 0.0, 0.0]))
    corner = np.flatnonzero(np.isclose(member.stations, LEVER))
    assert member.runs[corner].tolist() == [0, 1]
    expected = (
        [-FORCE, 0.0, 0.0, 0.0, 0.0, -FORCE * ARM],
        [0.0, -FORCE, 0.0, 0.0, 0.0, -FORCE * ARM],
    )
    assert member.forces[corner] == pytest.approx(np.array(expected), abs=1e-9 * FORCE)
    column = member.forces[member.runs == 0]
    assert np.abs(column - expected[0]).max() < 1e-9 * FORCE
    arm = member.runs == 1
    beyond = ARM + LEVER - member.stations[arm]
    assert member.forces[arm, 5] == pytest.approx(-FORCE * beyond, abs=1e-9 * FORCE)
    assert reaction.wrench[1] == pytest.approx(FORCE, rel=1e-9)
    stress = member_stress(leg, member)
    bending = 6.0 * FORCE * ARM / (0.05 * 0.02**2)
    assert stress.largest == pytest.approx(FORCE / 1e-3 + bending, rel=1e-6)
    # The arm has no axial force.
    assert stress.along[corner[1] + 1] < bending


HOOK = (
    HOOK_POINTS
    + """
tool = { body = "hook", point = "P", moves = ["y"], mass = 2.0 }
[joints.turntable]
type = "revolute"
between = ["ground", "hook"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = 4.0e5 }
[path]
from = [0.0]
to = [0.1]
count = 2
"""
    + HOOK_LEG
)


@pytest.mark.parametrize("model", ["beam", "links"])
def test_swung_hook_is_in_equilibrium(model):
    """Weight, inertia and centrifugal forces on the mass of the leg balance its ends to 1e-9.

    The ends have the wrenches of Newton's and Euler's equations for the mass of the model.
    """
    keys = {
        "gravity": [0.0, 0.0, -9.81],
        "speed": [0.0, 0.8, 0.0],
        "acceleration": [0.0, 2.0, 0.0],
        "wrench": [10.0, 20.0, 30.0, 1.0, 2.0, 3.0],
    }
    _, member, _ = solved(HOOK + load(**keys), model)
    size = np.abs(member.forces).max()
    assert member.half_width.max() < 1e-9 * size


def test_line_loads_of_bent_leg_add_up():
    """A load per length of the line, in base axes, has its resultant in the clamp."""
    lines = [
        '{ leg = "frame", wrench = [20.0, -50.0, 30.0, 0.0, 0.0, 4.0], from = 0.1, to = 0.6 }',
    ]
    text = FRAME + f'[[loads]]\nname = "snow"\nlines = [{", ".join(lines)}]\n'
    _, member, reaction = solved(text)
    # Column from 0.1 m, arm to 0.2 m.
    force = np.array([20.0, -50.0, 30.0])
    column, arm = LEVER - 0.1, 0.2
    centres = (np.array([0.0, LEVER - column / 2.0, 0.0]), np.array([arm / 2.0, LEVER, 0.0]))
    moment = sum(
        np.cross(centre, force * length) + np.array([0.0, 0.0, 4.0 * length])
        for centre, length in zip(centres, (column, arm), strict=True)
    )
    assert reaction.wrench == pytest.approx(-np.append(force * (column + arm), moment), rel=1e-9)
    assert np.abs(member.forces[-1]).max() < 1e-9
    # Root: x along the column (base y), y = z × x = −x, z.
    at_root = -reaction.wrench.reshape(2, 3)[:, [1, 0, 2]] * [1.0, -1.0, 1.0]
    assert member.forces[0] == pytest.approx(at_root.ravel(), rel=1e-9)


def test_weight_of_stepped_column_is_exact():
    """The axial force of a standing column is the weight above: it has a kink at the step."""
    text = (
        FRAME.replace('through = ["K"]', "")
        .replace(
            'section = { shape = "rectangle", width = 0.02, height = 0.05 }',
            "sections = ["
            '{ at = 0.0, shape = "rectangle", width = 0.06, height = 0.05 }, '
            '{ at = 0.5, shape = "rectangle", width = 0.06, height = 0.05 }, '
            '{ at = 0.5, shape = "rectangle", width = 0.02, height = 0.05 }, '
            '{ at = 1.0, shape = "rectangle", width = 0.02, height = 0.05 }]',
        )
        .replace(f"points.K = [0.0, {LEVER}, 0.0]", "")
        .replace(f"P = [{ARM},", "P = [0.0,")
    )
    _, member, _ = solved(text + load(gravity=[0.0, -WEIGHT, 0.0]))
    above = LEVER - member.stations
    thick = np.maximum(above - LEVER / 2.0, 0.0)
    mass = 7850.0 * 0.05 * (0.02 * (above - thick) + 0.06 * thick)
    assert member.forces[:, 0] == pytest.approx(-WEIGHT * mass, abs=1e-9 * WEIGHT)


def test_hook_stress_equals_that_of_solid():
    """Bending and torsion of an arc with R = 1.5 h, in the middle of three eighths of a circle.

    The solid of two elements across the thickness has the largest stress in bending to 1 %; a
    straight bar has 24 % less. In torsion it is 20 % larger, within the half-width.
    """
    section = Rectangle(0.1, 0.04)
    solid_stress = middle_of_hook(section, 2)
    for wrench, tolerance in (([0, 0, 0, 0, 0, 1.0], 0.01), ([0, 0, 0, 1.0, 0, 0], None)):
        stress = hook_stress(section, wrench)
        width = stress.half_width if tolerance is None else tolerance * stress.largest
        assert abs(solid_stress(wrench) - stress.largest) < width


def test_half_width_contains_uneven_torsion_of_hook():
    """My across the plane of an arc changes the torque along it: cross-sections warp unevenly.

    In a tall section the largest stress is 40 % higher for this reason.
    """
    section, wrench = Rectangle(0.04, 0.1), [0, 0, 0, 0, 1.0, 0]
    stress, of_solid = hook_stress(section, wrench), middle_of_hook(section, 1)(wrench)
    assert of_solid == pytest.approx(1.4 * stress.largest, rel=0.03)
    assert of_solid - stress.largest < stress.half_width < 0.55 * stress.largest


def middle_of_hook(section, divisions):
    """Return a function: largest stress of a solid hook, in its middle, under a wrench at its tip.

    Moments alone are those in the middle, too, where the section's x axis is that of the leg.
    """
    line = arc(RADIUS, 0.75 * np.pi)
    leg = LineLeg(line, ((0.0, section), (line.length, section)), STEEL, "free")
    mesh = solid_mesh(leg, divisions)
    solid = clamped_leg(solid_leg(leg, mesh), "free")
    shares = line.nearest(mesh.nodes) / line.length
    middle = np.abs(shares - 0.5) < np.abs(shares - 0.5).min() + 1e-6

    def largest(wrench):
        unknowns = solid.flexibility((solid.loads @ np.array(wrench))[:, None])[:, 0]
        displacements = (solid.solid.transformation @ unknowns).reshape(-1, 3)
        return von_mises(nodal_stresses(mesh, STEEL, displacements)[middle]).max()

    return largest


def test_half_width_contains_torsion_of_curved_bar():
    """τ = 16T/πd³ (1 + 5/4 d/D + 7/8 (d/D)²) at the inside of a round bar, D = 2R (Göhner)."""
    diameter, line = 0.03, arc(RADIUS, 1.0)
    bar = Circle(diameter)
    leg = LineLeg(line, ((0.0, bar), (line.length, bar)), STEEL)
    forces, runs = np.array([[0.0, 0.0, 0.0, FORCE, 0.0, 0.0]]), np.zeros(1, dtype=int)
    stress = member_stress(leg, MemberForces("bar", np.zeros(1), forces, np.zeros(6), runs))
    straight = np.sqrt(3.0) * 16.0 * FORCE / (np.pi * diameter**3)
    assert stress.largest == pytest.approx(straight, rel=1e-3)
    ratio = diameter / (2.0 * RADIUS)
    excess = straight * (1.25 * ratio + 0.875 * ratio**2)
    assert excess < stress.half_width < 2.0 * excess


def test_half_width_contains_flattening_of_pipe():
    """Kármán: a curved pipe has stresses of 18λ/(1 + 12λ²) Mr/I across its wall, λ = tR/r².

    The middle line of the wall has the radius r. The stress along the pipe is lower at its crown.
    """
    pipe, line = Tube(0.032, 0.002), arc(RADIUS, 1.0)
    leg = LineLeg(line, ((0.0, pipe), (line.length, pipe)), STEEL)
    forces, runs = np.array([[0.0, 0.0, 0.0, 0.0, 0.0, FORCE]]), np.zeros(1, dtype=int)
    stress = member_stress(leg, MemberForces("pipe", np.zeros(1), forces, np.zeros(6), runs))
    radius = 0.015
    ratio = 0.002 * RADIUS / radius**2
    across = 18.0 * ratio / (1.0 + 12.0 * ratio**2) * FORCE * radius / pipe.second_moment_z
    assert 0.5 * stress.largest < across < stress.half_width


def test_segment_count_leaves_forces_of_arm():
    """Forces of an arm on one joint do not depend on the number of segments.

    Round-off in shear forces that are zero adds other stations to each solution.
    """
    push = {"name": "push", "wrench": [-2.0e5, 0.0, 0.0, 0.0, 0.0, 0.0]}
    robot = robot_of({**load_robot(SWAN_NECK).tables, "loads": [push]})
    (pose,) = forces(Question(robot, "segments", {})).poses
    (member,) = pose.loads["push"].members
    assert member.half_width.max() < 1e-9 * 2.0e5
