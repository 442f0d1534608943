"""A mechanism of beams against EXUDYN, a multibody code, in the reference posture and off it."""

import numpy as np

from fem.multibody import ExudynMissing, exudyn_version, frequencies
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.mechanism import Mechanism, Posture
from validation.adequacy.mechanism.path import path_postures
from validation.agreement.convergence import step_factor
from validation.case import Measurement, Relative, Sides, Skip
from validation.case_group import CaseGroup
from validation.cases.mechanism.quantities import ASSEMBLER, MODEL_CODE, by_another_program
from validation.context import Context
from validation.exhibits import PATH
from validation.models.mechanism import PostureAnswer, answers

MODES = 6
# Beams a leg: of second order, so that extrapolated ones are of fourth.
_ELEMENTS = (4, 8, 16)

cases = CaseGroup(
    section=PATH,
    group="mechanism.exudyn",
    effort=1.0,
    model="beam",
    sides=Sides((*MODEL_CODE["beam"], *ASSEMBLER), (frequencies,)),
)


def _places(mechanism: Mechanism) -> list[tuple[str, str]]:
    """Postures to compare in, and what they are called; what does not move has one."""
    places = [("reference", "the reference posture"), ("start", "the first pose of the path")]
    return places if mechanism.tool.moves else places[:1]


def by_both(at: Posture) -> tuple[PostureAnswer, Array, Array]:
    """The program's own beams, and EXUDYN's frequencies (Hz) with their uncertainty, idle ones out.

    What idles stands first there, with the frequency that rounding gives it. Raises ExudynMissing,
    and InputError for what is not written for it.
    """
    (own,) = answers("beam", [at], MODES)
    coarse, middle, fine = (frequencies(at, number, MODES + own.idle) for number in _ELEMENTS)
    extrapolated, before = (
        finer + (finer - coarser) / 3.0 for coarser, finer in ((middle, fine), (coarse, middle))
    )
    uncertain = step_factor(2.0, 4.0) * np.abs(extrapolated - before)
    return own, extrapolated[own.idle :], uncertain[own.idle :]


@cases.case(
    "mechanism.exudyn[{place}]",
    f"EXUDYN gives the first {MODES} frequencies in {{said}}, legs as beams",
    over={"place, said": _places},
    quantity="first natural frequency, the others beside it, {said}",
    unit="Hz",
    reference_kind="independent-solver",
    citation="EXUDYN, geometrically exact beams, generic joints and springs, linearised in the "
    "posture; 8 and 16 beams a leg extrapolated by their second order",
    tolerance=Relative(5e-4),
    tolerance_reason="the step from 4 and 8 beams a leg to 8 and 16 shows what the extrapolated "
    "frequencies leave open, 1e-4 to 3e-4",
)
def _frequency(context: Context, place: str) -> Measurement:
    at = path_postures(context)[0]
    at = reference_posture(at.mechanism) if place == "reference" else at
    try:
        own, theirs, uncertain = context.get(by_both, at)
    except ExudynMissing as missing:
        raise Skip(str(missing)) from None
    except InputError as error:
        raise Skip("; ".join(error.faults)) from None
    headings = "EXUDYN, extrapolated (Hz)", "beam elements (Hz)"
    note = f"mode 1; EXUDYN {exudyn_version()}"
    return by_another_program(own.frequencies, theirs, uncertain, headings, note)
