"""A case of one's own: what is claimed, from which source, how closely and why, and its value.

Run as a script it is tried: its verdict, and that it is able to disagree.
"""

from validation.adequacy.mechanism.path import path_postures
from validation.case import Absolute, Measurement, Relation
from validation.case_group import CaseGroup
from validation.context import Context
from validation.models.mechanism import answers

stated = CaseGroup(section="My own", reference_kind="paper-statement", citation="Briot et al., §3")
cases = stated.like(tolerance=Absolute(0.5), tolerance_reason="half a unit in the last digit")


@cases.case("mine.f1", "First frequencies above 100 Hz", unit="Hz", relation=Relation.AT_LEAST)
def lowest(context: Context) -> Measurement:
    found = answers("beam", path_postures(context), 1)
    first = min(float(answer.frequencies[0]) for answer in found)
    return Measurement(first, 100.0, value_uncertainty=0.01)  # of twenty elements


if __name__ == "__main__":
    from lumped.robot_file import load_robot
    from validation.results.outcome import judge, perturbed

    context = Context(load_robot("ifw"))
    for case in cases():
        outcome = judge(case, case.compute(context), seconds=0.0)
        assert outcome.verdict == "agree"
        assert perturbed(outcome, factor=30.0) == "disagree"  # 111.3 Hz are 22 tolerances above
