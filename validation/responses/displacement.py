"""How far the whole displacement of the loaded point is from another one, load by load.

The displacement under a force is a translation, the one under a moment a rotation, three numbers
each; what it is off by is the length of the difference over the length of the reference's. Of all
directions of force the worst is found exactly: by Dines' theorem (Bull. Amer. Math. Soc. 47 (1941)
494; the lossless S-lemma) the largest |D f|²/max(a, b) over f, a and b quadratic forms, is the
smallest over 0 <= w <= 1 of the largest generalised eigenvalue of (DᵀD, w A + (1 − w) B).
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np

from lumped.acceptance.quantities import AXES, UNIT_LOADS, Quantity, QuantityKind, load_quantities
from lumped.arrays import Array
from validation.responses.statics_and_modes import Statics

# A direction that hardly yields does not decide: of the largest displacement that a force of the
# same size causes, at least this part is what an error is relative to.
FLOOR = 1.0 / 20.0
# Of the largest displacement: below it there is rounding alone, and the reference is rigid.
RIGID = 1e-12
# The golden section of the weight: of 70 steps 2e-15 is left.
_STEPS, _GOLDEN = 70, 0.5 * (5.0**0.5 - 1.0)
# Eigenvalues as close as this are one: at a kink of their largest two of them meet.
_SAME = 1e-8


class Worst(NamedTuple):
    """The largest relative error (p) over all directions of force, and the direction (p×3)."""

    error: Array
    force: Array


class RelativeDisplacement(NamedTuple):
    """Difference of two displacements in P poses, relative to the reference's.

    `size` of the whole and `along` the load, signed (P each). `wrench` (P×6) is the unit wrench
    that causes them: the worst one for any force, zero for loads of the file. `direction` (P×3) is
    the wrench's, for loads of the file that of the reference's displacement. `length` (P, m/N or
    rad/(N m), for such loads m) of the reference's displacement is 0 if the reference is rigid, and
    `size` then 0 or infinite.
    """

    size: Array
    along: Array
    wrench: Array
    direction: Array
    length: Array


def sizes(difference: Statics, reference: Statics) -> Array:
    """Sizes of a difference relative to the reference's displacement (P×(7+L)).

    One column for every unit load, then for every load of the robot file.
    """
    loads = load_quantities([""] * reference.load_displacements.shape[1])
    columns = [relative(difference, reference, one).size for one in (*UNIT_LOADS, *loads)]
    return np.asarray(np.stack(columns, axis=1))


def relative(difference: Statics, reference: Statics, quantity: Quantity) -> RelativeDisplacement:
    """Difference of displacements under the load of a quantity."""
    is_load = quantity.kind is QuantityKind.LOAD
    rows = slice(3, 6) if quantity.rotational else slice(0, 3)
    wrench = np.zeros((len(reference.compliances), len(AXES)))
    block = reference.compliances[:, rows, rows]
    floor = np.zeros(len(block))
    if quantity.kind is QuantityKind.ANY_FORCE:
        wrench[:, rows] = worst_force(difference.compliances[:, rows, rows], block).force
        floor = FLOOR * np.linalg.norm(block, 2, axis=(1, 2))
    elif not is_load:
        wrench[:, quantity.column] = 1.0
    moved, off = (one.displacements(quantity, wrench) for one in (reference, difference))
    largest = np.linalg.norm(moved, axis=1) if is_load else np.linalg.norm(block, axis=(1, 2))
    nothing = RIGID * float(largest.max(initial=0.0))
    length = np.maximum(np.linalg.norm(moved, axis=1), floor)
    size = np.linalg.norm(off, axis=1)
    yields = length > nothing
    infinite = np.where(size > nothing, np.inf, 0.0)
    direction = wrench[:, rows]
    if is_load:
        direction = moved / np.where(yields, length, np.inf)[:, None]
    own, other = (np.einsum("pi,pi->p", direction, one) for one in (moved, off))
    own = np.maximum(own, floor)
    return RelativeDisplacement(
        np.divide(size, length, out=infinite, where=yields),
        np.divide(other, own, out=np.zeros_like(own), where=yields & (own > 0.0)),
        wrench,
        direction,
        np.where(yields, length, 0.0),
    )


def difference_under(
    model: Statics, reference: Statics, quantity: Quantity, wrench: Array
) -> tuple[Array, Array]:
    """Difference (P×3) of displacements under wrenches (P×6), and the length (P) it is relative to.

    The length as in `relative`.
    """
    due, moved = (one.displacements(quantity, wrench) for one in (reference, model))
    length = np.linalg.norm(due, axis=-1)
    if quantity.kind is QuantityKind.ANY_FORCE:
        block = reference.compliances[:, :3, :3]
        length = np.maximum(length, FLOOR * np.linalg.norm(block, 2, axis=(1, 2)))
    return moved - due, length


def nearest_between(off: Array, length: Array) -> Array:
    """Least relative size (…) of a difference from what lies between two of several references.

    `off` (a×…×3) are the differences of displacements from the references, `length` (a×…) those of
    the references. Between two references displacement and length change linearly. Infinite for
    one reference.
    """
    nearest = np.full(length.shape[1:], np.inf)
    for first, second in combinations(range(len(off)), 2):
        step = off[second] - off[first]
        square, towards = (np.einsum("...i,...i->...", step, one) for one in (step, -off[first]))
        share = np.divide(towards, square, out=np.zeros_like(square), where=square > 0.0)
        share = np.clip(share, 0.0, 1.0)
        size = np.linalg.norm(off[first] + share[..., None] * step, axis=-1)
        whole = length[first] + share * (length[second] - length[first])
        found = np.divide(size, whole, out=np.full_like(size, np.inf), where=whole > 0.0)
        nearest = np.fmin(nearest, found)
    return nearest


def worst_force(difference: Array, reference: Array) -> Worst:
    """Largest |D f| / max(|C f|, s/20) over all directions f, s the largest |C f|.

    D and C are p×3×3 blocks, translation by force. Of a reference of zeros the direction in which
    the difference is largest, and an error that is infinite unless that is zero, too.
    """
    _, yields, axes = np.linalg.svd(reference)
    axes = np.swapaxes(axes, 1, 2)
    floor = FLOOR * yields[:, :1]
    rigid = floor[:, 0] <= 0.0
    # In these axes the form below the fraction bar is diagonal.
    a, b = yields**2, np.where(rigid[:, None], 1.0, floor**2) * np.ones(3)
    a = np.where(rigid[:, None], 1.0, a)
    forms = np.swapaxes(difference @ axes, 1, 2) @ (difference @ axes)

    def scaled(weight: Array) -> tuple[Array, Array]:
        root = np.sqrt(weight[..., None] * a + (1.0 - weight[..., None]) * b)
        return forms / (root[..., :, None] * root[..., None, :]), root

    low, high = np.zeros(len(forms)), np.ones(len(forms))
    for _ in range(_STEPS):
        # For every direction the fraction is convex in the weight, and so is the largest.
        first, second = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        largest = np.linalg.eigvalsh(scaled(np.array([first, second]))[0])[..., -1]
        left = largest[0] <= largest[1]
        low, high = np.where(left, low, first), np.where(left, second, high)
    matrices, root = scaled(0.5 * (low + high))
    force = np.array([_meeting(*of_pose) for of_pose in zip(matrices, root, a - b, strict=True)])
    force = np.einsum("pij,pj->pi", axes, force)
    force /= np.linalg.norm(force, axis=1, keepdims=True)
    leading = np.take_along_axis(force, np.abs(force).argmax(axis=1)[:, None], axis=1)
    force = np.where(leading < 0.0, -force, force)
    size = np.linalg.norm(np.einsum("pij,pj->pi", difference, force), axis=1)
    length = np.linalg.norm(np.einsum("pij,pj->pi", reference, force), axis=1)
    length = np.maximum(length, floor[:, 0])
    infinite = np.where(size > 0.0, np.inf, 0.0)
    error = np.divide(size, length, out=infinite, where=~rigid)
    return Worst(np.asarray(error), np.asarray(force))


def _meeting(matrix: Array, root: Array, excess: Array) -> Array:
    """The worst direction: of the largest eigenvalue, where both forms below the bar are equal.

    `matrix` (3×3) in coordinates scaled by `root` (3), `excess` (3) one form less the other.
    """
    values, vectors = np.linalg.eigh(matrix)
    space = vectors[:, values >= values[-1] - _SAME * abs(values[-1])] / root[:, None]
    differ, ways = np.linalg.eigh(space.T * excess @ space)
    below, above = max(-float(differ[0]), 0.0), max(float(differ[-1]), 0.0)
    if below == 0.0 or above == 0.0:
        return np.asarray(space @ ways[:, 0])
    return np.asarray(space @ (np.sqrt(above) * ways[:, 0] + np.sqrt(below) * ways[:, -1]))
