"""Volume, centre and moments of a solid, and areas of its faces, by integrals over its surface.

These integrals check those of gmsh's geometry kernel (OpenCASCADE), called CAD kernel here.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from lumped.arrays import Array
from meshes.part.boundary import Facets
from meshes.shape_functions import gradients, quadrature, values

# Ratio of the triangle sizes of two surface meshes, coarse to fine, and ratio of the error of the
# fine integral to the difference of both: errors of quadratic triangles are of fourth order in
# size.
COARSENESS = 4.0
_ERROR = 1.0 / (COARSENESS**4 - 1.0)
# Factor on this error, because the meshes are not nested. Observed on cylinders and lofts.
_SAFETY = 4.0
# Relative error of the kernel's integrals over planes, cylinders, cones, spheres and tori.
ROUNDING = 1e-6
# Degree of the integrand of second moments over quadratic triangles: position cubed times normal.
_DEGREE = 8


@dataclass(frozen=True, eq=False)
class VolumeProperties:
    """Volume properties of a solid: `volume` (m³), `centre` (3, in m), `inertia` (3×3, in m⁵).

    The inertia is the moment of inertia about the centre for density 1. `error` (m³) is the
    half-width of the volume's uncertainty if the volume was extrapolated from two surface meshes.
    Zero if the volume is exact.
    """

    volume: float
    centre: Array
    inertia: Array
    error: float = 0.0


@cache
def _tri6() -> tuple[Array, Array, Array]:
    points, weights = quadrature("tri6", _DEGREE)
    return values("tri6", points), gradients("tri6", points), weights


def _integrated(nodes: Array, facets: Facets) -> tuple[Array, Array]:
    """Quadrature points (F×Q×3, in m) of F quadratic triangles, and weighted normals at them.

    The normals (F×Q×3, in m²) are multiplied by the quadrature weights, so that their lengths are
    areas.
    """
    shapes, slopes, weights = _tri6()
    corners = nodes[facets.cells]
    points = np.einsum("fki,kq->fqi", corners, shapes)
    tangents = np.einsum("fki,kjq->fqji", corners, slopes)
    normals = np.cross(tangents[:, :, 0], tangents[:, :, 1]) * weights[:, None]
    return points, normals


def enclosed(nodes: Array, faces: Sequence[Facets]) -> VolumeProperties:
    """Volume properties of the solid enclosed by `faces` of quadratic triangles.

    By Gauss's theorem, ∫ x_i x_j dV = ∫ x_i x_j (x · n) dA / 5 with the outward normal n, and
    similarly for lower moments.
    """
    middle = 0.5 * (nodes.min(axis=0) + nodes.max(axis=0))
    volume, first_moments, second_moments = 0.0, np.zeros(3), np.zeros((3, 3))
    for facets in faces:
        points, normals = _integrated(nodes - middle, facets)
        flux = np.einsum("fqi,fqi->fq", points, normals)
        volume += float(flux.sum()) / 3.0
        first_moments += np.einsum("fq,fqi->i", flux, points) / 4.0
        second_moments += np.einsum("fq,fqi,fqj->ij", flux, points, points) / 5.0
    centre = first_moments / volume
    second_moments -= volume * np.outer(centre, centre)
    inertia = np.eye(3) * np.trace(second_moments) - second_moments
    return VolumeProperties(volume, middle + centre, inertia)


def extrapolated(coarse: Array, fine: Array) -> Array:
    """Integral over a surface, extrapolated from its values for coarse and for fine triangles.

    The ratio of the sizes of the triangles is COARSENESS.
    """
    return fine + _ERROR * (fine - coarse)


def half_width(coarse: float, fine: float) -> float:
    """Half-width of the uncertainty of an integral extrapolated from its values on two meshes."""
    return _SAFETY * _ERROR * abs(fine - coarse)


def is_confirmed(kernel: float, coarse: float, fine: float) -> bool:
    """True if `kernel`, an integral by the CAD kernel, is confirmed by two surface meshes.

    `coarse` and `fine` are the values of the same integral on these meshes. The integral is
    confirmed if it agrees with the value extrapolated from them, within the uncertainty of the
    extrapolation.
    """
    limit = fine + _ERROR * (fine - coarse)
    return abs(kernel - limit) <= half_width(coarse, fine) + ROUNDING * abs(kernel)


def corrected(
    kernel: VolumeProperties, coarse: VolumeProperties, fine: VolumeProperties
) -> VolumeProperties:
    """Volume properties by the CAD kernel, or by two surface meshes if these contradict its volume.

    In the second case they are extrapolated from the properties `coarse` and `fine` on the two
    meshes.
    """
    if is_confirmed(kernel.volume, coarse.volume, fine.volume):
        return kernel
    return VolumeProperties(
        float(extrapolated(np.array(coarse.volume), np.array(fine.volume))),
        extrapolated(coarse.centre, fine.centre),
        extrapolated(coarse.inertia, fine.inertia),
        half_width(coarse.volume, fine.volume),
    )


@dataclass(frozen=True, eq=False)
class FaceArea:
    """Area (m²) of a face, and the centre (3, in m) of the area."""

    area: float
    centre: Array


def face_area(nodes: Array, facets: Facets) -> FaceArea:
    """Area and centre of a face that consists of quadratic triangles."""
    points, normals = _integrated(nodes, facets)
    areas = np.linalg.norm(normals, axis=2)
    area = float(areas.sum())
    return FaceArea(area, np.einsum("fq,fqi->i", areas, points) / area)


def corrected_area(kernel: FaceArea, coarse: FaceArea, fine: FaceArea) -> FaceArea:
    """Area and centre of a face by the CAD kernel, or by two surface meshes if they contradict it.

    In the second case they are extrapolated from the values `coarse` and `fine` on the two meshes.
    """
    if is_confirmed(kernel.area, coarse.area, fine.area):
        return kernel
    return FaceArea(
        float(extrapolated(np.array(coarse.area), np.array(fine.area))),
        extrapolated(coarse.centre, fine.centre),
    )
