"""`flexproof converge`, `api.converge`: text, JSON, CSV, pictures and exit codes."""

import csv
import io
import json

import numpy as np
import pytest

from validation import api
from validation.cli import main

COUNTS = "5,10,20,40"


def run(capsys, *arguments):
    code = main(["converge", *arguments])
    streams = capsys.readouterr()
    return code, streams.out, streams.err


@pytest.fixture(scope="module")
def leg1():
    return api.converge("ifw", body="leg1", elements=(5, 10, 20, 40))


def test_table_has_errors_and_element_counts(capsys):
    """f1 of leg 1: 0.0089 % off with 20 segments; 1, 0.1 and 0.01 % need 2, 6 and 19."""
    code, out, _ = run(capsys, "ifw", "--body", "leg1", "--model", "segments")
    assert code == 0
    line = next(line for line in out.splitlines() if line.startswith("  f1: "))
    assert "order 2.00" in line
    assert "20 elements: +0.0089 %; 1 % needs 2, 0.1 % needs 6, 0.01 % needs 19" in line
    row = next(line.split() for line in out.splitlines() if line.split()[:1] == ["20"])
    assert row[1:] == ["114.52824", "+0.00886", "0.011", "2.00"]


def test_json_has_values_errors_and_limits(capsys):
    """f2 of leg 1 by segments is 182.056 to 181.810 Hz for 5 to 40 elements (known values)."""
    code, out, _ = run(capsys, "ifw", "--body", "leg1", "--elements", COUNTS, "--json")
    document = json.loads(out)
    assert (code, document["kind"], document["body"]) == (0, "convergence", "leg1")
    for series in document["series"]:
        values, limit = np.array(series["values"]["f2"]), series["limits"]["f2"]
        np.testing.assert_allclose(series["errors"]["f2"], values / limit - 1.0, atol=1e-15)
        assert len(values) == len(series["elements"])
    half = document["series"][0]
    assert half["elements"] == [5, 10, 20, 40]
    np.testing.assert_allclose(
        half["values"]["f2"], [182.056, 181.869, 181.822, 181.810], atol=6e-4
    )
    assert half["orders"]["f2"] == pytest.approx(2.0, abs=0.05)
    assert document["units"]["f2"] == "Hz"
    assert document["units"]["x"] == "m/N"


def test_csv_has_all_values(capsys, tmp_path, leg1):
    """Values and relative errors with units, for each model, layout and number of elements."""
    path = tmp_path / "convergence.csv"
    code, _, _ = run(capsys, "ifw", "--body", "leg1", "--elements", COUNTS, "--csv", str(path))
    rows = list(csv.DictReader(io.StringIO(path.read_text())))
    assert code == 0
    assert len(rows) == sum(len(series.counts) for series in leg1.series)
    for row in rows:
        series = leg1.of(row["model"], row["layout"], row["theory"])
        values = series.values[series.counts.index(int(row["elements"]))]
        assert row["body"] == "leg1"
        for k, (quantity, unit) in enumerate(zip(leg1.quantities, leg1.units, strict=True)):
            assert float(row[f"{quantity} ({unit})"]) == pytest.approx(values[k], rel=1e-12)
            # With its sign: the literal layout is too stiff by 1/n.
            error = float(row[f"{quantity} relative error"])
            assert error == pytest.approx(values[k] / series.limits[k] - 1.0, abs=1e-15)
    literal = leg1.of("segments", "literal")
    row = next(r for r in rows if r["layout"] == "literal" and r["elements"] == "20")
    assert float(row["f2 (Hz)"]) == pytest.approx(191.01, abs=6e-3)
    assert float(row["f2 relative error"]) == pytest.approx(
        literal.errors[literal.counts.index(20), 1], rel=1e-12
    )


@pytest.mark.parametrize(
    ("ending", "head"), [(".png", b"\x89PNG"), (".svg", b"<svg")], ids=["png", "svg"]
)
def test_picture_format_follows_suffix(capsys, tmp_path, ending, head):
    """--picture NAME.png or NAME.svg."""
    path = tmp_path / f"convergence{ending}"
    code, _, _ = run(capsys, "ifw", "--body", "leg1", "--elements", COUNTS, "--picture", str(path))
    assert code == 0
    assert path.read_bytes().startswith(head)


