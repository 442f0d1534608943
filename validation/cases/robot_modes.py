"""Modes of the robot with solid legs, paired by shape with those of segments."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from fem.solid import Ends
from lumped import mechanism
from lumped.arrays import Array, IntArray
from lumped.biglide import Biglide, with_equivalent_legs
from lumped.leg_matrices import LegMatrices
from lumped.legs import equivalent_leg
from lumped.mechanism import Mechanism
from validation.case import Absolute, Allowance, Case, Measurement, Relative
from validation.cases.robot_solid import POSTURES, SECTION
from validation.context import Context, Preset
from validation.exhibits import Study
from validation.mode_pairing import (
    centreline_samples,
    centreline_weights,
    largest_angle,
    pair_modes,
)
from validation.models import highest_frequency, robot_legs
from validation.robot_solids import reduced_solid

FREQUENCIES, PAIRED = 4, 6
# Twice as many modes are offered as partners, so that none is missing where orders differ.
OFFERED = 12
# Divisions of the solids; the next coarser ones give the numerical uncertainty.
DIVISIONS: dict[Preset, int] = {"quick": 2, "standard": 3, "fine": 4}
# Modes of one model closer than this (relative) are compared as a space: the models' difference of
# up to 1 % turns shapes that are 5 % apart by up to a fifth of a radian, 0.96 in MAC.
CLOSE = 0.05
_SEGMENTS = "20 segments per leg, Timoshenko springs, rotary inertia"
_STATIONS = 24


def cases() -> tuple[Case, ...]:
    """Frequencies and shapes against segments over the stroke."""
    return (*_frequencies(), *_shapes())


def _frequencies() -> list[Case]:
    return [
        Case(
            id=f"robot.solid.frequency[{index + 1}]",
            title=f"Frequency {index + 1} of the robot with solid legs is that of segments",
            quantity=f"natural frequency {index + 1}, posture of the largest difference, paired "
            "by shape",
            unit="Hz",
            reference_kind="independent-solver",
            citation=_SEGMENTS,
            tolerance=Relative(0.01),
            tolerance_reason="rigid end faces stiffen torsion (0.8 % of the first frequency), "
            "segments are 0.2 % too soft",
            compute=partial(_frequency, index=index),
            section=SECTION,
            group="robot.solid.modes",
            effort=3.0,
        )
        for index in range(FREQUENCIES)
    ]


def _shapes() -> tuple[Case, Case]:
    return (
        Case(
            id="robot.solid.mac",
            title=f"The first {PAIRED} modes of the solid robot are those of segments",
            quantity="smallest MAC outside mode crossings",
            unit="1",
            reference_kind="independent-solver",
            citation=_SEGMENTS,
            tolerance=Absolute(0.01),
            tolerance_reason="0.99 is the project's measure of one and the same mode",
            compute=_mac,
            section=SECTION,
            group="robot.solid.modes",
            effort=3.0,
        ),
        Case(
            id="robot.solid.mac-of-close-modes",
            title=f"Modes closer than {100.0 * CLOSE:g} % span the same space in both models",
            quantity="smallest squared cosine of the largest angle between the spaces",
            unit="1",
            reference_kind="independent-solver",
            citation=_SEGMENTS,
            tolerance=Absolute(0.01),
            tolerance_reason="the same measure as for single modes, cos² of an angle",
            compute=_close_modes,
            section=SECTION,
            group="robot.solid.modes",
            effort=3.0,
        ),
    )


@dataclass(frozen=True)
class PairedModes:
    """The first modes (k) of segments at p positions `x` (m) with their partners among solids'.

    Frequencies (Hz) `segments` and `solid`, `partner` (number from 0) and `mac`, all p×k. `close`
    tells which modes have a neighbour within `CLOSE`, `shared` is cos² of the largest angle between
    the spaces of a mode and its close neighbours in both models.
    """

    x: Array
    segments: Array
    solid: Array
    partner: IntArray
    mac: Array
    close: Array
    shared: Array


def paired_modes(robot: Biglide, divisions: int, ends: Ends, postures: int) -> PairedModes:
    """Pairing by shape on common section points of both centrelines and the platform."""
    member = with_equivalent_legs(robot)
    x = member.stations(postures)
    highest = max(highest_frequency(member, at, OFFERED) for at in (x[0], member.centre, x[-1]))
    legs1 = robot_legs("segments", member)
    solid1, solid2 = (
        reduced_solid(equivalent_leg(leg), divisions, ends, highest).matrices
        for leg in (member.leg1, member.leg2)
    )
    rows = [_pair(member, at, legs1, (solid1, solid2)) for at in x.tolist()]
    segments, solid, partner, mac, close, shared = (
        np.array(column) for column in zip(*rows, strict=True)
    )
    return PairedModes(x, segments, solid, partner, mac, close, shared)


def _pair(
    robot: Biglide,
    x: float,
    lumped: tuple[LegMatrices, LegMatrices],
    solids: tuple[LegMatrices, LegMatrices],
) -> tuple[Array, Array, IntArray, Array, Array, Array]:
    frequencies, samples = [], []
    for legs in (lumped, solids):
        whole = mechanism.assemble(robot, x, *legs)
        modes = mechanism.modes(whole, OFFERED)
        frequencies.append(modes.frequencies)
        samples.append(_sampled(whole, legs, modes.shapes))
    weights = _weights(robot)
    pairing = pair_modes(samples[0], samples[1], weights)
    close, shared = np.zeros(PAIRED, dtype=bool), pairing.mac[:PAIRED].copy()
    for mode in range(PAIRED):
        family = _neighbours(frequencies[0], mode)
        if len(family) > 1:
            close[mode] = True
            angle = largest_angle(
                samples[0][:, family], samples[1][:, pairing.partner[family]], weights
            )
            shared[mode] = np.cos(angle) ** 2
    partner = pairing.partner[:PAIRED]
    return (
        frequencies[0][:PAIRED],
        frequencies[1][partner],
        partner,
        pairing.mac[:PAIRED],
        close,
        shared,
    )


def _neighbours(frequencies: Array, mode: int) -> IntArray:
    """Modes that follow on each other within `CLOSE`, among them `mode`."""
    apart = np.diff(frequencies) > CLOSE * frequencies[:-1]
    family = np.concatenate([[0], np.cumsum(apart)])
    return np.flatnonzero(family == family[mode])


def _sampled(whole: Mechanism, legs: tuple[LegMatrices, LegMatrices], shapes: Array) -> Array:
    """Displacement of the platform's mass, and twists of both legs' sections (k×m, SI)."""
    rows = [(whole.loaded @ shapes)[:3]]
    for to_leg, leg in zip(whole.legs, legs, strict=True):
        stations, _ = centreline_samples(leg.length, _STATIONS)
        rows.append(leg.centreline(stations) @ (to_leg @ shapes))
    return np.vstack(rows)


def _weights(robot: Biglide) -> Array:
    """Masses (k) of what `_sampled` gives."""
    masses = [np.full(3, robot.platform_mass)]
    for leg in (equivalent_leg(robot.leg1), equivalent_leg(robot.leg2)):
        _, lengths = centreline_samples(leg.length, _STATIONS)
        masses.append(centreline_weights(leg.timoshenko, lengths))
    return np.concatenate(masses)


def _found(context: Context) -> PairedModes:
    return context.get(paired_modes, context.robot, DIVISIONS[context.preset], "rigid", POSTURES)


def _frequency(context: Context, index: int) -> Measurement:
    fine = _found(context)
    coarse = context.get(
        paired_modes, context.robot, DIVISIONS[context.preset] - 1, "rigid", POSTURES
    )
    free = context.get(paired_modes, context.robot, DIVISIONS[context.preset], "free", POSTURES)
    worst = int(np.argmax(np.abs(fine.solid / fine.segments - 1.0)[:, index]))
    return Measurement(
        float(fine.solid[worst, index]),
        float(fine.segments[worst, index]),
        value_uncertainty=float(abs(fine.solid - coarse.solid)[worst, index]),
        allowances=(
            Allowance(
                cause="end faces kept plane and rigid: warping restrained",
                amount=float((fine.solid - free.solid)[worst, index]),
                source="same meshes with ends free to warp (Saint-Venant tractions)",
            ),
        ),
        notes=(f"largest difference at x = {fine.x[worst]:.4g} m",),
        studies=(_frequency_study(fine),),
    )


def _mac(context: Context) -> Measurement:
    found = _found(context)
    single = np.where(found.close, np.inf, found.mac)
    posture, mode = np.unravel_index(int(np.argmin(single)), single.shape)
    crossings = tuple(
        f"crossing: mode {int(k) + 1} at x = {found.x[p]:.4g} m has a neighbour within "
        f"{100.0 * CLOSE:g} % (MAC {found.mac[p, k]:.4f} alone, {found.shared[p, k]:.4f} as a "
        "space)"
        for p, k in np.argwhere(found.close)
    )
    swapped = int(np.sum(found.partner != np.arange(PAIRED)))
    return Measurement(
        float(single[posture, mode]),
        1.0,
        notes=(
            f"mode {int(mode) + 1} at x = {found.x[posture]:.4g} m",
            f"{swapped} modes have another number in the solid robot",
            *crossings,
        ),
        table=_mac_table(found),
        studies=(_mac_study(found),),
    )


def _close_modes(context: Context) -> Measurement:
    found = _found(context)
    if not found.close.any():
        return Measurement(1.0, 1.0, notes=("no two modes are close at any posture",))
    spaces = np.where(found.close, found.shared, np.inf)
    posture, mode = np.unravel_index(int(np.argmin(spaces)), spaces.shape)
    return Measurement(
        float(spaces[posture, mode]),
        1.0,
        notes=(f"mode {int(mode) + 1} and its neighbours at x = {found.x[posture]:.4g} m",),
    )


def _mac_table(found: PairedModes) -> dict[str, tuple[float | str, ...]]:
    pairs = [(p, k) for p in range(len(found.x)) for k in range(PAIRED)]
    return {
        "x (m)": tuple(float(found.x[p]) for p, _ in pairs),
        "mode": tuple(float(k + 1) for _, k in pairs),
        "segments (Hz)": tuple(float(found.segments[pair]) for pair in pairs),
        "partner": tuple(float(found.partner[pair] + 1) for pair in pairs),
        "solid (Hz)": tuple(float(found.solid[pair]) for pair in pairs),
        "MAC": tuple(float(found.mac[pair]) for pair in pairs),
        "crossing": tuple("yes" if found.close[pair] else "" for pair in pairs),
        "MAC as a space": tuple(float(found.shared[pair]) for pair in pairs),
    }


def _mac_study(found: PairedModes) -> Study:
    return Study(
        id="robot.solid.mac",
        kind="sweep",
        title="Shapes of the solid robot and of segments",
        x_label="x (m)",
        y_label="MAC of paired modes",
        unit="1",
        x=tuple(found.x.tolist()),
        series={f"mode {k + 1}": tuple(found.mac[:, k].tolist()) for k in range(PAIRED)},
        notes=("At a crossing two close modes mix: there only the space they span compares.",),
    )


def _frequency_study(found: PairedModes) -> Study:
    return Study(
        id="robot.solid.frequencies",
        kind="sweep",
        title="First frequencies of the solid robot and of segments, paired by shape",
        x_label="x (m)",
        y_label="natural frequency",
        unit="Hz",
        x=tuple(found.x.tolist()),
        series={
            f"{model}, mode {k + 1}": tuple(values[:, k].tolist())
            for k in range(FREQUENCIES)
            for model, values in (("segments", found.segments), ("solid", found.solid))
        },
    )
