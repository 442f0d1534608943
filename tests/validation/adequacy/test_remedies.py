"""What a report says to do is a model, an option or a key that there is, and is enough."""

import re
from dataclasses import replace
from json import dumps

import numpy as np
import pytest
from crane import write_crane
from one_arm import ONE_ARM
from written_robot import robot_of

from lumped.acceptance.requirement import Requirement
from lumped.robot_file import load_robot
from lumped.robot_file.rules.published import json_schema
from validation import cli
from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Coordinate
from validation.adequacy.mechanism.dynamics import DYNAMIC_STEPS
from validation.adequacy.mechanism.parts import FINER_PARTS
from validation.adequacy.mechanism.path import holding, known_legs, say_masses
from validation.adequacy.mechanism.statics import STATIC_STEPS
from validation.adequacy.response import (
    NOT_FINER,
    USE_SOLID,
    Alternative,
    Candidate,
    Reference,
    Response,
    Subject,
    finer_by,
)
from validation.solids.size import larger_preset
from validation.solve.question import OPTIONS

STEPS = (*STATIC_STEPS.values(), *DYNAMIC_STEPS.values())
REMEDIES = {
    remedy.format(climbs=climbs)
    for remedy in (USE_SOLID, *(remedy for *_, remedy in STEPS if remedy))
    for climbs in ("vjm", "links")
}
FINER = larger_preset("quick", lambda preset: preset == "fine")


def options_taken(said, *words):
    """The options that are said, of a command that takes them as they are typed."""
    options = dict(re.findall(r"--(\w+) (\S+)", said))
    typed = [word for name, value in options.items() for word in (f"--{name}", value)]
    _, bound, _ = cli.app.parse_args([*words, *typed], exit_on_error=False, print_error=False)
    assert {name: str(bound.arguments[name]) for name in options} == options
    return options


@pytest.mark.parametrize("remedy", sorted(REMEDIES))
def test_every_remedy_is_a_model_or_an_option_that_solve_takes(remedy):
    said = set(re.findall(r"--(\w+)", remedy))
    models = re.findall(r"\buse (\w+)", remedy) or [
        model for model, heard in OPTIONS.items() if said and said <= set(heard)
    ]
    assert models
    for model in models:
        assert options_taken(remedy, "solve", "ifw", "--model", model).keys() <= set(OPTIONS[model])


@pytest.mark.parametrize("said", [FINER_PARTS, finer_by(FINER)])
def test_finer_references_are_computed_by_an_option_of_run(said):
    assert len(options_taken(said, "run", "ifw")) == 1


@pytest.mark.parametrize(
    ("leg1", "leg2", "said"),
    [
        ((), ("inertia",), "inertia in [leg2]"),
        (("mass_centre", "inertia"), ("inertia",), "mass_centre and inertia in [leg1], inertia in"),
        # The built-in robot says both of both legs, and was told to do so.
        ((), (), "a section and a material in place of the 6×6 in [leg1], [leg2]"),
    ],
)
def test_masses_are_said_by_the_keys_that_the_file_leaves_out(leg1, leg2, said):
    legs = known_legs(load_robot("ifw").mechanism)
    for name, keys in (("leg1", leg1), ("leg2", leg2)):
        legs[name] = replace(legs[name], **dict.fromkeys(keys))
    decides = say_masses(legs, 1)
    assert said in decides
    assert ("mass_centre" in decides) == ("mass_centre" in leg1)
    schema = dumps(json_schema())
    assert all(f'"{key}":' in schema for key in ("mass_centre", "inertia", "section", "material"))


def test_ends_and_interfaces_are_said_by_lines_that_can_be_pasted(tmp_path):
    arm = ONE_ARM + "[path]\nposes = [[0.0]]\n"
    decides = holding(robot_of(arm, tmp_path).mechanism).decides
    (table,) = re.findall(r"\[[\w.]+\]", decides)
    lines = re.findall(r'\w+ = "\w+"', decides)
    said = [arm.replace(table, f"{table}\n{line}") for line in lines]
    file = write_crane(tmp_path)
    crane, decides = file.read_text("utf-8"), holding(load_robot(file).mechanism).decides
    assert "[bodies.arm]" in decides
    ((key, values),) = re.findall(r"(\w+) = (.*) in the interfaces", decides)
    values = re.findall(r'"\w+"', values)
    said += [crane.replace(" } }", f" }}, {key} = {value} }}") for value in values]
    assert (len(lines), len(values)) == (2, 3)
    assert not any(holding(robot_of(text, tmp_path).mechanism).unsaid for text in said)


@pytest.mark.parametrize("ends", [0.3, 0.8])
def test_where_no_mesh_is_finer_what_leaves_nearly_as_much_open_is_said(ends):
    """A five-bar's meshes left 0.234 % open, its ends 0.222 %: it was told that nothing helps."""
    exact, axes = np.eye(6)[None], np.full((1, 7), 0.02)
    held = (("rigid", exact), ("free", exact * (1.0 - 0.04 * ends)))
    answers = [Alternative(name, Response(found), static=axes) for name, found in held]
    beam = Candidate("beam", "beam", Response(1.05 * exact))
    for finer, told in ((NOT_FINER, NOT_FINER if ends < 0.5 else "say ends"), ("mesh", "mesh")):
        statics = Reference("solids", answers, open="ends", decides="say ends", finer=finer)
        pose = (Coordinate("x", "m"),), np.zeros((1, 1)), np.ones(1)
        robot = Subject("toy", *pose, [beam], statics, Reference("none", ()))
        entry = judged(robot, Requirement()).entry("beam", "x")
        assert entry.uncertainties["meshes"] > entry.uncertainties["ends"]
        assert (entry.verdict, entry.reason) == ("undecided", told)
