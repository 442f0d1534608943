"""Convergence of solid legs with the mesh: studies, verdicts on them, and the figure."""

import csv
import io
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.fakes.toy_responses import NO_ROBOT

from lumped.beam_properties import tip_compliance
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from validation.comparisons import mesh_cases
from validation.comparisons.discretisations import Discretisation
from validation.comparisons.mesh_cases import half_width_shares, tetrahedral_modes
from validation.comparisons.mesh_convergence import leg_mesh_convergence
from validation.context import Context, memo_key
from validation.drawing.text import number
from validation.references.robot_on_path import distinct_legs
from validation.report.figures.studies import families, mesh_curves, study_figure
from validation.run.outcome import judge
from validation.solids.leg_meshes import formal_order
from validation.solids.solid_legs import Refinement, solid_compliances

LEG = ConstantLeg(0.25, Rectangle(0.05, 0.05), Material(E=2.1e11, G=8.0e10, nu=0.0, rho=7850.0))
FREE = Discretisation("solid", ends="free")


@pytest.fixture(scope="module")
def study():
    return leg_mesh_convergence(NO_ROBOT, "leg", LEG, divisions=(1, 2, 3, 4))


def test_solid_limit_is_timoshenko_beam(study):
    """With ν = 0 and ends free to warp, beam theory is exact in bending and tension."""
    series = next(
        candidate for candidate in study.series if candidate.discretisation.ends == "free"
    )
    expected = np.diag(tip_compliance(LEG.timoshenko, LEG.length))[:3]
    errors = np.abs(series.limits[4:] / expected - 1.0)
    # Shear of a rectangle with ν = 0: κ = 5/6 is exact.
    assert (errors <= series.limit_half_widths[4:]).all()
    assert (series.limit_half_widths[4:] < 1e-3).all()


def test_needed_divisions_are_smallest(study):
    """The needed divisions are the smallest ones within the target.

    0 if the finest mesh misses it.
    """
    all_needed = set()
    for series in study.series:
        sizes = np.abs(series.values / series.limits - 1.0)
        for target, row in zip((0.01, 0.001, 0.0001), series.needed, strict=True):
            for needed, errors in zip(row, sizes.T, strict=True):
                due = [
                    count
                    for index, count in enumerate(series.counts)
                    if (errors[index:] <= target).all()
                ]
                assert needed == (due[0] if due else 0)
                all_needed.add(needed)
    assert len(all_needed) >= 3


def test_half_width_contains_doubled_mesh():
    """Values for 4 divisions lie within the half-widths of 2."""
    coarse = leg_mesh_convergence(NO_ROBOT, "leg", LEG, [FREE], (1, 2)).series[0]
    fine = leg_mesh_convergence(NO_ROBOT, "leg", LEG, [FREE], (2, 4)).series[0]
    assert (np.abs(fine.values[-1] / coarse.values[-1] - 1.0) <= coarse.half_widths[-1]).all()


def test_orders_are_near_formal_ones(study):
    """Quadratic elements without restrained contraction (ν = 0): energies have order four."""
    for series in study.series:
        assert series.formal_order == pytest.approx(4.0)
        # Four meshes of up to four divisions reach half an order.
        assert series.orders[0] == pytest.approx(4.0, abs=0.6)


def random_leg(seed):
    """Random leg, side ratio 1 or 2: its cells are refined alike in both directions."""
    draw = np.random.default_rng(seed)
    width, nu = draw.uniform(0.03, 0.06), draw.uniform(0.0, 0.35)
    sides = Rectangle(width, float(draw.integers(1, 3)) * width)
    material = Material(E=2.1e11, G=2.1e11 / (2.0 * (1.0 + nu)), nu=nu, rho=7850.0)
    return ConstantLeg(draw.uniform(4.0, 6.0) * sides.height, sides, material)


@pytest.mark.parametrize("seed", range(4))
def test_random_free_legs_have_fourth_order(seed):
    """Errors of eigenvalues and energies fall as h⁴ (Strang and Fix 1973, chapters 1 and 6)."""
    orders = leg_mesh_convergence(NO_ROBOT, "leg", random_leg(seed), [FREE]).series[0].orders
    # f1 and f2 bend; y and z are deflections in bending. Four meshes of up to four divisions.
    assert orders[[0, 1, 5, 6]] == pytest.approx(4.0, abs=0.15)


