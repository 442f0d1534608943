"""Natural modes of a mechanism with what carries their strain energy, posture by posture."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from lumped.arrays import Array
from lumped.dense.modes import Modes
from lumped.errors import InputError
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.system.assembly import System, assembly
from lumped.system.joint_motion import Portion
from lumped.system.solution import compliance, mode_count, modes, solved, strain_shares
from validation.models.mechanism import (
    as_printed,
    dynamic_bodies,
    highest_frequency,
    on_drives_alone,
)
from validation.models.options import DEFAULT_OPTIONS, STATIC, ModelName, ModelOptions
from validation.solids.robots import renewed_where_needed


@dataclass(frozen=True, eq=False)
class PostureModes:
    """The lowest modes of a mechanism in one posture.

    `compliance` (6×6, SI, base axes) at the loaded point, `idle` the number of mobilities that do
    not move the tool. `strain` maps every drive, every elastic part of a joint and every body, by
    kind of deformation where its model knows it, to its share of each mode's strain energy; the
    shares of a mode sum to 1.
    """

    posture: Posture
    system: System
    compliance: Array
    modes: Modes
    idle: int
    strain: Mapping[Portion, Array]


def mechanism_modes(
    model: ModelName,
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> list[PostureModes]:
    """The lowest `count` modes in each posture of one mechanism; of rigid bodies as many as are.

    Raises InputError for a static model, ComputationError where the tool is free to move.
    """
    if model in STATIC:
        raise InputError(f"--modes: the {model} model is static and has no frequencies")
    if not postures:
        return []
    if model == "simplified":
        rigid = on_drives_alone(postures[0].mechanism)
        prepared = assembly(rigid, {})
        return [
            posture_modes(prepared.at(replace(at, mechanism=rigid)), at, count) for at in postures
        ]
    mechanism = postures[0].mechanism
    if options.release == "printed":
        printed = as_printed(mechanism)
        postures = [replace(at, mechanism=printed) for at in postures]
    return renewed_where_needed(
        highest_frequency(postures, count, options),
        partial(_of_bodies, model, mechanism, postures, count, options),
        frequencies=lambda found: np.array([one.modes.frequencies for one in found]),
    )


def _of_bodies(
    model: ModelName,
    mechanism: Mechanism,
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions,
    highest: float,
) -> list[PostureModes]:
    bodies = dynamic_bodies(model, mechanism, highest, options)
    prepared = assembly(postures[0].mechanism, bodies)
    return [posture_modes(prepared.at(at), at, count) for at in postures]


def posture_modes(system: System, posture: Posture, count: int) -> PostureModes:
    """The lowest `count` modes of an assembled system; of rigid bodies as many as there are."""
    solution = solved(system)
    wanted = count if system.models else min(count, mode_count(solution))
    found = modes(solution, wanted) if wanted else Modes(np.zeros(0), np.zeros((system.size, 0)))
    return PostureModes(
        posture=posture,
        system=system,
        compliance=compliance(solution),
        modes=found,
        idle=solution.idle,
        strain=strain_shares(system, found.shapes),
    )
