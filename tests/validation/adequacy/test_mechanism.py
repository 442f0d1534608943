"""Adequacy of a mechanism's models: sampled poses and points, interpretations, and cases."""

from dataclasses import replace

import numpy as np
import pytest
from support.robots.robot_from_text import robot_of

from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.body import Rigid
from lumped.mechanism.kinematics.postures import posture
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from lumped.system.assembly import assembly
from validation.adequacy.judged_models import judged_models
from validation.adequacy.robot_verdicts import robot_adequacy
from validation.catalogue import catalogue
from validation.context import Context
from validation.models.options import ModelOptions
from validation.models.robot_bodies import on_drives_alone, sectioned_legs
from validation.references.mode_samples import samples_of
from validation.references.robot_on_path import (
    HOLD,
    MOST_POSES,
    holding,
    path_postures,
    why_not_serial,
)

# A prism welded to an arm known by its 6×6, which is twice as soft along z as it would be one.
PRISM = ConstantLeg(0.3, Rectangle(0.06, 0.04), Material.isotropic(2.1e11, 0.3, 7850.0))
SOFTER = tip_compliance(PRISM.timoshenko, PRISM.length) * (1.0 + np.diag([0, 0, 1.0, 0, 0, 0]))
ARM = f"""
schema = 2
name = "arm"
points = {{ A = [0.0, 0.0, 0.0], M = [0.0, 0.3, 0.0], P = [0.0, 0.5, 0.0] }}
joints.weld = {{ type = "fixed", between = ["inner", "outer"], at = "M" }}
tool = {{ body = "outer", point = "P", moves = ["x"] }}
path = {{ poses = [[0.0]] }}
accept = {{ modes = 1 }}
[bodies.inner]
from = "A"
to = "M"
mass = {PRISM.mass}
mass_centre = 0.15
compliance = {SOFTER.tolist()}
[bodies.outer]
from = "M"
to = "P"
section = {{ shape = "rectangle", width = 0.06, height = 0.04 }}
material = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}
ends = "rigid"
[joints.motor]
type = "revolute"
between = ["ground", "inner"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = {{ stiffness = 5.0e4 }}
"""


@pytest.mark.usefixtures("coarse_legs")
def test_mechanism_has_verdicts_and_mass_note(tmp_path):
    """An arm on a slide: its models, poses, causes, remedies and notes."""
    short = robot_of(ARM, tmp_path)
    matrix = robot_adequacy(Context(short, "quick"))
    assert list(map(str, matrix.coordinates)) == ["x (m)"]
    assert np.allclose(matrix.poses, short.mechanism.poses)
    assert [note.model for note in matrix.models] == list(judged_models(short.mechanism))
    assert all(matrix.verdict(model) == "adequate" for model in ("vjm", "links"))
    # Rigid bodies move in the plane of their drives alone.
    for quantity in ("z", "phi_x", "phi_y"):
        entry = matrix.entry("simplified", quantity)
        assert (entry.error, entry.along) == (pytest.approx(1.0), pytest.approx(-1.0))
        assert entry.causes[0].cause == "elastic drives only, bodies and joints rigid"
        assert entry.remedy == "use vjm"
    assert matrix.supposed.startswith("for every plausible distribution")
    assert any("give f1" in note for note in matrix.notes)
    assert matrix.formulation.entry("beam", "z").verdict == "adequate"
    assert matrix.entry("beam", "z").verdict == "inadequate"


def test_branching_robot_has_no_vjm_model():
    """The Delta's arms branch into two rods. The five-bar consists of two serial chains."""
    delta, five_bar = (Context(load_robot(name), "quick") for name in ("delta", "five-bar"))
    assert why_not_serial(path_postures(five_bar)[:1]) == ""
    assert "branches at" in why_not_serial(path_postures(delta)[:1])


