"""Compliance and modes of any mechanism by each model, in its postures.

Input: postures of one mechanism, name and options of a model. Output: 6×6 compliance at the loaded
point, natural frequencies and modes. Rule: the cut-off frequency of reduced bodies is raised until
it covers the requested modes.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import ceil, log2
from typing import TypeVar

import numpy as np

from lumped.arrays import Array
from lumped.dense.modes import Modes, too_few
from lumped.errors import InputError
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.memo import memo
from lumped.models import serial_chains
from lumped.models.bodies import legs_of
from lumped.system.assembly import Assembly, System, assembly
from lumped.system.joint_motion import Portion
from lumped.system.response import DampedModes, HarmonicResponse, damped_modes, harmonic_responses
from lumped.system.solution import (
    Solved,
    compliance,
    modes,
    modes_with_mass,
    solved,
    strain_shares,
)
from lumped.system.sweep import Swept, swept
from validation.models.leg_models import leg_matrices
from validation.models.options import DEFAULT_OPTIONS, STATIC, ModelName, ModelOptions
from validation.models.robot_bodies import (
    FINE_PARTS,
    PartMeshing,
    bodies_of,
    on_drives_alone,
    reduced_bodies,
    released,
    springs_of,
    static_assembly,
    unreduced_bodies,
)

T = TypeVar("T")
# Number of frequencies that are compared one by one.
JUDGED_MODES = 4
# Coarse beams for estimates: their frequencies lie above the true ones (Rayleigh), and frequencies
# of solids are hardly higher than those.
_ESTIMATE = ModelOptions(elements=2)


def answers(
    model: ModelName,
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> Swept:
    """Compliance and the lowest `count` frequencies of one mechanism in each posture.

    Frequencies exclude the zero frequencies of idle motions, which do not move the tool.
    `simplified` has at most `count` frequencies: as many as its rigid bodies have elastic motions.
    In postures with fewer of them than in others, the missing ones are infinite. Raises InputError
    for frequencies of a static model and for a leg that is not a serial chain (vjm), and
    ComputationError if the tool is free to move.
    """
    if not postures:
        return Swept(np.zeros((0, 6, 6)), np.zeros((0, count)), ())
    mechanism = postures[0].mechanism
    if count:
        _require_dynamic_model(model)
    if model == "vjm":
        springs = springs_of(mechanism, options)
        return Swept(
            np.array([serial_chains.compliance(posture, springs) for posture in postures]),
            np.zeros((len(postures), 0)),
            tuple(mobility(posture).idle for posture in postures),
        )
    if not count:
        return swept(static_assembly(model, postures, options), released(postures, options), 0)
    if model == "simplified":
        results = list(modes_on_drives(postures, count))
        rows = [result.modes.frequencies for result in results]
        longest = max(map(len, rows))
        return Swept(
            np.array([result.compliance for result in results]),
            np.array(
                [np.pad(row, (0, longest - len(row)), constant_values=np.inf) for row in rows]
            ),
            tuple(result.idle for result in results),
        )
    postures = released(postures, options)
    released_mechanism = postures[0].mechanism
    return with_dynamic_bodies(
        model,
        mechanism,
        lambda bodies: swept(assembly(released_mechanism, bodies), postures, count),
        lambda results: results.frequencies,
        postures,
        count,
        options,
    )


@dataclass(frozen=True, eq=False)
class PostureModes:
    """Compliance and lowest modes of a mechanism in one posture. Idle motions are omitted.

    `compliance` (6×6, SI, base axes) at the loaded point.
    """

    posture: Posture
    solution: Solved
    compliance: Array
    modes: Modes

    @property
    def system(self) -> System:
        """Assembled system of the mechanism."""
        return self.solution.system

    @property
    def idle(self) -> int:
        """Number of mobilities that do not move the tool."""
        return self.solution.idle

    def first(self, count: int) -> "PostureModes":
        """Solution with the first `count` modes only."""
        frequencies, shapes = self.modes.frequencies[:count], self.modes.shapes[:, :count]
        return replace(self, modes=Modes(frequencies, shapes))

    @cached_property
    def strain(self) -> Mapping[Portion, Array]:
        """Shares (m) of m modes' strain energies in each drive, body and elastic part of a joint.

        Shares of a body are listed by kind of deformation if its model distinguishes kinds. The
        shares of a mode sum to 1.
        """
        return strain_shares(self.system, self.modes.shapes)

    @cached_property
    def damped(self) -> DampedModes:
        """Complex modes, accurate up to the highest frequency of the undamped modes."""
        return damped_modes(self.solution, float(self.modes.frequencies.max(initial=0.0)))

    @cached_property
    def responses(self) -> tuple[HarmonicResponse, ...]:
        """Responses to each excitation of the mechanism."""
        return harmonic_responses(self.solution)


def mechanism_modes(
    model: ModelName,
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
    part_mesh: PartMeshing = FINE_PARTS,
    spare: int = 0,
) -> list[PostureModes]:
    """Lowest `count` modes of one mechanism in each posture. `simplified` may have fewer.

    `part_mesh`: mesh and coupling of CAD parts as solids. `spare`: number of modes that are
    computed in addition, as far as they exist. The cut-off frequency of the reduction is not raised
    for them.

    Raises InputError for a static model, and ComputationError if the tool is free to move or, for
    any model except `simplified`, fewer than `count` modes move mass.
    """
    _require_dynamic_model(model)
    if not postures:
        return []
    mechanism = postures[0].mechanism
    if model == "simplified":
        return list(modes_on_drives(postures, count))
    postures = released(postures, options)

    def solve(bodies: Mapping[str, BodyModel]) -> list[PostureModes]:
        prepared = assembly(postures[0].mechanism, bodies)
        solutions = list(modes_along(prepared, postures, count + spare))
        if any(len(solution.modes.frequencies) < count for solution in solutions):
            raise too_few(mechanism.name, count)
        return solutions

    return with_dynamic_bodies(
        model,
        mechanism,
        solve,
        lambda solutions: np.array([solution.modes.frequencies[:count] for solution in solutions]),
        postures,
        count,
        options,
        part_mesh,
    )


def modes_on_drives(postures: Sequence[Posture], count: int) -> Iterator[PostureModes]:
    """Lowest `count` modes of rigid bodies on elastic drives. All modes if fewer move mass."""
    rigid = on_drives_alone(postures[0].mechanism)
    return modes_along(assembly(rigid, {}), postures, count)


def modes_along(
    prepared: Assembly, postures: Sequence[Posture], count: int
) -> Iterator[PostureModes]:
    """Lowest `count` modes of an assembly in each posture. All modes if fewer move mass.

    Raises ComputationError if round-off dominates the compliance at the loaded point: the
    frequencies of the system would be as wrong as its compliance, without any sign of it.
    """
    for system in prepared.along(postures):
        solution = solved(system)
        at_tool = compliance(solution)
        yield PostureModes(system.posture, solution, at_tool, modes_with_mass(solution, count))


def with_enough_modes(
    solve: Callable[[float], T],
    frequencies: Callable[[T], Array],
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> T:
    """Solution by `solve` with bodies reduced up to a frequency (Hz) that covers `count` modes.

    The first estimate of that frequency is by beams. Restrained warping of open sections can raise
    frequencies far above it. Therefore `solve` is repeated until the `frequencies` of the solution
    lie below the limit of the reduction. More modes in the reduction only lower frequencies
    (Rayleigh), so the second reduction suffices, apart from round-off.
    """
    highest = highest_frequency(postures, count, options)
    while (highest_solved := float(np.max(frequencies(solution := solve(highest))))) > highest:
        highest = _half_octave_above(highest_solved)
    return solution


def with_dynamic_bodies(
    model: ModelName,
    mechanism: Mechanism,
    solve: Callable[[Mapping[str, BodyModel]], T],
    frequencies: Callable[[T], Array],
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
    part_mesh: PartMeshing = FINE_PARTS,
) -> T:
    """Solution by `solve` with models of the bodies of `mechanism`, accurate for `count` modes.

    Bodies that are not reduced have all their modes, and are solved once. If bodies are reduced,
    `solve` is repeated as in `with_enough_modes`, until the `frequencies` of its solution lie below
    the limit of the reduction. `part_mesh`: mesh and coupling of CAD parts as solids.
    """
    if unreduced := unreduced_bodies(model, mechanism, options):
        return solve(unreduced)
    return with_enough_modes(
        lambda highest: solve(reduced_bodies(model, mechanism, highest, options, part_mesh)),
        frequencies,
        postures,
        count,
        options,
    )


def highest_frequency(
    postures: Sequence[Posture], count: int, options: ModelOptions = DEFAULT_OPTIONS
) -> float:
    """Frequency (Hz) up to which bodies must be accurate for `count` modes, by coarse beams.

    The estimate is made in the middle posture and covers the frequencies of all excitations. It is
    rounded up in steps of half an octave, so that other postures and counts can use the same
    bodies.
    """
    middle = postures[len(postures) // 2]
    # An element adds six modes to a leg, half of which are close to the true ones.
    legs = max(1, len(legs_of(middle.mechanism)) + len(middle.mechanism.parts))
    coarse = replace(
        _ESTIMATE,
        equivalent=options.equivalent,
        theory=options.theory,
        elements=max(_ESTIMATE.elements, ceil(count / (3 * legs))),
    )
    return _highest_by_beams(middle, count, coarse)


@memo(64)
def _highest_by_beams(middle: Posture, count: int, coarse: ModelOptions) -> float:
    bodies = bodies_of(middle.mechanism, coarse, partial(leg_matrices, "beam"))
    solution = solved(assembly(middle.mechanism, bodies).at(middle))
    # Rigid bodies and condensed CAD parts may have fewer than `count` modes with mass.
    only_legs = legs_of(middle.mechanism) and not middle.mechanism.parts
    frequencies = (modes if only_legs else modes_with_mass)(solution, count).frequencies
    if not len(frequencies):
        raise too_few(middle.mechanism.name, count)
    excited = [excitation.last for excitation in middle.mechanism.excitations]
    return _half_octave_above(max([float(frequencies[-1]), *excited]))


def _half_octave_above(frequency: float) -> float:
    return float(2.0 ** (0.5 * ceil(2.0 * log2(frequency))))


def _require_dynamic_model(model: ModelName) -> None:
    if model in STATIC:
        raise InputError(
            f"--modes: model {model} is static and has no frequencies; leave --modes out or "
            "choose another --model"
        )