def test_single_mesh_is_refused():
    """Convergence needs two different meshes."""
    with pytest.raises(InputError, match="two or more different"):
        leg_mesh_convergence(NO_ROBOT, "leg", LEG, divisions=(3, 3))


BIGLIDE = load_robot("ifw")
STEEL = Material(E=2.1e11, G=2.1e11 / 2.6, nu=0.3, rho=7850.0)


CASES = mesh_cases.cases(legs=distinct_legs(BIGLIDE.mechanism)[:1])


@cache
def outcomes():
    """All mesh cases of leg 1 of the built-in robot, preset quick."""
    context = Context(BIGLIDE, "quick")
    return tuple(judge(case, case.compute(context), 0.0) for case in CASES)


def outcome(identifier):
    return next(candidate for candidate in outcomes() if candidate.case.id == identifier)


def test_mesh_cases_of_leg_agree():
    """Orders, half-widths and f1 of hexahedra and tetrahedra, with free and rigid ends."""
    assert {result.case.id for result in outcomes()} == {
        "refinement.leg1.solid.order[c22]",
        "refinement.leg1.solid.order[c44]",
        "refinement.leg1.solid-held.order[c22]",
        *(f"leg1.converged[solid-{ends}-half-width]" for ends in ("free", "held")),
        *(f"leg1.converged[solid-{ends}-f1]" for ends in ("free", "held")),
        *(f"leg1.converged[tetrahedra-{ends}-f1]" for ends in ("free", "held")),
    }
    assert {result.case.kind for result in outcomes()} == {"convergence"}
    assert {result.verdict for result in outcomes()} == {"agree"}


def test_mesh_limits_equal_cantilever():
    """f1 = 114.518 Hz (Huang 1961) with free ends; 3-D waves differ from it by 1e-5."""
    study = outcome("leg1.converged[solid-free-f1]").measurement.studies[0]
    name = "hexahedra, free ends"
    assert abs(study.limits[name] - 114.518) <= study.uncertainties[name]
    assert study.uncertainties[name] < 5e-4 * 114.518
    assert study.x == (585.0, 3375.0)


def test_tetrahedra_match_hexahedra():
    """Unstructured quadratic tetrahedra are too stiff: by up to 0.1 % with two elements across.

    Their half-width follows from the cube root of their unknowns, a ratio of 1.42. With the ratio 2
    of the divisions it was half as wide as the error.
    """
    leg = equivalent_leg(legs_of(BIGLIDE.mechanism)["leg1"])
    for modes in tetrahedral_modes(leg).values():
        errors = modes.frequencies.values[:, 0] / 114.518 - 1.0
        assert (errors > 0.0).all()
        assert errors[1] < 1e-3
        assert modes.unknowns[1] > 2 * modes.unknowns[0]
        error = abs(modes.frequencies.values[1, 0] - 114.518)
        assert 0.1 * error < modes.frequencies.uncertainty(0) - error < 10.0 * error


def slender_leg(seed):
    draw = np.random.default_rng(seed)
    width = draw.uniform(0.03, 0.1)
    section = Rectangle(width, draw.uniform(1.0, 1.9) * width)
    nu = draw.uniform(0.2, 0.35)
    material = replace(STEEL, nu=nu, G=STEEL.E / (2.0 * (1.0 + nu)))
    return ConstantLeg(draw.uniform(6.0, 12.0) * width, section, material)


@pytest.mark.parametrize("seed", range(10))
def test_random_solids_have_formal_order(seed):
    """Errors in bending have order h⁴ with free ends, and that of singular edges with rigid ends.

    Each half-width from two or more meshes contains the value on the next finer mesh. For divisions
    1, 2 and 4 that is a mesh twice as fine.
    """
    leg = slender_leg(seed)
    compliances = solid_compliances(leg, (1, 2, 3, 4))
    for entry in (1, 2):
        assert compliances["free"].at(entry, entry).observed_order == pytest.approx(4.0, abs=0.3)
        with_rigid_ends = compliances["rigid"].at(entry, entry)
        assert with_rigid_ends.orders[-1] == pytest.approx(formal_order(leg, "rigid"), abs=0.5)
    doubled = solid_compliances(leg, (1, 2, 4))
    for refinements in (compliances, doubled):
        for refinement in refinements.values():
            assert (half_width_shares(refinement) <= 1.0).all()


