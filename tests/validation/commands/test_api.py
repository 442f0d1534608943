"""flexproof from Python: the results of the command line as frozen data with tables and plots."""

from dataclasses import FrozenInstanceError, replace
from html import escape

import numpy as np
import pytest
from support.robots.paper_robot_variants import IFW

from lumped.errors import InputError
from lumped.robot_file import load_robot
from validation import api


@pytest.fixture(scope="module")
def judged(paper, paper_subject):
    return api.Adequacy(paper, IFW.requirement, paper_subject)


@pytest.mark.exhaustive
def test_api_solve_equals_command(command):
    """`fp.solve` and `flexproof solve --json`: equal bits."""
    options = ["--model", "segments", "--x", "0.3", "--theory", "euler-bernoulli", "--modes", 2]
    (printed,) = command.json("solve", "ifw", *options)["results"]
    # A pose of one coordinate may be a number.
    for pose in (0.3, [0.3]):
        arguments = {"poses": [pose], "modes": 2, "theory": "euler-bernoulli"}
        (answer,) = api.solve("ifw", "segments", **arguments).answers
        assert np.array_equal(answer.compliance, printed["compliance"])
        assert answer.frequencies.tolist() == printed["frequencies"]


@pytest.mark.soak
def test_api_adequacy_equals_run(tmp_path):
    """`fp.adequacy` and `fp.run(only="adequacy")`: equal entries, parts and notes."""
    judged = api.adequacy("ifw", preset="quick")
    finished = api.run("ifw", out=tmp_path / "run", preset="quick", only="adequacy", jobs=1)
    assert (finished.exit_code, finished.verdicts) == (0, {})
    assert finished.report.is_file()
    assert [(e.model, e.quantity, e.verdict) for e in finished.matrix.entries] == [
        (e.model, e.quantity, e.verdict) for e in judged.matrix.entries
    ]
    # One choice of what is judged: each leg alone and the notes are there, too.
    assert [part.robot for part in judged.matrix.parts] == ["leg1", "leg2"]
    for name in ("attached", "notes", "supposed"):
        assert getattr(finished.matrix, name) == getattr(judged.matrix, name)
    assert finished.matrix.formulation.robot == "equivalent legs"


def test_api_run_counts_verdicts(tmp_path):
    """Three comparisons of the beam elements of leg 1, all of which agree."""
    finished = api.run(
        "ifw", out=tmp_path / "run", preset="quick", only="leg1.converged?beam*", jobs=1
    )
    assert (finished.exit_code, finished.verdicts) == (0, {"agree": 3})
    assert finished.report == tmp_path / "run" / "report.html"
    assert "<!DOCTYPE html>" in finished.report.read_text(encoding="utf-8")


def test_wrong_name_error_has_valid_names(judged):
    """Unknown model, unknown quantity, or a frequency of a static model."""
    for model, quantity, message in (
        ("bem", "x", 'model "bem" is not judged; there are simplified'),
        ("beam", "f99", 'quantity "f99" is not judged; there are x, y'),
        ("vjm", "f1", 'model "vjm" does not define "f1"'),
    ):
        with pytest.raises(InputError, match=message):
            judged.entry(model, quantity)


def test_arguments_override_file_limits():
    """`fp.load(accept=…)` replaces single limits of [accept]; wrong ones are refused."""
    assert api.load("ifw").requirement == load_robot("ifw").requirement
    loaded = api.load("ifw", accept={"deflection": 0.2, "z": 0.5})
    limits = {
        quantity.name: loaded.requirement.limit(quantity)
        for quantity in loaded.requirement.quantities
    }
    assert [limits[name] for name in ("x", "z", "f1")] == [0.2, 0.5, 0.05]
    for wrong in ({"deflexion": 0.1}, {"z": 5.0}, {"z": 0.0}):
        with pytest.raises(InputError, match="accept"):
            api.load("ifw", accept=wrong)


def test_results_are_frozen_and_have_repr(judged):
    """Attributes cannot be set, and notebooks show a table."""
    html = judged._repr_html_()
    assert escape(judged.sentence) in html
    assert html.count("<tr>") == 1 + len(judged.matrix.models)
    assert "✗" in html
    with pytest.raises(FrozenInstanceError):
        judged.matrix = None
    solution = api.solve("ifw", "simplified")
    assert solution._repr_html_().count("<td") == 4
    assert "IFW demonstrator, simplified" in solution._repr_html_()


