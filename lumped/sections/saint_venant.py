"""Saint-Venant's torsion and flexure of a polygonal section, by boundary elements.

The coordinates s = (y, z) are relative to the centroid, Σ is ∫ s sᵀ dA, and c is Σ⁻¹F for a
transverse force F. The shear stresses due to a unit twist Gθ′ = 1 and due to F are

    torsion   τ = ∇ω + (−z, y)             ∂ω/∂n = z n_y − y n_z
    flexure   τ = ∇χ + P_0 + r P_1         ∂χ/∂n = −(P_0 + r P_1)·n,  r = νG/E
              P_0 = −½ (c₁y², c₂z²)        P_1 = ½ (y² + z²) c − yz (c₂, c₁)

with harmonic functions ω and χ. Then div τ = −c·s in the section, and τ·n = 0 on its boundary (A.
E. H. Love, A Treatise on the Mathematical Theory of Elasticity, ch. XV). All constants are
integrals over the boundary. By Green's formula, with g = (c₁y³ + c₂z³)/6, for which ∇²g = c·s,

    J = I_p − ∮ ω ∂ω/∂n ds,     ∫ ω c·s dA = ∮ (ω ∂g/∂n − g ∂ω/∂n) ds.

The harmonic functions are found by boundary elements (`lumped.sections.boundary_elements`). The
same constants are computed by finite elements in `fem.sections`.

A section may consist of regions with the same r, whose moduli E and G are w times those of a
reference material. Then Σ, c and all integrals over the section are weighted by w,
and integrals over the boundary become integrals over all edges, weighted by the jump of w: its
value to the left of an edge minus that to its right.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.sections.boundary_elements import Region, potentials, rim_of, unit_gauss
from lumped.sections.polygons import Loop

# Function that returns values (… × n) at n points with coordinates y and z.
_Integrand: TypeAlias = Callable[[Array, Array], Array]


@dataclass(frozen=True, eq=False)
class RimSolution:
    """Solution of torsion and flexure for a section scaled to a size of about 1.

    `area` and `torsion_constant` J are weighted by the weight w of the regions. `shear_centre` (2)
    is relative to the weighted centroid. `shear_energies` (3×2×2) are the coefficients of 1, r and
    r² (r = νG/E) in the integrals ∫ τ_f·τ_g/w dA. τ_f and τ_g are the shear stresses due to unit
    forces along y or z through the shear centre, which do not twist the section.
    """

    area: float
    torsion_constant: float
    shear_centre: Array
    shear_energies: Array


def area_moments(loops: Sequence[Loop]) -> tuple[float, Array, Array]:
    """Area, centroid (2) and matrix Σ = ∫ s sᵀ dA (2×2, about the centroid) of a polygon.

    `loops` are its outline (counter-clockwise) and its holes (clockwise).
    """
    area = float(_polygon_integral(loops, lambda y, _: np.ones((1, *y.shape)))[0])
    centroid = _polygon_integral(loops, lambda y, z: np.array([y, z])) / area
    centred = [loop - centroid for loop in loops]
    yy, yz, zz = _polygon_integral(centred, lambda y, z: np.array([y * y, y * z, z * z]))
    return area, centroid, np.array([[yy, yz], [yz, zz]])


def weighted_moments(regions: Sequence[Region]) -> tuple[float, Array, Array]:
    """Area, centroid (2) and Σ = ∫ s sᵀ dA (2×2, about the centroid) of several regions.

    The integrals over each region are multiplied by its `weight`.
    """
    weights = np.array([region.weight for region in regions])
    areas, centroids, moments = zip(
        *(area_moments(region.loops) for region in regions), strict=True
    )
    shares = weights * np.array(areas)
    total = float(shares.sum())
    centroid = shares @ np.array(centroids) / total
    offsets = np.array(centroids) - centroid
    steiner = np.einsum("r,ri,rj->ij", shares, offsets, offsets)
    return total, centroid, np.einsum("r,rij->ij", weights, np.array(moments)) + steiner


def rim_solution(regions: Sequence[Region]) -> RimSolution:
    """Solution of torsion and flexure for a section that consists of `regions`.

    The section must be scaled to a size of about 1. The outline of a region is counter-clockwise,
    its holes are clockwise.
    """
    area, centroid, moments = weighted_moments(regions)
    centred = [
        Region([loop - centroid for loop in region.loops], region.weight) for region in regions
    ]
    rim = rim_of(centred)
    slopes: Array = np.asarray(np.linalg.inv(moments), dtype=float)
    y, z = rim.points.transpose(2, 0, 1)
    n_y, n_z = rim.outward.T[:, :, None]
    twist_flux = z * n_y - y * n_z
    # Axes of the arrays of fields: force, power of r, component, then points.
    fluxes = np.einsum("fpdeq,ed->eqfp", _polynomials(slopes, y, z), rim.outward)
    data = np.concatenate([twist_flux[:, :, None], -fluxes.reshape(*fluxes.shape[:2], 4)], axis=2)
    harmonics = rim.on(potentials(rim, data))
    omega, chi = harmonics[:, :, 0], harmonics[:, :, 1:].reshape(fluxes.shape)

    polar = moments[0, 0] + moments[1, 1]
    torsion_constant = polar - float(rim.integral(omega * twist_flux))
    g = np.array([y, z]) ** 3 / 6.0
    g_flux = np.array([y**2 * n_y, z**2 * n_z]) / 2.0
    warped = slopes @ [
        float(rim.integral(omega * flux - value * twist_flux))
        for flux, value in zip(g_flux, g, strict=True)
    ]

    torques = _weighted_integral(
        centred,
        lambda y, z: np.einsum("fpdq,dq->fpq", _polynomials(slopes, y, z), np.array([-z, y])),
    )
    torques -= rim.integral(chi * twist_flux[:, :, None, None])
    # Only the part of the stress that does not depend on r has a divergence.
    torques[:, 0] += warped

    # ∫ χ_fp c_g·s dA is made symmetric in f and g. ∮ χ P·n ds and ∫ P·P dA are added to it.
    c_g = np.einsum("gd,deq->eqg", slopes, g)
    c_flux = np.einsum("gd,deq->eqg", slopes, g_flux)
    of_divergence = rim.integral(
        chi[..., None] * c_flux[:, :, None, None, :] + fluxes[..., None] * c_g[:, :, None, None, :]
    )
    energies = np.zeros((3, 2, 2))
    energies[:2] += of_divergence.transpose(1, 0, 2) + of_divergence.transpose(1, 2, 0)
    on_rim = rim.integral(np.einsum("eqgp,eqfs->eqpsfg", chi, fluxes))
    inside = _weighted_integral(
        centred,
        lambda y, z: np.einsum(
            "fpdq,gsdq->psfgq", _polynomials(slopes, y, z), _polynomials(slopes, y, z)
        ),
    )
    shares = np.einsum("fp,gs->psfg", torques, torques) / torsion_constant
    for p in range(2):
        for s in range(2):
            energies[p + s] += on_rim[p, s] + inside[p, s] - shares[p, s]
    energies = 0.5 * (energies + energies.transpose(0, 2, 1))
    return RimSolution(
        area=area,
        torsion_constant=torsion_constant,
        shear_centre=np.array([-warped[1], warped[0]]),
        shear_energies=energies,
    )


def _polynomials(slopes: Array, y: Array, z: Array) -> Array:
    """Polynomials P_0 and P_1 of the module docstring at points `y`, `z` (…), for unit forces.

    The axes of the result (2×2×2×…) are the force (along y or z), the index 0 or 1 of P, the
    component (y or z), and the points. `slopes` (2×2) is Σ⁻¹.
    """
    fields = np.zeros((2, 2, 2, *y.shape))
    for force, (c1, c2) in enumerate(slopes):
        fields[force, 0] = -0.5 * c1 * y**2, -0.5 * c2 * z**2
        half = 0.5 * (y**2 + z**2)
        fields[force, 1] = c1 * half - c2 * y * z, c2 * half - c1 * y * z
    return fields


def _polygon_integral(loops: Sequence[Loop], integrand: _Integrand) -> Array:
    """Integral of a polynomial (degree ≤ 10) over a polygon.

    It is the sum over the triangles between each edge and the origin.
    """
    shares, weights = unit_gauss()
    total: Array | float = 0.0
    for loop in loops:
        ends = np.roll(loop, -1, axis=0)
        twice = loop[:, 0] * ends[:, 1] - loop[:, 1] * ends[:, 0]
        edges = loop[:, None] + shares[:, None] * (ends - loop)[:, None]
        places = shares[:, None, None, None] * edges
        areas = np.multiply.outer(shares * weights, np.multiply.outer(twice, weights))
        y, z = places[..., 0].ravel(), places[..., 1].ravel()
        total = total + integrand(y, z) @ areas.ravel()
    return np.asarray(total)


def _weighted_integral(regions: Sequence[Region], integrand: _Integrand) -> Array:
    """Integral of a polynomial (degree ≤ 10) over several regions, each times its weight."""
    integrals = [region.weight * _polygon_integral(region.loops, integrand) for region in regions]
    return np.asarray(sum(integrals))
