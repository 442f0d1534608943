"""Matrix structural analysis: every leg by its stiffness between its two interfaces.

The 12×12 of a prism is that of its tip's compliance, root clamped, completed by equilibrium; that
of a leg given by its 6×6 likewise. Static: nothing is said about where a body's mass moves.
"""

from collections.abc import Mapping

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Mechanism
from lumped.screws import shift


def links(mechanism: Mechanism, legs: Mapping[str, Array]) -> dict[str, LegMatrices]:
    """Every leg by its tip compliance (`legs`, 6×6, SI, body axes), by name."""
    lengths = {
        name: float(np.linalg.norm(tip.position - root.position))
        for name in legs
        for root, tip in [mechanism.bodies[name].interfaces.values()]
    }
    return {name: link(lengths[name], compliance) for name, compliance in legs.items()}


def link(length: float, compliance: Array) -> LegMatrices:
    """A leg of the given tip compliance (6×6, SI, leg axes, root clamped), without mass.

    Between its ends it is drawn as a straight line.
    """
    relative = np.hstack([-shift(np.array([length, 0.0, 0.0])), np.eye(6)])
    stiffness: Array = relative.T @ np.linalg.inv(compliance) @ relative

    def centreline(stations: Array) -> Array:
        share = np.asarray(stations, dtype=float) / length
        return np.kron(np.column_stack([1.0 - share, share]), np.eye(6)).astype(float)

    return LegMatrices(
        model="link",
        length=length,
        stiffness=0.5 * (stiffness + stiffness.T),
        mass=np.zeros((12, 12)),
        centreline=centreline,
    )
