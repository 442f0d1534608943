"""Verdicts on robots at random, slender to stubby, against errors found by finer solids.

Statics: virtual joint method, with springs from legs on finer meshes than the reference's.
Dynamics: frequencies of the robot with finer solid legs.
"""

from dataclasses import replace

import numpy as np
import pytest
from support.oracles.verdict_rules import AXES, deflection
from support.random.random_biglides import MILD, random_robots
from support.robots.paper_robot_variants import file_of, placed_at, stations
from support.robots.robot_from_text import robot_of

from fem.bodies import doubling
from lumped.acceptance.requirement import Requirement
from lumped.models import serial_chains
from lumped.models.bodies import legs_of, on_equivalent_legs
from meshes.section.section_mesh import section_mesh
from validation.adequacy.judged_models import JUDGED, judged_models_of
from validation.adequacy.judgement import verdict_matrix
from validation.adequacy.robot_verdicts import robot_subject, static_subject
from validation.context import Context
from validation.models.options import ModelOptions
from validation.models.robot_models import mechanism_modes
from validation.references.mode_samples import samples_of
from validation.references.model_ladder import model_statics
from validation.references.modes_on_path import vibration_of
from validation.references.robot_on_path import robot_at
from validation.responses.mode_partners import partners
from validation.solids.leg_meshes import (
    COARSEST_WALLS,
    section_counts,
    static_divisions,
    static_slices,
)

POSTURES, MODES, OFFERED = 9, 4, 12
# Unknowns of the section meshes that the quick reference, of fewer, is held against.
FINER = 1900
MODELS = ("simplified", "vjm", "beam", "segments-euler-bernoulli")
# Several limits, so that verdicts of all kinds come up.
LIMITS = (0.003, 0.02, 0.1)


def robots(chunk, count, folder):
    """Yield (robot, ends): random robots with prismatic legs, alternately free and rigid ends."""
    for number, text in enumerate(random_robots(count, 100 + chunk, MILD)):
        ends = "rigid" if number % 2 else "free"
        robot = on_equivalent_legs(robot_of(text, folder).mechanism)
        bodies_with_ends = {
            name: replace(robot.bodies[name], shape=replace(leg, ends=ends))
            for name, leg in legs_of(robot).items()
        }
        yield replace(robot, bodies={**robot.bodies, **bodies_with_ends}), ends


def contradictions(subject, errors):
    """Verdicts that the true errors contradict.

    `errors` has an array over the poses for each (model, quantity).
    """
    contradicted = []
    for limit in LIMITS:
        matrix = verdict_matrix(
            subject, Requirement(deflection=limit, frequency=limit, modes=MODES)
        )
        for (model, quantity), error in errors.items():
            entry, size = matrix.entry(model, quantity), np.abs(error)
            pairs = zip(entry.highs, entry.errors, strict=True)
            half_widths = np.array([0.0 if high is None else high - error for high, error in pairs])
            # A finer mesh leaves less open than is stated. The largest over directions that were
            # tried is the largest of all, less a percent.
            wrong = {
                "adequate": (size > limit + half_widths).any(),
                "inadequate": (1.01 * size + half_widths < limit).all(),
                "undecided": (size > limit + 2.0 * half_widths).any(),
            }
            if wrong[entry.verdict]:
                contradicted.append((model, quantity, entry.verdict, limit, error, half_widths))
    return contradicted


def static_errors(robot, ends):
    springs = {}
    for name, leg in legs_of(robot).items():
        divisions = (static_divisions(leg, FINER) or (COARSEST_WALLS,))[-1]
        mesh = section_mesh(leg.section, section_counts(leg, divisions))
        condensed = doubling.condensed_leg(leg, mesh, static_slices(leg, divisions))
        springs[name] = doubling.tip_compliance(condensed, ends)
    places = placed_at(robot, *stations(robot, POSTURES))
    due = [serial_chains.compliance(posture, springs) for posture in places]
    compliances = {
        name: model_statics(places, JUDGED[name].kind, JUDGED[name].options).compliances
        for name in MODELS
    }
    return {
        (name, quantity): np.array(
            [
                deflection(C, exact, quantity)["error"]
                for C, exact in zip(compliances[name], due, strict=True)
            ]
        )
        for name in MODELS
        for quantity in (*AXES, "any_force")
    }


def frequency_errors(robot, ends):
    """Frequency errors of the segments model over the poses, for modes with a certain partner.

    Certain: MAC above 0.9 in all poses. The reference has solid legs.
    """
    places, samples = placed_at(robot, *stations(robot, POSTURES)), samples_of(robot)
    reference, segments = (
        vibration_of(samples, mechanism_modes(model, places, OFFERED, options), OFFERED)
        for model, options in (
            ("solid", ModelOptions(divisions=4, ends=ends)),
            ("segments", ModelOptions()),
        )
    )
    pairs = partners(reference, segments, MODES)
    errors = pairs.frequency / reference.frequencies[:, :MODES] - 1.0
    sure = (pairs.mac > 0.9).all(axis=0)
    return {("segments", f"f{k + 1}"): errors[:, k] for k in range(MODES) if sure[k]}


@pytest.mark.parametrize(
    ("chunk", "count"),
    [
        pytest.param(0, 1, marks=pytest.mark.exhaustive),
        *(pytest.param(chunk, 2, marks=pytest.mark.soak) for chunk in range(50)),
    ],
)
def test_static_verdicts_match_true_errors(chunk, count, tmp_path):
    """No adequate entry has a true error beyond its limit, and no inadequate entry one within."""
    for robot, ends in robots(chunk, count, tmp_path):
        context = Context(file_of(robot), "quick")
        places = placed_at(context.robot_file.mechanism, *stations(robot, POSTURES))
        robot_path = robot_at(context, places)
        models = judged_models_of(robot_path, {name: JUDGED[name] for name in MODELS})
        subject = static_subject(robot_path, models.values())
        assert not contradictions(subject, static_errors(robot, ends))


# In the fourth a mode of 1e-116 Hz was once the reference.
@pytest.mark.parametrize(
    "chunk",
    [pytest.param(chunk, marks=pytest.mark.soak) for chunk in range(20)],
)
def test_frequency_verdicts_match_true_errors(chunk, tmp_path):
    """No adequate entry has a true error beyond its limit, and no inadequate entry one within."""
    for robot, ends in robots(chunk, 2, tmp_path):
        subject = robot_subject(Context(file_of(robot), "quick"))
        assert not contradictions(subject, frequency_errors(robot, ends))
