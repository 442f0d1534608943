"""Runs of two variants of a robot: what differs in the input, adequacy side by side, no drift."""

from pathlib import Path

import pytest
from like_ifw import placed_at, stations
from msgspec.json import encode
from msgspec.structs import replace

from lumped.acceptance.requirement import ANY_FORCE, AXES, Requirement
from lumped.robot_file import RobotFile, load_robot
from validation.adequacy.judgement import judged
from validation.adequacy.mechanism.path import robot_at
from validation.adequacy.models import JUDGED
from validation.adequacy.robot import static_subject
from validation.context import Context
from validation.models.mechanism import answers
from validation.results import comparison_text
from validation.results.compare import as_dict, compare
from validation.results.records import CaseRecord, RunRecord, parse_run, run_record
from validation.run.provenance import header

WALLS = """
schema = 1
name = "tubes"
type = "biglide"
geometry = {{ a = 0.9 }}
platform = {{ mass = 30.0 }}
actuators = {{ stiffness = 5.0e8 }}
[leg1]
length = 0.8
section = {{ shape = "tube", diameter = 0.1, thickness = {thickness} }}
material = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}
[leg2]
length = 0.8
section = {{ shape = "tube", diameter = 0.12, thickness = 0.006 }}
material = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}
"""


def variant(folder: Path, thickness: float) -> RobotFile:
    """The robot file with tubes of this thickness (m)."""
    path = folder / f"{thickness}.toml"
    path.write_text(WALLS.format(thickness=thickness), encoding="utf-8")
    return load_robot(path)


def saved(robot_file: RobotFile) -> RunRecord:
    """A run of nothing but the statics of two models, as it is written and read again."""
    robot = robot_file.mechanism
    x = stations(robot, 9)
    context = Context(robot_file, "quick")
    models = {name: JUDGED[name] for name in ("vjm", "beam")}
    subject = static_subject(robot_at(context, placed_at(context.robot_file.mechanism, *x)), models)
    matrix = judged(subject, Requirement())
    return parse_run(encode(run_record(header(robot_file, "quick", {}), (), (), [matrix])), "test")


def one_case(value: float, pose: tuple[float, ...] = ()) -> CaseRecord:
    return CaseRecord(id="a", verdict="agree", value=value, reference=1.0, pose=pose)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("variants")


@pytest.fixture(scope="module")
def both(folder: Path) -> tuple[RunRecord, RunRecord]:
    return saved(variant(folder, 0.004)), saved(variant(folder, 0.003))


def test_statics_of_two_variants_differ_as_solve_says(
    folder: Path, both: tuple[RunRecord, RunRecord]
) -> None:
    thick, thin = (variant(folder, thickness).mechanism for thickness in (0.004, 0.003))
    comparison = compare(*both)
    assert len(comparison.adequacy) == 14
    for change in comparison.adequacy:
        if change.quantity == ANY_FORCE:
            # The worst direction is another one at every pose.
            assert not change.shared_poses
            continue
        index = AXES.index(change.quantity)
        assert len(change.shared_poses) == 9
        for (x,), before, after in change.shared_poses:
            model = "vjm" if change.model == "vjm" else "beam"
            solved = [
                answers(model, placed_at(robot, x), 0)[0].compliance[index, index]
                for robot in (thick, thin)
            ]
            assert after - before == pytest.approx(solved[1] - solved[0], rel=1e-9)


def test_what_differs_in_the_input_is_named(both: tuple[RunRecord, RunRecord]) -> None:
    comparison = compare(*both)
    assert comparison.inputs is not None
    (change,) = comparison.inputs
    assert (change.key, change.before, change.after) == ("leg1.section.thickness", 0.004, 0.003)
    text = comparison_text.as_text(*both, comparison)
    assert "The input differs" in text
    assert "leg1.section.thickness" in text
    record = as_dict(comparison)
    assert record["adequacy"][0]["values"][0].keys() == {"pose", "before", "after"}


def test_numbers_of_different_inputs_do_not_drift(both: tuple[RunRecord, RunRecord]) -> None:
    before = replace(both[0], cases=(one_case(value=1.0),))
    after = replace(both[1], cases=(one_case(value=2.0),))
    assert compare(before, after).drifted == ()
    assert compare(before, replace(after, run=before.run)).drifted != ()


def test_values_of_two_postures_are_not_set_against_each_other(
    both: tuple[RunRecord, RunRecord],
) -> None:
    at_start, elsewhere = (
        replace(
            both[0],
            cases=(one_case(value=value, pose=pose),),
        )
        for value, pose in ((1.0, (0.21,)), (2.0, (0.6,)))
    )
    assert compare(at_start, elsewhere).drifted == ()
    moved = replace(elsewhere.cases[0], pose=(0.21,))
    assert compare(at_start, replace(elsewhere, cases=(moved,))).drifted != ()


def test_runs_of_one_input_have_no_changes_to_tell(both: tuple[RunRecord, RunRecord]) -> None:
    comparison = compare(both[0], both[0])
    assert comparison.inputs == ()
    assert "Adequacy" not in comparison_text.as_text(both[0], both[0], comparison)
