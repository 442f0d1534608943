"""Motions that cost no energy: idle ones, which the tool does not feel, and the tool's own.

A rod between two ball joints spins: harmless in statics, a zero frequency in dynamics. They are
found by kinematics alone: bodies as rigid, springs as locks.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr

from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError
from lumped.screws import name_twists, shift
from lumped.system.assembly import System

# Without units. Rounding of a motion is about 1e-14; a posture's loops are closed to 1e-12.
_FREE = 1e-9


@dataclass(frozen=True, eq=False)
class IdleMotions:
    """Idle motions of a system, k of them: `motions` (outer × k) on its nodes' unknowns.

    Holding the `pinned` unknowns (k) stops them and nothing else.
    """

    motions: Array
    pinned: IntArray


def idle_motions(system: System) -> IdleMotions:
    """The idle motions of `system`, drives held or sprung.

    Raises ComputationError, naming the motion, where the tool is left free to move.
    """
    strains = [_relative(system, body) for body in system.ends]
    count = system.outer
    rows = np.vstack([system.motions.locks, *strains])
    _, values, right = np.linalg.svd(rows, full_matrices=True)
    free = right[int(np.sum(values > _FREE)) :].T
    length = system.motions.structure.length
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)
    felt = unit[:, None] * (system.tool[:, :count] @ free)
    left, sizes, mix = np.linalg.svd(felt, full_matrices=True)
    moving = int(np.sum(sizes > np.sqrt(_FREE)))
    if moving:
        motions = name_twists(left[:, :moving].T / unit, length)
        raise ComputationError(f"{system.name}: the tool is free to {motions}: no drive holds it")
    idle = free @ mix[moving:].T
    order = qr(idle.T, mode="r", pivoting=True)[1]
    return IdleMotions(idle, np.sort(order[: idle.shape[1]]))


def _relative(system: System, body: str) -> Array:
    """Twists of a body's other interfaces against its first, without units (6(m−1)×outer)."""
    length = system.motions.structure.length
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)[:, None]
    first, *others = system.posture.mechanism.bodies[body].interfaces.values()
    ends = system.ends[body]
    rows = [
        unit * (ends[6 * i : 6 * i + 6] - shift(other.position - first.position) @ ends[:6])
        for i, other in enumerate(others, start=1)
    ]
    return np.vstack([np.zeros((0, system.outer)), *rows])
