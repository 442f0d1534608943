"""What a joint lets happen between its two sides: free twists, and springs in series with them.

The wrench λ that a joint carries does no work on its passive free twists F, Fᵀλ = 0, and the sides
move apart by δ = F η + C λ. A drive is a spring on its free twist f: it adds f fᵀ/k to the joint's
own compliance C. So δ lies in the span of F and of C λ, and static condensation of η is exact.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.free_twists import free_twists, turned_since_reference
from lumped.mechanism.joint import Joint
from lumped.mechanism.mechanism import Posture
from lumped.screws import turn_matrix

# Compliance without units below which a direction of a joint is rigid; rounding leaves 1e-16.
_RIGID = 1e-14


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Relative twists of the second side at the first's interface, base axes: δ = `basis` w.

    `basis` is 6×r; a unit of w moves about as far as the mechanism is long. `springs` gives, for
    every elastic part of the joint by its name, the matrix D (k×r) of its energy ½|D w|² (J);
    the last `elastic` of w are what the springs feel, the others cost nothing.
    """

    basis: Array
    springs: Mapping[str, Array]
    elastic: int


def joint_motion(posture: Posture, joint: Joint, length: float) -> JointMotion:
    """What `joint` lets happen in `posture`; `length` (m) makes translations and rotations equal.

    A drive acts on the first free twist; a drive without stiffness holds it.
    """
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)
    free = unit[:, None] * free_twists(posture, joint)
    passive = free if joint.drive is None else free[:, 1:]
    gives = {}
    if joint.drive is not None and joint.drive.stiffness is not None:
        gives[f"{joint.name} drive"] = free[:, :1] / np.sqrt(joint.drive.stiffness)
    if joint.compliance is not None:
        turned = turn_matrix(joint.compliance, turned_since_reference(posture, joint.first.body))
        gives[f"{joint.name} compliance"] = _root(turned * unit[:, None] * unit)
    if not gives:
        return _sized(passive / unit[:, None], {}, 0, unit)
    wrenches, deflections = _condensed(passive, np.hstack(list(gives.values())))
    none = np.zeros((6, passive.shape[1]))
    return _sized(
        np.hstack([passive, deflections]) / unit[:, None],
        {name: give.T @ np.hstack([none, wrenches]) for name, give in gives.items()},
        wrenches.shape[1],
        unit,
    )


def _condensed(passive: Array, gives: Array) -> tuple[Array, Array]:
    """Wrenches (6×r) of unit energy that do no work on `passive`, and the twists they cause.

    `gives` G (6×g) is a root of the compliance G Gᵀ.
    """
    across = np.linalg.qr(passive, mode="complete")[0][:, passive.shape[1] :]
    values, vectors = np.linalg.eigh(across.T @ gives @ gives.T @ across)
    elastic = values > _RIGID * max(values[-1], np.finfo(float).tiny)
    wrenches = across @ (vectors[:, elastic] / np.sqrt(values[elastic]))
    return wrenches, gives @ (gives.T @ wrenches)


def _sized(basis: Array, springs: dict[str, Array], elastic: int, unit: Array) -> JointMotion:
    size = 1.0 / np.linalg.norm(unit[:, None] * basis, axis=0)
    sized = {name: rows * size for name, rows in springs.items()}
    return JointMotion(basis * size, sized, elastic)


def _root(compliance: Array) -> Array:
    """G (6×6) with G Gᵀ = `compliance`, which may be singular."""
    values, vectors = np.linalg.eigh(0.5 * (compliance + compliance.T))
    root: Array = vectors * np.sqrt(np.maximum(values, 0.0))
    return root
