"""Sample nodes distributed over a part, each with the volume of the elements nearest to it."""

import numpy as np
import scipy

from lumped.arrays import Array, IntArray
from meshes.elements import ELEMENTS
from meshes.shape_functions import gradients
from meshes.solid_mesh import VolumeMesh

# Number of sample nodes: sufficient for three half waves along a leg and the corners of its
# sections.
_COUNT = 60


def spread_over(mesh: VolumeMesh) -> tuple[IntArray, Array]:
    """Numbers of at most _COUNT corner nodes, far apart, and the volume (m³) that belongs to each.

    The node farthest from those already selected is added repeatedly (Gonzalez, Theor. Comput. Sci.
    38 (1985) 293). The volume of a cell belongs to the selected node that is nearest to its centre.
    """
    corners = mesh.cells[:, list(ELEMENTS[mesh.element].corner_nodes)]
    candidates = np.unique(corners)
    positions = mesh.nodes[candidates]
    distance = np.linalg.norm(positions - positions.mean(axis=0), axis=1)
    selected: list[int] = []
    for _ in range(min(_COUNT, len(positions))):
        selected.append(int(np.argmax(distance)))
        distance_to_last = np.linalg.norm(positions - positions[selected[-1]], axis=1)
        distance = (
            distance_to_last if len(selected) == 1 else np.minimum(distance, distance_to_last)
        )
    centres = mesh.nodes[corners].mean(axis=1)
    _, nearest = scipy.spatial.cKDTree(positions[selected]).query(centres)
    volumes = np.bincount(nearest, cell_volumes(mesh), len(selected))
    return candidates[selected], np.asarray(volumes, dtype=float)


def cell_volumes(mesh: VolumeMesh) -> Array:
    """Volume (M, in m³) of each cell, from the Jacobian at its centre."""
    kind = ELEMENTS[mesh.element]
    corners = kind.nodes[list(kind.corner_nodes)]
    slopes = gradients(mesh.element, corners.mean(axis=0)[:, None])[:, :, 0]
    jacobians = np.einsum("mki,kj->mij", mesh.nodes[mesh.cells], slopes)
    share = 1.0 / 6.0 if len(corners) == 4 else 1.0
    return np.asarray(share * np.abs(np.linalg.det(jacobians)))
