"""Elasticity and density in a section of several materials.

Elasticity matrices (6×6, Pa) relate the stresses (xx, yy, zz, yz, xz, xy) to the strains (εxx, εyy,
εzz, γyz, γxz, γxy) in the axes of the leg.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fem.sections.saint_venant import SectionQuadrature
from fem.sections.waveguide import elasticity
from lumped.arrays import Array, IntArray
from lumped.legs import ConstantLeg, Material, SectionedLeg
from lumped.sections import Composite
from meshes.section.section_mesh import SectionMesh


@dataclass(frozen=True, eq=False)
class Moduli:
    """Elasticity and density of the M cells of a section mesh.

    `at`: function from numbers of cells (m), and y and z at Q points of each (m×Q×2, m), to
    elasticity matrices (m×Q×6×6). `densities` (M, kg/m³).
    """

    at: Callable[[IntArray, Array], Array]
    densities: Array

    def on(self, quad: SectionQuadrature) -> Array:
        """Elasticity matrices (M×Q×6×6) at the quadrature points."""
        points = quad.points + quad.centroid[:, None, None]
        return self.at(np.arange(len(self.densities)), np.moveaxis(points, 0, -1))


def part_moduli(mesh: SectionMesh, materials: Sequence[Material]) -> Moduli:
    """Moduli of a section whose cells have the materials of their `regions`.

    A mesh without regions has one material.
    """
    cells = len(mesh.cells)
    regions = np.zeros(cells, dtype=int) if mesh.regions is None else mesh.regions
    matrices = np.array([elasticity(material) for material in materials])[regions]
    densities = np.array([material.rho for material in materials])[regions]

    def at(chosen: IntArray, points: Array) -> Array:
        return np.broadcast_to(matrices[chosen, None], (*points.shape[:2], 6, 6))

    return Moduli(at, densities)


def leg_moduli(leg: SectionedLeg, mesh: SectionMesh) -> Moduli | None:
    """Moduli on the section mesh of a leg of several materials. None for other legs."""
    if materials := part_materials(leg):
        return part_moduli(mesh, materials)
    return None


def part_materials(leg: SectionedLeg) -> tuple[Material, ...]:
    """Materials of the parts of a composite leg. () for other legs."""
    if not isinstance(leg, ConstantLeg) or not isinstance(leg.section, Composite):
        return ()
    return tuple(Material.isotropic(part.E, part.nu, part.rho) for part in leg.section.parts)
