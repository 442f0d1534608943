"""Declarations of the cases that compare models with solids, for single legs and the robot.

Input: a `CaseGroup` for a leg or for the robot. Output: decorators of a function that compares a
model with a solid. They declare one case for each model and motion of the tip or tool, or one for
each model and mode. The names of the causes of a difference are defined here for all cases.
"""

from collections.abc import Callable, Iterable
from typing import Unpack

from lumped.acceptance.quantities import AXIS_LABELS, DIAGONAL_UNITS
from validation.case import Allowance, Relative
from validation.case_group import CaseFields, CaseGroup, Compute, Over, numbered
from validation.comparisons.element_convergence import MODES
from validation.models.options import OF_ELEMENTS, STATIC, ModelName
from validation.studies_and_figures import AGREEMENT

# Named causes of a difference, for which allowances are made.
HELD_FACES = "held end faces"
DISTORTION = "distortion of the section"
FORMULA = "section constants by formula"
FORMULA_SOURCE = "finite elements on the section, within the known error of textbook formulas"
# Index on the diagonal of the tip compliance, and unit, of the tip motion under each unit load.
MOTIONS = {
    AXIS_LABELS[name]: (entry, unit) for entry, (name, unit) in enumerate(DIAGONAL_UNITS.items())
}
# Models that are compared with solids: in statics those of both lists, in frequencies the latter.
STATIC_MODELS: tuple[ModelName, ...] = (*STATIC, *OF_ELEMENTS)
DYNAMIC_MODELS: tuple[ModelName, ...] = OF_ELEMENTS


def agreement_group(*, over: Over | None = None, **fields: Unpack[CaseFields]) -> CaseGroup:
    """Group of cases that compare models with solids, with these `fields` in common.

    Each case is repeated for the parameter values in `over` (see `CaseGroup`).
    """
    common: CaseFields = {
        "kind": "agreement",
        "reference_kind": "independent-solver",
        "section": AGREEMENT,
        "elements": lambda model, limits: limits.elements if model in DYNAMIC_MODELS else 0,
        **fields,
    }
    return CaseGroup(over=over, **common)


def compliance_cases(
    cases: CaseGroup, identifier: str, heading: str, solid: str, **fields: Unpack[CaseFields]
) -> Callable[[Compute], Compute]:
    """Decorator that declares cases in the group `cases`: one for each static model and motion.

    `identifier` names the leg or robot in the id of each case, and `heading` names it in the title.
    `solid` names the reference in the title. `fields` are further fields of the cases.
    """
    common: CaseFields = {
        "label": "{motion}",
        "tolerance": lambda limits: Relative(limits.compliance),
        "tolerance_reason": (
            "[agree] compliance (default 0.1 %): in statics beam theory is exact after "
            "subtraction of its named differences from the solid"
        ),
        **fields,
    }
    motions = [(name, *entry_and_unit) for name, entry_and_unit in MOTIONS.items()]
    return cases.case(
        f"{identifier}.agrees[{{model}}-solid-{{motion}}]",
        f"{heading}: compliance {{motion}} by {{model}} equals {solid}",
        over={"model": STATIC_MODELS, "motion, entry, unit": motions},
        **common,
    )


def frequency_cases(
    cases: CaseGroup, identifier: str, heading: str, solid: str, **fields: Unpack[CaseFields]
) -> Callable[[Compute], Compute]:
    """Decorator that declares cases in the group `cases`: one for each dynamic model and mode.

    The arguments are those of `compliance_cases`.
    """
    common: CaseFields = {
        "label": "f{mode}",
        "unit": "Hz",
        "tolerance": lambda limits: Relative(limits.frequency),
        "tolerance_reason": "[agree] frequency (default 1 %), the accuracy of 20 elements per leg",
        **fields,
    }
    return cases.case(
        f"{identifier}.agrees[{{model}}-solid-f{{mode}}]",
        f"{heading}: f{{mode}} by {{model}} equals {solid}",
        over={"model": DYNAMIC_MODELS, "index, mode": numbered(MODES)},
        **common,
    )


def formula_allowance(
    theory: float, computed: float, band: Iterable[float], half_width: float
) -> Allowance:
    """Allowance for section constants by formula, at most the known error of correct formulas.

    `theory` is the result of the beam with constants by formula, `computed` that with constants by
    finite elements, of this `half_width`. `band`: results of the softest and the stiffest beam that
    correct formulas allow, in any order. Without this bound, any error of the beam's own constants
    would be explained.
    """
    first, second = (float(bound - computed) for bound in band)
    return Allowance(
        FORMULA, limited(float(theory - computed), (first, second), half_width), FORMULA_SOURCE
    )


def limited(difference: float, band: tuple[float, float], uncertainty: float) -> float:
    """Part of a `difference` between two models that a named cause can explain.

    `band` contains the differences that the cause can make. The result is the number nearest to
    `difference` in this band, after the band is extended to include zero and then widened by
    `uncertainty` on both sides.
    """
    low, high = min(0.0, *band) - uncertainty, max(0.0, *band) + uncertainty
    return min(max(difference, low), high)
