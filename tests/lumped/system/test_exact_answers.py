"""Compliances, frequencies and idle motions against closed forms and a null-space solution.

The null-space solution has six unknowns for every interface and six more for the relative twist of
every joint; each condition (rigid body, rigid direction of a joint) is a row. With T, the null
space of all rows by SVD, K̂ = TᵀKT; idle motions are left out by the pseudo-inverse. Sweeps over
many postures are compared with the postures one by one.
"""

from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
from support.random.random_mechanisms import STEEL, Maker, random_posture

from lumped.arrays import dense
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg
from lumped.mechanism.body import Body, Frame, Rigid
from lumped.mechanism.free_twists import free_twists, interface_position, rotation_since_reference
from lumped.mechanism.joint import Drive
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import GROUND, Tool
from lumped.models import serial_chains
from lumped.models.bodies import legs_of, links, tip_compliances
from lumped.models.segments import segment_chain, segment_leg
from lumped.robot_file import load_robot
from lumped.screws import shift, turn_matrix
from lumped.sections import Rectangle
from lumped.system import sweep as sweep_module
from lumped.system.assembly import assemble, assembly
from lumped.system.joint_motion import Portion
from lumped.system.solution import compliance, modes, solved, strain_shares
from lumped.system.sweep import swept
from validation.models.options import ModelOptions
from validation.models.robot_bodies import dynamic_bodies, static_bodies

X, Y, Z = np.eye(3)
WIDTH, LENGTH, STIFFNESS = 0.3, 0.7, 1e4
SECTION = Rectangle(0.02, 0.05)


@pytest.fixture(scope="module")
def parallelogram():
    """Return a bar on two parallel rods pinned at both ends, with a drive at one foot."""
    make = Maker(np.random.default_rng(0), planar=True)
    feet = {"A": 0.0 * X, "B": WIDTH * X}
    heads = {"C": LENGTH * Y, "D": WIDTH * X + LENGTH * Y}
    middle = 0.5 * WIDTH * X + LENGTH * Y
    make.bodies[GROUND] = Body(GROUND, Rigid(), {k: Frame(p) for k, p in feet.items()})
    make.body("bar", Rigid(1.0), Frame(middle), {"T": middle, **heads})
    for name, foot, head in (("rod1", "A", "C"), ("rod2", "B", "D")):
        make.leg(name, foot, head, np.array([feet[foot], heads[head]]))
        shape = ConstantLeg(LENGTH, SECTION, STEEL)
        make.bodies[name] = replace(make.bodies[name], shape=shape)
        drive = Drive(STIFFNESS) if name == "rod1" else None
        make.joint("revolute", ((GROUND, foot), (name, foot)), drive)
        make.joint("revolute", ((name, head), ("bar", head)))
    return make.posture(Tool("bar", "T"))


def test_parallelogram_is_exact(parallelogram):
    """A moment M about z pulls one rod and pushes the other by M/w: φ = 2 (M/w)(L/EA)/w.

    A force F along x rotates the drive at the foot, F L²/k, and bends the driven rod, F L³/3EI; the
    other rod, free to rotate at both ends, has no strain energy.
    """
    chains = {
        name: segment_leg(segment_chain(leg.properties("euler-bernoulli"), LENGTH, 3))
        for name, leg in legs_of(parallelogram.mechanism).items()
    }
    system = assemble(parallelogram, chains)
    solution = solved(system)
    stretch = LENGTH / (STEEL.E * SECTION.area)
    turned, bent = LENGTH**2 / STIFFNESS, LENGTH**3 / (3.0 * STEEL.E * SECTION.second_moment_z)
    diagonal = compliance(solution)[[0, 1, 5], [0, 1, 5]]
    assert diagonal == pytest.approx(
        [turned + bent, 0.5 * stretch, 2.0 * stretch / WIDTH**2], rel=1e-8
    )
    shares = strain_shares(system, solution.displacements(system.tool.T[:, :1]))
    expected = {Portion("j0", "drive"): turned, Portion("rod1", "bending z"): bent}
    for portion, share in shares.items():
        amount = expected.get(portion, 0.0) / (turned + bent)
        # Rounding error of a share of zero: up to 2.4e-13 with five kernels of OpenBLAS.
        assert share == pytest.approx(amount, rel=1e-8, abs=1e-11), portion


