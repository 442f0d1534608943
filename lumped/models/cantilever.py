"""One leg alone, its root clamped: what any leg model says about tip compliance and modes."""

import numpy as np

from lumped.arrays import Array, dense
from lumped.dense.modes import Modes, solve_modes
from lumped.dense.statics import balanced_flexibility, solve_statics
from lumped.mechanism.body_model import LegMatrices

_ROOT = 6


def tip_compliance_of(leg: LegMatrices) -> Array:
    """6×6 tip compliance (SI, leg axes) of the leg with its root clamped.

    Raises ComputationError where the clamped leg is not held by its stiffness.
    """
    stiffness = leg.stiffness[_ROOT:, _ROOT:]
    part, loads = f"{leg.model} model of a leg", np.eye(stiffness.shape[0], 6)
    displacements = solve_statics(stiffness, loads, part)
    return balanced_flexibility(loads, displacements, stiffness @ displacements, part)


def kind_frequencies(leg: LegMatrices, kind: str, count: int) -> Array:
    """First frequencies (Hz) of one kind of deformation of the clamped leg.

    The kinds of a straight leg do not couple, so that each is solved on its own unknowns: modes
    of two kinds at one frequency stay apart. Raises ComputationError as `solve_modes` does.
    """
    stiffness = dense(leg.parts[kind])
    own = np.flatnonzero(np.diag(stiffness) > 0.0)
    pick = np.ix_(own[own >= _ROOT], own[own >= _ROOT])
    return solve_modes(stiffness[pick], dense(leg.mass)[pick], count, kind).frequencies


def clamped_modes(leg: LegMatrices, count: int) -> Modes:
    """The lowest `count` modes of the leg with its root clamped.

    Shapes are on all unknowns of the leg (n×count, zero at the root), so that
    `leg.centreline(stations) @ shapes` draws them. Raises ComputationError as `solve_modes` does.
    """
    free = solve_modes(
        dense(leg.stiffness)[_ROOT:, _ROOT:], dense(leg.mass)[_ROOT:, _ROOT:], count, leg.model
    )
    shapes = np.vstack([np.zeros((_ROOT, count)), free.shapes])
    return Modes(frequencies=free.frequencies, shapes=shapes)
