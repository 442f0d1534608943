"""Frequencies of robots of I-sections and of legs known by a 6×6; torsion of a leg alone."""

from dataclasses import replace

import numpy as np
import pytest
from support.fakes.toy_responses import reference
from support.robots.paper_robot_variants import (
    LEG1,
    LEG2,
    file_of,
    placed_at,
    stations,
    variant_of_ifw,
)

from fem.beams.beam import beam_leg
from fem.bodies import doubling
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.acceptance.requirement import Requirement
from lumped.arrays import dense
from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg, GivenLeg, Material
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.screws import shift
from lumped.sections import HollowRectangle, ISection, Rectangle, Tube
from meshes.section.section_mesh import section_mesh
from validation.adequacy.judged_models import JUDGED, judged_model
from validation.adequacy.judgement import verdict_matrix
from validation.adequacy.robot_verdicts import leg_subject, robot_adequacy
from validation.context import Context
from validation.models.leg_models import leg_matrices
from validation.models.loads.leg_masses import (
    MASSES,
    Inside,
    leg_with_inside,
    plausible_masses,
)
from validation.models.options import DEFAULT_OPTIONS
from validation.references.modal_reference import dynamic_reference, mass_notes
from validation.references.model_ladder import SOLID
from validation.references.modes_on_path import (
    LegMesh,
    built_vibration,
    modes_by_model,
    modes_of_solids,
    solid_meshes,
    solid_vibration,
)
from validation.references.reference import Reference, Source, Subject
from validation.references.responses import Responses
from validation.references.robot_on_path import robot_at, robot_on_path
from validation.references.static_reference import static_reference
from validation.responses.mode_partners import frequency_changes
from validation.solids.leg_meshes import COARSEST_WALLS

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
FLANGED = ConstantLeg(
    0.9, ISection(width=0.1, height=0.1, flange=0.008, web=0.006), STEEL, ends="rigid"
)
BEAMS = ("segments", "beam", "segments-euler-bernoulli", "beam-euler-bernoulli")


def test_wall_mesh_is_refined_twofold():
    """The half-width of thin walls compares meshes whose element sizes have the ratio two."""
    meshes, bar = solid_meshes("fine"), replace(FLANGED, section=Rectangle(0.1, 0.1))
    assert meshes.ratio([FLANGED]) == 2.0
    assert meshes.ratio([FLANGED, bar]) == pytest.approx(4.0 / 3.0)


def test_equal_legs_share_a_reduction():
    """One reduction is computed for each different leg and end condition."""
    robot, reduced_legs = load_robot("five-bar").mechanism, []

    def build(leg, ends, _highest):
        reduced_legs.append((leg.length, ends))
        return leg_matrices("beam", leg)

    legs = legs_of(robot)
    ends = dict.fromkeys(legs, "free") | {"crank1": "rigid"}
    built_vibration((reference_posture(robot),), build, {}, ends, 1)
    due = {(leg.length, ends[name]) for name, leg in legs.items()}
    assert len(due) == 3
    assert set(reduced_legs) == due
    assert len(reduced_legs) % len(due) == 0


def at_the_centre(requirement=None, **changes):
    """Context (preset quick) of the paper's robot with `changes`, in one pose, digits exact."""
    robot = variant_of_ifw(**changes)
    robot = replace(robot, poses=robot.poses[4:5])
    return Context(file_of(robot, text="", requirement=requirement), "quick")


OF_FLANGED = {"requirement": Requirement(modes=4), "a": 0.95, "platform_mass": 30.0}
OF_FLANGED |= {"leg1": FLANGED, "leg2": FLANGED}


@pytest.fixture(scope="module")
def flanged():
    """Verdicts on a robot of I-sections 100 × 100 mm, flanges 8 mm, web 6 mm, length 0.9 m."""
    return robot_adequacy(at_the_centre(**OF_FLANGED))


@pytest.mark.exhaustive
@pytest.mark.parametrize("model", BEAMS)
def test_i_section_beam_modes_lack_partners(flanged, model):
    """Beams have two modes at 160 Hz, where the robot's next mode is above 220 Hz."""
    order = flanged.entry(model, "order")
    assert order.verdict == "inadequate"
    # Two at 160 Hz, where the robot's next mode is above 220 Hz.
    assert order.value == pytest.approx(160.0, abs=1.0)
    assert order.expected > 220.0
    assert order.causes[0].cause.startswith("restrained warping")
    assert order.causes[0].share == pytest.approx(1.0, abs=0.1)
    assert (order.remedy, order.error_with_remedy) == ("use solid", 0.0)


