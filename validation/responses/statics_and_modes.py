"""Data records of one model in P poses: displacements, and modes with harmonic responses.

`Statics` contains the displacements, `PathModes` the modes, `Unsolved` the reason if one of them
could not be computed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from lumped.acceptance.quantities import Quantity, QuantityKind
from lumped.arrays import Array, ComplexArray
from validation.responses.mode_pairing import SampledModes, sampled_modes


@dataclass(frozen=True, eq=False)
class Unsolved:
    """Reason why statics or modes that a model defines could not be computed.

    `fault` is true if the reason is an error of the program, not of the robot.
    """

    reason: str
    fault: bool = False


@dataclass(frozen=True, eq=False)
class Statics:
    """Compliance of the loaded point and its displacements under the file's loads, in base axes.

    `compliances` (P×6×6, SI): matrices that map a wrench at that point to its twist; zeros mean
    rigid. `load_displacements` (P×L×6, m and rad): twists under the L loads of the robot file, in
    its order. NaN in poses where the tool cannot move as the load requires. `idle` (P): number of
    mobilities that do not move the tool, () if it is not needed. Array sizes: P poses.
    """

    compliances: Array
    load_displacements: Array
    idle: Sequence[int | None] = ()

    def __sub__(self, other: "Statics") -> "Statics":
        return Statics(
            self.compliances - other.compliances,
            self.load_displacements - other.load_displacements,
        )

    def __rmul__(self, factor: float) -> "Statics":
        return Statics(factor * self.compliances, factor * self.load_displacements)

    def displacements(self, quantity: Quantity, wrenches: Array) -> Array:
        """Displacements (P×…×3, m or rad) under wrenches (P×…×6, N and N m).

        They are translations, or rotations if `quantity` is a rotation. If `quantity` is that of a
        load of the robot file, they are the displacements under this load, and only the shape of
        `wrenches` is used. Array sizes: P poses.
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
    """Natural modes and harmonic responses of one model in P poses.

    `frequencies` (P×m, Hz): NaN for a mode that the model does not have in a pose. `samples`
    (P×k×m): mode shapes at the sample points, the same for all models of a robot. `weights` (k,
    kg): mass of each sample. `energy_shares` (P×m): share of each mode's kinetic energy that the
    samples contain. `peaks` (P×q): values of the q judged quantities of harmonic responses of the
    tool, such as height (m/N) and frequency (Hz) of a peak; infinite without damping.
    `receptances`: one array (P×n, m/N) for each excitation, with n frequencies. Array sizes: k
    samples, m modes.
    """

    frequencies: Array
    samples: Array
    weights: Array
    energy_shares: Array
    peaks: Array = field(default_factory=lambda: np.zeros((0, 0)))
    receptances: Sequence[ComplexArray] = ()

    @classmethod
    def unsampled(cls, frequencies: Array) -> "PathModes":
        """Modes with `frequencies` (P×m, Hz) and without shapes.

        They cannot be compared with modes of other models.
        """
        samples = np.zeros((len(frequencies), 0, frequencies.shape[1]))
        return cls(frequencies, samples, np.zeros(0), np.ones_like(frequencies))

    def first(self, count: int) -> "PathModes":
        """Record of the first `count` modes only."""
        return replace(
            self,
            frequencies=self.frequencies[:, :count],
            samples=self.samples[:, :, :count],
            energy_shares=self.energy_shares[:, :count],
        )

    def at(self, pose: int) -> SampledModes:
        """Modes that the model has in the pose with this index."""
        exists = np.isfinite(self.frequencies[pose])
        shapes = self.samples[pose][:, exists] * np.sqrt(self.weights)[:, None]
        return sampled_modes(
            self.frequencies[pose, exists], shapes, self.energy_shares[pose, exists]
        )
