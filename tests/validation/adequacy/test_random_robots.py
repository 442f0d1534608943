"""Verdicts on robots at random, slender to stubby, against errors computed without the matrix.

Statics: virtual joints whose springs are those of solid legs on finer meshes than the reference's.
Dynamics: frequencies of the robot with finer solid legs.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from like_ifw import file_of, placed_at, stations
from plain_displacement import plain_errors
from random_robots import SHAPES, robots

from fem.bodies import doubling
from lumped.acceptance.requirement import Requirement
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Ends
from lumped.mechanism.mechanism import Mechanism
from lumped.models import serial_chains
from lumped.models.bodies import legs_of, on_equivalent_legs
from meshes.section.section_mesh import section_mesh
from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Matrix
from validation.adequacy.mechanism.path import robot_at
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.statics import compliances
from validation.adequacy.mechanism.vibration import vibration_of
from validation.adequacy.models import JUDGED
from validation.adequacy.partners import partners
from validation.adequacy.robot import robot_subject, static_subject
from validation.context import Context
from validation.models.mechanism import mechanism_modes
from validation.models.options import ModelOptions
from validation.solids.legs import COARSEST_WALLS, section_counts, static_ladder, static_slices

POSTURES = 9
# Modes judged, and looked at besides.
COUNT, OFFERED = 4, 12
# Unknowns of the section meshes that the quick reference, of fewer, is held against.
FINER = 1900
MODELS = ("simplified", "vjm", "beam", "segments-euler-bernoulli")
# Several limits, so that verdicts of all kinds come up.
LIMITS = (0.003, 0.02, 0.1)


def with_ends(robot: Mechanism, ends: Ends) -> Mechanism:
    """The same robot with its ends said; legs are constant ones."""
    robot = on_equivalent_legs(robot)
    said = {
        name: replace(body, shape=replace(body.shape, ends=ends))
        for name, body in robot.bodies.items()
        if isinstance(body.shape, ConstantLeg)
    }
    return replace(robot, bodies={**robot.bodies, **said})


def ends_of(robot: Mechanism) -> Ends:
    """How the ends of all legs are said to be held."""
    (ends,) = {
        one.shape.ends for one in robot.bodies.values() if isinstance(one.shape, ConstantLeg)
    }
    assert ends
    return ends


def chosen(count: int, chunk: int) -> Iterator[Mechanism]:
    """So many robots with solid legs, of every shape in turn, ends rigid and free by turns."""
    found = [robots(count // len(SHAPES), chunk, shape) for shape in SHAPES]
    for number, robot in enumerate(robot for group in zip(*found, strict=True) for robot in group):
        yield with_ends(robot, "rigid" if number % 2 else "free")


def static_matrices(robot: Mechanism) -> list[Matrix]:
    """Statics of some models, judged with several limits."""
    context = Context(file_of(robot), "quick")
    posed = robot_at(context, placed_at(context.robot_file.mechanism, *stations(robot, POSTURES)))
    subject = static_subject(posed, {name: JUDGED[name] for name in MODELS})
    return [judged(subject, Requirement(deflection=limit)) for limit in LIMITS]


def finest_statics(robot: Mechanism) -> Array:
    """Compliances (p×6×6) with solid legs on finer meshes, by virtual joints."""
    springs = {}
    for name, leg in legs_of(robot).items():
        assert isinstance(leg, ConstantLeg)
        divisions = (static_ladder(leg, FINER) or (COARSEST_WALLS,))[-1]
        mesh = section_mesh(leg.section, section_counts(leg, divisions))
        condensed = doubling.condensed_leg(leg, mesh, static_slices(leg, divisions))
        springs[name] = doubling.tip_compliance(condensed, ends_of(robot))
    places = placed_at(robot, *stations(robot, POSTURES))
    return np.array([serial_chains.compliance(at, springs) for at in places])


def contradictions(matrix: Matrix, errors: dict[tuple[str, str], Array]) -> list[str]:
    """Verdicts that errors computed otherwise do not bear out, beyond the stated uncertainty."""
    found = []
    for (model, quantity), direct in errors.items():
        entry = matrix.entry(model, quantity)
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


def wrong_in_statics(robot: Mechanism) -> list[str]:
    """What the finest statics contradict."""
    expected = finest_statics(robot)
    places = placed_at(robot, *stations(robot, POSTURES))
    errors = {}
    for name in MODELS:
        model, _, options = JUDGED[name]
        found = compliances(places, model, options)
        errors |= {(name, q): error for q, error in plain_errors(found, expected).items()}
    return [line for matrix in static_matrices(robot) for line in contradictions(matrix, errors)]


def wrong_in_dynamics(robot: Mechanism) -> list[str]:
    """What finer solids contradict of frequencies by segments, where both pair a mode alike."""
    places, samples = placed_at(robot, *stations(robot, POSTURES)), samples_of(robot)
    finer = ModelOptions(divisions=4, ends=ends_of(robot))
    reference, segments = (
        vibration_of(samples, mechanism_modes(model, places, OFFERED, options), OFFERED)
        for model, options in (("solid", finer), ("segments", ModelOptions()))
    )
    pairs = partners(reference, segments, samples.weights, COUNT)
    off = pairs.frequency / reference.frequencies[:, :COUNT] - 1.0
    sure = (pairs.likeness > 0.9).all(axis=0)
    errors = {("segments", f"f{k + 1}"): off[:, k] for k in range(COUNT) if sure[k]}
    subject = robot_subject(Context(file_of(robot), "quick"))
    matrices = (judged(subject, Requirement(frequency=limit, modes=COUNT)) for limit in LIMITS)
    return [line for matrix in matrices for line in contradictions(matrix, errors)]


@pytest.mark.exhaustive
def test_verdicts_are_those_of_errors_computed_directly() -> None:
    # One of rectangles and one of walls.
    for robot in islice(chosen(len(SHAPES), chunk=11), 2):
        assert not wrong_in_statics(robot), robot


@pytest.mark.soak
@pytest.mark.parametrize("chunk", range(8))
def test_no_verdict_on_forty_robots_is_contradicted(chunk: int) -> None:
    """Five robots, one of each shape, in every chunk."""
    for robot in chosen(len(SHAPES), chunk=20 + chunk):
        assert not wrong_in_statics(robot), robot
        assert not wrong_in_dynamics(robot), robot
