"""Guards of sweeps and of the sparse robot: with beams for legs both are the frame of beams."""

from collections.abc import Callable
from typing import TypeAlias

from fem.beams.frame import modes as frame_modes
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from fem.solvers import sparse_system
from lumped.arrays import Array
from lumped.biglide import Biglide, postures, system
from lumped.legs import equivalent_leg
from lumped.mechanism.body_model import LegMatrices
from lumped.system import sweep
from lumped.system.assembly import assembly
from validation.agreement.differences import farthest_off, scaled_difference
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.guards.robot import (
    ELEMENTS,
    MODES,
    SECTION,
    VARIANTS,
    frame_compliance,
    guarded_posture,
    robot_frame,
)
from validation.context import Context
from validation.models.legs import filled, leg_matrices
from validation.models.options import ModelOptions


def _beam_legs(robot: Biglide) -> tuple[LegMatrices, LegMatrices]:
    leg1, leg2 = (
        leg_matrices("beam", equivalent_leg(leg), ModelOptions(elements=ELEMENTS))
        for leg in (robot.leg1, robot.leg2)
    )
    return leg1, leg2


def swept(robot: Biglide) -> tuple[Array, Array]:
    """Compliance (6×6, SI) and frequencies (Hz) in the guards' posture, by a sweep."""
    highest = float(frame_modes(robot_frame(robot), MODES).frequencies[-1])
    leg1, leg2 = (craig_bampton(held_leg(leg), highest).matrices for leg in _beam_legs(robot))
    # The posture asked for is the second one: it differs from the first.
    places = postures(robot, (robot.stroke[0], guarded_posture(robot)))
    prepared = assembly(places[0].mechanism, {"leg1": filled(leg1), "leg2": filled(leg2)})
    found = sweep.swept(prepared, places, MODES)
    return found.compliances[1], found.frequencies[1]


def sparse(robot: Biglide) -> tuple[Array, Array]:
    """The same of the unreduced robot by its sparse factor."""
    whole = system(robot, guarded_posture(robot), *_beam_legs(robot))
    found = sparse_system.factorised(whole)
    return sparse_system.compliance(found), sparse_system.modes(found, MODES).frequencies


Solve: TypeAlias = Callable[[Biglide], tuple[Array, Array]]
_ROUNDED = Absolute(1e-7)
# By each way: what is solved, how near its frequencies are, and why.
_WAYS = (
    (
        "swept",
        "A posture of a sweep",
        Absolute(1e-4),
        "the cut-off of the reduced legs is chosen for 1e-4; the same elements otherwise",
        swept,
    ),
    (
        "sparse",
        "The sparse solution of the unreduced robot",
        _ROUNDED,
        "the same elements: rounding and the convergence of Lanczos",
        sparse,
    ),
)
cases = CaseGroup(
    over={"way, what, close, reason, solve": _WAYS, "name": ("as it is", "tool offset")},
    unit="1",
    reference_kind="closed-form",
    citation="the same robot as a frame of Timoshenko beams, placed by coordinates "
    "(fem.beams.frame)",
    section=SECTION,
    group="guard.sweep",
    effort=0.05,
)


@cases.case(
    "guard.sweep.{way}.compliance[{name}]",
    "{what} has the compliance of a frame of beams ({name})",
    quantity="largest difference of the 6×6 in units of √(c_ii c_jj)",
    tolerance=_ROUNDED,
    tolerance_reason="one statics and one set of elements: rounding, grown by the condition of "
    "slender legs",
)
def _robot_compliance(context: Context, solve: Solve, name: str) -> Measurement:
    robot = VARIANTS[name](context.robot)
    found, _ = context.get(solve, robot)
    frame = context.get(robot_frame, robot)
    return farthest_off(scaled_difference(found, frame_compliance(frame)))


@cases.case(
    "guard.sweep.{way}.frequency[{name}]",
    "{what} has the first frequencies of a frame of beams ({name})",
    quantity=f"largest relative difference of the first {MODES}",
    tolerance=lambda close: close,
    tolerance_reason="{reason}",
)
def _robot_frequencies(context: Context, solve: Solve, name: str) -> Measurement:
    robot = VARIANTS[name](context.robot)
    _, found = context.get(solve, robot)
    reference = frame_modes(context.get(robot_frame, robot), MODES).frequencies
    return farthest_off(found / reference - 1.0)
