"""Convergence studies of legs and robots over the element count, by segments and beam elements.

Input: `Responses` of a robot in one posture, and element counts. Output: a `ConvergenceStudy` of
four frequencies and three deflections of the robot or of a leg. Rule: a prismatic leg, clamped at
its root, is compared with the exact cantilever of the same theory: Huang's frequencies
(`fem.beams.beam_theory`) and its tip compliance in closed form. A robot has no closed solution; its
limit is that of the beam elements, f = f80 + (f80 − f40)/15 for fourth order in 1/n.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import ceil
from typing import TypeAlias, TypeVar

import numpy as np

from fem.beams.beam_theory import cantilever_frequencies
from fem.beams.stepped import SteppedLeg
from lumped.arrays import Array
from lumped.beam_properties import tip_compliance
from lumped.errors import InputError
from lumped.legs import ConstantLeg, SectionedLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.memo import memo
from lumped.model_choices import Theory
from lumped.models.bodies import clamped_modes, legs_of, tip_compliance_of
from lumped.system.assembly import assembly
from lumped.system.solution import Solved, compliance, modes, solved
from validation.comparisons.convergence_series import (
    TARGETS,
    ConvergenceSeries,
    fitted_orders,
    relative_errors,
)
from validation.comparisons.convergence_study import ConvergenceStudy
from validation.comparisons.discretisations import FORMULATIONS, Discretisation
from validation.models.leg_models import leg_matrices, reduced_leg
from validation.models.options import BEAM_ORDER, ModelOptions
from validation.models.robot_bodies import bodies_of
from validation.models.robot_models import highest_frequency
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import NOMINAL, Reading, RobotOnPath
from validation.responses.statics_and_modes import PathModes, Statics
from validation.run.cache import Arrays
from validation.run.executor import Executor, in_turn
from validation.run.stored_results import StoringExecutor, part_digests
from validation.uncertainty.grid_convergence import richardson
from validation.uncertainty.half_widths import MeshPolicy

H = TypeVar("H")
# Elements per leg: nearly equal steps on a logarithmic axis, with ratios of 2:1 for half-widths.
COUNTS = (1, 2, 3, 5, 8, 10, 15, 20, 30, 40, 80)
MODES = 4
DEFLECTIONS = ("x", "y", "z")
QUANTITIES = (*(f"f{number}" for number in range(1, MODES + 1)), *DEFLECTIONS)
UNITS = MODES * ("Hz",) + len(DEFLECTIONS) * ("m/N",)
# Cut-off frequency of reduced legs over the highest compared frequency: the error is 1e-11.
_CUTOFF = 16.0
# Largest element count without reduction: such legs have hardly more unknowns than reduced ones.
_WHOLE = 8
# Fraction of the largest deflection of the tool below which a deflection is round-off.
_STILL = 1e-13
# Counts from which the limit of a robot is extrapolated.
_LIMIT_COUNTS = (40, 80)

# Function that returns limits (q) of the values by a beam theory, and their half-widths (q).
Limits: TypeAlias = Callable[[Theory], tuple[Array, Array]]


@dataclass(frozen=True, eq=False)
class Discretised:
    """Solver of a leg or robot by any formulation, with any element count or mesh.

    `statics` and `modes` are functions that solve the leg or robot by a formulation; `executor`
    calls them, and `responses` stores their results. `models` are the models of the formulations
    used so far. All element counts of a formulation share one model, to which the field `elements`
    of a `Reading` passes the count. `solved`: formulations that are already solved, each with its
    element count.
    """

    responses: Responses
    statics: Callable[[Discretisation, RobotOnPath], Statics]
    modes: Callable[[Discretisation, RobotOnPath], PathModes]
    executor: Executor
    models: dict[Discretisation, Model] = field(default_factory=dict)
    solved: set[Discretisation] = field(default_factory=set)

    def values(self, discretisation: Discretisation) -> Array:
        """Frequencies (4, Hz) and deflections (3, m/N) by a formulation with its count."""
        self.solve_ahead([discretisation])
        request = self._request(discretisation)
        compliance = self.responses.required_statics(*request).compliances[0]
        frequencies = self.responses.required_modes(*request).frequencies[0]
        return np.concatenate([frequencies, np.diag(compliance)[: len(DEFLECTIONS)]])

    def solve_ahead(self, discretisations: Sequence[Discretisation]) -> None:
        """Solve all formulations, each with its count, in one call of the executor.

        Formulations that are in `solved` are omitted.
        """
        missing = [one for one in dict.fromkeys(discretisations) if one not in self.solved]
        if missing:
            self.responses.solve_ahead(list(map(self._request, missing)), self.executor)
            self.solved.update(missing)

    def _request(self, discretisation: Discretisation) -> tuple[Model, Reading]:
        formulation = discretisation.with_count(1)
        if formulation not in self.models:
            self.models[formulation] = Model(
                formulation.label,
                statics=partial(_with_elements, self.statics, formulation),
                modes=partial(_with_elements, self.modes, formulation),
                static_fields=("elements",),
                modal_fields=("elements",),
            )
        return self.models[formulation], replace(NOMINAL, elements=discretisation.count)


def storing(executor: Executor, mechanism: Mechanism) -> StoringExecutor[tuple[Statics, PathModes]]:
    """Executor that stores solutions of a mechanism or its legs, and solves what is not stored."""
    names = ("compliances", "load_displacements", "frequencies")
    return StoringExecutor(executor, part_digests(mechanism), names, _arrays, _statics_and_modes)


def _arrays(solution: tuple[Statics, PathModes]) -> dict[str, Array]:
    statics, modes = solution
    return {
        "compliances": statics.compliances,
        "load_displacements": statics.load_displacements,
        "frequencies": modes.frequencies,
    }


def _statics_and_modes(arrays: Arrays) -> tuple[Statics, PathModes]:
    statics = Statics(arrays["compliances"], arrays["load_displacements"])
    return statics, PathModes.unsampled(arrays["frequencies"])


def _with_elements(
    solve: Callable[[Discretisation, RobotOnPath], H],
    formulation: Discretisation,
    robot: RobotOnPath,
    reading: Reading,
) -> H:
    return solve(formulation.with_count(reading.elements), robot)


def leg_convergence(
    responses: Responses,
    name: str,
    leg: SectionedLeg | SteppedLeg,
    discretisations: Sequence[Discretisation] = FORMULATIONS,
    counts: Sequence[int] = COUNTS,
    executor: Executor = in_turn,
) -> ConvergenceStudy:
    """Convergence study of one leg of a robot with its root clamped.

    A leg of varying section has no closed solution; its limit is that of the beam elements.
    Raises InputError if a formulation allows none of the `counts`.
    """
    discretised = Discretised(
        responses, partial(_leg_statics, leg), partial(_leg_modes, leg), executor
    )
    if isinstance(leg, ConstantLeg):
        limits: Limits = partial(_cantilever, leg)
        reference = "exact cantilever of the same theory (Huang 1961)"
    else:
        limits, reference = partial(_beam_limit, discretised), _EXTRAPOLATED
    series = _all_series(discretised, limits, discretisations, counts)
    return convergence_study(responses, name, reference, series)


def robot_convergence(
    responses: Responses,
    discretisations: Sequence[Discretisation] = FORMULATIONS,
    counts: Sequence[int] = COUNTS,
    executor: Executor = in_turn,
) -> ConvergenceStudy:
    """Convergence study of a robot in one posture, with equal element counts in all legs.

    Raises InputError for a robot without legs, or if a formulation allows none of the `counts`.
    Raises ComputationError if the tool is free to move or fewer than four modes move mass.
    """
    mechanism, postures = responses.robot.mechanism, responses.robot.postures
    if not (legs_of(mechanism) or mechanism.parts):
        raise InputError(f"{mechanism.name}: no leg of this robot can be divided into elements")
    highest = highest_frequency(postures, MODES)
    discretised = Discretised(
        responses, partial(_robot_statics, highest), partial(_robot_modes, highest), executor
    )
    limits = partial(_beam_limit, discretised)
    series = _all_series(discretised, limits, discretisations, counts)
    return convergence_study(responses, "", _EXTRAPOLATED, series)


_EXTRAPOLATED = "limit of the beam elements, extrapolated from 40 and 80 elements"


def convergence_study(
    responses: Responses,
    subject: str,
    reference: str,
    series: Iterable[ConvergenceSeries],
) -> ConvergenceStudy:
    """Study of the leg `subject`, or of the whole robot if `subject` is "".

    `reference` names the source of the limits. The limits of agreement are those of the robot file.
    """
    robot = responses.robot
    pose: dict[str, float] = {}
    if not subject:
        moves = robot.mechanism.tool.moves
        pose = dict(zip(moves, robot.postures[0].pose.tolist(), strict=True))
    return ConvergenceStudy(
        robot=robot.mechanism.name,
        subject=subject,
        pose=pose,
        quantities=QUANTITIES,
        units=UNITS,
        reference=reference,
        series=tuple(series),
        agreement=robot.context.robot_file.agreement,
    )


def _all_series(
    discretised: Discretised,
    limits: Limits,
    discretisations: Sequence[Discretisation],
    counts: Sequence[int],
) -> tuple[ConvergenceSeries, ...]:
    """Series of each formulation in `discretisations`, over those `counts` that it allows.

    All formulations and element counts are solved in one call of the executor.
    """
    counts_by_row = [_checked_counts(discretisation, counts) for discretisation in discretisations]
    rows = list(zip(discretisations, counts_by_row, strict=True))
    discretised.solve_ahead(
        [discretisation.with_count(count) for discretisation, row in rows for count in row]
    )
    return tuple(
        _series(discretisation, discretised, *limits(discretisation.theory), row)
        for discretisation, row in rows
    )


def _checked_counts(discretisation: Discretisation, counts: Sequence[int]) -> tuple[int, ...]:
    """Element counts that the formulation allows, ascending.

    Raises InputError if there are none.
    """
    allowed_counts = tuple(
        sorted({count for count in counts if count >= discretisation.fewest_elements})
    )
    if not allowed_counts:
        raise InputError(
            f"elements: {discretisation.label} needs at least "
            f"{discretisation.fewest_elements} elements"
        )
    return allowed_counts


def _series(
    discretisation: Discretisation,
    discretised: Discretised,
    limits: Array,
    limit_half_widths: Array,
    counts: tuple[int, ...],
) -> ConvergenceSeries:
    """Convergence series over ascending element `counts`, with `limits` of q quantities.

    `limit_half_widths` (q) are relative. Further counts are evaluated to find the smallest ones
    that meet each of `TARGETS`.
    """

    def errors(count: int) -> Array:
        values = discretised.values(discretisation.with_count(count))
        return np.abs(relative_errors(values, limits))

    values = np.array([discretised.values(discretisation.with_count(n)) for n in counts])
    columns = range(len(limits))
    needed = [[_smallest_count(counts, errors, k, target) for k in columns] for target in TARGETS]
    return ConvergenceSeries(
        discretisation=discretisation,
        formal_order=discretisation.element_order,
        counts=counts,
        values=values,
        limits=limits,
        limit_half_widths=limit_half_widths,
        orders=fitted_orders(counts, relative_errors(values, limits), limit_half_widths),
        needed=np.array(needed),
    )


def _smallest_count(
    counts: Sequence[int], errors: Callable[[int], Array], column: int, target: float
) -> int:
    """Smallest element count from which on |error| stays below `target`. 0 if there is none.

    `errors` returns the relative errors (q) at an element count; `column` selects a quantity. The
    error is assumed to be monotone between the last one of `counts` whose error exceeds the target
    and the next count. The search starts where a power law through the errors of both counts meets
    the target.
    """
    missed = [count for count in counts if errors(count)[column] > target]
    met = [count for count in counts if not missed or count > missed[-1]]
    if not met:
        return 0
    above, below = (missed[-1] if missed else met[0] - 1), met[0]
    while below - above > 1:
        middle = (above + below) // 2
        coarse, fine = (float(errors(count)[column]) for count in (above, below))
        if coarse > fine > 0.0:
            share = np.log(coarse / target) / np.log(coarse / fine)
            middle = ceil(above * (below / above) ** share)
            middle = min(max(middle, above + 1), below - 1)
        if errors(middle)[column] > target:
            above = middle
        else:
            below = middle
    return below


def one_pose_statics(compliance: Array) -> Statics:
    """Statics of a body or robot in one pose without loads, from its compliance (6×6, SI)."""
    return Statics(compliance[None], np.zeros((1, 0, 6)))


def _leg_statics(
    leg: SectionedLeg | SteppedLeg, discretisation: Discretisation, _: RobotOnPath
) -> Statics:
    matrices = leg_matrices(discretisation.model, leg, discretisation.options)
    return one_pose_statics(tip_compliance_of(matrices))


def _leg_modes(
    leg: SectionedLeg | SteppedLeg, discretisation: Discretisation, _: RobotOnPath
) -> PathModes:
    matrices = leg_matrices(discretisation.model, leg, discretisation.options)
    return PathModes.unsampled(clamped_modes(matrices, MODES).frequencies[None])


def _cantilever(leg: ConstantLeg, theory: Theory) -> tuple[Array, Array]:
    """Exact values of the clamped leg, and their half-widths, which are zero.

    The values are four frequencies (Hz), then three deflections of the tip, each along a unit force
    (m/N).
    """
    properties = leg.properties(theory)
    exact_modes = cantilever_frequencies(properties, leg.length, MODES)
    deflections = np.diag(tip_compliance(properties, leg.length))[: len(DEFLECTIONS)]
    values = np.array([*(mode.frequency for mode in exact_modes), *deflections])
    return values, np.zeros(len(values))


def _robot_statics(highest: float, discretisation: Discretisation, robot: RobotOnPath) -> Statics:
    tool = compliance(_solved_robot(robot.postures[0], highest, discretisation))
    deflections = np.einsum("ii->i", tool)[: len(DEFLECTIONS)]
    deflections[deflections <= _STILL * deflections.max()] = 0.0
    return one_pose_statics(tool)


def _robot_modes(highest: float, discretisation: Discretisation, robot: RobotOnPath) -> PathModes:
    solution = _solved_robot(robot.postures[0], highest, discretisation)
    return PathModes.unsampled(modes(solution, MODES).frequencies[None])


# In memory, since statics and modes have the same bodies.
@memo(1)
def _solved_robot(posture: Posture, highest: float, discretisation: Discretisation) -> Solved:
    def matrices(leg: SectionedLeg | SteppedLeg, options: ModelOptions) -> LegMatrices:
        if discretisation.elements <= _WHOLE:
            return leg_matrices(discretisation.model, leg, options)
        return reduced_leg(discretisation.model, leg, options, highest, _CUTOFF * highest)

    mechanism = posture.mechanism
    bodies = bodies_of(mechanism, discretisation.options, matrices)
    return solved(assembly(mechanism, bodies).at(posture))


def _beam_limit(discretised: Discretised, theory: Theory) -> tuple[Array, Array]:
    """Richardson's limits (7) of the values by beam elements, and their relative half-widths (7).

    The values are four frequencies (Hz) and three deflections (m/N). A half-width is three times
    the error at the highest element count.
    """
    beams = Discretisation("beam", theory=theory)
    discretised.solve_ahead([beams.with_count(count) for count in _LIMIT_COUNTS])
    coarse, fine = (discretised.values(beams.with_count(count)) for count in _LIMIT_COUNTS)
    limits = richardson(coarse, fine, _LIMIT_COUNTS[1] / _LIMIT_COUNTS[0], BEAM_ORDER)
    errors = np.abs(relative_errors(fine, limits))
    return limits, MeshPolicy.to_limit().half_widths(errors)
