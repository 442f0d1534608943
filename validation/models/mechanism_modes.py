"""Natural modes of a mechanism with what carries their strain energy, posture by posture."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from lumped.arrays import Array
from lumped.dense.modes import Modes
from lumped.errors import InputError
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.system.assembly import Assembly, System, assembly
from lumped.system.joint_motion import Portion
from lumped.system.solution import (
    Solved,
    compliance,
    modes_with_mass,
    solved,
    strain_shares,
    too_few,
)
from validation.models.mechanism import (
    as_printed,
    dynamic_bodies,
    highest_frequency,
    on_drives_alone,
)
from validation.models.options import DEFAULT_OPTIONS, STATIC, ModelName, ModelOptions
from validation.solids.leg_models import renewed_where_needed


@dataclass(frozen=True, eq=False)
class PostureModes:
    """The lowest modes of a mechanism in one posture, idle motions left out."""

    posture: Posture
    solution: Solved
    modes: Modes

    @property
    def system(self) -> System:
        """The assembled mechanism."""
        return self.solution.system

    @property
    def idle(self) -> int:
        """Number of mobilities that do not move the tool."""
        return self.solution.idle

    @cached_property
    def compliance(self) -> Array:
        """6×6 (SI, base axes) at the loaded point; raises as `lumped.system.solution` does."""
        return compliance(self.solution)

    @cached_property
    def strain(self) -> Mapping[Portion, Array]:
        """Share of each mode's strain energy in every drive, body and elastic part of a joint.

        Of a body by kind of deformation where its model knows it; those of a mode sum to 1.
        """
        return strain_shares(self.system, self.modes.shapes)


def mechanism_modes(
    model: ModelName,
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> list[PostureModes]:
    """The lowest `count` modes in each posture of one mechanism; of rigid bodies as many as are.

    Raises InputError for a static model, ComputationError where the tool is free to move and where
    fewer modes have mass.
    """
    if model in STATIC:
        raise InputError(f"--modes: the {model} model is static and has no frequencies")
    if not postures:
        return []
    if model == "simplified":
        return list(modes_on_drives(postures, count))
    mechanism = postures[0].mechanism
    if options.release == "printed":
        printed = as_printed(mechanism)
        postures = [replace(at, mechanism=printed) for at in postures]
    return renewed_where_needed(
        highest_frequency(postures, count, options),
        partial(_of_bodies, model, mechanism, postures, count, options),
        frequencies=lambda found: np.array([one.modes.frequencies for one in found]),
    )


def modes_on_drives(postures: Sequence[Posture], count: int) -> Iterator[PostureModes]:
    """At most `count` modes of rigid bodies on elastic drives, as many as have mass."""
    rigid = on_drives_alone(postures[0].mechanism)
    return modes_along(assembly(rigid, {}), postures, count)


def modes_along(
    prepared: Assembly, postures: Sequence[Posture], count: int
) -> Iterator[PostureModes]:
    """At most `count` modes in each posture, as many as have mass; one posture after the other."""
    for posture in postures:
        solution = solved(prepared.at(posture))
        yield PostureModes(posture, solution, modes_with_mass(solution, count))


def _of_bodies(
    model: ModelName,
    mechanism: Mechanism,
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions,
    highest: float,
) -> list[PostureModes]:
    bodies = dynamic_bodies(model, mechanism, highest, options)
    found = list(modes_along(assembly(postures[0].mechanism, bodies), postures, count))
    if any(len(one.modes.frequencies) < count for one in found):
        raise too_few(mechanism.name, count)
    return found
