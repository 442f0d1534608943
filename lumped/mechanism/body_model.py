"""Matrices of one free body, the common interface of all body models to the assembly.

A leg is a body with a root, a tip and a centreline, whose sections are drawn in figures.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from scipy.sparse import csr_array

from lumped.arrays import Array, SparseMatrix

ENDS = ("root", "tip")


@dataclass(frozen=True, eq=False)
class BodyModel:
    """Stiffness and mass of one free body on (6 per interface, then inner) unknowns, SI.

    Unknowns 6i to 6i+5 are the twist of interface i in body axes, in the order of the body's
    interfaces (`interfaces` are their names in the model). The other unknowns are internal to the
    model. `stiffness` and `mass` are n×n, symmetric, dense or sparse. The body is not supported,
    so the stiffness has six rigid-body motions.

    `displacements(points)` gives the 3m×n matrix from unknowns to the displacements, in body axes,
    at `points` (m×3, body axes). `parts` splits the stiffness by kind of deformation, if the model
    can; the parts sum to `stiffness`.
    """

    model: str
    interfaces: tuple[str, ...]
    stiffness: Array | SparseMatrix
    mass: Array | SparseMatrix
    displacements: Callable[[Array], SparseMatrix]
    parts: Mapping[str, Array | SparseMatrix] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        return int(self.stiffness.shape[0])


@dataclass(frozen=True, eq=False)
class LegMatrices(BodyModel):
    """Stiffness and mass of one free leg on (root 6, tip 6, internal) unknowns, leg axes, SI.

    `length` (m) from root to tip. `centreline(stations)` gives the sparse 6m × n matrix from
    unknowns to the section's twist at `stations` (m from the root, m values). Sections remain
    plane. `parts` are "tension", "torsion", "bending y" and "bending z" with their shear; bending
    y is deflection along z (EIy), bending z along y (EIz). Both are one part, "bending", if the
    section couples them.
    """

    interfaces: tuple[str, ...] = field(init=False, default=ENDS)
    displacements: Callable[[Array], SparseMatrix] = field(init=False)
    length: float = field(kw_only=True)
    centreline: Callable[[Array], SparseMatrix] = field(kw_only=True)

    def __post_init__(self) -> None:
        displacements = partial(_section_displacements, self.centreline)
        object.__setattr__(self, "displacements", displacements)


def _section_displacements(
    centreline: Callable[[Array], SparseMatrix], points: Array
) -> SparseMatrix:
    """3m × n matrix of u + φ × r of the section at each of the points (m×3, leg axes)."""
    count = len(points)
    arm = np.zeros((count, 3, 6))
    arm[:, :, :3] = np.eye(3)
    y, z = points[:, 1], points[:, 2]
    arm[:, 0, 4], arm[:, 0, 5] = z, -y
    arm[:, 1, 3], arm[:, 2, 3] = -z, y
    rows = np.repeat(np.arange(3 * count), 6)
    columns = (6 * np.arange(count)[:, None, None] + np.arange(6)).repeat(3, axis=1).ravel()
    point_from_section = csr_array((arm.ravel(), (rows, columns)), shape=(3 * count, 6 * count))
    return csr_array(point_from_section @ centreline(points[:, 0]))
