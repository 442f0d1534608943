"""Modes of the robot with solid legs, paired by shape with those of segments and beams.

Segments are what the paper computes with. From them to solids lead four steps, each of them a named
cause: 20 rigid segments for a beam, textbook constants for the section's own, beam theory for a
solid whose ends are free to warp, and those ends made rigid. All but the third are taken off by
their own size; the third, beam theory in dynamics, is what a comparison is about.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from lumped.arrays import Array
from validation.case import Absolute, Allowance, Case, Measurement, Relative, Skip
from validation.cases.legs import constant_leg_of
from validation.cases.robot_mode_tables import frequency_study, mac_study, mac_table
from validation.cases.robot_solid import SECTION
from validation.context import Context
from validation.leg_solids import step_factor
from validation.legs_in_torsion import torsion_effects, wave_error
from validation.mode_pairing import CLOSE
from validation.paired_robot_modes import (
    ELEMENTS,
    PAIRED,
    BeamKind,
    BoolArray,
    LegDivisions,
    PairedModes,
    beam_modes,
    divisions_of,
    paired,
    solid_modes,
)
from validation.stroke_statics import POSTURES

FREQUENCIES = 4
_SEGMENTS = "20 segments per leg, Timoshenko springs, rotary inertia"
_OWN = "20 Timoshenko beam elements per leg, constants of the solids' own section meshes"
# Relative tolerance of frequencies.
_DYNAMICS = 0.01
# Absolute tolerance of MAC.
_SHAPE = 0.01

_shape_case = partial(
    Case,
    unit="1",
    reference_kind="independent-solver",
    tolerance=Absolute(_SHAPE),
    model="solid",
    section=SECTION,
    group="robot.solid.modes",
    effort=3.0,
)
_mac_case = partial(
    _shape_case,
    quantity="smallest MAC outside mode crossings",
    tolerance_reason="0.99 is the project's measure of one and the same mode",
)
_spaces_case = partial(
    _shape_case,
    quantity="smallest squared cosine of the largest angle between the spaces",
    tolerance_reason="the same measure as for single modes, cos² of an angle",
)


def cases() -> tuple[Case, ...]:
    """Frequencies against segments, shapes against beams of the sections' own constants."""
    return (
        *_frequencies(),
        _mac_case(
            id="robot.solid.free.mac",
            title=f"The first {PAIRED} modes of the robot with solid legs, ends free to warp, are "
            "those of beams",
            citation=_OWN,
            compute=_mac_of_free,
        ),
        _spaces_case(
            id="robot.solid.free.mac-of-close-modes",
            title=f"Modes closer than {100.0 * CLOSE:g} % span the same space in both (free ends, "
            "beams)",
            citation=_OWN,
            compute=_spaces_of_free,
        ),
    )


def paper_cases() -> tuple[Case, ...]:
    """Shapes of the paper's robot, whose rectangles of ν = 0 leave 1 % between all models."""
    return (
        _mac_case(
            id="robot.solid.mac",
            title=f"The first {PAIRED} modes of the solid robot are those of segments",
            citation=_SEGMENTS,
            compute=_mac,
        ),
        _spaces_case(
            id="robot.solid.mac-of-close-modes",
            title=f"Modes closer than {100.0 * CLOSE:g} % span the same space in both models",
            citation=_SEGMENTS,
            compute=_close_modes,
        ),
    )


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
            tolerance=Relative(_DYNAMICS),
            tolerance_reason="segments, textbook constants and rigid faces are allowed for by "
            "their own effect; what is left is Timoshenko's theory, approximate in dynamics: below "
            "1 % while the wave is longer than three section heights",
            compute=partial(_frequency, index=index),
            model="solid",
            section=SECTION,
            group="robot.solid.modes",
            effort=3.0,
        )
        for index in range(FREQUENCIES)
    ]


def _meshes(context: Context) -> tuple[LegDivisions, LegDivisions]:
    return divisions_of([constant_leg_of(context, number) for number in (1, 2)], context.preset)


def _segments_and_solids(context: Context) -> PairedModes:
    robot, (_, fine) = context.robot, _meshes(context)
    return paired(
        robot,
        context.get(beam_modes, robot, "segments", fine, POSTURES),
        context.get(solid_modes, robot, fine, "rigid", POSTURES),
    )


def _own_beams_and_solids(context: Context) -> PairedModes:
    robot, (_, fine) = context.robot, _meshes(context)
    return paired(
        robot,
        context.get(beam_modes, robot, "own beam", fine, POSTURES),
        context.get(solid_modes, robot, fine, "free", POSTURES),
    )


def _beyond_beams(context: Context, divisions: LegDivisions) -> tuple[Array, Array, Array]:
    """Frequencies (Hz, p×k) of solids with free ends, own beams, and textbook beams.

    All as partners of the segments' modes.
    """
    robot = context.robot
    segments = context.get(beam_modes, robot, "segments", divisions, POSTURES)
    free, own, textbook = (
        paired(robot, segments, other).found
        for other in (
            context.get(solid_modes, robot, divisions, "free", POSTURES),
            context.get(beam_modes, robot, "own beam", divisions, POSTURES),
            context.get(beam_modes, robot, "beam", divisions, POSTURES),
        )
    )
    return free, own, textbook


