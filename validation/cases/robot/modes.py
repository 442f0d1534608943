"""Modes of the robot with solid legs, paired by shape with those of beams and segments.

Beams of the sections' own constants are held against solids whose ends are free to warp: what sets
them apart is beam theory in dynamics, which waves along the legs tell by themselves. Solids with
rigid faces are CalculiX's business; here their shapes stand beside those of segments, which the
paper computes with.
"""

from collections.abc import Sequence

import numpy as np

from fem.reduction.superelement import Superelement
from lumped.arrays import Array
from lumped.biglide import Biglide, with_equivalent_legs
from lumped.biglide import postures as biglide_postures
from lumped.legs import equivalent_leg
from validation.agreement.convergence import step_factor
from validation.agreement.mode_pairing import CLOSE
from validation.case import Absolute, Allowance, Measurement, Relative, Skip, others
from validation.case_group import CaseGroup, numbered
from validation.cases.robot.mode_tables import frequency_study, mac_table
from validation.cases.robot.stroke import at_stations, largest_difference
from validation.context import Context
from validation.exhibits import SOLID_ROBOT
from validation.models.legs import constant_leg_of
from validation.solids.legs import FORMAL_ORDER
from validation.solids.robots import SHARED_SOLIDS
from validation.solids.size import skip_too_large
from validation.studies.leg_waves import NO_WAVES, WAVES, WAVES_SOURCE, wave_changes, waves_of
from validation.studies.paired_robot_modes import (
    ELEMENTS,
    OFFERED,
    PAIRED,
    BoolArray,
    LegDivisions,
    PairedModes,
    divisions_of,
    model_modes,
    own_beam,
    own_beam_modes,
    paired,
    solid_modes,
)
from validation.studies.stroke_statics import POSTURES
from validation.studies.torsion import torsion_effects, wave_error

FREQUENCIES = 4
# Relative tolerance of frequencies, absolute one of MAC.
_DYNAMICS, _SHAPE = 0.01, 0.01
_OWN = "20 Timoshenko beam elements per leg, constants of the solids' own section meshes"

cases = CaseGroup(
    unit="1",
    reference_kind="independent-solver",
    citation=_OWN,
    tolerance=Absolute(_SHAPE),
    model="solid",
    section=SOLID_ROBOT,
    group=SHARED_SOLIDS,
    effort=3.0,
)
_BELOW = (
    f"above the first {OFFERED} modes of the solids: among these are some that beams do not have, "
    "of walls that move by themselves"
)
_SMALLEST = "smallest MAC outside mode crossings"
_ONE_MODE = "0.99 is the project's measure of one and the same mode"
_SPACES = "smallest squared cosine of the largest angle between the spaces"
_ONE_SPACE = "the same measure as for single modes, cos² of an angle"


def _meshes(context: Context) -> tuple[LegDivisions, LegDivisions]:
    """Coarser and finer divisions of both legs; raises Skip where these are too slender."""
    legs = [constant_leg_of(context, number) for number in (1, 2)]
    coarse, fine = divisions_of(legs, context.preset)
    skip_too_large(legs, fine, context.preset)
    return coarse, fine


def _segments_and_solids(context: Context) -> PairedModes:
    robot, (_, divisions) = context.robot, _meshes(context)
    return paired(
        robot,
        context.get(model_modes, robot, "segments", "timoshenko", ELEMENTS, POSTURES),
        context.get(solid_modes, robot, divisions, "rigid", POSTURES),
    )


def _own_beams_and(context: Context, divisions: LegDivisions) -> PairedModes:
    robot = context.robot
    return paired(
        robot,
        context.get(own_beam_modes, robot, divisions, POSTURES),
        context.get(solid_modes, robot, divisions, "free", POSTURES),
    )


def _step_factor(context: Context) -> float:
    """Uncertainty over the step between the meshes, of the leg that is refined by less."""
    coarse, fine = _meshes(context)
    return max(step_factor(f / c, FORMAL_ORDER) for c, f in zip(coarse, fine, strict=True))


