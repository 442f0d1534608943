"""Limits in each form, in the API, pytest fixture, robot files and on the command line.

One made-up robot with known errors (toy_subject) is judged through the API, the pytest plugin and
`flexproof run`; an option that is dropped, or scaled, on its way changes an outcome here.
"""

import inspect
import re
from dataclasses import replace
from importlib.metadata import entry_points
from itertools import groupby
from pathlib import Path

import pytest
from support.fakes import toy_catalogue
from support.fakes.toy_runs import run_in_this_process
from support.fakes.toy_subject import ERROR, F2, toy_subject
from support.pages.report_sample import measured, sample_report, unmeasured

from lumped.errors import InputError
from lumped.robot_file import load_robot
from lumped.robot_file.variation import variations_of
from validation import api, catalogue, cli, pytest_plugin
from validation import validate as session
from validation.adequacy import robot_verdicts as adequacy_of_robot
from validation.adequacy.judgement import verdict_matrix
from validation.case import Measurement
from validation.references.responses import Model
from validation.references.robot_on_path import robot_on_path
from validation.run import runner
from validation.verdicts import Assessment

pytest_plugins = ["pytester"]
BELOW, ABOVE = 0.99, 1.01


@pytest.fixture(autouse=True)
def computed(monkeypatch):
    """Replace computed models by those of the toy; return the list of judged contexts."""
    contexts = []

    def toy(context):
        contexts.append(context)
        return toy_subject(context.robot_file.requirement.modes, robot_on_path(context))

    monkeypatch.setattr(adequacy_of_robot, "robot_subject", toy)
    return contexts


@pytest.mark.parametrize(
    ("quantity", "general", "limit", "verdict"),
    [
        ("x", "deflection", BELOW * ERROR, "inadequate"),
        ("f1", "frequency", ABOVE * ERROR, "adequate"),
        ("f2", "frequency", BELOW * F2[1], "undecided"),
    ],
)
def test_api_accepts_all_limit_forms(quantity, general, limit, verdict):
    """A limit as argument `accept` or `within`, by quantity or by group: one verdict."""
    by_default = api.adequacy("ifw")
    entries = [by_default.entry("beam", quantity, within=limit)]
    for accept in ({quantity: limit}, {general: limit}):
        entries += [
            api.adequacy("ifw", accept=accept).entry("beam", quantity),
            api.adequacy(api.load("ifw", accept=accept)).entry("beam", quantity),
            by_default.accepting(accept).entry("beam", quantity),
        ]
    assert [(entry.verdict, entry.limit) for entry in entries] == [(verdict, limit)] * 7
    assert by_default.accepting({quantity: limit}).entry("beam", "y").limit == 0.05
    if verdict == "adequate":
        by_default.assert_adequate("beam", quantity, within=limit)
    else:
        with pytest.raises(AssertionError, match=f"beam, {quantity}: {verdict}"):
            by_default.assert_adequate("beam", quantity, within=limit)


def test_preset_and_limits_are_applied(computed):
    """The number of modes in `accept` gives the columns of the matrix."""
    for preset in ("quick", "standard", "fine"):
        judged = api.adequacy("ifw", preset=preset, accept={"modes": 6})
        context = computed.pop()
        assert (context.preset, context.robot_file.requirement.modes) == (preset, 6)
        names = [quantity.name for quantity in judged.matrix.quantities]
        assert names[7:] == ["f1", "f2", "f3", "f4", "f5", "f6", "order"]
    # Fewer modes are judged anew, more are refused.
    names = [quantity.name for quantity in judged.accepting({"modes": 2}).matrix.quantities]
    assert names[7:] == ["f1", "f2", "order"]
    with pytest.raises(InputError, match="modes = 8: must be at most 6"):
        judged.accepting({"modes": 8})


RUN = {"out": Path("elsewhere"), "preset": "fine", "only": "leg*", "jobs": 3}
VARY = ("geometry.a=0.9:1:3",)


def test_run_forwards_every_keyword(monkeypatch):
    """Each argument of `fp.run` arrives in the request of the run."""
    requests = []
    monkeypatch.setattr(session, "validate", lambda request, _: requests.append(request) or 1 / 0)
    assert set(inspect.signature(api.run).parameters) == {"robot", "vary", *RUN}
    with pytest.raises(ZeroDivisionError):
        api.run("ifw", vary=VARY, **RUN)
    assert {name: getattr(requests[0], name) for name in RUN} == RUN
    assert requests[0].variations == variations_of(load_robot("ifw"), VARY)


