"""Errata of the paper's text, captions and formulas, each with the number that shows it.

The paper: S. Briot, A. Pashkevich, D. Chablat, "On the optimal design of parallel robots taking
into account their deformations and natural frequencies". Its data are audited by `lumped.audit`.

Eqs (1), (2) are elastic drives and rigid legs. The legs keep their length: A t = B q̇ with
A = [[x, s1], [x − a, s2]], B = diag(s1, s2). Hence J = A⁻¹B, which exists at both ends of the
stroke, where B is singular and J⁻¹ does not.
"""

import numpy as np

from fem.beams.beam_theory import Plane, bending_frequencies, tension_frequencies
from lumped.arrays import Array
from lumped.audit import Finding
from lumped.legs import ConstantLeg, equivalent_leg
from lumped.mechanism.biglide import Stroke
from lumped.mechanism.mechanism import Mechanism
from lumped.models.cantilever import clamped_modes
from lumped.models.segments import segment_chain, segment_leg
from lumped.robot_file import RobotFile
from lumped.screws import shift, turn, turn_matrix
from lumped.system.joint_motion import condensed_release, printed_release
from validation.paper.robot import foot_compliances, is_the_papers, legs, stroke_of

# Number of elements of a leg in §3.2, and a small rigid rotation (rad).
_ELEMENTS = 20
_ROTATION = 1e-3
_PLANES: tuple[Plane, ...] = ("z", "y")


def paper_findings(robot_file: RobotFile) -> tuple[Finding, ...]:
    """All errata of the paper, by its robot as used; none for any other robot."""
    if not is_the_papers(robot_file):
        return ()
    robot = robot_file.mechanism
    stroke, both = stroke_of(robot), [equivalent_leg(leg) for leg in legs(robot)]
    printed_foot, foot = foot_compliances(robot_file)
    # Stiffness (6×6, leg axes) between two elements of leg 1, and half an element's length (m).
    piece = both[0].length / _ELEMENTS
    compliance = both[0].properties("euler-bernoulli").piece_compliance(piece)
    spring, arm = np.diag(1.0 / np.diag(compliance)), piece / 2.0
    return (
        _caption(stroke),
        _foot_stiffness(printed_foot, foot),
        _joint_release(foot),
        _longitudinal_frequencies(both),
        _work_balance(robot, stroke),
        _literal_layout(both[0]),
        _lever_arms(spring, arm, robot.reference["leg1"].rotation),
        _small_rotations(spring),
        _neighbour_index(spring, arm),
        *_READ,
    )


def jacobian(stroke: Stroke, x: float) -> Array:
    """J (2×2, no unit) of eq. (2): velocity (x, y) of B at `x` (m) from the slides' along y."""
    directions = np.array([leg.rotation[:2, 0] for leg in stroke.legs_at(x)])
    slides = directions[:, 1, None] * np.eye(2)
    return np.linalg.solve(directions, slides).astype(float)


def drive_compliance(J: Array, K: Array) -> Array:
    """J K⁻¹ Jᵀ (2×2, m/N) of eq. (1) from a Jacobian and the drives' stiffness K (2×2, N/m)."""
    flexibility: Array = J @ np.linalg.solve(K, J.T)
    return flexibility


def _caption(stroke: Stroke) -> Finding:
    """The captions put the right end of the workspace at x = L1 − a."""
    x = stroke.length1 - stroke.a
    first, last = stroke.ends
    return Finding(
        "captions of Figs 6c, 12c, 13c",
        "caption",
        printed="x = L1 − a",
        wrong="outside the stroke; the right end is reached when leg 1 is horizontal",
        evidence=f"L1 − a = {x:.3g} m, the stroke goes from {first:.3g} to {last:.3g} m",
        used="x = L1",
        severity="note",
        numbers={"x": x, "first": first, "last": last},
    )


def _foot_stiffness(printed: Array, corrected: Array) -> Finding:
    """§2.1 gives the foot about 1e9 N/m along y: a check of the corrected entry (6,6)."""
    as_printed, as_corrected = (float(np.linalg.inv(k)[1, 1]) for k in (printed, corrected))
    return Finding(
        "foot.compliance",
        "stiffness along y",
        printed=f"c66 = {printed[5, 5]:.3g} rad/(N m)",
        wrong="§2.1 says about 1e9 N/m along y; the printed matrix does not have it",
        evidence=f"(k⁻¹)₂₂ = {as_printed:.3g} N/m as printed, {as_corrected:.4g} N/m as corrected",
        used="the corrected matrix",
        severity="error",
        numbers={"as printed": as_printed, "corrected": as_corrected},
    )


