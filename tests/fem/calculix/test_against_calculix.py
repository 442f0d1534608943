"""Solid legs, alone and in whole mechanisms, held against CalculiX on the same meshes."""

import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from compliances import scaled_difference
from prismatic_legs import STEEL

from fem.bodies.solid import solid_leg, solid_leg_matrices
from fem.calculix.deck import Equation, deck_text
from fem.calculix.leg import leg_deck, mass_at_stiffness_points
from fem.calculix.mechanism import compliance_and_frequencies
from fem.calculix.run import PROGRAMS, calculix_program, run_calculix
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg
from lumped.mechanism.body import Rigid
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from lumped.system.assembly import assemble
from lumped.system.response import damped_modes
from lumped.system.solution import compliance, modes, solved
from meshes.prism import tetrahedra
from validation.adequacy.robot import leg_alone

needs_calculix = pytest.mark.skipif(
    not any(map(shutil.which, PROGRAMS)), reason="CalculiX (ccx) is not installed"
)
# Seven printed digits; of the reduction, cut off at four times the tenth frequency, less.
PRINTED = 1e-6
# Solid squares, so that coarse meshes are good ones: both sides have the same.
SECTIONS = {"five-bar": {"": 0.09}, "delta": {"arm": 0.06, "rod": 0.04}}


def of_squares(name):
    """The built-in mechanism with legs of square sections, of a material that has axes."""
    mechanism = load_robot(name).mechanism
    bodies = dict(mechanism.bodies)
    for body in mechanism.bodies.values():
        for start, side in SECTIONS[name].items():
            if isinstance(body.shape, ConstantLeg) and body.name.startswith(start):
                cubic = replace(body.shape.material, G=1.2 * body.shape.material.G)
                shape = replace(body.shape, section=Rectangle(side, side), material=cubic)
                bodies[body.name] = replace(body, shape=shape)
    return replace(mechanism, bodies=bodies)


def solid_and_reduced(leg, highest, cutoff):
    """A leg in tetrahedra with its mass as CalculiX integrates it, and what it is reduced to."""
    solid = solid_leg(leg, tetrahedra(leg.section, leg.length, 1))
    solid = replace(solid, mass=mass_at_stiffness_points(solid.mesh, leg.material.rho))
    held = held_leg(solid_leg_matrices(solid))
    return solid, craig_bampton(held, highest, cutoff).matrices


def solid_legs(mechanism):
    """Solids by body, and what they are reduced to; alike ones once."""
    made, legs = {}, legs_of(mechanism)
    for leg in legs.values():
        key = leg.section, round(leg.length, 9)
        made[key] = made.get(key) or solid_and_reduced(leg, 1400.0, 5600.0)
    both = {body: made[leg.section, round(leg.length, 9)] for body, leg in legs.items()}
    return ({body: pair[side] for body, pair in both.items()} for side in (0, 1))


def agree(at) -> int:
    solids, reduced = solid_legs(at.mechanism)
    solution = solved(assemble(at, reduced))
    found, frequencies = compliance_and_frequencies(at, solids, 10)
    assert scaled_difference(found, compliance(solution)) < PRINTED
    np.testing.assert_allclose(frequencies, modes(solution, 10).frequencies, rtol=PRINTED)
    return solution.idle


@needs_calculix
def test_a_five_bar_with_rotors_a_rigid_link_and_a_joint_that_gives_way_in_all_directions():
    mechanism = of_squares("five-bar")
    *_, last = mechanism.bodies.values()
    rigid = Rigid(6.0, np.array([0.1, 0.02, 0.03]), np.diag([0.2, 0.3, 0.4]) + 0.01)
    bodies = {**mechanism.bodies, last.name: replace(last, shape=rigid)}
    root = np.random.default_rng(1).normal(size=(6, 6))
    first, *others = (
        replace(one, drive=replace(one.drive, inertia=0.5)) if one.drive else one
        for one in mechanism.joints
    )
    assert first.drive
    first = replace(first, compliance=1e-8 * (root @ root.T + np.eye(6)))
    soft = replace(mechanism, bodies=bodies, joints=(first, *others))
    assert agree(posture(soft, soft.poses[0])) == 0


@needs_calculix
@pytest.mark.exhaustive
def test_a_delta_whose_rods_spin_idly():
    assert agree(reference_posture(of_squares("delta"))) == 6


RATIO, MODES, FIRST, LAST = 0.02, 40, 50.0, 1500.0


def receptances_by_calculix(text, folder):
    """Frequencies (Hz) and receptances (complex, m/N) of the tip along y, from modes alone.

    Printed are real parts, then imaginary ones, frequency by frequency, between resonances and at
    them.
    """
    tip = int(re.search(r"NSET=WATCHED\n(\d+)", text)[1])
    text = text.replace("*FREQUENCY\n", "*FREQUENCY, STORAGE=YES\n")
    text += f"*STEP\n*STEADY STATE DYNAMICS\n{FIRST}, {LAST}, 10\n*MODAL DAMPING\n1, {MODES}, "
    text += f"{RATIO}\n*CLOAD\n{tip}, 2, 1.0\n*NODE PRINT, NSET=WATCHED\nU\n*END STEP\n"
    (folder / "deck.inp").write_text(text, encoding="ascii")
    program = [calculix_program(), "-i", "deck"]
    subprocess.run(program, cwd=folder, check=True, capture_output=True)
    printed = (folder / "deck.dat").read_text(encoding="ascii")
    rows = re.findall(rf"and time +(\S+)\n\n +{tip} +\S+ +(\S+) ", printed)
    numbers = np.array(rows, dtype=float).reshape(-1, 2, 2)
    return numbers[:, 0, 0], numbers[:, 0, 1] + 1j * numbers[:, 1, 1]


@needs_calculix
def test_a_damped_leg_swings_as_calculix_says(tmp_path):
    """What forty modes of CalculiX leave out stands still, and is too small to be seen at peaks."""
    leg = ConstantLeg(0.5, Rectangle(0.04, 0.06), STEEL)
    solid, reduced = solid_and_reduced(leg, LAST, 6.0 * LAST)
    deck = replace(leg_deck(solid.mesh, STEEL, MODES), load_cases=())
    frequencies, theirs = receptances_by_calculix(deck_text(deck), tmp_path)
    assert len(frequencies) > 40
    alone = replace(leg_alone("leg", leg), damping=RATIO)
    found = damped_modes(solved(assemble(reference_posture(alone), {"leg": reduced})), LAST)
    own = found.along(np.array([0.0, 1.0, 0.0])).receptance(frequencies)
    assert np.abs(theirs).max() > 10.0 * np.abs(theirs[0])
    apart = own - theirs
    left_out = apart[0].real
    assert 0.0 < left_out < 1e-4 * theirs[0].real
    # Seven digits of a frequency are 1e-5 of the answer beside a resonance.
    sizes = np.maximum(np.abs(theirs), np.abs(theirs[0]))
    assert (np.abs(apart - left_out) < 3e-5 * sizes).all()


@needs_calculix
def test_error_of_calculix_is_quoted_with_the_deck():
    deck = leg_deck(tetrahedra(Rectangle(0.1, 0.1), 0.2, 1), STEEL)
    foreign = Equation((10**6, 0), (((0, 0), 1.0),))
    broken = replace(deck, title="foreign node", equations=(*deck.equations, foreign))
    with pytest.raises(ComputationError, match=r"foreign node: .*\*ERROR"):
        run_calculix(broken)
