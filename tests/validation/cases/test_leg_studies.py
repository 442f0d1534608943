"""A solid leg compared with beams: orders of the differences in the length, and local modes."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.robots.paper_legs import LEG_1, LEG_2, STEEL, kind_frequencies
from support.robots.paper_robot_variants import file_of, placed_at, variant_of_ifw

from fem.beams.beam import beam_leg
from fem.bodies import doubling
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import Superelement
from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.biglide import biglide
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.sections import Channel, Composite, CompositePart, HollowRectangle, Rectangle, Tube
from lumped.system.assembly import assemble
from lumped.system.solution import modes, solved
from validation.case import Skip
from validation.cases import leg_theory
from validation.cases.leg_waves import wave_changes, waves_of
from validation.comparisons import mesh_cases
from validation.comparisons.section_formulas import leg_formula_band
from validation.context import Context
from validation.run.outcome import judge
from validation.solids.leg_meshes import face_mesh, static_slices
from validation.solids.solid_legs import (
    ELEMENTS,
    Refinement,
    computed_beam,
    computed_properties,
    doubled_tips,
    held_solid,
    solid_frequencies,
)

# With elements across the smaller side or the walls.
LEGS = {
    "leg1": (LEG_1, 3),
    "leg2": (LEG_2, 2),
    "box": (ConstantLeg(0.85, HollowRectangle(0.1, 0.16, 0.008), STEEL), 4),
}
LENGTHS = 2.0 ** np.arange(5)
# Powers of the slenderness (docs/guide/theory.md): a held face acts over a fixed length, shear and
# rotary inertia all along, shear's own warping is held over a fixed length of L/κGA.
EXPONENTS = {
    **dict.fromkeys(("torsion", "contraction c11", "contraction c22", "contraction c33"), -1.0),
    **dict.fromkeys(("shear", "rotary inertia"), -2.0),
    "warping of shear": -3.0,
}
# The extrapolated share of torsion and the shear share L/κGA ÷ L³/3EI: leg 1 1.44 % and 1.35 %,
# leg 2 17.5 % and 17.9 % (the end restraint brings the latter to 17.5 %).
SHARES = {
    ("leg1", "torsion"): (0.0140, 0.0160),
    ("leg1", "shear"): (0.0133, 0.0137),
    ("leg2", "torsion"): (0.174, 0.177),
    ("leg2", "shear"): (0.178, 0.180),
}


def doubled(leg: ConstantLeg, divisions: int):
    """Diagonals (5×6) of the tip compliances at five lengths, each twice the one before.

    Three arrays: solid with rigid ends, solid with free ends, Euler–Bernoulli beam.
    """
    pieces = [doubling.condensed_leg(leg, face_mesh(leg, divisions), static_slices(leg, divisions))]
    for _ in LENGTHS[1:]:
        pieces.append(doubling.doubled(pieces[-1]))
    beam = computed_properties(leg, divisions).as_euler_bernoulli()
    return (
        np.array([np.diag(doubling.tip_compliance(piece, "rigid")) for piece in pieces]),
        np.array([np.diag(doubling.tip_compliance(piece, "free")) for piece in pieces]),
        np.array([np.diag(tip_compliance(beam, leg.length * factor)) for factor in LENGTHS]),
    )


def rotary_inertia(leg, length):
    slender = leg.timoshenko.as_euler_bernoulli()
    beams = slender, replace(slender, rho_Iy=leg.timoshenko.rho_Iy)
    without, with_it = (kind_frequencies(beam_leg(b, length, 20), "bending y", 1)[0] for b in beams)
    return without / with_it - 1.0


def differences(leg: ConstantLeg, divisions: int):
    """Relative differences (five lengths) between two models of a leg, by name of their cause."""
    lengths = leg.length * LENGTHS
    rigid, free, slender = doubled(replace(leg, material=replace(leg.material, nu=0.0)), divisions)
    isotropic = Material.isotropic(leg.material.E, 0.3, leg.material.rho)
    restrained, loose, beam = doubled(replace(leg, material=isotropic), divisions)
    # Of the deflection along z; 1/EI is this mesh's own, and what it holds at faces taken off.
    turning = free[:, 4]
    per_length = (turning[-1] - turning[0]) / (lengths[-1] - lengths[0])
    bent = per_length * lengths**3 / 3.0 + 0.5 * (turning - per_length * lengths) * lengths**2
    return {
        "torsion": 1.0 - rigid[:, 3] / free[:, 3],
        **{
            f"contraction c{k + 1}{k + 1}": (loose - restrained)[:, k] / beam[:, k]
            for k in range(3)
        },
        "shear": free[:, 2] / bent - 1.0,
        "rotary inertia": np.array([rotary_inertia(leg, length) for length in lengths]),
        "warping of shear": (free - rigid)[:, 2] / slender[:, 2],
    }


@pytest.mark.parametrize("name", LEGS)
def test_each_difference_has_known_order(name):
    """Exponents of the length: end effects −1, shear and rotary inertia −2, warping by shear −3."""
    for cause, amounts in differences(*LEGS[name]).items():
        # −p of C s⁻ᵖ (1 + D/s + …): exponents of the longest legs, extrapolated in 1/s.
        before, last = np.diff(np.log2(amounts[-3:]))
        assert 2.0 * last - before == pytest.approx(EXPONENTS[cause], abs=0.05), cause
        low, high = SHARES.get((name, cause), (0.0, 1.0))
        assert low < amounts[0] < high


def test_rigid_face_residual_is_mesh_error():
    """Beam and end effects are exact: the rest is the mesh error at the edges of a rigid face."""
    foam = replace(Material.isotropic(3.0e9, 0.45, 1100.0), G=0.8e9)
    tube = ConstantLeg(0.66, Tube(0.14, 0.0137), foam)
    context = Context(file_of(variant_of_ifw(leg1=tube)), "quick")
    for entry in ((0, 0), (1, 1)):
        measurement = leg_theory._entry(context, "leg1", entry, "rigid", 1.0)
        assert 0.0 < -measurement.unexplained < measurement.numerical_uncertainty


# A sandwich of aluminium and a core with another Poisson's ratio.
SANDWICH = Composite(
    (
        CompositePart(Rectangle(0.04, 0.01), 7e10, 0.45, 2700.0, at=(0.0, -0.015)),
        CompositePart(Rectangle(0.04, 0.02), 3e10, 0.1, 300.0),
        CompositePart(Rectangle(0.04, 0.01), 7e10, 0.45, 2700.0, at=(0.0, 0.015)),
    )
)


@pytest.mark.parametrize(("factor", "verdict"), [(1.0, "agree"), (1.001, "disagree")])
def test_composite_with_wrong_ea_disagrees(factor, verdict, monkeypatch):
    """A solid composite leg agrees with its beam. With 0.1 % more EA they disagree."""
    leg = ConstantLeg(0.2, SANDWICH, Material(*SANDWICH.mean_material))

    def stiffer(leg, divisions):
        right = computed_properties(leg, divisions)
        return replace(right, EA=factor * right.EA)

    monkeypatch.setattr(leg_theory, "static_divisions", two_coarse_meshes)
    monkeypatch.setattr(leg_theory, "computed_properties", stiffer)
    context = Context(file_of(variant_of_ifw(leg1=leg)), "quick")
    cases = {case.id: case for case in leg_theory.cases(legs=("leg1",))}
    case = cases["leg1.compliance.solid-free[c11]"]
    assert judge(case, case.measure(context), 0.0).verdict == verdict


def test_composite_formulas_are_bounds():
    """Sums of EA and EI over the parts are lower bounds; with a common contraction, upper bounds.

    Poisson's ratios of the parts differ by 0.35, which stiffens tension by 2 %.
    """
    leg = ConstantLeg(0.2, SANDWICH, Material(*SANDWICH.mean_material))
    computed, by_formula = computed_properties(leg, 2), leg.timoshenko
    softer, stiffer = leg_formula_band(leg, 2)
    for name in ("EA", "EIy", "EIz", "GAy", "GAz"):
        assert getattr(softer, name) <= getattr(by_formula, name) <= getattr(stiffer, name), name
    for name in ("EA", "EIy", "EIz"):
        ratio = getattr(computed, name) / getattr(by_formula, name)
        assert 1.001 < ratio < getattr(computed, name) / getattr(softer, name), name


def test_mode_above_cut_off_is_skipped():
    """The walls of the Delta's arms vibrate by themselves below its first torsional frequency."""
    delta = Context(load_robot("delta"), "standard")
    cases = {case.id: case for case in leg_theory.cases(legs=("arm1",))}
    for mode, lowest in ((3, 2557), (6, 3728)):
        with pytest.raises(Skip, match=f"above {lowest} Hz the section of the leg distorts"):
            cases[f"arm1.frequency.solid[{mode}]"].measure(delta)


