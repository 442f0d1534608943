"""Published torsion constants of rectangles, by the series and by finite elements."""

import numpy as np

from fem.sections.section_constants import section_constants
from lumped.arrays import Array
from lumped.sections import Rectangle, rectangle_torsion_constant
from meshes.section.section_mesh import section_mesh
from validation.agreement.convergence import analyse, uncertainty_of
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.benchmarks.beams import SECTION
from validation.context import Context
from validation.solids.legs import FORMAL_ORDER

# J/(b h³) of rectangles b × h.
TORSION_CONSTANTS = {
    1.0: 0.140577,
    1.2: 0.166119,
    1.5: 0.195761,
    2.0: 0.228682,
    2.5: 0.249365,
    3.0: 0.263317,
    4.0: 0.280813,
    5.0: 0.291317,
    10.0: 0.312325,
}
SOURCE = "S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, §109, table of k1, to six digits"
# Multiples of 4, with which every ratio of sides above is met by square elements.
DIVISIONS = (4, 8, 12, 16)


cases = CaseGroup(
    quantity="J/(b h³)",
    unit="1",
    reference_kind="published",
    citation=SOURCE,
    row="b/h = {ratio:g}",
    section=SECTION,
)


@cases.case(
    "benchmark.torsion.series[b/h={ratio:g}]",
    "Torsion constant of a rectangle, b/h = {ratio:g}, by Saint-Venant's series",
    over={"ratio, published": TORSION_CONSTANTS.items()},
    tolerance=Absolute(1e-6),
    tolerance_reason="the last published digit",
    model="series",
    group="benchmark.torsion.series",
)
def _series(_context: Context, ratio: float, published: float) -> Measurement:
    return Measurement(rectangle_torsion_constant(ratio, 1.0) / ratio, published, exact=True)


@cases.case(
    "benchmark.torsion.mesh[b/h={ratio:g}]",
    "Torsion constant of a rectangle, b/h = {ratio:g}, by finite elements",
    over={"ratio, published": TORSION_CONSTANTS.items()},
    tolerance=Absolute(4e-6),
    tolerance_reason="the last published digit, and two and a half times the uncertainty of the "
    "finest mesh, which is 1.2e-6 for a square and less for all others",
    model="mesh",
    group="benchmark.torsion.mesh",
)
def _mesh(context: Context, ratio: float, published: float) -> Measurement:
    found = context.get(torsion_constants, ratio, DIVISIONS) / ratio
    convergence = analyse(1.0 / np.array(DIVISIONS, dtype=float), found, FORMAL_ORDER)
    return Measurement(float(found[-1]), published, value_uncertainty=uncertainty_of(convergence))


def torsion_constants(ratio: float, divisions: tuple[int, ...]) -> Array:
    """J (m⁴) of a rectangle of `ratio` × 1 m on meshes of biquadratic elements."""
    section = Rectangle(ratio, 1.0)
    return np.array(
        [section_constants(section_mesh(section, n), nu=0.0).torsion_constant for n in divisions]
    )
