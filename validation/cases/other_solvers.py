"""Cases of a whole robot against other solvers: another reduction, CalculiX and EXUDYN.

Input: a posture of a robot. Output: verdicts on the 6×6 compliance and on natural frequencies.
Rules: modes of CAD parts with fixed interfaces (Craig, Bampton) and with free interfaces (MacNeal,
Rubin) span different spaces, so that equal frequencies confirm both; each reduction bounds its own
error. For CalculiX, each leg is a solid bar with the outer dimensions of the leg, meshed coarsely,
along its line if it is tapered, stepped or bent. CalculiX solves the whole mesh, and flexproof
condenses each bar to its ends. For EXUDYN, legs are chains of beam elements; frequencies are
extrapolated to infinitely many elements per leg. Legs along a line are rigid bodies and springs.
"""

import numpy as np

from fem.bodies.solid import solid_leg_matrices
from fem.calculix.leg import bar_solids, why_no_bars, with_bars
from fem.calculix.mechanism import compliance_and_frequencies
from fem.calculix.run import calculix_program
from fem.multibody import ExudynMissing, exudyn_version, frequencies
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.arrays import Array
from lumped.dense.modes import FewerModesError
from lumped.equivalent_leg import sectioned_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, LineLeg, SectionedLeg
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, modes, solved
from meshes.loft import slices_along, solid_section
from validation.case import Absolute, Elsewhere, Measurement, Relative, Skip
from validation.case_group import CaseGroup, numbered
from validation.context import Context
from validation.models.leg_models import filled
from validation.models.robot_models import (
    JUDGED_MODES,
    answers,
    highest_frequency,
)
from validation.parts.meshes import COARSE
from validation.references.reference_parts import bounded_frequencies
from validation.references.robot_on_path import (
    known_legs,
    path_postures,
    robot_on_path,
)
from validation.studies_and_figures import PATH
from validation.uncertainty.half_widths import MeshPolicy

# Number of frequencies compared with CalculiX, and with EXUDYN.
SOLID_MODES, BEAM_MODES = 10, 6
# Relative round-off of seven printed digits. Frequencies are roots of the printed eigenvalues.
_PRINTED_ROUND_OFF, _ROOT_ROUND_OFF = 5e-7, 2.5e-7
# Cut-off frequency of the bodies' modes over the highest frequency of the mechanism: the error of
# the reduction is below the printed digits.
_CUTOFF = 4.0
# Numbers of beams per leg in EXUDYN. They converge with order two, extrapolated frequencies with
# order four.
_ELEMENTS = (4, 8, 16)
# Largest number of cubes, with the smaller side of a bar as edge, in all bars, or of bricks along
# lines. CalculiX needs a minute for 2000 (100,000 unknowns), and more than ten for the 9600 of
# strips of a 0.5 mm leaf spring.
_MOST_CUBES = 2000
# Decimals to which differences of scaled entries are rounded, so that round-off vanishes.
_DIFFERENCE_DIGITS = 8

cases = CaseGroup(reference_kind="independent-solver", section=PATH)


def _judged_modes(mechanism: Mechanism) -> tuple[tuple[int, int], ...]:
    return numbered(JUDGED_MODES) if mechanism.parts else ()


@cases.case(
    "mechanism.parts.frequency[{mode}]",
    "Robot with CAD parts: frequency {mode} by free-interface modes equals that by "
    "fixed-interface modes",
    over={"index, mode": _judged_modes},
    quantity="natural frequency {mode}, middle of the path, coarsest mesh of the parts",
    citation="the same meshes, reduced by Craig and Bampton's method",
    unit="Hz",
    model="solid",
    group="mechanism.parts",
    effort=5.0,
    tolerance=Relative(1e-5),
    tolerance_reason="largest error of each reduction by its own bound: 3e-7 and less",
)
def _part_frequency(context: Context, index: int) -> Measurement:
    robot = robot_on_path(context)
    arguments = robot.postures, robot.computed_count, robot.holding.first
    free, fixed = (
        context.get(bounded_frequencies, *arguments, JUDGED_MODES, COARSE, interfaces)
        for interfaces in ("free", "fixed")
    )
    return Measurement(
        float(free.upper[index]),
        float(fixed.upper[index]),
        value_uncertainty=float(free.upper[index] - free.lower[index]),
        reference_uncertainty=float(fixed.upper[index] - fixed.lower[index]),
    )


_by_calculix = cases.family(
    citation=(
        "CalculiX CrunchiX, C3D10 and C3D20 elements; joints and rigid faces as linear equations, "
        "drives as springs; the same meshes, not reduced"
    ),
    presets=("standard", "fine"),
    model="solid",
    group="mechanism.calculix",
    effort=4.0,
)


