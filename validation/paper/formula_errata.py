"""Errata of the paper's equations (12), (17)–(19), (23), (25), shown on the robot's numbers.

Eqs (1), (2) are elastic drives and rigid legs. The legs keep their length: A t = B q̇ with
A = [[x, s1], [x − a, s2]], B = diag(s1, s2). Hence J = A⁻¹B, which exists at both ends of the
stroke, where B is singular and J⁻¹ does not.
"""

import numpy as np

from lumped.arrays import Array
from lumped.audit.finding import Finding
from lumped.legs import equivalent_leg
from lumped.mechanism.biglide import Stroke
from lumped.mechanism.mechanism import Mechanism
from lumped.screws import shift, turn, turn_matrix
from lumped.system.joint_motion import condensed_release, printed_release
from validation.paper.robot import legs, stroke_of

# Number of elements of a leg in §3.2, and a small rigid rotation (rad).
_ELEMENTS = 20
_ROTATION = 1e-3


def jacobian(stroke: Stroke, x: float) -> Array:
    """J (2×2, no unit) of eq. (2): velocity (x, y) of B at `x` (m) from the slides' along y."""
    directions = np.array([leg.rotation[:2, 0] for leg in stroke.legs_at(x)])
    slides = directions[:, 1, None] * np.eye(2)
    return np.linalg.solve(directions, slides).astype(float)


def drive_compliance(J: Array, K: Array) -> Array:
    """J K⁻¹ Jᵀ (2×2, m/N) of eq. (1) from a Jacobian and the drives' stiffness K (2×2, N/m)."""
    flexibility: Array = J @ np.linalg.solve(K, J.T)
    return flexibility


def work_balance(robot: Mechanism) -> Finding:
    """Eq. (12) prints J⁻¹KJ⁻ᵀ; f = J⁻ᵀτ and eq. (1) give J⁻ᵀKJ⁻¹."""
    stroke, stiffness = stroke_of(robot), drive_stiffness(robot)
    J = jacobian(stroke, stroke.centre)
    K = stiffness * np.diag([1.0, 2.0])
    inverse: Array = np.linalg.inv(J).astype(float)
    exact: Array = np.linalg.inv(drive_compliance(J, K)).astype(float)
    printed, balanced = inverse @ K @ inverse.T, inverse.T @ K @ inverse
    error = _difference(printed, exact)
    first, first_balanced = (_first_frequency(k, robot) for k in (printed, balanced))
    equal_drives = stiffness * np.eye(2)
    same = _first_frequency(inverse @ equal_drives @ inverse.T, robot) - _first_frequency(
        inverse.T @ equal_drives @ inverse, robot
    )
    return Finding(
        "eq. (12)",
        "work balance",
        printed="J⁻¹KJ⁻ᵀ",
        wrong="not the stiffness at the platform: the work balance f = J⁻ᵀτ gives J⁻ᵀKJ⁻¹; and "
        "at both ends of the stroke J has no inverse",
        evidence=f"at the centre with drives of {K[0, 0]:.0e} and {K[1, 1]:.0e} N/m the inverse of "
        f"eq. (1) is missed by {error:.0%} as printed, by {_difference(balanced, exact):.0e} with "
        f"J⁻ᵀKJ⁻¹; f1 = {first:.1f} in place of {first_balanced:.1f} Hz; equal drives give the "
        f"same f1 to {abs(same):.0e} Hz",
        used="J⁻ᵀKJ⁻¹, by flexibility",
        severity="warning",
        numbers={
            "error as printed": error,
            "error with work balance": _difference(balanced, exact),
            "f1 as printed": first,
            "f1 with work balance": first_balanced,
            "f1 difference, equal drives": float(same),
        },
    )


def drive_stiffness(robot: Mechanism) -> float:
    """Stiffness (N/m) of a drive in the simplified model."""
    (first, *_) = (joint.drive for joint in robot.joints if joint.kind == "prismatic")
    if first is None or first.simplified is None:
        raise ValueError(f"{robot.name}: drives without a stiffness of the simplified model")
    return first.simplified


