"""Which parts carry the strain energy of the first sixty modes of the solid robot."""

import numpy as np

from fem.bodies.leg_energies import DISTORTION
from lumped.arrays import Array
from lumped.system.joint_motion import Portion
from validation.context import Context
from validation.drawing.style import csv_of
from validation.exhibits import SOLID_ROBOT
from validation.report.figures.curves.energy import MEANINGS
from validation.report.figures.declared import FigureGroup, Shown
from validation.report.figures.stacked_bars import (
    DRIVES,
    JOINTS,
    KINDS,
    energy_table,
    stacked_bars,
)
from validation.solids.sixty import ALONE, SIXTY, SixtyModes, in_the_feet, sixty

# From the bottom of the bars to their top.
_COLOURS = {"foot": DRIVES, "tool": JOINTS, **KINDS, DISTORTION: "#bbbbbb"}
figures = FigureGroup(SOLID_ROBOT, "robot.solid.sixty")


@figures.figure(
    "robot.solid.sixty-modes",
    f"Where the strain energy of the first {SIXTY} modes of the solid robot sits",
    effort=8.0,
)
def energies(context: Context) -> Shown:
    """One stacked bar for each mode, above for leg 1 and its foot, below for leg 2 and its foot."""
    found = sixty(context)
    panels = {
        f"({'ab'[number - 1]}) foot {number} and leg {number}": {
            MEANINGS.get(kind, kind): share
            for kind in _COLOURS
            if (share := _share(found, kind, number)) is not None
        }
        for number in (1, 2)
    }
    colours = {MEANINGS.get(kind, kind): colour for kind, colour in _COLOURS.items()}
    return Shown(
        _caption(found),
        stacked_bars(panels, colours, legend_columns=3),
        data=csv_of(energy_table(found.frequencies, found.shares)),
    )


def _share(found: SixtyModes, kind: str, number: int) -> Array | None:
    """Share of a kind in foot or leg `number`; the tool goes with leg 1, as the platform does."""
    if kind == "tool":
        return found.shares.get(Portion("tool")) if number == 1 else None
    foot, leg = Portion(f"foot {number}"), Portion(f"leg {number}", kind)
    return found.shares.get(foot if kind == "foot" else leg)


def _caption(found: SixtyModes) -> str:
    feet = in_the_feet(found)
    most = int(np.argmax(feet))
    distorted = np.sum([s for part, s in found.shares.items() if part.kind == DISTORTION], axis=0)
    return (
        f"Both legs as solids with rigid end faces, B at x = {found.x:.4g} m, "
        f"{found.frequencies[0]:.0f} Hz to {found.frequencies[-1]:.0f} Hz; the bars of both "
        "pictures together are 100 %. The feet hold at most "
        f"{100.0 * feet[most]:.0f} % (mode {most + 1}): "
        + (
            "there is a mode of the feet alone. "
            if feet[most] > ALONE
            else "none of these modes is due to the feet, that is to the actuators, alone. "
        )
        + "Tension, torsion and bending with its shear are the projection of the "
        "solid's stresses on those of beam theory; section distortion is all that is left. It is "
        f"more than half of the energy in {int(np.sum(distorted > 0.5))} modes, which no beam "
        "model can show."
    )
