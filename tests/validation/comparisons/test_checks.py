"""Agreement and convergence as pytest items: names, verdicts, messages, one study per robot."""

from importlib.metadata import entry_points

import pytest
from support.pages.report_sample import measured
from support.robots.crane import write_crane

from lumped.acceptance.requirement import AgreementLimits
from lumped.robot_file import load_robot
from validation import api, pytest_plugin
from validation.case import Allowance, Relative, Skip
from validation.comparisons import convergence_cases
from validation.comparisons.checks import agreement_text, checks, convergence_check

pytest_plugins = ["pytester"]
# An environment set up before the plugin was there knows it by its module alone.
_KNOWN = any(
    entry_point.value == pytest_plugin.__name__ for entry_point in entry_points(group="pytest11")
)
PLUGIN_OPTIONS = () if _KNOWN else ("-p", pytest_plugin.__name__)
FILE = ("--flexproof", "mine.toml", "--flexproof-preset", "quick")


@pytest.fixture
def items(pytester):
    """Function that runs pytest on a robot file with a table [agree].

    It returns (outcome, message) by name of the item.
    """

    def run(agree, expression, *options):
        text = f"{load_robot('ifw').text}\n[agree]\n{agree}\n"
        (pytester.path / "mine.toml").write_text(text, encoding="utf-8")
        completed = pytester.inline_run(
            "-p", "no:cacheprovider", *PLUGIN_OPTIONS, *FILE, "-k", expression, *options
        )
        reports = [r for r in completed.getreports("pytest_runtest_logreport") if r.when == "call"]
        return {r.nodeid.rpartition("::")[2]: (r.outcome, str(r.longrepr)) for r in reports}

    return run


def test_check_names_have_body_and_model():
    """Such as `agrees[leg2-vjm-solid-phi_x]`; names are unique."""
    names = [check.name for check in checks(load_robot("ifw"))]
    assert len(set(names)) == len(names)
    # Robot and two legs: six motions by four models and four frequencies by two; four frequencies
    # and three deflections by two models.
    assert len(names) == 3 * (6 * 4 + 4 * 2) + 3 * (7 * 2)
    for name in (
        "agrees[beam-solid-f1]",
        "agrees[leg2-vjm-solid-phi_x]",
        "converged[segments-f1-20]",
        "converged[leg1-beam-z-20]",
    ):
        assert name in names


def test_pytest_items_apply_limit_and_share_study(items, monkeypatch):
    """Segments of leg 1 at 20 elements: f1 0.0089 % off, f3 0.123 %."""
    studies, original = [], convergence_cases.convergence

    def recorded(mechanism, **options):
        studies.append(options)
        return original(mechanism, **options)

    monkeypatch.setattr(convergence_cases, "convergence", recorded)
    results = items("convergence = 0.0005", "converged and leg1-segments")
    outcomes = {name: outcome for name, (outcome, _) in results.items()}
    assert len(outcomes) == 7
    assert outcomes.pop("converged[leg1-segments-f3-20]") == "failed"
    assert outcomes["converged[leg1-segments-f1-20]"] == "passed"
    message = results["converged[leg1-segments-f3-20]"][1]
    assert message.startswith("leg1, f3 by segments with 20 elements or more: disagree\n")
    assert "difference   −0.12 % (allowed 0.05 %)" in message
    assert "Traceback" not in message
    # One by each theory, for seven items.
    assert [options.get("theory") for options in studies] == [None, "euler-bernoulli"]


def test_pytest_item_of_leg_agrees_with_solid(items):
    """Torsion of leg 1 differs by 1.47 %, all but 0.01 % of it by rigid end faces."""
    name = "leg1-vjm-solid-phi_x"
    assert items("", name) == {f"agrees[{name}]": ("passed", "None")}


def test_pytest_items_run_on_two_workers(pytester):
    """With pytest-xdist."""
    (pytester.path / "mine.toml").write_text(load_robot("ifw").text, encoding="utf-8")
    options = ("-k", "converged and leg1 and f1", "-n", "2")
    completed = pytester.runpytest_subprocess(
        "-p", "no:cacheprovider", *PLUGIN_OPTIONS, *FILE, *options
    )
    completed.assert_outcomes(passed=2)


def test_missing_comparison_is_skipped(pytester):
    """A CAD part has no comparison of beams with a solid: the reason is that of the skip."""
    write_crane(pytester.path)
    completed = pytester.inline_run(
        *("-p", "no:cacheprovider", *PLUGIN_OPTIONS, "--flexproof", "robot.toml"),
        *("-k", "agrees and beam-solid-f1"),
    )
    (report,) = [r for r in completed.getreports("pytest_runtest_logreport") if r.when == "call"]
    assert report.outcome == "skipped"
    assert "arm: this comparison is for legs of constant section" in str(report.longrepr)


def test_agreement_text_has_every_number():
    """A difference of 1.5 %, 1.45 % of it explained: the remaining 0.05 % meet a limit of 0.1 %."""
    allowances = (Allowance("held end faces", 2.9),)
    fields = {"model": "beam", "label": "φx", "body": "leg1", "unit": "Hz"}
    fields |= {"allowances": allowances, "tolerance": Relative(0.001)}
    text = agreement_text(measured("beam", 203.0, 200.0, 0.02, exact=False, **fields))
    assert text.splitlines()[0] == "leg1, phi_x, beam compared with solid FE: agree"
    for line in (
        "value        203 Hz",
        "reference    200 Hz",
        "difference   +1.5 %",
        "explained    held end faces +1.4 %",
        "unexplained  +0.05 % (tolerance 0.1 %)",
        "half-width   0.01 %",
    ):
        assert line in text


@pytest.fixture(scope="module")
def study():
    return api.converge("ifw", body="leg1", elements=(5, 10, 20, 40))


@pytest.mark.parametrize(
    ("limits", "verdict"),
    # f1 by segments: 0.0089 % at 20 elements, 0.14 % at 5.
    [
        ((20, 1e-4), "agree"),
        ((20, 8e-5), "disagree"),
        ((5, 1e-2), "agree"),
        ((5, 1e-3), "disagree"),
    ],
)
def test_convergence_check_uses_limit(study, limits, verdict):
    """f1 by segments: 0.0089 % off at 20 elements, 0.14 % at 5."""
    assert convergence_check(study, "segments", "f1", AgreementLimits(*limits)).verdict == verdict


def test_element_count_not_studied_is_skipped(study):
    """12 elements are none of 5, 10, 20 and 40."""
    with pytest.raises(
        Skip,
        match=r"elements = 12: not among .* numbers of elements; must be one of 5, 10, 20, 40",
    ):
        convergence_check(study, "segments", "f1", AgreementLimits(12))