def lever_arms(robot: Mechanism) -> Finding:
    """Eqs (17), (18) hold in the leg's axes; beside eq. (15) they must be turned by D_k."""
    leg_axes, base_axes = robot.reference["leg1"].rotation, np.eye(3)
    spring, arm = _spring_and_arm(robot)
    printed = _energy_of_rotation(spring, leg_axes, base_axes, arm, arm)
    turned = _energy_of_rotation(spring, leg_axes, leg_axes, arm, arm)
    along_x = _energy_of_rotation(spring, base_axes, base_axes, arm, arm)
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
            "energy of a leg along x": along_x,
        },
    )


def small_rotations(robot: Mechanism) -> Finding:
    """Eq. (19) multiplies the rotations by their own cross-product matrix, φ × φ = 0."""
    bend = np.array([0.0, 0.0, 0.0, 0.0, 0.0, _ROTATION])
    # diag(I₃, Rˢ) q of eq. (19)
    deflection = np.concatenate([bend[:3], np.cross(bend[3:], bend[3:])])
    stiffness, _ = _spring_and_arm(robot)
    stored = float(0.5 * deflection @ stiffness @ deflection)
    due = float(0.5 * bend @ stiffness @ bend)
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


def neighbour_index(robot: Mechanism) -> Finding:
    """Eq. (23) couples spring 1 by C₁,₃, the arm of element 3, to element 2."""
    spring, arm = _spring_and_arm(robot)
    axes = np.eye(3)
    arm_of_third = 2.0 * arm
    printed = _energy_of_rotation(spring, axes, axes, arm, arm_of_third)
    correct = _energy_of_rotation(spring, axes, axes, arm, arm)
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


def joint_release(foot_compliance: Array) -> Finding:
    """Eq. (25) zeroes row and column of φz; a joint in series is a condensation."""
    stiffness: Array = np.linalg.inv(foot_compliance).astype(float)
    printed = float(printed_release(stiffness)[1, 1])
    condensed = float(condensed_release(stiffness)[1, 1])
    return Finding(
        "eq. (25)",
        "joint release",
        printed="K_R = I₅ K_S I₅",
        wrong="zeroing row and column of φz holds φz at zero instead of releasing it, wherever φz "
        "is coupled; it contradicts eq. (3)",
        evidence=f"the foot resists y with {printed:.3g} N/m as printed, {condensed:.3g} N/m with "
        f"a free joint; 1/c22 = {1.0 / foot_compliance[1, 1]:.3g} N/m",
        used="K_S − K_S e₆ e₆ᵀ K_S / k₆₆; the printed form as a variant",
        severity="error",
        numbers={
            "y stiffness as printed": printed,
            "y stiffness condensed": condensed,
            "1/c22": float(1.0 / foot_compliance[1, 1]),
        },
    )


def _energy_of_rotation(
    spring: Array,
    leg_axes: Array,
    arm_axes: Array,
    arm: float,
    assumed_arm: float,
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


def _spring_and_arm(robot: Mechanism) -> tuple[Array, float]:
    """Stiffness (6×6, leg axes) between two elements of leg 1, and half an element's length (m)."""
    leg = equivalent_leg(legs(robot)[0])
    piece = leg.length / _ELEMENTS
    compliance = leg.properties("euler-bernoulli").piece_compliance(piece)
    return np.diag(1.0 / np.diag(compliance)), piece / 2.0


def _first_frequency(stiffness: Array, robot: Mechanism) -> float:
    smallest = float(np.linalg.eigvals(stiffness).real.min())
    return float(np.sqrt(smallest / robot.tool.mass) / (2.0 * np.pi))


def _difference(matrix: Array, reference: Array) -> float:
    return float(np.linalg.norm(matrix - reference) / np.linalg.norm(reference))
