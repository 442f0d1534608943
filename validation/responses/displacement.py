"""Relative difference between two displacement vectors of the loaded point, load by load.

Input: compliances and load displacements of a model and of a reference, in base axes. Output: one
relative difference for each pose and load. Rule: the length of the difference vector over the
length of the reference's vector. A force is judged by the translation (3 numbers) that it causes, a
moment by the rotation (3 numbers).

The worst direction of force is found exactly, by Dines' theorem (Bull. Amer. Math. Soc. 47 (1941)
494; the lossless S-lemma). The largest |D f|²/max(a, b) over all forces f, with the difference D of
compliances and quadratic forms a = fᵀA f and b = fᵀB f, is the smallest value over 0 <= w <= 1 of
the largest generalised eigenvalue of (DᵀD, w A + (1 − w) B).
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np

from lumped.acceptance.quantities import AXES, UNIT_LOADS, Quantity, QuantityKind, load_quantities
from lumped.arrays import Array
from validation.responses.statics_and_modes import Statics

# The displacement that divides an error is at least this fraction of the largest one that a force
# of the same size causes, so that a very stiff direction does not decide.
FLOOR = 1.0 / 20.0
# Fraction of the largest displacement below which a displacement is round-off. The reference counts
# as rigid there.
RIGID = 1e-12
# Golden-section search over the weight w: after 70 steps the interval is 2e-15 wide.
_STEPS, _GOLDEN = 70, 0.5 * (5.0**0.5 - 1.0)
# Relative gap below which eigenvalues count as repeated. The largest eigenvalue, as a function of
# w, has a kink where two of them meet.
_REPEATED = 1e-8


class Worst(NamedTuple):
    """Largest relative error (p) over all directions of force, and the direction (p×3).

    One row for each of p poses. Directions are unit vectors in base axes.
    """

    error: Array
    force: Array


class RelativeDisplacement(NamedTuple):
    """Difference of two displacements in P poses, relative to the reference's displacement.

    `size`: length of the difference vector (P). `along`: its component along the load, signed (P).
    `wrench` (P×6): unit wrench that causes the displacements; for the quantity "any force" the
    force with the largest error; zero for loads of the robot file. `direction` (P×3): direction of
    the wrench, or of the reference's displacement for loads of the file. `length` (P): length of
    the reference's displacement in m/N or rad/(N m), in m for loads of the file. It is 0 if the
    reference is rigid, and `size` is then 0 or infinite. If the tool cannot move as a load of the
    file requires, `size` is NaN and `length` 0.
    """

    size: Array
    along: Array
    wrench: Array
    direction: Array
    length: Array


def sizes(difference: Statics, reference: Statics) -> Array:
    """Lengths of displacement differences relative to the reference's displacements (P×(7+L)).

    `difference`: statics of a model minus those of the reference, in P poses. The columns are the 7
    unit loads (forces along and moments about x, y and z; any force) and the L loads of the robot
    file.
    """
    loads = load_quantities([""] * reference.load_displacements.shape[1])
    columns = [relative(difference, reference, load).size for load in (*UNIT_LOADS, *loads)]
    return np.asarray(np.stack(columns, axis=1))


def relative(difference: Statics, reference: Statics, quantity: Quantity) -> RelativeDisplacement:
    """Relative difference of two models' displacements under the load of a quantity.

    `difference`: statics of a model minus those of the reference. For the quantity "any force", the
    reference's displacement, by which the difference is divided, is at least 1/20 of its largest
    displacement under a unit force.
    """
    is_load = quantity.kind is QuantityKind.LOAD
    rows = _rows(quantity)
    wrench = np.zeros((len(reference.compliances), len(AXES)))
    block = reference.compliances[:, rows, rows]
    floor = np.zeros(len(block))
    if quantity.any_direction:
        wrench[:, rows] = worst_force(difference.compliances[:, rows, rows], block).force
        floor = FLOOR * np.linalg.norm(block, 2, axis=(1, 2))
    elif not is_load:
        wrench[:, quantity.column] = 1.0
    displacement, deviation = (
        statics.displacements(quantity, wrench) for statics in (reference, difference)
    )
    impossible = np.asarray(np.isnan(displacement + deviation).any(axis=1))
    displacement, deviation = (
        np.where(impossible[:, None], 0.0, vectors) for vectors in (displacement, deviation)
    )
    largest = (
        np.linalg.norm(displacement, axis=1) if is_load else np.linalg.norm(block, axis=(1, 2))
    )
    rigid_length = RIGID * float(largest.max(initial=0.0))
    length = np.maximum(np.linalg.norm(displacement, axis=1), floor)
    size = np.linalg.norm(deviation, axis=1)
    yields = length > rigid_length
    infinite = np.where(size > rigid_length, np.inf, 0.0)
    direction = wrench[:, rows]
    if is_load:
        direction = displacement / np.where(yields, length, np.inf)[:, None]
    reference_along, difference_along = (
        np.einsum("pi,pi->p", direction, vectors) for vectors in (displacement, deviation)
    )
    reference_along = np.maximum(reference_along, floor)
    return RelativeDisplacement(
        np.where(impossible, np.nan, np.divide(size, length, out=infinite, where=yields)),
        np.divide(
            difference_along,
            reference_along,
            out=np.zeros_like(reference_along),
            where=yields & (reference_along > 0.0),
        ),
        wrench,
        direction,
        np.where(yields, length, 0.0),
    )


def _rows(quantity: Quantity) -> slice:
    """Rows of a twist, and columns of a wrench, of the quantity: rotation or translation."""
    return slice(3, 6) if quantity.rotational else slice(0, 3)


def difference_under(
    model: Statics, reference: Statics, quantity: Quantity, wrench: Array
) -> tuple[Array, Array]:
    """Difference (P×3) of two models' displacements under wrenches (P×6), and a length (P).

    The length is that of the reference's displacement, with the same lower limit as in `relative`.
    Array sizes: P poses.
    """
    expected, displacement = (
        statics.displacements(quantity, wrench) for statics in (reference, model)
    )
    length = np.linalg.norm(expected, axis=-1)
    if quantity.any_direction:
        rows = _rows(quantity)
        block = reference.compliances[:, rows, rows]
        length = np.maximum(length, FLOOR * np.linalg.norm(block, 2, axis=(1, 2)))
    return displacement - expected, length


def nearest_between(deviations: Array, length: Array) -> Array:
    """Smallest relative distance (…) from a displacement to any between two references.

    `deviations` (a×…×3): differences of the displacement from that of each reference. `length`
    (a×…): lengths of the references' displacements. Between two references, displacement and length
    are interpolated linearly. Infinite if there is only one reference. Array sizes: a references.
    """
    nearest = np.full(length.shape[1:], np.inf)
    for first, second in combinations(range(len(deviations)), 2):
        step = deviations[second] - deviations[first]
        square, towards = (
            np.einsum("...i,...i->...", step, vector) for vector in (step, -deviations[first])
        )
        share = np.divide(towards, square, out=np.zeros_like(square), where=square > 0.0)
        share = np.clip(share, 0.0, 1.0)
        size = np.linalg.norm(deviations[first] + share[..., None] * step, axis=-1)
        reference_length = length[first] + share * (length[second] - length[first])
        distances = np.full_like(size, np.inf)
        np.divide(size, reference_length, out=distances, where=reference_length > 0.0)
        nearest = np.fmin(nearest, distances)
    return nearest


def worst_force(difference: Array, reference: Array) -> Worst:
    """Largest |D f| / max(|C f|, s/20) over all directions f of force; s is the largest |C f|.

    `difference` D and `reference` C (p×3×3) are blocks of compliance, translation by force. If C is
    zero, the direction is that of the largest |D f|, and the error is infinite or, if D is zero
    too, zero.
    """
    _, yields, axes = np.linalg.svd(reference)
    axes = np.swapaxes(axes, 1, 2)
    floor = FLOOR * yields[:, :1]
    rigid = floor[:, 0] <= 0.0
    # In these axes the quadratic form of the denominator is diagonal.
    a, b = yields**2, np.where(rigid[:, None], 1.0, floor**2) * np.ones(3)
    a = np.where(rigid[:, None], 1.0, a)
    forms = np.swapaxes(difference @ axes, 1, 2) @ (difference @ axes)
    # Largest |D f| / |C f|. It is the result if |C f| is at least s/20 for the force f that causes
    # it.
    regular = rigid | (yields[:, 2] > np.finfo(float).eps * yields[:, 0])
    scale = 1.0 / np.sqrt(np.where(regular[:, None], a, 1.0))
    values, vectors = np.linalg.eigh(forms * scale[:, :, None] * scale[:, None])
    force = scale * vectors[:, :, 2]
    is_result = regular & (values[:, 1] < (1.0 - _REPEATED) * values[:, 2])
    is_result &= np.sum((a - b) * force**2, axis=1) >= 0.0
    other = np.flatnonzero(~is_result)
    if len(other):
        force[other] = _worst_between(forms[other], a[other], b[other])
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


def _worst_between(forms: Array, a: Array, b: Array) -> Array:
    """Force f (p×3) for which fᵀ F f is largest relative to max(Σ a f², Σ b f²), with F = `forms`.

    `forms` is p×3×3, `a` and `b` are p×3, for p poses.
    """

    def scaled(weight: Array) -> tuple[Array, Array]:
        root = np.sqrt(weight[..., None] * a + (1.0 - weight[..., None]) * b)
        return forms / (root[..., :, None] * root[..., None, :]), root

    low, high = np.zeros(len(forms)), np.ones(len(forms))
    for _ in range(_STEPS):
        # The fraction is convex in the weight for each direction f, and therefore also its maximum
        # over f.
        first, second = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        largest = np.linalg.eigvalsh(scaled(np.array([first, second]))[0])[..., -1]
        in_lower = largest[0] <= largest[1]
        low, high = np.where(in_lower, low, first), np.where(in_lower, second, high)
    matrices, root = scaled(0.5 * (low + high))
    return np.array(
        [
            _worst_direction(*forms_of_pose)
            for forms_of_pose in zip(matrices, root, a - b, strict=True)
        ]
    )


def _worst_direction(matrix: Array, root: Array, excess: Array) -> Array:
    """Direction (3) of the force with the largest error, from the largest eigenvalue of `matrix`.

    `matrix` (3×3): quadratic form of the numerator in coordinates scaled by `root` (3). `excess`
    (3): diagonal of the first quadratic form of the denominator minus that of the second. If
    directions exist in the eigenspace for which both forms of the denominator are equal, the result
    is one of them.
    """
    values, vectors = np.linalg.eigh(matrix)
    space = vectors[:, values >= values[-1] - _REPEATED * abs(values[-1])] / root[:, None]
    gaps, directions = np.linalg.eigh(space.T * excess @ space)
    below, above = max(-float(gaps[0]), 0.0), max(float(gaps[-1]), 0.0)
    if below == 0.0 or above == 0.0:
        return np.asarray(space @ directions[:, 0])
    return np.asarray(
        space @ (np.sqrt(above) * directions[:, 0] + np.sqrt(below) * directions[:, -1])
    )
