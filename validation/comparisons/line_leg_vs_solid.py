"""Cases on single legs along a line, root clamped: beams, segments and links against solids.

Input: a leg whose section varies, or whose line has arcs or corners. Output: a verdict for each
model on tip motions and frequencies. The solid is the same leg in quadratic hexahedra, with the end
condition of the robot file. Six causes of a difference are computed separately:
- rigid end faces, by the same solid with free ends;
- distortion of the section, because walls converge in torsion (`fem.beams.box_distortion`) and in
  vibration (`line_distortion`);
- bending of flanges of tapered I-sections in their planes by torsion (`fem.beams.tapered_flanges`),
  with its largest observed error as a half-width;
- bending of walls at kinks, where tapers begin or end (`fem.beams.kinked_walls`): only an upper
  bound is known, so that half of it is the cause, and half of it a half-width;
- corners and steps, by a solid of each alone, and corners by the mass beside the line
  (`validation.references.corners_and_steps`);
- section constants by textbook formulas along the line.

The remainder is the difference between the solid with free ends and a beam with section constants
computed on the solid's mesh. It converges with the order of the solid's elements.

Beam theory neglects terms of the size of two squares, which are added to the tolerances of [agree].
One is the square of the slope of a taper's faces: it matters in torsion, if a leg tapers across the
plane of bending, and for sections without two axes of symmetry. It is averaged along the leg,
weighted by the strain energy of a motion or mode, so that a short taper counts little. The other
is the square of half the height of the section over the radius of an arc.
"""

from dataclasses import replace

import numpy as np

from fem.beams.kinked_walls import kink_compliances
from fem.beams.line_beam import line_beam
from fem.beams.tapered_flanges import FLANGE_ERROR, flange_work
from lumped.acceptance.requirement import AgreementLimits
from lumped.arrays import Array, distinct
from lumped.errors import InputError
from lumped.legs import LineLeg
from lumped.line_sections import TOGETHER, LineSections, cumulative, gauss_points
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Mechanism
from lumped.memo import memo
from lumped.model_choices import Ends
from lumped.models.bodies import clamped_modes, legs_of
from lumped.screws import shift
from validation.case import Allowance, Measurement, Relative, Skip
from validation.comparisons.agreement_cases import (
    DISTORTION,
    HELD_FACES,
    agreement_group,
    compliance_cases,
    formula_allowance,
    frequency_cases,
)
from validation.comparisons.element_convergence import MODES
from validation.comparisons.line_distortion import flange_change, frequency_change, kink_change
from validation.comparisons.section_formulas import mesh_formula_band
from validation.context import Context
from validation.models.leg_models import leg_compliance, leg_frequencies
from validation.models.options import ModelName, ModelOptions
from validation.references.corners_and_steps import (
    SOURCE,
    frequency_changes,
    tip_changes,
    tip_half_widths,
)
from validation.references.reference_legs import (
    line_divisions,
    require_line_solid,
    slowest,
    solid_leg,
)
from validation.solids.leg_meshes import formal_order
from validation.solids.line_beams import (
    computed_along,
    computed_tip,
    mesh_frames,
    on_solid_mesh,
    wall_distortion,
)
from validation.solids.solid_legs import ELEMENTS, line_frequencies
from validation.solids.solid_size import why_shapeless
from validation.uncertainty.half_widths import MeshPolicy

_HELD_SOURCE = "the same solid with ends free to warp and contract"
_WALLS_SOURCE = "walls that converge push against each other (fem.beams.box_distortion)"
_WAVES_SOURCE = "waves of 3-D elasticity in prisms of the leg's sections at its frequency"
_TAPERED_FLANGES = "flanges of tapers bent by torsion"
_FLANGES_SOURCE = "plane beams that are not parallel (fem.beams.tapered_flanges)"
_KINKED_WALLS = "walls bent at kinks"
_KINKS_SOURCE = "half the upper bound of plates under deflected forces (fem.beams.kinked_walls)"
# Index of torsion in the tip compliance.
_TORSION = 3
_KINKS_UNDECIDED = (
    "only an upper bound is known for walls bent at kinks, so that finer meshes do not decide: "
    "give a longer taper or thicker walls, or describe the leg as a CAD part"
)
_NEGLECTED = (
    "and the squares of a taper's slope and of half the height over an arc's radius, which beam "
    "theory neglects"
)


