"""Statements about natural frequencies and modes (paper §3.1 and §3.2)."""

import numpy as np

from fem.bodies.beam_theory import bending_frequencies
from lumped.biglide_assembly import Release
from lumped.legs import equivalent_leg
from validation.case import Absolute, Measurement, Relation, Relative
from validation.cases.paper_statement import POSTURES, Statement
from validation.context import Context
from validation.models.legs import leg_frequencies
from validation.models.options import ModelOptions
from validation.quantities import RobotModes, robot_modes, stroke_frequencies


def _simplified_frequency(context: Context) -> Measurement:
    first = context.get(stroke_frequencies, "simplified", context.robot, POSTURES, 1)
    return Measurement(float(first.min()), reference=710.0)


def _modes(context: Context, release: Release, count: int) -> RobotModes:
    options = ModelOptions(release=release)
    return context.get(robot_modes, "segments", context.robot, context.robot.centre, count, options)


def _first_mode_along_z(context: Context) -> Measurement:
    shares = [
        context.get(robot_modes, "segments", context.robot, x, 2).kinetic["z"][0]
        for x in context.robot.stations(9)
    ]
    return Measurement(100.0 * min(shares), reference=100.0)


def _second_mode_planar(context: Context) -> Measurement:
    shares = [
        context.get(robot_modes, "segments", context.robot, x, 2).kinetic["z"][1]
        for x in context.robot.stations(9)
    ]
    return Measurement(100.0 * (1.0 - max(shares)), reference=100.0)


def _second_mode_bends_leg1(context: Context) -> Measurement:
    printed = {part: s[1] for part, s in _modes(context, "printed", 2).strain.items()}
    exact = {part: s[1] for part, s in _modes(context, "condensed", 2).strain.items()}
    rank = 1 + sum(share > printed["leg 1 bending z"] for share in printed.values())
    feet = exact["foot 1"] + exact["foot 2"]
    return Measurement(
        float(rank),
        reference=1.0,
        notes=(
            "With eq. (25) as printed the bending of leg 1 in the plane holds "
            f"{100.0 * printed['leg 1 bending z']:.0f} % of the strain energy. With joints that "
            f"turn freely it holds {100.0 * exact['leg 1 bending z']:.0f} % and the feet "
            f"{100.0 * feet:.0f} %: the second mode is then a planar motion on the feet.",
        ),
        table={
            "part": tuple(exact),
            "eq. (25) as printed (%)": tuple(100.0 * printed.get(part, np.nan) for part in exact),
            "free joints (%)": tuple(100.0 * share for share in exact.values()),
        },
    )


def _leg1_beam(context: Context) -> Measurement:
    leg = context.get(equivalent_leg, context.robot.leg1)
    found = bending_frequencies(leg.timoshenko, leg.length, "y", 1)
    in_plane = bending_frequencies(leg.timoshenko, leg.length, "z", 1)
    return Measurement(
        float(found[0]),
        reference=180.0,
        notes=(
            "That is bending out of the plane, deflection along z. In the plane the same beam has "
            f"its first frequency at {float(in_plane[0]):.1f} Hz.",
        ),
    )


def _twenty_elements(context: Context) -> Measurement:
    leg = context.get(equivalent_leg, context.robot.leg1)
    exact = float(bending_frequencies(leg.timoshenko, leg.length, "y", 1)[0])
    half, literal = (
        leg_frequencies("segments", leg, 2, ModelOptions(layout=layout))
        for layout in ("half", "literal")
    )
    nearest = float(half[np.argmin(np.abs(half - exact))])
    as_printed = float(literal[np.argmin(np.abs(literal - exact))])
    return Measurement(
        nearest,
        reference=exact,
        notes=(
            "It takes springs of half length at both ends. With springs between the elements "
            "alone, as the text reads, a length L/20 of the leg stays rigid and the error is "
            f"{100.0 * (as_printed / exact - 1.0):+.1f} %.",
        ),
    )


def _actuators_alone(context: Context) -> Measurement:
    found = context.get(robot_modes, "beam", context.robot, context.robot.centre, 60)
    feet = found.strain["foot 1"] + found.strain["foot 2"]
    largest = int(np.argmax(feet))
    return Measurement(
        float(np.sum(feet > 0.95)),
        reference=0.0,
        notes=(
            f"The largest share of the feet, which stand for the actuators, is "
            f"{100.0 * feet[largest]:.0f} % in mode {largest + 1}.",
        ),
    )


STATEMENTS = (
    Statement(
        "simplified.first-frequency",
        "§3.1, Fig. 7",
        "Simplified model: the first natural frequency stays above 710 Hz",
        "lowest first frequency over the stroke",
        "Hz",
        Absolute(5.0),
        "half a unit in the last printed digit that counts (tens)",
        _simplified_frequency,
        Relation.AT_LEAST,
    ),
    Statement(
        "refined.first-mode-along-z",
        "§3.2, Fig. 11a",
        "Rigid segments: the first mode bends the robot along z, everywhere in the stroke",
        "least share of kinetic energy along z, nine postures",
        "%",
        Absolute(5.0),
        "a mode is named by its direction if 95 % of its motion goes there",
        _first_mode_along_z,
        group="paper.modes",
        effort=1.0,
    ),
    Statement(
        "refined.second-mode-planar",
        "§3.2, Fig. 11b",
        "Rigid segments: the second mode is planar, everywhere in the stroke",
        "least share of kinetic energy in the plane, nine postures",
        "%",
        Absolute(5.0),
        "a mode is named by its direction if 95 % of its motion goes there",
        _second_mode_planar,
        group="paper.modes",
    ),
    Statement(
        "refined.second-mode-leg1",
        "§3.2, Fig. 11b",
        "Rigid segments: the second mode is due to the bending of leg 1 (eq. 25 as printed)",
        "rank of that bending among the parts' strain energies",
        "1",
        Absolute(0.5),
        "a rank is a whole number",
        _second_mode_bends_leg1,
        group="paper.modes",
    ),
    Statement(
        "refined.leg1-beam",
        "§3.2",
        "The equivalent beam of leg 1 has its first natural frequency at about 180 Hz",
        "first bending frequency along z, clamped-free, exact Timoshenko beam",
        "Hz",
        Absolute(5.0),
        "half a unit in the last printed digit that counts (tens)",
        _leg1_beam,
        group="paper.beam",
    ),
    Statement(
        "refined.twenty-elements",
        "§3.2",
        "With 20 elements the segments miss the beam's first frequency by less than 1 %",
        "first bending frequency of leg 1, half-length springs at the ends",
        "Hz",
        Relative(0.01),
        "the statement itself",
        _twenty_elements,
        group="paper.beam",
    ),
    Statement(
        "refined.actuators-alone",
        "§3.2",
        "None of the first 60 modes is due to the actuators alone",
        "modes with more than 95 % of the strain energy in the feet (beam model, centre)",
        "1",
        Absolute(0.5),
        "a count is a whole number",
        _actuators_alone,
        group="paper.sixty",
        effort=1.0,
    ),
)
