"""The one interface that carries every model of a body to whoever assembles the mechanism."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from lumped.arrays import Array, SparseMatrix


@dataclass(frozen=True, eq=False)
class BodyModel:
    """Stiffness and mass of one free body on (6 per interface, then inner) unknowns, SI.

    Unknowns 6i to 6i+5 are the twist of interface i in body axes, in the order of the body's own
    (`interfaces` are their names in the model), the rest is the model's own. `stiffness` and `mass`
    are n×n, symmetric, dense or sparse; the body is not supported, so the stiffness has six
    rigid-body motions. It knows nothing of robots.

    `displacements(points)` gives the 3m×n matrix from unknowns to the displacements, in body axes,
    at `points` (m×3, body axes). `parts` splits the stiffness by kind of deformation where the
    model knows it; the parts sum to `stiffness`.
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
