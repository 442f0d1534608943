"""Cases on modes of a mechanism with CAD parts, by two different reductions of the parts.

Input: a mechanism with CAD parts on their coarsest mesh. Output: verdicts on its first frequencies.
Rule: modes with fixed interfaces (Craig, Bampton) and with free interfaces (MacNeal, Rubin) span
different spaces, so that equal frequencies confirm both. Each reduction bounds its own error.
"""

from lumped.mechanism.mechanism import Mechanism
from validation.case import Measurement, Relative
from validation.case_group import CaseGroup, numbered
from validation.context import Context
from validation.models.robot_models import (
    JUDGED_MODES,
)
from validation.parts.meshes import COARSE
from validation.references.reference_parts import bounded_frequencies
from validation.references.robot_on_path import (
    robot_on_path,
)
from validation.studies_and_figures import PATH

cases = CaseGroup(
    reference_kind="independent-solver", model="solid", section=PATH, unit="Hz", effort=5.0
)


def _judged_modes(mechanism: Mechanism) -> tuple[tuple[int, int], ...]:
    return numbered(JUDGED_MODES) if mechanism.parts else ()


@cases.case(
    "mechanism.parts.frequency[{mode}]",
    "Robot with CAD parts: frequency {mode} by free-interface modes equals that by "
    "fixed-interface modes",
    over={"index, mode": _judged_modes},
    quantity="natural frequency {mode}, middle of the path, coarsest mesh of the parts",
    citation="the same meshes, reduced by Craig and Bampton's method",
    group="mechanism.parts",
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