def test_solution_has_table_and_plot():
    """The beam model at two poses; an infinite frequency is None in the table."""
    solution = api.solve("ifw", "beam", poses=[0.3, 0.5], modes=2)
    table = solution.table()
    units = ("x (m/N)", "y (m/N)", "z (m/N)", "phi_x (rad/(N m))", "phi_y (rad/(N m))")
    assert table.headings == ("at", *units, "phi_z (rad/(N m))", "f1 (Hz)", "f2 (Hz)")
    for row, answer in zip(table.rows, solution.answers, strict=True):
        assert row[1:7] == tuple(np.diag(answer.compliance))
        assert row[7:] == tuple(answer.frequencies)
    deflection, frequency = solution.plot().axes
    assert deflection.get_title(loc="left") == "deflection along a force of 1000 N (µm)"
    curves = [line.get_ydata() for line in deflection.get_lines()]
    expected = [
        [np.diag(answer.compliance)[k] * 1e9 for answer in solution.answers] for k in range(3)
    ]
    np.testing.assert_allclose(curves, expected)
    frequencies = [line.get_ydata() for line in frequency.get_lines()]
    np.testing.assert_allclose(np.transpose(frequencies), [a.frequencies for a in solution.answers])
    rigid = replace(solution.answers[0], frequencies=np.array([100.0, np.inf]))
    assert replace(solution, answers=(rigid,)).table().rows[0][7:] == (100.0, None)


def test_solution_at_one_pose_has_bars():
    """Bars are the diagonal of the compliance under 1000 N, in µm."""
    solution = api.solve("ifw", "vjm", poses=[0.4975])
    (deflection,) = solution.plot().axes
    heights = [patch.get_height() for patch in deflection.patches]
    np.testing.assert_allclose(heights, np.diag(solution.answers[0].compliance)[:3] * 1e9)


def test_adequacy_has_table_and_plot(judged):
    """A row for each entry, a panel for each quantity."""
    table = judged.table()
    column = {name: index for index, name in enumerate(table.headings)}
    assert len(table.rows) == len(judged.matrix.entries) > 20
    for row, entry in zip(table.rows, judged.matrix.entries, strict=True):
        assert row[:3] == (entry.model, str(entry.quantity), entry.verdict)
        assert row[column["limit (%)"]] == 100.0 * entry.limit
        if entry.error is not None:
            assert row[column["error (%)"]] == 100.0 * entry.error
            assert row[column["low (%)"]] <= row[column["error (%)"]] <= row[column["high (%)"]]
    titles = [axes.get_title(loc="left") for axes in judged.plot().axes]
    assert titles[:3] == ["force along x", "force along y", "force along z"]


@pytest.mark.parametrize(
    ("robot", "arguments", "message"),
    [
        ("five-bar", {"poses": [[0.1]]}, r"^poses 0\.1: must be x,y as finite numbers"),
        ("ifw", {"poses": [[0.3, 0.4]]}, "^poses 0.3,0.4: must be x as finite"),
        ("ifw", {"poses": [0.3], "leg": 1}, "leave out poses or leg$"),
        ("ifw", {"modes": -1}, "^modes = -1: must be"),
    ],
)
def test_messages_name_python_arguments(robot, arguments, message):
    """Messages name arguments of Python functions, not options such as --pose or --x."""
    with pytest.raises(InputError, match=message) as raised:
        api.solve(robot, "segments", **arguments)
    assert "--" not in str(raised.value)
    with pytest.raises(InputError, match=r"^accept z=9"):
        api.load("ifw", accept={"z": 9.0})


