"""Which parts of the biglide carry the strain energy of its modes: of beams, and of solid legs."""

from collections.abc import Mapping

import numpy as np

from fem.bodies.leg_energies import DISTORTION
from lumped.arrays import Array
from lumped.system.joint_motion import Portion
from validation.context import Context
from validation.drawing.style import csv_of
from validation.exhibits import SOLID_ROBOT, STROKE
from validation.report.figures.declared import FigureGroup, Shown
from validation.report.figures.mechanism.mode_names import mode_names
from validation.report.figures.stacked_bars import (
    DRIVES,
    JOINTS,
    KINDS,
    Shares,
    energy_table,
    stacked_bars,
)
from validation.solids.sixty import ALONE, FEET, SIXTY, SixtyModes, in_the_feet, sixty
from validation.studies.quantities import RobotModes, robot_modes

MODES = 6
# From the bottom of the bars to their top.
_COLOURS = {"foot": DRIVES, "tool": JOINTS, **KINDS, DISTORTION: "#bbbbbb"}
_BENDING = "Bending y is deflection along z, bending z deflection in the robot's plane."
_TITLE = "Where the strain energy of the first"
figures = FigureGroup(STROKE, "figures.dynamics")
figures_of_solids = FigureGroup(SOLID_ROBOT, "robot.solid.sixty")


@figures.figure("robot.strain-energy", f"{_TITLE} modes sits")
def of_beams(context: Context) -> Shown:
    """One stacked bar for each mode, above for leg 1 and its foot, below for leg 2 and its foot."""
    robot = context.robot
    beam, segments = (
        context.get(robot_modes, model, robot, robot.centre, MODES)
        for model in ("beam", "segments")
    )
    columns = energy_table(beam.modes.frequencies, beam.strain)
    of_segments = energy_table(segments.modes.frequencies, segments.strain)
    del of_segments["mode"]
    return Shown(
        _said_of_beams(beam, robot.centre),
        stacked_bars(_panels(beam.strain), _COLOURS, 3, beam.modes.frequencies),
        data=csv_of(columns | {f"segments: {name}": one for name, one in of_segments.items()}),
    )


@figures_of_solids.figure(
    "robot.solid.sixty-modes", f"{_TITLE} {SIXTY} modes of the solid robot sits", effort=8.0
)
def of_solids(context: Context) -> Shown:
    """The same of both legs as solids."""
    found = sixty(context)
    return Shown(
        _said_of_solids(found),
        stacked_bars(_panels(found.shares), _COLOURS, 3, found.frequencies),
        data=csv_of(energy_table(found.frequencies, found.shares)),
    )


def _panels(strain: Mapping[Portion, Array]) -> dict[str, Shares]:
    return {
        f"({'ab'[number - 1]}) foot {number} and leg {number}": {
            kind: share for kind in _COLOURS if (share := _share(strain, kind, number)) is not None
        }
        for number in (1, 2)
    }


def _share(strain: Mapping[Portion, Array], kind: str, number: int) -> Array | None:
    """Share of a kind in foot or leg `number`; the tool goes with leg 1, as the platform does."""
    if kind == "tool":
        return strain.get(Portion("tool")) if number == 1 else None
    foot, leg = Portion(f"foot {number}"), Portion(f"leg {number}", kind)
    return strain.get(foot if kind == "foot" else leg)


def _said_of_beams(found: RobotModes, x: float) -> str:
    said = [
        f"Beam model, B at the centre of the stroke (x = {x:.4g} m); the bars of both pictures "
        f"together are 100 %. {_BENDING}"
    ]
    names = mode_names(found.system, found.modes.shapes)
    for mode in range(2):
        part, shares = max(found.strain.items(), key=lambda item: item[1][mode])
        said.append(
            f"{names.said(mode)} Its largest share, "
            f"{100.0 * shares[mode]:.0f} %, is in {f'{part.of}, {part.kind}'.rstrip(', ')}."
        )
    of_feet = [found.strain[foot] for foot in FEET if foot in found.strain]
    if of_feet:
        feet = np.sum(of_feet, axis=0)
        said.append(
            f"The feet hold at most {100.0 * feet.max():.0f} % of any of these modes: "
            f"{_alone(float(feet.max()))}"
        )
    return " ".join(said)


def _said_of_solids(found: SixtyModes) -> str:
    feet = in_the_feet(found)
    most = int(np.argmax(feet))
    distorted = np.sum([s for part, s in found.shares.items() if part.kind == DISTORTION], axis=0)
    return (
        f"Both legs as solids with rigid end faces, B at x = {found.x:.4g} m, "
        f"{found.frequencies[0]:.0f} Hz to {found.frequencies[-1]:.0f} Hz; the bars of both "
        f"pictures together are 100 %. {_BENDING} The feet hold at most "
        f"{100.0 * feet[most]:.0f} % (mode {most + 1}): {_alone(float(feet[most]))} "
        "Tension, torsion and bending with its shear are the projection of the "
        "solid's stresses on those of beam theory; section distortion is all that is left. It is "
        f"more than half of the energy in {int(np.sum(distorted > 0.5))} modes, which no beam "
        "model can show."
    )


def _alone(share: float) -> str:
    if share > ALONE:
        return "there is a mode of the feet alone."
    return "none of these modes is due to the feet, that is to the actuators, alone."
