"""Verdicts on convergence with element count: correct series agree, and wrong ones do not."""

import csv
import io
import json
import re
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
from support.robots.crane import write_overlapping_crane
from support.robots.robot_from_text import robot_of
from support.robots.single_arm import ONE_ARM

from lumped.acceptance.requirement import DEFAULT_LIMITS
from lumped.errors import ComputationError, InputError
from lumped.robot_file import load_robot
from validation.case import Skip
from validation.cli import main
from validation.comparisons import convergence_cases, element_convergence
from validation.comparisons.convergence_cases import cases, study_of, subjects
from validation.comparisons.convergence_cases import element_convergence as figure_of
from validation.comparisons.convergence_series import fitted_orders
from validation.comparisons.discretisations import EULER_BERNOULLI, FORMULATIONS
from validation.context import Context, memo_key
from validation.record_fields import plain_data
from validation.run.outcome import judge

PATH = """
[path]
from = [0.0]
to = [0.0]
count = 1
"""
BIGLIDE = load_robot("ifw")


@cache
def leg1_study():
    return study_of(Context(BIGLIDE), "leg1")


def verdict_with(study, identifier):
    """Verdict of the case `identifier` on leg 1, judged by `study` instead of its own study."""
    context = Context(BIGLIDE)
    key = memo_key(convergence_cases._study, (BIGLIDE, "leg1"), {})
    context._memo[key] = study
    case = next(
        case for case in cases(bodies=("leg1",), limits=DEFAULT_LIMITS) if case.id == identifier
    )
    return judge(case, case.compute(context), 0.0).verdict


def with_series(study, model, change):
    """Copy of a study, with `change` applied to the series of a model."""
    series = tuple(
        change(member) if member is study.of(model) else member for member in study.series
    )
    return replace(study, series=series)


def test_distinct_legs_and_robot_are_studied():
    """The nine legs of the Delta are of two kinds, and the robot itself is studied as well."""
    assert subjects(BIGLIDE.mechanism) == ("leg1", "leg2", "")
    assert len(subjects(load_robot("delta").mechanism)) == 3


@pytest.mark.parametrize("subject", ["order", "20", "half-width"])
@pytest.mark.parametrize("model", ["segments", "beam"])
def test_leg_of_paper_converges(model, subject):
    """Order, error at 20 elements and half-widths of segments and beams agree for leg 1."""
    assert verdict_with(leg1_study(), f"leg1.converged[{model}-{subject}]") == "agree"


@pytest.mark.parametrize("subject", ["order", "20"])
def test_literal_layout_disagrees(subject):
    """Order 1.0 instead of 2.0, and an error of 5.1 % at 20 elements."""
    study = leg1_study()
    literal = study.of("segments", "literal")
    wrong = replace(literal, discretisation=FORMULATIONS[0], formal_order=2.0)
    mixed = replace(study, series=(wrong, *study.series[1:]))
    assert verdict_with(mixed, f"leg1.converged[segments-{subject}]") == "disagree"


def test_one_quantity_beyond_limit_disagrees():
    """The last frequency, f4, is 1.1 % off at 40 elements, and all others are within 1 %."""

    def change(series):
        values = series.values.copy()
        values[series.counts.index(40), 3] = 1.011 * series.limits[3]
        return replace(series, values=values)

    study = with_series(leg1_study(), "beam", change)
    assert verdict_with(study, "leg1.converged[beam-20]") == "disagree"


def test_uncertain_limit_is_undecided():
    """Limit 1 %, error 0.95 %, converged value uncertain by 0.1 %: the error may be 1.05 %."""

    def change(series, half_width):
        values = np.tile(series.limits, (len(series.counts), 1))
        values[:, 1] *= 1.0095
        half_widths = np.zeros_like(series.limits)
        half_widths[1] = half_width
        return replace(series, values=values, limit_half_widths=half_widths)

    for half_width, verdict in ((0.0, "agree"), (1e-3, "undecided")):
        study = with_series(leg1_study(), "beam", partial(change, half_width=half_width))
        assert verdict_with(study, "leg1.converged[beam-20]") == verdict


@pytest.mark.parametrize("column", range(4))
def test_unsettled_order_is_undecided(column):
    """The finest error of one frequency is 20 % larger: its last observed order is 0.26 lower."""

    def change(series):
        values = series.values.copy()
        values[-1, column] += 0.2 * (values[-1, column] - series.limits[column])
        return replace(series, values=values)

    study = with_series(leg1_study(), "segments", change)
    assert verdict_with(study, "leg1.converged[segments-order]") == "undecided"


