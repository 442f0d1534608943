"""Whole mechanisms with solid legs held against CalculiX on the same meshes."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from compliances import scaled_difference

from fem.bodies.solid import solid_leg, solid_leg_matrices
from fem.calculix import run as calculix_run
from fem.calculix.leg import mass_at_stiffness_points
from fem.calculix.mechanism import compliance_and_frequencies, mechanism_deck
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.legs import ConstantLeg
from lumped.mechanism.body import Rigid
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from lumped.system.assembly import assemble
from lumped.system.solution import compliance, modes, solved
from meshes.prism.tetrahedra import tetrahedra

needs_calculix = pytest.mark.skipif(
    not any(map(shutil.which, calculix_run.PROGRAMS)), reason="CalculiX (ccx) is not installed"
)
# Seven printed digits; of the reduction, cut off at four times the tenth frequency, less.
PRINTED = 1e-6
# Solid squares, so that coarse meshes are good ones: both sides have the same.
SECTIONS = {"five-bar": {"": 0.06}, "delta": {"arm": 0.06, "rod": 0.04}}


def of_squares(name):
    """The built-in mechanism with legs of solid square sections, a joint of it with a give."""
    mechanism = load_robot(name).mechanism
    bodies = dict(mechanism.bodies)
    for body in mechanism.bodies.values():
        for start, side in SECTIONS[name].items():
            if isinstance(body.shape, ConstantLeg) and body.name.startswith(start):
                shape = replace(body.shape, section=Rectangle(side, side))
                bodies[body.name] = replace(body, shape=shape)
    return replace(mechanism, bodies=bodies)


def solid_legs(mechanism):
    """Solids by body, and what they are reduced to; alike ones once."""
    made, solids, reduced = {}, {}, {}
    for body, leg in legs_of(mechanism).items():
        key = leg.section, leg.material, round(leg.length, 9)
        if key not in made:
            solid = solid_leg(leg, tetrahedra(leg.section, leg.length, 1))
            mass = mass_at_stiffness_points(solid.mesh, leg.material.rho)
            solid = replace(solid, mass=mass)
            held = held_leg(solid_leg_matrices(solid))
            made[key] = solid, craig_bampton(held, 1400.0, 5600.0).matrices
        solids[body], reduced[body] = made[key]
    return solids, reduced


def agree(at) -> int:
    solids, reduced = solid_legs(at.mechanism)
    solution = solved(assemble(at, reduced))
    expected = compliance(solution)
    found, frequencies = compliance_and_frequencies(at, solids, 10)
    assert scaled_difference(found, expected) < PRINTED
    np.testing.assert_allclose(frequencies, modes(solution, 10).frequencies, rtol=PRINTED)
    return solution.idle


@needs_calculix
def test_a_five_bar_with_rotors_and_a_joint_that_gives_way_in_all_directions():
    mechanism = of_squares("five-bar")
    root = np.random.default_rng(1).normal(size=(6, 6))
    give = 1e-8 * (root @ root.T + np.eye(6))
    first, *others = (
        replace(one, drive=replace(one.drive, inertia=0.5)) if one.drive else one
        for one in mechanism.joints
    )
    assert first.drive
    soft = replace(mechanism, joints=(replace(first, compliance=give), *others))
    assert agree(posture(soft, soft.poses[0])) == 0


@needs_calculix
@pytest.mark.exhaustive
def test_a_delta_whose_rods_spin_idly():
    assert agree(reference_posture(of_squares("delta"))) == 6


def test_six_points_have_the_mass_and_the_inertia_of_a_rigid_body():
    mechanism = of_squares("delta")
    inertia = np.diag([2.0, 3.0, 4.0]) + 0.1
    shape = Rigid(6.0, np.array([0.1, 0.2, 0.3]), inertia)
    bodies = dict(mechanism.bodies)
    bodies["platform"] = replace(bodies["platform"], shape=shape)
    at = reference_posture(replace(mechanism, bodies=bodies))
    solids, _ = solid_legs(mechanism)
    deck = mechanism_deck(at, solids, 0).deck
    frame = at.frames["platform"]
    centre = frame.position + frame.rotation @ shape.centre
    points = np.array([deck.nodes[node] for node, mass in deck.masses if mass == 1.0]) - centre
    points = points @ frame.rotation
    # The tool's load is a mass of 1 kg too; it comes last.
    points = points[:6]
    assert points.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12)
    found = np.einsum("ij,ij->", points, points) * np.eye(3) - points.T @ points
    assert found == pytest.approx(inertia, abs=1e-12)
