"""Cases on the paper's statements about natural frequencies and modes (§3.1 and §3.2).

Input: the paper's robot in postures over its stroke. Output: a verdict on each statement. Modes are
characterised by shares of their kinetic energy by direction and of their strain energy by part.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fem.beams.beam_theory import Plane, bending_frequencies
from lumped.equivalent_leg import equivalent_leg
from lumped.legs import ConstantLeg
from lumped.system.joint_motion import Portion
from validation.case import Absolute, Measurement, Relation, Relative
from validation.context import Context
from validation.models.leg_models import leg_frequencies
from validation.models.options import (
    BEAM_ORDER,
    LITERAL_ORDER,
    SEGMENT_ORDER,
    ModelName,
    ModelOptions,
)
from validation.paper.robot import (
    ModeShares,
    RobotOnStroke,
    frequencies,
    legs,
    mode_shares,
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
# Number of evenly spaced postures over the stroke at which mode shapes are evaluated.
_MODE_POSTURES = 9
# Number of modes to which the statement on the actuators refers (§3.2).
_SIXTY = 60
# Share of strain energy above which a mode is attributed to one part alone.
_SINGLE_PART = 0.95
statements = Statements(**PAPER)


def _stroke_modes(context: Context, variant: ModelOptions) -> Sequence[ModeShares]:
    """First two modes by segments in nine postures, with options as printed or as corrected."""
    robots = over_stroke(context.robot_file.mechanism, _MODE_POSTURES)
    return context.get(mode_shares, "segments", robots, 2, variant)


def _centre_modes(
    context: Context, options: ModelOptions, count: int, model: ModelName = "segments"
) -> ModeShares:
    mechanism = context.robot_file.mechanism
    robot = RobotOnStroke(mechanism, np.array([stroke_of(mechanism).centre]))
    (modes,) = context.get(mode_shares, model, (robot,), count, options)
    return modes


def _leg1(context: Context) -> ConstantLeg:
    """Leg 1 as its equivalent prism."""
    return equivalent_leg(legs(context.robot_file.mechanism)[0])


def _leg1_first_frequency(context: Context, plane: Plane = "y") -> float:
    """First bending frequency (Hz) of the clamped-free Timoshenko beam equivalent to leg 1."""
    leg = _leg1(context)
    return float(bending_frequencies(leg.timoshenko, leg.length, plane, 1)[0])


@statements.statement(
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
        robots = over_stroke(context.robot_file.mechanism, postures)
        return float(context.get(frequencies, "simplified", robots, 1).min())

    return sampled(lowest, reference=710.0)


direction = statements.family(
    unit="%",
    tolerance=Absolute(5.0),
    tolerance_reason="a mode is named by its direction if 95 % of its motion goes there",
    figure="frequency.stroke",
)


@direction.statement(
    "refined.first-mode-along-z",
    "§3.2, Fig. 11a",
    "Rigid segments: the first mode bends the robot along z, everywhere in the stroke",
    quantity="least share of kinetic energy along z, nine postures",
    order=SEGMENT_ORDER,
    effort=1.0,
    corrections=FORMULAS,
)
def _first_mode_along_z(context: Context, variant: ModelOptions) -> Measurement:
    shares = [modes.kinetic["z"][0] for modes in _stroke_modes(context, variant)]
    return Measurement(100.0 * min(shares), reference=100.0, exact=True)


@direction.statement(
    "refined.second-mode-planar",
    "§3.2, Fig. 11b",
    "Rigid segments: the second mode is planar, everywhere in the stroke",
    quantity="least share of kinetic energy in the plane, nine postures",
    order=SEGMENT_ORDER,
    corrections=FORMULAS,
)
def _second_mode_planar(context: Context, variant: ModelOptions) -> Measurement:
    shares = [modes.kinetic["z"][1] for modes in _stroke_modes(context, variant)]
    return Measurement(100.0 * (1.0 - max(shares)), reference=100.0, exact=True)


@statements.statement(
    "refined.second-mode-leg1",
    "§3.2, Fig. 11b",
    "Rigid segments: the second mode is due to the bending of leg 1 (eq. 25 as printed)",
    sentence="Rigid segments: the second mode is due to the bending of leg 1",
    quantity="rank of bending z of leg 1 among the strain energies of all parts",
    tolerance=Absolute(0.5),
    tolerance_reason="a rank is a whole number",
    order=LITERAL_ORDER,
    reported=AS_PRINTED,
    corrections=FORMULAS,
    figure="mechanism.strain-energy",
)
def _second_mode_bends_leg1(context: Context, variant: ModelOptions) -> Measurement:
    modes_as_printed, modes_as_corrected = (
        _centre_modes(context, replace(options, elements=variant.elements), 2)
        for options in (AS_PRINTED, AS_CORRECTED)
    )
    printed, exact = (
        {part: shares[1] for part, shares in modes.strain.items()}
        for modes in (modes_as_printed, modes_as_corrected)
    )
    ranked = printed if variant.release == "printed" else exact
    rank = 1 + sum(share > ranked[_BENDING] for share in ranked.values())
    feet = float(modes_as_corrected.strain_in_feet[1])
    return Measurement(
        float(rank),
        reference=1.0,
        exact=True,
        notes=(
            "With eq. (25) as printed, bending z of leg 1 has "
            f"{100.0 * printed[_BENDING]:.0f} % of the strain energy. With joints that "
            f"turn freely it has {100.0 * exact[_BENDING]:.0f} % and the feet have "
            f"{100.0 * feet:.0f} %. The second mode is then a planar motion of the robot on its "
            "feet.",
        ),
        table={
            "part": tuple(map(str, exact)),
            "eq. (25) as printed (%)": tuple(100.0 * printed.get(part, np.nan) for part in exact),
            "free joints (%)": tuple(100.0 * share for share in exact.values()),
        },
    )


@statements.statement(
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
        "This is the frequency of bending y, with deflection along z. Bending z of the same beam "
        f"has its first frequency at {_leg1_first_frequency(context, 'z'):.1f} Hz."
    )
    return Measurement(_leg1_first_frequency(context), reference=180.0, exact=True, notes=(note,))


@statements.statement(
    "refined.twenty-elements",
    "§3.2",
    "With 20 elements the segments miss the beam's first frequency by less than 1 %",
    quantity="first bending frequency of leg 1, half-length springs at the ends",
    unit="Hz",
    tolerance=Relative(0.01),
    tolerance_reason="the statement itself",
    order=SEGMENT_ORDER,
    corrections="layout of the springs (§3.2)",
)
def _twenty_elements(context: Context, variant: ModelOptions) -> Measurement:
    exact, nearest = _leg1_first_frequency(context), []
    for layout in (variant.layout, AS_PRINTED.layout):
        options = ModelOptions(layout=layout, elements=variant.elements)
        # The first frequencies of both bending planes. The statement is about that of `exact`.
        first_two = leg_frequencies("segments", _leg1(context), 2, options)
        nearest.append(float(first_two[np.argmin(np.abs(first_two - exact))]))
    value, as_printed = nearest
    note = (
        "This requires springs of half length at both ends. With springs between the elements "
        "only, as printed, a length L/20 of the leg stays rigid and the error is "
        f"{100.0 * (as_printed / exact - 1.0):+.1f} %."
    )
    return Measurement(value, reference=exact, exact=True, notes=(note,))


@statements.statement(
    "refined.order-of-magnitude",
    "§3.2, Fig. 10",
    "The robot's first two frequencies are of the order of that of leg 1 alone",
    curves={"first": {"mode": 0}, "second": {"mode": 1}},
    quantity="log₁₀ of the first frequency over that of leg 1, worst of nine postures",
    tolerance=Absolute(0.5),
    tolerance_reason="one order of magnitude spans a factor of √10 to either side",
    order=SEGMENT_ORDER,
    corrections=FORMULAS,
    figure="frequency.stroke",
)
def _order_of_magnitude(context: Context, variant: ModelOptions, mode: int = 0) -> Measurement:
    robot = np.array([modes.frequencies[mode] for modes in _stroke_modes(context, variant)])
    ratios = np.log10(robot / _leg1_first_frequency(context))
    worst = int(np.argmax(np.abs(ratios)))
    return Measurement(float(ratios[worst]), reference=0.0, exact=True)


@statements.statement(
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
def _actuators_alone(context: Context, variant: ModelOptions) -> Measurement:
    options = ModelOptions(elements=variant.elements)
    shares = _centre_modes(context, options, _SIXTY, "beam").strain_in_feet
    mode = int(np.argmax(shares))
    largest = f"{100.0 * shares[mode]:.0f} %"
    largest_as_printed = float(_centre_modes(context, AS_PRINTED, _SIXTY).strain_in_feet.max())
    note = (
        f"The largest share of the feet, which represent the actuators, is {largest} in mode "
        f"{mode + 1}. Whether the statement holds depends on the share that counts as 'alone': it "
        f"holds for any threshold above {largest} and fails for any below. §3.2 attributes mode "
        f"{mode + 1} to the bending of leg 1. With eq. (25) as printed no mode has more than "
        f"{100.0 * largest_as_printed:.0f} % in the feet."
    )
    above = float(np.sum(shares > _SINGLE_PART))
    return Measurement(above, reference=0.0, exact=True, notes=(note,))