def neglected(leg: LineLeg) -> Array:
    """Allowed errors (6) of beam theory in the diagonal entries of the tip compliance.

    They are (slope of a face)² + (half the height / radius)². The slope is the largest within a
    height on either side of a position, since stresses settle over that length, and its square is
    averaged along the leg, weighted by the strain energy of each entry.
    """
    edges, squares = _slopes(leg)
    tips = np.repeat([[leg.line.chord, 0.0, 0.0]], len(squares), axis=0)
    pieces = leg.sections("euler-bernoulli").compliances(edges, tips)
    energies = np.diagonal(pieces, axis1=1, axis2=2)
    return np.asarray(squares @ energies / energies.sum(axis=0) + _curved(leg))


def neglected_in_modes(leg: LineLeg) -> Array:
    """Allowed errors (`MODES`) of beam theory in the frequencies of the clamped leg.

    They are those of `neglected`, averaged by the strain energy of each mode: that of the inertia
    forces of all parts of the leg nearer to the tip.
    """
    sections = leg.sections("euler-bernoulli")
    beam = line_beam(sections, ELEMENTS)
    shapes = clamped_modes(beam, MODES).shapes
    edges = sections.edges(ELEMENTS)
    field = sections.along(edges)
    points, weights = gauss_points()
    lengths = np.diff(edges)
    positions = edges[:-1, None] + 0.5 * lengths[:, None] * (1.0 + points)
    twists = (beam.centreline(positions.ravel()) @ shapes).reshape(*positions.shape, 6, -1)
    momenta = np.einsum("egij,egjm->egim", field.mass, twists)
    at_root = np.einsum("egji,egjm->egim", shift(field.points), momenta)
    integral = 0.5 * lengths[:, None] * weights
    sums = np.cumsum(np.einsum("eg,egim->eim", integral, at_root), axis=0)
    before = np.concatenate([0.0 * sums[:1], sums[:-1]])
    beyond = sums[-1] - before[:, None] - cumulative(at_root, lengths)
    wrenches = np.einsum("egji,egjm->egim", shift(-field.points), beyond)
    energies = np.einsum("eg,egim,egij,egjm->egm", integral, wrenches, field.flexibility, wrenches)
    limits, squares = _slopes(leg)
    of_positions = squares[np.searchsorted(limits[1:-1], positions)]
    shares = energies / energies.sum(axis=(0, 1))
    return np.asarray(np.einsum("eg,egm->m", of_positions, shares) + _curved(leg))


def _slopes(leg: LineLeg) -> tuple[Array, Array]:
    """Ends (k + 1, m along the line) of k pieces, and the square (k) of the slope in each piece.

    The slope is the largest of a face within a height of the section on either side.
    """
    reach = leg.largest_extent
    ends = np.array([0.0, *(span.end for span in leg.spans)])
    edges = np.unique(np.clip([ends - reach, ends, ends + reach], 0.0, ends[-1]))
    edges = distinct(edges, TOGETHER * ends[-1])
    slopes = [
        np.abs(np.subtract(span.last.extent, span.first.extent)).max()
        / (2.0 * (span.end - span.start))
        for span in leg.spans
    ]
    middles = 0.5 * (edges[1:] + edges[:-1])[:, None]
    near = (middles > ends[:-1] - reach) & (middles < ends[1:] + reach)
    return edges, np.square(np.where(near, slopes, 0.0).max(axis=1))


def _curved(leg: LineLeg) -> float:
    return float((0.5 * leg.largest_extent / leg.line.smallest_radius) ** 2)


def _line_legs(mechanism: Mechanism) -> list[tuple[str, Array, Array]]:
    """Name of each tapered or curved leg, with allowed errors of its motions and frequencies."""
    return [
        (name, neglected(leg), neglected_in_modes(leg))
        for name, leg in legs_of(mechanism).items()
        if isinstance(leg, LineLeg)
    ]


cases = agreement_group(
    over={"body, of_motions, of_modes": _line_legs}, subject="leg", group="{body}.line", effort=1.0
)
_CITATION = "the same leg along its line meshed with quadratic hexahedra"


def _leg(context: Context, body: str) -> LineLeg:
    leg = legs_of(context.robot_file.mechanism)[body]
    if not isinstance(leg, LineLeg):
        raise TypeError(f"{body}: is not a tapered or curved leg")
    if reason := why_shapeless([leg]):
        raise Skip(reason)
    try:
        require_line_solid(context.meshes, leg)
    except InputError as error:
        raise Skip(str(error)) from None
    return leg


def _options(limits: AgreementLimits) -> ModelOptions:
    return ModelOptions(elements=limits.elements)