def test_wrong_theory_limit_disagrees():
    """186.8 Hz (Euler–Bernoulli) instead of 181.8 Hz: errors do not converge to zero."""

    def change(series):
        limits = series.limits * 1.027
        errors = series.values / limits - 1.0
        orders = fitted_orders(series.counts, errors, series.limit_half_widths)
        return replace(series, limits=limits, orders=orders)

    study = with_series(leg1_study(), "segments", change)
    assert verdict_with(study, "leg1.converged[segments-20]") == "disagree"


def test_narrow_half_widths_disagree():
    """Values that seem to converge to another limit, 0.1 % from the exact one."""

    def change(series):
        return replace(series, values=1.001 * series.values)

    study = with_series(leg1_study(), "beam", change)
    assert verdict_with(study, "leg1.converged[beam-half-width]") == "disagree"


def outcomes_of(robot_file, body):
    """Yield the measurement or the exception of each case on a body of a robot."""
    context = Context(robot_file)
    for case in cases(bodies=(body,), limits=DEFAULT_LIMITS):
        try:
            yield case.compute(context)
        except Exception as error:  # noqa: BLE001  the class is what is tested
            yield error


def test_program_error_in_study_is_failure(monkeypatch):
    """Cases that share the study all have its error, and none a verdict."""

    def broken(*_):
        raise ComputationError("leg1: its matrices are lost in rounding")

    monkeypatch.setattr(element_convergence, "leg_matrices", broken)
    assert {type(outcome) for outcome in outcomes_of(BIGLIDE, "leg1")} == {ComputationError}

    def refused(*_):
        raise InputError("elements = 20: not a number of elements")

    monkeypatch.setattr(element_convergence, "leg_matrices", refused)
    assert {type(outcome) for outcome in outcomes_of(BIGLIDE, "leg1")} == {InputError}


@pytest.mark.parametrize("body", ["arm", ""])
def test_leg_without_beam_theory_is_skipped(tmp_path, body):
    """Cowper's κ is negative for a wide I-section of a material with ν = −0.9."""
    wide = ONE_ARM.replace(
        'shape = "rectangle", width = 0.06, height = 0.04',
        'shape = "i-section", width = 0.069, height = 0.01, flange = 0.001, web = 0.001',
    ).replace("nu = 0.0", "nu = -0.9")
    robot = robot_of(wide + PATH, tmp_path)
    skips = list(outcomes_of(robot, body))
    assert {type(skip) for skip in skips} == {Skip}
    assert all("shear stiffness" in str(skip) for skip in skips)


@pytest.mark.usefixtures("coarse_parts")
def test_part_without_prisms_is_skipped(tmp_path):
    """The part cannot be divided into prismatic pieces, because its interfaces overlap."""
    write_overlapping_crane(tmp_path)
    robot = load_robot(tmp_path / "robot.toml")
    skips = list(outcomes_of(robot, "arm"))
    assert {type(skip) for skip in skips} == {Skip}
    assert all("interfaces of the part overlap" in str(skip) for skip in skips)


def test_figure_shows_every_leg_and_robot():
    """Errors and element counts in the caption, and all curves as studies."""
    context = Context(BIGLIDE)
    figure = figure_of(context)
    rows = list(csv.DictReader(io.StringIO(figure.data)))
    assert "leg1" in figure.caption
    # Segments without shear against their own cantilever, f1: 5.2 % for 5.1 %.
    assert (
        "springs between elements only, Euler–Bernoulli +5.2\N{NO-BREAK SPACE}% (" in figure.caption
    )
    assert "+0.0089\N{NO-BREAK SPACE}% (2, 6, 19)" in figure.caption
    # The robot's literal layout: the paper's statement holds at 20 elements and not before.
    assert "+0.97\N{NO-BREAK SPACE}% (20, over 80, over 80)" in figure.caption
    identifiers = {study.id for study in figure.studies}
    assert identifiers == {
        f"convergence.{body}.{quantity}"
        for body in ("leg1", "leg2", "robot")
        for quantity in ("f1", "f2", "f3", "f4", "x", "y", "z")
    }
    for body in ("leg1", ""):
        body_study = study_of(context, body)
        for study, (k, quantity) in zip(
            plain_data(body_study.studies()), enumerate(body_study.quantities), strict=True
        ):
            assert study["id"] == f"convergence.{body or 'robot'}.{quantity}"
            for series in body_study.series:
                # Of the finest value, in the unit of the study.
                width, value = series.half_widths[-1, k], series.values[-1, k]
                label = series.discretisation.label
                assert study["uncertainty"][label] == pytest.approx(width * value, rel=1e-12)
                assert study["limit"][label] == series.limits[k]
                assert (label in study["order"]) is bool(np.isfinite(series.orders[k]))
    study = next(
        candidate
        for candidate in plain_data(figure.studies)
        if candidate["id"] == "convergence.leg1.f2"
    )
    values = study["series"]["segments, half-length end springs"]
    index = study["x"].index(20)
    assert values[index] == pytest.approx(181.822, abs=6e-4)
    assert study["series"]["segments, springs between elements only"][0] is None
    # The paper's layout without shear is 5.2 % above its own limit in the second plane.
    without_shear = "segments, springs between elements only, Euler–Bernoulli"
    ratio = study["series"][without_shear][index] / study["limit"][without_shear]
    assert ratio == pytest.approx(1.052, abs=5e-4)
    assert study["theory"][without_shear] == "euler-bernoulli"
    # The data of the figure are errors in percent over the element count.
    column = next(name for name in rows[0] if "leg1: f1" in name and "half-length" in name)
    by_count = {float(row["elements per leg"]): row[column] for row in rows}
    assert float(by_count[20.0]) == pytest.approx(0.00886, rel=1e-3)


