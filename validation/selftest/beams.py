"""NAFEMS FV2 by beam elements: seven equal eigenvalues."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from fem.beams.beam_theory import Kind
from fem.beams.frame import BeamFrame, Component, Member, Support, assemble, modes
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle
from validation.selftest.benchmark import Benchmark, KnownNumber

FV2 = "NAFEMS, The Standard NAFEMS Benchmarks, TNSB rev. 3 (1990), Test FV2"
REASON = "0.1 % of the theory column, which has four digits; the beams' own error is below 0.01 %"
TOLERANCE = 1e-3
ARM = ConstantLeg(5.0, Rectangle(0.125, 0.125), Material.isotropic(2e11, 0.3, 8000.0))
ARMS = 8
# What is held where arms only turn about z.
IN_PLANE: tuple[Component, ...] = ("x", "y", "z", "φx", "φy")
_ELEMENTS = 16


@dataclass(frozen=True)
class Cluster:
    """Modes `first` to `last` (from 1) of one frequency `target` (Hz)."""

    first: int
    last: int
    target: float
    meaning: str

    @property
    def quantity(self) -> str:
        """Such as "f3, torsion 1" or "f1 to f2, bending 1"."""
        numbers = f"f{self.first}" + (f" to f{self.last}" if self.last > self.first else "")
        return f"{numbers}, {self.meaning}"


FV2_CLUSTERS = (
    Cluster(1, 1, 11.336, "arms pinned at both ends"),
    Cluster(2, 8, 17.709, "arms pinned and clamped"),
    Cluster(9, 9, 45.345, "arms pinned at both ends, second"),
    Cluster(10, 16, 57.390, "arms pinned and clamped, second"),
)


def benchmarks() -> tuple[Benchmark, ...]:
    """A double cross of Euler–Bernoulli beams."""
    return (
        Benchmark(
            "NAFEMS FV2, pin-ended double cross, by Euler–Bernoulli beams",
            "Natural frequencies in the plane of eight arms of 5 m with a square section of "
            "0.125 m, pinned at their ends and joined in the middle: E = 200 GPa, "
            "ρ = 8000 kg/m³. The arms do not stretch, as in the theory: seven modes are of one "
            f"frequency. {_ELEMENTS} elements an arm.",
            FV2,
            REASON,
            lambda: clusters(double_cross(_ELEMENTS), FV2_CLUSTERS),
        ),
    )


def clusters(frame: BeamFrame, published: Sequence[Cluster]) -> list[KnownNumber]:
    """The worst frequency of each cluster beside its target."""
    found = modes(assemble(frame), published[-1].last).frequencies
    return [
        KnownNumber(one.quantity, "Hz", one.target, farthest(found, one), TOLERANCE)
        for one in published
    ]


def farthest(frequencies: Array, cluster: Cluster) -> float:
    """The frequency (Hz) of the cluster that is farthest from its target."""
    own = frequencies[cluster.first - 1 : cluster.last]
    return float(own[np.argmax(np.abs(own - cluster.target))])


def double_cross(
    elements: int,
    kinds: tuple[Kind, ...] = ("bending z",),
    crossing: Support | None = None,
) -> BeamFrame:
    """FV2: arms of `kinds`, by default those that bend, around a crossing that turns alone."""
    angles = np.arange(ARMS) * 2.0 * pi / ARMS
    pins = ARM.length * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(ARMS)])
    beam = ARM.properties("euler-bernoulli")
    numbers = range(1, ARMS + 1)
    return BeamFrame(
        "NAFEMS FV2",
        np.vstack([np.zeros(3), pins]),
        tuple(Member(n, 0, beam, (0.0, 0.0, 1.0), elements, kinds=kinds) for n in numbers),
        (crossing or Support(0, IN_PLANE), *(Support(n, IN_PLANE) for n in numbers)),
    )
