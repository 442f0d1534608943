"""Samples of shapes stand for the mass and the rotary inertia of what moves."""

from dataclasses import replace

import numpy as np
import pytest

from lumped.mechanism.body import Rigid
from lumped.mechanism.kinematics.postures import posture
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.system.assembly import assembly
from validation.adequacy.mechanism.samples import samples_of
from validation.models.mechanism import on_drives_alone


@pytest.mark.parametrize("pose", [0, 8])
def test_rigid_bodies_have_their_kinetic_energy(pose):
    """With a turned platform, whose centre is off its origin; the assembler's mass beside it."""
    mechanism = on_drives_alone(load_robot("hexapod").mechanism)
    shape = Rigid(18.0, np.array([0.02, -0.03, 0.05]), np.diag([3.0, 4.0, 5.0]) + 0.5)
    platform = replace(mechanism.bodies["platform"], shape=shape)
    mechanism = replace(mechanism, bodies={**mechanism.bodies, "platform": platform})
    at = posture(mechanism, mechanism.poses[pose])
    system, samples = assembly(mechanism, {}).at(at), samples_of(mechanism)
    shapes = np.random.default_rng(pose).normal(size=(system.size, 3))
    rigid = [body.shape for body in mechanism.bodies.values() if isinstance(body.shape, Rigid)]
    rows = 3 + 6 * sum(shape.mass > 0.0 for shape in rigid)
    squares = samples.at(system, shapes, {})[:rows] ** 2
    expected = np.diag(shapes.T @ system.mass @ shapes)
    assert samples.weights[:rows] @ squares == pytest.approx(expected, rel=1e-9)


def test_points_of_a_leg_have_its_mass_and_rotary_inertia():
    mechanism = load_robot("five-bar").mechanism
    samples = samples_of(mechanism)
    first = len(samples.weights) - sum(points.size for points in samples.points.values())
    for name, points in samples.points.items():
        masses = samples.weights[first : first + points.size : 3]
        first += points.size
        leg = legs_of(mechanism)[name]
        beam = leg.timoshenko
        assert beam.rho_Iy != pytest.approx(beam.rho_Iz, rel=0.1)
        found = masses @ np.column_stack([np.ones(len(points)), points[:, 1:] ** 2])
        per_length = np.array([beam.mu, beam.rho_Iz, beam.rho_Iy])
        assert found == pytest.approx(leg.length * per_length, rel=1e-9), name