ALUMINIUM = Material.isotropic(7.0e10, 0.33, 2700.0)
SCARA_ARM = ConstantLeg(0.35, HollowRectangle(0.12, 0.09, 0.006), ALUMINIUM)


def measured_mode(leg, mode, preset="quick"):
    context = Context(file_of(variant_of_ifw(leg1=leg)), preset)
    cases = {case.id: case for case in leg_theory.cases(legs=("leg1",))}
    case = cases[f"leg1.frequency.solid[{mode}]"]
    return judge(case, case.measure(context), 0.0)


def four_elements(*_):
    """Divisions of a single mesh, the coarsest for thin walls, instead of a sequence of meshes."""
    return (4,)


@pytest.mark.parametrize(("mode", "expected"), [(1, -0.0285), (2, -0.0132)])
def test_short_box_agrees_with_distortion(mode, expected, monkeypatch):
    """The box's section distorts: modes 1 and 2 are 2.9 and 1.3 % below Timoshenko's beam."""
    monkeypatch.setattr(leg_theory, "modal_divisions", four_elements)
    monkeypatch.setattr("validation.solids.solid_legs.Refinement.uncertainty", lambda *_: 0.0)
    outcome = measured_mode(SCARA_ARM, mode)
    measurement = outcome.measurement
    assert measurement.difference / measurement.reference == pytest.approx(expected, abs=1e-3)
    # Four elements along the leg.
    assert abs(measurement.unexplained) < 5e-4 * measurement.reference
    assert outcome.verdict == "agree"


