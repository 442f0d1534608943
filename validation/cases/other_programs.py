"""A whole robot in other programs: unreduced solids by CalculiX, beams by EXUDYN.

For CalculiX legs are bars of their outer size on coarse meshes, here reduced to their ends.
"""

import numpy as np

from fem.bodies.solid import solid_leg_matrices
from fem.calculix.leg import bar_solids, with_bars
from fem.calculix.mechanism import compliance_and_frequencies
from fem.calculix.run import calculix_program
from fem.multibody import ExudynMissing, exudyn_version, frequencies
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.arrays import Array
from lumped.dense.modes import FewerModesError
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Leg
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, modes, solved
from validation.case import Absolute, Elsewhere, Measurement, Relative, Skip
from validation.case_group import CaseGroup
from validation.context import Context
from validation.models.leg_models import filled
from validation.models.robot_models import PostureAnswer, answers, highest_frequency
from validation.references.robot_on_path import known_legs, path_postures
from validation.studies_and_figures import PATH
from validation.uncertainty.mesh_half_widths import MeshPolicy, mesh_half_widths

# Frequencies compared with CalculiX, and with EXUDYN.
SOLID_MODES, BEAM_MODES = 10, 6
# Relative rounding of seven printed digits; frequencies are roots of the printed eigenvalues.
_PRINTED, _PRINTED_ROOT = 5e-7, 2.5e-7
# Modes of the bodies are kept up to four times the highest frequency of the mechanism: what is
# left out is below the printed digits.
_CUTOFF = 4.0
# Beams a leg in EXUDYN: of second order, so that extrapolated ones are of fourth.
_ELEMENTS = (4, 8, 16)
# Cubes of the smaller side in all bars: 2000 have 100,000 unknowns and take CalculiX a minute, the
# strips of a leaf spring of 0.5 mm, 9600, more than ten.
_MOST_CUBES = 2000
# Digits of differences that are more than rounding.
_DIGITS = 8

cases = CaseGroup(reference_kind="independent-solver", section=PATH)
_by_calculix = cases.family(
    citation="CalculiX CrunchiX, C3D10, joints and rigid faces as linear equations, drives as "
    "springs; the same meshes, not reduced",
    presets=("standard", "fine"),
    model="solid",
    group="mechanism.calculix",
    effort=4.0,
)


def by_reduced(at: Posture) -> tuple[Array, Array]:
    """Compliance (6×6, SI, base axes) at the loaded point, and first frequencies (Hz).

    Of a mechanism with legs as bars of their outer size, coarse meshes, reduced to their ends; mass
    is summed over the points that CalculiX sums it over.
    """
    bars = with_bars(at)
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


def by_calculix(at: Posture) -> tuple[Array, Array]:
    """The same of a mechanism of bars on the same meshes, not reduced."""
    calculix_program()
    bars = with_bars(at)
    return compliance_and_frequencies(bars, bar_solids(bars.mechanism), SOLID_MODES)


def _cubes(described: Leg) -> float:
    """Cubes as long as a bar's smaller side that fill it: 7 to 15 nodes each."""
    leg = equivalent_leg(described)
    width, height = leg.section.extent
    return width * height * leg.length / min(width, height) ** 3


def _solids(context: Context) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """By this program and by CalculiX, which is asked first: it may not be there."""
    at = path_postures(context)[0]
    legs = known_legs(at.mechanism).values()
    if parts := at.mechanism.parts:
        raise Skip(f"{', '.join(parts)}: CalculiX solves mechanisms of prisms and rigid bodies")
    if not legs or not all(isinstance(leg, ConstantLeg) for leg in legs):
        raise Skip("legs known by a 6×6 have no section that could be meshed")
    cubes = sum(map(_cubes, legs_of(with_bars(at).mechanism).values()))
    if cubes > _MOST_CUBES:
        raise Skip(
            f"legs of strips: tetrahedra as long as the legs are thick fill {cubes:.0f} cubes; "
            f"CalculiX solves at most {_MOST_CUBES} in time"
        )
    theirs = context.get(by_calculix, at)
    return context.get(by_reduced, at), theirs


@_by_calculix.case(
    "mechanism.calculix.statics",
    "CalculiX gives the mechanism's 6×6 compliance, legs as solid bars",
    quantity="entry of the 6×6 that differs most, in units of √(c_ii c_jj), first pose",
    unit="1",
    tolerance=Absolute(5e-6),
    tolerance_reason="the same equations: ten times what seven printed digits leave",
    figure="mechanism.deflections",
)
def _static_solids(context: Context) -> Measurement:
    (own, _), (theirs, _) = _solids(context)
    return Measurement(*farthest_entry(own, theirs), reference_uncertainty=_PRINTED)


