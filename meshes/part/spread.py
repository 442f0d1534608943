"""A few nodes spread over a part, and how much of it is nearest to each."""

import numpy as np
import scipy

from lumped.arrays import Array, IntArray
from meshes.elements import ELEMENTS
from meshes.shape_functions import gradients
from meshes.solid_mesh import VolumeMesh

# Enough for three half waves along a leg and the corners of its sections.
_COUNT = 60


def spread_over(mesh: VolumeMesh) -> tuple[IntArray, Array]:
    """Corner nodes (rows) as far from each other as can be, and the volume (m³) next to each.

    Greedily, each the farthest from those before (Gonzalez, Theor. Comput. Sci. 38 (1985) 293). A
    cell counts where its centre is.
    """
    corners = mesh.cells[:, list(ELEMENTS[mesh.element].corner_nodes)]
    candidates = np.unique(corners)
    places = mesh.nodes[candidates]
    distance = np.linalg.norm(places - places.mean(axis=0), axis=1)
    chosen: list[int] = []
    for _ in range(min(_COUNT, len(places))):
        chosen.append(int(np.argmax(distance)))
        apart = np.linalg.norm(places - places[chosen[-1]], axis=1)
        distance = apart if len(chosen) == 1 else np.minimum(distance, apart)
    centres = mesh.nodes[corners].mean(axis=1)
    _, nearest = scipy.spatial.cKDTree(places[chosen]).query(centres)
    volumes = np.bincount(nearest, cell_volumes(mesh), len(chosen))
    return candidates[chosen], np.asarray(volumes, dtype=float)


def cell_volumes(mesh: VolumeMesh) -> Array:
    """Volume (M, m³) of each cell by its Jacobian at the centre."""
    kind = ELEMENTS[mesh.element]
    corners = kind.nodes[list(kind.corner_nodes)]
    slopes = gradients(mesh.element, corners.mean(axis=0)[:, None])[:, :, 0]
    jacobians = np.einsum("mki,kj->mij", mesh.nodes[mesh.cells], slopes)
    share = 1.0 / 6.0 if len(corners) == 4 else 1.0
    return np.asarray(share * np.abs(np.linalg.det(jacobians)))
