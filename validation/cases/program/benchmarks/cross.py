"""NAFEMS FV2, the pin-ended double cross: clusters of seven equal frequencies, and their shapes."""

from math import cos, pi, sin, sqrt, tan, tanh

import numpy as np
from scipy.linalg import null_space, subspace_angles
from scipy.optimize import brentq

from fem.beams.beam_theory import Kind
from fem.beams.frame import Frame, Member, Support, assemble, modes
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle
from validation.agreement.differences import refined
from validation.case import Absolute, Allowance, Case, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.benchmarks.beams import BEAM_ORDER, SECTION, Cluster, family
from validation.context import Context

CITATION = "NAFEMS, The Standard NAFEMS Benchmarks, TNSB rev. 3 (1990), Test FV2"
ARM = ConstantLeg(5.0, Rectangle(0.125, 0.125), Material.isotropic(2e11, 0.3, 8000.0))
COUNTS = (4, 8, 12, 16)
_BENDING, _STRETCHING = "NAFEMS FV2, arms that only bend", "NAFEMS FV2, arms that stretch"
_ARMS = 8
_SAMPLES = 24

CLUSTERS = (
    Cluster(1, 1, 11.336, "arms pinned at both ends"),
    Cluster(2, 8, 17.709, "arms pinned and clamped"),
    Cluster(9, 9, 45.345, "arms pinned at both ends, second"),
    Cluster(10, 16, 57.390, "arms pinned and clamped, second"),
)
# Two modes of each seven move the crossing, against the stretching of the arms.
MOVING = (
    Cluster(2, 3, 17.709, "arms pinned and clamped, the crossing moves"),
    Cluster(10, 11, 57.390, "arms pinned and clamped, second, the crossing moves"),
)


def cases() -> tuple[Case, ...]:
    """Frequencies of arms that only bend, as in the theory, and that stretch; and the shapes."""
    return (
        *family("fv2.bending", _BENDING, rigid_crossing, CLUSTERS, CITATION, COUNTS),
        *family(
            "fv2.stretching",
            _STRETCHING,
            double_cross,
            MOVING,
            CITATION,
            COUNTS,
            stretching,
        ),
        *_subspaces(),
    )


def rigid_crossing(elements: int) -> Frame:
    """FV2 as its theory has it: arms bend in the plane, the crossing turns but does not move."""
    return _cross(elements, ("bending z",), Support(0, ("x", "y", "z", "φx", "φy")))


def double_cross(elements: int) -> Frame:
    """FV2 with arms that bend in the plane and stretch."""
    return _cross(elements, ("tension", "bending z"), Support(0, ("z", "φx", "φy")))


def stretching(cluster: Cluster) -> tuple[Allowance, ...]:
    """What the arms' stretching does to a frequency in which the crossing moves (Hz)."""
    order = MOVING.index(cluster) + 1
    moved = moving_crossing_root(order) ** 2 - pinned_clamped_root(order) ** 2
    arm = ARM.properties("euler-bernoulli")
    return (
        Allowance(
            cause="the theory's arms do not stretch",
            amount=moved * sqrt(arm.EIz / arm.mu) / ARM.length**2 / (2.0 * pi),
            source="exact dynamic stiffness of the crossing: root of k_tension + k_bending = 0",
        ),
    )


def pinned_clamped_root(order: int) -> float:
    """βL number `order` of tan βL = tanh βL: 3.926602, 7.068583."""

    def difference(b: float) -> float:
        return sin(b) - cos(b) * tanh(b)

    return float(brentq(difference, order * pi, (order + 0.5) * pi))


def moving_crossing_root(order: int) -> float:
    """βL of the modes in which the crossing of FV2 moves without turning.

    Over the eight arms the stiffness against moving is 4 (k_tension + k_bending), with
    k_tension = EA (ω/c) cot(ωL/c) and k_bending = 2 EI β³/(tan βL − tanh βL) (Euler–Bernoulli,
    pinned at one end, guided at the other).
    """
    arm, length = ARM.properties("euler-bernoulli"), ARM.length

    def stiffness(b: float) -> float:
        omega = (b / length) ** 2 * sqrt(arm.EIz / arm.mu)
        wave = omega * sqrt(arm.mu / arm.EA)
        tension = arm.EA * wave / tan(wave * length)
        bending = 2.0 * arm.EIz * (b / length) ** 3
        # Multiplied by tan − tanh and by cos, so that neither has poles.
        return tension * (sin(b) - cos(b) * tanh(b)) + bending * cos(b)

    return float(brentq(stiffness, order * pi, (order + 0.5) * pi))


def exact_cross_shapes(cluster: Cluster, stations: Array) -> Array:
    """FV2's deflections at `stations` (fractions of the arm from its pin), 8m × modes.

    Arms alike and pinned (the crossing turns), or clamped with moments that balance: amplitudes of
    zero sum.
    """
    order = 1 if cluster.last <= _ARMS else 2
    if cluster.first == cluster.last:
        amplitudes, shape = np.ones((_ARMS, 1)), np.sin(order * pi * stations)
    else:
        b = pinned_clamped_root(order)
        amplitudes = null_space(np.ones((1, _ARMS)))
        shape = np.sin(b * stations) / np.sin(b) - np.sinh(b * stations) / np.sinh(b)
    return np.asarray(np.kron(amplitudes, shape[:, None]), dtype=np.float64)


def cross_shapes(elements: int, stations: Array) -> Array:
    """The first sixteen shapes (8m × 16) of the finite elements at the same places."""
    frame = assemble(rigid_crossing(elements))
    shapes = modes(frame, CLUSTERS[-1].last).shapes
    at = stations * ARM.length
    return np.vstack([(leg.centreline(at) @ own @ shapes)[1::6] for leg, own in frame.members])


_subspaces = CaseGroup(section=SECTION)


@_subspaces.case(
    "benchmark.fv2.subspace[{cluster.label}]",
    "NAFEMS FV2, shapes: {cluster.meaning}",
    over={"cluster": CLUSTERS},
    quantity="largest principal angle to the exact shapes of modes {cluster.label}",
    unit="rad",
    reference_kind="closed-form",
    citation=f"{CITATION}; Euler–Bernoulli shapes sin kπs and sin βs/sin β − sinh βs/sinh β",
    tolerance=Absolute(1e-3),
    tolerance_reason="shapes enter a frequency squared: 0.1 % of it is an angle of 0.03, and this "
    "is a thirtieth of that",
    group="benchmark.fv2.bending",
)
def _subspace(context: Context, cluster: Cluster) -> Measurement:
    stations = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    exact = exact_cross_shapes(cluster, stations)
    coarse, fine = (
        float(subspace_angles(cluster.of(context.get(cross_shapes, number, stations)), exact).max())
        for number in (COUNTS[-1] // 2, COUNTS[-1])
    )
    return refined(coarse, fine, order=BEAM_ORDER)


def _cross(elements: int, kinds: tuple[Kind, ...], crossing: Support) -> Frame:
    angles = np.arange(_ARMS) * 2.0 * pi / _ARMS
    pins = ARM.length * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(_ARMS)])
    beam = ARM.properties("euler-bernoulli")
    numbers = range(1, _ARMS + 1)
    return Frame(
        "NAFEMS FV2",
        np.vstack([np.zeros(3), pins]),
        tuple(Member(n, 0, beam, (0.0, 0.0, 1.0), elements, kinds=kinds) for n in numbers),
        (crossing, *(Support(n, ("x", "y", "z", "φx", "φy")) for n in numbers)),
    )
