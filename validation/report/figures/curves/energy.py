"""Which part of the robot carries the strain energy of its first modes."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from lumped.arrays import Array
from lumped.system.joint_motion import Portion
from validation.context import Context
from validation.drawing.chart import legend_above
from validation.drawing.style import canvas, csv_of, plot_style, svg_of
from validation.exhibits import STROKE
from validation.report.figures.declared import FigureGroup, Shown
from validation.report.figures.stacked_bars import DRIVES, JOINTS, KINDS
from validation.solids.sixty import FEET
from validation.studies.quantities import RobotModes, robot_modes

MODES = 6
# A share below this has no room for its number.
_LABELLED = 0.07
# Parts that together stay below this in every mode are summed up.
_NEGLIGIBLE = 0.02


@dataclass(frozen=True)
class PartLook:
    """How a part of the robot is drawn; `ink` is legible on `colour`."""

    colour: str
    ink: str
    hatch: str = ""


_INKS = {DRIVES: "white", KINDS["bending y"]: "white", JOINTS: "white"}
_JOINTS = {**dict.fromkeys(FEET, DRIVES), Portion("tool"): JOINTS}
_HATCHED = ("leg 2", "foot 2")
_OTHERS = Portion("all others")
MEANINGS = {"bending y": "bending out of the plane", "bending z": "bending in the plane"}
figures = FigureGroup(STROKE, "figures.dynamics")


@figures.figure("robot.strain-energy", "Where the strain energy of the first modes sits")
def strain_energy(context: Context) -> Shown:
    """Stacked bars, one for each mode of the beam model."""
    robot = context.robot
    beam, segments = (
        context.get(robot_modes, model, robot, robot.centre, MODES)
        for model in ("beam", "segments")
    )
    with plot_style():
        picture, (axes,) = canvas(height=4.2)
        _bars(axes, beam)
        legend_above(picture, columns=3)
        svg = svg_of(picture)
    return Shown(
        _caption(beam, robot.centre),
        svg,
        data=_table({"beam FE": beam, "segments": segments}),
    )


def part_name(part: Portion) -> str:
    """A part as engineers say it: bending z of leg 1 is its bending in the robot's plane."""
    return f"{part.of}, {MEANINGS.get(part.kind, part.kind)}" if part.kind else part.of


def visible_parts(
    strain: Mapping[Portion, Array], least: float = _NEGLIGIBLE
) -> dict[Portion, Array]:
    """The shares of the parts that reach `least` in some mode, and the sum of all others."""
    kept = {part: shares for part, shares in strain.items() if np.max(shares) >= least}
    rest = 1.0 - np.sum(list(kept.values()), axis=0)
    return kept | ({_OTHERS: rest} if len(kept) < len(strain) else {})


def _look(part: Portion) -> PartLook:
    colour = _JOINTS.get(part) or KINDS.get(part.kind, "#bbbbbb")
    return PartLook(colour, _INKS.get(colour, "black"), "///" if part.of in _HATCHED else "")


def _bars(axes: Axes, found: RobotModes) -> None:
    rows = np.arange(MODES)
    left = np.zeros(MODES)
    for part, shares in visible_parts(found.strain).items():
        look = _look(part)
        axes.barh(
            rows,
            100.0 * shares,
            left=100.0 * left,
            height=0.68,
            color=look.colour,
            hatch=look.hatch,
            edgecolor="white",
            linewidth=0.6,
            label=part_name(part),
        )
        for row in np.flatnonzero(shares >= _LABELLED):
            axes.text(
                100.0 * (left[row] + shares[row] / 2.0),
                float(row),
                f"{100.0 * shares[row]:.0f}",
                ha="center",
                va="center",
                fontsize=8.5,
                color=look.ink,
                bbox={"facecolor": look.colour, "edgecolor": "none", "pad": 1.2},
            )
        left += shares
    frequencies = found.modes.frequencies
    axes.set_yticks(rows, [f"mode {k + 1}: {f:.0f} Hz" for k, f in enumerate(frequencies)])
    axes.set(xlim=(0.0, 100.0), xlabel="share of the strain energy (%)")
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")


def _caption(found: RobotModes, x: float) -> str:
    said = [
        f"Beam model, B at the centre of the stroke (x = {x:.4g} m); a number is a share in %, "
        "hatched parts belong to the second drive and leg."
    ]
    for mode in range(2):
        part, shares = max(found.strain.items(), key=lambda item: item[1][mode])
        along_z = float(found.kinetic["z"][mode])
        direction = "along z" if along_z > 0.5 else "in the plane"
        said.append(
            f"Mode {mode + 1} moves {direction}; its largest share, "
            f"{100.0 * shares[mode]:.0f} %, is in {part_name(part)}."
        )
    of_feet = [found.strain[foot] for foot in FEET if foot in found.strain]
    if of_feet:
        feet = np.sum(of_feet, axis=0)
        said.append(
            f"The feet hold at most {100.0 * feet.max():.0f} % of any of these modes: "
            + (
                "there is a mode of the feet alone."
                if feet.max() > 0.95
                else "none is due to the feet, that is to the actuators, alone."
            )
        )
    return " ".join(said)


def _table(found: Mapping[str, RobotModes]) -> str:
    columns: dict[str, list[float]] = {"mode": list(range(1, MODES + 1))}
    for model, modes in found.items():
        columns[f"{model}: frequency (Hz)"] = modes.modes.frequencies.tolist()
        for part, shares in modes.strain.items():
            columns[f"{model}: {part_name(part)} (%)"] = (100.0 * shares).tolist()
    return csv_of(columns)
