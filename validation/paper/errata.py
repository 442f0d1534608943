"""Errata of the paper's text, captions and formulas, each with the number that shows it.

The paper: S. Briot, A. Pashkevich, D. Chablat, "On the optimal design of parallel robots taking
into account their deformations and natural frequencies". Its data are audited by `lumped.audit`,
its equations (12) to (25) by `formula_errata`.
"""

import numpy as np

from fem.beams.beam_theory import Plane, bending_frequencies, tension_frequencies
from lumped.arrays import Array
from lumped.audit.finding import Finding
from lumped.legs import ConstantLeg, equivalent_leg
from lumped.mechanism.mechanism import Mechanism
from lumped.models.cantilever import clamped_modes
from lumped.models.segments import segment_chain, segment_leg
from lumped.robot_file import RobotFile
from validation.paper.formula_errata import (
    joint_release,
    lever_arms,
    neighbour_index,
    small_rotations,
    work_balance,
)
from validation.paper.robot import foot_compliances, is_the_papers, legs, stroke_of

_ELEMENTS = 20
_PLANES: tuple[Plane, ...] = ("z", "y")


def paper_findings(robot_file: RobotFile) -> tuple[Finding, ...]:
    """All errata of the paper, by its robot as used; none for any other robot."""
    if not is_the_papers(robot_file):
        return ()
    robot = robot_file.mechanism
    printed_foot, foot = foot_compliances(robot_file)
    return (
        caption(robot),
        foot_stiffness(printed_foot, foot),
        joint_release(foot),
        longitudinal_frequencies(robot),
        work_balance(robot),
        literal_layout(robot),
        lever_arms(robot),
        small_rotations(robot),
        neighbour_index(robot),
        *_READ,
    )


def caption(robot: Mechanism) -> Finding:
    """The captions put the right end of the workspace at x = L1 − a."""
    stroke = stroke_of(robot)
    x = stroke.length1 - stroke.a
    first, last = stroke.ends
    return Finding(
        where="captions of Figs 6c, 12c, 13c",
        check="caption",
        printed="x = L1 − a",
        wrong="outside the stroke; the right end is reached when leg 1 is horizontal",
        evidence=f"L1 − a = {x:.3g} m, the stroke goes from {first:.3g} to {last:.3g} m",
        used="x = L1",
        severity="note",
        numbers={"x": x, "first": first, "last": last},
    )


def foot_stiffness(printed: Array, corrected: Array) -> Finding:
    """§2.1 gives the foot about 1e9 N/m along y: a check of the corrected entry (6,6)."""
    as_printed, as_corrected = (float(np.linalg.inv(k)[1, 1]) for k in (printed, corrected))
    return Finding(
        where="foot.compliance",
        check="stiffness along y",
        printed=f"c66 = {printed[5, 5]:.3g} rad/(N m)",
        wrong="§2.1 says about 1e9 N/m along y; the printed matrix does not have it",
        evidence=f"(k⁻¹)₂₂ = {as_printed:.3g} N/m as printed, {as_corrected:.4g} N/m as corrected",
        used="the corrected matrix",
        severity="error",
        numbers={"as printed": as_printed, "corrected": as_corrected},
    )


def longitudinal_frequencies(robot: Mechanism) -> Finding:
    """§1 says longitudinal natural frequencies are many times smaller than bending ones."""
    ratios = {
        f"{name}, bending {plane}": _longitudinal_to_bending(equivalent_leg(leg), plane)
        for name, leg in zip(("leg 1", "leg 2"), legs(robot), strict=True)
        for plane in _PLANES
    }
    shown = ", ".join(f"{ratio:.2g} ({name})" for name, ratio in ratios.items())
    return Finding(
        where="§1",
        check="longitudinal frequencies",
        printed="longitudinal frequencies many times smaller than those of bending",
        wrong="the other way round",
        evidence=f"first longitudinal over first bending frequency, clamped-free: {shown}",
        used="nothing",
        severity="note",
        numbers=ratios,
    )


def literal_layout(robot: Mechanism) -> Finding:
    """§3.2, read literally, leaves half a piece rigid at each end of the leg."""
    leg = equivalent_leg(legs(robot)[0])
    errors = {n: _literal_error(leg, n) for n in (_ELEMENTS, 2 * _ELEMENTS)}
    coarse, fine = errors.values()
    order = float(np.log2(coarse / fine))
    deficit = leg.length / (2 * _ELEMENTS)
    return Finding(
        where="§3.2",
        check="literal layout",
        printed="element 0 fixed, springs of length L/m between the elements",
        wrong="half a piece at each end is rigid, so that the leg is too short where it bends "
        "most: an error of first order in 1/m, where the paper claims below 1 % with 20 elements",
        evidence=f"at m = {_ELEMENTS} leg 1 bends from {1e3 * deficit:.3g} mm beyond its root and "
        f"its first frequency is {coarse:.1%} too high, at m = {2 * _ELEMENTS} {fine:.1%} "
        f"(order {order:.2f})",
        used="half springs of length L/2n at both ends; the printed layout as a variant",
        severity="error",
        numbers={
            "error at 20": coarse,
            "error at 40": fine,
            "order": order,
            "length deficit": deficit,
        },
    )


def _literal_error(leg: ConstantLeg, elements: int) -> float:
    """Relative error of the first frequency of the literal layout, clamped-free."""
    properties = leg.properties("euler-bernoulli")
    chain = segment_chain(properties, leg.length, elements, "literal")
    exact = min(bending_frequencies(properties, leg.length, plane, 1)[0] for plane in _PLANES)
    return float(clamped_modes(segment_leg(chain), 1).frequencies[0] / exact - 1.0)


def _longitudinal_to_bending(leg: ConstantLeg, plane: Plane) -> float:
    beam = leg.properties("euler-bernoulli"), leg.length
    return float(tension_frequencies(*beam, 1)[0] / bending_frequencies(*beam, plane, 1)[0])


# Place, what is printed, what is wrong, and what is used instead.
_READINGS = (
    ("§2.1", "matrix K of equation (2)", "K stands in eq. (1)", "eq. (1)"),
    ("§3.3", "α of eq. (6)", "α is defined by eq. (10); eq. (6) is the chain", "eq. (10)"),
    (
        "eq. (16) ff., eq. (21)",
        "C_k and C_k+1",
        "eq. (16) itself writes C₂,ₖ and C₁,ₖ₊₁; with one index the two arms of an element merge",
        "C₂,ₖ and C₁,ₖ₊₁",
    ),
    ("appendix", "L_Tool = 0.155", "the unit is missing", "0.155 m, along z"),
    (
        "appendix",
        "J_Foot without a mass of the foot",
        "the foot's inertia is given, its mass and the place of its mass centre are not",
        "feet as massless springs",
    ),
)
_READ = tuple(
    Finding(where, "text", printed, wrong, evidence="read", used=used, severity="note", kind="read")
    for where, printed, wrong, used in _READINGS
)