@_by_calculix.case(
    "mechanism.calculix.frequencies",
    f"CalculiX gives the mechanism's first {SOLID_MODES} frequencies, legs as solid bars",
    quantity="first natural frequency, the others beside it, first pose of the path",
    unit="Hz",
    tolerance=Relative(5e-6),
    tolerance_reason="the printed digits, and what bodies reduced with modes up to four times the "
    "highest frequency leave: 3e-7 and less of built-in robots",
    figure="mechanism.frequencies",
)
def _solid_frequencies(context: Context) -> Measurement:
    (_, own), (_, theirs) = _solids(context)
    headings = "CalculiX (Hz)", "reduced bodies (Hz)"
    return _side_by_side(own, theirs, _PRINTED_ROOT * theirs, headings)


def _places(mechanism: Mechanism) -> list[tuple[str, str]]:
    """Postures to compare in, and what they are called; what does not move has one."""
    places = [("reference", "the reference posture"), ("start", "the first pose of the path")]
    return places if mechanism.tool.moves else places[:1]


def by_both(at: Posture) -> tuple[PostureAnswer, Array, Array]:
    """The program's own beams, and EXUDYN's frequencies (Hz) with their uncertainty, idle ones out.

    What idles stands first there, with the frequency that rounding gives it. Raises ExudynMissing,
    and InputError for what is not written for it.
    """
    (own,) = answers("beam", [at], BEAM_MODES)
    coarse, middle, fine = (frequencies(at, number, BEAM_MODES + own.idle) for number in _ELEMENTS)
    extrapolated, before = (
        finer + (finer - coarser) / 3.0 for coarser, finer in ((middle, fine), (coarse, middle))
    )
    uncertain = mesh_half_widths([np.abs(extrapolated - before)], MeshPolicy.of_order(2.0, 4.0))
    return own, extrapolated[own.idle :], uncertain[own.idle :]


@cases.case(
    "mechanism.exudyn[{place}]",
    f"EXUDYN gives the first {BEAM_MODES} frequencies in {{said}}, legs as beams",
    over={"place, said": _places},
    quantity="first natural frequency, the others beside it, {said}",
    unit="Hz",
    group="mechanism.exudyn",
    effort=1.0,
    model="beam",
    citation="EXUDYN, geometrically exact beams, generic joints and springs, linearised in the "
    "posture; 8 and 16 beams a leg extrapolated by their second order",
    tolerance=Relative(5e-4),
    tolerance_reason="the step from 4 and 8 beams a leg to 8 and 16 shows what the extrapolated "
    "frequencies leave open, 1e-4 to 3e-4",
)
def _beam_frequencies(context: Context, place: str) -> Measurement:
    at = path_postures(context)[0]
    at = reference_posture(at.mechanism) if place == "reference" else at
    try:
        program = exudyn_version()
        own, theirs, uncertain = context.get(by_both, at)
    except (ExudynMissing, FewerModesError) as missing:
        raise Skip(str(missing)) from None
    except InputError as error:
        raise Skip("; ".join(error.faults)) from None
    headings = "EXUDYN, extrapolated (Hz)", "beam elements (Hz)"
    note = f"mode 1; EXUDYN {program}"
    return _side_by_side(own.frequencies, theirs, uncertain, headings, note)


def _side_by_side(
    own: Array, theirs: Array, uncertainty: Array, headings: tuple[str, str], note: str = ""
) -> Measurement:
    """Frequencies (Hz) beside another program's, which are uncertain: the first, others beside it.

    `headings` of its and of our column in the table.
    """
    places = [f"mode {number}" for number in range(1, len(theirs) + 1)]
    columns = zip(headings, (theirs, own), strict=True)
    compared = zip(places, own.tolist(), theirs.tolist(), uncertainty.tolist(), strict=True)
    return Measurement(
        float(own[0]),
        float(theirs[0]),
        reference_uncertainty=float(uncertainty[0]),
        elsewhere=tuple(Elsewhere(*one) for one in compared)[1:],
        notes=(note,) if note else (),
        table={
            "mode": tuple(float(number) for number in range(1, len(theirs) + 1)),
            **{heading: tuple(column.tolist()) for heading, column in columns},
        },
    )


def farthest_entry(found: Array, reference: Array) -> tuple[float, float]:
    """The entries of two compliances (6×6) that differ most, in units of √(c_ii c_jj).

    The unit is the power of two next to that of the reference, so that both numbers stay what they
    are. Of entries that differ by rounding alone the largest: rounding differs from machine to
    machine.
    """
    sizes = np.sqrt(np.abs(np.diag(reference)))
    scale = np.outer(sizes, sizes)
    scale = np.exp2(np.round(np.log2(np.where(scale > 0.0, scale, 1.0))))
    ours, theirs = (found / scale).ravel(), (reference / scale).ravel()
    apart = np.round(np.abs(ours - theirs), _DIGITS)
    at = np.lexsort((np.abs(theirs), apart))[-1]
    return float(ours[at]), float(theirs[at])
