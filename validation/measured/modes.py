"""Modes of a modal test as measured values, paired with the modes of a model.

Input: a robot file and a universal or CSV file of a test. Output: measured frequencies and
responses, each with the number of its partner among the modes of the model. Rule: shapes are
compared at the measured points along the measured axes by their MAC with equal weights. Modes are
paired so that the sum of all MAC is largest. Partners have a MAC of at least 0.8.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from math import hypot
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lumped.acceptance.measured import Freedoms, Measured, ModalTest
from lumped.acceptance.quantities import FREQUENCIES, MOST_MODES
from lumped.arrays import Array
from lumped.dense.modes import FewerModesError
from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.memo import memo
from lumped.robot_file.load import RobotFile, with_measured
from lumped.system.assembly import System
from lumped.system.response import DampedModes, damped_modes
from lumped.text import counted
from validation.measured.responses import measured_responses
from validation.measured.tested import SUFFIXES, read_modes
from validation.models.options import DEFAULT_OPTIONS, STATIC, ModelName, ModelOptions
from validation.models.robot_models import PostureModes, mechanism_modes
from validation.responses.mode_pairing import (
    equal_frequency_groups,
    pair_modes,
    sampled_modes,
    space_mac,
)

# Smallest MAC of partners. Partners usually have 0.9 and other modes 0.1; sensors a few centimetres
# from their stated position reduce it by a tenth.
LEAST_MAC = 0.8
# If the frequency of one of several modes of similar shape is within this ratio of the measured
# frequency, modes farther away are excluded. Bending rods of a Delta robot drag the platform along,
# so that their modes look like platform modes far below.
_NEAR_RATIO = 1.5
# Modes of a model are computed up to _SEARCH_RATIO times the highest measured frequency: first
# _FIRST_COUNT of them, at most _LARGEST_COUNT.
_SEARCH_RATIO, _FIRST_COUNT, _LARGEST_COUNT = 1.5, 8, 64
# A mode moves the measured points only by round-off if their motion is below this fraction of that
# in the mode with the largest motion.
_INVISIBLE = 1e-6


class Partner(NamedTuple):
    """Mode of a model that is the partner of a measured mode.

    `number` counts from 1; `frequency` in Hz; `mac` is that of the two shapes. `reason`: why the
    two modes cannot be compared. "" if they can.
    """

    number: int
    frequency: float
    mac: float
    reason: str


def with_measured_file(robot_file: RobotFile, path: Path) -> RobotFile:
    """Robot file extended by the measured values of a CSV or universal file.

    Modes get the numbers of their partners in the beam model; modes without a partner are omitted.
    Raises InputError with one line per fault.
    """
    if path.suffix.lower() not in SUFFIXES:
        return with_measured(robot_file, path)
    if (hammer := robot_file.hammer) is None:
        raise InputError(
            f"{path}: the robot file {robot_file.source} must have [hammer] with the "
            "positions of the nodes"
        )
    tested = read_modes(path)
    numbers = tested.freedoms[:, 0]
    located = np.isin(numbers, list(hammer.nodes))
    all_nodes = counted(len(set(numbers)), "node")
    if not located.any():
        raise InputError(
            f"{path}: none of the {all_nodes} of the test is listed in [hammer.nodes] of "
            f"{robot_file.source}"
        )
    sizes = np.abs(tested.poles)
    test = ModalTest(
        hammer.pose,
        hammer.freedoms(tested.freedoms[located]),
        tested.shapes[located],
        sizes / (2.0 * np.pi),
        -tested.poles.real / sizes,
    )
    partners = modal_prediction("beam", robot_file.mechanism, test, DEFAULT_OPTIONS).partners
    paired = [
        (c, partner.number)
        for c, partner in enumerate(partners)
        if partner and partner.number <= MOST_MODES
    ]
    if not paired:
        all_modes = counted(len(partners), "mode")
        raise InputError(
            f"{path}: none of the {all_modes} above 0 Hz has a partner among the modes of the "
            "beam model"
        )
    source = (
        f"{path.name}, {len(paired)} of {counted(len(partners), 'mode')}, "
        f"{len(set(numbers[located]))} of {all_nodes}"
    )
    values = []
    for column, number in paired:
        value = float(test.frequencies[column])
        spread = hypot(tested.scatter[0, column], hammer.uncertainty * value)
        values.append(
            Measured(FREQUENCIES[number - 1], value, spread, source, test.pose, 1.0, test, column)
        )
    # A response at a mode requires the damping ratio.
    if test.ratios.all():
        values += measured_responses(
            tested, test, dict(paired), hammer, robot_file.mechanism, path.name
        )
    return replace(robot_file, measured=(*robot_file.measured, *values))


class ModalPrediction(NamedTuple):
    """Results of a model for a modal test: `partners` of the test's modes, and `responses`.

    `responses` contains, for each measured response, the damped modes with their residues. Both are
    empty for a model without frequencies.
    """

    partners: list[Partner | None]
    responses: list[DampedModes]


@memo(64)
def modal_prediction(
    model: ModelName, robot: Mechanism, test: ModalTest, options: ModelOptions
) -> ModalPrediction:
    """Partners of a test's modes in a model, and the model's responses for the test."""
    partners: list[Partner | None] = [None] * len(test.frequencies)
    if model in STATIC:
        return ModalPrediction(partners, [])
    postures, count = [posture(robot, np.array(test.pose))], _FIRST_COUNT
    solution = _modes(model, postures, count, options)
    highest = _SEARCH_RATIO * test.frequencies.max(initial=0.0)
    while (
        len(solution.modes.frequencies) == count < _LARGEST_COUNT
        and solution.modes.frequencies[-1] < highest
    ):
        count *= 2
        solution = _modes(model, postures, count, options)
    motions = _motions(solution.system, solution.modes.shapes, test.at)
    sizes = np.linalg.norm(motions, axis=0)
    visible = np.flatnonzero(sizes > _INVISIBLE * sizes.max(initial=0.0))
    # Modes of equal frequency are compared as a space. A measured mode that does not move the
    # points of known position has no partner.
    frequencies = solution.modes.frequencies[visible]
    measured = sampled_modes(test.frequencies, test.shapes)
    modelled = sampled_modes(frequencies, motions[:, visible])
    mac = space_mac(measured, modelled)
    similar, spaces = mac >= LEAST_MAC, equal_frequency_groups(frequencies)
    ratios = np.divide.outer(test.frequencies, frequencies)
    near = similar & (np.maximum(ratios, 1.0 / ratios) < _NEAR_RATIO)
    excluded = similar & ~near & near.any(axis=1, keepdims=True)
    mac[excluded] = 0.0
    pairs = pair_modes(measured, modelled, excluded=excluded)
    for column, nearest in enumerate(pairs.nearest):
        if nearest >= 0:
            similar_modes, partner_mac = mac[column] >= LEAST_MAC, float(mac[column, nearest])
            reason = ""
            if partner_mac < LEAST_MAC:
                reason = (
                    f"not paired: MAC {partner_mac:.2f} is below {LEAST_MAC}; another mode, "
                    "or wrong positions of the nodes"
                )
            elif len(set(spaces[similar_modes])) > 1 or (
                len(motions) == 1 and not near[column].any()
            ):
                listed = ", ".join(f"f{number + 1}" for number in visible[similar_modes])
                reason = (
                    f"modes {listed} of the model have the same shape at the measured points; "
                    "measure at more points"
                )
            partners[column] = Partner(
                int(visible[nearest]) + 1, float(frequencies[nearest]), partner_mac, reason
            )
    if model != "simplified":
        partners = _without_verdicts_if_most_misfit(partners)
    return ModalPrediction(
        partners, _responses(robot, solution, test, partners) if test.responses else []
    )


def _without_verdicts_if_most_misfit(partners: Sequence[Partner | None]) -> list[Partner | None]:
    """Partners of the measured modes, without verdicts if most of the modes have no good partner.

    Each partner then gets a reason why it cannot be compared. If nodes of the test are mistaken for
    each other, some pairs of modes are similar by chance only.
    """
    misfits = sum(partner is None or partner.mac < LEAST_MAC for partner in partners)
    if 2 * misfits <= len(partners):
        return list(partners)
    reason = (
        f"{misfits} of {counted(len(partners), 'mode')} of the test have no partner in "
        "the model; check for exchanged nodes and the positions in [hammer.nodes]"
    )
    return [
        partner and (partner if partner.reason else partner._replace(reason=reason))
        for partner in partners
    ]


def _responses(
    robot: Mechanism, solution: PostureModes, test: ModalTest, partners: Sequence[Partner | None]
) -> list[DampedModes]:
    """Damped modes with the residues of each measured response.

    If the robot is undamped, its modes get the measured damping.
    """
    unit = np.eye(solution.system.size)
    outputs = np.vstack(
        [_motions(solution.system, unit, response.ends) for response in test.responses]
    )
    # Partners in a model that is too stiff lie far above the measured frequencies.
    highest = max([*test.frequencies, *(partner.frequency for partner in partners if partner)])
    damped = damped_modes(solution.solution, _SEARCH_RATIO * highest, outputs)
    if not robot.is_damped:
        ratios = np.full(len(damped.residues), test.ratios.mean())
        for ratio, partner in zip(test.ratios, partners, strict=True):
            if partner:
                ratios[partner.number - 1] = ratio
        damped = replace(damped, ratio=ratios)
    output_rows = range(0, len(outputs), 2)
    return [
        replace(
            damped,
            residues=damped.residues[:, row, row + 1],
            rate_residues=damped.rate_residues[:, row, row + 1],
        )
        for row in output_rows
    ]


def _modes(
    model: ModelName, postures: Sequence[Posture], count: int, options: ModelOptions
) -> PostureModes:
    """Lowest `count` modes, or all modes of a robot of rigid bodies that has fewer."""
    for existing in range(count, 1, -1):
        with suppress(FewerModesError):
            return mechanism_modes(model, postures, existing, options)[0]
    return mechanism_modes(model, postures, 1, options)[0]


def _motions(system: System, shapes: Array, freedoms: Freedoms) -> Array:
    """Displacements (k×m) of k measured points, along the measured axes, in m mode `shapes` (n×m).

    Shapes: n unknowns.
    """
    rows = []
    for body, position, direction in zip(
        freedoms.bodies, freedoms.places, freedoms.directions, strict=True
    ):
        frame = system.posture.frames[body]
        if body in system.models:
            field = system.models[body].displacements(position[None]).toarray()
            motion = frame.rotation @ (field @ system.body_unknowns(body, shapes))
        else:
            point = next(iter(system.posture.mechanism.bodies[body].interfaces))
            point_position = frame.position + frame.rotation @ position
            motion = system.motions.at(body, point, point_position)[:3] @ shapes[: system.outer]
        rows.append(direction @ motion)
    return np.array(rows)