@compliance_cases(
    cases,
    "{body}",
    "{body}",
    "that of the solid leg",
    quantity="displacement of the tip, {motion}, under a unit load, root clamped",
    citation=_CITATION,
    tolerance=lambda limits, of_motions, entry: Relative(limits.compliance + of_motions[entry]),
    tolerance_reason=f"[agree] compliance (default 0.1 %), {_NEGLECTED}",
)
def _motion(
    context: Context, body: str, model: ModelName, entry: int, limits: AgreementLimits
) -> Measurement:
    leg = _leg(context, body)
    ends = limits.ends_of(leg.ends)
    meshes = solid_leg(context, leg)
    diagonal = entry, entry
    fine, coarse = meshes.fine[ends][diagonal], meshes.coarse[ends][diagonal]
    free = MeshPolicy.of_order(meshes.ratio, formal_order(leg, "free"))
    restraint = meshes.restrained[diagonal] if ends == "rigid" else 0.0
    divisions = line_divisions(context.meshes, leg)
    on_coarse, computed = (context.get(computed_tip, leg, n)[diagonal] for n in divisions)
    theory = leg.sections("timoshenko").tip_compliance[diagonal]
    soft, stiff = (bound[diagonal] for bound in context.get(_formula_tips, leg, divisions[1]))
    walls = [context.get(wall_distortion, leg, n) for n in divisions]
    coarse_walls, fine_walls = walls if entry == _TORSION else (0.0, 0.0)
    flanges = flange_work(leg, np.ones_like) if entry == _TORSION else 0.0
    coarse_jumps, fine_jumps = (
        {
            cause: float(change[diagonal])
            for cause, change in context.get(tip_changes, leg, n).items()
        }
        for n in divisions
    )
    # What kinks add to the compliance lies between zero and an upper bound.
    kinks = 0.5 * float(kink_compliances(leg)[entry])
    measurement = Measurement(
        float(leg_compliance(model, leg, _options(limits))[diagonal]),
        float(fine),
        reference_uncertainty=slowest(meshes.ratio, [leg]).half_width(fine - coarse),
        judged_uncertainty=kinks
        + FLANGE_ERROR * abs(flanges)
        + float(context.get(tip_half_widths, leg, divisions[1])[entry])
        + free.half_width(
            (meshes.fine["free"][diagonal] - computed - fine_walls - sum(fine_jumps.values()))
            - (
                meshes.coarse["free"][diagonal]
                - on_coarse
                - coarse_walls
                - sum(coarse_jumps.values())
            )
        ),
        allowances=(
            Allowance(HELD_FACES, -float(restraint), _HELD_SOURCE),
            Allowance(DISTORTION, -fine_walls, _WALLS_SOURCE),
            formula_allowance(
                theory, computed, (stiff, soft), free.half_width(computed - on_coarse)
            ),
            *((Allowance(_TAPERED_FLANGES, -flanges, _FLANGES_SOURCE),) if flanges else ()),
            *((Allowance(_KINKED_WALLS, -kinks, _KINKS_SOURCE),) if kinks else ()),
            *(Allowance(cause, -change, SOURCE) for cause, change in fine_jumps.items()),
        ),
    )
    return _naming_kinks(measurement, kinks)


def _naming_kinks(measurement: Measurement, kinks: float) -> Measurement:
    """Measurement that names kinks as what leaves it open, if they are most of its uncertainty."""
    uncertainty = measurement.numerical_uncertainty or 0.0
    most = 2.0 * kinks > uncertainty
    return replace(measurement, decides=_KINKS_UNDECIDED) if most else measurement


@memo(8)
def _formula_band(leg: LineLeg, divisions: int) -> tuple[LineSections, LineSections]:
    """Sections of the softest and of the stiffest beam by correct textbook formulas."""
    mesh = on_solid_mesh(leg, divisions)
    soft, stiff = (
        leg.sections_by(lambda prism: mesh_formula_band(prism, mesh(prism))[side])  # noqa: B023
        for side in (0, 1)
    )
    return soft, stiff


def _formula_tips(leg: LineLeg, divisions: int) -> tuple[Array, Array]:
    """Tip compliances (6×6, SI) of the softest and stiffest beam by correct textbook formulas."""
    soft, stiff = _formula_band(leg, divisions)
    return soft.tip_compliance, stiff.tip_compliance


def _formula_frequencies(leg: LineLeg, divisions: int) -> tuple[Array, Array]:
    """First frequencies (Hz) of the softest and stiffest beam by correct textbook formulas.

    Each array has `MODES` frequencies.
    """
    soft, stiff = (
        clamped_modes(line_beam(sections, ELEMENTS), MODES).frequencies
        for sections in _formula_band(leg, divisions)
    )
    return soft, stiff


