"""Each leg alone, root clamped: a 3-D solid against beam theory, differences with their causes."""

from collections.abc import Callable, Mapping
from typing import TypeAlias

import numpy as np

from fem.beams.beam_theory import (
    CantileverFrequency,
    Kind,
    cantilever_frequencies,
    frequency_of_kind,
)
from fem.bodies.solid import Ends
from fem.couplings.wave_cantilever import beam_frequency, cut_off, prism_frequency, wave_frequency
from fem.couplings.wave_stiffness import PrismWaves, prism_waves
from fem.sections import nonuniform_torsion
from fem.sections.waveguide import torsion_wave
from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, tip_compliance
from lumped.memo import memo
from lumped.text import counted
from validation.case import Allowance, Measurement, Relative, Skip
from validation.case_group import CaseGroup, numbered
from validation.context import Context, Preset
from validation.models.leg_models import constant_leg_of
from validation.solids.solid_legs import (
    GRIDS_FOR_ORDER,
    Refinement,
    SolidModes,
    dynamic_ladder,
    face_mesh,
    face_restraint,
    formal_order,
    leg_constants,
    own_properties,
    solid_compliances,
    solid_frequencies,
    static_ladder,
)
from validation.solids.solid_size import larger_preset, why_shapeless

MODES = 6
# Row and column (from 0), meaning and unit of the entries that a straight leg's compliance has.
ENTRIES = {
    "c11": ((0, 0), "tension", "m/N"),
    "c22": ((1, 1), "deflection along y", "m/N"),
    "c33": ((2, 2), "deflection along z", "m/N"),
    "c44": ((3, 3), "torsion", "rad/(N m)"),
    "c55": ((4, 4), "rotation about y", "rad/(N m)"),
    "c66": ((5, 5), "rotation about z", "rad/(N m)"),
    "c26": ((1, 5), "deflection along y under a moment about z", "m/(N m)"),
    "c35": ((2, 4), "deflection along z under a moment about y", "m/(N m)"),
}
TIMOSHENKO = "S. P. Timoshenko, Phil. Mag. 41 (1921) 744; c = ∫ of unit resultants over EA … κGA"
HUANG = "T. C. Huang, J. Appl. Mech. 28 (1961) 579, exact Timoshenko cantilever, solved here"
# Divisions of the meshes of a leg that have at most so many unknowns.
Ladder: TypeAlias = Callable[[ConstantLeg, int], tuple[int, ...]]
# Unknowns of the largest section mesh for statics by doubling, and of the largest solid for modes.
STATICS: dict[Preset, int] = {"quick": 1000, "standard": 2000, "fine": 4000}
DYNAMICS: dict[Preset, int] = {"quick": 9_000, "standard": 30_000, "fine": 100_000}
# Waves need dense matrices: divisions of the section that show whether a mode is a beam's, and the
# largest ones.
WAVE_DIVISIONS, MOST_WAVES = 4, 8
# Relative tolerances of compliances. Held faces have edges where the mesh loses its order, worst in
# I-sections (2e-5); solid and beam with free ends have one section mesh, and what is left is how
# each follows curved walls (1e-7 of a circle).
_HELD, _FREE = 2e-4, 3e-6
# Wave length of the shortest mode, in section heights, that beam theory is held to.
SHORTEST_WAVE = 3.0
# Relative tolerance of frequencies: the uncertainty that two meshes leave of elements along a leg.
_BEAMS = 2e-3
DISTORTION = (
    "distortion of the section: contraction, warping by shear and walls that bend along the wave "
    "and at the free end"
)
DISTORTION_SOURCE = (
    "all fields of 3-D elasticity on the section's mesh (fem.couplings.wave_cantilever)"
)


cases = CaseGroup(
    over={"body": lambda legs: legs},
    reference_kind="closed-form",
    section="{body}",
    subject="leg",
    effort=0.1,
)
_compliances = cases.family(
    over={"name, entry, meaning, unit": [(name, *of) for name, of in ENTRIES.items()]},
    quantity="compliance {name}, {meaning}",
    label="{name}, {meaning}",
    citation=f"{TIMOSHENKO}; section constants by finite elements",
    group="{body}.solid",
)