def number_in(text):
    """The number that a text such as "5.2 × 10⁻⁶ %" begins with."""
    plain = text.replace("\N{NO-BREAK SPACE}", "").removesuffix("%").replace("×10", "e")
    return float(plain.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")))


def test_figure_shows_errors_in_percent(leg1):
    """Logarithmic axes, with the limit, the number of elements that is judged, and orders."""
    figure = leg1.plot(["f1", "f2"])
    assert len(figure.axes) == 2
    for axes, column in zip(figure.axes, (0, 1), strict=True):
        lines = {line.get_label(): line for line in axes.get_lines()}
        for series in leg1.series:
            line = next(
                v for k, v in lines.items() if k.startswith(f"{series.discretisation.label} (")
            )
            np.testing.assert_allclose(line.get_xdata(), series.counts)
            np.testing.assert_allclose(line.get_ydata(), 100.0 * np.abs(series.errors[:, column]))
        assert axes.get_xscale() == axes.get_yscale() == "log"
        np.testing.assert_allclose(lines["1 %"].get_ydata(), 1.0)
        np.testing.assert_allclose(lines["20 elements"].get_xdata(), 20.0)
        # At each curve its order and its error with 20 elements.
        remarks = [text.get_text() for text in axes.texts]
        orders, stated = remarks[: len(leg1.series)], remarks[len(leg1.series) :]
        assert sorted(orders) == sorted(series.behaviour(column) for series in leg1.series)
        errors = sorted(100.0 * abs(series.errors[2, column]) for series in leg1.series)
        np.testing.assert_allclose(sorted(map(number_in, stated)), errors, rtol=0.1)


def test_order_label_is_at_finest_error(leg1):
    """Static errors are round-off, below 1e-7 %: they are not drawn."""
    quantities = ["f1", "f3", "x"]
    for quantity, panel in zip(quantities, leg1.chart(quantities).panels, strict=True):
        column, ends = leg1.column(quantity), []
        for series in leg1.series:
            sizes = 100.0 * np.abs(series.errors[:, column])
            if (sizes >= 1e-7).any():
                last = int(np.flatnonzero(sizes >= 1e-7)[-1])
                ends.append((sizes[last], series.counts[last], series.behaviour(column)))
        # Errors with 20 elements stand at the curves, too.
        remarks = [note for note in panel.notes if not note.text.endswith("%")]
        notes = sorted((note.y, note.x, note.text) for note in remarks)
        assert notes == sorted(ends)


def test_curve_ending_at_stated_count_has_one_label():
    """Its order follows the error with 20 elements: two labels at one point would overlap."""
    leg1 = api.converge("ifw", body="leg1", elements=(5, 10, 20))
    (panel,) = leg1.chart(["f1"]).panels
    (series,) = (series for series in leg1.series if series.discretisation.model == "beam")
    texts = [note.text for note in panel.notes if note.text.endswith(series.behaviour(0))]
    assert len(texts) == 1
    error, _, order = texts[0].partition(", ")
    assert order == series.behaviour(0)
    assert number_in(error) == pytest.approx(100.0 * abs(series.errors[-1, 0]), rel=0.1)
    points = [(note.x, note.y) for note in panel.notes]
    assert len(points) == len(set(points))


@pytest.mark.parametrize(
    ("within", "code"),
    # f2 of the segments is 0.0087 % off at 20 elements, that of the beams 5e-6 %.
    [("0.0001", 0), ("0.00008", 1)],
)
def test_exceeded_limit_exits_with_1(capsys, within, code):
    """f2 of segments is 0.009 % off at 20 elements: within 0.01 %, beyond 0.008 %."""
    arguments = ("ifw", "--body", "leg1", "--elements", "20,40", "--quantity", "f2")
    exit_code, _, err = run(capsys, *arguments, "--within", within)
    assert exit_code == code
    assert ("segments, half-length" in err) == (code == 1)
    assert "beam" not in err


def test_assert_converged_fails_above_limit(leg1):
    """The literal layout is 5.1 % off at 20 elements; the message has layout, error and limit."""
    leg1.assert_converged("f1", elements=20, within=0.01)
    leg1.assert_converged("f2", elements=20, within=6e-8, model="beam")
    with pytest.raises(
        AssertionError, match=r"springs between elements only.*5\.1\s%.*, allowed 1\s%"
    ):
        leg1.assert_converged("f1", within=0.01, layout="literal")


def test_euler_bernoulli_has_own_reference(capsys):
    """L⁻² √(EI/μ) 1.875104²/2π = 186.8 Hz; the literal layout is 5.2 % high with 20 elements."""
    arguments = ("ifw", "--body", "leg1", "--elements", COUNTS, "--json")
    code, out, _ = run(capsys, *arguments, "--theory", "euler-bernoulli")
    document = json.loads(out)
    literal = document["series"][1]
    assert (code, literal["layout"], literal["theory"]) == (0, "literal", "euler-bernoulli")
    assert literal["limits"]["f2"] == pytest.approx(186.8, abs=0.05)
    assert literal["errors"]["f2"][2] == pytest.approx(0.052, abs=5e-4)


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        (
            ("ifw", "--body", "leg1", "--model", "solid", "--theory", "timoshenko"),
            "theory: not for model solid",
        ),
        (("ifw", "--body", "leg3"), "body leg3: not a leg of the robot; must be one of leg1, leg2"),
        (("ifw", "--quantity", "f9"), "--quantity f9: must be one of f1, f2"),
        (("ifw", "--elements", "5,x"), "must be whole numbers from 1 to 9999"),
        (("ifw", "--elements", "900"), "must be at most 200"),
        (("ifw", "--elements", "1", "--model", "beam", "--within", "0.01"), "must be one of 1"),
        (("ifw", "--model", "solid"), "needs a body"),
        (("ifw", "--within", "2"), "must be above 0 and below 1"),
        (("ifw", "--body", "leg1", "--model", "beam", "--divisions", "2,3"), "beam has elements"),
        (("ifw", "--picture", "a.gif"), "must end in .png or .svg"),
    ],
)
def test_invalid_input_gives_one_error_line(capsys, tmp_path, monkeypatch, arguments, fault):
    """Options that exclude each other, unknown bodies and quantities: exit code 2, no files."""
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, *arguments)
    assert code == 2
    assert out == ""
    assert fault in err
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []
