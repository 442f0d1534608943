"""The adequacy of a mechanism's models: what is sampled, what is held against what."""

import re
from dataclasses import replace

import numpy as np
import pytest
from written_robot import robot_of

from lumped.legs import ConstantLeg
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.models.bodies import legs_of, tip_compliances
from lumped.robot_file import load_robot
from lumped.system.assembly import assembly
from lumped.system.solution import modes, solved
from validation.adequacy.mechanism.parts import assembled
from validation.adequacy.mechanism.path import (
    MOST_POSES,
    holding,
    path_postures,
    why_not_serial,
)
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.statics import summed
from validation.adequacy.models import judged_models
from validation.adequacy.robot import robot_adequacy
from validation.catalogue import catalogue
from validation.context import Context
from validation.models.legs import leg_matrices
from validation.models.mechanism import constant_legs
from validation.models.options import ModelOptions


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """The five-bar in one pose, its rods solid and held, cranks of a 6×6 twice as soft along z."""
    sound = load_robot("five-bar")
    leg = legs_of(sound.mechanism)["crank1"]
    tip = tip_compliances(sound.mechanism)["crank1"].copy()
    tip[2, 2] *= 2.0
    prism = re.compile(r"(\[bodies\.crank.\]\nfrom.*\nto.*\n)section.*\nmaterial.*\n")
    given = rf"\1mass = {leg.mass!r}\ncompliance = {tip.tolist()!r}\n"
    text, changed = prism.subn(given, sound.text)
    assert changed == 2
    box = r'\nsection = { shape = "hollow-(rectangle.*), thickness = .*'
    text = re.sub(box, r'\nends = "rigid"\nsection = { shape = "\1 }', text)
    text = f"{text.partition('[path]')[0]}[path]\nposes = [[-0.2, 0.45]]\n"
    return robot_of(text, tmp_path_factory.mktemp("five-bar"))


@pytest.fixture(scope="module")
def matrix(short):
    return robot_adequacy(Context(short, "quick"))


def test_a_mechanism_has_a_matrix_of_its_own(short, matrix):
    assert list(map(str, matrix.coordinates)) == ["x (m)", "y (m)"]
    assert np.allclose(matrix.poses, short.mechanism.poses)
    assert [note.model for note in matrix.models] == list(judged_models(short.mechanism))
    assert all(matrix.verdict(model) == "adequate" for model in ("vjm", "links"))
    # Rigid bodies move in the plane of their drives alone.
    for quantity in ("z", "phi_x", "phi_y"):
        entry = matrix.entry("simplified", quantity)
        assert (entry.error, entry.along) == (pytest.approx(1.0), pytest.approx(-1.0))
        assert entry.causes[0].cause == "elastic drives only: bodies and joints rigid"
        assert entry.remedy == "use vjm"


def test_samples_have_the_mass_of_the_mechanism():
    """Mass-normalised modes are orthonormal in what the samples stand for."""
    mechanism = load_robot("delta").mechanism
    bodies = {
        name: leg_matrices("beam", leg, own)
        for name, leg, own in constant_legs(mechanism, ModelOptions(elements=6))
    }
    system = assembly(mechanism, bodies).at(reference_posture(mechanism))
    found = modes(solved(system), 8)
    samples = samples_of(mechanism)
    rows = samples.at(system, found.shapes, samples.of_models(bodies))
    gram = rows.T @ (samples.weights[:, None] * rows)
    assert np.allclose(gram, np.eye(8), atol=2e-3)


def test_virtual_joints_and_links_climb_the_same_ladder():
    context = Context(load_robot("five-bar"), "quick")
    postures = path_postures(context)[::4]
    springs = tip_compliances(context.robot_file.mechanism)
    assert np.allclose(
        summed(postures, springs), assembled(postures, springs), rtol=1e-9, atol=1e-18
    )
    assert why_not_serial(postures) == ""
    delta = Context(load_robot("delta"), "quick")
    assert "branches at" in why_not_serial(path_postures(delta)[:1])


def test_ends_are_alternatives_until_the_file_says_them():
    mechanism = load_robot("five-bar").mechanism
    assert list(holding(mechanism).alternatives) == ["ends rigid", "ends free"]
    said = {
        name: replace(body, shape=replace(body.shape, ends="free"))
        if isinstance(body.shape, ConstantLeg)
        else body
        for name, body in mechanism.bodies.items()
    }
    (ends,) = holding(replace(mechanism, bodies=said)).alternatives.values()
    assert set(ends.values()) == {"free"}


def test_long_paths_are_looked_at_in_even_steps():
    robot_file = load_robot("five-bar")
    poses = np.linspace(robot_file.mechanism.poses[0], robot_file.mechanism.poses[-1], 40)
    longer = replace(robot_file, mechanism=replace(robot_file.mechanism, poses=poses))
    shown = [posture.pose for posture in path_postures(Context(longer, "quick"))]
    assert len(shown) == MOST_POSES["quick"]
    assert np.allclose([shown[0], shown[-1]], poses[[0, -1]])


def test_a_mechanism_has_no_cases_of_the_biglide():
    ids = {task.id for task in catalogue(load_robot("hexapod"))}
    assert {"adequacy", "mechanism.exudyn[start]", "robot.portrait"} <= ids
    assert not any(name.startswith(("robot.beam", "leg1", "decision", "paper")) for name in ids)
    assert len(ids) > 100


def test_frequencies_of_legs_known_by_a_matrix_are_judged_for_plausible_masses(matrix):
    assert matrix.supposed.startswith("for every plausible distribution")
    assert any("give f1" in note for note in matrix.notes)
    assert matrix.formulation.entry("beam", "z").verdict == "adequate"
    assert matrix.entry("beam", "z").verdict == "inadequate"
