"""Published benchmarks that no machine of a user could fail, in the form of `flexproof selftest`.

They are beams that are exact or nearly so, and series: tests solve them, and the verification
manual shows them beside those of the self-test.
"""

from math import cos, pi, sin, sqrt, tan, tanh

import numpy as np
from scipy.optimize import brentq

from fem.beams.beam import beam_leg
from lumped.arrays import Array, dense
from lumped.dense.modes import solve_modes
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.body import Body, Frame, Rigid
from lumped.mechanism.joint import Joint, JointKind, Side
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool
from lumped.models.cantilever import kind_frequencies, tip_compliance_of
from lumped.sections import Rectangle, rectangle_torsion_constant
from validation.models.mechanism import answers
from validation.models.options import ModelOptions
from validation.selftest import solids
from validation.selftest.benchmark import Benchmark, KnownNumber
from validation.selftest.solids import TOLERANCE, Cluster

FV2 = "NAFEMS, The Standard NAFEMS Benchmarks, TNSB rev. 3 (1990), Test FV2"
TEST_71 = (
    "F. Abbassian, D. J. Dawswell, N. C. Knowles, Selected Benchmarks for Natural Frequency "
    "Analysis, NAFEMS (1987), Test 71"
)
REASON = "0.1 % of the theory column, which has four digits; the beams' own error is below 0.01 %"
# Four times as high as wide: in the plane it is FV2's, across it too stiff for the modes compared.
ARM = ConstantLeg(5.0, Rectangle(0.125, 0.5), Material.isotropic(2e11, 0.3, 8000.0))
ARMS = 8
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
FV2_CLUSTERS = (
    Cluster(1, 1, 11.336, "arms pinned at both ends"),
    Cluster(2, 8, 17.709, "arms pinned and clamped"),
    Cluster(9, 9, 45.345, "arms pinned at both ends, second"),
    Cluster(10, 16, 57.390, "arms pinned and clamped, second"),
)
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
            deep_beam,
        ),
        Benchmark(
            "NAFEMS Test 71, slender cantilever, by Euler–Bernoulli beams",
            "Bending frequencies in one plane of a cantilever of 10 m with a square section of "
            "0.125 m: E = 200 GPa, ρ = 8000 kg/m³. 32 elements.",
            TEST_71,
            REASON,
            slender_cantilever,
        ),
        Benchmark(
            "MacNeal–Harder's straight cantilever by a Timoshenko beam",
            "The cantilever of 6 × 0.2 × 0.1 as one beam element.",
            solids.MACNEAL_HARDER,
            "0.1 % of the theory column, which has four digits; the beam is exact",
            straight_cantilever,
        ),
        Benchmark(
            "NAFEMS FV2, pin-ended double cross, as a mechanism of Euler–Bernoulli beams",
            "Natural frequencies in the plane of eight arms of 5 m, 0.125 m wide, pinned at their "
            "ends and joined in the middle: E = 200 GPa, ρ = 8000 kg/m³. The crossing turns but "
            "does not move, as in the theory: seven modes are of one frequency. 20 elements an "
            "arm, which is four times as high as wide: in the plane that changes nothing.",
            FV2,
            REASON,
            pinned_cross,
        ),
        Benchmark(
            "NAFEMS FV2 with arms that stretch",
            "The double cross, its crossing free to move in the plane. Explained is what "
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


def deep_beam() -> list[KnownNumber]:
    """FV5: simply supported, held along and about its axis at the first end alone."""
    beam = beam_leg(solids.DEEP.timoshenko, solids.DEEP.length, 32)
    free = np.delete(np.arange(beam.size), [0, 1, 2, 3, 7, 8])
    stiffness, mass = (dense(matrix)[np.ix_(free, free)] for matrix in (beam.stiffness, beam.mass))
    found = solve_modes(stiffness, mass, FV5_CLUSTERS[-1].last, "NAFEMS FV5").frequencies
    return [cluster.compared(found) for cluster in FV5_CLUSTERS]


def slender_cantilever() -> list[KnownNumber]:
    """Test 71: Euler–Bernoulli bending in one plane."""
    beam = beam_leg(SLENDER.properties("euler-bernoulli"), SLENDER.length, 32)
    found = kind_frequencies(beam, "bending z", len(TEST_71_CLUSTERS))
    return [cluster.compared(found) for cluster in TEST_71_CLUSTERS]


def straight_cantilever() -> list[KnownNumber]:
    """MacNeal–Harder, one element, its section's height along z."""
    found = tip_compliance_of(beam_leg(solids.STRAIGHT.timoshenko, solids.STRAIGHT.length, 1))
    return [
        KnownNumber(quantity, unit, target, float(found[component, component]), TOLERANCE)
        for component, quantity, unit, target in solids.MACNEAL_TARGETS
    ]


def pinned_cross() -> list[KnownNumber]:
    """FV2, its crossing on a hinge."""
    found = cross_frequencies("revolute")
    return [cluster.compared(found) for cluster in FV2_CLUSTERS]


def stretching_cross() -> list[KnownNumber]:
    """FV2 with a crossing that moves as far as its arms stretch."""
    found = cross_frequencies("planar")
    return [
        cluster.compared(
            found, (moving_crossing_root(order) / pinned_clamped_root(order)) ** 2 - 1.0
        )
        for order, cluster in enumerate(MOVING_CLUSTERS, start=1)
    ]


def cross_frequencies(crossing: JointKind) -> Array:
    """The first 16 frequencies (Hz) of FV2's cross, its middle joined to the ground."""
    up = np.array([[0.0, 0.0, 1.0]])
    angles = np.arange(ARMS) * 2.0 * np.pi / ARMS
    inwards = [np.array([-np.cos(angle), -np.sin(angle), 0.0]) for angle in angles]
    pins = {f"pin{n}": Frame(-ARM.length * along) for n, along in enumerate(inwards)}
    reference = {GROUND: Frame(), "crossing": Frame()}
    bodies = {
        GROUND: Body(GROUND, Rigid(), {"O": Frame(), **pins}),
        "crossing": Body("crossing", Rigid(), {"O": Frame()}),
    }
    joints = [Joint("O", crossing, Side(GROUND, "O"), Side("crossing", "O"), up)]
    for n, (pin, along) in enumerate(zip(pins, inwards, strict=True)):
        arm = f"arm{n}"
        axes = np.column_stack([along, np.cross(up[0], along), up[0]])
        reference[arm] = Frame(pins[pin].position, axes)
        ends = {pin: Frame(), "O": Frame(np.array([ARM.length, 0.0, 0.0]))}
        bodies[arm] = Body(arm, ARM, ends)
        joints.append(Joint(pin, "revolute", Side(GROUND, pin), Side(arm, pin), up))
        joints.append(Joint(arm, "fixed", Side(arm, "O"), Side("crossing", "O"), np.zeros((0, 3))))
    tool = Tool("crossing", "O")
    cross = Mechanism("FV2", bodies, joints, tool, reference, np.zeros((1, 0)))
    options = ModelOptions(theory="euler-bernoulli")
    (found,) = answers("beam", [reference_posture(cross)], FV2_CLUSTERS[-1].last, options)
    return found.frequencies


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
