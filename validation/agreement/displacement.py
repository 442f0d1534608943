"""How far the whole displacement of the loaded point is from another one, load by load.

The displacement under a force is a translation, the one under a moment a rotation, three numbers
each; what it is off by is the length of the difference over the length of the reference's. Of all
directions of force the worst is found exactly: by Dines' theorem (Bull. Amer. Math. Soc. 47 (1941)
494; the lossless S-lemma) the largest |D f|²/max(a, b) over f, a and b quadratic forms, is the
smallest over 0 <= w <= 1 of the largest generalised eigenvalue of (DᵀD, w A + (1 − w) B).
"""

from typing import NamedTuple

import numpy as np

from lumped.acceptance.quantities import AXES, UNIT_LOADS, Quantity, QuantityKind, load_quantities
from lumped.arrays import Array

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
    """A difference of two displacements in p poses, relative to the reference's.

    `size` of the whole and `along` the load, signed (p each); `load` (p×6) is the unit wrench that
    causes them, of any force the worst one (p×(6+l) where there are loads: a one for theirs).
    `direction` (p×3) is the load's, of loads of the file that of the reference's displacement;
    `length` (p, m/N or rad/(N m), of such loads m) of the reference's displacement, 0 where the
    reference is rigid: `size` is then 0 or infinite.
    """

    size: Array
    along: Array
    load: Array
    direction: Array
    length: Array


def displacement(compliance: Array, load: Array, quantity: Quantity) -> Array:
    """Displacement (…×3) under a wrench (…×6): rotation where the quantity is one.

    `compliance` (…×6×6, SI, base axes) at the loaded point; what stands behind its sixth column are
    displacements under loads of the robot file, and behind the wrench how much there is of each.
    """
    moved = np.einsum("...ij,...j->...i", compliance, load)
    return np.asarray(moved[..., 3:] if quantity.rotational else moved[..., :3])


def sizes(difference: Array, reference: Array) -> Array:
    """Sizes of a difference of compliances relative to the reference's displacement (p×(7+l)).

    Both p×6×(6+l); one column for every static quantity, then for every load.
    """
    loads = load_quantities([""] * (reference.shape[2] - len(AXES)))
    found = [relative(difference, reference, one).size for one in (*UNIT_LOADS, *loads)]
    return np.asarray(np.stack(found, axis=1))


def relative(difference: Array, reference: Array, quantity: Quantity) -> RelativeDisplacement:
    """A difference of compliances under the load of a quantity; both p×6×(6+l)."""
    is_load = quantity.kind is QuantityKind.LOAD
    any_force = quantity.kind is QuantityKind.ANY_FORCE
    rows = slice(3, 6) if quantity.rotational else slice(0, 3)
    column = len(AXES) + quantity.column if is_load else quantity.column
    columns = slice(column, column + 1) if is_load else rows
    block = reference[:, rows, columns]
    nothing = RIGID * float(np.linalg.norm(block, axis=(1, 2)).max(initial=0.0))
    load = np.zeros((len(reference), reference.shape[2]))
    floor = np.zeros(len(reference))
    if any_force:
        load[:, :3] = worst_force(difference[:, rows, rows], block).force
        floor = FLOOR * np.linalg.norm(block, 2, axis=(1, 2))
    else:
        load[:, column] = 1.0
    moved, off = (displacement(one, load, quantity) for one in (reference, difference))
    length = np.maximum(np.linalg.norm(moved, axis=1), floor)
    size = np.linalg.norm(off, axis=1)
    yields = length > nothing
    infinite = np.where(size > nothing, np.inf, 0.0)
    direction = load[:, rows]
    if is_load:
        direction = moved / np.where(yields, length, np.inf)[:, None]
    own, other = (np.einsum("pi,pi->p", direction, one) for one in (moved, off))
    own = np.maximum(own, floor)
    return RelativeDisplacement(
        np.divide(size, length, out=infinite, where=yields),
        np.divide(other, own, out=np.zeros_like(own), where=yields & (own > 0.0)),
        load,
        direction,
        np.where(yields, length, 0.0),
    )


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
