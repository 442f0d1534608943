"""Relative motion of the two sides of a joint: free twists, and springs in series with them.

The wrench λ in a joint does no work on the passive free twists F of the joint: Fᵀλ = 0. The
relative twist of the sides is δ = F η + C λ with the compliance C and coordinates η. A drive is a
spring of stiffness k on its free twist f, which adds f fᵀ/k to C. δ therefore lies in the span of F
and of all C λ with Fᵀλ = 0, and η can be eliminated by exact static condensation.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space

from lumped.arrays import Array
from lumped.mechanism.free_twists import joint_twists
from lumped.mechanism.joint import Joint
from lumped.screws import turn, turn_matrix

# Dimensionless compliance below which a joint is rigid in a direction. Round-off is about 1e-16.
_RIGID = 1e-14


@dataclass(frozen=True)
class Portion:
    """Key of a portion of the strain energy of a mechanism: a body or joint, and a deformation.

    `of` is the name of the body or joint. `kind` is "drive" or "compliance" for a joint. For a body
    it is a kind of deformation such as "tension" or "bending z". "" if the model of the body does
    not split its energy by deformation.
    """

    of: str
    kind: str = ""

    def __str__(self) -> str:
        return f"{self.of} {self.kind}".rstrip()


class UnevenError(ValueError):
    """Raised if postures that are assembled together differ in their number of unknowns."""


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Possible relative twists δ = B w of the second side of a joint, with r coefficients w.

    The arrays are for one posture, or for several postures (…). `basis` is B (…×6×r, base axes, at
    the first interface). A unit of w corresponds to a translation of about the size of the
    mechanism. `springs` contains, for each elastic part of the joint, the matrix D (…×k×r) of its
    strain energy ½|D w|² (J). Only the last `elastic` components of w strain the springs.
    """

    basis: Array
    springs: Mapping[Portion, Array]
    elastic: int

    def rotated(self, rotation: Array) -> "JointMotion":
        """Joint motion after a common `rotation` (…×3×3) of both sides."""
        return replace(self, basis=turn(rotation) @ self.basis)


def joint_motion(
    joint: Joint,
    first: Array,
    second: Array,
    length: float,
    stiffness: Array | float | None = None,
) -> JointMotion:
    """Relative motion of `joint` after the rotations `first` and `second` (…×3×3) of its bodies.

    The rotations are those from the reference posture, in one or several postures (…). `length` (m)
    makes translations and rotations comparable. A drive acts on the first free twist. A drive
    without stiffness locks it. `stiffness` (…) is the stiffness of a drive with a ball screw in
    these postures. If it is None, the stiffness of the drive is used. Raises UnevenError if the
    number of elastic directions depends on the posture.
    """
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)[:, None]
    free = unit * joint_twists(joint, first, second)
    passive = free if joint.drive is None else free[..., 1:]
    roots: dict[Portion, Array] = {}
    if joint.drive is not None and joint.drive.stiffness is not None:
        stiffness = joint.drive.stiffness if stiffness is None else stiffness
        roots[Portion(joint.name, "drive")] = free[..., :1] / np.sqrt(
            np.asarray(stiffness)[..., None, None]
        )
    if joint.compliance is not None:
        rotated = turn_matrix(joint.compliance, first)
        roots[Portion(joint.name, "compliance")] = _root(rotated * unit * unit.T)
    if not roots:
        return _sized(passive, {}, 0, unit)
    rotor: dict[Portion, Array] = {}
    if rotor_moves_alone(joint):
        rotor = {part: roots.pop(part) for part in list(roots) if part.kind == "drive"}
    independent = np.concatenate([passive, *rotor.values()], axis=-1)
    wrenches, deflections = _condensed(passive, np.concatenate(list(roots.values()), axis=-1))
    all_wrenches = np.concatenate([np.zeros_like(independent), wrenches], axis=-1)
    count = all_wrenches.shape[-1]
    # The deflection of the rotor is scaled to unit energy, like those of the other springs.
    springs = {
        part: np.broadcast_to(
            np.eye(count)[passive.shape[-1]], (*all_wrenches.shape[:-2], 1, count)
        )
        for part in rotor
    }
    return _sized(
        np.concatenate([independent, deflections], axis=-1),
        springs | {part: np.swapaxes(root, -1, -2) @ all_wrenches for part, root in roots.items()},
        wrenches.shape[-1] + len(rotor),
        unit,
    )