def reduced_solids(posture: Posture) -> tuple[Array, Array]:
    """Compliance (6×6, SI, base axes) and first frequencies (Hz) by this program.

    Each leg is replaced by a solid bar with its outer dimensions, coarsely meshed and reduced by
    Craig and Bampton's method. Mass is integrated at the same points as in CalculiX.
    """
    bars = with_bars(posture)
    highest = highest_frequency([bars], SOLID_MODES)
    solids = bar_solids(bars.mechanism)
    cutoff = _CUTOFF * highest
    reduced = {
        leg: filled(craig_bampton(held_leg(solid_leg_matrices(solid)), highest, cutoff).matrices)
        for leg, solid in {solid.leg: solid for solid in solids.values()}.items()
    }
    bodies = {name: reduced[solid.leg] for name, solid in solids.items()}
    solution = solved(assembly(bars.mechanism, bodies).at(bars))
    return compliance(solution), modes(solution, SOLID_MODES).frequencies


def calculix_solids(posture: Posture) -> tuple[Array, Array]:
    """Compliance (6×6, SI, base axes) and first frequencies (Hz) by CalculiX, without reduction.

    The meshes of the legs are those of `reduced_solids`.
    """
    calculix_program()
    bars = with_bars(posture)
    return compliance_and_frequencies(bars, bar_solids(bars.mechanism), SOLID_MODES)


def _cube_count(leg: SectionedLeg) -> float:
    """Number of bricks of a line leg's bar, or of cubes whose edge is the smaller side of a prism.

    The mesh has 4 to 15 nodes in each of them.
    """
    if isinstance(leg, LineLeg):
        face = solid_section(leg, leg.stations[0][1], 1)
        return float(slices_along(leg, 1) * len(face.cells))
    width, height = leg.section.extent
    return width * height * leg.length / min(width, height) ** 3


