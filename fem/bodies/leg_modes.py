"""Modes of a clamped solid leg, with the count that proves that none is missing."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fem.bodies.solid import ClampedLeg
from fem.couplings.end_coupling import RigidEnds
from fem.solvers.certificate.count import count_name, inertia_below
from fem.solvers.certificate.sturm import Inertia
from fem.solvers.modes import CertifiedModes, lowest_modes
from lumped.arrays import Array
from lumped.dense.modes import fix_signs


def clamped_count(clamped: ClampedLeg) -> Callable[[float], Inertia]:
    """Inertia of K − σM of a clamped leg, its ends rigid or free, as a function of σ (rad²/s²).

    Free ends: that of K − σM on the displacements with B_rootᵀu = 0.
    """
    mesh, ends, factor = clamped.mesh, clamped.ends, clamped.factor
    K, M, constraints = factor.triangle, clamped.mass, None
    points, leading = mesh.nodes, ends.leading_blocks
    if isinstance(ends, RigidEnds):
        points = points[ends.interior]
    elif clamped.solid is not None:
        K, M = clamped.solid.stiffness, clamped.solid.mass
        # Forces and moments of one size, so that no twist looks like rounding beside another.
        constraints = ends.root_loads * np.repeat([1.0, mesh.length], [3, 3])

    def of(sigma: float) -> Inertia:
        return inertia_below(factor, K, M, sigma, points, leading, constraints)

    return of


def modes(clamped: ClampedLeg, count: int, start: Array | None = None) -> CertifiedModes:
    """The lowest `count` modes of a leg held at its root: shapes 3N×count, leg axes.

    `start` as in `fem.solvers.modes.lowest_modes`, on the unknowns of the held leg. Raises as that
    does.
    """
    found = lowest_modes(
        clamped.factor,
        clamped.mass,
        count,
        clamped_count(clamped),
        "solid leg",
        count_name(clamped.factor.symbolic.backend),
        start,
    )
    return replace(found, shapes=fix_signs(clamped.ends.expanded(found.shapes)))
