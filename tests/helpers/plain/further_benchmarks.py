"""Published benchmarks that no machine of a user could fail, in the form of `flexproof selftest`.

They are beams that are exact or nearly so, and series: tests solve them, and the verification
manual shows them beside those of the self-test.
"""

from math import cos, pi, sin, sqrt, tan, tanh

import numpy as np
from scipy.optimize import brentq

from fem.beams.frame import BeamFrame, Member, Support, assemble, displacements
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle, rectangle_torsion_constant
from validation.selftest import beams, solids
from validation.selftest.beams import ARM, FV2, REASON, TOLERANCE, Cluster
from validation.selftest.benchmark import Benchmark, KnownNumber

TEST_71 = (
    "F. Abbassian, D. J. Dawswell, N. C. Knowles, Selected Benchmarks for Natural Frequency "
    "Analysis, NAFEMS (1987), Test 71"
)
SLENDER = ConstantLeg(10.0, Rectangle(0.125, 0.125), Material.isotropic(2e11, 0.3, 8000.0))
FV5_CLUSTERS = tuple(cluster for cluster, *_ in solids.FV5_MODES)
TEST_71_CLUSTERS = tuple(
    Cluster(k, k, target, f"bending {k}")
    for k, target in enumerate((1.010, 6.327, 17.716, 34.717, 57.390, 85.730), start=1)
)
# J/(b h³), beside those of the self-test.
TORSION_CONSTANTS = solids.TORSION_CONSTANTS | {
    1.2: 0.166119,
    1.5: 0.195761,
    2.5: 0.249365,
    3.0: 0.263317,
    4.0: 0.280813,
    5.0: 0.291317,
}
# Two modes of each seven move the crossing, against the stretching of the arms.
MOVING_CLUSTERS = (
    Cluster(2, 3, 17.709, "arms pinned and clamped, the crossing moves"),
    Cluster(10, 11, 57.390, "arms pinned and clamped, second, the crossing moves"),
)


def benchmarks() -> tuple[Benchmark, ...]:
    """All of them."""
    return (
        Benchmark(
            "NAFEMS FV5, deep simply supported beam, by Timoshenko beams",
            "The beam of 10 m with a square section of 2 m, its ends held as those of the solid. "
            "32 elements.",
            solids.FV5,
            REASON,
            lambda: beams.clusters(deep_beam(32), FV5_CLUSTERS),
        ),
        Benchmark(
            "NAFEMS Test 71, slender cantilever, by Euler–Bernoulli beams",
            "Bending frequencies in one plane of a cantilever of 10 m with a square section of "
            "0.125 m: E = 200 GPa, ρ = 8000 kg/m³. 32 elements.",
            TEST_71,
            REASON,
            lambda: beams.clusters(slender_cantilever(32), TEST_71_CLUSTERS),
        ),
        Benchmark(
            "MacNeal–Harder's straight cantilever by a Timoshenko beam",
            "The cantilever of 6 × 0.2 × 0.1 as one beam element.",
            solids.MACNEAL_HARDER,
            "0.1 % of the theory column, which has four digits; the beam is exact",
            straight_cantilever,
        ),
        Benchmark(
            "NAFEMS FV2 with arms that stretch",
            "FV2's double cross, its crossing free to move in the plane. Explained is what "
            "the theory, whose arms do not stretch, leaves out: root of k_tension + k_bending = 0 "
            "of the crossing's exact dynamic stiffness.",
            FV2,
            REASON,
            stretching_cross,
        ),
        Benchmark(
            "Torsion constants of rectangles by Saint-Venant's series",
            "J/(b h³) of rectangles b × h.",
            solids.TIMOSHENKO,
            "the last of six published digits",
            torsion_by_series,
        ),
    )


