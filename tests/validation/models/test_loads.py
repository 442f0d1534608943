"""Loads of the robot file by every model, against closed forms and other solutions."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.robots.gantry import GANTRY, MASSES, STIFFNESSES
from support.robots.pendulum import PENDULUM
from support.robots.robot_from_text import described
from support.robots.single_arm import ONE_ARM

from fem import multibody
from lumped.errors import ComputationError, InputError
from lumped.mechanism.body import Rigid
from lumped.mechanism.free_twists import free_twists
from lumped.mechanism.kinematics.accelerations import accelerations
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.load import Load
from lumped.mechanism.mechanism import GROUND
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.robot_file.load import described_by
from lumped.system.assembly import assemble
from lumped.system.joint_motion import Portion
from lumped.system.loads import loading, work_on
from lumped.system.solution import solved
from validation.cases import ritz
from validation.models.loads.statics import displacements, interface_loads
from validation.models.options import ModelOptions
from validation.models.robot_bodies import static_bodies
from validation.models.robot_models import answers

E, RHO, LENGTH, WIDTH, HEIGHT = 2.1e11, 7850.0, 0.5, 0.06, 0.04
AREA, IX, IZ = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12.0, HEIGHT * WIDTH**3 / 12.0
# ν = 0: G = E/2, κ = 5/6.
SHEAR = 5.0 / 6.0 * E / 2.0 * AREA
G = 9.81
ARM = """
schema = 2
name = "arm"
points = { A = [0.0, 0.0, 0.0], M = [0.0, 0.2, 0.0], P = [0.0, 0.5, 0.0] }
bodies.inner = { from = "A", to = "M", section = SECTION, material = STEEL }
bodies.outer = { from = "M", to = "P", section = SECTION, material = STEEL }
joints.weld = { type = "fixed", between = ["inner", "outer"], at = "M" }
joints.motor.type = "revolute"
joints.motor.between = ["ground", "inner"]
joints.motor.at = "A"
joints.motor.axis = [0.0, 0.0, 1.0]
joints.motor.drive = { stiffness = "rigid" }
tool = { body = "outer", point = "P", moves = ["x"] }
"""
SECTION = f'{{ shape = "rectangle", width = {WIDTH}, height = {HEIGHT} }}'
ARM = ARM.replace("SECTION", SECTION).replace("STEEL", f"{{ E = {E}, nu = 0.0, rho = {RHO} }}")
WEIGHT = Load("weight", "outer", "P", gravity=np.array([0.0, 0.0, -G]))


def under(mechanism, *loads, model="beam", pose=(), **options):
    """Displacements (l×6) of the loaded point under l loads. Reference posture without `pose`."""
    robot = replace(mechanism, loads=loads)
    loaded_posture = posture(robot, np.array(pose) if len(pose) else robot.reference_pose)
    return displacements(model, [loaded_posture], ModelOptions(**options))[0]


def load_on(mechanism, **fields):
    """Load at the loaded point, with these `fields` of `Load`."""
    tool = mechanism.tool
    arrays = {key: np.array(value, dtype=float) for key, value in fields.items()}
    return Load("load", tool.body, tool.point, **arrays)


@pytest.mark.parametrize(
    ("model", "close"),
    [("vjm", 1e-9), ("links", 1e-9), ("beam", 1e-9), ("segments", 2e-3), ("solid", 1e-3)],
)
def test_cantilever_deflects_under_inertia(model, close):
    """Weight: qL⁴/8EI + qL²/2κGA.

    Angular acceleration α: loads f = −αs per mass at s from the root deflect the tip by
    Σ f s²(3L − s)/6EI + f s/κGA; moments ρIα per length bend it, too.
    Angular velocity ω: elongation ρω²L³/3E.
    """
    arm = described(ARM)
    swung, spun = load_on(arm, acceleration=[5.0, 0, 0]), load_on(arm, speed=[2.0, 0, 0])
    weight, swing, spin = under(arm, WEIGHT, swung, spun, model=model, divisions=2)
    q = RHO * AREA * G
    bent = q * LENGTH**4 / (8.0 * E * IX) + q * LENGTH**2 / (2.0 * SHEAR)
    assert weight[2] == pytest.approx(-bent, rel=close)
    assert weight[3] == pytest.approx(-q * LENGTH**3 / (6.0 * E * IX), rel=close)
    p = RHO * AREA * 5.0 / LENGTH
    bent = p * (11.0 * LENGTH**5 / 20.0) / (6.0 * E * IZ) + p * LENGTH**3 / (3.0 * SHEAR)
    bent += RHO * IZ * (5.0 / LENGTH) * LENGTH**3 / 3.0 / (E * IZ)
    assert swing[0] == pytest.approx(-bent, rel=close)
    pulled = RHO * (2.0 / LENGTH) ** 2 * LENGTH**3 / (3.0 * E)
    assert spin[1] == pytest.approx(pulled, rel=close)
    assert np.abs(spin[[0, 2]]).max() <= 1e-6 * pulled


@pytest.mark.parametrize(
    ("model", "height", "close"),
    [
        ("links", 0.004, 1e-6),
        ("links", 0.04, 1e-4),
        ("segments", 0.04, 2e-3),
        ("solid", 0.04, 1e-3),
    ],
)
def test_coning_arm_is_pulled_outwards(model, height, close):
    """A load ρAω²sc per length across the arm, a couple −ρIω²sc, and ρAω²c² along the arm.

    Here s and c are sine and cosine of the arm's slope. The couple is distributed with an error of
    a few per cent of itself.
    """
    cone = ARM.replace("0.2, 0.0]", "0.12, 0.16]").replace("0.5, 0.0]", "0.3, 0.4]")
    cone = described(cone.replace(f"height = {HEIGHT}", f"height = {height}"))
    (displacement,) = under(cone, load_on(cone, speed=[2.0, 0, 0]), model=model, divisions=2)
    c, s, p = 0.6, 0.8, RHO * (2.0 / 0.3) ** 2 / E
    bent = p * s * c * (11.0 * LENGTH**5 / 10.0 / height**2 + 0.8 * LENGTH**3 - LENGTH**3 / 3.0)
    due = p * c**2 * LENGTH**3 / 3.0 * np.array([0, c, s]) + bent * np.array([0, s, -c])
    np.testing.assert_allclose(displacement[:3], due, rtol=0, atol=close * bent)


@pytest.mark.parametrize("model", ["vjm", "links", "segments", "beam"])
def test_leg_force_is_reciprocal(model):
    """P a²(3L − a)/6EI + P a/κGA: deflection of the tip by P at a, or of a by P at the tip."""
    force = Load("within", "inner", "M", wrench=np.array([0.0, 0.0, 3.0, 0.0, 0.0, 0.0]))
    a = 0.2
    bent = 3.0 * a**2 * (3.0 * LENGTH - a) / (6.0 * E * IX) + 3.0 * a / SHEAR
    force_and_weight = replace(force, gravity=WEIGHT.gravity)
    within, weight, together = under(described(ARM), force, WEIGHT, force_and_weight, model=model)
    assert within[2] == pytest.approx(bent, rel=1e-9)
    np.testing.assert_allclose(together, within + weight, rtol=1e-9, atol=1e-18)


@pytest.mark.parametrize("model", ["simplified", "links", "beam"])
def test_translating_bodies_act_as_masses(model):
    """Displacement m a/k along each slide; an acceleration acts as gravity against it."""
    gantry = described(GANTRY)
    pulled = (
        load_on(gantry, acceleration=[4.0, 3.0, 2.0]),
        load_on(gantry, gravity=[-4.0, -3.0, -2.0]),
    )
    first, second = under(gantry, *pulled, model=model)
    due = -np.array([4.0, 3.0, 2.0]) * MASSES / STIFFNESSES
    np.testing.assert_allclose(first[:3], due, rtol=1e-9)
    np.testing.assert_allclose(first, second, rtol=1e-9, atol=1e-18)


@pytest.mark.parametrize("model", ["simplified", "links", "beam"])
def test_pendulum_inertia_acts_on_drive(model):
    """The drive carries (J + mc²) α = 0.86 α, and m g c of the horizontal pendulum's weight."""
    bob = described(PENDULUM)
    swung, spun = load_on(bob, acceleration=[2.0, 0, 0]), load_on(bob, speed=[3.0, 0, 0])
    sideways = load_on(bob, gravity=[G, 0, 0])
    swing, spin, hang = under(bob, swung, spun, sideways, model=model)
    assert swing[5] == pytest.approx(-0.86 * (2.0 / 0.8) / 4.0e4, rel=1e-9)
    assert hang[5] == pytest.approx(3.0 * G * 0.5 / 4.0e4, rel=1e-9)
    assert np.abs(spin).max() <= 1e-12


