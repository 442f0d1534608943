"""Matrix structural analysis: every deformable body by its stiffness between its two interfaces.

The 12×12 of a prism is that of its tip's compliance, root clamped, completed by equilibrium; that
of a leg given by its 6×6 likewise. Static: nothing is said about where a body's mass moves.
"""

from collections.abc import Mapping

import numpy as np
from scipy.sparse import csr_array

from lumped.arrays import Array, SparseMatrix
from lumped.mechanism.body import Body
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Mechanism
from lumped.screws import shift


def links(mechanism: Mechanism, legs: Mapping[str, Array]) -> dict[str, BodyModel]:
    """Every leg by its tip compliance (`legs`, 6×6, SI, body axes), by name."""
    return {name: link(mechanism.bodies[name], compliance) for name, compliance in legs.items()}


def link(body: Body, compliance: Array) -> BodyModel:
    """A leg of the given tip compliance (6×6, SI, leg axes, root clamped), without mass.

    Between its ends it is drawn as a straight line.
    """
    root, tip = body.interfaces.values()
    offset = tip.position - root.position
    relative = np.hstack([-shift(offset), np.eye(6)])
    stiffness: Array = relative.T @ np.linalg.inv(compliance) @ relative

    def displacements(points: Array) -> SparseMatrix:
        share = np.clip((points - root.position) @ offset / (offset @ offset), 0.0, 1.0)
        across = points - root.position - share[:, None] * offset
        blocks = [
            np.hstack([(1.0 - s) * carried, s * carried])
            for s, carried in zip(share, (shift(r)[:3] for r in across), strict=True)
        ]
        return csr_array(np.vstack(blocks))

    return BodyModel(
        model="link",
        interfaces=tuple(body.interfaces),
        stiffness=0.5 * (stiffness + stiffness.T),
        mass=np.zeros((12, 12)),
        displacements=displacements,
    )
