"""Statements about natural frequencies and modes (paper §3.1 and §3.2)."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fem.beams.beam_theory import bending_frequencies
from lumped.legs import ConstantLeg, equivalent_leg
from lumped.models.segments import segment_leg
from lumped.system.joint_motion import Portion
from validation.case import Absolute, Measurement, Relation, Relative, Sides
from validation.cases.mechanism.quantities import ASSEMBLER, MODEL_CODE
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
from validation.paper.statements.statement import (
    AS_CORRECTED,
    AS_PRINTED,
    FORMULAS,
    SEGMENTS,
    SIMPLIFIED,
    Compute,
    Statement,
    sampled,
)

_BENDING = Portion("leg 1", "bending z")
# Postures at which modes are looked at.
_STATIONS = 9
_SIXTY = 60


def _simplified_frequency(context: Context, _reading: ModelOptions) -> Measurement:
    def lowest(postures: int) -> float:
        places = over_stroke(context.robot_file.mechanism, postures)
        return float(context.get(frequencies, "simplified", places, 1).min())

    return sampled(lowest, reference=710.0)


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


def _first_mode_along_z(context: Context, reading: ModelOptions) -> Measurement:
    shares = [found.kinetic["z"][0] for found in _over_the_stroke(context, reading)]
    return Measurement(100.0 * min(shares), reference=100.0, exact=True)


def _second_mode_planar(context: Context, reading: ModelOptions) -> Measurement:
    shares = [found.kinetic["z"][1] for found in _over_the_stroke(context, reading)]
    return Measurement(100.0 * (1.0 - max(shares)), reference=100.0, exact=True)


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


def _leg1_beam(context: Context, _reading: ModelOptions) -> Measurement:
    leg = _leg1(context)
    bending_z = bending_frequencies(leg.timoshenko, leg.length, "z", 1)
    return Measurement(
        _first_of_leg1(context),
        reference=180.0,
        exact=True,
        notes=(
            "That is bending y, deflection along z. Bending z of the same beam has its first "
            f"frequency at {float(bending_z[0]):.1f} Hz.",
        ),
    )


def _leg1(context: Context) -> ConstantLeg:
    """Leg 1 as its equivalent of constant section."""
    return equivalent_leg(legs(context.robot_file.mechanism)[0])


def _first_of_leg1(context: Context) -> float:
    leg = _leg1(context)
    return float(bending_frequencies(leg.timoshenko, leg.length, "y", 1)[0])


def _twenty_elements(context: Context, reading: ModelOptions) -> Measurement:
    leg, exact = _leg1(context), _first_of_leg1(context)
    nearest, as_printed = (
        float(found[np.argmin(np.abs(found - exact))])
        for found in (
            leg_frequencies(
                "segments", leg, 2, ModelOptions(layout=layout, elements=reading.elements)
            )
            for layout in (reading.layout, AS_PRINTED.layout)
        )
    )
    return Measurement(
        nearest,
        reference=exact,
        exact=True,
        notes=(
            "It takes springs of half length at both ends. With springs between the elements "
            "alone, as the text reads, a length L/20 of the leg stays rigid and the error is "
            f"{100.0 * (as_printed / exact - 1.0):+.1f} %.",
        ),
    )


def _order_of_magnitude(mode: int) -> Compute:
    def compute(context: Context, reading: ModelOptions) -> Measurement:
        found = [one.frequencies[mode] for one in _over_the_stroke(context, reading)]
        apart = np.log10(np.array(found) / _first_of_leg1(context))
        worst = int(np.argmax(np.abs(apart)))
        return Measurement(float(apart[worst]), reference=0.0, exact=True)

    return compute


def _actuators_alone(context: Context, reading: ModelOptions) -> Measurement:
    of_beams = ModelOptions(elements=reading.elements)
    feet = _at_the_centre(context, of_beams, _SIXTY, "beam").in_the_feet
    largest = int(np.argmax(feet))
    largest_printed = float(_at_the_centre(context, AS_PRINTED, _SIXTY).in_the_feet.max())
    return Measurement(
        float(np.sum(feet > _ALONE)),
        reference=0.0,
        exact=True,
        notes=(
            f"The largest share of the feet, which stand for the actuators, is "
            f"{100.0 * feet[largest]:.0f} % in mode {largest + 1}. The statement thus hangs on "
            f"'only': it holds for every share above {100.0 * feet[largest]:.0f} % and fails for "
            f"every one below, and mode {largest + 1} is the one that §3.2 puts down to the "
            "bending of leg 1. With eq. (25) as printed no mode has more than "
            f"{100.0 * largest_printed:.0f} % in the feet.",
        ),
    )


# Share of the strain energy above which a mode is due to a part alone.
_ALONE = 0.95
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
        SIMPLIFIED,
        Relation.AT_LEAST,
        figure="frequency.simplified",
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
        SEGMENTS,
        order=SEGMENT_ORDER,
        effort=1.0,
        differs=FORMULAS,
        figure="frequency.stroke",
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
        SEGMENTS,
        order=SEGMENT_ORDER,
        differs=FORMULAS,
        figure="frequency.stroke",
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
        SEGMENTS,
        order=LITERAL_ORDER,
        sentence="Rigid segments: the second mode is due to the bending of leg 1",
        judged="as printed",
        differs=FORMULAS,
        figure="mechanism.strain-energy",
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
        Sides((bending_frequencies,)),
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
        Sides((segment_leg,), (bending_frequencies,)),
        order=SEGMENT_ORDER,
        differs="layout of the springs (§3.2)",
    ),
    Statement(
        "refined.order-of-magnitude",
        "§3.2, Fig. 10",
        "The robot's first two frequencies are of the order of that of leg 1 alone",
        "log₁₀ of the first frequency over that of leg 1, worst of nine postures",
        "1",
        Absolute(0.5),
        "one order of magnitude reaches a factor of √10 to either side",
        _order_of_magnitude(0),
        Sides(SEGMENTS.value, (bending_frequencies,)),
        order=SEGMENT_ORDER,
        curves={"first": _order_of_magnitude(0), "second": _order_of_magnitude(1)},
        differs=FORMULAS,
        figure="frequency.stroke",
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
        Sides((*MODEL_CODE["beam"], *ASSEMBLER)),
        group="paper.sixty",
        order=BEAM_ORDER,
        effort=1.0,
        figure="mechanism.strain-energy",
    ),
)
