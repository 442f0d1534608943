"""Robots at random: the suite without a fault raises no alarm, whatever the robot.

Every robot meets the cases of the lumped models and the guards on it; the costlier groups (modes
over the stroke, orders of convergence) meet every tenth. The slow tests show 200 robots to all of
these in the standard preset, and a few to the cases of solid legs.
"""

import numpy as np
import pytest
from hypothesis import Phase, assume, given, seed, settings
from hypothesis import strategies as st

from lumped.biglide import Biglide, geometry_faults
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, GivenLeg, Leg, Material
from lumped.robot_file import RobotFile, load_robot
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Section, Tube
from validation.case import Case, Skip, judge
from validation.catalogue import catalogue
from validation.context import Context

IFW = load_robot("ifw")
CHUNKS = 4
# 12°: where the legs come near to one line the robot is near to a type 2 singularity, its
# compliance grows without bound and rounding with it, beyond what comparisons to 1e-9 can bear.
SMALLEST_ANGLE = 0.2
EXAMPLES = 50
# A robot costs a second: one that raises an alarm is shown as it is.
UNSHRUNK = (Phase.explicit, Phase.generate)
LUMPED = ("leg1.lumped", "leg2.lumped", "robot.statics", "guard.robot", "guard.legs")
LUMPED += ("guard.family", "guard.simplified")
SOLIDS = (
    *(f"leg{n}.{group}" for n in (1, 2) for group in ("solid", "modes")),
    *(f"restraint.leg{n}" for n in (1, 2)),
    *(f"guard.leg{n}.two-ways" for n in (1, 2)),
)
COSTLIER = ("robot.frequencies", "benchmark.huang.1", "benchmark.huang.2")
COSTLIER += tuple(f"refinement.{n}.{name}" for n in (1, 2) for name in ("half", "literal", "beam"))


def compliance_of(rng: np.random.Generator, length: float) -> np.ndarray:
    """A positive definite 6×6 of the size of a leg's, all its terms coupled."""
    bending = 10.0 ** rng.uniform(-8.0, -6.3)
    sizes = np.sqrt([bending / 50.0, bending, bending, *[3.0 * bending / length**2] * 3])
    shape = rng.standard_normal((6, 6)) * 0.25 + np.eye(6)
    own = shape @ shape.T
    unit = 1.0 / np.sqrt(np.diag(own))
    matrix = own * np.outer(unit * sizes, unit * sizes)
    return 0.5 * (matrix + matrix.T)


@st.composite
def sections(draw: st.DrawFn, size: float) -> Section:
    """One of the five shapes, its larger side about `size`."""
    ratio = draw(st.floats(0.4, 1.0))
    wall = draw(st.floats(0.05, 0.2))
    width, height = draw(st.permutations([size, ratio * size]))
    thickness = wall * ratio * size
    match draw(st.integers(0, 4)):
        case 0:
            return Rectangle(width, height)
        case 1:
            return HollowRectangle(width, height, thickness)
        case 2:
            return Circle(size)
        case 3:
            return Tube(size, wall * size)
        case _:
            return ISection(width, height, thickness, 0.7 * thickness)


@st.composite
def materials(draw: st.DrawFn) -> Material:
    """Steel to plastics; isotropic, or with a shear modulus of its own."""
    E = 10.0 ** draw(st.floats(9.5, 11.5))
    nu = draw(st.floats(0.0, 0.45))
    material = Material.isotropic(E, nu, draw(st.floats(1000.0, 8000.0)))
    factor = draw(st.sampled_from([1.0, 0.6, 1.5]))
    return Material(E, factor * material.G, nu, material.rho)


@st.composite
def legs(draw: st.DrawFn, length: float) -> Leg:
    """A matrix and a mass, or a section and a material; slenderness 4 to 15."""
    if draw(st.booleans()):
        rng = np.random.default_rng(draw(st.integers(0, 2**32)))
        return GivenLeg(length, draw(st.floats(5.0, 100.0)), compliance_of(rng, length))
    size = length / draw(st.floats(4.0, 15.0))
    return ConstantLeg(length, draw(sections(size)), draw(materials()))


def smallest_angle(robot: Biglide) -> float:
    """Sine of the smallest angle between the legs over the stroke."""
    sines = []
    for x in robot.stations(41):
        posture = robot.posture(x)
        sines.append(abs(np.cross(posture.rotation1[:, 0], posture.rotation2[:, 0])[2]))
    return min(sines)


@st.composite
def robots(draw: st.DrawFn) -> Biglide:
    """Robots whose legs meet and become horizontal at both ends of the stroke."""
    first = draw(st.floats(0.3, 2.0))
    second = first * draw(st.floats(0.6, 1.6))
    # The slides lie apart between |L1 − L2| and L1 + L2, with a margin on both sides.
    share = draw(st.floats(0.15, 0.85))
    a = abs(first - second) + share * (first + second - abs(first - second))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    foot = compliance_of(rng, 1.0) / 30.0 if draw(st.booleans()) else None
    tool = compliance_of(rng, 1.0) / 100.0 if draw(st.booleans()) else None
    offset = draw(st.tuples(*[st.floats(-0.2, 0.2)] * 3))
    robot = Biglide(
        name="random",
        a=a,
        platform_mass=draw(st.floats(5.0, 100.0)),
        actuator_stiffness=10.0 ** draw(st.floats(7.0, 9.5)),
        leg1=draw(legs(first)),
        leg2=draw(legs(second)),
        tool_offset=np.array(offset),
        foot_compliance=foot,
        tool_compliance=tool,
    )
    assume(not geometry_faults(robot) and smallest_angle(robot) > SMALLEST_ANGLE)
    return robot


def alarms(robot: Biglide, groups: tuple[str, ...], preset: str = "quick") -> list[str]:
    """Cases of the groups that do not agree, with what they say."""
    robot_file = RobotFile(robot, "random.toml", built_in=False, text="", sha256="", corrections=())
    context = Context(robot_file, preset)
    found = []
    for task in catalogue(robot_file):
        if not (isinstance(task, Case) and task.group in groups and preset in task.presets):
            continue
        try:
            outcome = judge(task, task.compute(context), 0.0)
        except Skip:
            continue
        except ComputationError as error:
            found.append(f"{task.id}: {error}")
            continue
        if outcome.verdict != "agree":
            measured = outcome.measurement
            found.append(f"{task.id}: {measured.value} for {measured.reference} {outcome.message}")
    return found


@pytest.mark.exhaustive
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_random_robots_raise_no_alarm(chunk):
    seen = 0

    @seed(chunk)
    @settings(max_examples=EXAMPLES, database=None, phases=UNSHRUNK)
    @given(robots())
    def check(chosen):
        nonlocal seen
        seen += 1
        assert not alarms(chosen, LUMPED + (COSTLIER if seen % 10 == 0 else ()))

    check()
    assert seen >= EXAMPLES


@pytest.mark.exhaustive
@settings(max_examples=200, database=None, phases=UNSHRUNK)
@given(robots())
def test_random_robots_raise_no_alarm_in_any_lumped_group(chosen):
    assert not alarms(chosen, LUMPED + COSTLIER, "standard")


@pytest.mark.exhaustive
@settings(max_examples=6, database=None, phases=UNSHRUNK)
@given(robots())
def test_random_robots_raise_no_alarm_with_solid_legs(chosen):
    assert not alarms(chosen, SOLIDS)