@pytest.mark.parametrize("name", ["five-bar", "delta", "ifw", "hexapod"])
def test_accelerations_equal_differences(name):
    """Reference: second differences of postures along x = ẋt + ẍt²/2.

    The drives of a hexapod rotate with its legs.
    """
    robot = load_robot(name).mechanism
    drive = replace(next(joint.drive for joint in robot.joints if joint.drive), inertia=3.0)
    joints = [
        replace(joint, drive=drive) if joint.kind in ("revolute", "prismatic") else joint
        for joint in robot.joints
    ]
    robot = replace(robot, joints=tuple(joints))
    pull = load_on(robot, speed=[0.7, 0, 0], acceleration=[3.0, 0, 0])
    robot = replace(robot, loads=(pull,))
    pose, step = robot.poses[len(robot.poses) // 2], 1e-3
    along = np.array([move == "x" for move in robot.tool.moves], dtype=float)
    times = step * np.array([-1.0, 0.0, 1.0])
    postures = [posture(robot, pose + along * (0.7 * t + 1.5 * t**2)) for t in times]
    computed = accelerations(postures[1], pull.speed, pull.acceleration)
    for body in robot.bodies:
        before, middle, after = (moved_posture.frames[body].position for moved_posture in postures)
        linear = (after - 2.0 * middle + before) / step**2
        np.testing.assert_allclose(computed[body].linear_acceleration, linear, rtol=2e-5, atol=2e-5)
        # Rods on ball joints may spin.
        before, axis, after = (
            moved_posture.frames[body].rotation[:, 0] for moved_posture in postures
        )
        swung, due = (
            np.cross(computed[body].angular_velocity, axis),
            (after - before) / (2.0 * step),
        )
        np.testing.assert_allclose(swung, due, rtol=1e-4, atol=1e-4)
    rotor_forces = loading(postures[1], pull, interface_loads(robot)).rotor_forces
    assert set(rotor_forces) == {joint.name for joint in joints if joint.drive}
    for joint, force in rotor_forces.items():
        (before,), (middle,), (after,) = (
            moved_posture.coordinates[joint] for moved_posture in postures
        )
        due = -3.0 * (after - 2.0 * middle + before) / step**2
        assert force == pytest.approx(due, rel=1e-4, abs=1e-4)


def test_impossible_acceleration_is_refused():
    """At the end of its stroke the biglide cannot move along x; a weight acts nevertheless."""
    robot = load_robot("ifw").mechanism
    end, pull = posture(robot, robot.poses[0]), np.array([1.0, 0.0, 0.0])
    with pytest.raises(ComputationError, match="tool cannot move with the requested"):
        accelerations(end, np.zeros(3), pull)
    loads = load_on(robot, gravity=pull), load_on(robot, acceleration=pull)
    weight, stopped = under(robot, *loads, pose=end.pose)
    assert np.isfinite(weight).all()
    assert np.isnan(stopped).all()


def test_path_wrench_acts_in_its_pose_only():
    """NaN in a pose that is not on the path."""
    arm = described(ARM + "path = { poses = [[0.1], [-0.2]] }")
    rows = np.array([[3.0, 0, 5.0, 0, 0, 0], [0, 2.0, 0, 0, 0.4, 0]])
    over = Load("cutting", "inner", "M", path_wrenches=rows)
    plain = [Load("now", "inner", "M", wrench=row) for row in rows]
    for number, pose in enumerate(arm.poses):
        (displacement,), due = under(arm, over, pose=pose), under(arm, *plain, pose=pose)
        # One right-hand side instead of two rounds the last bit another way on some processors.
        np.testing.assert_allclose(displacement, due[number], rtol=1e-12)
    assert np.isnan(under(arm, over, pose=[0.15])).all()


@pytest.mark.parametrize("name", ["ifw", "3-rrr", "hexapod"])
def test_vjm_and_links_are_equal_under_loads(name):
    """Wrenches on all points of all bodies, weight, and inertia with speed."""
    robot = load_robot(name).mechanism
    wrench = np.array([1.0, 2.0, 3.0, 0.4, 0.5, 0.6])
    loads = [
        Load("inside", body.name, point, wrench=wrench)
        for body in robot.bodies.values()
        for point in body.interfaces
        if body.name != GROUND
    ]
    loads.append(load_on(robot, gravity=[1.0, 2.0, -9.81]))
    loads.append(load_on(robot, acceleration=[5.0, 0, 0], speed=[0.8, 0, 0]))
    pose = robot.poses[len(robot.poses) // 3]
    chains, assembled = (under(robot, *loads, model=m, pose=pose) for m in ("vjm", "links"))
    sizes = np.abs(assembled).max(axis=1, keepdims=True)
    assert np.abs(chains - assembled).max() <= 1e-8 * sizes.max()
    assert (np.abs(chains - assembled) <= 1e-7 * sizes).all()


def rigid(leg):
    """Rigid body with mass and inertia of the leg, a prism."""
    section, along = leg.section, leg.mass * leg.length**2 / 12.0
    y, z = leg.mass / section.area * np.array([section.second_moment_y, section.second_moment_z])
    inertia = np.diag([y + z, along + y, along + z])
    return Rigid(leg.mass, np.array([0.5 * leg.length, 0.0, 0.0]), inertia)


class _Moving(multibody._ExudynModel):
    """EXUDYN model with the bodies' velocities at `speed` of the tool, by posture differences."""

    def __init__(self, start, free, speed):
        step = 1e-5 * np.array([*speed, 0.0, 0.0, 0.0])
        before, after = (
            posture(start.mechanism, start.pose + change, start) for change in (-step, step)
        )
        self.linear, self.spin, self.moving = {}, {}, start.mechanism.tool.body
        for name, frame in start.frames.items():
            first, second = before.frames[name], after.frames[name]
            self.linear[name] = (second.position - first.position) / 2e-5
            turned = frame.rotation.T @ (second.rotation - first.rotation) / 2e-5
            self.spin[name] = turned[[2, 0, 1], [1, 2, 0]]
        super().__init__(replace(start, mechanism=free), 1)

    def _add_rigid(self, name, shape):
        self.moving = name
        super()._add_rigid(name, shape)

    def _node(self, position, rotation):
        spin, node = self.spin[self.moving], self.items.NodeRigidBodyRotVecLG
        arm = position - self.posture.frames[self.moving].position
        velocity = self.linear[self.moving] + np.cross(rotation @ spin, arm)
        placed = [*position, *multibody.rotation_vector(rotation)]
        return self.mbs.AddNode(
            node(referenceCoordinates=placed, initialVelocities=[*velocity, *spin])
        )


@pytest.mark.parametrize(("speed", "close"), [(0.0, 1e-4), (1.0, 1e-3)], ids=["rest", "moving"])
def test_accelerated_hexapod_equals_exudyn(speed, close):
    """A hexapod of rigid bodies in EXUDYN, with forces instead of drives.

    Without the inertia forces of its speed the tool would be 13 % slower along z.
    """
    exudyn = pytest.importorskip("exudyn", reason="EXUDYN (extra exudyn) is not installed")
    robot, time = load_robot("hexapod").mechanism, 2e-4
    speed = speed * np.array([1.5, -1.0, 0.5])
    load = load_on(robot, acceleration=[3.0, 2.0, -4.0], speed=speed)
    robot = replace(robot, loads=(load,))
    robot_posture = posture(robot, robot.poses[2])
    system = assemble(robot_posture, static_bodies("links", robot))
    work = work_on(system, loading(robot_posture, load, interface_loads(robot)))
    displacements = solved(system).displacements(work[:, None])
    legs = legs_of(robot).items()
    bodies = {name: replace(robot.bodies[name], shape=rigid(leg)) for name, leg in legs}
    joints = [replace(joint, drive=None) for joint in robot.joints]
    free = replace(robot, bodies=robot.bodies | bodies, joints=joints)
    model = _Moving(robot_posture, free, speed)
    for joint in (candidate for candidate in robot.joints if candidate.drive):
        spring = system.motions.springs[Portion(joint.name, "drive")]
        force = -np.sqrt(joint.drive.stiffness) * (spring @ displacements)[0, 0]
        pull = force * free_twists(robot_posture, joint)[:3, 0]
        for side, end in ((joint.first, -1.0), (joint.second, 1.0)):
            marker = model.marker(side, np.eye(3))
            model.mbs.AddLoad(model.items.Force(markerNumber=marker, loadVector=end * pull))
    model.mbs.Assemble()
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.timeIntegration.numberOfSteps = 20
    settings.timeIntegration.endTime = time
    model.mbs.SolveDynamic(settings)
    deviation = np.array(model.mbs.systemData.GetODE2Coordinates())[-6:-3] - speed * time
    np.testing.assert_allclose(2.0 * deviation / time**2, load.acceleration, rtol=close)


GIVE = {"compliance": (1e-7 * np.diag([1.0, 2.0, 1.0, 30.0, 20.0, 90.0])).tolist()}
# Axes and rotors of 2 kg m² and 2 kg.
ROTORS = {
    "revolute": ([0, 0, 1.0], {"mass": 1.0, "inertia": np.diag([1.0, 1.0, 2.0]).tolist()}),
    "prismatic": ([1.0, 0, 0], {"mass": 2.0}),
}


def with_rotor(kind, give, *, by_key):
    """An arm on a drive with a rotor, given by keys of the drive if `by_key`, otherwise as a body.

    `give` is empty, or has the compliance of the joint.
    """
    axis, rotor = ROTORS[kind]
    drive = {"stiffness": 5.0e4, "simplified": 4.0e4}
    motor = {"type": kind, "between": ["ground", "arm"], "at": "A", "axis": axis, "drive": drive}
    tables = tomllib.loads(ONE_ARM) | {"joints": {"motor": motor}}
    if by_key:
        drive |= {"inertia": 2.0e-4, "ratio": 100.0}
        motor |= give
    else:
        motor["between"] = ["ground", "rotor"]
        tables["bodies"]["rotor"] = {"points": ["A"], "centre": "A", **rotor}
        gear = {"type": "fixed", "between": ["rotor", "arm"], "at": "A", **give}
        tables["joints"]["gear"] = gear
    return described_by(tables, Path())[0]


@pytest.mark.parametrize("kind", ROTORS)
@pytest.mark.parametrize("give", [{}, GIVE], ids=["stiff", "giving"])
def test_rotor_key_equals_rotor_body(kind, give):
    """A rotor given by keys of the drive has the effect of one modelled as a body."""
    frequencies = []
    for by_key in (True, False):
        arm = with_rotor(kind, give, by_key=by_key)
        pull = load_on(arm, acceleration=[5.0, 0, 0], speed=[1.0, 0, 0])
        numbers = [under(arm, pull, model=m).ravel() for m in ("vjm", "links", "simplified")]
        arm_posture = reference_posture(arm)
        frequencies_by_model = {
            m: answers(m, [arm_posture], 3, ModelOptions(divisions=2)).frequencies[0]
            for m in WITH_MASS
        }
        if not give:
            np.testing.assert_allclose(
                frequencies_by_model["beam"], ritz.frequencies(arm_posture, 3), rtol=1e-5
            )
            rigid = ritz.simplified_response(arm_posture, 1)[1]
            np.testing.assert_allclose(frequencies_by_model["simplified"], rigid, rtol=1e-9)
        frequencies.append(np.concatenate([*numbers, *frequencies_by_model.values()]))
    np.testing.assert_allclose(frequencies[0], frequencies[1], rtol=1e-9, atol=1e-15)


WITH_MASS = ("simplified", "segments", "beam", "solid")


@pytest.mark.parametrize(
    ("drive", "fault"),
    [
        ('"rigid", inertia = 0.1', "drive.inertia: the rotor of a rigid drive stands"),
        ("1e5, ratio = 5.0", "drive.ratio: must be left out without `inertia`"),
    ],
)
def test_rotors_without_effect_are_refused(drive, fault):
    """A rotor on a rigid drive, or a gear ratio without a rotor."""
    with pytest.raises(InputError, match=fault):
        described(PENDULUM.replace("4.0e4", drive))