def _joint_release(foot_compliance: Array) -> Finding:
    """Eq. (25) zeroes row and column of φz; a joint in series is a condensation."""
    stiffness: Array = np.linalg.inv(foot_compliance).astype(float)
    printed = float(printed_release(stiffness)[1, 1])
    condensed = float(condensed_release(stiffness)[1, 1])
    uncoupled = float(1.0 / foot_compliance[1, 1])
    return Finding(
        "eq. (25)",
        "joint release",
        printed="K_R = I₅ K_S I₅",
        wrong="zeroing row and column of φz holds φz at zero instead of releasing it, wherever φz "
        "is coupled; it contradicts eq. (3)",
        evidence=f"the foot resists y with {printed:.3g} N/m as printed, {condensed:.3g} N/m with "
        f"a free joint; 1/c22 = {uncoupled:.3g} N/m",
        used="K_S − K_S e₆ e₆ᵀ K_S / k₆₆; the printed form as a variant",
        severity="error",
        numbers={
            "y stiffness as printed": printed,
            "y stiffness condensed": condensed,
            "1/c22": uncoupled,
        },
    )


def _longitudinal_frequencies(both: list[ConstantLeg]) -> Finding:
    """§1 says longitudinal natural frequencies are many times smaller than bending ones."""
    ratios = {}
    for number, leg in enumerate(both, start=1):
        beam = leg.properties("euler-bernoulli"), leg.length
        for plane in _PLANES:
            ratio = tension_frequencies(*beam, 1)[0] / bending_frequencies(*beam, plane, 1)[0]
            ratios[f"leg {number}, bending {plane}"] = float(ratio)
    shown = ", ".join(f"{ratio:.2g} ({name})" for name, ratio in ratios.items())
    return Finding(
        "§1",
        "longitudinal frequencies",
        printed="longitudinal frequencies many times smaller than those of bending",
        wrong="the other way round",
        evidence=f"first longitudinal over first bending frequency, clamped-free: {shown}",
        used="nothing",
        severity="note",
        numbers=ratios,
    )


def _work_balance(robot: Mechanism, stroke: Stroke) -> Finding:
    """Eq. (12) prints J⁻¹KJ⁻ᵀ; f = J⁻ᵀτ and eq. (1) give J⁻ᵀKJ⁻¹."""
    (drive, *_) = (joint.drive for joint in robot.joints if joint.kind == "prismatic")
    if drive is None or drive.simplified is None:
        raise ValueError(f"{robot.name}: drives without a stiffness of the simplified model")
    J = jacobian(stroke, stroke.centre)
    equal = drive.simplified * np.eye(2)
    K = equal * [1.0, 2.0]
    inverse: Array = np.linalg.inv(J).astype(float)
    exact: Array = np.linalg.inv(drive_compliance(J, K)).astype(float)

    def frequency(stiffness: Array) -> float:
        smallest = float(np.linalg.eigvals(stiffness).real.min())
        return float(np.sqrt(smallest / robot.tool.mass) / (2.0 * np.pi))

    printed, balanced = inverse @ K @ inverse.T, inverse.T @ K @ inverse
    error, balance = (
        float(np.linalg.norm(one - exact) / np.linalg.norm(exact)) for one in (printed, balanced)
    )
    first, first_balanced = frequency(printed), frequency(balanced)
    same = frequency(inverse @ equal @ inverse.T) - frequency(inverse.T @ equal @ inverse)
    return Finding(
        "eq. (12)",
        "work balance",
        printed="J⁻¹KJ⁻ᵀ",
        wrong="not the stiffness at the platform: the work balance f = J⁻ᵀτ gives J⁻ᵀKJ⁻¹; and "
        "at both ends of the stroke J has no inverse",
        evidence=f"at the centre with drives of {K[0, 0]:.0e} and {K[1, 1]:.0e} N/m the inverse of "
        f"eq. (1) is missed by {error:.0%} as printed, by {balance:.0e} with J⁻ᵀKJ⁻¹; "
        f"f1 = {first:.1f} in place of {first_balanced:.1f} Hz; equal drives give the "
        f"same f1 to {abs(same):.0e} Hz",
        used="J⁻ᵀKJ⁻¹, by flexibility",
        severity="warning",
        numbers={
            "error as printed": error,
            "error with work balance": balance,
            "f1 as printed": first,
            "f1 with work balance": first_balanced,
            "f1 difference, equal drives": same,
        },
    )