PERCENT = r"([-+−]?[\d.]+(?: × 10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?) %"
SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")


def plain_order(counts, errors):
    """Slope of log |e| over log 1/n, fitted to the three finest errors above 1e-8 with n ≥ 5."""
    resolved = [
        (n, abs(e)) for n, e in zip(counts, errors, strict=True) if n >= 5 and abs(e) > 1e-8
    ]
    x, y = np.log([n for n, _ in resolved[-3:]]), np.log([e for _, e in resolved[-3:]])
    return -float(np.sum((x - x.mean()) * (y - y.mean())) / np.sum((x - x.mean()) ** 2))


def test_leg_figure_matches_its_study():
    """Curves of f1 in JSON, CSV, page and caption have the same numbers, orders and counts."""
    figure = figure_of(Context(BIGLIDE))
    rows = list(csv.DictReader(io.StringIO(figure.data)))
    study = next(
        candidate
        for candidate in plain_data(figure.studies)
        if candidate["id"] == "convergence.leg1.f1"
    )
    caption = figure.caption.replace("\N{NO-BREAK SPACE}", " ").partition("leg1: ")[2]
    assert set(study["series"]) == {
        formulation.label for formulation in (*FORMULATIONS, *EULER_BERNOULLI)
    }
    for label, values in study["series"].items():
        solved = [(n, v) for n, v in zip(study["x"], values, strict=True) if v is not None]
        errors = {n: value / study["limit"][label] - 1.0 for n, value in solved}
        column = f"leg1: f1: {label}, error (%)"
        errors_in_csv = {
            int(float(row["elements per leg"])): row[column] for row in rows if row[column]
        }
        assert set(errors_in_csv) == set(errors)
        for count, error in errors.items():
            assert float(errors_in_csv[count]) == pytest.approx(100.0 * error, rel=1e-9, abs=1e-12)
        order = plain_order(list(errors), list(errors.values()))
        assert study["order"][label] == pytest.approx(order, rel=1e-9)
        needed = study["needed"][label]
        for target, count in needed.items():
            finer = [abs(error) for n, error in errors.items() if count and n >= count]
            assert max(finer, default=0.0) <= float(target)
            coarser = [n for n, error in errors.items() if abs(error) > float(target)]
            assert max(coarser, default=0) < (count or np.inf)
        if theory_of(label) == "timoshenko":
            caption_entry = re.search(rf"{re.escape(label)} {PERCENT} \(([^)]*)\)", caption)
            percent = caption_entry[1].replace(" ", "").replace("×10", "e").translate(SUPERSCRIPTS)
            assert 0.01 * float(percent) == pytest.approx(errors[20], rel=0.06)
            assert caption_entry[2].split(", ") == [str(n or "over 80") for n in needed.values()]


def theory_of(label):
    return (
        "euler-bernoulli"
        if label in {formulation.label for formulation in EULER_BERNOULLI}
        else "timoshenko"
    )


def test_run_has_convergence_verdicts(tmp_path, capsys):
    """A run of the five-bar with --only: order, error at 20 elements and half-width, all agree."""
    code = main(
        [
            "run",
            "five-bar",
            "--preset",
            "quick",
            "--only",
            "robot.converged*",
            "--out",
            str(tmp_path / "run"),
        ]
    )
    capsys.readouterr()
    document = json.loads((tmp_path / "run" / "results.json").read_text())
    assert code == 0
    assert {case["id"] for case in document["cases"]} == {
        f"robot.converged[{model}-{subject}]"
        for model in ("segments", "beam")
        for subject in ("order", "20", "half-width")
    }
    for case in document["cases"]:
        assert case["kind"] == "convergence"
        assert case["verdict"] == "agree"
    order = next(c for c in document["cases"] if c["id"] == "robot.converged[segments-order]")
    assert order["value"] == pytest.approx(2.0, abs=0.05)
    assert np.isfinite(order["numerical_uncertainty"])
