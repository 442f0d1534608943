"""Frequencies of robots whose legs are known by a 6×6, against the solids that have this 6×6."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from support.fakes.toy_responses import reference
from support.robots.paper_robot_variants import FOOT, file_of, placed_at, variant_of_ifw
from support.robots.robot_from_text import described

from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import static_superelement
from lumped.acceptance.quantities import FREQUENCIES
from lumped.acceptance.requirement import Requirement
from lumped.arrays import Array
from lumped.legs import ConstantLeg, GivenLeg, Material
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import legs_of, tip_compliance_of
from lumped.sections import HollowRectangle, ISection, Rectangle, Tube
from validation.adequacy.judged_models import JudgedModel, judged_model
from validation.adequacy.judgement import verdict_matrix
from validation.adequacy.model_errors import ModelErrors
from validation.context import Context
from validation.models.options import DEFAULT_OPTIONS, ModelOptions
from validation.references.modal_reference import dynamic_reference
from validation.references.modes_on_path import built_vibration
from validation.references.reference import Reference, Subject
from validation.references.responses import Responses
from validation.references.robot_on_path import robot_at
from validation.solids.leg_meshes import COARSEST_WALLS, divisions_across
from validation.solids.solid_legs import held_solid

MODES = 6
# Relative. The shapes by which the inside follows the ends are others with each stiffness inside,
# which Rayleigh's argument leaves out: they change the f1 of the robot of seed 103 by 1e-3 in no
# order, and its solids are 9e-5 above the highest reading.
OPEN = 2e-4
EULER = ModelOptions(theory="euler-bernoulli")
MODELS = {"beam": DEFAULT_OPTIONS, "beam-euler-bernoulli": EULER}
STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
ALUMINIUM = Material.isotropic(7.0e10, 0.33, 2700.0)
IRON = Material.isotropic(1.1e11, 0.26, 7200.0)
# Two cast I-sections and the 6×6 of finer solids of them (a public case of this kind: by a beam
# f1 = 145.2 Hz, by solids 207.6 Hz).
FLANGED = """
schema = 1
name = "6x6 f1"
type = "biglide"
[geometry]
a = 0.9502
[platform]
mass = 5.804
[actuators]
stiffness = 5.0e8
[leg1]
length = 0.7885
mass = 41.082944
compliance = [
  [9.8451664e-10, 0, 0, 0, 0, 0],
  [0, 1.5278368e-07, 0, 0, 0, 2.8226351e-07],
  [0, 0, 3.0139929e-08, 0, -4.5391614e-08, 0],
  [0, 0, 0, 3.2350386e-06, 0, 0],
  [0, 0, -4.5391614e-08, 0, 1.1513409e-07, 0],
  [0, 2.8226351e-07, 0, 0, 0, 7.1595056e-07]]
[leg2]
length = 0.8048
mass = 8.1495851
compliance = [
  [5.1881751e-09, 0, 0, 0, 0, 0],
  [0, 1.5603717e-06, 0, 0, 0, 2.8726237e-06],
  [0, 0, 1.9383758e-06, 0, -3.5037594e-06, 0],
  [0, 0, 0, 0.00036355918, 0, 0],
  [0, 0, -3.5037594e-06, 0, 8.7071555e-06, 0],
  [0, 2.8726237e-06, 0, 0, 0, 7.1387269e-06]]
