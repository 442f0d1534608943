"""Guards of sweeps and of the sparse robot: with beams for legs both are the frame of beams."""

from functools import partial

import numpy as np

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
from validation.case import Absolute, Case, Measurement, Tolerance
from validation.cases.program.guards.reduction import guard_case
from validation.cases.program.guards.robot import (
    ELEMENTS,
    MODES,
    VARIANTS,
    frame_compliance,
    guarded_posture,
    robot_frame,
    scaled_difference,
)
from validation.context import Context
from validation.models.legs import filled, leg_matrices
from validation.models.options import ModelOptions

_SWEPT_VARIANTS = ("as it is", "tool offset")


def cases() -> tuple[Case, ...]:
    """Compliance and frequencies by both ways, with and without a tool offset."""
    frame = "the same robot as a frame of Timoshenko beams, placed by coordinates (fem.beams.frame)"
    reduced = (
        f"largest relative difference of the first {MODES}",
        frame,
        Absolute(1e-4),
        "the cut-off of the reduced legs is chosen for 1e-4; the same elements otherwise",
    )
    rounding = (
        "largest difference of the 6×6 in units of √(c_ii c_jj)",
        frame,
        Absolute(1e-7),
        "one statics and one set of elements: rounding, grown by the condition of slender legs",
    )
    ways: dict[str, tuple[str, Tolerance, str]] = {
        "swept": ("A posture of a sweep", *reduced[2:]),
        "sparse": (
            "The sparse solution of the unreduced robot",
            Absolute(1e-7),
            "the same elements: rounding and the convergence of Lanczos",
        ),
    }
    return tuple(
        case
        for way, (title, tolerance, reason) in ways.items()
        for name in _SWEPT_VARIANTS
        for case in (
            guard_case(
                f"sweep.{way}.compliance[{name}]",
                f"{title} has the compliance of a frame of beams ({name})",
                *rounding,
                partial(_robot_compliance, way=way, name=name),
            ),
            guard_case(
                f"sweep.{way}.frequency[{name}]",
                f"{title} has the first frequencies of a frame of beams ({name})",
                reduced[0],
                frame,
                tolerance,
                reason,
                partial(_robot_frequencies, way=way, name=name),
            ),
        )
    )


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


_WAYS = {"swept": swept, "sparse": sparse}


def _robot_compliance(context: Context, way: str, name: str) -> Measurement:
    robot = VARIANTS[name](context.robot)
    found, _ = context.get(_WAYS[way], robot)
    frame = context.get(robot_frame, robot)
    return Measurement(scaled_difference(found, frame_compliance(frame)), 0.0, exact=True)


def _robot_frequencies(context: Context, way: str, name: str) -> Measurement:
    robot = VARIANTS[name](context.robot)
    _, found = context.get(_WAYS[way], robot)
    reference = frame_modes(context.get(robot_frame, robot), MODES).frequencies
    return Measurement(float(np.abs(found / reference - 1.0).max()), 0.0, exact=True)
