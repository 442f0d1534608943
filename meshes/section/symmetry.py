"""Exact symmetry for meshes that are symmetric up to the accuracy of their generator."""

import numpy as np
from scipy.spatial import cKDTree

from lumped.arrays import Array
from lumped.errors import ComputationError


def symmetrised(nodes: Array, part: str) -> Array:
    """Nodes (N×2) moved to the mean of their own places and those of their mirror images.

    Gmsh spaces points on arcs to about 1e-9 of their length; a section symmetric to rounding has
    products of inertia and couplings that vanish to rounding. Raises ComputationError naming
    `part` where a node has no mirror image within 1e-6 of the section's size.
    """
    tolerance = 1e-6 * float(np.ptp(nodes, axis=0).max())
    for mirror in ([-1.0, 1.0], [1.0, -1.0]):
        images = nodes * mirror
        distance, partner = cKDTree(images).query(nodes)
        if distance.max() > tolerance:
            raise ComputationError(f"{part}: the mesh is not symmetric about its section's axes")
        nodes = (nodes + images[partner]) / 2.0
    return nodes
