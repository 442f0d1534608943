"""Symmetry of a prism under a reversal of its axis, x → −x.

If planes across the axis are planes of symmetry of the materials, the prism is its own mirror
image. Fibres that are inclined to the axis have no such planes. A wall of fibres that is equal all
around its section is nevertheless its own image after half a turn about y. Either reversal is a
linear map P of the displacements u of a section, with P² = 1. The matrices E₀ and E₂ of the prism
(see `fem.couplings.section_fields`) do not couple fields with Pu = −u ("odd") and fields with Pu =
u ("even"). E₁ couples only odd with even fields.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from scipy.sparse import csr_array

from fem.sections.moduli import Moduli
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.legs import Material

# Largest distance between a node and the image of another, relative to the section's size.
_SAME_PLACE = 1e-6
# Signs of displacements and rotations (x y z φx φy φz) of a reversed section.
_MIRROR = np.array([-1.0, 1.0, 1.0, 1.0, -1.0, -1.0])
_HALF_TURN = np.array([-1.0, 1.0, -1.0, -1.0, 1.0, -1.0])


@dataclass(frozen=True, eq=False)
class Reversal:
    """Reversal of a prism with N nodes in its section.

    `images` (N) contains, for each node, the index of the node at the place to which the reversal
    moves it. `twists` (6) are the signs by which the reversal multiplies a twist (x y z φx φy φz)
    of the section.
    """

    images: IntArray
    twists: Array

    @property
    def matrix(self) -> SparseMatrix:
        """Matrix P (csr 3N×3N) from displacements of the section to those after the reversal."""
        unknowns = np.arange(3 * len(self.images))
        rows = 3 * self.images[unknowns // 3] + unknowns % 3
        signs = self.twists[unknowns % 3]
        return csr_array((signs, (rows, unknowns)), shape=(len(rows),) * 2)

    @cached_property
    def odd(self) -> SparseMatrix:
        """Orthonormal basis (csr 3N×n) of the fields that the reversal multiplies by −1."""
        return self.basis(-1.0)

    @cached_property
    def even(self) -> SparseMatrix:
        """Orthonormal basis (csr 3N×n) of the fields that the reversal does not change."""
        return self.basis(1.0)

    def basis(
        self, sign: float, mirrors: Sequence[tuple[IntArray, Sequence[float]]] = ()
    ) -> SparseMatrix:
        """Orthonormal basis (csr 3N×n) of the fields that the reversal multiplies by `sign`.

        `mirrors` are further symmetries of the fields. Each is a pair: the index of the image of
        each node, and the sign of each of the three displacement components at the image.
        """
        parts = []
        for component in range(3):
            own = sign * float(self.twists[component])
            symmetries = [(images, signs[component]) for images, signs in mirrors]
            parts.append(_orbits([*symmetries, (self.images, own)], component))
        return csr_array(np.hstack(parts))


def reversal_of(nodes: Array, material: Material | Moduli) -> Reversal:
    """Reversal of a prism with `nodes` (N×2; y, z in m) in its section.

    Raises ValueError for inclined fibres if the nodes are not symmetric about the y axis.
    """
    if not isinstance(material, Moduli) or not material.inclined:
        return Reversal(np.arange(len(nodes)), _MIRROR)
    images = images_of(nodes, (1.0, -1.0))
    if images is None:
        raise ValueError("a section of inclined fibres must have nodes symmetric about y")
    return Reversal(images, _HALF_TURN)


def images_of(nodes: Array, signs: tuple[float, float]) -> IntArray | None:
    """Index (N) of the node at the image of each node. None if the mesh is not symmetric.

    `nodes` are N×2 (y, z in m). At the image of a node, y and z are multiplied by `signs`.
    """
    size = float(np.ptp(nodes, axis=0).max())
    distance, partner = scipy.spatial.cKDTree(nodes).query(nodes * np.array(signs))
    if distance.max() > _SAME_PLACE * size:
        return None
    return np.asarray(partner)


def _orbits(symmetries: Sequence[tuple[IntArray, float]], component: int) -> Array:
    """Orthonormal fields (3N×n) of one displacement `component` with the given `symmetries`.

    A symmetry is a pair: the index of the image of each node (N), and a sign. Each field is the
    normalised sum of unit displacements of a node and of all its images, with the products of these
    signs. Sums that vanish are omitted.
    """
    count = len(symmetries[0][0])
    images, weights = np.arange(count)[None], np.ones(1)
    for mirror, sign in symmetries:
        images = np.vstack([images, mirror[images]])
        weights = np.concatenate([weights, sign * weights])
    representatives = np.flatnonzero(images.min(axis=0) == np.arange(count))
    columns = np.zeros((3 * count, len(representatives)))
    for image, weight in zip(images, weights, strict=True):
        np.add.at(
            columns,
            (3 * image[representatives] + component, np.arange(len(representatives))),
            weight,
        )
    norms = np.linalg.norm(columns, axis=0)
    # Nodes on an axis of antisymmetry do not move.
    return np.asarray(columns[:, norms > 0.5] / norms[norms > 0.5])