@cases.case(
    "robot.solid.frequency[{mode}]",
    "Frequency {mode} of the robot with solid legs, ends free to warp, is that of beams",
    over={"index, mode": numbered(FREQUENCIES)},
    quantity="natural frequency {mode}, middle of the stroke, paired by shape",
    headlines=("robot.frequencies.solid",),
    unit="Hz",
    tolerance=Relative(_DYNAMICS),
    tolerance_reason="Timoshenko's theory is approximate in dynamics; what waves of 3-D "
    "elasticity say of that is allowed for, and leaves a few tenths of it",
)
def _frequency(context: Context, index: int) -> Measurement:
    coarse, fine = _meshes(context)
    changes, coarse_changes = (context.get(_by_waves, context.robot, d) for d in (fine, coarse))
    held = _held_to_beams(context, [index])[:, 0] & np.isfinite(changes[:, index])
    if not held.any():
        raise Skip(NO_WAVES)
    held &= _own_beams_and(context, fine).reached[:, index]
    if not held.any():
        raise Skip(f"mode {index + 1} of beams left out, {_BELOW}")
    (value, reference), (coarse_value, coarse_reference) = (
        _free_and_own(context, divisions) for divisions in (fine, coarse)
    )
    allowed = changes * reference[:, : changes.shape[1]]
    factor = _step_factor(context)
    segments = _segments_and_solids(context)
    # Of the postures where it is held, the one in the middle of the stroke or nearest to it.
    (postures,) = np.nonzero(held)
    own = int(np.argmin(np.abs(postures - POSTURES // 2)))
    at = int(postures[own]), index
    # Constants, waves and solid have the errors of one section mesh in common.
    left = (value - reference)[:, index] - allowed[:, index]
    coarse_left = (coarse_value - coarse_reference * (1.0 + np.nan_to_num(coarse_changes)))[
        :, index
    ]
    judged = factor * np.abs(left - coarse_left)
    stations = segments.x[postures].tolist()
    frequencies = value[postures, index], reference[postures, index]
    return Measurement(
        float(value[at]),
        float(reference[at]),
        value_uncertainty=float(factor * abs(value[at] - coarse_value[at])),
        reference_uncertainty=float(factor * abs(reference[at] - coarse_reference[at])),
        judged_uncertainty=float(judged[at[0]]),
        allowances=(Allowance(WAVES, float(allowed[at]), WAVES_SOURCE),),
        pose=(stations[own],),
        elsewhere=others(
            at_stations(stations), *frequencies, judged[postures], own, allowed[postures, index]
        ),
        notes=(largest_difference(stations, *frequencies), *_paper_beside(segments, at)),
        studies=(frequency_study(segments, FREQUENCIES),),
    )


def _paper_beside(segments: PairedModes, at: tuple[int, int]) -> tuple[str, ...]:
    if not segments.reached[at]:
        return ()
    return (
        f"at x = {segments.x[at[0]]:.4g} m segments have {segments.reference[at]:.5g} Hz, solids "
        f"with rigid faces {segments.found[at]:.5g} Hz",
    )


def _by_waves(robot: Biglide, divisions: LegDivisions) -> Array:
    """Relative changes (p×k) of the first frequencies of beams by the waves in the legs."""
    member = with_equivalent_legs(robot)
    legs = {"leg1": equivalent_leg(member.leg1), "leg2": equivalent_leg(member.leg2)}
    numbers = dict(zip(legs, divisions, strict=True))
    beams = {name: own_beam(leg, numbers[name]) for name, leg in legs.items()}
    postures = biglide_postures(member, member.stations(POSTURES))
    whole = {name: Superelement(beam, np.eye(beam.size)) for name, beam in beams.items()}
    return wave_changes(
        postures,
        whole,
        beams,
        waves_of(legs, numbers),
        elements=ELEMENTS,
        offered=OFFERED,
        count=PAIRED,
    )


def _free_and_own(context: Context, divisions: LegDivisions) -> tuple[Array, Array]:
    """Frequencies (Hz, p×k) of solids with free ends and of beams of their section meshes.

    Both in the order of the beams.
    """
    found = _own_beams_and(context, divisions)
    return found.found, found.reference


def _held_to_beams(context: Context, modes: Sequence[int]) -> BoolArray:
    """For which of `modes` (k) and postures Saint-Venant's torsion is meant to hold (p×k).

    Raises Skip where for none: how legs warp, and how their walls bend, along their length changes
    modes, or mixes them with others, by more than beams may leave out.
    """
    robot, (_, fine) = context.robot, _meshes(context)
    beams = context.get(own_beam_modes, robot, fine, POSTURES)
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


@cases.case(
    "robot.solid.free.mac",
    f"The first {PAIRED} modes of the robot with solid legs, ends free to warp, are those of beams",
    quantity=_SMALLEST,
    tolerance_reason=_ONE_MODE,
)
def _mac(context: Context) -> Measurement:
    coarse, found, held = _beside(context)
    step = _step_factor(context) * np.abs(found.mac - coarse.mac)
    return _smallest_mac(found, held, step)


def _beside(context: Context) -> tuple[PairedModes, PairedModes, BoolArray]:
    """Solids on coarser and finer meshes, and which of their modes are held to beams.

    Those that torsion leaves as they are.
    """
    held = _held_to_beams(context, range(PAIRED))
    coarse, found = (_own_beams_and(context, divisions) for divisions in _meshes(context))
    return coarse, found, held


def _smallest_mac(found: PairedModes, held: BoolArray, uncertainty: Array) -> Measurement:
    """The least MAC of a mode that is held and has no close neighbour (all p×k)."""
    left_out = _left_out(found, held)
    alone = held & found.reached & ~found.close
    if not alone.any():
        raise Skip("; ".join(("no mode that is compared stands alone at any posture", *left_out)))
    single = np.where(alone, found.mac, np.inf)
    posture, mode = np.unravel_index(int(np.argmin(single)), single.shape)
    crossings = tuple(
        f"crossing: mode {int(k) + 1} at x = {found.x[p]:.4g} m has a neighbour within "
        f"{100.0 * CLOSE:g} % (MAC {found.mac[p, k]:.4f} alone, {found.shared[p, k]:.4f} as a "
        "space)"
        for p, k in np.argwhere(found.close & found.reached)
    )
    swapped = int(np.sum((found.partner != np.arange(PAIRED)) & found.reached))
    return Measurement(
        float(single[posture, mode]),
        1.0,
        value_uncertainty=float(uncertainty[posture, mode]),
        notes=(
            f"mode {int(mode) + 1} at x = {found.x[posture]:.4g} m",
            f"{swapped} modes have another number in the solid robot",
            *left_out,
            *crossings,
        ),
        table=mac_table(found, "beams"),
    )


def _left_out(found: PairedModes, held: BoolArray) -> tuple[str, ...]:
    reasons = (
        (~held, "which torsional waves of the legs, beyond Saint-Venant's, would change"),
        (held & ~found.reached, _BELOW),
    )
    return tuple(
        f"{int(np.sum(left))} of {held.size} modes left out, {why}"
        for left, why in reasons
        if left.any()
    )


@cases.case(
    "robot.solid.free.mac-of-close-modes",
    f"Modes closer than {100.0 * CLOSE:g} % span the same space in both (free ends, beams)",
    quantity=_SPACES,
    tolerance_reason=_ONE_SPACE,
)
def _close_modes(context: Context) -> Measurement:
    coarse, found, held = _beside(context)
    step = _step_factor(context) * np.abs(found.shared - coarse.shared)
    return smallest_shared(found, held, step)


def smallest_shared(found: PairedModes, held: BoolArray, uncertainty: Array) -> Measurement:
    """The least shared of the spaces of close modes that are held; Skip where there are none.

    `held` and the `uncertainty` of what is shared are p×k.
    """
    left_out = _left_out(found, held)
    close = held & found.reached & found.close
    if not close.any():
        raise Skip("; ".join(("no two modes are close at any posture", *left_out)))
    spaces = np.where(close, found.shared, np.inf)
    posture, mode = np.unravel_index(int(np.argmin(spaces)), spaces.shape)
    where = f"mode {int(mode) + 1} and its neighbours at x = {found.x[posture]:.4g} m"
    return Measurement(
        float(spaces[posture, mode]),
        1.0,
        value_uncertainty=float(uncertainty[posture, mode]),
        notes=(where, *left_out),
    )