def compliances(context: Context, body: str, ends: Ends) -> Refinement:
    """Tip compliances of a leg on the preset's meshes."""
    leg = constant_leg_of(context, body)
    divisions = _divisions(context, leg, static_ladder, STATICS, "section meshes")
    return context.get(solid_compliances, leg, divisions)[ends]


def frequencies(context: Context, body: str, ends: Ends, count: int) -> SolidModes:
    """First `count` frequencies of a leg on the preset's meshes."""
    leg = constant_leg_of(context, body)
    divisions = _divisions(context, leg, dynamic_ladder, DYNAMICS, "solid meshes")
    return context.get(solid_frequencies, leg, divisions, ends, count)


def _divisions(
    context: Context, leg: ConstantLeg, ladder: Ladder, limits: Mapping[Preset, int], what: str
) -> tuple[int, ...]:
    """Divisions of the meshes that the preset allows; Skip where these are fewer than two."""
    if shapeless := why_shapeless([leg]):
        raise Skip(shapeless)
    most = limits[context.preset]
    if divisions := context.get(ladder, leg, most):
        return divisions
    takes = larger_preset(context.preset, lambda one: bool(ladder(leg, limits[one])))
    raise Skip(
        f"two {what} of this section have more than {most} unknowns, too many for preset "
        f"{context.preset}; {takes} takes them"
    )


def own_compliances(leg: ConstantLeg, divisions: tuple[int, ...]) -> Array:
    """Tip compliances (m×6×6) of the beam, section constants on each of the solids' meshes."""
    beams = (own_properties(leg, number) for number in divisions)
    return np.array([tip_compliance(beam, leg.length) for beam in beams])


def restrained(leg: ConstantLeg, divisions: tuple[int, ...]) -> Array:
    """Change (m×6×6, ≤ 0) of the beam's tip compliance by rigid end faces, by theory."""
    return np.array([face_restraint(leg, number) for number in divisions])


def own_frequencies(
    leg: ConstantLeg, divisions: tuple[int, ...], kinds: tuple[tuple[Kind, int], ...]
) -> Array:
    """Frequencies (Hz, m×k) of the beam by kind and order, for each of the solids' meshes."""
    beams = [own_properties(leg, number) for number in divisions]
    return np.array(
        [[frequency_of_kind(beam, leg.length, *kind) for kind in kinds] for beam in beams]
    )


@_compliances.case(
    "{body}.compliance.solid-free[{name}]",
    "{body}: {name} of the solid with free ends is the Timoshenko cantilever's",
    over={"ends, fraction": [("free", _FREE)]},
    tolerance=Relative(_FREE),
    tolerance_reason="beam theory is exact for ends free to warp and contract, and both have one "
    "section mesh: 3e-6 where its walls are curved",
)
@_compliances.case(
    "{body}.compliance.solid[{name}]",
    "{body}: {name} of the solid with rigid faces is the Timoshenko cantilever's less what "
    "faces held plane take from it",
    over={"ends, fraction": [("rigid", _HELD)]},
    tolerance=Relative(_HELD),
    tolerance_reason="end effects decay as Saint-Venant's theory of the prism says; what is left "
    "is the mesh at the edges of held faces: 0.02 %",
    model="solid",
)
def _entry(
    context: Context, body: str, entry: tuple[int, int], ends: Ends, fraction: float
) -> Measurement:
    leg = constant_leg_of(context, body)
    solid, free = (compliances(context, body, one) for one in (ends, "free"))
    beams = context.get(own_compliances, leg, solid.divisions)
    own = Refinement(solid.divisions, beams, formal_order(leg, "free"))
    value, reference = float(solid.values[-1][entry]), float(own.values[-1][entry])
    taken = np.zeros_like(beams)
    allowances: tuple[Allowance, ...] = ()
    notes: tuple[str, ...] = ()
    if ends == "rigid":
        taken = context.get(restrained, leg, solid.divisions)
        allowances = (
            Allowance(
                cause="end faces kept plane and rigid: warping and contraction restrained",
                amount=float(taken[-1][entry]),
                source="fields that decay from held faces of the prism (fem.couplings.end_effects)",
            ),
        )
        by_faces = _percent(value, float(free.values[-1][entry]))
        notes = (f"the same mesh with free ends: {by_faces} by rigid faces",)
    # Solid and beam have one section mesh, whose errors they share: what is judged has its own.
    left = Refinement(solid.divisions, solid.values - own.values - taken, formal_order(leg, ends))
    _require_decided(context, body, left, entry, fraction * abs(reference))
    return Measurement(
        value,
        reference,
        value_uncertainty=solid.uncertainty(*entry),
        reference_uncertainty=own.uncertainty(*entry),
        judged_uncertainty=left.uncertainty(*entry),
        allowances=allowances,
        notes=notes,
    )


