"""Table [agree] of a robot file: default values, reading, faults, and its place in the key list."""

import json
from dataclasses import asdict, replace
from itertools import product

import pytest

from lumped.acceptance.requirement import AgreementLimits
from lumped.errors import InputError
from lumped.robot_file import load_robot, write_template
from lumped.robot_file.rules.published import json_schema

# Elements and convergence as the paper states them (20 elements, 1 %); the compliance limit is the
# difference to be expected between beam theory and solids in statics.
DEFAULTS = {
    "elements": 20,
    "convergence": 0.01,
    "compliance": 0.001,
    "frequency": 0.01,
    "ends": "as given",
}


@pytest.fixture
def robot_with(tmp_path):
    """Function that writes a built-in robot with the given [agree] table, and loads the file."""

    def load(agree, robot="ifw", text=""):
        path = tmp_path / "mine.toml"
        path.write_text(f"{load_robot(robot).text}\n[agree]\n{agree}\n{text}", encoding="utf-8")
        return load_robot(path)

    return load


def test_agreement_limits_have_defaults(robot_with):
    """Without [agree] all limits have the defaults of the guide."""
    assert asdict(load_robot("ifw").agreement) == DEFAULTS
    assert asdict(robot_with("").agreement) == DEFAULTS


@pytest.mark.parametrize("robot", ["ifw", "five-bar"])
def test_agreement_limits_are_read(robot_with, robot):
    """All keys of [agree], in both formats of robot files."""
    table = 'elements = 12\nconvergence = 0.02\ncompliance = 0.003\nfrequency = 0.04\nends = "free"'
    agreement = robot_with(table, robot).agreement
    assert agreement == AgreementLimits(12, 0.02, 0.003, 0.04, "free")


@pytest.mark.parametrize(
    ("agree", "fault"),
    [
        ("elements = 0", "agree.elements = 0: must be at least 1"),
        ("elements = 201", "agree.elements = 201: must be at most 200"),
        ("elements = 20.5", "agree.elements = 20.5: must be a whole number from 1 to 200"),
        ("convergence = 0.0", "agree.convergence = 0.0: must be at least 1e-06 (0.05 is 5 %)"),
        ("convergence = 5", "must be at most 1 (0.05 is 5 %); is this in percent?"),
        ('frequency = "1 %"', 'agree.frequency = "1 %": must be a number from 1e-06 to 1'),
        ("compliance = -1.0", "agree.compliance = -1.0: must be at least 1e-06"),
        ('ends = "pinned"', 'agree.ends = "pinned": must be "as given" or "rigid" or "free"'),
        ("element = 20", 'agree.element: unknown key; did you mean "elements"?'),
    ],
)
def test_invalid_agreement_is_refused(robot_with, agree, fault):
    """Each fault of [agree] gives one line with file, key and range."""
    with pytest.raises(InputError) as raised:
        robot_with(agree)
    (line,) = raised.value.faults
    assert fault in line
    assert "mine.toml" in line


@pytest.mark.parametrize(
    ("ends", "leg_ends", "expected"),
    [
        ("as given", None, "rigid"),
        ("as given", "free", "free"),
        ("free", "rigid", "free"),
        ("rigid", "free", "rigid"),
    ],
)
def test_table_agree_sets_ends_of_solids(ends, leg_ends, expected):
    """The end condition in [agree] overrides that of the leg. The default is rigid."""
    assert AgreementLimits(ends=ends).ends_of(leg_ends) == expected


def test_agreement_limit_is_not_uncertain(robot_with):
    """`--inputs` assumes keys named `compliance` to be uncertain, but not `agree.compliance`."""
    robot = replace(robot_with("compliance = 0.002"), supposed=0.05)
    assert "foot.compliance" in robot.uncertain_inputs
    assert "agree.compliance" not in robot.uncertain_inputs
    uncertain = '[[input_uncertainty]]\nkey = "agree.compliance"\nrelative = 0.1'
    with pytest.raises(InputError, match="must name a number or a matrix of the robot"):
        robot_with("compliance = 0.002", text=uncertain)


@pytest.mark.parametrize("kind", ["biglide", "five-bar"])
def test_new_file_has_agreement_limits(tmp_path, kind):
    """`flexproof new` writes each key of [agree] as a comment with its default."""
    write_template(tmp_path / "new.toml", kind)
    lines = (tmp_path / "new.toml").read_text(encoding="utf-8").replace("\n#     ", " ").split("\n")
    for key, value in DEFAULTS.items():
        (line,) = [line for line in lines if line.startswith(f"# agree.{key}:")]
        assert line.endswith(f"; default {json.dumps(value)}")


def test_schema_has_agreement_defaults():
    for unit, branch in product(("then", "else"), repeat=2):
        properties = json_schema()[unit][branch]["properties"]["agree"]["properties"]
        assert {key: entry["default"] for key, entry in properties.items()} == DEFAULTS
