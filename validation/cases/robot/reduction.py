"""The robot of reduced solid legs against the same robot without reduction."""

from dataclasses import dataclass

import numpy as np

from fem.reduction.craig_bampton import craig_bampton, frequency_bounds
from fem.reduction.superelement import held_leg
from lumped.arrays import Array
from lumped.biglide import Biglide, system, with_equivalent_legs
from lumped.dense.balance import ELIMINATION
from lumped.system.solution import compliance, mode_count, modes, solved
from validation.case import Absolute, Measurement, Relative, Skip, others
from validation.case_group import CaseGroup
from validation.cases.robot.stroke import BEYOND_ROUNDING
from validation.context import Context, Preset
from validation.exhibits import SOLID_ROBOT
from validation.models.biglide import highest_frequency
from validation.solids.robots import full_mac, recovered, unreduced_robot
from validation.solids.size import skip_too_large

MODES = 20
# A prism of any regular section has its modes of bending and of its walls in pairs.
_BEYOND = 2
DIVISIONS: dict[Preset, int] = {"quick": 1, "standard": 2, "fine": 3}
# A cut-off just above the highest frequency leaves an error that is worth a bound.
CLOSE_CUTOFF = 1.1
# Bounds below this are lost in the rounding of the frequencies.
_ROUNDING = 1e-9
_UNREDUCED = "the same meshes without reduction, sparse Cholesky and Lanczos"

cases = CaseGroup(
    unit="1",
    reference_kind="finer-model",
    citation=_UNREDUCED,
    model="solid",
    section=SOLID_ROBOT,
    group="robot.solid.reduction",
    effort=2.0,
)


@dataclass(frozen=True)
class Reduction:
    """What the reduction does to the robot with B at `x` (m).

    `statics`: largest difference of the compliance in units of √(c_ii c_jj), of which `rounding` is
    what that of the stiffness matrix leaves open of either. `unreduced` and
    `reduced` frequencies (Hz), `mac` of their shapes on all unknowns. `error` and `bound` (relative
    to the frequencies) with the close cut-off.
    """

    x: float
    statics: float
    rounding: float
    unreduced: Array
    reduced: Array
    mac: Array
    error: Array
    bound: Array


def reductions(
    robot: Biglide, positions: tuple[float, ...], divisions: int, highest: float
) -> tuple[Reduction, ...]:
    """The reduction for frequencies up to `highest` (Hz) at every position (m)."""
    member = with_equivalent_legs(robot)
    exact = unreduced_robot(member, positions, divisions, MODES)
    held = [held_leg(leg) for leg in exact[0].legs]
    top = max(float(one.modes.frequencies[-1]) for one in exact)
    named = dict(zip(("leg1", "leg2"), held, strict=True))
    legs = {name: craig_bampton(leg, max(highest, top)) for name, leg in named.items()}
    cut = {name: craig_bampton(leg, top, CLOSE_CUTOFF * top) for name, leg in named.items()}
    found = []
    for x, whole in zip(positions, exact, strict=True):
        reduced = solved(system(member, x, *(leg.matrices for leg in legs.values())))
        # Those beyond complete the space of a last mode that is one of several.
        swung = modes(reduced, min(MODES + _BEYOND, mode_count(reduced)))
        sizes = np.sqrt(np.diag(whole.compliance))
        scale = np.outer(sizes, sizes)
        difference = compliance(reduced) - whole.compliance
        closely = system(member, x, *(leg.matrices for leg in cut.values()))
        bounds = frequency_bounds(closely, cut, MODES)
        found.append(
            Reduction(
                x=x,
                statics=float(np.abs(difference / scale).max()),
                rounding=float((whole.rounding / scale).max()),
                unreduced=whole.modes.frequencies,
                reduced=swung.frequencies[:MODES],
                mac=full_mac(
                    whole.system.mass,
                    whole.modes.shapes,
                    recovered(reduced.system, legs, swung.shapes),
                    swung.frequencies,
                ),
                error=1.0 - whole.modes.frequencies / bounds.upper,
                bound=bounds.relative_width,
            )
        )
    return tuple(found)


def _found(context: Context) -> tuple[Reduction, ...]:
    """The reduction at two postures; raises Skip where a leg is too slender to be meshed."""
    robot = context.robot
    legs = robot.leg1, robot.leg2
    skip_too_large(legs, 2 * (DIVISIONS[context.preset],), context.preset)
    positions = (robot.stroke[0], robot.centre)
    highest = max(highest_frequency(robot, x, MODES) for x in positions)
    return context.get(reductions, robot, positions, DIVISIONS[context.preset], highest)