@frequency_cases(
    cases,
    "{body}",
    "{body}",
    "that of the solid leg",
    quantity="natural frequency {mode}, clamped-free, paired by shape",
    citation=_CITATION,
    tolerance=lambda limits, of_modes, index: Relative(limits.frequency + of_modes[index]),
    tolerance_reason=f"[agree] frequency (default 1 %), {_NEGLECTED}",
)
def _frequency(
    context: Context, body: str, model: ModelName, index: int, limits: AgreementLimits
) -> Measurement:
    leg = _leg(context, body)
    ends = limits.ends_of(leg.ends)
    meshes = line_divisions(context.meshes, leg)
    ratio = meshes[1] / meshes[0]
    policy = MeshPolicy.of_order(ratio, formal_order(leg, "free"))
    (coarse, fine), (coarse_free, free) = (
        [context.get(_solid_frequencies, leg, number, end_condition)[index] for number in meshes]
        for end_condition in (ends, "free")
    )
    if np.isnan([coarse, fine, coarse_free, free]).any():
        raise Skip(f"no mode of the solid has the shape of mode {index + 1} of the beam")
    on_coarse, computed = (context.get(_computed_frequencies, leg, n)[index] for n in meshes)
    change, beyond_prisms = context.get(_distortion, leg, meshes[1], index)
    (coarse_jumps, _), (fine_jumps, beyond_stubs) = (
        (
            {cause: float(frequency * shares[index]) for cause, shares in changes.items()},
            float(frequency * half_widths[index]),
        )
        for n, frequency in zip(meshes, (on_coarse, computed), strict=True)
        for changes, half_widths in [context.get(frequency_changes, leg, n, MODES)]
    )
    # What kinks take from the frequency lies between zero and an upper bound.
    kinks = -0.5 * float(computed) * context.get(_kink_change, leg, meshes[1], index)
    flanges = -float(computed) * context.get(_flange_change, leg, meshes[1], index)
    theory = leg_frequencies("beam", leg, index + 1, ModelOptions(elements=ELEMENTS))[index]
    soft, stiff = (bound[index] for bound in context.get(_formula_frequencies, leg, meshes[1]))
    value = leg_frequencies(model, leg, index + 1, _options(limits))[index]
    measurement = Measurement(
        float(value),
        float(fine),
        reference_uncertainty=slowest(ratio, [leg]).half_width(fine - coarse),
        judged_uncertainty=kinks
        + FLANGE_ERROR * abs(flanges)
        + beyond_stubs
        + float(computed) * beyond_prisms
        + policy.half_width(
            (free - computed - sum(fine_jumps.values()))
            - (coarse_free - on_coarse - sum(coarse_jumps.values()))
        ),
        allowances=(
            Allowance(HELD_FACES, float(free - fine), _HELD_SOURCE),
            Allowance(DISTORTION, -float(computed) * change, _WAVES_SOURCE),
            formula_allowance(
                theory, computed, (soft, stiff), policy.half_width(computed - on_coarse)
            ),
            *(Allowance(cause, -change, SOURCE) for cause, change in fine_jumps.items()),
            *((Allowance(_TAPERED_FLANGES, flanges, _FLANGES_SOURCE),) if flanges else ()),
            *((Allowance(_KINKED_WALLS, kinks, _KINKS_SOURCE),) if kinks else ()),
        ),
    )
    return _naming_kinks(measurement, kinks)


def _solid_frequencies(leg: LineLeg, divisions: int, ends: Ends) -> Array:
    return line_frequencies(leg, divisions, ends, _computed_beam(leg, divisions), MODES)


def _computed_frequencies(leg: LineLeg, divisions: int) -> Array:
    """First `MODES` frequencies (Hz) of beam elements with section constants by finite elements."""
    return clamped_modes(_computed_beam(leg, divisions), MODES).frequencies


def _distortion(leg: LineLeg, divisions: int, index: int) -> tuple[float, float]:
    frames = mesh_frames(leg, divisions)
    return frequency_change(leg, _computed_beam(leg, divisions), index, frames)


def _kink_change(leg: LineLeg, divisions: int, index: int) -> float:
    return kink_change(leg, _computed_beam(leg, divisions), index)


def _flange_change(leg: LineLeg, divisions: int, index: int) -> float:
    return flange_change(leg, _computed_beam(leg, divisions), index)


@memo(8)
def _computed_beam(leg: LineLeg, divisions: int) -> LegMatrices:
    return line_beam(computed_along(leg, divisions), ELEMENTS)
