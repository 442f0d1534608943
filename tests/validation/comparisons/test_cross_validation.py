"""Cross-validation in Python: values for a leg, assertions, table, plot, notebook display."""

import numpy as np
import pytest

from lumped.errors import InputError
from lumped.robot_file import load_robot
from validation import api
from validation.case import Allowance, Case, Measurement, Relative
from validation.comparisons.requested import convergence
from validation.cross_validation import CrossValidation
from validation.run.outcome import judge, outcome_of

ARM = """\
schema = 2
name = "arm"
points = { A = [0.0, 0.0, 0.0], P = [0.0, 0.5, 0.0] }

[bodies.arm]
from = "A"
to = "P"
section = { shape = "rectangle", width = 0.06, height = 0.04 }
material = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
ends = "free"

[joints.motor]
type = "revolute"
between = ["ground", "arm"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = 5.0e4 }

[tool]
body = "arm"
point = "P"
moves = ["x"]
"""


def outcome(body, model, label, measurement, tolerance=0.01):
    case = Case(
        id=f"{body or 'robot'}.agrees[{model}-solid-{label}]",
        title="title",
        quantity="quantity",
        unit="Hz",
        reference_kind="independent-solver",
        citation="citation",
        tolerance=Relative(tolerance),
        tolerance_reason="reason",
        compute=lambda _: measurement,
        model=model,
        label=label,
        kind="agreement",
        body=body,
    )
    if measurement is None:
        return outcome_of(case, "skipped", 0.0, "too large")
    return judge(case, measurement, 0.0)


def measurement(value, explained=0.0, half_width=0.0, reference=200.0):
    return Measurement(
        value,
        reference,
        judged_uncertainty=half_width,
        allowances=(Allowance("held end faces", explained),),
    )


@pytest.fixture(scope="module")
def studies():
    return {"arm": convergence(load_robot("ifw"), body="leg1", elements=[5, 10, 20, 40])}


@pytest.fixture
def crossed(studies):
    """Made-up results for f1: beam 1 % high, 0.9 % explained, ± 0.05 %; segments 3 % high."""
    comparisons = (
        outcome("arm", "beam", "f1", measurement(202.0, 1.8, 0.1)),
        outcome("arm", "segments", "f1", measurement(206.0)),
        outcome("arm", "beam", "φx", None),
        outcome("", "beam", "f1", measurement(-202.0, reference=-200.0)),
    )
    return CrossValidation("toy", comparisons, studies)


@pytest.mark.parametrize("within", [0.00151, None])
def test_explained_difference_agrees(crossed, within):
    """A difference of 1 %, of which 0.9 % is explained; 0.1 ± 0.05 % remain."""
    # 1 % less 0.9 % and the half-width of 0.05 %; the case's own tolerance is 1 %.
    crossed.assert_agrees("beam", quantity="f1", within=within, body="arm")


def test_half_width_counts_against_agreement(crossed):
    """0.1 + 0.05 % exceed a limit of 0.149 %; the message contains each of these numbers."""
    with pytest.raises(AssertionError) as raised:
        crossed.assert_agrees("beam", quantity="f1", within=0.00149, body="arm")
    assert str(raised.value) == (
        "beam compared with solid, f1 of arm: 202 against 200 Hz, +1 %; "
        "explained: held end faces +0.9 %; unexplained +0.1 % ± 0.05 %; allowed 0.149 %"
    )


def test_formulations_compare_without_solid(crossed):
    """Beam and segments are 202 and 206 Hz: −1.94 %, with nothing explained."""
    # 202/206 − 1 = −1.94 %.
    crossed.assert_agrees("beam", "segments", quantity="f1", within=0.0195, body="arm")
    with pytest.raises(AssertionError, match=r"202 against 206, -1.94 %; allowed 1.94 %"):
        crossed.assert_agrees("beam", "segments", quantity="f1", within=0.0194, body="arm")


def test_comparison_without_body_is_of_whole_robot(crossed):
    """−202 against −200 Hz: the difference of −2 Hz is −1 % of the size of the reference."""
    with pytest.raises(AssertionError, match=r"f1 of the robot: -202 against -200 Hz, -1 %"):
        crossed.assert_agrees("beam", quantity="f1", within=0.009)
    crossed.assert_agrees("beam", quantity="f1", within=0.0101)


def test_skipped_comparison_does_not_agree(crossed):
    """The assertion fails with the reason of the skip."""
    with pytest.raises(AssertionError, match="not compared, because too large"):
        crossed.assert_agrees("beam", quantity="phi_x", body="arm")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"model": "vjm", "quantity": "f1", "body": "arm"}, "model vjm: .* beam, segments"),
        ({"model": "beam", "quantity": "f2", "body": "arm"}, "quantity f2: .* f1, phi_x"),
        (
            {"model": "beam", "quantity": "f1", "body": "leg"},
            r"body leg: .* arm, None \(the robot\)",
        ),
    ],
)
def test_unknown_names_are_refused(crossed, arguments, message):
    """Unknown model, quantity or body: the message lists those that were compared."""
    with pytest.raises(InputError, match=message):
        crossed.assert_agrees(**arguments)


