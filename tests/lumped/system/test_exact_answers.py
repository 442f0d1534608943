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
from lumped.mechanism.mechanism import GROUND, Tool
from lumped.models.bodies import legs_of, tip_compliances
from lumped.models.segments import segment_chain, segment_leg
from lumped.models.serial_chains import compliance as vjm_compliance
from lumped.sections import Rectangle
from lumped.system.assembly import assemble
from lumped.system.joint_motion import Portion
from lumped.system.solution import compliance, modes, solved, strain_shares

X, Y, Z = np.eye(3)
WIDTH, LENGTH, STIFFNESS = 0.3, 0.7, 1e4
SECTION = Rectangle(0.02, 0.05)


@pytest.fixture(scope="module")
def parallelogram():
    """A bar on two parallel rods pinned at both ends, driven at one foot."""
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


def test_a_parallelogram_yields_by_its_drive_its_driven_rod_and_the_stretch_of_both(parallelogram):
    """A moment M about z pulls one rod and pushes the other by M/w: φ = 2 (M/w)(L/EA)/w.

    A force F along x turns the foot's drive, F L²/k, and bends the driven rod, F L³/3EI, since only
    its foot is held: between these two the energy is divided, the other rod carries none.
    """
    chains = {
        name: segment_leg(segment_chain(leg.properties("euler-bernoulli"), LENGTH, 3))
        for name, leg in legs_of(parallelogram.mechanism).items()
    }
    system = assemble(parallelogram, chains)
    solution = solved(system)
    stretch = LENGTH / (STEEL.E * SECTION.area)
    turned, bent = LENGTH**2 / STIFFNESS, LENGTH**3 / (3.0 * STEEL.E * SECTION.second_moment_z)
    found = compliance(solution)[[0, 1, 5], [0, 1, 5]]
    assert found == pytest.approx(
        [turned + bent, 0.5 * stretch, 2.0 * stretch / WIDTH**2], rel=1e-8
    )
    shares = strain_shares(system, solution.displacements(system.tool.T[:, :1]))
    expected = {Portion("j0", "drive"): turned, Portion("rod1", "bending z"): bent}
    for portion, share in shares.items():
        amount = expected.get(portion, 0.0) / (turned + bent)
        assert share == pytest.approx(amount, rel=1e-8, abs=1e-12), portion


def test_legs_that_are_no_serial_chains_are_named(parallelogram):
    """A rod between the two rods: the legs of the parallelogram branch."""
    mechanism = parallelogram.mechanism
    looped = replace(
        mechanism,
        tool=replace(mechanism.tool, body="rod1", point="C"),
        joints=[*mechanism.joints, mechanism.joints[1]],
    )
    with pytest.raises(InputError, match="branches at bar; take --model links"):
        vjm_compliance(replace(parallelogram, mechanism=looped), tip_compliances(mechanism))


def test_a_rod_between_ball_joints_goes_round_a_cone_without_spinning():
    """Led by a crank on a drive k: ω² = k/(I_crank + (I_across + mL²/4) sin²β), half angle β.

    One ball joint is on the crank's axis. A rod that turned with the crank would add its large
    inertia along itself, times cos²β.
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
    found = modes(solution, 1)
    assert found.frequencies == pytest.approx([speed / (2.0 * np.pi)], rel=1e-9)
    # The rod is not dragged along: the shape is a mode of the whole, the idle motion included.
    system, shape = solution.system, found.shapes[:, 0]
    forces, momenta = dense(system.stiffness) @ shape, dense(system.mass) @ shape
    assert shape @ momenta == pytest.approx(1.0, rel=1e-12)
    assert forces == pytest.approx(speed**2 * momenta, abs=1e-6 * abs(forces).max())