def deep_beam(elements: int) -> BeamFrame:
    """FV5: simply supported, held along and about its axis at the first end alone."""
    return BeamFrame(
        "NAFEMS FV5",
        np.array([[0.0, 0.0, 0.0], [solids.DEEP.length, 0.0, 0.0]]),
        (Member(0, 1, solids.DEEP.timoshenko, (0.0, 0.0, 1.0), elements),),
        (Support(0, ("x", "y", "z", "φx")), Support(1, ("y", "z"))),
    )


def slender_cantilever(elements: int) -> BeamFrame:
    """Test 71: Euler–Bernoulli bending in one plane."""
    beam = SLENDER.properties("euler-bernoulli")
    return BeamFrame(
        "NAFEMS Test 71",
        np.array([[0.0, 0.0, 0.0], [SLENDER.length, 0.0, 0.0]]),
        (Member(0, 1, beam, (0.0, 0.0, 1.0), elements, kinds=("bending z",)),),
        (Support(0), Support(1, ("x", "z", "φx", "φy"))),
    )


def straight_cantilever() -> list[KnownNumber]:
    """MacNeal–Harder, clamped at node 0, its section's height along z."""
    frame = BeamFrame(
        "MacNeal–Harder cantilever",
        np.array([[0.0, 0.0, 0.0], [solids.STRAIGHT.length, 0.0, 0.0]]),
        (Member(0, 1, solids.STRAIGHT.timoshenko, (0.0, 0.0, 1.0), 1),),
        (Support(0),),
    )
    found = displacements(assemble(frame), np.eye(12)[:, 6:])[6:]
    return [
        KnownNumber(quantity, unit, target, float(found[component, component]), TOLERANCE)
        for component, quantity, unit, target in solids.MACNEAL_TARGETS
    ]


def stretching_cross() -> list[KnownNumber]:
    """FV2 with arms that bend in the plane and stretch."""
    crossing = Support(0, ("z", "φx", "φy"))
    compared = beams.clusters(
        beams.double_cross(16, ("tension", "bending z"), crossing), MOVING_CLUSTERS
    )
    return [
        KnownNumber(
            one.quantity,
            one.unit,
            one.known,
            one.ours,
            one.tolerance,
            (moving_crossing_root(order) / pinned_clamped_root(order)) ** 2 - 1.0,
        )
        for order, one in enumerate(compared, start=1)
    ]


def pinned_clamped_root(order: int) -> float:
    """βL number `order` of tan βL = tanh βL: 3.926602, 7.068583."""

    def difference(b: float) -> float:
        return sin(b) - cos(b) * tanh(b)

    return float(brentq(difference, order * pi, (order + 0.5) * pi))


def moving_crossing_root(order: int, arm: ConstantLeg = ARM) -> float:
    """βL of the modes in which the crossing of FV2 moves without turning.

    Over the eight arms the stiffness against moving is 4 (k_tension + k_bending), with
    k_tension = EA (ω/c) cot(ωL/c) and k_bending = 2 EI β³/(tan βL − tanh βL) (Euler–Bernoulli,
    pinned at one end, guided at the other).
    """
    beam, length = arm.properties("euler-bernoulli"), arm.length

    def stiffness(b: float) -> float:
        omega = (b / length) ** 2 * sqrt(beam.EIz / beam.mu)
        wave = omega * sqrt(beam.mu / beam.EA)
        tension = beam.EA * wave / tan(wave * length)
        bending = 2.0 * beam.EIz * (b / length) ** 3
        # Multiplied by tan − tanh and by cos, so that neither has poles.
        return tension * (sin(b) - cos(b) * tanh(b)) + bending * cos(b)

    return float(brentq(stiffness, order * pi, (order + 0.5) * pi))


def torsion_by_series() -> list[KnownNumber]:
    """Saint-Venant's series at every published ratio."""
    return [
        KnownNumber(
            f"J/(b h³), b/h = {ratio:g}",
            "1",
            known,
            rectangle_torsion_constant(ratio, 1.0) / ratio,
            1e-6 / known,
        )
        for ratio, known in sorted(TORSION_CONSTANTS.items())
    ]