NAMES = "must be one of simplified, vjm, links, segments, beam, solid"
LIST = "must be a list, each entry a number or a list, each entry a number"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: api.solve("five-bar", "fem"), f'^model = "fem": {NAMES}$'),
        (lambda: api.solve("five-bar", "beams"), f'^model = "beams": {NAMES}; did you mean "beam"'),
        (lambda: api.solve("five-bar", ["vjm"]), "^model = .*: must be one of simplified"),
        (
            lambda: api.solve("five-bar", "segments", theory="x"),
            '^theory = "x": must be one of euler-bernoulli, timoshenko$',
        ),
        (
            lambda: api.solve("five-bar", "segments", layout="x"),
            '^layout = "x": must be one of half, literal$',
        ),
        (
            lambda: api.solve("five-bar", "solid", ends="x"),
            '^ends = "x": must be one of rigid, free$',
        ),
        (
            lambda: api.solve("five-bar", "segments", elements=1.5),
            r"^elements = 1\.5: must be a whole number$",
        ),
        (
            lambda: api.solve("five-bar", "segments", elements=True),
            "^elements = true: must be a whole number$",
        ),
        (
            lambda: api.solve("five-bar", "solid", divisions="x", ends=3),
            '^divisions = "x": must be a whole number\nends = 3: must be one of rigid, free$',
        ),
        (
            lambda: api.solve("five-bar", "beam", modes=1.5),
            r"^modes = 1\.5: must be a whole number or None$",
        ),
        (lambda: api.solve("five-bar", "beam", poses=3), f"^poses = 3: {LIST}$"),
        (lambda: api.solve("five-bar", "beam", poses=[["a", 1.0]]), f"^poses = .*: {LIST}$"),
        (lambda: api.solve("five-bar", "beam", poses=[[1j, 1.0]]), f"^poses = .*: {LIST}$"),
        (lambda: api.solve("five-bar", "beam", body=["crank1"]), "^body = .*: must be a text or"),
        (lambda: api.solve(3, "beam"), "^robot = 3: .* or a text or a path or a dictionary$"),
        (lambda: api.load("ifw", accept=3), "^accept = 3: must be a dictionary, each value a numb"),
        (lambda: api.adequacy("five-bar", preset="x"), "^preset = .*: must be one of quick, stand"),
        (lambda: api.run("five-bar", preset="fin"), 'standard, fine; did you mean "fine"'),
        (lambda: api.run("five-bar", out=3), "^out = 3: must be a text or a path$"),
        (lambda: api.run("five-bar", only=3), "^only = 3: must be a text or None$"),
        (lambda: api.run("five-bar", jobs="x"), '^jobs = "x": must be a whole number or None$'),
        (lambda: api.run("five-bar", jobs=0), "^jobs = 0: must be a whole number from 1 to 1024$"),
        (lambda: api.run("five-bar", vary="a=1:2:2"), "^vary = .*: must be a list, each entry a t"),
        (lambda: api.converge("five-bar", model="x"), "^model = .*: must be one of segments, beam"),
        (lambda: api.converge("five-bar", elements=[]), "^elements = none: must be one or more"),
        (lambda: api.converge("five-bar", elements=[0, 2]), "^elements = 0, 2: must be one or mo"),
        (lambda: api.converge("five-bar", elements=[2.5]), "^elements = .*, each entry a whole nu"),
    ],
)
def test_error_names_the_wrong_argument(call, message, tmp_path, monkeypatch):
    """Unknown names and values of Python arguments: one line, and no files are written."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=message):
        call()
    assert not list(tmp_path.iterdir())


def test_adequacy_arguments_are_checked(judged):
    """Wrong types of model, limit and quantities."""
    for call in (
        lambda: judged.entry(3, "x"),
        lambda: judged.entry("beam", "x", within="y"),
        lambda: judged.assert_adequate("beam", ["x"]),
        lambda: judged.accepting({"x": "y"}),
    ):
        with pytest.raises(InputError, match=r" = .*: must be "):
            call()


# The project's own earlier answers: errors of the matrix of ifw at quick, x/F (m/N), f1 and f3 (Hz)
# of others in the middle of the path. They decide nothing; who moves them on purpose says why.
# Frequencies: the inside of a 6×6 leg is bracketed between a soft and a stiff extreme.
FROZEN_ERRORS = {
    ("simplified", "y"): 0.89602311,
    ("simplified", "f2"): 5.115965267,
    ("vjm-equivalent", "any_force"): 0.618015531,
    ("segments", "z"): 0.349971038,
    ("segments", "f1"): 0.425148974,
    ("beam", "x"): 0.615662719,
    ("beam", "phi_y"): 0.854658045,
    ("beam", "f3"): 1.964231993,
    ("segments-euler-bernoulli", "z"): 0.359924021,
}
FROZEN_UNCERTAINTIES = {
    ("vjm", "x"): 0.00168180953,
    ("vjm", "phi_z"): 0.00103821872,
    ("segments", "z"): 0.000376305019,
    ("simplified", "f2"): 0.004604978019,
}
FROZEN_ANSWERS = {
    ("five-bar", "simplified"): [1.110012755e-06, 91.5575915],
    ("five-bar", "vjm"): [1.177733201e-06],
    ("five-bar", "segments"): [1.177733201e-06, 58.5972873, 125.844421],
    ("hexapod", "simplified"): [4.597314715e-08, 165.151438, 348.828427],
    ("hexapod", "vjm"): [6.153684348e-08],
    ("hexapod", "segments"): [6.153684348e-08, 101.814433, 120.863227],
}


def test_api_results_equal_frozen_values(judged):
    """Errors, uncertainties and solutions of an earlier version, to 1e-6."""
    # Between machines eigenvalue solvers differ by 1e-9; 1e-6 is far below any limit of a model.
    for name, error in FROZEN_ERRORS.items():
        assert judged.entry(*name).error == pytest.approx(error, rel=1e-6), name
    # Virtual joints are the reference itself, whose digits alone leave something open.
    for quantity in ("x", "phi_z"):
        assert judged.entry("vjm", quantity).error == pytest.approx(0.0, abs=1e-10)
    for name, uncertainty in FROZEN_UNCERTAINTIES.items():
        assert judged.entry(*name).uncertainty == pytest.approx(uncertainty, rel=1e-6), name
    for name, expected in FROZEN_ANSWERS.items():
        answer = api.solve(*name, modes=3 * (len(expected) > 1)).answers[0]
        numbers = [answer.compliance[0, 0], *answer.frequencies[::2]]
        assert numbers == pytest.approx(expected, rel=1e-6), name
