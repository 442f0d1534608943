"""References on finer meshes: where a verdict hangs on those of the preset, or one asks for it."""

from dataclasses import replace

import pytest
from one_arm import ONE_ARM
from written_robot import robot_of

from lumped.robot_file import RobotFile
from validation.adequacy.matrix import Matrix
from validation.adequacy.robot import robot_adequacy
from validation.context import Context, Preset


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> RobotFile:
    held = ONE_ARM.replace("height = 0.04 }", 'height = 0.04 }\nends = "rigid"')
    short = held.replace("nu = 0.0", "nu = 0.3").replace("P = [0.0, 0.5", "P = [0.0, 0.2")
    return robot_of(short + "[path]\nposes = [[0.0]]\n", tmp_path_factory.mktemp("arm"))


def by(arm: RobotFile, preset: Preset, accuracy: float | None = None, **limits: float) -> Matrix:
    requirement = replace(arm.requirement, accuracy=accuracy, limits=limits)
    return robot_adequacy(Context(replace(arm, requirement=requirement), preset))


def left_by_meshes(matrix: Matrix) -> float:
    return max(entry.uncertainties.get("meshes", 0.0) for entry in matrix.entries)


@pytest.mark.exhaustive
def test_an_accuracy_is_reached_or_it_is_said_that_it_is_not(arm: RobotFile) -> None:
    rough = by(arm, "quick")
    left = left_by_meshes(rough)
    better = by(arm, "quick", 0.5 * left)
    assert left_by_meshes(better) <= 0.5 * left
    assert better.notes[-1].startswith("accuracy ±")
    assert ";" not in better.notes[-1]
    best = by(arm, "quick", 1e-6)
    assert best.notes[-1].endswith("; no preset has finer meshes of its bodies")
    # What finer meshes say lies within what coarser ones left open.
    for one in rough.entries:
        other = best.entry(one.model, one.quantity)
        if one.error is not None and other.error is not None:
            assert abs(one.error - other.error) <= (one.uncertainty or 0.0) + 1e-9


@pytest.mark.exhaustive
def test_a_verdict_that_hangs_on_meshes_is_decided_by_finer_ones(arm: RobotFile) -> None:
    standard, finer = by(arm, "standard"), by(arm, "fine")
    entry = max(
        (one for one in standard.entries if "meshes" in one.uncertainties),
        key=lambda one: one.uncertainties["meshes"],
    )
    best = finer.entry(entry.model, entry.quantity)
    # A limit that the meshes of this preset leave open, and those of the next one do not.
    size = abs(best.error) + best.uncertainty
    limit = 0.5 * (size + abs(entry.error) + entry.uncertainty)
    decided = by(arm, "standard", **{entry.quantity: limit}).entry(entry.model, entry.quantity)
    assert decided.verdict == "adequate"
    assert decided.uncertainty == pytest.approx(best.uncertainty, rel=1e-6)
