"""Volume, centre and moments of a solid, and areas of its faces, by integrals over its surface."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from lumped.arrays import Array
from meshes.part.boundary import Facets
from meshes.shape_functions import gradients, quadrature, values

# Ratio of the triangle sizes of two surface meshes, coarse over fine, and the ratio of the
# integrals' error to their difference: quadratic triangles have errors of fourth order in size.
COARSENESS = 4.0
_ERROR = 1.0 / (COARSENESS**4 - 1.0)
# Factor on this error, because meshes are not nested; measured on cylinders and lofts.
_SAFETY = 4.0
# Relative error of the kernel's integrals over elementary faces.
ROUNDING = 1e-6
# Degree of second moments over quadratic triangles: nodes cubed, times the normal.
_DEGREE = 8


@dataclass(frozen=True, eq=False)
class VolumeProperties:
    """Properties at density 1: `volume` (m³), `centre` (3, m), `inertia` about it (3×3, m⁵).

    `error` (m³): bound on the error of the volume from two surface meshes; zero if it is exact.
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
    """Points (F×Q×3, m) of quadratic triangles and normals times weights (F×Q×3, m²) there."""
    shapes, slopes, weights = _tri6()
    corners = nodes[facets.cells]
    points = np.einsum("fki,kq->fqi", corners, shapes)
    tangents = np.einsum("fki,kjq->fqji", corners, slopes)
    normals = np.cross(tangents[:, :, 0], tangents[:, :, 1]) * weights[:, None]
    return points, normals


def enclosed(nodes: Array, faces: Sequence[Facets]) -> VolumeProperties:
    """Properties of the solid inside closed `faces` of quadratic triangles, by Gauss's theorem.

    Normals outward. ∫ x_i x_j dV = ∫ x_i x_j (x · n) dA / 5, and likewise for lower moments.
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
    """Limit of integrals over `coarse` and `fine` triangles with size ratio COARSENESS."""
    return fine + _ERROR * (fine - coarse)


def half_width(coarse: float, fine: float) -> float:
    """Half-width of the uncertainty of the limit of two such integrals."""
    return _SAFETY * _ERROR * abs(fine - coarse)


def is_limit(kernel: float, coarse: float, fine: float) -> bool:
    """True if an integral of the CAD kernel is the limit of those over two surface meshes."""
    limit = fine + _ERROR * (fine - coarse)
    return abs(kernel - limit) <= half_width(coarse, fine) + ROUNDING * abs(kernel)


def corrected(
    kernel: VolumeProperties, coarse: VolumeProperties, fine: VolumeProperties
) -> VolumeProperties:
    """The kernel's integrals if its volume is the limit of two meshes, else the limit of these."""
    if is_limit(kernel.volume, coarse.volume, fine.volume):
        return kernel
    return VolumeProperties(
        float(extrapolated(np.array(coarse.volume), np.array(fine.volume))),
        extrapolated(coarse.centre, fine.centre),
        extrapolated(coarse.inertia, fine.inertia),
        half_width(coarse.volume, fine.volume),
    )


@dataclass(frozen=True, eq=False)
class FaceArea:
    """Area (m²) of a face and its `centre` (3, m)."""

    area: float
    centre: Array


def face_area(nodes: Array, facets: Facets) -> FaceArea:
    """Area and centre of a face of quadratic triangles."""
    points, normals = _integrated(nodes, facets)
    areas = np.linalg.norm(normals, axis=2)
    area = float(areas.sum())
    return FaceArea(area, np.einsum("fq,fqi->i", areas, points) / area)


def corrected_area(kernel: FaceArea, coarse: FaceArea, fine: FaceArea) -> FaceArea:
    """The kernel's area and centre if its area is the limit of two meshes, else that limit."""
    if is_limit(kernel.area, coarse.area, fine.area):
        return kernel
    return FaceArea(
        float(extrapolated(np.array(coarse.area), np.array(fine.area))),
        extrapolated(coarse.centre, fine.centre),
    )
