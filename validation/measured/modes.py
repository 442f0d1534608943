"""Modes of a test as measured values, and which mode of a model each of them is.

Shapes are compared at the points and along the axes that were measured (modal assurance criterion,
all weighing alike) and paired so that likeness is largest in all.
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
from validation.measured.responses import responses_of
from validation.measured.tested import SUFFIXES, read_modes
from validation.models.options import DEFAULT_OPTIONS, STATIC, ModelName, ModelOptions
from validation.models.robot_models import PostureModes, mechanism_modes
from validation.responses.mode_pairing import (
    one_frequency,
    pair_modes,
    sampled_modes,
    space_likeness,
)

# From here on two shapes are one mode: 0.9 is usual of modes that belong together, 0.1 of others,
# and sensors a few centimetres off take a tenth away.
LEAST_MAC = 0.8
# Where one of the modes that look alike is nearer than so many times in frequency, the others are
# none: rods of a Delta that bend drag the platform along, whose modes look the same far below.
_OFF = 1.5
# How far above the highest measured frequency modes of a model are looked at, and how many at most.
_ABOVE, _FIRST, _AT_MOST = 1.5, 8, 64
# Motion of all points, of the largest of any mode, below which there is rounding alone.
_UNSEEN = 1e-6


class Partner(NamedTuple):
    """The mode of a model that a measured one is: its `number` (from 1) and `frequency` (Hz).

    `mac` is the likeness of the two; `reason` says why they are not held against each other.
    """

    number: int
    frequency: float
    mac: float
    reason: str


def with_measured_file(robot_file: RobotFile, path: Path) -> RobotFile:
    """The robot file with what a CSV or universal file says was measured, after its own values.

    Modes have the numbers that they have in the beam model; those that have none there are left
    out. Raises InputError with one line per fault.
    """
    if path.suffix.lower() not in SUFFIXES:
        return with_measured(robot_file, path)
    if (hammer := robot_file.hammer) is None:
        raise InputError(f"{path}: {robot_file.source} must say in [hammer] where its nodes are")
    found = read_modes(path)
    numbers = found.freedoms[:, 0]
    known = np.isin(numbers, list(hammer.nodes))
    all_nodes = counted(len(set(numbers)), "node")
    if not known.any():
        raise InputError(
            f"{path}: [hammer.nodes] of {robot_file.source} has none of its {all_nodes}"
        )
    sizes = np.abs(found.poles)
    test = ModalTest(
        hammer.pose,
        hammer.freedoms(found.freedoms[known]),
        found.shapes[known],
        sizes / (2.0 * np.pi),
        -found.poles.real / sizes,
    )
    partners = modal_answer("beam", robot_file.mechanism, test, DEFAULT_OPTIONS).partners
    paired = [(c, one.number) for c, one in enumerate(partners) if one and one.number <= MOST_MODES]
    if not paired:
        all_modes = counted(len(partners), "mode")
        raise InputError(f"{path}: none of its {all_modes} above 0 Hz is one of the beam model's")
    source = (
        f"{path.name}, {len(paired)} of {counted(len(partners), 'mode')}, "
        f"{len(set(numbers[known]))} of {all_nodes}"
    )
    ones = []
    for column, number in paired:
        value = float(test.frequencies[column])
        spread = hypot(found.scatter[0, column], hammer.uncertainty * value)
        ones.append(
            Measured(FREQUENCIES[number - 1], value, spread, source, test.pose, 1.0, test, column)
        )
    # Without damping ratios no response can be read at a mode.
    if test.ratios.all():
        ones += responses_of(found, test, dict(paired), hammer, robot_file.mechanism, path.name)
    return replace(robot_file, measured=(*robot_file.measured, *ones))


class ModalAnswer(NamedTuple):
    """What a model says of a test: `partners` of its modes, damped modes as `responses` feel them.

    A static model has neither.
    """

    partners: list[Partner | None]
    responses: list[DampedModes]


@memo(64)
def modal_answer(
    model: ModelName, robot: Mechanism, test: ModalTest, options: ModelOptions
) -> ModalAnswer:
    """What a model says of a test."""
    partners: list[Partner | None] = [None] * len(test.frequencies)
    if model in STATIC:
        return ModalAnswer(partners, [])
    at, count = [posture(robot, np.array(test.pose))], _FIRST
    found = _modes(model, at, count, options)
    highest = _ABOVE * test.frequencies.max(initial=0.0)
    while (
        len(found.modes.frequencies) == count < _AT_MOST and found.modes.frequencies[-1] < highest
    ):
        count *= 2
        found = _modes(model, at, count, options)
    moved = _motions(found.system, found.modes.shapes, test.at)
    sizes = np.linalg.norm(moved, axis=0)
    seen = np.flatnonzero(sizes > _UNSEEN * sizes.max(initial=0.0))
    # Modes of one frequency are compared as a space. A measured mode that does not move the named
    # points is like none.
    frequencies = found.modes.frequencies[seen]
    measured = sampled_modes(test.frequencies, test.shapes)
    modelled = sampled_modes(frequencies, moved[:, seen])
    mac = space_likeness(measured, modelled)
    alike, spaces = mac >= LEAST_MAC, one_frequency(frequencies)
    ratios = np.divide.outer(test.frequencies, frequencies)
    near = alike & (np.maximum(ratios, 1.0 / ratios) < _OFF)
    excluded = alike & ~near & near.any(axis=1, keepdims=True)
    mac[excluded] = 0.0
    pairs = pair_modes(measured, modelled, excluded=excluded)
    for column, other in enumerate(pairs.nearest):
        if other >= 0:
            same, own = mac[column] >= LEAST_MAC, float(mac[column, other])
            reason = ""
            if own < LEAST_MAC:
                reason = f"another mode, or measured elsewhere: MAC {own:.2f}, must be {LEAST_MAC}"
            elif len(set(spaces[same])) > 1 or (len(moved) == 1 and not near[column].any()):
                told = ", ".join(f"f{number + 1}" for number in seen[same])
                reason = f"{told} of the model look like it where it was measured: add points"
            partners[column] = Partner(int(seen[other]) + 1, float(frequencies[other]), own, reason)
    if model != "simplified":
        partners = _unless_most_misfit(partners)
    return ModalAnswer(partners, _responses(robot, found, test, partners) if test.responses else [])


def _unless_most_misfit(partners: Sequence[Partner | None]) -> list[Partner | None]:
    """The partners, none of them judged if most modes of the test are like none of the model.

    Where nodes are swapped some pairs are alike by chance.
    """
    misfits = sum(one is None or one.mac < LEAST_MAC for one in partners)
    if 2 * misfits <= len(partners):
        return list(partners)
    reason = (
        f"{misfits} of {counted(len(partners), 'mode')} of the test are like none of the model: "
        "are nodes swapped, or elsewhere than [hammer.nodes] says?"
    )
    return [one and (one if one.reason else one._replace(reason=reason)) for one in partners]


def _responses(
    robot: Mechanism, found: PostureModes, test: ModalTest, partners: Sequence[Partner | None]
) -> list[DampedModes]:
    """Damped modes as each response feels them; where no part loses energy, damped as measured."""
    unit = np.eye(found.system.size)
    outputs = np.vstack([_motions(found.system, unit, one.ends) for one in test.responses])
    # A model that is stiff where it was measured has its partners far above what was measured.
    highest = max([*test.frequencies, *(one.frequency for one in partners if one)])
    damped = damped_modes(found.solution, _ABOVE * highest, outputs)
    if not robot.is_damped:
        ratios = np.full(len(damped.residues), test.ratios.mean())
        for ratio, partner in zip(test.ratios, partners, strict=True):
            if partner:
                ratios[partner.number - 1] = ratio
        damped = replace(damped, ratio=ratios)
    moved = range(0, len(outputs), 2)
    return [replace(damped, residues=damped.residues[:, row, row + 1]) for row in moved]


def _modes(
    model: ModelName, at: Sequence[Posture], count: int, options: ModelOptions
) -> PostureModes:
    """The lowest `count` modes, or the fewer that a robot of rigid bodies has."""
    for fewer in range(count, 1, -1):
        with suppress(FewerModesError):
            return mechanism_modes(model, at, fewer, options)[0]
    return mechanism_modes(model, at, 1, options)[0]


def _motions(system: System, shapes: Array, at: Freedoms) -> Array:
    """Motions (k×m) of shapes (n×m) where and along what they were measured (k)."""
    rows = []
    for body, place, direction in zip(at.bodies, at.places, at.directions, strict=True):
        frame = system.posture.frames[body]
        if body in system.models:
            field = system.models[body].displacements(place[None]).toarray()
            moved = frame.rotation @ (field @ system.body_unknowns(body, shapes))
        else:
            point = next(iter(system.posture.mechanism.bodies[body].interfaces))
            there = frame.position + frame.rotation @ place
            moved = system.motions.at(body, point, there)[:3] @ shapes[: system.outer]
        rows.append(direction @ moved)
    return np.array(rows)