@pytest.mark.parametrize("disagreeing", [0, 2])
def test_run_returns_counts_and_exit_code(monkeypatch, disagreeing):
    """Counts of verdicts, and exit code 1 if a comparison disagrees."""
    outcomes = [measured(f"toy[{k}]", 1.0, 1.0) for k in range(3)]
    outcomes += [measured(f"wrong[{k}]", 2.0, 1.0) for k in range(disagreeing)]
    outcomes.append(unmeasured("left", "skipped", "nothing to compare"))
    gathered = sample_report(outcomes=outcomes, figures=(), missing=(), matrix=None).results
    monkeypatch.setattr(session, "validate", lambda *_: gathered)
    result = api.run("ifw")
    counts = {"agree": 3, "disagree": disagreeing, "skipped": 1}
    assert result.verdicts == {verdict: count for verdict, count in counts.items() if count}
    assert result.exit_code == (1 if disagreeing else 0)
    assert result.seconds == 75.2
    # As a notebook shows it.
    cells = re.findall(r"<td[^>]*>([^<]*)</td>", result._repr_html_())
    assert dict(zip(cells[::2], map(int, cells[1::2]), strict=True)) == result.verdicts
    broken = sample_report(matrix=None, figures=(), missing=()).results
    monkeypatch.setattr(session, "validate", lambda *_: broken)
    assert api.run("ifw").exit_code == 3


PLUGIN = f"""
import pytest

LIMITS = {{"below": {BELOW * ERROR}, "above": {ABOVE * ERROR}}}

@pytest.mark.parametrize("side", LIMITS)
def test_within(flexproof, side):
    flexproof("mine.toml").assert_adequate("beam", "f1", within=LIMITS[side])

@pytest.mark.parametrize("side", LIMITS)
def test_accept(flexproof, side):
    flexproof("mine.toml", accept={{"deflection": LIMITS[side]}}).assert_adequate("beam", "x")

def test_more_modes(flexproof):
    flexproof("mine.toml").assert_adequate("beam", "f1")
    flexproof("mine.toml", accept={{"modes": 6}}).assert_adequate("beam", "f6")
"""


# An environment set up before the plugin was there knows it by its module alone.
_KNOWN = any(
    entry_point.value == pytest_plugin.__name__ for entry_point in entry_points(group="pytest11")
)
PLUGIN_OPTIONS = () if _KNOWN else ("-p", pytest_plugin.__name__)


@pytest.fixture
def in_folder(pytester):
    """Function `run(accept, *options)`: pytest in a folder with a robot; returns outcomes by test.

    `accept` is the text of the robot's table [accept]. `run.messages` has the messages by test and
    `run.code` the exit code of the last call.
    """

    def run(accept, *options):
        robot = f"{load_robot('ifw').text}\n[accept]\n{accept}\n"
        (pytester.path / "mine.toml").write_text(robot, encoding="utf-8")
        session_result = pytester.inline_run("-p", "no:cacheprovider", *PLUGIN_OPTIONS, *options)
        reports = [
            r for r in session_result.getreports("pytest_runtest_logreport") if r.when == "call"
        ]
        run.code = session_result.ret
        run.messages = {r.nodeid.rpartition("::")[2]: str(r.longrepr) for r in reports}
        return {r.nodeid.rpartition("::")[2]: r.outcome for r in reports}

    return run


def test_fixture_has_within_and_accept(in_folder, pytester):
    """Limits can be arguments of the fixture's methods `within` and `accept`."""
    pytester.makepyfile(PLUGIN)
    outcomes = in_folder("")
    assert outcomes.pop("test_more_modes") == "passed"
    for test, message in (
        ("test_within", "beam, f1: inadequate; error +4"),
        ("test_accept", "beam, x: inadequate; error 4"),
    ):
        assert (outcomes[f"{test}[below]"], outcomes[f"{test}[above]"]) == ("failed", "passed")
        assert message in in_folder.messages[f"{test}[below]"]


