"""What a joint lets happen between its two sides: free twists, and springs in series with them.

The wrench λ that a joint carries does no work on its passive free twists F, Fᵀλ = 0, and the sides
move apart by δ = F η + C λ. A drive is a spring on its free twist f: it adds f fᵀ/k to the joint's
own compliance C. So δ lies in the span of F and of C λ, and static condensation of η is exact.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space

from lumped.arrays import Array
from lumped.mechanism.free_twists import twists_left_free
from lumped.mechanism.joint import Joint
from lumped.screws import turn, turn_matrix

# Compliance without units below which a direction of a joint is rigid; rounding leaves 1e-16.
_RIGID = 1e-14


@dataclass(frozen=True)
class Portion:
    """What has a share of strain energy: a body or joint, and its kind of deformation.

    `kind` is a body's "tension", "bending z", … where its model knows them, "" where it does not,
    and "drive" or "compliance" of a joint.
    """

    of: str
    kind: str = ""

    def __str__(self) -> str:
        return f"{self.of} {self.kind}".rstrip()


class UnevenError(ValueError):
    """Postures that are asked for together do not have the same number of unknowns."""


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Relative twists of the second side at the first's interface, base axes: δ = `basis` w.

    `basis` is …×6×r, of one posture or of many; a unit of w moves about as far as the mechanism is
    long. `springs` gives, for every elastic part of the joint, the matrix D (…×k×r) of
    its energy ½|D w|² (J); the last `elastic` of w are what the springs feel, the others cost
    nothing.
    """

    basis: Array
    springs: Mapping[Portion, Array]
    elastic: int

    def turned(self, rotation: Array) -> "JointMotion":
        """The same of a joint whose sides have turned together by `rotation` (…×3×3)."""
        return replace(self, basis=turn(rotation) @ self.basis)


def joint_motion(joint: Joint, first: Array, second: Array, length: float) -> JointMotion:
    """What `joint` lets happen where its bodies have turned by `first` and `second` (…×3×3).

    `length` (m) makes translations and rotations equal. A drive acts on the first free twist; a
    drive without stiffness holds it. Raises UnevenError where postures differ in what gives way.
    """
    unit = np.array([1.0 / length] * 3 + [1.0] * 3)[:, None]
    free = unit * twists_left_free(joint, first, second)
    passive = free if joint.drive is None else free[..., 1:]
    gives: dict[Portion, Array] = {}
    if joint.drive is not None and joint.drive.stiffness is not None:
        gives[Portion(joint.name, "drive")] = free[..., :1] / np.sqrt(joint.drive.stiffness)
    if joint.compliance is not None:
        turned = turn_matrix(joint.compliance, first)
        gives[Portion(joint.name, "compliance")] = _root(turned * unit * unit.T)
    if not gives:
        return _sized(passive, {}, 0, unit)
    alone: dict[Portion, Array] = {}
    if rotor_moves_alone(joint):
        alone = {part: gives.pop(part) for part in list(gives) if part.kind == "drive"}
    before = np.concatenate([passive, *alone.values()], axis=-1)
    wrenches, deflections = _condensed(passive, np.concatenate(list(gives.values()), axis=-1))
    felt = np.concatenate([np.zeros_like(before), wrenches], axis=-1)
    count = felt.shape[-1]
    # Of unit energy, as the twists of the other springs are.
    springs = {
        part: np.broadcast_to(np.eye(count)[passive.shape[-1]], (*felt.shape[:-2], 1, count))
        for part in alone
    }
    return _sized(
        np.concatenate([before, deflections], axis=-1),
        springs | {part: np.swapaxes(give, -1, -2) @ felt for part, give in gives.items()},
        wrenches.shape[-1] + len(alone),
        unit,
    )


def rotor_moves_alone(joint: Joint) -> bool:
    """Whether a drive's rotor has inertia and springs on both sides, so that neither tells where.

    Its motion then is one of the joint's own, beside what the joint's compliance gives.
    """
    drive = joint.drive
    sprung = drive is not None and drive.stiffness is not None and bool(drive.inertia)
    return sprung and joint.compliance is not None


def carried(joint: Joint, first: Array, second: Array, apart: Array) -> Array:
    """Wrenches (6×m) that an elastic joint carries whose sides are `apart` (6×m, base axes).

    In the axes of the joint's compliance, at the first interface; `first` and `second` (3×3) as in
    `joint_motion`. They do no work on the passive free twists F, and C λ is the rest of `apart`.
    """
    free = twists_left_free(joint, first, second)
    gives = turn_matrix(np.asarray(joint.compliance), first)
    passive = free
    if joint.drive is not None:
        passive = free[:, 1:]
        if joint.drive.stiffness is not None:
            gives = gives + free[:, :1] @ free[:, :1].T / joint.drive.stiffness
    across = null_space(passive.T)
    stiffness = np.linalg.pinv(across.T @ gives @ across, hermitian=True)
    return np.asarray(turn(first).T @ across @ stiffness @ across.T @ apart)


def _condensed(passive: Array, gives: Array) -> tuple[Array, Array]:
    """Wrenches (…×6×r) of unit energy that do no work on `passive`, and the twists they cause.

    `gives` G (…×6×g) is a root of the compliance G Gᵀ.
    """
    across = np.linalg.qr(passive, mode="complete")[0][..., passive.shape[-1] :]
    felt = np.swapaxes(gives, -1, -2) @ across
    values, vectors = np.linalg.eigh(np.swapaxes(felt, -1, -2) @ felt)
    largest = np.maximum(values[..., -1:], np.finfo(float).tiny)
    elastic = same_rank(values > _RIGID * largest)
    kept = slice(values.shape[-1] - elastic, None)
    wrenches = across @ (vectors[..., kept] / np.sqrt(values[..., None, kept]))
    return wrenches, gives @ (np.swapaxes(gives, -1, -2) @ wrenches)


def same_rank(above: Array) -> int:
    """How many of the values (…×n) lie above; raises UnevenError where postures differ."""
    ranks = np.unique(np.sum(above, axis=-1))
    if len(ranks) != 1:
        raise UnevenError
    return int(ranks[0])


def _sized(basis: Array, springs: dict[Portion, Array], elastic: int, unit: Array) -> JointMotion:
    """From a basis without units."""
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
    """Eq. (25): K_R = I₅ K_S I₅, row and column of φz zeroed (6×6)."""
    keep = np.array([1.0, 1.0, 1.0, 1.0, 1.0, 0.0])
    released: Array = stiffness * keep[:, None] * keep
    return released
