"""Volume, centre and moments of a solid, and areas of its faces, by integrals over its surface."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from lumped.arrays import Array
from meshes.part.boundary import Facets
from meshes.shape_functions import gradients, quadrature, values

# Sizes of the triangles of two surface meshes, coarse by fine, and the integrals' error by their
# difference: quadratic triangles follow a surface with the fourth power of their size.
COARSENESS = 4.0
_ERROR = 1.0 / (COARSENESS**4 - 1.0)
# Meshes that are not nested miss that by less than this factor, measured on cylinders and lofts.
_SAFETY = 4.0
# Share to which the kernel's integrals are exact where they are.
ROUNDING = 1e-6
# Degree of second moments over quadratic triangles: nodes cubed, times the normal.
_DEGREE = 8


@dataclass(frozen=True, eq=False)
class VolumeProperties:
    """Of a solid of density 1: `volume` (m³), `centre` (3, m), `inertia` (3×3, m⁵) about it.

    `error` (m³): bound of that of the volume by two surface meshes; zero if the volume is exact.
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
    """Places (F×Q×3, m) in quadratic triangles and normals times weights (F×Q×3, m²) there."""
    shapes, slopes, weights = _tri6()
    corners = nodes[facets.cells]
    places = np.einsum("fki,kq->fqi", corners, shapes)
    tangents = np.einsum("fki,kjq->fqji", corners, slopes)
    normals = np.cross(tangents[:, :, 0], tangents[:, :, 1]) * weights[:, None]
    return places, normals


def enclosed(nodes: Array, faces: Sequence[Facets]) -> VolumeProperties:
    """The solid inside closed `faces` of quadratic triangles, normals outward, by Gauss's theorem.

    ∫ x_i x_j dV = ∫ x_i x_j (x · n) dA / 5, and alike for lower moments.
    """
    middle = 0.5 * (nodes.min(axis=0) + nodes.max(axis=0))
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for facets in faces:
        places, normals = _integrated(nodes - middle, facets)
        flux = np.einsum("fqi,fqi->fq", places, normals)
        volume += float(flux.sum()) / 3.0
        first += np.einsum("fq,fqi->i", flux, places) / 4.0
        second += np.einsum("fq,fqi,fqj->ij", flux, places, places) / 5.0
    centre = first / volume
    second -= volume * np.outer(centre, centre)
    inertia = np.eye(3) * np.trace(second) - second
    return VolumeProperties(volume, middle + centre, inertia)


def extrapolated(coarse: Array, fine: Array) -> Array:
    """The limit of integrals over quadratic triangles, the `coarse` ones larger by COARSENESS."""
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
    """The kernel's integrals, or if its volume is not their limit those over two surface meshes."""
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
    """Area (m²) of a face, and the `centre` (3, m) of it."""

    area: float
    centre: Array


def face_area(nodes: Array, facets: Facets) -> FaceArea:
    """Area and centre of a face of quadratic triangles."""
    places, normals = _integrated(nodes, facets)
    areas = np.linalg.norm(normals, axis=2)
    area = float(areas.sum())
    return FaceArea(area, np.einsum("fq,fqi->i", areas, places) / area)


def corrected_area(kernel: FaceArea, coarse: FaceArea, fine: FaceArea) -> FaceArea:
    """The kernel's area and centre, or if its area is not their limit those of two meshes."""
    if is_limit(kernel.area, coarse.area, fine.area):
        return kernel
    return FaceArea(
        float(extrapolated(np.array(coarse.area), np.array(fine.area))),
        extrapolated(coarse.centre, fine.centre),
    )
