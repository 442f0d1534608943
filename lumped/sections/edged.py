"""Sections whose constants are integrals over their edges (`lumped.sections.saint_venant`)."""

from abc import abstractmethod

import numpy as np

from lumped.arrays import Array
from lumped.sections.saint_venant import RimSolution
from lumped.sections.shapes import Section

# A product moment below this fraction of Iy + Iz is round-off: there is an axis of symmetry.
_SYMMETRIC = 1e-9
# A distance of shear centre and centroid below this fraction of the section's size is an error of
# the boundary elements: there is an axis of symmetry. The same holds for a shear coupling below
# this fraction of the sum of 1/κ.
OFF_CENTRE = 1e-7


class EdgedSection(Section):
    """A section whose torsion and shear constants are computed by boundary elements."""

    @property
    @abstractmethod
    def flexure(self) -> tuple[RimSolution, float]:
        """Solution of torsion and flexure for the section scaled to size 1, and its size (m)."""

    @property
    def is_doubly_symmetric(self) -> bool:
        return False

    @property
    def shear_centre(self) -> tuple[float, float]:
        solution, size = self.flexure
        y, z = np.where(np.abs(solution.shear_centre) > OFF_CENTRE, solution.shear_centre, 0.0)
        return float(y * size), float(z * size)

    def shear_coefficients(self, nu: float) -> tuple[float, float]:
        """Shear coefficients κ for a force V along y and along z, at Poisson's ratio `nu`.

        They follow from the strain energy of the shear stresses τ: ∫τ²/G dA = V²/κGA.
        """
        flexibility = self._shear_flexibility(nu)
        return 1.0 / float(flexibility[0, 0]), 1.0 / float(flexibility[1, 1])

    def shear_coupling(self, nu: float) -> float:
        flexibility = self._shear_flexibility(nu)
        coupling = float(flexibility[0, 1])
        return coupling if abs(coupling) > OFF_CENTRE * np.trace(flexibility) else 0.0

    def _shear_flexibility(self, nu: float) -> Array:
        """Dimensionless shear flexibility (2×2), with 1/κ for shear along y and z on the diagonal.

        Entry (f, g) is GA ∫ τ_f·τ_g/G dA with the shear stresses τ_f due to a unit force f along y
        or z.
        """
        solution, _ = self.flexure
        ratio = nu / (2.0 * (1.0 + nu))
        powers = np.array([1.0, ratio, ratio**2])
        return np.asarray(solution.area * np.tensordot(powers, solution.shear_energies, axes=1))


def product_of(moments: Array) -> float:
    """Off-diagonal entry of a matrix of second moments (2×2). 0 if it is only round-off."""
    product = float(moments[0, 1])
    return product if abs(product) > _SYMMETRIC * float(np.trace(moments)) else 0.0