def test_channel_agrees_with_section_modes(monkeypatch):
    """Warping of a channel, 4 % of its first frequency, is explained; a wrong E is not."""
    monkeypatch.setattr(leg_theory, "MODES", 2)
    monkeypatch.setattr(leg_theory, "modal_divisions", four_elements)
    monkeypatch.setattr(leg_theory, "solid_frequencies", cache(solid_frequencies))
    monkeypatch.setattr("validation.solids.solid_legs.Refinement.uncertainty", lambda *_: 0.0)
    leg = ConstantLeg(0.2, Channel(0.04, 0.06, 0.008, 0.008), STEEL)
    outcome = measured_mode(leg, 1)
    measurement = outcome.measurement
    assert outcome.verdict == "agree"
    assert measurement.difference / measurement.reference == pytest.approx(0.044, abs=1e-3)
    for factor in (0.95, 1.05):

        def wrong(*arguments, factor=factor):
            beam = computed_properties(*arguments)
            names = ("EA", "EIy", "EIz", "GJ", "GAy", "GAz")
            return replace(beam, **{name: factor * getattr(beam, name) for name in names})

        monkeypatch.setattr(leg_theory, "computed_properties", wrong)
        assert measured_mode(leg, 1).verdict == "disagree"


def two_coarse_meshes(*_):
    """Numbers of divisions of two coarse meshes of a rectangle, which take a second."""
    return (1, 2)


STUB = ConstantLeg(0.2, Rectangle(0.08, 0.1), STEEL)


@pytest.mark.parametrize(
    ("mistake", "verdict"), [({}, "agree"), ({"GAz": 1.03}, "disagree"), ({"mu": 1.03}, "disagree")]
)
def test_wrong_beam_disagrees_despite_distortion(mistake, verdict, monkeypatch):
    """Beam with 3 % too much shear stiffness or mass: distortion must not explain this error."""

    def wrong(leg, divisions):
        right = computed_properties(leg, divisions)
        return replace(
            right, **{name: factor * getattr(right, name) for name, factor in mistake.items()}
        )

    monkeypatch.setattr(leg_theory, "computed_properties", wrong)
    monkeypatch.setattr(leg_theory, "modal_divisions", two_coarse_meshes)
    # Bending y, the second mode.
    assert measured_mode(STUB, 2).verdict == verdict


def heavier_solid(leg, *arguments):
    """Frequencies of a solid with three percent too much density."""
    dense = replace(leg, material=replace(leg.material, rho=1.03 * leg.material.rho))
    return solid_frequencies(dense, *arguments)


def test_wrong_solid_disagrees_despite_distortion(monkeypatch):
    """Solid with too much mass: distortion of the section must not explain this error."""
    monkeypatch.setattr(leg_theory, "solid_frequencies", heavier_solid)
    monkeypatch.setattr(leg_theory, "modal_divisions", two_coarse_meshes)
    assert measured_mode(STUB, 2).verdict == "disagree"


@pytest.mark.parametrize(
    ("section", "length", "nu"),
    [(Tube(0.06, 0.003), 0.4, 0.3), (Tube(0.03, 0.002), 0.4, 0.45), (Tube(0.03, 0.002), 0.1, 0.1)],
)
def test_tube_with_independent_g_agrees(section, length, nu):
    """Beam and solid agree within 3e-6.

    Differences of 3e-6 to 9e-6 reveal unequal integration rules in curved cells.
    """
    carbon = replace(Material.isotropic(1.2e11, nu, 1600.0), G=5.0e9)
    leg = ConstantLeg(length, section, carbon)
    solid = doubled_tips(leg, 8, static_slices(leg, 8))["free"]
    beam = tip_compliance(computed_properties(leg, 8), leg.length)
    # Fourth order in the opening angle of the cells: 7e-7 and less at four divisions.
    assert_allclose(np.diag(solid), np.diag(beam), rtol=2e-7)