def test_unspecified_ends_give_two_readings():
    """Rigid and free ends, for all legs whose end condition the robot file does not specify."""
    mechanism = load_robot("five-bar").mechanism
    legs, bodies = legs_of(mechanism), dict(mechanism.bodies)
    assert list(holding(mechanism).alternatives) == ["ends rigid", "ends free"]
    for name, leg in legs.items():
        bodies[name] = replace(bodies[name], shape=replace(leg, ends="free"))
        alternatives = holding(replace(mechanism, bodies=bodies)).alternatives.values()
        legs_with_ends = [leg for leg in legs if bodies[leg] is not mechanism.bodies[leg]]
        # Of the legs that it says nothing of all are rigid, then all are free.
        ways = [dict.fromkeys(legs, ends) | dict.fromkeys(legs_with_ends, "free") for ends in HOLD]
        assert list(alternatives) == (ways if len(legs_with_ends) < len(legs) else ways[1:])
        options = sectioned_legs(replace(mechanism, bodies=bodies), ModelOptions(ends="rigid"))
        assert {name: option.ends for name, _, option in options} == ways[0]


def test_long_path_is_sampled_evenly():
    """Preset quick takes its largest number of poses out of 41, at equal distances."""
    robot_file = load_robot("five-bar")
    poses = np.linspace(*robot_file.mechanism.poses[[0, -1]], 41)
    longer = replace(robot_file, mechanism=replace(robot_file.mechanism, poses=poses))
    sampled_poses = [posture.pose for posture in path_postures(Context(longer, "quick"))]
    assert len(sampled_poses) == MOST_POSES["quick"]
    assert np.allclose(sampled_poses, poses[:: 40 // (len(sampled_poses) - 1)])


def test_other_mechanism_has_no_biglide_cases():
    """A hexapod has no cases of the paper and of the biglide's legs, but all others."""
    ids = {task.id for task in catalogue(load_robot("hexapod"))}
    assert {"adequacy", "mechanism.exudyn[start]", "robot.portrait"} <= ids
    assert not any(name.startswith(("robot.beam", "leg1", "decision", "paper")) for name in ids)
    assert len(ids) > 100


@pytest.mark.parametrize("pose", [0, 8])
def test_sampled_points_have_kinetic_energy(pose):
    """The platform is rotated and its centre of mass is off its origin.

    The kinetic energy is that of the assembled mass matrix.
    """
    mechanism = on_drives_alone(load_robot("hexapod").mechanism)
    shape = Rigid(18.0, np.array([0.02, -0.03, 0.05]), np.diag([3.0, 4.0, 5.0]) + 0.5)
    platform = replace(mechanism.bodies["platform"], shape=shape)
    mechanism = replace(mechanism, bodies={**mechanism.bodies, "platform": platform})
    pose_posture = posture(mechanism, mechanism.poses[pose])
    system, samples = assembly(mechanism, {}).at(pose_posture), samples_of(mechanism)
    shapes = np.random.default_rng(pose).normal(size=(system.size, 3))
    # The tool, and all that turns; legs have points.
    rows = 3 + 6 * len(samples.turned)
    squares = samples.at(system, shapes, {})[:rows] ** 2
    expected = np.diag(shapes.T @ system.mass @ shapes)
    assert samples.weights[:rows] @ squares == pytest.approx(expected, rel=1e-9)


def test_point_masses_equal_leg_inertia():
    """Point masses at the samples have the mass and the rotary inertia of the leg."""
    mechanism = load_robot("five-bar").mechanism
    samples = samples_of(mechanism)
    counts = [points.size for points in samples.points.values()]
    masses = np.split(samples.weights, len(samples.weights) - np.cumsum(counts[::-1])[::-1])[1:]
    for (name, points), of_leg in zip(samples.points.items(), masses, strict=True):
        leg = legs_of(mechanism)[name]
        beam = leg.timoshenko
        assert beam.rho_Iy != pytest.approx(beam.rho_Iz, rel=0.1)
        moments = of_leg[::3] @ np.column_stack([np.ones(len(points)), points[:, 1:] ** 2])
        per_length = np.array([beam.mu, beam.rho_Iz, beam.rho_Iy])
        assert moments == pytest.approx(leg.length * per_length, rel=1e-9), name
