"""Cases that check a robot against computations that share no code with the judged models.

Input: the mechanism of a run. Output: cases on each leg alone (3-D solid against beam theory), on
two reductions of CAD parts, and on the robot against CalculiX, EXUDYN and Ritz's method with
polynomials.
"""

from lumped.mechanism.mechanism import Mechanism
from validation.case import Case
from validation.cases import leg_theory, other_solvers, polynomials
from validation.references.robot_on_path import prismatic_legs


def cases(mechanism: Mechanism, mode_count: int) -> tuple[Case, ...]:
    """All cases in the order of the report. Equal legs have one set of cases.

    `mode_count` is the number of judged natural frequencies.
    """
    return (
        *leg_theory.cases(legs=prismatic_legs(mechanism)),
        *other_solvers.cases(mechanism=mechanism),
        *polynomials.cases(mechanism=mechanism, modes=mode_count),
    )