def test_torsion_has_largest_mesh_half_width():
    """Torsion of an open section depends on its mesh; bending of 100 × 100 mm hardly does."""
    robot = robot_on_path(at_the_centre(**OF_FLANGED))
    (solids,) = dynamic_reference(Responses(robot)).interpretations
    first, *further = solids.budget[Source.MESHES].frequencies[0, :4]
    # The section mesh of the solids leaves open a ninth of it, by beams on it and on a finer one.
    assert 0.0057 < first < 0.0061
    assert max(further) < 0.0025


def test_i_section_beam_torsion_is_inadequate():
    """The torsional compliance of the beam is 3.7 times that of the solid."""
    entry = alone(FLANGED)
    assert entry.verdict == "inadequate"
    # 3.7 times the compliance of the solid, from a mesh of its own.
    mesh = section_mesh(FLANGED.section, 4)
    solid = doubling.tip_compliance(doubling.condensed_leg(FLANGED, mesh, 64), "rigid")[3, 3]
    torsional_compliance = tip_compliance(FLANGED.timoshenko, FLANGED.length)[3, 3]
    assert torsional_compliance / solid == pytest.approx(3.7, abs=0.05)
    assert entry.error == pytest.approx(
        torsional_compliance / solid - 1.0, abs=2.0 * entry.uncertainty
    )
    first = entry.causes[0]
    assert first.cause == "restrained warping at the ends"
    assert first.share == pytest.approx(1.0, abs=0.05)
    assert (entry.remedy, entry.error_with_remedy) == ("use solid", 0.0)


def alone(leg):
    """Entry of model `beam` for the torsion of the leg, at preset quick."""
    subject = leg_subject(Context(load_robot("ifw"), "quick"), "leg1", leg)
    return verdict_matrix(subject, Requirement()).entry("beam", "phi_x")


def test_end_conditions_change_torsion_verdict():
    """I-section: with free ends only formulas are in error. Without an end condition: undecided."""
    entry = alone(replace(FLANGED, ends="free"))
    # The thin-walled J alone is off; inward corners leave the quick mesh 4 % uncertain.
    assert entry.along == pytest.approx(0.0, abs=0.02)
    # The error is as computed, however much is left open of it; none is below zero.
    assert entry.error == pytest.approx(abs(entry.along), rel=1e-6)
    assert entry.low == 0.0 < entry.error < entry.uncertainty
    assert entry.high == pytest.approx(entry.error + entry.uncertainty, rel=1e-12)
    assert [cause.cause for cause in entry.causes] == ["section constants by textbook formulas"]
    unsaid = alone(replace(FLANGED, ends=None))
    assert unsaid.verdict == "undecided"
    assert unsaid.reason.endswith("in [leg1]")
    assert unsaid.uncertainties["end conditions of the legs"] > 1.0


@pytest.mark.parametrize(
    ("section", "ends"),
    [
        pytest.param(FLANGED.section, "rigid", marks=pytest.mark.exhaustive),
        pytest.param(Tube(0.12, 0.006), "free", marks=pytest.mark.soak),
        # One section mesh with one and two divisions: it resists distortion 0.4 % too much in f3.
        pytest.param(HollowRectangle(0.1, 0.16, 0.008), "free", marks=pytest.mark.soak),
    ],
)
def test_half_widths_cover_finer_mesh(section, ends):
    """Changes of frequencies from preset quick to finer meshes are within the half-widths."""
    leg = ConstantLeg(0.9, section, STEEL, ends=ends)
    robot = variant_of_ifw(a=1.0, platform_mass=30.0, leg1=leg, leg2=leg)
    quick, finer = (
        robot_at(Context(file_of(robot), preset), placed_at(robot, *stations(robot, 2)))
        for preset in ("quick", "standard")
    )
    responses = Responses(quick)
    (interpretation,) = dynamic_reference(responses).interpretations
    modes = responses.modes(SOLID, interpretation.reading)
    hold = finer.first_reading
    mesh = LegMesh(2, 2, 2 * COARSEST_WALLS)
    of_sections = solid_vibration(quick.postures, hold, mesh, quick.computed_count)
    for truth in (modes_of_solids(finer, hold), of_sections):
        changes = frequency_changes(modes, truth, 4)
        assert (changes <= interpretation.budget[Source.MESHES].frequencies).all()


