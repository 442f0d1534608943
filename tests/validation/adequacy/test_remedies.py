"""What a report says to do is a model, an option or a key that there is, and is enough."""

import re
from json import dumps
from pathlib import Path

import pytest
from crane import write_crane
from one_arm import ONE_ARM
from written_robot import robot_of

from lumped.robot_file import load_robot
from lumped.robot_file.rules.published import json_schema
from validation import cli
from validation.adequacy.mechanism.dynamics import DYNAMIC_STEPS
from validation.adequacy.mechanism.parts import FINER_PARTS
from validation.adequacy.mechanism.path import holding
from validation.adequacy.mechanism.statics import STATIC_STEPS
from validation.adequacy.response import SAY_MASSES, USE_SOLID, finer_by
from validation.solids.size import larger_preset
from validation.solve.question import OPTIONS

REMEDIES = {USE_SOLID} | {
    remedy.format(climbs=climbs)
    for steps in (STATIC_STEPS, DYNAMIC_STEPS)
    for *_, remedy in steps.values()
    for climbs in ("vjm", "links")
    if remedy
}
OF_RUNS = (FINER_PARTS, finer_by(larger_preset("quick", lambda preset: preset == "fine")))


def options_in(text: str) -> list[tuple[str, str]]:
    return re.findall(r"--(\w+) (\S+)", text)


@pytest.mark.parametrize("remedy", sorted(REMEDIES))
def test_every_remedy_is_a_model_or_an_option_that_solve_takes(remedy: str) -> None:
    options = dict(options_in(remedy))
    models = re.findall(r"\buse (\w+)", remedy) or [
        model for model, heard in OPTIONS.items() if options and options.keys() <= set(heard)
    ]
    assert models
    for model in models:
        assert options.keys() <= set(OPTIONS[model])
        typed = [word for name, value in options.items() for word in (f"--{name}", value)]
        line = ["solve", "ifw", "--model", model, *typed]
        _, bound, _ = cli.app.parse_args(line, exit_on_error=False, print_error=False)
        assert {name: str(bound.arguments[name]) for name in options} == options


@pytest.mark.parametrize("said", OF_RUNS)
def test_finer_references_are_computed_by_an_option_of_run(said: str) -> None:
    ((name, value),) = options_in(said)
    line = ["run", "ifw", f"--{name}", value]
    _, bound, _ = cli.app.parse_args(line, exit_on_error=False, print_error=False)
    assert str(bound.arguments[name]) == value


def test_masses_are_said_by_keys_of_the_robot_file() -> None:
    keys = re.findall(r"\w+_\w+|\binertia\b", SAY_MASSES)
    assert keys == ["mass_centre", "inertia"]
    schema = dumps(json_schema())
    assert all(f'"{key}":' in schema for key in keys)


def test_ends_are_said_by_a_line_that_can_be_pasted(tmp_path: Path) -> None:
    text = ONE_ARM + "[path]\nposes = [[0.0]]\n"
    robot = robot_of(text, tmp_path).mechanism
    decides = holding(robot).decides
    (table,) = re.findall(r"\[[\w.]+\]", decides)
    lines = re.findall(r'\w+ = "\w+"', decides)
    assert len(lines) == 2
    for line in lines:
        said = robot_of(text.replace(table, f"{table}\n{line}"), tmp_path).mechanism
        assert holding(said).unsaid == ""


def test_interfaces_are_said_by_a_key_that_can_be_pasted(tmp_path: Path) -> None:
    file = write_crane(tmp_path)
    text, decides = file.read_text("utf-8"), holding(load_robot(file).mechanism).decides
    assert "[bodies.arm]" in decides
    ((key, values),) = re.findall(r"(\w+) = (.*) in the interfaces", decides)
    for value in re.findall(r'"\w+"', values):
        said = robot_of(text.replace(" } }", f" }}, {key} = {value} }}"), tmp_path).mechanism
        assert holding(said).unsaid == ""
