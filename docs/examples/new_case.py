"""A case of one's own: what is claimed, from which source, how closely and why, and its value.

Run as a script it is tried: its verdict, and that it is able to disagree.
"""

from validation import api
from validation.case import Absolute, Measurement, Relation
from validation.case_group import CaseGroup
from validation.context import Context

stated = CaseGroup(section="My own", reference_kind="paper-statement", citation="Briot et al., §3")
cases = stated.family(tolerance=Absolute(0.5), tolerance_reason="half a unit in the last digit")


@cases.case("mine.f1", "First frequency above 100 Hz", unit="Hz", relation=Relation.AT_LEAST)
def lowest(context: Context) -> Measurement:
    (middle,) = api.solve(context.robot_file, "beam", modes=1).answers
    return Measurement(float(middle.frequencies[0]), 100.0, value_uncertainty=0.01)


if __name__ == "__main__":
    from dataclasses import replace

    from validation.run.outcome import judge

    context = Context(api.load("biglide"))
    for case in cases():
        measured = case.compute(context)
        assert judge(case, measured, seconds=0.0).verdict == "agree"
        claimed_more = replace(measured, reference=140.0)  # the robot has 131.3 Hz
        assert judge(case, claimed_more, seconds=0.0).verdict == "disagree"
