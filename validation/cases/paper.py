"""The paper's statements about stiffness and frequencies, one case each.

S. Briot, A. Pashkevich, D. Chablat, "On the optimal design of parallel robots taking into account
their deformations and natural frequencies". They hold for the IFW demonstrator alone.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import spearmanr

from fem.beam_theory import bending_frequencies
from lumped.arrays import Array
from lumped.legs import equivalent_leg
from validation.case import Absolute, Case, Measurement, Relation, Relative, Skip, Tolerance
from validation.context import Context
from validation.models import ModelName, ModelOptions, leg_frequencies
from validation.quantities import (
    Deflections,
    RobotModes,
    family_deflections,
    family_frequencies,
    robot_modes,
    stroke_deflections,
    stroke_frequencies,
)

POSTURES = 81
ALPHAS = tuple(np.linspace(1.0, 2.0, 11).tolist())
# Where Figs 6, 12 and 13 are drawn, as a fraction of the stroke.
FIGURE_POINTS = {"centre": 0.5, "left": 0.0, "right": 1.0}
EQUIVALENT = ModelOptions(legs="equivalent")
SECTION = "The paper's statements"


@dataclass(frozen=True)
class _Statement:
    """What the paper says, in our words, and how it is measured."""

    id: str
    where: str
    says: str
    quantity: str
    unit: str
    tolerance: Tolerance
    reason: str
    compute: Callable[[Context], Measurement]
    relation: Relation = Relation.EQUAL
    group: str = "paper"
    effort: float = 0.2


def cases() -> tuple[Case, ...]:
    """One case for each statement."""
    return tuple(
        Case(
            id=f"paper.{s.id}",
            title=s.says,
            quantity=s.quantity,
            unit=s.unit,
            reference_kind="paper-statement",
            citation=f"Briot, Pashkevich, Chablat, {s.where}",
            tolerance=s.tolerance,
            tolerance_reason=s.reason,
            compute=s.compute,
            relation=s.relation,
            section=SECTION,
            group=s.group,
            effort=s.effort,
        )
        for s in (*_STATICS, *_FREQUENCIES, *_FAMILY)
    )


def _simplified(context: Context) -> Deflections:
    return context.get(stroke_deflections, "simplified", context.robot, POSTURES)


def _refined(context: Context) -> Deflections:
    return context.get(stroke_deflections, "vjm", context.robot, POSTURES)


def _largest_simplified(context: Context) -> Measurement:
    return Measurement(_simplified(context).largest_planar, reference=1.1)


def _x_at_the_ends(context: Context) -> Measurement:
    planar = _simplified(context).planar_x
    return Measurement(max(planar[0], planar[-1]), reference=0.0)


def _y_largest_at_the_ends(context: Context) -> Measurement:
    planar = _simplified(context).planar_y
    half = POSTURES // 2
    left = int(np.argmax(planar[: half + 1]))
    right = half - int(np.argmax(planar[half:]))
    return Measurement(100.0 * max(left, right) / (POSTURES - 1), reference=0.0)


def _simplified_frequency(context: Context) -> Measurement:
    first = context.get(stroke_frequencies, "simplified", context.robot, POSTURES, 1)
    return Measurement(float(first.min()), reference=710.0)


def _refined_over_simplified(context: Context) -> Measurement:
    ratio = _refined(context).largest_planar / _simplified(context).largest_planar
    return Measurement(ratio, reference=10.0)


def _z_over_planar(context: Context) -> Measurement:
    refined = _refined(context)
    return Measurement(float(refined.along_z.max()) / refined.largest_planar, reference=3.0)


def _profile(curve: str, extremum: Callable[[Array], np.intp]) -> Callable[[Context], Measurement]:
    def compute(context: Context) -> Measurement:
        place = [
            100.0 * int(extremum(getattr(deflections, curve))) / (POSTURES - 1)
            for deflections in (_refined(context), _simplified(context))
        ]
        return Measurement(value=place[0], reference=place[1])

    return compute


def _foot_stiffness(context: Context) -> Measurement:
    foot = context.robot.foot_compliance
    if foot is None:
        raise Skip("the robot has rigid feet")
    return Measurement(float(np.linalg.inv(foot)[1, 1]) / 1e9, reference=1.0)


_STATICS = (
    _Statement(
        "foot-stiffness",
        "§2.1",
        "The feet's stiffness along y is about 1e9 N/m",
        "(k_Foot⁻¹)₂₂ of the corrected matrix",
        "GN/m",
        Absolute(0.1),
        "half a unit in the second digit that 'about' leaves open",
        _foot_stiffness,
    ),
    _Statement(
        "simplified.largest-deflection",
        "§2.1, Fig. 3",
        "Simplified model: planar deflections stay below 1.1 µm at 1000 N",
        "largest planar deflection over the stroke",
        "µm",
        Absolute(0.05),
        "half a unit in the last printed digit",
        _largest_simplified,
        Relation.AT_MOST,
    ),
    _Statement(
        "simplified.x-zero-at-ends",
        "§2.1, Fig. 3",
        "Simplified model: a force along x deflects nothing at both ends of the stroke",
        "larger of the two deflections",
        "µm",
        Absolute(1e-6),
        "a millionth of the largest deflection: s = √(L² − x²) amplifies rounding to 1e-8",
        _x_at_the_ends,
    ),
    _Statement(
        "simplified.y-largest-at-ends",
        "§2.1, Fig. 3",
        "Simplified model: a force along y deflects most at the ends of the stroke",
        "distance of the maximum of each half from its end, of the stroke",
        "%",
        Absolute(100.0 / (POSTURES - 1)),
        f"one of the {POSTURES - 1} steps of the stroke",
        _y_largest_at_the_ends,
    ),
    _Statement(
        "refined.planar-ratio",
        "§2.2, Figs 3 and 5",
        "Virtual joints: planar deflections are about 10 times those of the simplified model",
        "ratio of the largest planar deflections",
        "1",
        Absolute(2.9),
        "'about 10' on a scale of 5, 10, 20 covers 7.1 to 14: 10 − 10/√2 below it",
        _refined_over_simplified,
    ),
    _Statement(
        "refined.z-ratio",
        "§2.2, Fig. 5",
        "Virtual joints: deflections along z are 3 times larger than planar ones",
        "ratio of the largest deflections",
        "1",
        Absolute(0.5),
        "half a unit in the printed digit",
        _z_over_planar,
    ),
    _Statement(
        "refined.profile-x",
        "§2.2, Figs 3 and 5",
        "Virtual joints keep the simplified curve's profile: the peak under a force along x",
        "place of the peak, of the stroke",
        "%",
        Absolute(10.0),
        "a tenth of the stroke: further apart, two curves of one hump look different",
        _profile("planar_x", np.argmax),
    ),
    _Statement(
        "refined.profile-y",
        "§2.2, Figs 3 and 5",
        "Virtual joints keep the simplified curve's profile: the trough under a force along y",
        "place of the trough, of the stroke",
        "%",
        Absolute(15.0),
        "the trough is flat: its place is softer than a peak's, 15 % of the stroke",
        _profile("planar_y", np.argmin),
    ),
)


def _modes(context: Context, release: str, count: int) -> RobotModes:
    options = ModelOptions(release=release)  # type: ignore[arg-type]
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


_FREQUENCIES = (
    _Statement(
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
    _Statement(
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
    _Statement(
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
    _Statement(
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
    _Statement(
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
    _Statement(
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
    _Statement(
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


def _trend(curve: Array) -> float:
    """Spearman's rank correlation with α: +1 rises throughout, −1 falls throughout."""
    return float(spearmanr(ALPHAS, curve).statistic)


