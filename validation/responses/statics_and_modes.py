"""Responses of one model of a robot in P poses: statics, and modes with harmonic responses."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from lumped.acceptance.quantities import Quantity, QuantityKind
from lumped.arrays import Array, ComplexArray
from validation.responses.mode_pairing import SampledModes, sampled_modes


@dataclass(frozen=True, eq=False)
class Unsolved:
    """A half of a response that a model defines but that cannot be computed, with the `reason`.

    `fault`: True if the reason is an error of the program, not of the robot.
    """

    reason: str
    fault: bool = False


@dataclass(frozen=True, eq=False)
class Statics:
    """Displacements of the loaded point, base axes.

    `compliances` (P×6×6, SI) at that point; zeros mean rigid. `load_displacements` (P×L×6, m and
    rad) belong to the loads of the robot file, in its order.
    """

    compliances: Array
    load_displacements: Array

    @classmethod
    def of(cls, compliances: Array, load_displacements: Array) -> "Statics":
        """Statics with zeros for loads (NaN) that the mechanism cannot follow."""
        return cls(compliances, np.nan_to_num(load_displacements))

    def __sub__(self, other: "Statics") -> "Statics":
        return Statics(
            self.compliances - other.compliances,
            self.load_displacements - other.load_displacements,
        )

    def __rmul__(self, factor: float) -> "Statics":
        return Statics(factor * self.compliances, factor * self.load_displacements)

    def displacements(self, quantity: Quantity, wrenches: Array) -> Array:
        """Translations, or rotations if the quantity is one (P×…×3), under wrenches (P×…×6).

        If the quantity belongs to a load of the robot file, displacements under that load; the
        wrenches then give the shape of the result alone.
        """
        if quantity.kind is QuantityKind.LOAD:
            poses, *inner_shape, _ = wrenches.shape
            twists = self.load_displacements[:, quantity.column].reshape(
                poses, *(1,) * len(inner_shape), 6
            )
            twists = np.broadcast_to(twists, wrenches.shape)
        else:
            twists = np.einsum("pij,p...j->p...i", self.compliances, wrenches)
        return np.asarray(twists[..., 3:] if quantity.rotational else twists[..., :3])


@dataclass(frozen=True, eq=False)
class PathModes:
    """Natural modes: `frequencies` (P×m, Hz), `samples` (P×k×m) of shapes, `weights` (k, kg).

    All models of a robot are sampled at the same points of its bodies, so that shapes can be
    compared. NaN stands for a mode that a model does not have in a pose. `seen` (P×m) is the share
    of each mode's kinetic energy that the samples see. `peaks` (P×q) are the judged numbers of the
    tool's responses, infinite without damping; `receptances` (P×n each, m/N) the responses to each
    of the excitations.
    """

    frequencies: Array
    samples: Array
    weights: Array
    seen: Array
    peaks: Array = field(default_factory=lambda: np.zeros((0, 0)))
    receptances: Sequence[ComplexArray] = ()

    def at(self, pose: int) -> SampledModes:
        """Existing modes in a pose (its index)."""
        exists = np.isfinite(self.frequencies[pose])
        shapes = self.samples[pose][:, exists] * np.sqrt(self.weights)[:, None]
        return sampled_modes(self.frequencies[pose, exists], shapes, self.seen[pose, exists])