def test_fixture_path_is_relative_to_test(in_folder, pytester):
    """The folder of the session has another robot of this name, with a limit that is not met."""
    folder = pytester.mkdir("lower")
    (folder / "mine.toml").write_text(
        f"{load_robot('ifw').text}\n[accept]\ndeflection = {ABOVE * ERROR}\n", encoding="utf-8"
    )
    test = "def test_x(flexproof):\n    flexproof('mine.toml').assert_adequate('beam', 'x')\n"
    for path in (pytester.path / "test_upper.py", folder / "test_lower.py"):
        path.write_text(test, encoding="utf-8")
    limit = f"deflection = {BELOW * ERROR}"
    assert in_folder(limit, "test_upper.py") == {"test_x": "failed"}
    assert in_folder(limit, "lower") == {"test_x": "passed"}


def test_robots_of_equal_name_are_separate(in_folder, pytester, computed):
    """Two robots and their files have equal names. Each is judged once for all of its tests."""
    heavier = load_robot("ifw").text.replace("mass = 46.0", "mass = 47.0")
    (pytester.mkdir("other") / "mine.toml").write_text(heavier, encoding="utf-8")
    pytester.makepyfile(
        "import pytest\n"
        "@pytest.mark.parametrize('robot', ['mine.toml', 'other/mine.toml', './mine.toml'])\n"
        "def test_f1(flexproof, robot):\n"
        "    flexproof(robot).assert_adequate('beam', 'f1')\n"
    )
    assert set(in_folder("").values()) == {"passed"}
    masses = (context.robot_file.tables["platform"]["mass"] for context in computed)
    assert [mass for mass, _ in groupby(masses)] == [46.0, 47.0]


@pytest.mark.parametrize(
    ("limit", "sure", "unsure"),
    [(BELOW * ERROR, "failed", "undecided"), (ABOVE * F2[1], "passed", "passed")],
)
def test_robot_file_is_collected_as_tests(limit, sure, unsure, in_folder, computed):
    """`pytest --flexproof FILE`: verdicts become passed, failed and skipped items."""
    accept = f"deflection = {limit!r}\nfrequency = {limit!r}"
    names = ("beam.x", "beam.phi_z", "beam.f1", "beam.f2")
    selection = (
        "--flexproof",
        "mine.toml",
        "-k",
        f"({' or '.join(names)} or vjm.f1) and not euler",
    )
    for options, preset, undecided in (
        ([], "standard", "skipped"),
        (["--flexproof-strict", "--flexproof-preset", "fine"], "fine", "failed"),
    ):
        f2 = undecided if unsure == "undecided" else unsure
        expected = {**dict.fromkeys(names, sure), "beam.f2": f2, "vjm.f1": "skipped"}
        assert in_folder(accept, *selection, *options) == expected
        assert ("beam, x: inadequate; error 4" in in_folder.messages["beam.x"]) is (
            sure == "failed"
        )
        assert "Traceback" not in in_folder.messages["beam.x"]
        assert "model vjm does not define f1" in in_folder.messages["vjm.f1"]
        assert computed.pop().preset == preset


def test_program_error_fails_its_item(in_folder, monkeypatch):
    """If the item were skipped as undecided, the error would never be noticed."""

    def faulty(context):
        toy = toy_subject(context.robot_file.requirement.modes)
        return replace(toy, models=(Model("beam", statics=lambda *_: 1 / 0),))

    monkeypatch.setattr(adequacy_of_robot, "robot_subject", faulty)
    selection = ("--flexproof", "mine.toml", "-k", "beam.x and not euler")
    assert in_folder("", *selection) == {"beam.x": "failed"}
    assert "ZeroDivisionError" in in_folder.messages["beam.x"]


def test_robot_file_gives_pytest_item_per_verdict(in_folder, capsys):
    """96 verdicts on models, and 138 on agreement and convergence."""
    in_folder("", "--flexproof", "mine.toml", "--collect-only", "-q")
    # Eight models by six axes and any force, four frequencies and their order; comparisons of
    # formulations with each other, see test_checks.
    assert capsys.readouterr().out.count("mine.toml::") == 96 + 138