def test_narrow_half_width_disagrees():
    """Errors decrease with order 1, but the half-width assumes order 4 and is too narrow.

    The half-width is 3/(2⁴ − 1) of a step between two meshes. The next step is half as large as the
    last one, 2.5 times the half-width.
    """
    divisions = (1, 2, 4)
    values = np.multiply.outer(1.0 + 1.0 / np.array(divisions), np.eye(6))
    assert half_width_shares(Refinement(divisions, values, 4.0)).max() == pytest.approx(2.5)
    assert half_width_shares(Refinement(divisions, values, 1.0)).max() <= 1.0


def test_caption_names_command_for_orders():
    """The quick preset has two meshes for f1, from which no order follows."""
    (family,) = families(outcomes())
    command = (
        "f1: this preset has fewer than 4 meshes, too few to observe an order. To observe the "
    )
    caption = mesh_curves(family.studies).caption
    assert command + "orders of f1 to f4: flexproof converge " in caption
    doubled = [study for study in family.studies if len(study.x) >= 4]
    assert doubled
    assert "flexproof converge" not in mesh_curves(doubled).caption


def test_mesh_figure_has_errors_and_orders():
    """Panels, curves and CSV data of the figure equal the studies of the cases."""
    (family,) = families(outcomes())
    figure = mesh_curves(family.studies)
    panels = {panel.title: panel for panel in figure.panels}
    assert set(panels) == {"deflection along y", "torsion", "f1", "CPU time"}
    rows = list(csv.DictReader(io.StringIO(study_figure(family).data)))
    for study in family.studies:
        (name,) = study.series
        study_rows = [row for row in rows if (row["quantity"], row["mesh"]) == (study.panel, name)]
        assert [float(row["unknowns"]) for row in study_rows] == list(study.x)
        np.testing.assert_array_equal(
            [float(row["value"]) for row in study_rows], study.series[name]
        )
        if study.limits:
            limit = f"{study.panel}, {name}: {number(study.limits[name], 6)} ± "
            assert f"{limit}{number(study.uncertainties[name], 2)} {study.unit}, " in figure.caption
        curve = next(
            candidate for candidate in panels[study.panel].series if candidate.look == name
        )
        np.testing.assert_array_equal(curve.x, study.x)
        if study.panel == "CPU time":
            assert {row["error (%)"] for row in study_rows} == {""}
            np.testing.assert_array_equal(curve.y, study.series[name])
            continue
        errors = [100.0 * (value / study.limits[name] - 1.0) for value in study.series[name]]
        np.testing.assert_allclose(
            [float(row["error (%)"]) for row in study_rows], errors, atol=1e-12
        )
        np.testing.assert_allclose(curve.y, np.abs(errors), atol=1e-12)
        assert f"(formal order {study.formal_order:.3g})" in curve.label
        notes = [note.text for note in panels[study.panel].notes]
        if len(study.x) >= 4:
            # Slope of log error over log unknowns is a third of the order in the mesh size.
            logs = np.log(np.abs(errors[-3:])), np.log(np.array(study.x[-3:]))
            slope = -3.0 * np.polyfit(logs[1], logs[0], 1)[0]
            assert study.orders[name] == pytest.approx(slope, abs=0.35)
            assert f"order {study.orders[name]:.2f}" in notes
        else:
            assert notes == []
            assert name not in study.orders


def test_cpu_times_do_not_affect_verdicts():
    """Measurements with other CPU times have equal values and verdicts."""
    first = outcome("leg1.converged[tetrahedra-free-f1]")
    leg = equivalent_leg(legs_of(BIGLIDE.mechanism)["leg1"])
    context = Context(BIGLIDE, "quick")
    context._memo[memo_key(tetrahedral_modes, (leg,), {})] = {
        ends: replace(modes, seconds=tuple(1e3 + second for second in modes.seconds))
        for ends, modes in tetrahedral_modes(leg).items()
    }
    (case,) = (case for case in CASES if case.id == first.id)
    second = judge(case, case.compute(context), 0.0)
    assert second.verdict == first.verdict
    assert second.measurement.value == pytest.approx(first.measurement.value, rel=1e-9)
    assert second.measurement.studies[1].series != first.measurement.studies[1].series