def _reduced_and_calculix(context: Context) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Compliance and first frequencies by `reduced_solids`, then by `calculix_solids`.

    CalculiX runs first, so that no time is lost if it is not installed.
    """
    posture = path_postures(context)[0]
    legs = known_legs(posture.mechanism).values()
    if parts := posture.mechanism.parts:
        raise Skip(
            f"{', '.join(parts)}: the comparison with CalculiX is available only for robots "
            "of legs with sections and rigid bodies"
        )
    if not legs or any(isinstance(leg, GivenLeg) for leg in legs):
        raise Skip("legs specified by a 6×6 compliance have no section that could be meshed")
    if any(isinstance(leg, ConstantLeg) and not leg.section.is_uniform for leg in legs):
        raise Skip(
            "legs of composites or laminates cannot be modelled in CalculiX as bars of one material"
        )
    bars = with_bars(posture).mechanism
    if reasons := why_no_bars(bars):
        raise Skip("; ".join(reasons))
    cubes = sum(map(_cube_count, map(sectioned_leg, legs_of(bars).values())))
    if cubes > _MOST_CUBES:
        raise Skip(
            "a leg is a thin strip: cubes of its thickness would number "
            f"{cubes:.0f} in the mesh; the comparison allows at most {_MOST_CUBES}"
        )
    calculix = context.get(calculix_solids, posture)
    return context.get(reduced_solids, posture), calculix


@_by_calculix.case(
    "mechanism.calculix.statics",
    "Robot with legs as solid bars: 6×6 compliance equals that of CalculiX",
    quantity=(
        "entry of the 6×6 compliance with the largest difference, in units of √(c_ii c_jj), at "
        "the first pose"
    ),
    unit="1",
    tolerance=Absolute(5e-6),
    tolerance_reason="the same equations; ten times the rounding of seven printed digits",
    figure="mechanism.deflections",
)
def _static_solids(context: Context) -> Measurement:
    (reduced, _), (calculix, _) = _reduced_and_calculix(context)
    return Measurement(*farthest_entry(reduced, calculix), reference_uncertainty=_PRINTED_ROUND_OFF)


@_by_calculix.case(
    "mechanism.calculix.frequencies",
    f"Robot with legs as solid bars: first {SOLID_MODES} frequencies equal those of CalculiX",
    quantity="first natural frequency (all others in the table); first pose of the path",
    unit="Hz",
    tolerance=Relative(5e-6),
    tolerance_reason=(
        "rounding of printed digits, and the reduction with modes up to four times the "
        "highest frequency: 3e-7 and less for built-in robots"
    ),
    figure="mechanism.frequencies",
)
def _solid_frequencies(context: Context) -> Measurement:
    (_, reduced), (_, calculix) = _reduced_and_calculix(context)
    headings = "CalculiX (Hz)", "reduced bodies (Hz)"
    return _side_by_side(reduced, calculix, _ROOT_ROUND_OFF * calculix, headings)


def _compared_postures(mechanism: Mechanism) -> list[tuple[str, str]]:
    """Names and descriptions of the two compared postures, or of one if the tool cannot move."""
    postures = [("reference", "the reference posture"), ("start", "the first pose of the path")]
    return postures if mechanism.tool.moves else postures[:1]


def beams_and_exudyn(posture: Posture) -> tuple[Array, Array, Array]:
    """Frequencies (Hz) of this program's beams, and EXUDYN's with their half-widths.

    Idle motions, which have the lowest frequencies in EXUDYN due to round-off, are removed. Raises
    ExudynMissing if EXUDYN is not installed, and InputError for a mechanism that it cannot
    represent.
    """
    beams = answers("beam", [posture], BEAM_MODES)
    idle = beams.idle[0]
    coarse, middle, fine = (frequencies(posture, number, BEAM_MODES + idle) for number in _ELEMENTS)
    extrapolated, coarser_limit = (
        finer + (finer - coarser) / 3.0 for coarser, finer in ((middle, fine), (coarse, middle))
    )
    half_widths = MeshPolicy.of_order(2.0, 4.0).half_widths(np.abs(extrapolated - coarser_limit))
    return beams.frequencies[0], extrapolated[idle:], half_widths[idle:]


@cases.case(
    "mechanism.exudyn[{place}]",
    f"Robot with legs as beams, {{said}}: first {BEAM_MODES} frequencies equal those of EXUDYN",
    over={"place, said": _compared_postures},
    quantity="first natural frequency (all others in the table); {said}",
    unit="Hz",
    group="mechanism.exudyn",
    effort=1.0,
    model="beam",
    citation=(
        "EXUDYN, geometrically exact beams (springs between rigid bodies in legs along a line), "
        "generic joints and springs, linearised at the pose; extrapolated from 8 and 16 elements "
        "per leg, second order"
    ),
    tolerance=Relative(5e-4),
    tolerance_reason=(
        "uncertainty of the extrapolated frequencies, from the extrapolation with 4 and 8 "
        "beams per leg: 1e-4 to 3e-4"
    ),
)
def _beam_frequencies(context: Context, place: str) -> Measurement:
    posture = path_postures(context)[0]
    posture = reference_posture(posture.mechanism) if place == "reference" else posture
    try:
        program = exudyn_version()
        beams, exudyn, half_widths = context.get(beams_and_exudyn, posture)
    except (ExudynMissing, FewerModesError) as missing:
        raise Skip(str(missing)) from None
    except InputError as error:
        raise Skip("; ".join(error.faults)) from None
    headings = "EXUDYN, extrapolated (Hz)", "beam elements (Hz)"
    note = f"mode 1; EXUDYN {program}"
    return _side_by_side(beams, exudyn, half_widths, headings, note)


def _side_by_side(
    computed: Array,
    other_program: Array,
    half_widths: Array,
    headings: tuple[str, str],
    note: str = "",
) -> Measurement:
    """Comparison of `computed` frequencies (Hz) with those of another program.

    The first frequency is judged, all are in the table. `half_widths` (Hz): of the other program's
    frequencies. `headings`: columns of the table for the other program and for this one.
    """
    labels = [f"mode {number}" for number in range(1, len(other_program) + 1)]
    columns = zip(headings, (other_program, computed), strict=True)
    rows = zip(labels, computed.tolist(), other_program.tolist(), half_widths.tolist(), strict=True)
    return Measurement(
        float(computed[0]),
        float(other_program[0]),
        reference_uncertainty=float(half_widths[0]),
        elsewhere=tuple(Elsewhere(*row) for row in rows)[1:],
        notes=(note,) if note else (),
        table={
            "mode": tuple(float(number) for number in range(1, len(other_program) + 1)),
            **{heading: tuple(column.tolist()) for heading, column in columns},
        },
    )


def farthest_entry(compliance: Array, reference: Array) -> tuple[float, float]:
    """Entry of two compliances (6×6) that differs most: both values in units of √(c_ii c_jj).

    The unit is rounded to a power of two, so that scaling has no round-off. If entries differ only
    by round-off, which depends on the machine, the largest entry is returned.
    """
    sizes = np.sqrt(np.abs(np.diag(reference)))
    scale = np.outer(sizes, sizes)
    scale = np.exp2(np.round(np.log2(np.where(scale > 0.0, scale, 1.0))))
    values, references = (compliance / scale).ravel(), (reference / scale).ravel()
    differences = np.round(np.abs(values - references), _DIFFERENCE_DIGITS)
    farthest = np.lexsort((np.abs(references), differences))[-1]
    return float(values[farthest]), float(references[farthest])