def _literal_layout(leg: ConstantLeg) -> Finding:
    """§3.2, read literally, leaves half a piece rigid at each end of the leg."""
    properties = leg.properties("euler-bernoulli")
    exact = min(bending_frequencies(properties, leg.length, plane, 1)[0] for plane in _PLANES)

    def error(elements: int) -> float:
        """Of the first frequency, clamped-free, relative."""
        chain = segment_chain(properties, leg.length, elements, "literal")
        return float(clamped_modes(segment_leg(chain), 1).frequencies[0] / exact - 1.0)

    coarse, fine = error(_ELEMENTS), error(2 * _ELEMENTS)
    order = float(np.log2(coarse / fine))
    deficit = leg.length / (2 * _ELEMENTS)
    return Finding(
        "§3.2",
        "literal layout",
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


def _lever_arms(spring: Array, arm: float, leg_axes: Array) -> Finding:
    """Eqs (17), (18) hold in the leg's axes; beside eq. (15) they must be turned by D_k."""
    base_axes = np.eye(3)
    printed = _energy_of_rotation(spring, leg_axes, base_axes, arm, arm)
    turned = _energy_of_rotation(spring, leg_axes, leg_axes, arm, arm)
    return Finding(
        "eqs (17), (18)",
        "lever arms",
        printed="C₂,ₖ and C₁,ₖ₊₁ with d along x",
        wrong="the arms lie along the leg, but q and K_k of eq. (15) are in base axes",
        evidence=f"a rigid rotation of leg 1 by 1 mrad about z stores {printed:.3g} J in one "
        f"spring at the centre of the stroke, {turned:.0e} J with D C Dᵀ",
        used="D_k C D_kᵀ: the legs are assembled in their own axes and then turned",
        severity="error",
        numbers={
            "energy as printed": printed,
            "energy turned": turned,
            "energy of a leg along x": _energy_of_rotation(spring, base_axes, base_axes, arm, arm),
        },
    )


def _small_rotations(spring: Array) -> Finding:
    """Eq. (19) multiplies the rotations by their own cross-product matrix, φ × φ = 0."""
    bend = np.array([0.0, 0.0, 0.0, 0.0, 0.0, _ROTATION])
    # diag(I₃, Rˢ) q of eq. (19)
    deflection = np.concatenate([bend[:3], np.cross(bend[3:], bend[3:])])
    stored, due = (float(0.5 * one @ spring @ one) for one in (deflection, bend))
    return Finding(
        "eqs (19), (20)",
        "small rotations",
        printed="diag(I₃, Rˢ) with Rˢ the cross-product matrix of φ",
        wrong="Rˢ φ = φ × φ = 0, so no spring would turn, and there is no lever arm: eqs (17), "
        "(18) do not follow from it",
        evidence=f"a spring bent by 1 mrad stores {stored:g} J, in truth {due:.3g} J",
        used="eqs (17), (18), turned",
        severity="note",
        numbers={"energy as printed": stored, "energy": due},
    )


def _neighbour_index(spring: Array, arm: float) -> Finding:
    """Eq. (23) couples spring 1 by C₁,₃, the arm of element 3, to element 2."""
    printed, correct = (
        _energy_of_rotation(spring, np.eye(3), np.eye(3), arm, assumed)
        for assumed in (2.0 * arm, arm)
    )
    return Finding(
        "eq. (23)",
        "neighbour index",
        printed="second block row C₂,₁ C₁,₃",
        wrong="spring 1 lies between elements 1 and 2: C₁,₂",
        evidence="with element 3 twice as long as element 2, a rigid rotation by 1 mrad stores "
        f"{printed:.3g} J as printed, {correct:.0e} J with C₁,₂; equal elements hide the slip",
        used="C₁,₂",
        severity="note",
        numbers={"energy as printed": printed, "energy": correct},
    )


def _energy_of_rotation(
    spring: Array, leg_axes: Array, arm_axes: Array, arm: float, assumed_arm: float
) -> float:
    """Energy (J) by eqs (15), (16) in a spring whose two elements turn about z as one body.

    `spring` is 6×6 in leg axes, `leg_axes` (3×3) the leg's direction; the elements' centres lie
    `arm` (m) before and behind the spring. Eqs (17), (18) are written in `arm_axes`, the one behind
    with `assumed_arm`.
    """
    along = np.array([1.0, 0.0, 0.0])
    first_twist = np.array([0.0, 0.0, 0.0, 0.0, 0.0, _ROTATION])
    second_twist = shift(leg_axes @ along * 2.0 * arm) @ first_twist
    D = turn(arm_axes)
    C2 = -D @ shift(along * arm) @ D.T
    C1 = D @ shift(-along * assumed_arm) @ D.T
    deflection = C2 @ first_twist + C1 @ second_twist
    return float(0.5 * deflection @ turn_matrix(spring, leg_axes) @ deflection)


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
