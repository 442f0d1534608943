"""A mechanism's moves by differences of postures: what they say, and what they notice."""

import pytest

from lumped.robot_file import load_robot
from validation.cases.mechanism import motion as mechanism_motion
from validation.context import Context
from validation.faults import detection
from validation.faults.catalogue import FAULTS
from validation.faults.detection import fault_cases
from validation.results.outcome import judge

BY_ID = {fault.id: fault for fault in FAULTS}


def verdicts(robot: str) -> dict[str, str]:
    context = Context(load_robot(robot), "quick")
    return {
        case.id: judge(case, case.compute(context), 0.0).verdict
        for case in mechanism_motion.cases(moving=bool(context.robot_file.mechanism.tool.moves))
    }


@pytest.mark.parametrize("robot", ["five-bar", "3-rrr", "delta", "hexapod"])
def test_moves_stir_what_the_assembler_says(robot):
    assert set(verdicts(robot).values()) == {"agree"}


@pytest.mark.parametrize(
    ("fault", "robot", "case"),
    [
        ("joint.drive-twice", "five-bar", "mechanism.simplified"),
        ("joint.drive-twice", "five-bar", "mechanism.inertia"),
        ("closure.half-angle", "five-bar", "mechanism.simplified"),
        ("system.centre", "five-bar", "mechanism.inertia"),
        ("system.inertia-left-out", "3-rrr", "mechanism.inertia"),
        ("idle.mass-kept", "delta", "mechanism.inertia"),
        ("idle.one-forgotten", "delta", "mechanism.idle"),
        ("idle.counted-twice", "delta", "mechanism.idle"),
    ],
)
def test_mistakes_in_moves_masses_and_idle_motions_turn_a_verdict(fault, robot, case):
    with BY_ID[fault].inject():
        assert verdicts(robot)[case] == "disagree"


def test_run_of_a_mechanism_tries_its_faults_and_passes_over_those_of_biglides(monkeypatch):
    context = Context(load_robot("five-bar"), "standard")
    monkeypatch.setattr(
        detection,
        "catalogue",
        lambda of: mechanism_motion.cases(moving=bool(of.mechanism.tool.moves)),
    )
    cases = {case.id: case for case in fault_cases()}
    caught = cases["fault.system.centre"].compute(context)
    assert caught.table["caught by"] == ("mechanism.inertia",)
    with pytest.raises(Exception, match=r"no comparison of a mechanism uses lumped\.models\.vjm"):
        cases["fault.vjm.tip-joint-forgotten"].compute(context)