def _require_decided(
    context: Context, body: str, left: Refinement, entry: tuple[int, int], tolerance: float
) -> None:
    """Raise Skip where too few meshes for an order, three times their step, cannot decide."""
    uncertainty = left.uncertainty(*entry)
    undecided = abs(left.values[-1][entry]) <= tolerance < uncertainty
    if undecided and len(left.divisions) < GRIDS_FOR_ORDER:
        leg, preset = constant_leg_of(context, body), context.preset
        has = larger_preset(preset, lambda one: static_ladder(leg, STATICS[one]) != left.divisions)
        meshes = counted(len(left.divisions), "mesh", "meshes")
        raise Skip(
            f"affordable in preset {preset}: {meshes} of this section, too few to show an order; "
            f"the uncertainty is {uncertainty / tolerance:.2g} times the tolerance; {has} has "
            "finer ones"
        )


def _percent(changed: float, base: float) -> str:
    return f"{100.0 * (changed / base - 1.0):+.3g} %"


@cases.case(
    "{body}.frequency.solid[{mode}]",
    "{body}: frequency {mode} of the solid with free ends is the Timoshenko beam's and that of "
    "the waves in it",
    over={"index, mode": numbered(MODES)},
    quantity="natural frequency {mode}, clamped-free",
    label="frequency {mode}",
    unit="Hz",
    citation=f"{HUANG}; section constants by finite elements",
    tolerance=Relative(_BEAMS),
    tolerance_reason="what waves of 3-D elasticity change of Timoshenko's theory is allowed for; "
    "what is left is the mesh along the leg, known to 0.17 % from two coarse ones",
    model="solid",
    group="{body}.modes",
    effort=2.0,
)
def _mode(context: Context, body: str, index: int) -> Measurement:
    leg = constant_leg_of(context, body)
    judged = modes_of_beams(context, leg)
    modes = exact_modes(leg)
    exact = modes[index]
    if reason := context.get(not_a_beam, leg, exact):
        raise Skip(f"{exact.kind}, number {exact.order} of its kind: {reason}")
    rigid, free = (frequencies(context, body, ends, judged) for ends in ("rigid", "free"))
    found = free.frequencies
    kinds = tuple((one.kind, one.order) for one in modes)
    beams = context.get(own_frequencies, leg, found.divisions, kinds)[:, index]
    changes = context.get(distortion, leg, found.divisions, exact)
    # As for compliances: free solid, beam and waves have the errors of one section mesh in common.
    left = Refinement(found.divisions, found.values[:, index] - beams * (1.0 + changes))
    own = Refinement(found.divisions, beams)
    value, reference = float(found.values[-1, index]), float(beams[-1])
    held = float(rigid.frequencies.values[-1, index])
    return Measurement(
        value,
        reference,
        value_uncertainty=found.uncertainty(index),
        reference_uncertainty=own.uncertainty(),
        judged_uncertainty=left.uncertainty(),
        allowances=(Allowance(DISTORTION, float(changes[-1]) * reference, DISTORTION_SOURCE),),
        notes=(
            f"{exact.kind}, number {exact.order} of its kind; MAC with the beam's mode "
            f"{free.mac[-1, index]:.4f}",
            f"with rigid end faces {held:.5g} Hz, {_percent(held, value)}",
        ),
    )


def exact_modes(leg: ConstantLeg) -> tuple[CantileverFrequency, ...]:
    """The first frequencies of the Timoshenko cantilever, ascending."""
    return cantilever_frequencies(leg.timoshenko, leg.length, MODES)


