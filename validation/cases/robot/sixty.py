"""The first sixty modes of the solid robot: energies that add up, none due to actuators alone."""

import numpy as np

from fem.bodies.leg_energies import DISTORTION
from validation.agreement.convergence import step_factor
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.context import Context
from validation.exhibits import SOLID_ROBOT
from validation.solids.legs import FORMAL_ORDER
from validation.solids.sixty import ALONE, COARSE, DIVISIONS, SIXTY, in_the_feet, sixty, sixty_modes

cases = CaseGroup(unit="1", model="solid", section=SOLID_ROBOT, group="robot.solid.sixty")
# The paper's statement on the actuators, by solids.
paper_cases = cases.like()


@paper_cases.case(
    "paper.solid.none-due-to-the-actuators",
    f"None of the first {SIXTY} modes of the solid robot is due to the feet alone",
    quantity=f"modes with more than {100.0 * ALONE:g} % of the strain energy in the feet",
    reference_kind="paper-statement",
    citation="paper §3.2, the 60 first modes",
    tolerance=Absolute(0.5),
    tolerance_reason="a count: nothing but none will do",
    # A count needs a second mesh to be believed, which a quick answer has no time for.
    presets=("standard", "fine"),
    figure="robot.solid.sixty-modes",
    effort=8.0,
)
def _actuators_alone(context: Context) -> Measurement:
    found = sixty(context)
    feet = in_the_feet(found)
    most = int(np.argmax(feet))
    coarse = in_the_feet(context.get(sixty_modes, context.robot, COARSE))
    factor = step_factor(DIVISIONS[context.preset] / COARSE, FORMAL_ORDER)
    counts = [float(np.sum(shares > ALONE)) for shares in (feet, coarse)]
    return Measurement(
        counts[0],
        0.0,
        value_uncertainty=factor * abs(counts[0] - counts[1]),
        notes=(
            f"at most {100.0 * feet[most]:.2f} %, mode {most + 1} at "
            f"{found.frequencies[most]:.0f} Hz; at most {100.0 * coarse.max():.2f} % on the "
            "coarser mesh",
        ),
        table={
            "mode": tuple(float(k) for k in range(1, SIXTY + 1)),
            "frequency (Hz)": tuple(found.frequencies.tolist()),
        }
        | {f"{part} (%)": tuple((100.0 * share).tolist()) for part, share in found.shares.items()},
    )


@cases.case(
    "robot.solid.sixty.energy",
    f"The parts' energies of the first {SIXTY} modes are Rayleigh's",
    quantity="largest relative difference of the parts' strain energy from ω²/2",
    reference_kind="closed-form",
    citation="Rayleigh's quotient of a mode of unit modal mass",
    tolerance=Absolute(1e-8),
    tolerance_reason="convergence of the modes, squared in their energy",
    effort=3.0,
)
def _balance(context: Context) -> Measurement:
    found = sixty(context)
    worst = int(np.argmax(np.abs(found.balance)))
    distortion = [
        float(share.min()) for part, share in found.shares.items() if part.kind == DISTORTION
    ]
    return Measurement(
        float(found.balance[worst]),
        0.0,
        value_uncertainty=float(found.rounding[worst]),
        notes=(
            f"smallest share of a leg's section distortion {min(distortion):.2g}: never negative "
            "but for rounding (Bessel)",
        ),
    )
