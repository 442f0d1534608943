"""Legs of fibre layers in a run: solids of orthotropic layers judge beams by laminate theory."""

from math import pi

import pytest
from support.robots.paper_robot_variants import file_of, variant_of_ifw

from fem.sections.layered_ring import ring_stiffnesses, thin_wall_stiffnesses
from lumped.acceptance.requirement import DEFAULT_LIMITS
from lumped.legs import ConstantLeg, Material
from lumped.sections import LaminateBox, LaminateTube, Layer
from validation.comparisons import leg_beam_vs_solid
from validation.comparisons.agreement_cases import FORMULA, HELD_FACES, MOTIONS
from validation.comparisons.section_formulas import laminate_errors
from validation.context import Context
from validation.models.leg_models import leg_compliance
from validation.run.outcome import judge
from validation.solids.solid_legs import computed_properties

# T300/5208 carbon and epoxy (S. W. Tsai, H. T. Hahn, Introduction to Composite Materials, 1980,
# table 1.7), and a fibre of high modulus: Pa.
CARBON = {"E1": 181e9, "E2": 10.3e9, "G12": 7.17e9, "nu12": 0.28, "rho": 1600.0}
STIFF = {"E1": 340e9, "E2": 6.4e9, "G12": 3.9e9, "nu12": 0.3, "rho": 1600.0}


def layers(*angles, thickness, ply=CARBON):
    return tuple(Layer(**ply, thickness=thickness, angle=angle) for angle in angles)


def leg_of(section, length=0.3):
    return ConstantLeg(length, section, Material(*section.mean_material))


@pytest.fixture
def agreement(monkeypatch):
    """Function of a leg that compares its beam with its solid in all motions.

    It returns (verdict, measurement) by motion. `factor` multiplies the compliances of the beam.
    Both meshes of the solid have the coarsest section mesh.
    """
    monkeypatch.setattr(leg_beam_vs_solid, "most_unknowns", lambda *_: 400)
    monkeypatch.setattr(leg_beam_vs_solid, "STATICS", {"quick": 400})

    def verdicts(leg, factor=1.0):
        def compliances(*arguments):
            return factor * leg_compliance(*arguments)

        monkeypatch.setattr(leg_beam_vs_solid, "leg_compliance", compliances)
        context = Context(file_of(variant_of_ifw(leg1=leg)), "quick")
        cases = {
            case.id: case for case in leg_beam_vs_solid.cases(legs=("leg1",), limits=DEFAULT_LIMITS)
        }
        outcomes = {}
        for motion in MOTIONS:
            case = cases[f"leg1.agrees[beam-solid-{motion}]"]
            measurement = case.measure(context)
            outcomes[motion] = judge(case, measurement, 0.0).verdict, measurement
        return outcomes

    return verdicts


def test_laminate_leg_agrees_with_orthotropic_solid(agreement):
    """Held faces stiffen tension by 2.5 %, laminate theory is 0.5 % too stiff in torsion."""
    weave = leg_of(LaminateTube(layers(45, -45, thickness=1.5e-3), 0.06))
    outcomes = agreement(weave)
    assert {verdict for verdict, _ in outcomes.values()} == {"agree"}
    causes = {
        motion: {one.cause: one.amount / found.reference for one in found.allowances}
        for motion, (_, found) in outcomes.items()
    }
    assert causes["x"][HELD_FACES] == pytest.approx(0.024, abs=0.002)
    assert causes["φx"][FORMULA] == pytest.approx(-0.0046, abs=5e-4)
    wrong = agreement(weave, 1.02)
    assert {wrong[motion][0] for motion in ("x", "y", "z", "φy", "φz")} == {"disagree"}


def test_unidirectional_leg_is_exact(agreement):
    """E1 A, E1 I and G12 J are exact. Twelve parabolas for a circle: an error of 3e-4."""
    outcomes = agreement(leg_of(LaminateTube(layers(0, thickness=3e-3), 0.06)))
    for motion in ("x", "φx", "φy"):
        verdict, found = outcomes[motion]
        held = sum(one.amount for one in found.allowances if one.cause == HELD_FACES)
        assert verdict == "agree"
        assert found.value - held == pytest.approx(found.reference, rel=5e-4)


