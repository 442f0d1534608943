"""Relative motion of the two sides of a joint: free twists, and springs in series with them.

The wrench λ in a joint does no work on its passive free twists F, Fᵀλ = 0, and the relative twist
of the sides is δ = F η + C λ. A drive is a spring on its free twist f: it adds f fᵀ/k to the
joint's own compliance C. So δ lies in the span of F and of C λ, and static condensation of η is
exact.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space

from lumped.arrays import Array
from lumped.mechanism.free_twists import joint_twists
from lumped.mechanism.joint import Joint
from lumped.screws import turn, turn_matrix

# Dimensionless compliance below which a direction of a joint is rigid; rounding leaves 1e-16.
_RIGID = 1e-14


@dataclass(frozen=True)
class Portion:
    """Carrier of a share of strain energy: the body or joint `of`, and its kind of deformation.

    `kind` of a body is "tension", "bending z", … or "" if its model does not split the energy;
    of a joint "drive" or "compliance".
    """

    of: str
    kind: str = ""

    def __str__(self) -> str:
        return f"{self.of} {self.kind}".rstrip()


class UnevenError(ValueError):
    """Postures that are assembled together differ in their number of unknowns."""


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Relative twists of the second side at the first's interface, base axes: δ = `basis` w.

    `basis` is …×6×r, of one posture or of many. A unit of w moves about as far as the mechanism is
    long. `springs` gives, for every elastic part of the joint, the matrix D (…×k×r) of its energy
    ½|D w|² (J). Only the last `elastic` components of w strain the springs; the others have no
    energy.
    """

    basis: Array
    springs: Mapping[Portion, Array]
    elastic: int

    def rotated(self, rotation: Array) -> "JointMotion":
        """Motion of the joint after a common `rotation` (…×3×3) of both sides."""
        return replace(self, basis=turn(rotation) @ self.basis)


def joint_motion(joint: Joint, first: Array, second: Array, length: float) -> JointMotion:
    """Motion of `joint` after rotations `first` and `second` (…×3×3) of its bodies.

    `length` (m) makes translations and rotations comparable. A drive acts on the first free twist.
    A drive without stiffness locks it. Raises UnevenError if the number of elastic directions
    depends on the posture.
    """
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)[:, None]
    free = unit * joint_twists(joint, first, second)
    passive = free if joint.drive is None else free[..., 1:]
    roots: dict[Portion, Array] = {}
    if joint.drive is not None and joint.drive.stiffness is not None:
        roots[Portion(joint.name, "drive")] = free[..., :1] / np.sqrt(joint.drive.stiffness)
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
    # Normalised to unit energy, like the twists of the other springs.
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
    """True if a drive's rotor has inertia and springs on both sides.

    The sides of the joint do not determine its motion then. It is a further unknown of the joint,
    in addition to those of the joint's compliance.
    """
    drive = joint.drive
    sprung = drive is not None and drive.stiffness is not None and bool(drive.inertia)
    return sprung and joint.compliance is not None


def elastic_wrenches(joint: Joint, first: Array, second: Array, relative: Array) -> Array:
    """Wrenches (6×m) in an elastic joint from `relative` twists of its sides (6×m, base axes).

    In the axes of the joint's compliance, at the first interface; `first` and `second` (3×3) as in
    `joint_motion`. The wrenches λ do no work on the passive free twists F; `relative` is F η + C λ.
    """
    free = joint_twists(joint, first, second)
    compliance = turn_matrix(np.asarray(joint.compliance), first)
    passive = free
    if joint.drive is not None:
        passive = free[:, 1:]
        if joint.drive.stiffness is not None:
            compliance = compliance + free[:, :1] @ free[:, :1].T / joint.drive.stiffness
    across = null_space(passive.T)
    stiffness = np.linalg.pinv(across.T @ compliance @ across, hermitian=True)
    return np.asarray(turn(first).T @ across @ stiffness @ across.T @ relative)


def _condensed(passive: Array, root: Array) -> tuple[Array, Array]:
    """Wrenches (…×6×r) of unit energy that do no work on `passive`, and the twists that they cause.

    `root` G (…×6×g) is a root of the compliance G Gᵀ.
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
    """Number of true values in each row of `above` (…×n). Raises UnevenError if rows differ."""
    ranks = np.unique(np.sum(above, axis=-1))
    if len(ranks) != 1:
        raise UnevenError
    return int(ranks[0])


def _sized(basis: Array, springs: dict[Portion, Array], elastic: int, unit: Array) -> JointMotion:
    """Joint motion in SI units from a dimensionless basis."""
    size = 1.0 / np.linalg.norm(basis, axis=-2, keepdims=True)
    return JointMotion(
        basis * size / unit, {part: rows * size for part, rows in springs.items()}, elastic
    )


def _root(compliance: Array) -> Array:
    """G (…×6×6) with G Gᵀ = `compliance`, which may be singular."""
    values, vectors = np.linalg.eigh(0.5 * (compliance + np.swapaxes(compliance, -1, -2)))
    root: Array = vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :]
    return root


def printed_release(stiffness: Array) -> Array:
    """Released stiffness K_R = I₅ K_S I₅ of eq. (25): row and column of φz zeroed (6×6)."""
    mask = np.array([1.0, 1.0, 1.0, 1.0, 1.0, 0.0])
    released: Array = stiffness * mask[:, None] * mask
    return released
