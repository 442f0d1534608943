"""Convergence studies of legs and robots over the element count, by segments and beam elements.

Input: a leg or a posture of a robot, and element counts. Output: a `ConvergenceStudy` of four
frequencies and three deflections. Rule: a prismatic leg, clamped at its root, is compared with the
exact cantilever of the same theory: Huang's frequencies (`fem.beams.beam_theory`) and its tip
compliance in closed form. A robot has no closed solution; its limit is that of the beam elements, f
= f80 + (f80 − f40)/15 for fourth order in 1/n.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import ceil

import numpy as np

from fem.beams.beam_theory import cantilever_frequencies
from fem.beams.stepped import SteppedLeg
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg, SectionedLeg, Theory, tip_compliance
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Posture
from lumped.models.bodies import clamped_modes, legs_of, tip_compliance_of
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, modes, solved
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
from validation.models.robot_models import bodies_of, highest_frequency
from validation.run.executor import Executor, in_order, in_turn
from validation.uncertainty.grid_convergence import richardson
from validation.uncertainty.mesh_half_widths import MeshPolicy, mesh_half_widths

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

Evaluate = Callable[[Discretisation], Array]


def leg_convergence(
    robot: str,
    name: str,
    leg: SectionedLeg | SteppedLeg,
    discretisations: Sequence[Discretisation] = FORMULATIONS,
    counts: Sequence[int] = COUNTS,
    executor: Executor = in_turn,
) -> ConvergenceStudy:
    """Convergence study of one leg with its root clamped.

    A leg of varying section has no closed solution; its limit is that of the beam elements.
    Raises InputError if a formulation allows none of the `counts`.
    """
    evaluate = partial(leg_values, leg)
    if isinstance(leg, ConstantLeg):
        limits = partial(_cantilever, leg)
        reference = "exact cantilever of the same theory (Huang 1961)"
    else:
        limits, reference = partial(_beam_limit, evaluate), _EXTRAPOLATED
    return _study(robot, name, {}, evaluate, limits, reference, discretisations, counts, executor)


def robot_convergence(
    posture: Posture,
    discretisations: Sequence[Discretisation] = FORMULATIONS,
    counts: Sequence[int] = COUNTS,
    executor: Executor = in_turn,
) -> ConvergenceStudy:
    """Convergence study of a robot in one posture, with equal element counts in all legs.

    Raises InputError for a robot without legs, or if a formulation allows none of the `counts`.
    Raises ComputationError if the tool is free to move or fewer than four modes move mass.
    """
    mechanism = posture.mechanism
    if not (legs_of(mechanism) or mechanism.parts):
        raise InputError(f"{mechanism.name}: no leg of this robot can be divided into elements")
    evaluate = partial(_robot_values, posture, highest_frequency([posture], MODES))
    limits = partial(_beam_limit, evaluate)
    pose = dict(zip(mechanism.tool.moves, posture.pose.tolist(), strict=True))
    return _study(
        mechanism.name,
        "",
        pose,
        evaluate,
        limits,
        _EXTRAPOLATED,
        discretisations,
        counts,
        executor,
    )


_EXTRAPOLATED = "limit of the beam elements, extrapolated from 40 and 80 elements"


def _study(
    robot: str,
    subject: str,
    pose: Mapping[str, float],
    evaluate: Evaluate,
    limits: Callable[[Theory], tuple[Array, Array]],
    reference: str,
    discretisations: Sequence[Discretisation],
    counts: Sequence[int],
    executor: Executor,
) -> ConvergenceStudy:
    """Convergence study. The executor calls `evaluate` for each formulation and element count."""
    counts_by_row = [_checked_counts(discretisation, counts) for discretisation in discretisations]
    values = iter(
        in_order(
            executor,
            [
                partial(evaluate, discretisation.with_count(count))
                for discretisation, row in zip(discretisations, counts_by_row, strict=True)
                for count in row
            ],
        )
    )
    return ConvergenceStudy(
        robot=robot,
        subject=subject,
        pose=pose,
        quantities=QUANTITIES,
        units=UNITS,
        reference=reference,
        series=tuple(
            _series(
                discretisation,
                evaluate,
                *limits(discretisation.theory),
                {count: next(values) for count in row},
            )
            for discretisation, row in zip(discretisations, counts_by_row, strict=True)
        ),
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
    evaluate: Evaluate,
    limits: Array,
    limit_half_widths: Array,
    values_by_count: dict[int, Array],
) -> ConvergenceSeries:
    """Convergence series of values by ascending element count.

    Further counts are evaluated to find the smallest ones that meet each of `TARGETS`.
    """
    counts = tuple(values_by_count)

    def errors(count: int) -> Array:
        if count not in values_by_count:
            values_by_count[count] = evaluate(discretisation.with_count(count))
        return np.abs(relative_errors(values_by_count[count], limits))

    values = np.array([values_by_count[count] for count in counts])
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

    The error is assumed to be monotone between the last listed count that exceeds the target and
    the next one. The search starts where a power law through the errors of both counts meets the
    target.
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


def leg_values(leg: SectionedLeg | SteppedLeg, discretisation: Discretisation) -> Array:
    """Frequencies (4, Hz) and tip compliances (3, m/N) of one leg with its root clamped."""
    matrices = leg_matrices(discretisation.model, leg, discretisation.options)
    return _values(clamped_modes(matrices, MODES).frequencies, tip_compliance_of(matrices))


def _cantilever(leg: ConstantLeg, theory: Theory) -> tuple[Array, Array]:
    """Exact frequencies (Hz) and tip compliances (m/N) of the cantilever. Half-widths are zero."""
    properties = leg.properties(theory)
    exact_modes = cantilever_frequencies(properties, leg.length, MODES)
    frequencies = np.array([mode.frequency for mode in exact_modes])
    values = _values(frequencies, tip_compliance(properties, leg.length))
    return values, np.zeros(len(values))


def _robot_values(posture: Posture, highest: float, discretisation: Discretisation) -> Array:
    def matrices(leg: SectionedLeg | SteppedLeg, options: ModelOptions) -> LegMatrices:
        if discretisation.elements <= _WHOLE:
            return leg_matrices(discretisation.model, leg, options)
        return reduced_leg(discretisation.model, leg, options, highest, _CUTOFF * highest)

    mechanism = posture.mechanism
    bodies = bodies_of(mechanism, discretisation.options, matrices)
    solution = solved(assembly(mechanism, bodies).at(posture))
    values = _values(modes(solution, MODES).frequencies, compliance(solution))
    deflections = values[MODES:]
    deflections[deflections <= _STILL * deflections.max()] = 0.0
    return values


def _beam_limit(evaluate: Evaluate, theory: Theory) -> tuple[Array, Array]:
    """Richardson's limit of the beam elements, and its half-widths.

    These are three times the error of the highest element count.
    """
    beams = Discretisation("beam", theory=theory)
    coarse, fine = (evaluate(beams.with_count(count)) for count in _LIMIT_COUNTS)
    limits = richardson(coarse, fine, _LIMIT_COUNTS[1] / _LIMIT_COUNTS[0], BEAM_ORDER)
    errors = np.abs(relative_errors(fine, limits))
    return limits, mesh_half_widths([errors], MeshPolicy.to_limit())


def _values(frequencies: Array, tip: Array) -> Array:
    return np.concatenate([frequencies, np.diag(tip)[: len(DEFLECTIONS)]])