def modes_of_beams(context: Context, leg: ConstantLeg) -> int:
    """Count of the first modes up to the last that beam theory applies to, at least one.

    Raises Skip for sections too large for a solid: they are too large for their waves, too.
    """
    _divisions(context, leg, dynamic_ladder, DYNAMICS, "solid meshes")
    beams = [not context.get(not_a_beam, leg, mode) for mode in exact_modes(leg)]
    return max((place for place, beam in enumerate(beams, start=1) if beam), default=1)


def _wave_number(leg: ConstantLeg, order: int) -> float:
    """Of a clamped-free mode (rad/m): so many quarters of a wave, an odd number, fit the leg."""
    return (2 * order - 1) * np.pi / (2.0 * leg.length)


def not_a_beam(leg: ConstantLeg, mode: CantileverFrequency) -> str:
    """Reason why beam theory does not apply to a mode, from the section alone; or ""."""
    if not leg.section.is_doubly_symmetric:
        return (
            "waves of 3-D elasticity are computed for sections that are symmetric about y and z, "
            f"not for a {leg.section.shape}"
        )
    width, height = leg.section.extent
    depth = {"bending y": height, "bending z": width}.get(mode.kind, max(width, height))
    heights = 2.0 * np.pi / _wave_number(leg, mode.order) / depth
    if heights < SHORTEST_WAVE:
        return (
            f"its wave is {heights:.1f} section heights long, below {SHORTEST_WAVE:g} no beam "
            "theory is meant to hold"
        )
    kind = _waves(leg, WAVE_DIVISIONS)[mode.kind]
    lowest = cut_off(kind)
    if mode.frequency >= lowest:
        return f"from {lowest:.4g} Hz on its section distorts by itself, as that of no beam does"
    try:
        _distorted(leg, WAVE_DIVISIONS, mode)
    except ComputationError as error:
        return str(error)
    return ""


@memo(16)
def _waves(leg: ConstantLeg, divisions: int) -> dict[str, PrismWaves]:
    """Waves of a leg's section by their kind."""
    waves = prism_waves(face_mesh(leg, divisions), leg.material)
    return {kind.fields.name: kind for kind in waves}


def distortion(leg: ConstantLeg, divisions: tuple[int, ...], mode: CantileverFrequency) -> Array:
    """Relative change (m) of a beam's frequency by the waves in it, on the solids' section meshes.

    Raises Skip if the wave is not a beam's.
    """
    try:
        return np.array([_distorted(leg, min(one, MOST_WAVES), mode) for one in divisions])
    except ComputationError as error:
        raise Skip(f"{mode.kind}, number {mode.order} of its kind: {error}") from None


@memo(64)
def _distorted(leg: ConstantLeg, divisions: int, mode: CantileverFrequency) -> float:
    kind = _waves(leg, divisions)[mode.kind]
    beam = beam_frequency(kind, leg.length, mode.order)
    if mode.kind == "torsion":
        near = beam * _warping_waves(leg, mode.order)
    else:
        near = wave_frequency(kind, leg.length, mode.order, beam)
    lowest = cut_off(kind)
    if near < lowest and (prism := prism_frequency(kind, leg.length, near)) < lowest:
        return prism / beam - 1.0
    raise ComputationError(
        f"by waves of 3-D elasticity it lies above {lowest:.4g} Hz, from where on its section "
        "distorts by itself"
    )


@memo(64)
def _warping_waves(leg: ConstantLeg, order: int) -> float:
    """Estimate of what warping makes of a torsional frequency of Saint-Venant's, a factor.

    Of the 3-D wave of the same length in an endless leg, and of the tip's face, free of that wave's
    normal stress, by Reissner's theory.
    """
    wave_number = _wave_number(leg, order)
    constants, material = leg_constants(leg, WAVE_DIVISIONS), leg.material
    saint_venant = wave_number * nonuniform_torsion.torsional_speed(constants, material)
    wave = torsion_wave(face_mesh(leg, WAVE_DIVISIONS), material, wave_number) / saint_venant
    relaxed = nonuniform_torsion.cantilever_frequencies(constants, material, leg.length, order)[-1]
    tip = relaxed / nonuniform_torsion.wave_frequency(constants, material, wave_number)
    return float(wave * tip)