def test_mode_excludes_idle_rod_spin():
    """A rod guided by a crank on a drive k: ω² = k/(I_crank + (I_across + mL²/4) sin²β).

    One ball joint of the rod lies on the crank's axis, and β is the angle between rod and axis. If
    the rod's idle spin took part in the mode, its large inertia about its axis, times cos²β, would
    be added.
    """
    arm, height, stiffness = 0.3, 0.4, 2e4
    crank, mass, across, along = 0.05, 6.0, 0.5, 0.9
    foot, centre, head = 0.0 * X, height * Z, arm * X + height * Z
    length = np.hypot(arm, height)
    make = Maker(np.random.default_rng(0), planar=True)
    make.bodies[GROUND] = Body(GROUND, Rigid(), {"O": Frame(foot), "M": Frame(centre)})
    turning = Rigid(1.0, np.zeros(3), crank * np.eye(3))
    make.body("crank", turning, Frame(centre), {"M": centre, "Q": head})
    rod = Rigid(mass, 0.5 * length * X, np.diag([along, across, across]))
    make.body("rod", rod, Frame(foot, make.rotation(head / length)), {"O": foot, "Q": head})
    make.joint("revolute", ((GROUND, "M"), ("crank", "M")), Drive(stiffness))
    make.joint("spherical", ((GROUND, "O"), ("rod", "O")))
    make.joint("spherical", (("crank", "Q"), ("rod", "Q")))
    solution = solved(assemble(make.posture(Tool("crank", "Q")), {}))
    led = (across + mass * length**2 / 4.0) * (arm / length) ** 2
    speed = np.sqrt(stiffness / (crank + led))
    assert solution.idle == 1
    computed = modes(solution, 1)
    assert computed.frequencies == pytest.approx([speed / (2.0 * np.pi)], rel=1e-9)
    # The shape satisfies K φ = ω² M φ with all unknowns, those of the idle spin included.
    system, shape = solution.system, computed.shapes[:, 0]
    forces, momenta = dense(system.stiffness) @ shape, dense(system.mass) @ shape
    assert shape @ momenta == pytest.approx(1.0, rel=1e-12)
    assert forces == pytest.approx(speed**2 * momenta, abs=1e-6 * abs(forces).max())


# Legs and joints have compliances (m/N) up to this one: a softer robot is near a singular posture,
# and its rounding errors grow in proportion to its compliance.
LARGEST_PART_COMPLIANCE = 1e-5


def joint_compliance(posture, joint, free):
    """Return the 6×6 compliance of a joint; its drive acts along the first column of `free`."""
    compliance = np.zeros((6, 6))
    if joint.compliance is not None:
        rotation = rotation_since_reference(posture, joint.first.body)
        compliance += turn_matrix(joint.compliance, rotation)
    if joint.drive is not None and joint.drive.stiffness is not None:
        compliance += np.outer(free[:, 0], free[:, 0]) / joint.drive.stiffness
    return compliance


def null_space_system(posture, legs):
    """Return stiffness and mass on the null space of all conditions, and the tool's rows of it."""
    mechanism = posture.mechanism
    bodies = {name: body for name, body in mechanism.bodies.items() if name != GROUND}
    keys = [(name, point) for name, body in bodies.items() for point in body.interfaces]
    keys += [joint.name for joint in mechanism.joints]
    size = 6 * len(keys)
    rows = dict(zip(keys, np.eye(size).reshape(-1, 6, size), strict=True))
    stiffness, mass = np.zeros((2, size, size))
    conditions = []
    for name, body in bodies.items():
        base = posture.frames[name]
        points = [(base @ frame).position for frame in body.interfaces.values()]
        root, *further_rows = (rows[name, point] for point in body.interfaces)
        rigid = [shift(point - points[0]) @ root for point in points[1:]]
        if name in legs:
            relative = further_rows[0] - rigid[0]
            tip = np.linalg.inv(turn_matrix(legs[name], base.rotation))
            stiffness += relative.T @ tip @ relative
            continue
        conditions += [other - carried for other, carried in zip(further_rows, rigid, strict=True)]
        moving = shift((base @ Frame(body.shape.centre)).position - points[0]) @ root
        weight = np.diag([body.shape.mass] * 3 + [0.0] * 3)
        weight[3:, 3:] = base.rotation @ body.shape.inertia @ base.rotation.T
        mass += moving.T @ weight @ moving
    for joint in mechanism.joints:
        point, free = interface_position(posture, joint.first), free_twists(posture, joint)
        # The elastic twist of the joint; conditions keep it zero in the rigid directions.
        deflection = rows[joint.name]
        values, vectors = np.linalg.eigh(joint_compliance(posture, joint, free))
        soft = values > 1e-12 * values[-1]
        elastic = vectors[:, soft].T @ deflection
        conditions.append(vectors[:, ~soft].T @ deflection)
        stiffness += elastic.T @ (elastic / values[soft, None])
        relative = -deflection
        for side, sign in ((joint.second, 1.0), (joint.first, -1.0)):
            if side.body != GROUND:
                arm = shift(point - interface_position(posture, side))
                relative = relative + sign * arm @ rows[side.body, side.point]
        passive = free if joint.drive is None else free[:, 1:]
        across = np.linalg.qr(passive, mode="complete")[0][:, passive.shape[1] :]
        conditions.append(across.T @ relative)
    tool = rows[mechanism.tool.body, mechanism.tool.point]
    mass += mechanism.tool.mass * tool[:3].T @ tool[:3]
    _, values, right = np.linalg.svd(np.vstack(conditions))
    free = right[int(np.sum(values > 1e-10)) :].T
    return free.T @ stiffness @ free, free.T @ mass @ free, tool @ free