def _frequency(context: Context, index: int) -> Measurement:
    held = _held_to_beams(context, "segments", [index])[:, 0]
    coarse, fine = _meshes(context)
    paired = _segments_and_solids(context)
    free, own, textbook = _beyond_beams(context, fine)
    coarse_free, coarse_own, _ = _beyond_beams(context, coarse)
    left = (free - own) / paired.reference
    # Constants and solid have the errors of one section mesh in common.
    step = np.abs(left - (coarse_free - coarse_own) / paired.reference)[:, index]
    factor = max(step_factor(f / c) for c, f in zip(coarse, fine, strict=True))
    worst = int(np.argmax(np.where(held, np.abs(left[:, index]), -1.0)))
    at = worst, index
    return Measurement(
        float(paired.found[at]),
        float(paired.reference[at]),
        value_uncertainty=float(factor * step[worst] * paired.reference[at]),
        allowances=(
            Allowance(
                cause="rigid segments for a beam, second order in 1/n",
                amount=float((textbook - paired.reference)[at]),
                source=f"{ELEMENTS} Timoshenko beam elements instead, same constants",
            ),
            Allowance(
                cause="textbook section constants (thin walls, Cowper's shear)",
                amount=float((own - textbook)[at]),
                source="fem.sections.section_constants on the solids' section meshes",
            ),
            Allowance(
                cause="end faces kept plane and rigid: warping and contraction restrained",
                amount=float((paired.found - free)[at]),
                source="same meshes with ends free to warp (Saint-Venant tractions)",
            ),
        ),
        notes=(f"largest difference at x = {paired.x[worst]:.4g} m",),
        studies=(frequency_study(paired, FREQUENCIES),),
    )


def _held_to_beams(context: Context, kind: BeamKind, modes: Sequence[int]) -> BoolArray:
    """For which of `modes` (k) and postures Saint-Venant's torsion is meant to hold (p×k).

    Raises Skip where for none: how legs warp, and how their walls bend, along their length changes
    modes, or mixes them with others, by more than beams may leave out.
    """
    robot, (_, fine) = context.robot, _meshes(context)
    beams = context.get(beam_modes, robot, kind, fine, POSTURES)
    highest = float(beams.frequencies[:, modes].max())
    legs = [constant_leg_of(context, number) for number in (1, 2)]
    errors = [context.get(wave_error, leg, highest) for leg in legs]
    effects = context.get(torsion_effects, robot, beams, np.array(errors))
    frequency, mac = effects.frequency[:, modes], effects.mac[:, modes]
    held: BoolArray = (frequency <= 0.5 * _DYNAMICS) & (mac >= 1.0 - 0.5 * _SHAPE)
    if not held.any():
        raise Skip(
            "beams leave out how legs warp and their walls bend along torsional waves: "
            f"{100.0 * errors[0]:+.3g} % of the torsional stiffness of leg 1 and "
            f"{100.0 * errors[1]:+.3g} % of leg 2, up to {100.0 * frequency.max():.3g} % of a "
            f"frequency, MAC of a mode with itself {mac.min():.3f}"
        )
    return held


def _mac(context: Context) -> Measurement:
    found = _segments_and_solids(context)
    return _smallest_mac(found, "segments", np.ones_like(found.close))


def _mac_of_free(context: Context) -> Measurement:
    held = _held_to_beams(context, "own beam", range(PAIRED))
    return _smallest_mac(_own_beams_and_solids(context), "beams", held)


def _smallest_mac(found: PairedModes, reference: str, held: BoolArray) -> Measurement:
    alone = held & ~found.close
    if not alone.any():
        raise Skip(
            "; ".join(("all modes have close neighbours at every posture", *_left_out(held)))
        )
    single = np.where(alone, found.mac, np.inf)
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
            *_left_out(held),
            *crossings,
        ),
        table=mac_table(found, reference),
        studies=(mac_study(found, reference),) if reference == "segments" else (),
    )


def _left_out(held: BoolArray) -> tuple[str, ...]:
    count = int(np.sum(~held))
    why = "which torsional waves of the legs, beyond Saint-Venant's, would change"
    return (f"{count} of {held.size} modes left out, {why}",) if count else ()


def _close_modes(context: Context) -> Measurement:
    found = _segments_and_solids(context)
    return smallest_shared(found, np.ones_like(found.close))


def _spaces_of_free(context: Context) -> Measurement:
    held = _held_to_beams(context, "own beam", range(PAIRED))
    return smallest_shared(_own_beams_and_solids(context), held)


def smallest_shared(found: PairedModes, held: BoolArray) -> Measurement:
    """The least shared of the spaces of close modes that are held; Skip where there are none."""
    close = held & found.close
    if not close.any():
        raise Skip("; ".join(("no two modes are close at any posture", *_left_out(held))))
    spaces = np.where(close, found.shared, np.inf)
    posture, mode = np.unravel_index(int(np.argmin(spaces)), spaces.shape)
    where = f"mode {int(mode) + 1} and its neighbours at x = {found.x[posture]:.4g} m"
    return Measurement(float(spaces[posture, mode]), 1.0, notes=(where, *_left_out(held)))
