"""Verdicts on robots at random, slender to stubby, against errors computed without the matrix.

Statics: virtual joints whose springs are those of solid legs on finer meshes than the reference's.
Dynamics: frequencies of the robot with finer solid legs, paired by the cases' own pairing.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from placed import placed
from plain_displacement import plain_errors
from random_robots import IFW, SHAPES, robots, shown

from fem.bodies import doubling
from lumped.acceptance.requirement import Requirement
from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.legs import ConstantLeg, Ends, equivalent_leg
from lumped.models import vjm
from meshes.section.section_mesh import section_mesh
from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Matrix
from validation.adequacy.mechanism.path import robot_at
from validation.adequacy.mechanism.statics import compliances
from validation.adequacy.models import JUDGED
from validation.adequacy.robot import robot_subject, static_subject
from validation.context import Context
from validation.solids.legs import COARSEST_WALLS, section_counts, static_ladder, static_slices
from validation.studies.paired_robot_modes import (
    ELEMENTS,
    PAIRED,
    divisions_of,
    model_modes,
    paired,
    solid_modes,
)

POSTURES = 9
# Unknowns of the section meshes that the quick reference, of fewer, is held against.
FINER = 1900
MODELS = ("simplified", "vjm", "beam", "segments-euler-bernoulli")
# Several limits, so that verdicts of all kinds come up.
LIMITS = (0.003, 0.02, 0.1)


def with_ends(robot: Biglide, ends: Ends) -> Biglide:
    """The same robot with its ends said; legs are constant ones."""
    leg1, leg2 = (replace(equivalent_leg(leg), ends=ends) for leg in (robot.leg1, robot.leg2))
    return replace(robot, leg1=leg1, leg2=leg2)


def chosen(count: int, chunk: int) -> Iterator[Biglide]:
    """So many robots with solid legs, of every shape in turn, ends rigid and free by turns."""
    found = [shown(robots(shape), count // len(SHAPES) + 1, chunk)[1:] for shape in SHAPES]
    for number, robot in enumerate(robot for group in zip(*found, strict=True) for robot in group):
        yield with_ends(robot, "rigid" if number % 2 else "free")


def context_of(robot: Biglide) -> Context:
    """A quick run's context."""
    robot_file = replace(IFW, described=robot, built_in=False, source="random.toml")
    return Context(robot_file, "quick")


def static_matrices(robot: Biglide) -> list[Matrix]:
    """Statics of some models, judged with several limits."""
    context = context_of(robot)
    posed = robot_at(context, placed(context, robot.stations(POSTURES)))
    subject = static_subject(posed, {name: JUDGED[name] for name in MODELS})
    return [judged(subject, Requirement(deflection=limit)) for limit in LIMITS]


def finest_statics(robot: Biglide) -> Array:
    """Compliances (p×6×6) with solid legs on finer meshes, by virtual joints."""
    springs = []
    for leg in (robot.leg1, robot.leg2):
        assert isinstance(leg, ConstantLeg)
        divisions = (static_ladder(leg, FINER) or (COARSEST_WALLS,))[-1]
        mesh = section_mesh(leg.section, section_counts(leg, divisions))
        condensed = doubling.condensed_leg(leg, mesh, static_slices(leg, divisions))
        springs.append(doubling.tip_compliance(condensed, leg.ends or "rigid"))
    return np.array(
        [
            vjm.compliance(robot, x, (springs[0], springs[1]))
            for x in robot.stations(POSTURES).tolist()
        ]
    )


def contradictions(matrix: Matrix, errors: dict[tuple[str, str], Array]) -> list[str]:
    """Verdicts that errors computed otherwise do not bear out, beyond the stated uncertainty."""
    found = []
    for (model, quantity), direct in errors.items():
        entry = matrix.entry(model, quantity)
        assert entry is not None
        size = np.abs(direct)
        spread = np.array([0.0 if s is None else s for s in entry.spreads])
        # The direct error is as uncertain as a finer mesh is: by less than the stated one.
        wrong = {
            "adequate": bool((size > entry.limit + spread).any()),
            # The largest over directions that were tried is the largest of all, less a percent.
            "inadequate": bool((1.01 * size + spread < entry.limit).all()),
            "undecided": bool((size > entry.limit + 2.0 * spread).any()),
        }
        if wrong[entry.verdict]:
            found.append(f"{model} {quantity}: {entry.verdict}, limit {entry.limit}, {direct}")
    return found


def wrong_in_statics(robot: Biglide) -> list[str]:
    """What the finest statics contradict."""
    expected = finest_statics(robot)
    x = robot.stations(POSTURES)
    errors = {}
    for name in MODELS:
        model, _, options = JUDGED[name]
        found = compliances(placed(context_of(robot), x), model, options)
        errors |= {(name, q): error for q, error in plain_errors(found, expected).items()}
    return [line for matrix in static_matrices(robot) for line in contradictions(matrix, errors)]


def wrong_in_dynamics(robot: Biglide) -> list[str]:
    """What finer solids contradict of frequencies by segments, where both pair a mode alike."""
    context = context_of(robot)
    legs = equivalent_leg(robot.leg1), equivalent_leg(robot.leg2)
    _, finer = divisions_of(legs, "standard")
    assert isinstance(robot.leg1, ConstantLeg)
    reference = solid_modes(robot, finer, robot.leg1.ends or "rigid", POSTURES)
    segments = model_modes(robot, "segments", "timoshenko", ELEMENTS, POSTURES)
    pairs = paired(robot, reference, segments)
    subject = robot_subject(context)
    found = []
    for limit in LIMITS:
        matrix = judged(subject, Requirement(frequency=limit, modes=4))
        sure = (pairs.shared > 0.9).all(axis=0)
        errors = {
            ("segments", f"f{k + 1}"): (pairs.found / pairs.reference - 1.0)[:, k]
            for k in range(min(4, PAIRED))
            if sure[k]
        }
        found += contradictions(matrix, errors)
    return found


@pytest.mark.exhaustive
def test_verdicts_are_those_of_errors_computed_directly() -> None:
    # One of rectangles and one of walls; the other shapes are among the exhaustive ones.
    for robot in islice(chosen(len(SHAPES), chunk=11), 2):
        assert not wrong_in_statics(robot), robot


@pytest.mark.soak
@pytest.mark.parametrize("chunk", range(8))
def test_no_verdict_on_forty_robots_is_contradicted(chunk: int) -> None:
    """Five robots, one of each shape, in every chunk."""
    for robot in chosen(len(SHAPES), chunk=20 + chunk):
        assert not wrong_in_statics(robot), robot
        assert not wrong_in_dynamics(robot), robot


@pytest.mark.soak
@pytest.mark.parametrize("chunk", range(10))
def test_no_model_of_a_hundred_robots_is_called_adequate_in_statics_that_is_not(
    chunk: int,
) -> None:
    """Ten robots in every chunk."""
    for robot in chosen(2 * len(SHAPES), chunk=40 + chunk):
        assert not wrong_in_statics(robot), robot
