"""Cases on each leg alone with its root clamped: 3-D solid against Timoshenko's beam theory.

Input: a leg of constant section and the meshes that the preset allows. Output: verdicts on six
diagonal and two coupling entries of the tip compliance, with free and rigid end faces, and on six
frequencies. Rule: the difference between solid and beam, less the allowances for restrained end
faces and for distortion of the section in vibration, must be within the tolerance. Section
constants of the beam are computed on the section mesh of the solid, so that the error of this mesh
cancels.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import TypeAlias

import numpy as np

from fem.beams.beam_theory import (
    CantileverFrequency,
    Kind,
    cantilever_frequencies,
    frequency_of_kind,
)
from fem.couplings import wave_cantilever
from fem.couplings.wave_cantilever import beam_frequency, cut_off, wave_frequency
from fem.couplings.wave_stiffness import PrismWaves, prism_waves
from fem.sections import nonuniform_torsion
from fem.sections.moduli import mirrored_moduli
from fem.sections.waveguide import torsion_wave
from lumped.arrays import Array
from lumped.beam_properties import BeamProperties, tip_compliance
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg
from lumped.memo import memo
from lumped.model_choices import Ends
from lumped.text import counted
from validation.case import Allowance, Measurement, Relative, Skip
from validation.case_group import CaseGroup, numbered
from validation.context import Context, Preset
from validation.models.leg_models import constant_leg_of
from validation.solids import prism_legs
from validation.solids.leg_meshes import face_mesh, formal_order, modal_divisions, static_divisions
from validation.solids.prism_legs import has_waves, last_level_change, prism_change, prism_frequency
from validation.solids.solid_legs import (
    GRIDS_FOR_ORDER,
    Refinement,
    SolidModes,
    computed_properties,
    face_restraint,
    leg_constants,
    solid_compliances,
    solid_frequencies,
)
from validation.solids.solid_size import larger_preset, why_shapeless

MODES = 6
# Row and column (from 0), meaning and unit of the entries that a straight leg's compliance
# contains.
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
TIMOSHENKO = (
    "S. P. Timoshenko, Phil. Mag. 41 (1921) 744; compliance c = integral of products of unit "
    "stress resultants over EA … κGA"
)
HUANG = (
    "T. C. Huang, J. Appl. Mech. 28 (1961) 579, exact Timoshenko cantilever, frequency "
    "equation solved numerically"
)
# Function that returns the divisions of a leg's meshes, for a largest number of unknowns.
DivisionsWithin: TypeAlias = Callable[[ConstantLeg, int], tuple[int, ...]]
# Largest number of unknowns: of a section mesh for statics by doubling, of a solid for modes.
STATICS: dict[Preset, int] = {"quick": 1000, "standard": 2000, "fine": 4000}
DYNAMICS: dict[Preset, int] = {"quick": 9_000, "standard": 30_000, "fine": 100_000}
# Divisions of the section mesh for the waves that decide whether beam theory applies to a mode, and
# largest divisions for waves, whose matrices are dense.
WAVE_DIVISIONS, MOST_WAVES = 4, 8
# Relative tolerances of compliances. Rigid faces have edges at which the mesh loses its order, most
# in I-sections (2e-5). With free ends, solid and beam share one section mesh; what remains is their
# different treatment of curved walls (1e-7 for a circle).
_HELD_TOLERANCE, _FREE_TOLERANCE = 2e-4, 3e-6
# Modes with whose shapes those of the solid are paired: without and with two axes of symmetry.
_SHAPES = "the mode of the prism", "the beam mode"
# Shortest wavelength, in section heights, for which beam theory is judged.
SHORTEST_WAVE = 3.0
# Relative tolerance of frequencies: uncertainty of two meshes along a leg.
_FREQUENCY_TOLERANCE = 2e-3
DISTORTION = (
    "distortion of the section: contraction, shear warping, and walls that bend along "
    "the wave and at the free end"
)
DISTORTION_SOURCE = (
    "all fields of 3-D elasticity on the section's mesh (fem.couplings.wave_cantilever); without "
    "two axes of symmetry, modes of the section (fem.couplings.section_modes)"
)
cases = CaseGroup(
    over={"body": lambda legs: legs},
    reference_kind="closed-form",
    section="{body}",
    subject="leg",
    effort=0.1,
)
_compliances = cases.family(
    over={
        "name, entry, meaning, unit": [
            (name, *entry_fields) for name, entry_fields in ENTRIES.items()
        ]
    },
    quantity="compliance {name}, {meaning}",
    label="{name}, {meaning}",
    citation=f"{TIMOSHENKO}; section constants by finite elements",
    group="{body}.solid",
)


def compliances(context: Context, body: str, ends: Ends) -> Refinement:
    """Tip compliances of a leg as a solid, on all meshes that the preset allows."""
    leg = constant_leg_of(context, body)
    divisions = _divisions(context, leg, static_divisions, STATICS, "section meshes")
    return context.get(solid_compliances, leg, divisions)[ends]


def frequencies(context: Context, body: str, ends: Ends, count: int) -> SolidModes:
    """First `count` frequencies of a leg as a solid, on all meshes that the preset allows."""
    leg = constant_leg_of(context, body)
    divisions = _divisions(context, leg, modal_divisions, DYNAMICS, "solid meshes")
    return context.get(solid_frequencies, leg, divisions, ends, count)


def _divisions(
    context: Context,
    leg: ConstantLeg,
    divisions_within: DivisionsWithin,
    limits: Mapping[Preset, int],
    meshes: str,
) -> tuple[int, ...]:
    """Divisions of the meshes that the preset of the run allows.

    `divisions_within` returns the divisions of meshes whose unknowns are within a limit; `limits`
    has the limit of each preset. Raises Skip if there are fewer than two meshes. `meshes` is their
    name in the message.
    """
    if shapeless := why_shapeless([leg]):
        raise Skip(shapeless)
    largest_unknowns = limits[context.preset]
    if divisions := context.get(divisions_within, leg, largest_unknowns):
        return divisions
    fitting_preset = larger_preset(
        context.preset, lambda preset: bool(divisions_within(leg, limits[preset]))
    )
    raise Skip(
        f"two {meshes} of the section of {leg.name or 'the leg'} have more than "
        f"{largest_unknowns} unknowns, too many for preset {context.preset}; "
        f"{fitting_preset} allows them"
    )


def computed_compliances(leg: ConstantLeg, divisions: tuple[int, ...]) -> Array:
    """Tip compliances (m×6×6, SI, leg axes) of the beam with computed section constants.

    The constants are those of each of m section meshes.
    """
    beams = (computed_properties(leg, number) for number in divisions)
    return np.array([tip_compliance(beam, leg.length) for beam in beams])


def face_restraints(leg: ConstantLeg, divisions: tuple[int, ...]) -> Array:
    """Change (m×6×6, negative semidefinite) of a beam's tip compliance due to rigid end faces.

    It is computed on each of m section meshes.
    """
    return np.array([face_restraint(leg, number) for number in divisions])


def computed_frequencies(
    leg: ConstantLeg, divisions: tuple[int, ...], kinds: tuple[tuple[Kind, int], ...]
) -> Array:
    """Frequencies (m×k, Hz) of a leg as a beam, with section constants from each of m meshes.

    `kinds`: kind of deformation and order of each of k modes.
    """
    beams = [computed_properties(leg, number) for number in divisions]
    return frequencies_by_kind(beams, leg.length, kinds)


def frequencies_by_kind(
    beams: Iterable[BeamProperties], length: float, kinds: tuple[tuple[Kind, int], ...]
) -> Array:
    """Frequencies (m×k, Hz) of m cantilevers, for the kind and order of each of k modes."""
    return np.array([[frequency_of_kind(beam, length, *kind) for kind in kinds] for beam in beams])


@_compliances.case(
    "{body}.compliance.solid-free[{name}]",
    "{body}: compliance {name} of the solid with free ends equals that of a Timoshenko cantilever",
    over={"ends, fraction": [("free", _FREE_TOLERANCE)]},
    tolerance=Relative(_FREE_TOLERANCE),
    tolerance_reason=(
        "beam theory is exact if the ends are free to warp and contract, and both models use "
        "the same section mesh: 3e-6 if its walls are curved"
    ),
)
@_compliances.case(
    "{body}.compliance.solid[{name}]",
    "{body}: compliance {name} of the solid with rigid end faces equals that of a "
    "Timoshenko cantilever minus the effect of the rigid faces",
    over={"ends, fraction": [("rigid", _HELD_TOLERANCE)]},
    tolerance=Relative(_HELD_TOLERANCE),
    tolerance_reason=(
        "end effects decay as in Saint-Venant's theory of the prism; the remainder is the mesh "
        "error at the edges of rigid faces: 0.02 %"
    ),
    model="solid",
)
def _entry(
    context: Context, body: str, entry: tuple[int, int], ends: Ends, fraction: float
) -> Measurement:
    leg = constant_leg_of(context, body)
    solid, free = (compliances(context, body, condition) for condition in (ends, "free"))
    beams = context.get(computed_compliances, leg, solid.divisions)
    beam = Refinement(solid.divisions, beams, formal_order(leg, "free"))
    value, reference = float(solid.values[-1][entry]), float(beam.values[-1][entry])
    restraints = np.zeros_like(beams)
    allowances: tuple[Allowance, ...] = ()
    notes: tuple[str, ...] = ()
    if ends == "rigid":
        restraints = context.get(face_restraints, leg, solid.divisions)
        allowances = (
            Allowance(
                cause="end faces kept plane and rigid: warping and contraction restrained",
                amount=float(restraints[-1][entry]),
                source=(
                    "fields that decay from rigid faces of the prism (fem.couplings.end_effects)"
                ),
            ),
        )
        by_faces = _percent(value, float(free.values[-1][entry]))
        notes = (f"change due to rigid faces, on the same mesh: {by_faces}",)
    # Solid and beam share the error of one section mesh, so their difference is less uncertain than
    # each.
    residuals = Refinement(
        solid.divisions, solid.values - beam.values - restraints, formal_order(leg, ends)
    )
    _require_decided(context, body, residuals, entry, fraction * abs(reference))
    return Measurement(
        value,
        reference,
        value_uncertainty=solid.uncertainty(*entry),
        reference_uncertainty=beam.uncertainty(*entry),
        judged_uncertainty=residuals.uncertainty(*entry),
        allowances=allowances,
        notes=notes,
    )


def _require_decided(
    context: Context, body: str, residuals: Refinement, entry: tuple[int, int], tolerance: float
) -> None:
    """Raise Skip if the comparison of a compliance entry is undecided for lack of meshes.

    `residuals` are the differences between solid and beam on each mesh, `entry` is row and column.
    The comparison is undecided if the difference is within the `tolerance` and the uncertainty
    above it. It lacks meshes if there are too few to observe an order of convergence.
    """
    uncertainty = residuals.uncertainty(*entry)
    undecided = abs(residuals.values[-1][entry]) <= tolerance < uncertainty
    if undecided and len(residuals.divisions) < GRIDS_FOR_ORDER:
        leg, preset = constant_leg_of(context, body), context.preset
        finer_preset = larger_preset(
            preset,
            lambda other_preset: (
                static_divisions(leg, STATICS[other_preset]) != residuals.divisions
            ),
        )
        meshes = counted(len(residuals.divisions), "mesh", "meshes")
        raise Skip(
            f"preset {preset} allows {meshes} of this section, too few to observe an "
            f"order of convergence; the uncertainty is {uncertainty / tolerance:.2g} "
            f"times the tolerance; {finer_preset} has finer meshes"
        )


def _percent(changed: float, base: float) -> str:
    return f"{100.0 * (changed / base - 1.0):+.3g} %"


@cases.case(
    "{body}.frequency.solid[{mode}]",
    "{body}: frequency {mode} of the solid with free ends equals that of a Timoshenko "
    "beam corrected by waves of 3-D elasticity",
    over={"index, mode": numbered(MODES)},
    quantity="natural frequency {mode}, clamped-free",
    label="frequency {mode}",
    unit="Hz",
    citation=f"{HUANG}; section constants by finite elements",
    tolerance=Relative(_FREQUENCY_TOLERANCE),
    tolerance_reason=(
        "the difference between Timoshenko's theory and waves of 3-D elasticity is allowed "
        "for; the remainder is the mesh error along the leg, known to 0.17 % from two coarse "
        "meshes"
    ),
    model="solid",
    group="{body}.modes",
    effort=2.0,
)
def _mode(context: Context, body: str, index: int) -> Measurement:
    leg = constant_leg_of(context, body)
    count = beam_mode_count(context, leg)
    modes = exact_modes(leg)
    exact = modes[index]
    if reason := context.get(why_no_beam, leg, exact):
        raise Skip(f"{exact.kind} mode {exact.order}: {reason}")
    rigid, free = (frequencies(context, body, ends, count) for ends in ("rigid", "free"))
    solid = free.frequencies
    kinds = tuple((mode.kind, mode.order) for mode in modes)
    beams = context.get(computed_frequencies, leg, solid.divisions, kinds)[:, index]
    changes = context.get(distortion, leg, solid.divisions, exact)
    # As for compliances, the free solid, the beam and the waves share the error of one section
    # mesh.
    residuals = Refinement(solid.divisions, solid.values[:, index] - beams * (1.0 + changes))
    beam = Refinement(solid.divisions, beams)
    value, reference = float(solid.values[-1, index]), float(beams[-1])
    rigid_frequency = float(rigid.frequencies.values[-1, index])
    return Measurement(
        value,
        reference,
        value_uncertainty=solid.uncertainty(index),
        reference_uncertainty=beam.uncertainty(),
        judged_uncertainty=residuals.uncertainty()
        + reference * context.get(distortion_half_width, leg, exact),
        allowances=(Allowance(DISTORTION, float(changes[-1]) * reference, DISTORTION_SOURCE),),
        notes=(
            (
                f"{exact.kind} mode {exact.order}; MAC with {_SHAPES[has_waves(leg)]} "
                f"{free.mac[-1, index]:.4f}"
            ),
            f"with rigid end faces {rigid_frequency:.5g} Hz, {_percent(rigid_frequency, value)}",
        ),
    )


def exact_modes(leg: ConstantLeg) -> tuple[CantileverFrequency, ...]:
    """First natural frequencies of a leg as a Timoshenko cantilever, ascending."""
    return cantilever_frequencies(leg.timoshenko, leg.length, MODES)


def beam_mode_count(context: Context, leg: ConstantLeg) -> int:
    """Number of the highest mode to which beam theory applies, at least 1.

    Raises Skip if the preset allows fewer than two solid meshes of the leg. The waves of 3-D
    elasticity, which determine the number, would then be too expensive as well.
    """
    _divisions(context, leg, modal_divisions, DYNAMICS, "solid meshes")
    follow_beam_theory = [not context.get(why_no_beam, leg, mode) for mode in exact_modes(leg)]
    return max(
        (number for number, follows in enumerate(follow_beam_theory, start=1) if follows), default=1
    )


def _wave_number(leg: ConstantLeg, order: int) -> float:
    """Wave number (rad/m) of a clamped-free mode of order n: 2n − 1 quarter waves fit the leg."""
    return (2 * order - 1) * np.pi / (2.0 * leg.length)


def why_no_beam(leg: ConstantLeg, mode: CantileverFrequency) -> str:
    """Reason why beam theory does not apply to a mode of a leg with a given section.

    "" if it applies. The criteria are the frequency from which on the section distorts and, for
    sections with two axes of symmetry, the wavelength over the height of the section.
    """
    if not has_waves(leg):
        prism = prism_frequency(leg, WAVE_DIVISIONS, "free", mode)
        return _above_cut_off(
            max(mode.frequency, prism), prism_legs.cut_off(leg, WAVE_DIVISIONS, mode)
        )
    width, height = leg.section.extent
    depth = {"bending y": height, "bending z": width}.get(mode.kind, max(width, height))
    heights_per_wave = 2.0 * np.pi / _wave_number(leg, mode.order) / depth
    if heights_per_wave < SHORTEST_WAVE:
        return (
            f"the wavelength of the mode is {heights_per_wave:.1f} section heights; beam theory is "
            f"not valid below {SHORTEST_WAVE:g}"
        )
    waves = _waves(leg, WAVE_DIVISIONS)[mode.kind]
    lowest = cut_off(waves)
    if reason := _above_cut_off(mode.frequency, lowest):
        return reason
    try:
        _distorted(leg, WAVE_DIVISIONS, mode)
    except ComputationError as error:
        return str(error)
    return ""


def _above_cut_off(frequency: float, lowest: float) -> str:
    if frequency < lowest:
        return ""
    return f"above {lowest:.4g} Hz the section of the leg distorts, which no beam theory contains"


@memo(16)
def _waves(leg: ConstantLeg, divisions: int) -> dict[str, PrismWaves]:
    """Waves of 3-D elasticity along a leg, by kind of deformation."""
    mesh = face_mesh(leg, divisions)
    waves = prism_waves(mesh, mirrored_moduli(leg, mesh) or leg.material)
    return {kind.fields.name: kind for kind in waves}


def distortion(leg: ConstantLeg, divisions: tuple[int, ...], mode: CantileverFrequency) -> Array:
    """Relative change of a beam frequency due to 3-D elasticity: one number for each of m meshes.

    Raises Skip if the section distorts at the frequency of the mode, so that the wave is no longer
    that of a beam.
    """
    if not has_waves(leg):
        return np.array([prism_change(leg, number, mode) for number in divisions])
    try:
        return np.array([_distorted(leg, min(number, MOST_WAVES), mode) for number in divisions])
    except ComputationError as error:
        raise Skip(f"{mode.kind} mode {mode.order}: {error}") from None


def distortion_half_width(leg: ConstantLeg, mode: CantileverFrequency) -> float:
    """Relative half-width of a frequency with `distortion`, from the modes of the section.

    It is the change by the highest level of these modes. All higher levels together leave 0.8 of
    it in torsion of an I-section five heights long, whose exact frequency waves give, and less in
    bending. Zero for waves, which contain all fields of the section.
    """
    if has_waves(leg):
        return 0.0
    return last_level_change(leg, WAVE_DIVISIONS, mode)


@memo(64)
def _distorted(leg: ConstantLeg, divisions: int, mode: CantileverFrequency) -> float:
    waves = _waves(leg, divisions)[mode.kind]
    beam = beam_frequency(waves, leg.length, mode.order)
    if mode.kind == "torsion" and leg.section.is_uniform:
        estimate = beam * _warping_waves(leg, mode.order)
    else:
        estimate = wave_frequency(waves, leg.length, mode.order, beam)
    lowest = cut_off(waves)
    if (
        estimate < lowest
        and (prism := wave_cantilever.prism_frequency(waves, leg.length, estimate)) < lowest
    ):
        return prism / beam - 1.0
    raise ComputationError(
        f"by the theory of waves in a 3-D prism, the mode lies above {lowest:.4g} Hz, where the "
        "section of the leg distorts"
    )


@memo(64)
def _warping_waves(leg: ConstantLeg, order: int) -> float:
    """Estimated factor by which warping changes a torsional frequency of Saint-Venant's theory.

    `order`: number of the torsional mode, from 1. The factor is a product of two factors: that of
    the 3-D wave of this length in an endless leg, and that of the tip face, which is free of the
    normal stress of that wave (Reissner's theory).
    """
    wave_number = _wave_number(leg, order)
    constants, material = leg_constants(leg, WAVE_DIVISIONS), leg.material
    saint_venant = wave_number * nonuniform_torsion.torsional_speed(constants, material)
    wave = torsion_wave(face_mesh(leg, WAVE_DIVISIONS), material, wave_number) / saint_venant
    relaxed = nonuniform_torsion.cantilever_frequencies(constants, material, leg.length, order)[-1]
    tip = relaxed / nonuniform_torsion.wave_frequency(constants, material, wave_number)
    return float(wave * tip)
