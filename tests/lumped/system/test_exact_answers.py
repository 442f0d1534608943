"""What a mechanism's stiffness must be in closed form: physics.md section 7."""

from dataclasses import replace

import numpy as np
import pytest
from random_mechanisms import STEEL, Maker

from lumped.arrays import dense
from lumped.errors import InputError
from lumped.legs import ConstantLeg
from lumped.mechanism.body import Body, Frame, Rigid
from lumped.mechanism.joint import Drive
from lumped.mechanism.mechanism import GROUND, Posture, Tool
from lumped.models.bodies import legs_of, links, tip_compliances
from lumped.models.segments import segment_chain, segment_leg
from lumped.models.serial_chains import compliance as vjm_compliance
from lumped.sections import Rectangle
from lumped.system.assembly import assemble
from lumped.system.joint_motion import Portion
from lumped.system.solution import compliance, modes, solved, strain_shares


def by_links(posture: Posture, theory="timoshenko"):
    legs = tip_compliances(posture.mechanism, theory=theory)
    return compliance(solved(assemble(posture, links(posture.mechanism, legs))))


def parallelogram() -> tuple[Posture, float, float]:
    """A bar on two parallel rods pinned at both ends, driven at one foot; width and length (m)."""
    make = Maker(np.random.default_rng(0), planar=True)
    width, length = 0.3, 0.7
    feet = {"A": np.zeros(3), "B": np.array([width, 0.0, 0.0])}
    heads = {"C": np.array([0.0, length, 0.0]), "D": np.array([width, length, 0.0])}
    middle = np.array([0.5 * width, length, 0.0])
    make.bodies[GROUND] = Body(GROUND, Rigid(), {k: Frame(p) for k, p in feet.items()})
    make.body("bar", Rigid(1.0), Frame(middle), {"T": middle, **heads})
    for name, foot, head in (("rod1", "A", "C"), ("rod2", "B", "D")):
        make.leg(name, foot, head, np.array([feet[foot], heads[head]]))
        shape = ConstantLeg(length, Rectangle(0.02, 0.05), STEEL)
        make.bodies[name] = replace(make.bodies[name], shape=shape)
        drive = Drive(1e4) if name == "rod1" else None
        make.joint("revolute", ((GROUND, foot), (name, foot)), drive)
        make.joint("revolute", ((name, head), ("bar", head)))
    return make.posture(Tool("bar", "T")), width, length


def test_a_parallelogram_turns_by_the_stretch_of_its_rods_alone():
    """A moment M about z pulls one rod and pushes the other by M/w: φ = 2 (M/w)(L/EA)/w.

    A moment about y bends both rods alike in their plane across the mechanism... along x the foot's
    drive turns: u = F L²/k, and the driven rod bends by L³/3EI, since only its foot is held.
    """
    posture, width, length = parallelogram()
    section = Rectangle(0.02, 0.05)
    found = by_links(posture, "euler-bernoulli")
    turning = 2.0 * length / (STEEL.E * section.area) / width**2
    assert found[5, 5] == pytest.approx(turning, rel=1e-10)
    bending = length**3 / (3.0 * STEEL.E * section.second_moment_z)
    assert found[0, 0] == pytest.approx(length**2 / 1e4 + bending, rel=1e-10)
    assert found[1, 1] == pytest.approx(0.5 * length / (STEEL.E * section.area), rel=1e-10)


def test_the_energy_of_a_parallelogram_is_its_drive_s_and_its_driven_rod_s():
    """A force F along x: half of F²L²/k, half of F²L³/3EI; the other rod carries none."""
    posture, _, length = parallelogram()
    chains = {
        name: segment_leg(segment_chain(leg.properties("euler-bernoulli"), length, 3))
        for name, leg in legs_of(posture.mechanism).items()
    }
    system = assemble(posture, chains)
    moved = solved(system).displacements(system.tool.T[:, :1])
    shares = strain_shares(system, moved)
    of_drive = length**2 / 1e4
    bending = length**3 / (3.0 * STEEL.E * Rectangle(0.02, 0.05).second_moment_z)
    expected = {Portion("j0", "drive"): of_drive, Portion("rod1", "bending z"): bending}
    for portion, share in shares.items():
        amount = expected.get(portion, 0.0) / (of_drive + bending)
        assert share == pytest.approx(amount, rel=1e-9, abs=1e-12), portion


def test_legs_that_are_no_serial_chains_are_named():
    """A rod between the two rods: the legs of the parallelogram branch."""
    posture, _, _ = parallelogram()
    tool = replace(posture.mechanism.tool, body="rod1", point="C")
    bodies = dict(posture.mechanism.bodies)
    bodies["bar"] = replace(bodies["bar"])
    mechanism = replace(posture.mechanism, tool=tool, bodies=bodies)
    looped = replace(mechanism, joints=[*mechanism.joints, mechanism.joints[1]])
    legs = tip_compliances(mechanism)
    with pytest.raises(InputError, match="branches at bar; take --model links"):
        vjm_compliance(replace(posture, mechanism=looped), legs)


def test_a_rod_between_ball_joints_goes_round_a_cone_without_spinning():
    """Led by a crank on a drive k: ω² = k/(I_crank + (I_across + mL²/4) sin²β), half angle β.

    One ball joint is on the crank's axis. A rod that turned with the crank would add its large
    inertia along itself, times cos²β.
    """
    arm, height, stiffness = 0.3, 0.4, 2e4
    crank, mass, across, along = 0.05, 6.0, 0.5, 0.9
    foot, centre, head = np.zeros(3), np.array([0.0, 0.0, height]), np.array([arm, 0.0, height])
    length = float(np.linalg.norm(head))
    make = Maker(np.random.default_rng(0), planar=True)
    make.bodies[GROUND] = Body(GROUND, Rigid(), {"O": Frame(foot), "M": Frame(centre)})
    turning = Rigid(1.0, np.zeros(3), crank * np.eye(3))
    make.body("crank", turning, Frame(centre), {"M": centre, "Q": head})
    middle, inertia = np.array([length / 2.0, 0.0, 0.0]), np.diag([along, across, across])
    frame = Frame(foot, make.rotation(head / length))
    make.body("rod", Rigid(mass, middle, inertia), frame, {"O": foot, "Q": head})
    make.joint("revolute", ((GROUND, "M"), ("crank", "M")), Drive(stiffness))
    make.joint("spherical", ((GROUND, "O"), ("rod", "O")))
    make.joint("spherical", (("crank", "Q"), ("rod", "Q")))
    solution = solved(assemble(make.posture(Tool("crank", "Q")), {}))
    led = (across + mass * length**2 / 4.0) * (arm / length) ** 2
    expected = np.sqrt(stiffness / (crank + led)) / (2.0 * np.pi)
    assert solution.idle == 1
    found = modes(solution, 1)
    assert found.frequencies == pytest.approx([expected], rel=1e-9)
    # The rod is not dragged along: the shape is a mode of the whole, the idle motion included.
    system, shape = solution.system, found.shapes[:, 0]
    forces, momenta = dense(system.stiffness) @ shape, dense(system.mass) @ shape
    assert shape @ momenta == pytest.approx(1.0, rel=1e-12)
    assert forces == pytest.approx(
        (2.0 * np.pi * expected) ** 2 * momenta, abs=1e-6 * abs(forces).max()
    )
