"""What `solve` says of robots with CAD parts as solids: what is left open, and statics alone."""

from dataclasses import replace

import numpy as np
import pytest
from crane import write_crane

from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from lumped.system.assembly import assembly
from lumped.system.solution import modes, solved
from validation.models import parts
from validation.models.mechanism import CUTOFF, answers, dynamic_bodies
from validation.solve.answer import as_text
from validation.solve.model_answers import solve
from validation.solve.question import Question

pytestmark = pytest.mark.usefixtures("coarse_parts")
COUNT = 4


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    return write_crane(tmp_path_factory.mktemp("crane"))


def solution_of(file, count=COUNT, **given):
    return solve(Question(load_robot(file), "solid", given, count))


def values(answer):
    return np.concatenate([np.diag(answer.compliance), answer.frequencies])


@pytest.fixture(scope="module")
def solution(file):
    return solution_of(file)


@pytest.mark.exhaustive
def test_the_meshes_leave_open_what_a_far_finer_one_changes(solution, file, coarse_parts):
    (own,) = solution.answers
    at = [reference_posture(load_robot(file).mechanism)]
    with coarse_parts.context() as patch:
        patch.setattr(parts, "UNKNOWNS", 20_000)
        (finer,) = answers("solid", at, COUNT)
    apart = np.abs(values(finer) - values(own))
    half_widths = np.concatenate([own.of_parts.compliance, own.of_parts.frequencies])
    # Intervals of 95 %, from the coarsest ladder that this arm has: one of ten may miss.
    assert (apart <= half_widths).sum() >= len(apart) - 1
    assert (apart <= 1.5 * half_widths).all()
    # Worth something: percents of a mesh this coarse, not more.
    assert (half_widths <= 0.1 * values(own)).all()


@pytest.mark.exhaustive
def test_parts_are_meshed_as_finely_as_an_accuracy_asks(file, coarse_parts):
    with coarse_parts.context() as patch:
        patch.setattr(parts, "UNKNOWNS", 1500)
        (rough,) = solution_of(file, 0).answers
        left = rough.of_parts.compliance / np.diag(rough.compliance)
        asked = 0.8 * float(left.max())
        finer = solve(Question(load_robot(file), "solid", {}, 0, accuracy=asked))
    assert finer.accuracy.reached <= asked
    assert finer.accuracy.missed == ""
    (own,) = finer.answers
    # Other meshes, whose intervals meet those of the coarser ones; one of ten may miss.
    apart = np.abs(np.diag(own.compliance - rough.compliance))
    assert (apart > 0.0).all()
    assert (apart <= rough.of_parts.compliance + own.of_parts.compliance).sum() >= 5
    assert (apart <= 1.5 * rough.of_parts.compliance).all()


def test_the_bracket_is_what_the_file_changes_when_it_says_so(solution, file):
    (own,) = solution.answers
    other = file.with_name("average.toml")
    text = file.read_text("utf-8").replace(" } }", ' }, coupling = "average" }')
    other.write_text(text, "utf-8")
    average = load_robot(other).mechanism
    (said,) = answers("solid", [reference_posture(average)], COUNT)
    bracket = np.concatenate([own.of_parts.bracket.compliance, own.of_parts.bracket.frequencies])
    # Interfaces of which nothing is said are rigid.
    assert bracket == pytest.approx(values(said) - values(own), rel=1e-6)
    assert parts.is_held_as_said(average.parts["arm"])
    assert not parts.is_held_as_said(load_robot(file).mechanism.parts["arm"])
    # An averaged interface is the softer one.
    assert (bracket[:6] > 0.0).all()
    assert (bracket[6:] < 0.0).all()


@pytest.mark.parametrize("by", ["fixed", "free"])
def test_dropped_modes_lower_no_frequency_by_more_than_is_said(solution, file, by):
    (own,) = (solution if by == "fixed" else solution_of(file, reduction="free")).answers
    ((count, below),) = own.of_parts.counted.values()
    mechanism = load_robot(file).mechanism
    at = reference_posture(mechanism)
    arm = dynamic_bodies("solid", mechanism, 4.0 * below / CUTOFF["solid"])["arm"]
    assert arm.counted > count
    exact = modes(solved(assembly(mechanism, {"arm": arm}).at(at)), COUNT).frequencies
    too_high = own.frequencies - exact
    rounding = 1e-9 * exact
    assert (too_high >= -rounding).all()
    assert (too_high <= own.of_parts.reduction + rounding).all()
    assert (own.of_parts.reduction < 1e-3 * exact).all()
    assert f"modes of the parts with interfaces {by}, counted" in as_text(
        replace(solution, answers=(own,))
    )


def test_statics_alone_are_those_of_the_part(solution, file):
    """Of the part, not of a prism that is equivalent to it; the same is left open."""
    (dynamic,), (static,) = solution.answers, solution_of(file, 0).answers
    assert static.compliance == pytest.approx(dynamic.compliance, rel=1e-6, abs=1e-15)
    assert static.of_parts.compliance == pytest.approx(dynamic.of_parts.compliance, rel=1e-4)


def test_its_modes_have_partners_among_those_of_another_model(file):
    question = Question(load_robot(file), "solid", {}, 2, against="segments")
    (answer,) = solve(question).answers
    first = answer.pairs["pairs"][0]
    # An equivalent leg swings alike, at a frequency of its own.
    assert first["partner"] == 1
    assert first["mac"] > 0.95


@pytest.mark.parametrize("by", ["fixed", "free"])
def test_a_reduction_that_lacks_a_mode_is_refused(file, monkeypatch, by):
    arm = load_robot(file).mechanism.bodies["arm"]
    sound = parts.kept

    def without_a_mode(key, compute, read):
        found = dict(sound(key, compute, dict))
        if "counted" in found:
            rest = np.delete(np.arange(len(found["stiffness"])), 12)
            found |= {name: found[name][np.ix_(rest, rest)] for name in ("stiffness", "mass")}
            found["recovery"] = found["recovery"][:, rest]
        return read(found)

    whole = parts.reduced(arm, 1000.0, 2500.0, by=by)
    monkeypatch.setattr(parts, "kept", without_a_mode)
    message = f"arm, reduced: {whole.counted} modes were counted below 2500 Hz"
    with pytest.raises(parts.ComputationError, match=message):
        parts.reduced(arm, 1000.0, 2500.0, by=by)
