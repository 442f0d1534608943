"""The adequacy of a mechanism's models: what is sampled, what is held against what, whole runs."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from lumped.errors import InputError
from lumped.legs import ConstantLeg, equivalent_leg
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.models.bodies import legs_of, tip_compliances
from lumped.robot_file import load_robot
from lumped.system.assembly import assembly
from lumped.system.solution import modes, solved
from validation import api, cli
from validation.adequacy.mechanism.path import (
    HOLD,
    MOST_POSES,
    holding,
    path_postures,
    why_not_serial,
)
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.statics import assembled, summed
from validation.adequacy.models import judged_models
from validation.catalogue import catalogue
from validation.context import Context
from validation.models.legs import leg_compliance, leg_matrices
from validation.models.mechanism import answers, constant_legs
from validation.models.options import ModelOptions
from validation.session.validate import Request, validate

BEAMS = ("beam", "segments")
# Of the legs of the five-bar.
KINDS = ("crank", "rod")


def twice_as_soft_along_z(tip):
    """No straight leg is: its deflection alone, not what it turns under a force."""
    soft = tip.copy()
    soft[2, 2] *= 2.0
    return soft


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """The five-bar on two poses, cranks known by a 6×6."""
    sound = load_robot("five-bar")
    leg = legs_of(sound.mechanism)["crank1"]
    tip = twice_as_soft_along_z(tip_compliances(sound.mechanism)["crank1"])
    prism = re.compile(r"(\[bodies\.crank.\]\nfrom.*\nto.*\n)section.*\nmaterial.*\n")
    given = rf"\1mass = {leg.mass!r}\ncompliance = {tip.tolist()!r}\n"
    text, changed = prism.subn(given, sound.text)
    assert changed == 2
    path = tmp_path_factory.mktemp("five-bar") / "five-bar.toml"
    path.write_text(text.replace("count = 9", "count = 2"), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def ran(short):
    out = short.parent / "run"
    return api.run(short, out=out, preset="quick", only="adequacy*", jobs=1)


def test_a_run_of_a_mechanism_ends_with_its_matrix(short, ran):
    assert (ran.exit_code, ran.verdicts) == (0, {})
    matrix = ran.matrix
    assert list(map(str, matrix.coordinates)) == ["x (m)", "y (m)"]
    assert np.allclose(matrix.poses, load_robot(short).mechanism.poses)
    assert tuple(note.model for note in matrix.models) == tuple(
        judged_models(load_robot(short).mechanism)
    )
    assert all(matrix.verdict(model) == "adequate" for model in ("vjm", "links"))
    # Rigid bodies move in the plane of their drives alone.
    for quantity in ("z", "phi_x", "phi_y"):
        entry = matrix.entry("simplified", quantity)
        assert (entry.error, entry.along) == (pytest.approx(1.0), pytest.approx(-1.0))
        assert entry.causes[0].cause == "drives only: bodies and joints rigid"
        assert entry.remedy == "use vjm"


def test_its_report_and_results_show_the_matrix(ran):
    page = ran.report.read_text(encoding="utf-8")
    assert "VJM with the legs as given and links hold for deflections" in page
    assert "of solids of the same equivalent legs: the formulation holds" in page
    written = json.loads((ran.out / "results.json").read_text(encoding="utf-8"))
    assert written["run"]["robot"] == "five-bar"
    found = {(e["model"], e["quantity"]): e for e in written["adequacy"]}
    assert len(found[("beam", "f1")]["pose"]) == 2
    assert (ran.out / "junit.xml").is_file()


def test_a_run_goes_on_and_compares_with_itself(short, ran, capsys):
    again = ["run", str(short), "--preset", "quick", "--only", "adequacy*"]
    assert cli.main([*again, "--out", str(ran.out), "--resume"]) == 0
    assert "report: " in capsys.readouterr().out


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


def test_where_legs_branch_virtual_joints_say_so():
    postures = path_postures(Context(load_robot("delta"), "quick"))
    assert "branches at" in why_not_serial(postures)


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
    assert {"adequacy", "mechanism.closure", "mechanism.statics.solid", "robot.portrait"} <= ids
    assert not any(name.startswith(("robot.beam", "leg1", "decision", "paper")) for name in ids)
    assert len(ids) > 100


def test_what_a_mechanism_does_not_have_is_refused_before_anything_is_written(tmp_path):
    request = Request(load_robot("delta"), "quick", tmp_path / "out", 1, "adequacy")
    with pytest.raises(InputError, match="--cluster"):
        validate(replace(request, cluster="tcp://localhost:1"), catalogue)
    assert not (tmp_path / "out").exists()


def test_frequencies_of_legs_known_by_a_matrix_are_judged_for_plausible_masses(ran):
    assert ran.matrix.supposed.startswith("for every plausible distribution")
    assert any("give f1" in note for note in ran.matrix.notes)


@pytest.mark.exhaustive
def test_models_on_equivalent_legs_are_held_against_solids_of_those_too(short, ran):
    robot_file = load_robot(short)
    postures = path_postures(Context(robot_file, "quick"))
    legs = {n: equivalent_leg(leg) for n, leg in legs_of(robot_file.mechanism).items()}
    own = ran.matrix.formulation
    assert [note.model for note in own.models] == [
        name
        for name in judged_models(robot_file.mechanism)
        if name not in ("simplified", "vjm", "links")
    ]
    # Assembled from solids of the equivalent legs, ends held and free; both of a kind are alike.
    solids = []
    for options in (ModelOptions(ends=ends) for ends in HOLD):
        tips = {kind: leg_compliance("solid", legs[f"{kind}1"], options) for kind in KINDS}
        solids.append({f"{kind}{number}": tips[kind] for kind in KINDS for number in (1, 2)})
    expected = np.array([assembled(postures, tips)[:, 2, 2] for tips in solids])
    for model in BEAMS:
        found = np.array([one.compliance[2, 2] for one in answers(model, postures, 0)])
        errors = np.mean(found / expected - 1.0, axis=0)
        assert own.entry(model, "z").errors == pytest.approx(errors, abs=1e-3)
        assert own.entry(model, "z").verdict == "adequate"
        assert ran.matrix.entry(model, "z").verdict == "inadequate"