def test_item_location_is_robot_file(in_folder, pytester):
    """Editors and reports of pytest read the location of a test item."""
    items = []

    class Seen:
        def pytest_collection_finish(self, session):
            items.extend(session.items)

    in_folder("")
    pytester.inline_run(*PLUGIN_OPTIONS, "--flexproof", "mine.toml", "--co", plugins=[Seen()])
    assert len(items) == 96 + 138
    assert {item.path for item in items} == {pytester.path / "mine.toml"}
    assert {item.location[0] for item in items} == {"mine.toml"}


@pytest.mark.parametrize("workers", [(), ("-n", "2")], ids=["alone", "workers"])
def test_broken_robot_file_gives_one_error_line(workers, in_folder, pytester):
    """A usage error of pytest, also with two workers."""
    in_folder("x = -1.0")
    completed = pytester.runpytest_subprocess(*PLUGIN_OPTIONS, "--flexproof", "mine.toml", *workers)
    assert completed.ret == pytest.ExitCode.USAGE_ERROR
    completed.stderr.fnmatch_lines(["*mine.toml: accept.x*"])
    assert "Traceback" not in str(completed.stderr) + str(completed.stdout)


def matrix_of(context):
    return verdict_matrix(toy_subject(4), context.robot_file.requirement)


def measured_f2_of(context):
    """Matrix of verdicts against measured values, with f2 of the beam model only."""
    matrix = matrix_of(context)
    return replace(matrix, entries=(matrix.entry("beam", "f2"),))


def uncertain(_context):
    """Measurement of a comparison with so large an uncertainty that the verdict is undecided."""
    return Measurement(1.0, 1.0, 0.2)


ADEQUACY = Assessment("adequacy", "adequacy", matrix_of)
MEASURED = Assessment("adequacy.measured", "measured", measured_f2_of)
UNDECIDED = toy_catalogue.case("toy.undecided", uncertain)
DISAGREES = toy_catalogue.case("toy.disagrees", toy_catalogue.disagrees)


@pytest.fixture
def run(monkeypatch, tmp_path):
    """Function: exit code of `flexproof run` for made-up `tasks`, which run in this process."""
    monkeypatch.setattr(runner, "run", run_in_this_process)
    monkeypatch.setattr(session, "publish", lambda *_: None)

    def run_of(*options, tasks):
        monkeypatch.setattr(catalogue, "catalogue", lambda _: tasks)
        return cli.main(["run", "ifw", "--out", str(tmp_path / "report"), *options])

    return run_of


@pytest.mark.parametrize(
    ("besides", "options", "code"),
    [
        ([], "", 0),
        ([], f"--rely beam --accept deflection={BELOW * ERROR}", 1),
        ([], f"--rely beam --accept deflection={ABOVE * ERROR}", 0),
        ([], f"--rely beam --accept frequency={BELOW * ERROR}", 1),
        # f2 is between 1.9 and 6.1 % off: undecided at the 5 % of the file.
        ([], "--rely beam", 0),
        ([], "--rely beam --strict", 1),
        ([], f"--rely beam --strict --accept f2={ABOVE * F2[1]}", 0),
        ([], "--rely vjm --accept x=0.01", 0),
        # Where nothing is known of a model relied on, only strictness minds.
        ([], "--rely links", 0),
        ([], "--rely links --strict", 1),
        ([MEASURED], "--rely beam --accept frequency=0.01", 1),
        ([UNDECIDED], "", 0),
        ([UNDECIDED], "--strict", 1),
        ([DISAGREES], "", 1),
    ],
)
def test_options_determine_exit_code(besides, options, code, run, capsys):
    """Options --rely, --strict and --accept with verdicts on both sides of a limit."""
    assert run(*options.split(), tasks=[ADEQUACY, *besides]) == code
    refused = "relied on but not adequate" in capsys.readouterr().out
    assert refused == (code == 1 and "--rely" in options)


def test_option_only_keeps_measured_values(run, tmp_path, capsys):
    """Option `--only adequacy` excludes comparisons, but not measured values."""
    values = tmp_path / "values.csv"
    values.write_text("quantity,pose,value,uncertainty,source\nf2,0.4975,80.0,0.1,hammer test\n")
    options = ("--only", "adequacy", "--measured", str(values))
    assert run(*options, tasks=[ADEQUACY, MEASURED, DISAGREES]) == 0
    output = capsys.readouterr().out
    assert "against measured values: " in output
    # The matrix is full: that nothing was compared would be false.
    assert "No comparison was made" not in output
