"""The first sixty modes of the solid robot: energies that add up, none due to actuators alone."""

import numpy as np

from fem.bodies.leg_energies import DISTORTION
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.context import Context
from validation.exhibits import SOLID_ROBOT
from validation.solids.sixty import SIXTY, sixty

cases = CaseGroup(unit="1", model="solid", section=SOLID_ROBOT, group="robot.solid.sixty")


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
