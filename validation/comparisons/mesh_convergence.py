"""Convergence study of a solid leg of quadratic hexahedra over the divisions of its section.

Input: a leg with its root clamped, and at least two divisions. Output: a `ConvergenceStudy`. Rule:
the solid has no closed solution; its limit is extrapolated (Richardson). From four meshes on, the
observed order is used (`validation.uncertainty.grid_convergence.analyse`). With two or three it is
the formal one, f∞ = f_n + (f_n − f_m)/((n/m)^p − 1), and three times that correction is the
half-width.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from fem.bodies.rooted import RootedBody
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import SectionedLeg
from validation.comparisons.convergence_series import TARGETS, ConvergenceSeries
from validation.comparisons.convergence_study import ConvergenceStudy
from validation.comparisons.discretisations import Discretisation
from validation.comparisons.element_convergence import (
    MODES,
    Discretised,
    convergence_study,
    one_pose_statics,
)
from validation.models.leg_models import clamped_solid
from validation.references.responses import Responses
from validation.references.robot_on_path import RobotOnPath
from validation.responses.statics_and_modes import PathModes, Statics
from validation.run.executor import Executor, in_turn
from validation.solids.leg_meshes import formal_order
from validation.solids.solid_legs import ROUND_OFF
from validation.uncertainty.grid_convergence import analyse, richardson
from validation.uncertainty.half_widths import MeshPolicy

DIVISIONS = (1, 2, 3, 4)
SOLIDS = (Discretisation("solid", ends="rigid"), Discretisation("solid", ends="free"))
# Smallest number of meshes that shows an order.
_FEWEST_FOR_ORDER = 4


def leg_mesh_convergence(
    responses: Responses,
    name: str,
    leg: SectionedLeg,
    discretisations: Sequence[Discretisation] = SOLIDS,
    divisions: Sequence[int] = DIVISIONS,
    executor: Executor = in_turn,
) -> ConvergenceStudy:
    """Convergence study of one leg of a robot as a solid with its root clamped.

    Raises InputError for fewer than two meshes or a section that cannot be meshed.
    """
    counts = tuple(sorted(set(divisions)))
    if len(counts) < 2 or counts[0] < 1:
        raise InputError(
            f"divisions = {','.join(map(str, divisions))}: must be two or more different "
            "whole numbers, each at least 1"
        )
    discretised = Discretised(responses, partial(_statics, leg), partial(_modes, leg), executor)
    meshes = [[solid.with_count(count) for count in counts] for solid in discretisations]
    discretised.solve_ahead([mesh for row in meshes for mesh in row])
    series = [
        _series(leg, solid, counts, np.array(list(map(discretised.values, row))))
        for solid, row in zip(discretisations, meshes, strict=True)
    ]
    reference = "limit extrapolated from the finest meshes"
    return convergence_study(responses, name, reference, series)


def _series(
    leg: SectionedLeg, discretisation: Discretisation, counts: tuple[int, ...], values: Array
) -> ConvergenceSeries:
    """Series of `values` (m×q). Shapes: m meshes with `counts` divisions, q quantities."""
    order = formal_order(leg, discretisation.ends)
    limits, half_widths, orders = _limits(counts, values, order)
    errors = np.abs(values / limits - 1.0)
    return ConvergenceSeries(
        discretisation=discretisation,
        formal_order=order,
        counts=counts,
        values=values,
        limits=limits,
        limit_half_widths=half_widths / np.abs(limits),
        orders=orders,
        needed=np.array(
            [
                [
                    _smallest_listed_count(counts, column_errors, target)
                    for column_errors in errors.T
                ]
                for target in TARGETS
            ]
        ),
    )


def _statics(leg: SectionedLeg, discretisation: Discretisation, _: RobotOnPath) -> Statics:
    return one_pose_statics(_solid(leg, discretisation).compliance)


def _modes(leg: SectionedLeg, discretisation: Discretisation, _: RobotOnPath) -> PathModes:
    return PathModes.unsampled(_solid(leg, discretisation).modes(MODES).frequencies[None])


def _solid(leg: SectionedLeg, discretisation: Discretisation) -> RootedBody:
    return clamped_solid(leg, discretisation.divisions, discretisation.ends)


def _limits(counts: tuple[int, ...], values: Array, formal: float) -> tuple[Array, Array, Array]:
    """Limits (q), their half-widths (q, in the units of the values) and observed orders (q).

    Shapes: q quantities.
    """
    ratio = counts[-1] / counts[-2]
    policy = MeshPolicy.of_order(ratio, formal)
    limits = richardson(values[-2], values[-1], ratio, formal)
    half_widths = policy.half_widths(np.abs(values[-1] - values[-2]))
    orders = np.full(len(limits), np.nan)
    if len(counts) < _FEWEST_FOR_ORDER:
        return limits, half_widths, orders
    sizes = 1.0 / np.array(counts, dtype=float)
    for k, column in enumerate(values.T):
        observed = analyse(sizes, column, formal, ROUND_OFF)
        if observed.extrapolated is not None and observed.uncertainty is not None:
            limits[k], half_widths[k] = observed.extrapolated, observed.uncertainty
            orders[k] = np.nan if observed.observed_order is None else observed.observed_order
    return limits, half_widths, orders


def _smallest_listed_count(counts: tuple[int, ...], errors: Array, target: float) -> int:
    """Smallest of `counts` (m) from which on |error| stays below `target`. 0 if there is none.

    `errors` (m) are relative errors at these counts.
    """
    missed = np.flatnonzero(errors > target)
    first = int(missed[-1]) + 1 if len(missed) else 0
    return counts[first] if first < len(counts) else 0
