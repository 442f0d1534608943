"""Limits of the table [agree] in cases, reports, the terminal, `converge` and stored results."""

import json

import pytest

from lumped.acceptance.requirement import AgreementLimits
from lumped.robot_file import load_robot
from validation.catalogue import catalogue
from validation.cli import main
from validation.comparisons.leg_beam_vs_solid import cases
from validation.context import Context
from validation.run.outcome import judge


@pytest.fixture
def mine(tmp_path):
    """Function that writes the built-in robot with a table [agree] and returns the file's path."""

    def write(agree):
        path = tmp_path / "mine.toml"
        path.write_text(f"{load_robot('ifw').text}\n[agree]\n{agree}\n", encoding="utf-8")
        return str(path)

    return write


def run(robot, folder, only, *options):
    """Exit code and cases by id of a quick run with the results in `folder`."""
    code = main(["run", robot, "--preset", "quick", "--only", only, "--out", str(folder), *options])
    cases = json.loads((folder / "results.json").read_text(encoding="utf-8"))["cases"]
    return code, {case["id"]: case for case in cases}


def test_element_count_of_robot_file_is_judged(mine):
    """Segments of leg 1, f3, order 2: 0.77 % off at the 8 elements of [agree], 0.123 % at 20."""
    robot = load_robot(mine("elements = 8\nconvergence = 0.005"))
    by_id = {task.id: task for task in catalogue(robot)}
    assert "leg1.converged[segments-20]" not in by_id
    case = by_id["leg1.converged[segments-8]"]
    outcome = judge(case, case.measure(Context(robot, "quick")), 0.0)
    assert outcome.measurement.value == pytest.approx(0.123e-2 * (20 / 8) ** 2, rel=0.02)
    assert outcome.verdict == "disagree"
    assert "with 8 elements or more is at most 0.5 %" in case.title
    assert case.elements == by_id["leg1.agrees[beam-solid-f1]"].elements == 8
    assert by_id["leg1.agrees[vjm-solid-x]"].elements == 0


def test_element_count_changes_compared_model():
    """With one beam element instead of 20, f1 of leg 1 is 0.48 % high (consistent mass)."""
    context, frequencies = Context(load_robot("ifw"), "quick"), {}
    for elements in (1, 20):
        limits = AgreementLimits(elements=elements)
        (case,) = (
            candidate
            for candidate in cases(legs=("leg1",), limits=limits)
            if candidate.id == "leg1.agrees[beam-solid-f1]"
        )
        frequencies[elements] = case.measure(context).value
    # A cantilever of one cubic element: 3.5327 for 3.5160 (Euler–Bernoulli, shear changes little).
    assert frequencies[1] / frequencies[20] == pytest.approx(3.5327 / 3.5160, abs=3e-4)


def test_agree_ends_select_solid():
    """The solid of leg 1 is 1.47 % stiffer in torsion than the beam.

    With ends free to warp it is not.
    """
    context, differences = Context(load_robot("ifw"), "quick"), {}
    for ends in ("as given", "free"):
        (case,) = (
            candidate
            for candidate in cases(legs=("leg1",), limits=AgreementLimits(ends=ends))
            if candidate.id == "leg1.agrees[vjm-solid-φx]"
        )
        outcome = judge(case, case.measure(context), 0.0)
        assert outcome.verdict == "agree"
        differences[ends] = outcome.measurement.difference / outcome.measurement.reference
    assert differences["as given"] == pytest.approx(0.0147, abs=2e-4)
    assert abs(differences["free"]) < 2e-4


def test_new_limit_rejudges_stored_results(mine, tmp_path, capsys):
    """Segments of leg 1: f3 is 0.123 % off at 20 elements, more than any other quantity."""
    only, name = "leg1.converged?segments-20?", "leg1.converged[segments-20]"
    code, before = run(mine(""), tmp_path / "out", only)
    assert (code, before[name]["verdict"], before[name]["reference"]) == (0, "agree", 0.01)
    assert "20 elements: at most 0.12 %" in capsys.readouterr().out
    strict = mine("convergence = 0.0005")
    quick = ["run", strict, "--preset", "quick"]
    code = main([*quick, "--only", only, "--out", str(tmp_path / "out"), "--resume"])
    assert code == 2
    assert "(robot file differ)" in capsys.readouterr().err
    code, after = run(strict, tmp_path / "out", only)
    assert (code, after[name]["verdict"], after[name]["reference"]) == (1, "disagree", 5e-4)
    assert after[name]["value"] == before[name]["value"]


def test_converge_uses_limits_of_robot_file(mine, capsys):
    """Segments of leg 1, f1: 0.055 % at 8 elements, 0.0089 % at 20; --within overrides the file."""
    for agree, code in (("", 0), ("elements = 8", 0), ("elements = 8\nconvergence = 0.0004", 1)):
        counts = ["--model", "segments", "--elements", "4,8,20"]
        exit_code = main(["converge", mine(agree), "--body", "leg1", *counts])
        streams = capsys.readouterr()
        assert exit_code == code
        assert ("f1: the error reaches 0.055 % with 8 elements or more" in streams.err) is bool(
            code
        )
        stated = "8 elements: +0.055 %" if "8" in agree else "20 elements: +0.0089 %"
        assert stated in streams.out
    option = ["--within", "0.001", "--elements", "4,8"]
    assert main(["converge", mine(agree), "--body", "leg1", *option]) == 0