def test_convergence_of_a_leg_is_asserted(crossed):
    """f1 by segments is 0.0089 % off at 20 elements."""
    # Huang's cantilever: segments 0.0089 % off at 20 elements, the literal layout's 5 % left out.
    crossed.assert_converged("f1", body="arm", within=0.0001)
    with pytest.raises(AssertionError, match=r"reaches 0\.0089 %"):
        crossed.assert_converged("f1", body="arm", within=0.00008)
    with pytest.raises(InputError, match="body None: not computed; must be one of arm"):
        crossed.assert_converged("f1")


def test_table_has_explained_difference_in_percent(crossed):
    """Value, reference, difference, explained, unexplained, half-width and tolerance."""
    rows = crossed.table().rows
    assert rows[0][:4] == ("arm", "beam", "f1", "Hz")
    np.testing.assert_allclose(rows[0][4:11], [202.0, 200.0, 1.0, 0.9, 0.1, 0.05, 1.0], rtol=1e-9)
    assert [row[-1] for row in rows] == ["agree", "disagree", "skipped", "agree"]
    assert rows[2][4:11] == (None,) * 7
    lines = str(crossed.table()).splitlines()
    assert len(lines) == 5
    assert lines[3].split() == [*("arm", "beam", "phi_x", "Hz"), *["–"] * 7, "skipped"]
    frame = crossed.table().to_pandas()
    assert frame["difference (%)"].round(9).tolist()[:2] == [1.0, 3.0]
    assert "<td" in crossed._repr_html_()


def test_pandas_is_optional(crossed, monkeypatch):
    """Without pandas `to_pandas` is refused with the command that installs it."""
    monkeypatch.setattr("validation.tables.find_spec", lambda _: None)
    with pytest.raises(InputError, match="needs pandas, not installed"):
        crossed.table().to_pandas()


def test_plot_has_unexplained_and_tolerance(crossed):
    """A panel for each body, error bars for half-widths, and a band for the tolerance."""
    figure = crossed.plot()
    arm, robot = figure.axes
    assert [axes.get_title(loc="left") for axes in (arm, robot)] == ["arm", "toy, whole robot"]
    total_lines = [line for line in arm.get_lines() if line.get_label() == "total difference"]
    assert [line.get_ydata()[0] for line in total_lines] == pytest.approx([1.0, 3.0])
    bars = {container.get_label(): container for container in arm.containers}
    assert list(bars["beam, unexplained"].lines[0].get_ydata()) == pytest.approx([0.1])
    (segment,) = bars["beam, unexplained"].lines[2][0].get_segments()
    assert [float(y) for _, y in segment] == pytest.approx([0.05, 0.15])
    band = arm.collections[0].get_paths()[0].vertices[:, 1]
    assert (band.min(), band.max()) == (-1.0, 1.0)


def test_single_leg_is_cross_validated(tmp_path):
    """Closed forms of a cantilever: L/EA, and L³/3EI + L/κGA by Cowper's coefficient."""
    (tmp_path / "arm.toml").write_text(ARM, "utf-8")
    crossed = api.cross_validate(str(tmp_path / "arm.toml"), preset="quick")
    length, width, height, modulus = 0.5, 0.06, 0.04, 2.1e11
    area = width * height
    shear = modulus / 2.6 * area * 10.0 * 1.3 / (12.0 + 11.0 * 0.3)
    rows = {row[:3]: row for row in crossed.table().rows}
    tension = rows["arm", "vjm", "x"]
    np.testing.assert_allclose(tension[4:6], length / (modulus * area), rtol=1e-4)
    inertia = width**3 * height / 12.0
    bending = length**3 / (3.0 * modulus * inertia) + length / shear
    np.testing.assert_allclose(rows["arm", "beam", "y"][4], bending, rtol=1e-12)
    assert crossed.sentence.startswith("VJM, links, segments and Beam FE agree with solid FE")
    for quantity in ("x", "y", "z", "phi_x", "phi_y", "phi_z", "f1", "f2", "f3", "f4"):
        crossed.assert_agrees("beam", quantity=quantity, body="arm")
    crossed.assert_converged("f1", body="arm")
    crossed.assert_converged("f1")
    # 20 beam elements are above the limit by some 1e-7 in f4 (fourth order); statics are exact.
    with pytest.raises(AssertionError, match=r"unexplained .*; allowed 1e-07 %"):
        crossed.assert_agrees("beam", quantity="f4", within=1e-9, body="arm")