def test_tenth_mode_with_lumped_mass_is_undecided():
    """With the mass in lumps the robot has nine modes, with other mass distributions more."""
    # Three ways each for the platform and two point masses: fewer modes than are judged.
    leg1, leg2 = (replace(leg, inertia=None, mass_centre=None) for leg in (LEG1, LEG2))
    requirement = Requirement(modes=10)
    robot = robot_on_path(at_the_centre(requirement, leg1=leg1, leg2=leg2))
    responses = Responses(robot)
    truth = dynamic_reference(responses)
    beams, none = judged_model(robot, "beam", JUDGED["beam"]), Reference("none")
    subject = Subject("", (), np.zeros((1, 0)), responses, [beams], none, truth)
    matrix = verdict_matrix(subject, requirement)
    first_nine = [matrix.entry("beam", f"f{number}") for number in range(1, 10)]
    # With half of the mass at the ends of stiff legs f4 has a MAC of 0.498 with its beams' mode,
    # and f6, f7 and f9 have no partner among the beams with some insides of the legs either.
    assert [entry.error is None for entry in first_nine[:5]] == [False, False, False, True, False]
    assert first_nine[3].verdict == "undecided"
    assert first_nine[3].reason.startswith("specify the mass distribution of the legs")
    assert not any("fewer modes" in entry.reason for entry in first_nine)
    tenth = matrix.entry("beam", "f10")
    assert (tenth.verdict, tenth.error) == ("undecided", None)
    lumps = "with mass in lumps, soft inside, mass in lumps, stiff inside"
    assert tenth.reason.startswith(
        f"{lumps} the robot has fewer modes than are compared; specify the"
    )
    assert matrix.entry("beam", "order").verdict != "adequate"
    (note,) = mass_notes(responses, truth)
    assert ", f10 " in note


def test_drive_model_has_one_mode_at_stroke_end():
    """At its stroke ends the robot moves along one axis only. Entries of missing modes are NaN."""
    robot = robot_on_path(Context(load_robot("ifw"), "quick"))
    path_modes = modes_by_model(robot, "simplified", DEFAULT_OPTIONS)
    is_finite = np.isfinite(path_modes.frequencies)
    counts = is_finite.sum(axis=1)
    assert counts.tolist() == [1, *[2] * (len(robot.postures) - 2), 1]
    assert (is_finite == (np.arange(is_finite.shape[1]) < counts[:, None])).all()
    assert (is_finite == (np.abs(path_modes.samples).max(axis=1) > 0.0)).all()


WIDTH, HEIGHT = 0.06, 0.04
PRISM = ConstantLeg(0.8, Rectangle(WIDTH, HEIGHT), STEEL)
# Without shear deformation a 6×6 is that of its equivalent leg.
GIVEN = GivenLeg(
    PRISM.length, PRISM.mass, tip_compliance(PRISM.properties("euler-bernoulli"), PRISM.length)
)
HIGHEST = 2000.0
# Of mass m over a length L without thickness: centre in L, and inertia about it in m L².
SLENDER = {
    "mass along the legs": (1 / 2, 1 / 12),
    "mass near the roots": (1 / 3, 1 / 18),
    "mass near the tips": (2 / 3, 1 / 18),
    "mass half at the ends": (1 / 2, 1 / 24 + 1 / 8),
    "mass in lumps": (1 / 2, 0.0),
}


def rigid_inertia(leg, masses):
    """Mass (kg), mass centre (m from the root) and inertia about it (3×3, kg m²) of a leg.

    `masses` is the name of the mass distribution along the leg.
    """
    matrices = leg_with_inside(leg, Inside(masses), HIGHEST)
    motions = np.zeros((matrices.size, 6))
    motions[:6], motions[6:12] = np.eye(6), shift(np.array([leg.length, 0.0, 0.0]))
    forces = dense(matrices.stiffness) @ motions
    assert np.abs(forces).max() < 1e-9 * np.abs(dense(matrices.stiffness)).max()
    spatial = motions.T @ (matrices.mass @ motions)
    centre = spatial[1, 5] / spatial[1, 1]
    to_centre = np.linalg.inv(shift(np.array([centre, 0.0, 0.0])))
    return spatial[0, 0], centre, (to_centre.T @ spatial @ to_centre)[3:, 3:]