def _family(context: Context, model: ModelName, point: str) -> Deflections:
    fraction = FIGURE_POINTS[point]
    return context.get(
        family_deflections,
        model,
        context.robot,
        ALPHAS,
        fraction,
        EQUIVALENT,
    )


def _family_first(context: Context, model: ModelName, point: str) -> Array:
    fraction = FIGURE_POINTS[point]
    frequencies = context.get(
        family_frequencies,
        model,
        context.robot,
        ALPHAS,
        fraction,
        1,
    )
    return frequencies[:, 0]


def _planar_falls(context: Context) -> Measurement:
    found = {point: _family(context, "vjm", point).planar_x for point in FIGURE_POINTS}
    return Measurement(
        _trend(found["centre"]),
        reference=-1.0,
        notes=(
            "At the ends of the stroke, where one leg carries the force along its axis, the "
            f"deflection is small and grows with the leg: {found['left'][0]:.2f} to "
            f"{found['left'][-1]:.2f} µm on the left, {found['right'][0]:.2f} to "
            f"{found['right'][-1]:.2f} µm on the right.",
        ),
        table={"α": ALPHAS}
        | {f"{point} (µm)": tuple(curve.tolist()) for point, curve in found.items()},
    )


def _z_rises(point: str) -> Callable[[Context], Measurement]:
    def compute(context: Context) -> Measurement:
        return Measurement(_trend(_family(context, "vjm", point).along_z), reference=1.0)

    return compute


def _simplified_rises(context: Context) -> Measurement:
    found = {point: _family_first(context, "simplified", point) for point in FIGURE_POINTS}
    return Measurement(
        _trend(found["centre"]),
        reference=1.0,
        notes=(
            "At both ends of the stroke the simplified first frequency does not depend on α: "
            f"{found['left'][0]:.1f} Hz throughout.",
        ),
    )


def _refined_falls(point: str) -> Callable[[Context], Measurement]:
    def compute(context: Context) -> Measurement:
        return Measurement(_trend(_family_first(context, "segments", point)), reference=-1.0)

    return compute


def _trends() -> tuple[_Statement, ...]:
    quantity = "rank correlation with α from 1 to 2"
    reason = "±1 means throughout; one exchanged pair among eleven members changes it by 0.01"
    tolerance = Absolute(0.005)
    single = [
        (
            "family.planar-falls",
            "§2.3, Fig. 6a",
            "Longer legs: smaller planar deflection under a force along x, at the centre",
            _planar_falls,
        ),
        (
            "family.simplified-rises",
            "§3.3, Fig. 12a",
            "Simplified model: longer legs, higher first frequency, at the centre",
            _simplified_rises,
        ),
    ]
    per_point = [
        (
            f"family.z-rises[{point}]",
            f"§2.3, Fig. 6 ({point})",
            f"Longer legs: larger deflection along z ({point})",
            _z_rises(point),
        )
        for point in FIGURE_POINTS
    ] + [
        (
            f"family.refined-falls[{point}]",
            f"§3.3, Fig. 13 ({point})",
            f"Rigid segments: longer legs, lower first frequency ({point})",
            _refined_falls(point),
        )
        for point in FIGURE_POINTS
    ]
    return tuple(
        _Statement(
            name, where, says, quantity, "1", tolerance, reason, compute, group="paper.family"
        )
        for name, where, says, compute in (*single, *per_point)
    )


_FAMILY = _trends()
