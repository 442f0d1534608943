"""CAD parts in robots: every model of the rocker, and wrong files."""

from pathlib import Path

import pytest
from compliances import scaled_difference

from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from validation.models import parts
from validation.models.mechanism import answers
from validation.models.options import ModelOptions

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
CONDENSED = ModelOptions(parts="condensed")


@pytest.fixture
def coarse(monkeypatch, tmp_path):
    monkeypatch.setattr(parts, "UNKNOWNS", 9000)
    monkeypatch.setattr(parts.identified, "__defaults__", (9000, 2))
    monkeypatch.delenv("FLEXPROOF_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.mark.exhaustive
@pytest.mark.usefixtures("coarse")
def test_a_rocker_of_three_bores_in_every_model_that_takes_it():
    robot = load_robot(EXAMPLES / "rocker" / "robot.toml")
    at = [reference_posture(robot.mechanism)]
    (links,) = answers("links", at, 0)
    (condensed,) = answers("segments", at, 3, CONDENSED)
    (solid,) = answers("solid", at, 3)
    # The rod bends nowhere here, and the rocker is one mesh: statics are those of the solid.
    assert condensed.compliance == pytest.approx(links.compliance, rel=1e-6, abs=1e-14)
    assert scaled_difference(links.compliance, solid.compliance) < 0.02
    # Guyan's mass lies above in frequency, by little for the first.
    assert condensed.frequencies[0] == pytest.approx(solid.frequencies[0], rel=0.02)
    with pytest.raises(InputError, match="3 interfaces cannot be a link of a serial chain"):
        answers("vjm", at, 0)


@pytest.mark.parametrize(
    ("asked", "old", "new", "message"),
    [
        (
            ["solve", "--model", "links"],
            *("radius = 0.022", "radius = 0.023"),
            "no cylinder of radius 0.023 m; the nearest is face",
        ),
        (["check"], 'step = "rocker.step"', 'step = "rock.step"', "rock.step: no such file"),
        (
            ["check"],
            *('step = "rocker.step"', 'mesh = "rocker.step"\nunit = "cm"'),
            "contradicts it",
        ),
    ],
)
def test_a_part_that_is_not_where_the_joints_are(tmp_path, command, asked, old, new, message):
    text = (EXAMPLES / "rocker" / "robot.toml").read_text("utf-8")
    assert old in text
    (tmp_path / "robot.toml").write_text(text.replace(old, new), "utf-8")
    (tmp_path / "rocker.step").write_bytes((EXAMPLES / "rocker" / "rocker.step").read_bytes())
    said = command.refused(asked[0], tmp_path / "robot.toml", *asked[1:])
    assert message in said
    assert "bodies.rocker" in said


def test_checking_a_robot_opens_the_files_of_its_parts(command):
    said = command.told("check", EXAMPLES / "rocker" / "robot.toml")
    assert "rocker: rocker.step, read in mm: 343 × 263 × 60 mm" in said
    for point, radius in (("A", 22), ("B", 16), ("C", 16)):
        (line,) = (one for one in said.splitlines() if one.startswith(f"  {point}: face"))
        assert f"(bore of radius {radius} mm), its axis 0 mm from the point" in line
        assert line.endswith("rigid by default")


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (["identify", "--body", "rod"], "the parts of"),
        (["solve", "--model", "links", "--body", "rocker"], "from a file, see flexproof identify"),
    ],
)
def test_a_part_alone_is_identified_by_its_name_not_solved(command, asked, said):
    robot = EXAMPLES / "rocker" / "robot.toml"
    assert said in command.refused(asked[0], robot, *asked[1:])