@pytest.mark.parametrize("masses", MASSES)
def test_mass_distributions_have_known_inertia(masses):
    """Mass, centre and inertia of each plausible distribution in a prism, by integrals along it."""
    mass, centre, inertia = rigid_inertia(GIVEN, masses)
    expected, squared = SLENDER[masses]
    assert mass == pytest.approx(PRISM.mass, rel=1e-9)
    assert centre == pytest.approx(expected * PRISM.length, rel=1e-9)
    # Sections have rotary inertia of their own, ρ(I_y + I_z), ρI_y and ρI_z per length.
    inertia_factors = np.array([HEIGHT**2 + WIDTH**2, HEIGHT**2, WIDTH**2]) / 12.0
    bar = squared * PRISM.length**2 * np.array([0.0, 1.0, 1.0]) + inertia_factors * (
        masses != "mass in lumps"
    )
    assert inertia == pytest.approx(PRISM.mass * np.diag(bar), rel=1e-9, abs=1e-9)
    tensor = np.diag([0.1, 0.2, 0.3]) + 0.01
    for mass_centre in (0.05, 0.3, 0.41, 0.7):
        leg = replace(GIVEN, mass_centre=mass_centre, inertia=tensor)
        mass, centre, inertia = rigid_inertia(leg, masses)
        assert mass == pytest.approx(PRISM.mass, rel=1e-9)
        # Quadrature of a power of the distance from the lighter end.
        assert centre == pytest.approx(mass_centre, rel=1e-3)
        assert masses != "mass in lumps" or inertia == pytest.approx(tensor, abs=1e-9)


def test_beam_from_6x6_has_beam_constants():
    """Squared radii of gyration are EI/EA, with EI of bending without shear."""
    shear = tip_compliance(PRISM.timoshenko, PRISM.length)
    given_leg = GivenLeg(PRISM.length, PRISM.mass, shear)
    beam_matrices = craig_bampton(
        held_leg(beam_leg(PRISM.timoshenko, PRISM.length, 20)), HIGHEST
    ).matrices
    recovered = leg_with_inside(given_leg, Inside(MASSES[0]), HIGHEST)
    for matrix, expected in (
        (recovered.mass, beam_matrices.mass),
        (recovered.stiffness, beam_matrices.stiffness),
    ):
        due = np.abs(dense(expected))
        np.testing.assert_allclose(np.abs(dense(matrix)), due, rtol=0, atol=1e-9 * due.max())


def test_known_mass_centre_excludes_linear_masses():
    """A linear mass distribution is plausible only if the mass centre of a leg is unknown."""
    leg_with_centre = replace(GIVEN, mass_centre=0.4)
    assert plausible_masses([leg_with_centre, leg_with_centre]) == (MASSES[0], *MASSES[3:])
    assert plausible_masses([leg_with_centre, GIVEN]) == MASSES


@pytest.mark.parametrize("mixed", [False, True])
def test_massless_legs_give_upper_frequency_bounds(*, mixed):
    """Massless legs give the highest frequencies: each mass distribution lowers them.

    Rigid end faces make the solid of a prism stiffer than the 6×6 of beam theory.
    """
    prism = ConstantLeg(LEG2.length, Rectangle(0.1, 0.1), STEEL, ends="rigid")
    legs = {"leg2": prism} if mixed else {}
    light = {"leg1": replace(LEG1, mass=1e-6), "leg2": replace(LEG2, mass=1e-6)}
    robot, massless = (
        robot_on_path(at_the_centre(Requirement(), **tables)) for tables in (legs, light)
    )
    beam_modes = {"": modes_by_model(robot, "beam", DEFAULT_OPTIONS)}
    (note,) = mass_notes(Responses(robot), reference("", beam_modes, supposed="plausible"))
    assert note.startswith("Plausible distributions of the legs' mass and stiffness give f1 ")
    assert ("with massless legs" in note) is not mixed
    if mixed:
        # The mesh of the one leg that is a solid leaves something open of the robot.
        (statics,) = static_reference(Responses(robot)).interpretations
        assert (statics.budget[Source.MESHES].displacements[:, :6] > 1e-6).all()
    else:
        solid_modes, above = (
            modes_of_solids(robot_path, robot_path.first_reading)
            for robot_path in (robot, massless)
        )
        assert (solid_modes.frequencies[0, :3] < above.frequencies[0, :3]).all()
        bounds = [
            f"f{k + 1} {frequency:.4g} Hz" for k, frequency in enumerate(above.frequencies[0, :3])
        ]
        assert note.endswith(", ".join(bounds))