@cases.case(
    "robot.solid.reduction.statics",
    "Reduced legs give the statics of the unreduced robot",
    quantity="largest difference of the 6×6 in units of √(c_ii c_jj)",
    tolerance=Absolute(1e-9),
    tolerance_reason="exact in theory: rounding of the factor of the whole robot alone",
)
def _statics(context: Context) -> Measurement:
    worst = max(_found(context), key=lambda one: one.statics)
    # Both eliminate one stiffness matrix, each in an order of its own: what is seen of elimination
    # is seen of their difference.
    lost = ELIMINATION * worst.rounding / np.sqrt(2.0)
    return Measurement(
        worst.statics,
        0.0,
        value_uncertainty=lost,
        reference_uncertainty=lost,
        notes=(_place(worst),),
        decides=BEYOND_ROUNDING,
    )


@cases.case(
    "robot.solid.reduction.frequencies",
    f"Reduced legs give the first {MODES} frequencies of the unreduced robot",
    quantity=f"frequency {MODES} at the left end of the stroke, the others beside it",
    unit="Hz",
    tolerance=Relative(1e-4),
    tolerance_reason="the cut-off is chosen for 1e-4 at the highest frequency asked for",
)
def _frequency(context: Context) -> Measurement:
    found = _found(context)
    places = [f"mode {mode + 1}, {_place(one)}" for one in found for mode in range(MODES)]
    reduced = np.concatenate([one.reduced for one in found])
    unreduced = np.concatenate([one.unreduced for one in found])
    # The highest mode has the largest error of a reduction.
    own = MODES - 1
    return Measurement(
        float(reduced[own]),
        float(unreduced[own]),
        exact=True,
        elsewhere=others(places, reduced, unreduced, None, own),
        notes=(places[own],),
        table={"mode": tuple(float(k) for k in range(1, MODES + 1))}
        | {
            f"{model}, x = {one.x:.4g} m (Hz)": tuple(values.tolist())
            for one in found
            for model, values in (("unreduced", one.unreduced), ("reduced", one.reduced))
        },
    )


@cases.case(
    "robot.solid.reduction.mac",
    f"Reduced legs give the first {MODES} shapes, recovered on all unknowns of the mesh",
    quantity="smallest mass-weighted MAC",
    tolerance=Absolute(1e-4),
    tolerance_reason="shapes are right to the root of the frequencies' 1e-4",
)
def _mac(context: Context) -> Measurement:
    worst = min(_found(context), key=lambda one: float(one.mac.min()))
    mode = int(np.argmin(worst.mac))
    return Measurement(
        float(worst.mac[mode]), 1.0, exact=True, notes=(f"mode {mode + 1}, {_place(worst)}",)
    )


@cases.case(
    "robot.solid.reduction.bound",
    "The stated error of the reduction bounds the true one",
    quantity="largest true error as a share of its bound, legs cut off at "
    f"{CLOSE_CUTOFF:g} times the highest frequency",
    tolerance=Absolute(0.5),
    tolerance_reason="between 0 (Rayleigh: the reduced robot is never too soft) and 1 (the bound)",
)
def _bound(context: Context) -> Measurement:
    found = _found(context)
    shares = np.array(
        [
            np.divide(
                one.error,
                one.bound,
                out=np.full(MODES, -np.inf),
                where=one.bound > max(_ROUNDING, one.rounding),
            )
            for one in found
        ]
    )
    if not np.isfinite(shares).any():
        raise Skip("every bound is less than rounding leaves of the stiffness")
    posture, mode = np.unravel_index(int(np.argmax(shares)), shares.shape)
    worst = found[int(posture)]
    return Measurement(
        float(shares[posture, mode]),
        0.5,
        exact=True,
        notes=(
            f"mode {int(mode) + 1}, {_place(worst)}: error {worst.error[mode]:.2g}, bound "
            f"{worst.bound[mode]:.2g} of the frequency",
            "the reference is the middle of what the theory allows",
        ),
        table={"mode": tuple(float(k) for k in range(1, MODES + 1))}
        | {
            f"{name}, x = {one.x:.4g} m": tuple(values.tolist())
            for one in found
            for name, values in (("error", one.error), ("bound", one.bound))
        },
    )


def _place(one: Reduction) -> str:
    return f"x = {one.x:.4g} m"
