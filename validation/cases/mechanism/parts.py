"""CAD parts of a mechanism, reduced in two ways: their modes with interfaces held, and free.

Craig and Bampton's modes and MacNeal and Rubin's span different spaces; what each has dropped is
bounded by itself, so that both leave one robot.
"""

from fem.reduction.craig_bampton import reduction
from fem.reduction.free_interface import free_interface
from validation.adequacy.mechanism.parts import bounded_frequencies
from validation.adequacy.mechanism.path import robot_on_path
from validation.case import Measurement, Relative, Sides
from validation.case_group import CaseGroup, numbered
from validation.context import Context
from validation.exhibits import PATH
from validation.models.mechanism import JUDGED_MODES
from validation.parts.meshes import COARSE

cases = CaseGroup(
    reference_kind="independent-solver",
    model="solid",
    section=PATH,
    group="mechanism.parts",
    effort=5.0,
    sides=Sides((free_interface,), (reduction,)),
)


@cases.case(
    "mechanism.parts.frequency[{mode}]",
    "Frequency {mode} with parts by their free modes is that with their held ones",
    over={"index, mode": numbered(JUDGED_MODES)},
    quantity="natural frequency {mode}, middle of the path, coarsest mesh of the parts",
    unit="Hz",
    citation="the same meshes reduced by Craig and Bampton",
    tolerance=Relative(1e-5),
    tolerance_reason="what each reduction may be too high by its own bound says, 3e-7 and less",
)
def _frequency(context: Context, index: int) -> Measurement:
    robot = robot_on_path(context)
    at = robot.postures, robot.offered, robot.holding.first
    free, held = (
        context.get(bounded_frequencies, *at, JUDGED_MODES, COARSE, by) for by in ("free", "fixed")
    )
    return Measurement(
        float(free.upper[index]),
        float(held.upper[index]),
        value_uncertainty=float(free.upper[index] - free.lower[index]),
        reference_uncertainty=float(held.upper[index] - held.lower[index]),
    )
