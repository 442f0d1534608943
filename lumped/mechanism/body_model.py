"""Stiffness and mass of one free body: the common form in which all body models enter the assembly.

A leg is a body with a root, a tip and a centreline, along which figures draw its sections.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from scipy.sparse import csr_array

from lumped.arrays import Array, SparseMatrix
from lumped.centre_line import CentreLine
from lumped.screws import shift

ENDS = ("root", "tip")


@dataclass(frozen=True, eq=False)
class BodyModel:
    """Stiffness and mass matrices of one unsupported body, SI units.

    `stiffness` and `mass` are n×n, symmetric, dense or sparse. Unknowns 6i to 6i+5 are the twist of
    interface i in body axes; the names of the interfaces are in `interfaces`. The remaining
    unknowns are internal. `model` is the name of the model. The body is not supported, so that the
    stiffness has six rigid-body motions.

    `displacements(points)` is the 3k×n matrix that maps the n unknowns to displacements (body axes)
    of `points` (k×3, in m, body axes). `parts` splits the stiffness by type of deformation: its
    matrices add up to `stiffness`. It is empty if the model does not provide them. The keys of
    `unit_pressures` are the numbers of the faces of a CAD part. Each value contains the wrenches on
    all interfaces (6 for each, body axes) that represent a pressure of 1 Pa on that face. It is
    empty for bodies without faces.
    """

    model: str
    interfaces: tuple[str, ...]
    stiffness: Array | SparseMatrix
    mass: Array | SparseMatrix
    displacements: Callable[[Array], SparseMatrix]
    parts: Mapping[str, Array | SparseMatrix] = field(default_factory=dict)
    unit_pressures: Mapping[int, Array] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Number n of unknowns of the body."""
        return int(self.stiffness.shape[0])


@dataclass(frozen=True, eq=False)
class LegMatrices(BodyModel):
    """Stiffness and mass matrices of one unsupported leg, leg axes, SI units.

    The unknowns are the twist of the root (6), the twist of the tip (6) and internal ones. `length`
    from root to tip is in m. `line` is the centre line, None if it is the x axis.
    `centreline(stations)` is the sparse 6k × n matrix that maps the n unknowns to the twists of the
    sections at k `stations` (distances along the line in m). Sections remain plane. `parts` splits
    the stiffness into "tension", "torsion", "bending y" (deflection along z, EIy) and "bending z"
    (deflection along y, EIz), each bending with its shear deformation. If the section couples
    bending in the two planes, both are one part "bending". `parts` is empty for tapered, curved and
    bent legs.
    """

    interfaces: tuple[str, ...] = field(init=False, default=ENDS)
    displacements: Callable[[Array], SparseMatrix] = field(init=False)
    length: float = field(kw_only=True)
    centreline: Callable[[Array], SparseMatrix] = field(kw_only=True)
    line: CentreLine | None = field(kw_only=True, default=None)

    def __post_init__(self) -> None:
        displacements = partial(_section_displacements, self.centreline, self.line)
        object.__setattr__(self, "displacements", displacements)

    @property
    def line_length(self) -> float:
        """Length (m) along the centre line."""
        return self.length if self.line is None else self.line.length

    def centreline_points(self, stations: Array) -> Array:
        """Points (k×3, leg axes) of the centre line at k `stations` (distances along it in m)."""
        if self.line is None:
            return np.asarray(np.multiply.outer(stations, [1.0, 0.0, 0.0]))
        points, _ = self.line.frames(stations)
        return points


def _section_displacements(
    centreline: Callable[[Array], SparseMatrix], line: CentreLine | None, points: Array
) -> SparseMatrix:
    """3k × n matrix that maps the n unknowns to displacements of `points` (k×3, in m, leg axes).

    The displacement of a point is u + φ × r with the translation u and the rotation φ of its
    section, and the arm r from the section's centroid.
    """
    count = len(points)
    if line is None:
        stations = points[:, 0]
        arms = points * np.array([0.0, 1.0, 1.0])
    else:
        stations = line.nearest(points)
        arms = points - line.frames(stations)[0]
    arm = shift(arms)[:, :3]
    rows = np.repeat(np.arange(3 * count), 6)
    columns = (6 * np.arange(count)[:, None, None] + np.arange(6)).repeat(3, axis=1).ravel()
    point_from_section = csr_array((arm.ravel(), (rows, columns)), shape=(3 * count, 6 * count))
    return csr_array(point_from_section @ centreline(stations))
