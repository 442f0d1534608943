"""Statements about natural frequencies and modes (paper §3.1 and §3.2)."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fem.beams.beam_theory import Plane, bending_frequencies
from lumped.equivalent_leg import equivalent_leg
from lumped.legs import ConstantLeg
from lumped.system.joint_motion import Portion
from validation.case import Absolute, Measurement, Relation, Relative
from validation.context import Context
from validation.models.legs import leg_frequencies
from validation.models.options import (
    BEAM_ORDER,
    LITERAL_ORDER,
    SEGMENT_ORDER,
    ModelName,
    ModelOptions,
)
from validation.paper.robot import (
    ModeShares,
    Places,
    frequencies,
    legs,
    modes,
    over_stroke,
    stroke_of,
)
from validation.paper.statement import (
    AS_CORRECTED,
    AS_PRINTED,
    FORMULAS,
    PAPER,
    Statements,
    sampled,
)

_BENDING = Portion("leg 1", "bending z")
# Postures at which modes are looked at.
_STATIONS = 9
_SIXTY = 60
# Share of the strain energy above which a mode is due to a part alone.
_ALONE = 0.95
statements = Statements(**PAPER)


def _over_the_stroke(context: Context, reading: ModelOptions) -> Sequence[ModeShares]:
    """The first two modes in segments at nine postures."""
    places = over_stroke(context.robot_file.mechanism, _STATIONS)
    return context.get(modes, "segments", places, 2, reading)


def _at_the_centre(
    context: Context, reading: ModelOptions, count: int, model: ModelName = "segments"
) -> ModeShares:
    mechanism = context.robot_file.mechanism
    centre = Places(mechanism, np.array([stroke_of(mechanism).centre]))
    (found,) = context.get(modes, model, (centre,), count, reading)
    return found


def _leg1(context: Context) -> ConstantLeg:
    """Leg 1 as its equivalent of constant section."""
    return equivalent_leg(legs(context.robot_file.mechanism)[0])


def _first_of_leg1(context: Context, plane: Plane = "y") -> float:
    leg = _leg1(context)
    return float(bending_frequencies(leg.timoshenko, leg.length, plane, 1)[0])


@statements.says(
    "simplified.first-frequency",
    "§3.1, Fig. 7",
    "Simplified model: the first natural frequency stays above 710 Hz",
    quantity="lowest first frequency over the stroke",
    unit="Hz",
    tolerance=Absolute(5.0),
    tolerance_reason="half a unit in the last printed digit that counts (tens)",
    relation=Relation.AT_LEAST,
    figure="frequency.stroke",
)
def _simplified_frequency(context: Context) -> Measurement:
    def lowest(postures: int) -> float:
        places = over_stroke(context.robot_file.mechanism, postures)
        return float(context.get(frequencies, "simplified", places, 1).min())

    return sampled(lowest, reference=710.0)


direction = statements.family(
    unit="%",
    tolerance=Absolute(5.0),
    tolerance_reason="a mode is named by its direction if 95 % of its motion goes there",
    figure="frequency.stroke",
)


@direction.says(
    "refined.first-mode-along-z",
    "§3.2, Fig. 11a",
    "Rigid segments: the first mode bends the robot along z, everywhere in the stroke",
    quantity="least share of kinetic energy along z, nine postures",
    order=SEGMENT_ORDER,
    effort=1.0,
    differs=FORMULAS,
)
def _first_mode_along_z(context: Context, reading: ModelOptions) -> Measurement:
    shares = [found.kinetic["z"][0] for found in _over_the_stroke(context, reading)]
    return Measurement(100.0 * min(shares), reference=100.0, exact=True)


@direction.says(
    "refined.second-mode-planar",
    "§3.2, Fig. 11b",
    "Rigid segments: the second mode is planar, everywhere in the stroke",
    quantity="least share of kinetic energy in the plane, nine postures",
    order=SEGMENT_ORDER,
    differs=FORMULAS,
)
def _second_mode_planar(context: Context, reading: ModelOptions) -> Measurement:
    shares = [found.kinetic["z"][1] for found in _over_the_stroke(context, reading)]
    return Measurement(100.0 * (1.0 - max(shares)), reference=100.0, exact=True)


@statements.says(
    "refined.second-mode-leg1",
    "§3.2, Fig. 11b",
    "Rigid segments: the second mode is due to the bending of leg 1 (eq. 25 as printed)",
    sentence="Rigid segments: the second mode is due to the bending of leg 1",
    quantity="rank of that bending among the parts' strain energies",
    tolerance=Absolute(0.5),
    tolerance_reason="a rank is a whole number",
    order=LITERAL_ORDER,
    judged=AS_PRINTED,
    differs=FORMULAS,
    figure="mechanism.strain-energy",
)
def _second_mode_bends_leg1(context: Context, reading: ModelOptions) -> Measurement:
    both = (replace(of, elements=reading.elements) for of in (AS_PRINTED, AS_CORRECTED))
    found = [_at_the_centre(context, of, 2) for of in both]
    printed, exact = ({part: s[1] for part, s in of.strain.items()} for of in found)
    judged = printed if reading.release == "printed" else exact
    rank = 1 + sum(share > judged[_BENDING] for share in judged.values())
    feet = float(found[1].in_the_feet[1])
    return Measurement(
        float(rank),
        reference=1.0,
        exact=True,
        notes=(
            "With eq. (25) as printed bending z of leg 1 holds "
            f"{100.0 * printed[_BENDING]:.0f} % of the strain energy. With joints that "
            f"turn freely it holds {100.0 * exact[_BENDING]:.0f} % and the feet "
            f"{100.0 * feet:.0f} %: the second mode is then a planar motion on the feet.",
        ),
        table={
            "part": tuple(map(str, exact)),
            "eq. (25) as printed (%)": tuple(100.0 * printed.get(part, np.nan) for part in exact),
            "free joints (%)": tuple(100.0 * share for share in exact.values()),
        },
    )


@statements.says(
    "refined.leg1-beam",
    "§3.2",
    "The equivalent beam of leg 1 has its first natural frequency at about 180 Hz",
    quantity="first bending frequency along z, clamped-free, exact Timoshenko beam",
    unit="Hz",
    tolerance=Absolute(5.0),
    tolerance_reason="half a unit in the last printed digit that counts (tens)",
)
def _leg1_beam(context: Context) -> Measurement:
    note = (
        "That is bending y, deflection along z. Bending z of the same beam has its first "
        f"frequency at {_first_of_leg1(context, 'z'):.1f} Hz."
    )
    return Measurement(_first_of_leg1(context), reference=180.0, exact=True, notes=(note,))


@statements.says(
    "refined.twenty-elements",
    "§3.2",
    "With 20 elements the segments miss the beam's first frequency by less than 1 %",
    quantity="first bending frequency of leg 1, half-length springs at the ends",
    unit="Hz",
    tolerance=Relative(0.01),
    tolerance_reason="the statement itself",
    order=SEGMENT_ORDER,
    differs="layout of the springs (§3.2)",
)
def _twenty_elements(context: Context, reading: ModelOptions) -> Measurement:
    exact, found = _first_of_leg1(context), []
    for layout in (reading.layout, AS_PRINTED.layout):
        options = ModelOptions(layout=layout, elements=reading.elements)
        both = leg_frequencies("segments", _leg1(context), 2, options)
        found.append(float(both[np.argmin(np.abs(both - exact))]))
    nearest, as_printed = found
    note = (
        "It takes springs of half length at both ends. With springs between the elements alone, as "
        "the text reads, a length L/20 of the leg stays rigid and the error is "
        f"{100.0 * (as_printed / exact - 1.0):+.1f} %."
    )
    return Measurement(nearest, reference=exact, exact=True, notes=(note,))


@statements.says(
    "refined.order-of-magnitude",
    "§3.2, Fig. 10",
    "The robot's first two frequencies are of the order of that of leg 1 alone",
    curves={"first": {"mode": 0}, "second": {"mode": 1}},
    quantity="log₁₀ of the first frequency over that of leg 1, worst of nine postures",
    tolerance=Absolute(0.5),
    tolerance_reason="one order of magnitude reaches a factor of √10 to either side",
    order=SEGMENT_ORDER,
    differs=FORMULAS,
    figure="frequency.stroke",
)
def _order_of_magnitude(context: Context, reading: ModelOptions, mode: int = 0) -> Measurement:
    found = [one.frequencies[mode] for one in _over_the_stroke(context, reading)]
    apart = np.log10(np.array(found) / _first_of_leg1(context))
    worst = int(np.argmax(np.abs(apart)))
    return Measurement(float(apart[worst]), reference=0.0, exact=True)


@statements.says(
    "refined.actuators-alone",
    "§3.2",
    "None of the first 60 modes is due to the actuators alone",
    quantity="modes with more than 95 % of the strain energy in the feet (beam model, centre)",
    tolerance=Absolute(0.5),
    tolerance_reason="a count is a whole number",
    group="paper.sixty",
    order=BEAM_ORDER,
    effort=1.0,
    figure="mechanism.strain-energy",
)
def _actuators_alone(context: Context, reading: ModelOptions) -> Measurement:
    of_beams = ModelOptions(elements=reading.elements)
    feet = _at_the_centre(context, of_beams, _SIXTY, "beam").in_the_feet
    largest = int(np.argmax(feet))
    most = f"{100.0 * feet[largest]:.0f} %"
    most_printed = 100.0 * float(_at_the_centre(context, AS_PRINTED, _SIXTY).in_the_feet.max())
    note = (
        f"The largest share of the feet, which stand for the actuators, is {most} in mode "
        f"{largest + 1}. The statement thus hangs on 'only': it holds for every share above {most} "
        f"and fails for every one below, and mode {largest + 1} is the one that §3.2 puts down to "
        "the bending of leg 1. With eq. (25) as printed no mode has more than "
        f"{most_printed:.0f} % in the feet."
    )
    return Measurement(float(np.sum(feet > _ALONE)), reference=0.0, exact=True, notes=(note,))