"""
CAST = {
    "leg1": ConstantLeg(0.7885, ISection(0.1637, 0.2304, flange=0.0136, web=0.0137), IRON),
    "leg2": ConstantLeg(0.8048, ISection(0.1085, 0.0589, flange=0.0048, web=0.0074), IRON),
}
SECTION = "specify the section or the solid instead of the 6×6 compliance in [leg1], [leg2]"


@dataclass(frozen=True, eq=False)
class Twins:
    """Mechanism whose legs are known by their 6×6, its position x, and solids with these 6×6."""

    mechanism: Mechanism
    x: float
    solids: dict[str, ConstantLeg]

    def robot(self, limit):
        """The robot in its posture at preset quick, without uncertainty due to printed digits."""
        requirement = Requirement(modes=MODES, frequency=limit)
        file = file_of(self.mechanism, text="", requirement=requirement)
        return robot_at(Context(file, "quick"), placed_at(self.mechanism, self.x))

    def truth(self):
        """Modes with the legs as solids, sampled like those of the robot."""
        robot = self.robot(0.05)
        names = {id(leg): name for name, leg in legs_of(self.mechanism).items()}

        def build(leg, _ends, highest):
            return craig_bampton(held_beam(self.solids[names[id(leg)]]), highest).matrices

        ends = dict.fromkeys(self.solids, "rigid")
        return built_vibration(robot.postures, build, {}, ends, robot.computed_count)


@cache
def held_beam(leg):
    """Solid of the leg with rigid end faces, on the mesh of preset quick."""
    across = divisions_across(leg, 3, 2)
    return held_solid(leg, across, "rigid", divisions_across(leg, 3, COARSEST_WALLS))


def judgements(twins, truth, limit=0.05):
    """Verdict matrix, and (low, high, true error) of each frequency by (model, mode number)."""
    robot = twins.robot(limit)
    requirement = robot.context.robot_file.requirement
    responses = Responses(robot)
    models = [
        judged_model(robot, name, JudgedModel("beam", "", options))
        for name, options in MODELS.items()
    ]
    subjects = [
        Subject("", (), np.zeros((1, 0)), responses, models, Reference("none"), dynamics)
        for dynamics in (dynamic_reference(responses), reference("solids", {"solids": truth}))
    ]
    comparisons = [ModelErrors(subject, MODES) for subject in subjects]
    judged = {}
    for model in models:
        for number in range(1, MODES + 1):
            errors, truly = (
                comparison.errors(model, FREQUENCIES[number - 1]) for comparison in comparisons
            )
            low, high = (side[0] for side in errors.interval)
            judged[model.name, number] = low, high, truly.error[0, 0]
    return verdict_matrix(subjects[0], requirement), judged


@pytest.fixture(scope="module")
def flanged():
    mechanism = described(FLANGED)
    middle = mechanism.poses[len(mechanism.poses) // 2, 0]
    twins = Twins(mechanism, middle, CAST)
    return judgements(twins, twins.truth(), 0.25)


def test_f1_of_i_section_known_by_6x6_is_undecided(flanged):
    """The true error of f1 by beams is −30.1 ± 0.4 %, beyond the limit of 25 %.

    The interval of the verdict must contain it. With an interval of −10.8 ± 10.8 %, which does not,
    the verdict would be adequate.
    """
    matrix, comparisons = flanged
    low, high, true = comparisons["beam", 1]
    assert true == pytest.approx(-0.301, abs=0.004)
    assert low < true < high
    entry = matrix.entry("beam", "f1")
    assert (entry.verdict, entry.reason) == ("undecided", SECTION)


def test_i_section_intervals_contain_errors(flanged):
    """True errors of beams lie between `low` and `high` of their entries."""
    errors = [error for (model, _), error in flanged[1].items() if model == "beam"]
    finite_errors = [error for error in errors if np.isfinite(error).all()]
    assert len(finite_errors) >= 3
    assert all(low <= true <= high for low, high, true in finite_errors)


def test_torsion_of_6x6_leg_is_undecided(flanged):
    """A 6×6 does not define the torsional stiffness inside a leg, so that f5 is undecided."""
    entry = flanged[0].entry("beam-euler-bernoulli", "f5")
    assert entry.verdict == "undecided"
    assert entry.reason == SECTION
    inside = entry.uncertainties["stiffness distribution of the legs"]
    assert inside > 0.25 * (entry.high - entry.low)


def random_twins(seed):
    """A biglide of two random legs, four to twenty times as long as high, of known masses."""
    rng = np.random.default_rng(seed)
    legs = {name: random_leg(rng) for name in ("leg1", "leg2")}
    lengths = [leg.length for leg in legs.values()]
    masses = [leg.mass for leg in legs.values()]
    foot = FOOT if rng.random() < 0.5 else np.diag([1e-11] * 3 + [1e-10] * 3)
    span, platform = rng.uniform(0.55, 0.7) * sum(lengths), rng.uniform(0.1, 1.5) * sum(masses)
    given_tables = {
        name: GivenLeg(leg.length, leg.mass, tip(leg), inertia(leg), leg.length / 2.0)
        for name, leg in legs.items()
    }
    mechanism = variant_of_ifw(a=span, platform_mass=platform, foot_compliance=foot, **given_tables)
    return Twins(mechanism, mechanism.poses[len(mechanism.poses) // 2, 0], legs)


def random_leg(rng):
    length = rng.uniform(0.5, 1.0)
    larger = length / np.exp(rng.uniform(np.log(4.0), np.log(20.0)))
    width, height = rng.permutation([larger, larger * rng.uniform(0.5, 1.0)]).tolist()
    wall, flange = rng.uniform(0.06, 0.14), rng.uniform(0.06, 0.12)
    sections = (
        Rectangle(width, height),
        Tube(larger, wall * larger),
        HollowRectangle(width, height, wall * min(width, height)),
        ISection(width, height, flange=flange * height, web=wall * width),
    )
    section = sections[rng.integers(len(sections))]
    return ConstantLeg(length, section, (STEEL, ALUMINIUM, IRON)[rng.integers(3)], ends="rigid")


def tip(leg):
    compliance = tip_compliance_of(static_superelement(held_beam(leg)).matrices)
    return 0.5 * (compliance + compliance.T)


def inertia(leg) -> Array:
    """Inertia (3×3, kg m²) of a prism about its centre."""
    section = leg.section
    about_y, about_z = (
        leg.mass * second_moment / section.area
        for second_moment in (section.second_moment_y, section.second_moment_z)
    )
    rod = leg.mass * leg.length**2 / 12.0
    return np.diag([about_y + about_z, rod + about_y, rod + about_z])


def knowing(twins, *keys):
    """Twins whose legs have only the specified `keys` out of `mass_centre` and `inertia`."""
    bodies = dict(twins.mechanism.bodies)
    unknown = dict.fromkeys({"mass_centre", "inertia"} - set(keys))
    for name, leg in legs_of(twins.mechanism).items():
        bodies[name] = replace(bodies[name], shape=replace(leg, **unknown))
    return replace(twins, mechanism=replace(twins.mechanism, bodies=bodies))


GIVEN = {"mass": (), "centre": ("mass_centre",), "inertia": ("mass_centre", "inertia")}


@pytest.mark.soak
def test_random_6x6_intervals_contain_truth():
    """At least 93 % of the 95 % intervals contain the true error, for each kind of data and mode.

    It was 89 % for f5 and f6 if modes that cross between two readings of the file were ignored.
    """
    inside = {(knowledge, number): [] for knowledge in GIVEN for number in range(1, MODES + 1)}
    for seed in range(100, 114):
        twins = random_twins(seed)
        truth = twins.truth()
        for knowledge, keys in GIVEN.items():
            _, judged = judgements(knowing(twins, *keys), truth)
            for (_, number), (low, high, true) in judged.items():
                if np.isfinite([low, high, true]).all():
                    inside[knowledge, number].append(low - OPEN <= true <= high + OPEN)
    shares = {key: (np.mean(are_inside), len(are_inside)) for key, are_inside in inside.items()}
    assert all(count >= 14 for _, count in shares.values()), shares
    for knowledge in GIVEN:
        are_inside = [
            is_inside
            for (kind, _), of_mode in inside.items()
            if kind == knowledge
            for is_inside in of_mode
        ]
        assert np.mean(are_inside) >= 0.93, shares
    for number in range(1, MODES + 1):
        are_inside = [
            is_inside
            for (_, mode), of_given in inside.items()
            if mode == number
            for is_inside in of_given
        ]
        assert np.mean(are_inside) >= 0.93, shares
