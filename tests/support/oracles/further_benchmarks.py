"""Published benchmarks that are independent of the machine, in the form of `flexproof selftest`.

Beams solve them almost exactly. They are tested here only, and the verification manual shows them
beside those of the self-test.
"""

import numpy as np
from support.robots.paper_legs import kind_frequencies

from fem.beams.beam import beam_leg
from lumped.arrays import dense
from lumped.dense.modes import solve_modes
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.body import Body, Frame, Rigid
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool
from lumped.sections import Rectangle
from validation.models.options import ModelOptions
from validation.models.robot_models import answers
from validation.selftest import benchmarks as own
from validation.selftest.benchmarks import Benchmark, KnownNumber, ModeCluster

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
FV5_CLUSTERS = tuple(cluster for cluster, *_ in own.FV5_MODES)
TEST_71_CLUSTERS = tuple(
    ModeCluster(k, k, target, f"bending {k}")
    for k, target in enumerate((1.010, 6.327, 17.716, 34.717, 57.390, 85.730), start=1)
)
FV2_CLUSTERS = (
    ModeCluster(1, 1, 11.336, "arms pinned at both ends"),
    ModeCluster(2, 8, 17.709, "arms pinned and clamped"),
    ModeCluster(9, 9, 45.345, "arms pinned at both ends, second"),
    ModeCluster(10, 16, 57.390, "arms pinned and clamped, second"),
)


def benchmarks() -> tuple[Benchmark, ...]:
    """All benchmarks of this module."""
    return (
        Benchmark(
            "NAFEMS FV5, deep simply supported beam, by Timoshenko beams",
            "The beam of 10 m with a square section of 2 m, with the end conditions of the solid. "
            "32 elements.",
            own.FV5,
            REASON,
            deep_beam,
        ),
        Benchmark(
            "NAFEMS Test 71, slender cantilever, by Euler–Bernoulli beams",
            "Bending frequencies in one plane of a cantilever of 10 m with a square section of "
            "0.125 m. E = 200 GPa, ρ = 8000 kg/m³. 32 elements.",
            TEST_71,
            REASON,
            slender_cantilever,
        ),
        Benchmark(
            "NAFEMS FV2, pin-ended double cross, as a mechanism of Euler–Bernoulli beams",
            "Natural frequencies in the plane of eight arms of 5 m, 0.125 m wide, pinned at their "
            "ends and joined in the middle. E = 200 GPa, ρ = 8000 kg/m³. The crossing turns but "
            "does not move, as in the theory, so that seven modes have one frequency. 20 elements "
            "per arm. The arms are four times as high as wide, which has no effect in the plane.",
            FV2,
            REASON,
            pinned_cross,
        ),
    )


def deep_beam() -> list[KnownNumber]:
    """NAFEMS FV5: deep simply supported beam, fixed along and about its axis at the first end."""
    beam = beam_leg(own.DEEP.timoshenko, own.DEEP.length, 32)
    free = np.delete(np.arange(beam.size), [0, 1, 2, 3, 7, 8])
    stiffness, mass = (dense(matrix)[np.ix_(free, free)] for matrix in (beam.stiffness, beam.mass))
    frequencies = solve_modes(stiffness, mass, FV5_CLUSTERS[-1].last, "NAFEMS FV5").frequencies
    return [cluster.known_number(frequencies) for cluster in FV5_CLUSTERS]


def slender_cantilever() -> list[KnownNumber]:
    """NAFEMS test 71: cantilever in Euler–Bernoulli bending in one plane."""
    beam = beam_leg(SLENDER.properties("euler-bernoulli"), SLENDER.length, 32)
    frequencies = kind_frequencies(beam, "bending z", len(TEST_71_CLUSTERS))
    return [cluster.known_number(frequencies) for cluster in TEST_71_CLUSTERS]


def pinned_cross() -> list[KnownNumber]:
    """NAFEMS FV2: pin-ended double cross with its crossing on a hinge."""
    up = np.array([[0.0, 0.0, 1.0]])
    angles = np.arange(ARMS) * 2.0 * np.pi / ARMS
    inwards = [np.array([-np.cos(angle), -np.sin(angle), 0.0]) for angle in angles]
    pins = {f"pin{n}": Frame(-ARM.length * along) for n, along in enumerate(inwards)}
    reference = {GROUND: Frame(), "crossing": Frame()}
    bodies = {
        GROUND: Body(GROUND, Rigid(), {"O": Frame(), **pins}),
        "crossing": Body("crossing", Rigid(), {"O": Frame()}),
    }
    joints = [Joint("O", "revolute", Side(GROUND, "O"), Side("crossing", "O"), up)]
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
    computed = answers("beam", [reference_posture(cross)], FV2_CLUSTERS[-1].last, options)
    return [cluster.known_number(computed.frequencies[0]) for cluster in FV2_CLUSTERS]
