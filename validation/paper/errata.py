"""Errata of the paper's text, captions and formulas, each with the number that proves it.

Input: a robot file. Output: findings if it is the paper's robot, otherwise none. The paper: S.
Briot, A. Pashkevich, D. Chablat, "On the optimal design of parallel robots taking into account
their deformations and natural frequencies". `lumped.audit` checks its data. The numbers are
constants, because they hold for the paper's robot alone; tests/validation/paper/test_claims.py
computes them with independent formulas.
"""

from lumped.audit import Finding
from lumped.robot_file import RobotFile
from validation.paper.robot import is_paper_robot


def paper_findings(robot_file: RobotFile) -> tuple[Finding, ...]:
    """Errata of the paper if the robot is the paper's. () for any other robot."""
    return _ERRATA if is_paper_robot(robot_file) else ()


_ERRATA = (
    Finding(
        "captions of Figs 6c, 12c, 13c",
        "caption",
        printed="x = L1 − a",
        wrong="outside the stroke; the right end is reached when leg 1 is horizontal",
        evidence="L1 − a = -0.07 m, the stroke goes from 0.145 to 0.85 m",
        used="x = L1",
        severity="note",
    ),
    Finding(
        "foot.compliance",
        "stiffness along y",
        printed="c66 = 3.16e-09 rad/(N m)",
        wrong="§2.1 states about 1e9 N/m along y; the printed matrix does not have it",
        evidence="(k⁻¹)₂₂ = -1.28e+06 N/m as printed, 1.064e+09 N/m as corrected",
        used="the corrected matrix",
        severity="error",
    ),
    Finding(
        "eq. (25)",
        "joint release",
        printed="K_R = I₅ K_S I₅",
        wrong="zeroing row and column of φz holds φz at zero instead of releasing it, wherever φz "
        "is coupled; it contradicts eq. (3)",
        evidence="the foot resists y with 1.06e+09 N/m as printed, 1.7e+08 N/m with a free joint; "
        "1/c22 = 1.7e+08 N/m",
        used="K_S − K_S e₆ e₆ᵀ K_S / k₆₆; the printed form as a variant",
        severity="error",
    ),
    Finding(
        "§1",
        "longitudinal frequencies",
        printed="longitudinal frequencies many times smaller than those of bending",
        wrong="longitudinal frequencies are higher than those of bending",
        evidence="first longitudinal over first bending frequency, clamped-free: "
        "8.2 (leg 1, bending z), 5.1 (leg 1, bending y), 11 (leg 2, bending z), "
        "2.9 (leg 2, bending y)",
        used="nothing",
        severity="note",
    ),
    Finding(
        "eq. (12)",
        "work balance",
        printed="J⁻¹KJ⁻ᵀ",
        wrong="not the stiffness at the platform: the work balance f = J⁻ᵀτ gives J⁻ᵀKJ⁻¹; and "
        "at both ends of the stroke J has no inverse",
        evidence="at the centre with drives of 1e+09 and 2e+09 N/m the inverse of eq. (1) is "
        "missed by 96% as printed, by rounding alone with J⁻ᵀKJ⁻¹; f1 = 719.7 in place of "
        "807.0 Hz; equal drives give the same f1",
        used="J⁻ᵀKJ⁻¹, by flexibility",
        severity="warning",
    ),
    Finding(
        "§3.2",
        "literal layout",
        printed="element 0 fixed, springs of length L/m between the elements",
        wrong="half an element at each end is rigid, so that the leg is too short where it bends "
        "most. The error is of first order in 1/m; the paper claims below 1 % with 20 elements",
        evidence="at m = 20 leg 1 bends from 21.2 mm beyond its root and its first frequency is "
        "5.2% too high, at m = 40 2.6% (order 1.03)",
        used="half springs of length L/2n at both ends; the printed layout as a variant",
        severity="error",
    ),
    Finding(
        "eqs (17), (18)",
        "lever arms",
        printed="C₂,ₖ and C₁,ₖ₊₁ with d along x",
        wrong="the arms lie along the leg, but q and K_k of eq. (15) are in base axes",
        evidence="a rigid rotation of leg 1 by 1 mrad about z stores 56.5 J in one spring at the "
        "centre of the stroke, nothing with D C Dᵀ",
        used="D_k C D_kᵀ: legs are assembled in leg axes and then rotated",
        severity="error",
    ),
    Finding(
        "eqs (19), (20)",
        "small rotations",
        printed="diag(I₃, Rˢ) with Rˢ the cross-product matrix of φ",
        wrong="Rˢ φ = φ × φ = 0, so no spring would turn, and there is no lever arm: eqs (17), "
        "(18) do not follow from it",
        evidence="a spring bent by 1 mrad stores 0 J, in truth 21.5 J",
        used="eqs (17), (18), turned",
        severity="note",
    ),
    Finding(
        "eq. (23)",
        "neighbour index",
        printed="second block row C₂,₁ C₁,₃",
        wrong="spring 1 lies between elements 1 and 2: C₁,₂",
        evidence="with element 3 twice as long as element 2, a rigid rotation by 1 mrad stores "
        "64.6 J as printed, nothing with C₁,₂; equal elements hide the mistake",
        used="C₁,₂",
        severity="note",
    ),
    *(
        Finding(where, check, printed, wrong, "read", used=used, severity="note", kind="read")
        for where, check, printed, wrong, used in (
            (
                "§2.1",
                "equation number",
                "matrix K of equation (2)",
                "K stands in eq. (1)",
                "eq. (1)",
            ),
            (
                "§3.3",
                "equation number",
                "α of eq. (6)",
                "α is defined by eq. (10); eq. (6) is the chain",
                "eq. (10)",
            ),
            (
                "eq. (16) ff., eq. (21)",
                "missing index",
                "C_k and C_k+1",
                "eq. (16) itself writes C₂,ₖ and C₁,ₖ₊₁; with one index the two arms of an element "
                "merge",
                "C₂,ₖ and C₁,ₖ₊₁",
            ),
            (
                "appendix",
                "missing unit",
                "L_Tool = 0.155",
                "the unit is missing",
                "0.155 m, along z",
            ),
            (
                "appendix",
                "missing mass",
                "J_Foot without a mass of the foot",
                "the foot's inertia is given, its mass and the position of its mass centre are not",
                "feet as massless springs",
            ),
        )
    ),
)