# Elastic universal joints away from the reference posture occur from seed 15 on.
@pytest.mark.parametrize(
    ("seed", "planar"), [*((n, False) for n in range(27)), *((n, True) for n in range(8))]
)
def test_assembly_equals_null_space_solution(seed, planar):
    """35 random mechanisms: compliance of the tool, number of idle motions and frequencies."""
    posture = random_posture(seed, planar=planar)
    legs = tip_compliances(posture.mechanism)
    system = assemble(posture, links(posture.mechanism, legs))
    stiffness, mass, tool = null_space_system(posture, legs)
    values, vectors = np.linalg.eigh(stiffness)
    firm = values > 1e-11 * values.max(initial=1.0)
    idle_motions = vectors[:, ~firm]
    if np.abs(tool @ idle_motions).max(initial=0.0) > 1e-6:
        with pytest.raises(ComputationError, match="the tool is free to"):
            solved(system)
        return
    root = vectors[:, firm] / np.sqrt(values[firm])
    flexibility = tool @ root @ root.T @ tool.T
    size = np.abs(flexibility).max()
    grown = max(1.0, size / LARGEST_PART_COMPLIANCE)
    solution = solved(system)
    # 1e-20: the compliance of a tool that is held by rigid joints only.
    assert np.abs(compliance(solution) - flexibility).max() <= 1e-8 * grown * size + 1e-20
    assert solution.idle == np.sum(~firm)
    # Eqs (3) to (9) are independent of the assembler; they have no solution if a chain is rigid.
    with suppress(ComputationError):
        by_chains = serial_chains.compliance(posture, legs)
        assert np.abs(by_chains - flexibility).max() <= 1e-7 * grown * size + 1e-20
    # Idle motions are free: modes are orthogonal, in the mass matrix, to those that have a mass.
    free_mass, turned = np.linalg.eigh(idle_motions.T @ mass @ idle_motions)
    heavy = free_mass > 1e-11 * mass.max(initial=0.0)
    drag = mass @ idle_motions @ (turned[:, heavy] / np.sqrt(free_mass[heavy]))
    inverse = np.linalg.eigvalsh(root.T @ (mass - drag @ drag.T) @ root)[::-1]
    inverse = inverse[inverse > max(1e-20, 1e-9 * inverse.max(initial=0.0))][:3]
    if len(inverse):
        frequencies = modes(solution, len(inverse)).frequencies
        assert (2 * np.pi * frequencies) ** -2 == pytest.approx(inverse, rel=1e-7 * grown)


def postures_of(name):
    mechanism = load_robot(name).mechanism
    return [posture(mechanism, pose) for pose in mechanism.poses[::4]]


@pytest.mark.parametrize(
    ("name", "elements", "loss"), [("ifw", 60, 1.0), ("five-bar", 4, 100.0), ("delta", 60, 1.0)]
)
def test_sweep_equals_single_postures(name, elements, loss):
    """The biglide, a robot of unreduced bodies, and a Delta robot whose rods spin idly.

    Four elements of an unreduced leg are 4³ times as stiff as the leg. Round-off of a single
    posture is therefore larger by the factor `loss`.
    """
    postures, options = postures_of(name), ModelOptions(elements=elements)
    mechanism = postures[0].mechanism
    prepared = assembly(mechanism, dynamic_bodies("beam", mechanism, 500.0, options))
    sweep, statics = swept(prepared, postures, 8), swept(prepared, postures, 0)
    assert statics.frequencies.shape == (len(postures), 0)
    assert np.abs(statics.compliances - sweep.compliances).max() <= 1e-12 * sweep.compliances.max()
    for number, at_posture in enumerate(postures):
        solution = solved(prepared.at(at_posture))
        expected = compliance(solution)
        size = np.abs(expected).max()
        assert np.abs(sweep.compliances[number] - expected).max() <= 1e-12 * loss * size
        frequencies = modes(solution, 8).frequencies
        assert sweep.frequencies[number] == pytest.approx(frequencies, rel=1e-11 * loss)
        assert sweep.idle[number] == solution.idle


def test_unreduced_bodies_are_solved_together(monkeypatch):
    """Timoshenko elements are exact in statics. Round-off is 2e-12, of single postures 1.4e-11."""
    monkeypatch.delattr(sweep_module, "_individually")
    postures, options = postures_of("five-bar"), ModelOptions(elements=10)
    mechanism = postures[0].mechanism
    beams = assembly(mechanism, dynamic_bodies("beam", mechanism, 500.0, options))
    assert sum(model.size for model in beams.models.values()) == 4 * 6 * 21
    exact = swept(assembly(mechanism, static_bodies("links", mechanism)), postures, 0).compliances
    solution = swept(beams, postures, 2).compliances
    assert np.abs(solution - exact).max() <= 5e-11 * np.abs(exact).max()


def test_too_few_modes_name_posture():
    """Bodies of the model `links` have no mass, so that four modes do not exist."""
    postures = postures_of("five-bar")
    mechanism = postures[0].mechanism
    prepared = assembly(mechanism, static_bodies("links", mechanism))
    with pytest.raises(
        ComputationError, match=r"at x = .* 4 modes requested, but fewer modes move mass"
    ):
        swept(prepared, postures, 4)