def test_wrong_density_disagrees_despite_waves():
    """2 % more mass in the legs lowers the beams' frequencies. The wave correction is unchanged.

    A correction relative to the beams' own frequencies would have hidden the wrong mass.
    """
    leg = ConstantLeg(0.3, Rectangle(0.03, 0.05), STEEL)
    mechanism = biglide("heavy", 0.4, leg, leg, platform_mass=1e-3, drive_stiffness=1e10)
    right = computed_beam(leg, 2)
    places, results = placed_at(mechanism), []
    for beam in (right, replace(right, mass=1.02 * right.mass)):
        beams = dict.fromkeys(legs_of(mechanism), beam)
        changes = wave_changes(
            places,
            {
                name: Superelement(matrices, np.eye(matrices.size))
                for name, matrices in beams.items()
            },
            beams,
            waves_of(legs_of(mechanism), dict.fromkeys(beams, 2)),
            elements=ELEMENTS,
            basis_count=20,
            count=3,
        )[0]
        results.append((modes(solved(assemble(places[0], beams)), 3).frequencies, changes))
    (frequencies, changes), (lower, unchanged) = results
    assert_allclose(lower / frequencies, 1.02**-0.5, rtol=1e-3)
    assert_allclose(unchanged, changes, atol=3e-4)


@pytest.mark.exhaustive
def test_wave_correction_exists_for_fixed_ends():
    """The correction by 3-D waves exists for a leg that bends between fixed ends.

    With ν = −0.9, κ of its section is 0.007 by strain energy and much larger by waves.
    """
    soft, stiff = (Material.isotropic(2.1e11, nu, 7850.0) for nu in (-0.9, 0.0))
    thin = ConstantLeg(0.06, Rectangle(0.0017, 0.0008), soft)
    thick = ConstantLeg(0.07, Rectangle(0.01, 0.01), stiff)
    mechanism = biglide("rest", 0.12, thin, thick, platform_mass=10.0, drive_stiffness=3e11)
    legs, divisions = legs_of(mechanism), {"leg1": 2, "leg2": 2}
    beams = {name: computed_beam(leg, divisions[name]) for name, leg in legs.items()}
    places = placed_at(mechanism)
    changes = wave_changes(
        places,
        {name: Superelement(beam, np.eye(beam.size)) for name, beam in beams.items()},
        beams,
        waves_of(legs, divisions),
        elements=ELEMENTS,
        basis_count=12,
        count=5,
    )[0]
    frequencies = modes(solved(assemble(places[0], beams)), 5).frequencies
    solids = {
        name: craig_bampton(
            held_solid(leg, divisions[name], "free"), 2.0 * frequencies[-1]
        ).matrices
        for name, leg in legs.items()
    }
    differences = modes(solved(assemble(places[0], solids)), 5).frequencies / frequencies - 1.0
    assert differences.max() > 4e-3
    # What is left is the length of the solids' elements, fourth order.
    assert_allclose(changes, differences, atol=3e-5)


@pytest.mark.parametrize(
    ("values", "verdict"),
    [
        # h⁴ and h⁶.
        ([1.0 + n**-4.0 + 0.3 * n**-6.0 for n in (2, 3, 4, 6)], "agree"),
        ([1.0 + n**-1.5 for n in (2, 3, 4, 6)], "disagree"),
        # A strip of 0.5 by 20 mm: the order moves from 0.53 to 1.31.
        ([1.652000194694, 1.651912385746, 1.651874087651, 1.651856950924], "undecided"),
        ([1.0, 1.1, 1.25, 1.5], "disagree"),
    ],
    ids=["formal", "low", "moving", "diverging"],
)
def test_unsettled_mesh_order_is_undecided(monkeypatch, values, verdict):
    """The formal order agrees, a low order disagrees, one that still changes is undecided."""
    divisions = (1, 2, 3, 4) if verdict == "undecided" else (2, 3, 4, 6)
    refinement = Refinement(divisions, np.multiply.outer(values, np.eye(6)))
    monkeypatch.setattr(mesh_cases, "compliances", lambda *_: refinement)
    cases = {case.id: case for case in mesh_cases.cases(legs=("leg1",))}
    case = cases["refinement.leg1.solid.order[c22]"]
    assert judge(case, case.measure(Context(load_robot("ifw"))), 0.0).verdict == verdict