@pytest.mark.parametrize("ply", [CARBON, STIFF], ids=["carbon", "stiff"])
@pytest.mark.parametrize("angles", [(45, -45), (60, -60, 0), (0, 0, 75, -75)], ids=str)
def test_thin_wall_errors_are_bounds(ply, angles):
    """Constants by theory and by finite elements differ by less than `laminate_errors` states."""
    check_errors(layers(*angles, thickness=3e-3 / len(angles), ply=ply))


@pytest.mark.parametrize("thickness", [1e-3, 2e-3])
@pytest.mark.parametrize("ply", [CARBON, STIFF], ids=["carbon", "stiff"])
@pytest.mark.parametrize(
    "angles",
    [(30,), (60,), (30, 0), (20, -70), (85, 10), (-20, 35), (45, 0, -20), (90, -25, 50)],
    ids=str,
)
def test_thin_unbalanced_wall_errors_are_bounds(angles, ply, thickness):
    """A helix, in a box, is up to 6 % softer by theory, and (20, −70) in a tube 4 % stiffer."""
    check_errors(layers(*angles, thickness=thickness / len(angles), ply=ply))


def check_errors(wall):
    for section in (LaminateTube(wall, 0.06), LaminateBox(wall, 0.06, 0.04)):
        leg = leg_of(section)
        by_theory, computed = leg.timoshenko, computed_properties(leg, 2)
        for name, bound in laminate_errors(section).items():
            error = getattr(by_theory, name) / getattr(computed, name) - 1.0
            assert abs(error) < bound, name


@pytest.mark.parametrize("angles", [(30,), (45, -45), (20, -70), (90, -25, 50)], ids=str)
def test_tube_by_exact_elasticity_equals_section(angles):
    """Finite elements of the section converge to the exact ring; thin walls differ by up to 6 %."""
    section = LaminateTube(layers(*angles, thickness=3e-3 / len(angles), ply=STIFF), 0.06)
    exact, thin = ring_stiffnesses(section), thin_wall_stiffnesses(section)
    beam, computed = leg_of(section).timoshenko, computed_properties(leg_of(section), 4)
    for name, stiffness in exact.items():
        # Parabolas for arcs, and one element across each layer, which bends less than a layer.
        assert getattr(computed, name) == pytest.approx(stiffness, rel=3e-3)
        assert getattr(beam, name) == pytest.approx(thin[name], rel=1e-12)


def test_axial_tube_by_exact_elasticity_is_isotropic():
    """E1 A, E1 I and G12 J of a tube of axial fibres."""
    section = LaminateTube(layers(0, 0, thickness=1.5e-3), 0.06)
    exact = ring_stiffnesses(section)
    area, moment = pi / 4.0 * (0.06**2 - 0.054**2), pi / 64.0 * (0.06**4 - 0.054**4)
    assert exact["EA"] == pytest.approx(CARBON["E1"] * area, rel=1e-9)
    assert exact["EIy"] == pytest.approx(CARBON["E1"] * moment, rel=1e-6)
    assert exact["GJ"] == pytest.approx(CARBON["G12"] * 2.0 * moment, rel=1e-9)


def test_known_error_leaves_wrong_formula_visible():
    """The bound of a tube is the error that it has and (t/r)², not an estimate several times it."""
    section = LaminateTube(layers(45, 0, -20, thickness=1e-3 / 3.0), 0.06)
    bounds = laminate_errors(section)
    beam, computed = leg_of(section).timoshenko, computed_properties(leg_of(section), 2)
    for name in ("EA", "EIy", "GJ"):
        error = abs(getattr(beam, name) / getattr(computed, name) - 1.0)
        assert error < bounds[name] < error + 0.003
