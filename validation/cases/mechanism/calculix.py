"""A whole mechanism with solid legs, unreduced by CalculiX, against its legs reduced."""

from dataclasses import dataclass

import numpy as np

from fem.bodies.solid import SolidLeg, solid_leg_matrices
from fem.calculix.mechanism import compliance_and_frequencies
from fem.calculix.run import CalculixMissing, calculix_program
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.arrays import Array
from lumped.legs import ConstantLeg
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, modes, solved
from validation.adequacy.mechanism.path import known_legs, path_postures
from validation.case import Absolute, Case, Measurement, Relative, Skip, others
from validation.cases.program.calculix import PRINTED, PRINTED_ROOT
from validation.context import Context
from validation.exhibits import PATH
from validation.models.legs import filled
from validation.models.mechanism import highest_frequency
from validation.models.parts import parts_of
from validation.solids.bars import bar_solids, with_bars

MODES = 10
_GROUP = "mechanism.calculix"
# Modes of the bodies are kept up to four times the highest frequency of the mechanism: what is
# left out is below the printed digits.
_CUTOFF = 4.0
_CITATION = (
    "CalculiX CrunchiX, C3D10, joints and rigid faces as linear equations, drives as springs; the "
    "same meshes, not reduced"
)


def cases() -> tuple[Case, ...]:
    """Statics and frequencies in the first pose of the path."""
    return (
        Case(
            id="mechanism.calculix.statics",
            title="CalculiX gives the mechanism's 6×6 compliance, legs as solid bars",
            quantity="largest difference in units of √(c_ii c_jj), first pose of the path",
            unit="1",
            reference_kind="independent-solver",
            citation=_CITATION,
            tolerance=Absolute(1e-5),
            tolerance_reason="the same equations: the seven printed digits, with a margin",
            compute=_statics,
            presets=("standard", "fine"),
            model="solid",
            section=PATH,
            group=_GROUP,
            effort=4.0,
        ),
        Case(
            id="mechanism.calculix.frequencies",
            title=f"CalculiX gives the mechanism's first {MODES} frequencies, legs as solid bars",
            quantity="first natural frequency, the others beside it, first pose of the path",
            unit="Hz",
            reference_kind="independent-solver",
            citation=_CITATION,
            tolerance=Relative(1e-5),
            tolerance_reason="the printed digits, and what bodies reduced with modes up to four "
            "times the highest frequency leave",
            compute=_frequency,
            presets=("standard", "fine"),
            model="solid",
            section=PATH,
            group=_GROUP,
            effort=4.0,
        ),
    )


@dataclass(frozen=True, eq=False)
class _Both:
    """Compliance (6×6, SI, base axes) and frequencies (Hz) by this program and by CalculiX."""

    own: Array
    own_frequencies: Array
    theirs: Array
    their_frequencies: Array


def by_both(at: Posture) -> _Both:
    """The mechanism with legs as bars of their outer size, coarse meshes, the same for both.

    Mass is summed over the points that CalculiX sums it over. Raises CalculixMissing.
    """
    calculix_program()
    bars = with_bars(at)
    highest = highest_frequency([bars], MODES)
    solids = bar_solids(bars.mechanism)
    reduced = {solid.leg: _reduced(solid, highest) for solid in solids.values()}
    bodies = {name: reduced[solid.leg] for name, solid in solids.items()}
    solution = solved(assembly(bars.mechanism, bodies).at(bars))
    theirs, frequencies = compliance_and_frequencies(bars, solids, MODES)
    return _Both(compliance(solution), modes(solution, MODES).frequencies, theirs, frequencies)


def _reduced(solid: SolidLeg, highest: float) -> BodyModel:
    held = held_leg(solid_leg_matrices(solid))
    return filled(craig_bampton(held, highest, _CUTOFF * highest).matrices)


def _found(context: Context) -> _Both:
    at = path_postures(context)[0]
    legs = known_legs(at.mechanism).values()
    if parts := parts_of(at.mechanism):
        raise Skip(f"{', '.join(parts)}: CalculiX solves mechanisms of prisms and rigid bodies")
    if not legs or not all(isinstance(leg, ConstantLeg) for leg in legs):
        raise Skip("legs known by a 6×6 have no section that could be meshed")
    try:
        return context.get(by_both, at)
    except CalculixMissing as missing:
        raise Skip(str(missing)) from None


def _statics(context: Context) -> Measurement:
    found = _found(context)
    scale = np.sqrt(np.diag(found.own))
    apart = float(np.abs((found.theirs - found.own) / np.outer(scale, scale)).max())
    return Measurement(apart, 0.0, reference_uncertainty=PRINTED)


def _frequency(context: Context) -> Measurement:
    found = _found(context)
    names = [f"mode {k + 1}" for k in range(len(found.their_frequencies))]
    uncertainty = PRINTED_ROOT * found.their_frequencies
    return Measurement(
        float(found.own_frequencies[0]),
        float(found.their_frequencies[0]),
        reference_uncertainty=float(uncertainty[0]),
        elsewhere=others(names, found.own_frequencies, found.their_frequencies, uncertainty, 0),
        notes=(names[0],),
        table={
            "mode": tuple(float(k) for k in range(1, MODES + 1)),
            "CalculiX (Hz)": tuple(found.their_frequencies.tolist()),
            "reduced bodies (Hz)": tuple(found.own_frequencies.tolist()),
        },
    )