def rotor_moves_alone(joint: Joint) -> bool:
    """True if the drive of a joint has a rotor with inertia between two springs.

    The springs are the stiffness of the drive and the compliance of the joint. The motion of the
    rotor does not follow from the motion of the two bodies, and is an additional unknown.
    """
    drive = joint.drive
    sprung = drive is not None and drive.stiffness is not None and bool(drive.inertia)
    return sprung and joint.compliance is not None


def elastic_directions(joint: Joint, first: Array, second: Array) -> tuple[Array, Array]:
    """Orthonormal wrenches (6×e, base axes) that strain an elastic joint, and compliances (e).

    The wrenches do no work on the passive free twists. The compliance is that of the joint for each
    wrench. Under wrenches orthogonal to all of them the joint is rigid. `first` and `second` (3×3)
    are the rotations of the joint's bodies from the reference posture.
    """
    free = joint_twists(joint, first, second)
    compliance = turn_matrix(np.asarray(joint.compliance), first)
    passive = free
    if joint.drive is not None:
        passive = free[:, 1:]
        if joint.drive.stiffness is not None:
            compliance = compliance + free[:, :1] @ free[:, :1].T / joint.drive.stiffness
    across = null_space(passive.T)
    values, vectors = np.linalg.eigh(across.T @ compliance @ across)
    elastic = values > _RIGID * values[-1]
    return across @ vectors[:, elastic], values[elastic]


def elastic_wrenches(joint: Joint, first: Array, second: Array, relative: Array) -> Array:
    """Wrenches (6×m) in an elastic joint, from `relative` twists of its sides (6×m, base axes).

    A wrench λ does no work on the passive free twists F, and its relative twist is F η + C λ with
    the compliance C. λ acts at the first interface and is expressed in the axes of
    `Joint.compliance`. Components of λ under which the joint is rigid do not follow from the
    relative twist and are left out. `first` and `second` (3×3) are the rotations of the joint's
    bodies from the reference posture.
    """
    directions, compliances = elastic_directions(joint, first, second)
    wrenches = directions @ (directions.T @ relative / compliances[:, None])
    return np.asarray(turn(first).T @ wrenches)


def _condensed(passive: Array, root: Array) -> tuple[Array, Array]:
    """Wrenches (…×6×r) that do no work on `passive` twists (…×6×p), and the twists they cause.

    `root` is a matrix G (…×6×g) for which G Gᵀ is the compliance. Each wrench λ is normalised to
    λᵀ G Gᵀ λ = 1.
    """
    across = np.linalg.qr(passive, mode="complete")[0][..., passive.shape[-1] :]
    root_across = np.swapaxes(root, -1, -2) @ across
    values, vectors = np.linalg.eigh(np.swapaxes(root_across, -1, -2) @ root_across)
    largest = np.maximum(values[..., -1:], np.finfo(float).tiny)
    elastic = same_rank(values > _RIGID * largest)
    elastic_columns = slice(values.shape[-1] - elastic, None)
    wrenches = across @ (
        vectors[..., elastic_columns] / np.sqrt(values[..., None, elastic_columns])
    )
    return wrenches, root @ (np.swapaxes(root, -1, -2) @ wrenches)


def same_rank(above: Array) -> int:
    """Common number of True values in all rows of `above` (…×n).

    Raises UnevenError if the rows differ in this number.
    """
    ranks = np.unique(np.sum(above, axis=-1))
    if len(ranks) != 1:
        raise UnevenError
    return int(ranks[0])


def _sized(basis: Array, springs: dict[Portion, Array], elastic: int, unit: Array) -> JointMotion:
    """Joint motion in SI units from a dimensionless `basis` (…×6×r), with columns of unit length.

    The factors `unit` (6×1) make twists dimensionless. `springs` and `elastic` are those of
    `JointMotion`, for the given basis.
    """
    size = 1.0 / np.linalg.norm(basis, axis=-2, keepdims=True)
    return JointMotion(
        basis * size / unit, {part: rows * size for part, rows in springs.items()}, elastic
    )


def _root(compliance: Array) -> Array:
    """Matrix G (…×6×6) with G Gᵀ = `compliance`, which may be singular."""
    values, vectors = np.linalg.eigh(0.5 * (compliance + np.swapaxes(compliance, -1, -2)))
    root: Array = vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :]
    return root


def printed_release(stiffness: Array) -> Array:
    """Stiffness (6×6) with row and column φz set to zero: release K_R = I₅ K_S I₅ of eq. (25)."""
    mask = np.array([1.0, 1.0, 1.0, 1.0, 1.0, 0.0])
    released: Array = stiffness * mask[:, None] * mask
    return released
