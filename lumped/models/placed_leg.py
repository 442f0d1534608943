"""A leg in the axes of the body that it stands for: an idealised leg in the place of a part."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse import block_diag as sparse_block_diag
from scipy.sparse import csr_array, eye_array, issparse

from lumped.arrays import Array, SparseMatrix
from lumped.mechanism.body import Frame
from lumped.mechanism.body_model import ENDS, BodyModel, LegMatrices
from lumped.screws import turn


def placed_leg(leg: LegMatrices, frame: Frame, interfaces: Sequence[str]) -> BodyModel:
    """The leg as the model of a body with two `interfaces`, the first at the leg's root.

    `frame`: the leg's axes in those of the body. Of the unknowns only the ends' twists turn. What
    lies before the root or behind the tip moves with the section there.
    """
    back = turn(frame.rotation).T
    size = leg.size - 6 * len(ENDS)
    turned: Array | SparseMatrix
    if issparse(leg.stiffness):
        turned = csr_array(sparse_block_diag([back, back, eye_array(size)], format="csr"))
    else:
        turned = block_diag(back, back, np.eye(size))

    def displacements(points: Array) -> SparseMatrix:
        own = (points - frame.position) @ frame.rotation
        stations = np.clip(own[:, 0], 0.0, leg.length)
        arms = own - np.outer(stations, [1.0, 0.0, 0.0])
        carried = [np.hstack([frame.rotation, _carried(frame.rotation, arm)]) for arm in arms]
        twists = leg.centreline(stations) @ csr_array(turned)
        return csr_array(sparse_block_diag(carried, format="csr") @ twists)

    return BodyModel(
        leg.model,
        tuple(interfaces),
        turned.T @ leg.stiffness @ turned,
        turned.T @ leg.mass @ turned,
        displacements,
        {kind: turned.T @ part @ turned for kind, part in leg.parts.items()},
    )


def _carried(rotation: Array, arm: Array) -> Array:
    """φ ↦ R (φ × r) for rotations in leg axes."""
    return np.asarray(rotation @ np.cross(np.eye(3), arm).T)
