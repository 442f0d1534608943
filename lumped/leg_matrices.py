"""The one interface that carries every leg model to whoever assembles the robot."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from lumped.arrays import Array, SparseMatrix


@dataclass(frozen=True)
class LegMatrices:
    """Stiffness and mass of one free leg on (root 6, tip 6, internal) unknowns, leg axes, SI.

    Unknowns 0–5 are the twist of the root end, 6–11 that of the tip end, the rest is the model's
    own. `stiffness` and `mass` are n×n sparse, symmetric; the leg is not supported, so the
    stiffness has six rigid-body motions.

    `centreline(stations)` gives the sparse 6m × n matrix from unknowns to the section's twist at
    `stations` (m from the root, m values). `parts` splits the stiffness by kind of deformation
    ("tension", "torsion", "bending y", "bending z" with their shear) where the model knows it:
    the parts sum to `stiffness`. Bending y is deflection along z (EIy), bending z along y (EIz).
    """

    model: str
    length: float
    stiffness: SparseMatrix
    mass: SparseMatrix
    centreline: Callable[[Array], SparseMatrix]
    parts: Mapping[str, SparseMatrix] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        return int(self.stiffness.shape[0])
