"""Tension, torsion and bending of a round tube of orthotropic layers, by exact elasticity.

In a round tube, the fields of tension and torsion depend on the radius r alone, and those of
bending in proportion to cos θ or sin θ of the angle around the axis (S. G. Lekhnitskii, Theory of
Elasticity of an Anisotropic Body, ch. 3 and 4). With x along the tube, s along the circumference
and n along the radius, the strains are

    tension, torsion   εx = e, εs = U/r, εn = U′, γxs = r τ
    bending            εx = κ r cos θ, εs = (U + V)/r cos θ, εn = U′ cos θ, γxs = W/r cos θ,
                       γsn = (V′ − (U + V)/r) sin θ, γxn = W′ sin θ

for the axial strain e, the rate of twist τ and the curvature κ. The functions U, V and W of r are
found by one-dimensional quadratic elements, one in each layer, such that the strain energy is
smallest. Unlike laminate theory for thin walls, this includes that layers lie at different radii,
contract across the wall, and shear across it.
"""

from collections.abc import Callable

import numpy as np
from numpy.polynomial import legendre

from fem.sections.moduli import in_wall
from lumped.arrays import Array
from lumped.sections import LaminateTube

_POINTS, _WEIGHTS = legendre.leggauss(4)
# Values and derivatives (3×4) of the functions of a quadratic element from −1 to 1.
_VALUES = np.stack(
    [0.5 * _POINTS * (_POINTS - 1.0), 1.0 - _POINTS**2, 0.5 * _POINTS * (_POINTS + 1.0)]
)
_SLOPES = np.stack([_POINTS - 0.5, -2.0 * _POINTS, _POINTS + 0.5])


def ring_stiffnesses(section: LaminateTube) -> dict[str, float]:
    """Stiffnesses "EA" (N), "GJ", "EIy" and "EIz" (N m²) of a tube of layers.

    All other stress resultants are zero.
    """
    axial = np.linalg.inv(_condensed(section, 1, _axial_strains, 2.0 * np.pi))
    (bending,) = _condensed(section, 3, _bending_strains, np.pi).ravel()
    stiffnesses = {"EA": 1.0 / axial[0, 0], "GJ": 1.0 / axial[1, 1]}
    return {**stiffnesses, "EIy": float(bending), "EIz": float(bending)}


def thin_wall_stiffnesses(section: LaminateTube) -> dict[str, float]:
    """Stiffnesses like those of `ring_stiffnesses`, by laminate theory for thin walls.

    They are sums over the layers as tubes of their own. The plane stress stiffness of each layer
    follows from its elasticity in three dimensions, and not from `Layer`, so that the ratio to
    `ring_stiffnesses` is that of the theory and not of its implementation.
    """
    outer = 0.5 * section.diameter - section.thickness + np.cumsum(section.thicknesses)
    inner = outer - section.thicknesses
    planes = np.array([_plane_stress(in_wall(layer)) for layer in section.layers])

    def summed(weights: Array) -> Array:
        return np.asarray(np.tensordot(weights, planes, axes=1))

    moments = 0.25 * np.pi * (outer**4 - inner**4)
    wall = summed(section.thicknesses)
    freed = 1.0 / (np.linalg.inv(wall)[2, 2] * wall[2, 2])
    tension, bending = (
        float(1.0 / np.linalg.inv(summed(weights))[0, 0])
        for weights in (np.pi * (outer**2 - inner**2), moments)
    )
    torsion = float(freed * summed(2.0 * moments)[2, 2])
    return {"EA": tension, "GJ": torsion, "EIy": bending, "EIz": bending}


def _plane_stress(elasticity: Array) -> Array:
    """Stiffness (3×3) for εx, εs and γxs without stress along the normal of the wall."""
    inside, normal = [0, 1, 5], 2
    coupling = elasticity[inside, normal]
    return np.asarray(
        elasticity[np.ix_(inside, inside)]
        - np.outer(coupling, coupling) / elasticity[normal, normal]
    )


def _axial_strains(radii: Array, slopes: Array) -> Array:
    """Strains (4×6×5) for U at three nodes, for e and for τ."""
    strains = np.zeros((len(radii), 6, 5))
    strains[:, 1, :3], strains[:, 2, :3] = (_VALUES / radii).T, slopes.T
    strains[:, 0, 3], strains[:, 5, 4] = 1.0, radii
    return strains


def _bending_strains(radii: Array, slopes: Array) -> Array:
    """Amplitudes (4×6×10) of the strains for U, V, W at three nodes in turn, and for κ."""
    strains = np.zeros((len(radii), 6, 10))
    hoop, slope = (_VALUES / radii).T, slopes.T
    strains[:, 1, 0:9:3] = strains[:, 1, 1:9:3] = hoop
    strains[:, 2, 0:9:3] = slope
    strains[:, 3, 0:9:3], strains[:, 3, 1:9:3] = -hoop, slope - hoop
    strains[:, 4, 2:9:3], strains[:, 5, 2:9:3] = slope, hoop
    strains[:, 0, 9] = radii
    return strains


def _condensed(
    section: LaminateTube,
    functions: int,
    strains_at: Callable[[Array, Array], Array],
    around: float,
) -> Array:
    """Stiffness for the global strains (e and τ, or κ), without the `functions` of the radius.

    `strains_at` returns the strains at radii of an element, for the unknowns of its nodes and the
    global strains. `around` is the integral of their products around the axis.
    """
    count = functions * (2 * len(section.layers) + 1)
    inner = 0.5 * section.diameter - section.thickness
    total = 2 if functions == 1 else 1
    stiffness = np.zeros((count + total, count + total))
    for number, layer in enumerate(section.layers):
        half = 0.5 * layer.thickness
        radii = inner + half * (1.0 + _POINTS)
        strains = strains_at(radii, _SLOPES / half)
        weights = around * half * _WEIGHTS * radii
        element = np.einsum("q,qai,ab,qbj->ij", weights, strains, in_wall(layer), strains)
        nodes = 2 * functions * number + np.arange(3 * functions)
        places = np.concatenate([nodes, count + np.arange(total)])
        stiffness[np.ix_(places, places)] += element
        inner += layer.thickness
    # A translation of the section is U = −V: V of the first node is zero.
    inside = np.setdiff1d(np.arange(count), [1] if functions > 1 else [])
    outside = np.arange(count, count + total)
    own, coupling = stiffness[np.ix_(inside, inside)], stiffness[np.ix_(inside, outside)]
    return np.asarray(
        stiffness[np.ix_(outside, outside)] - coupling.T @ np.linalg.solve(own, coupling)
    )
