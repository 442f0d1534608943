"""What both sides of a comparison rest on, and how that is found out."""

from lumped.robot_file import load_robot
from validation.case import Absolute, Case, Measurement
from validation.catalogue import catalogue
from validation.context import Context
from validation.independence import as_text, headlines, independence
from validation.models.legs import leg_compliance
from validation.models.options import ModelOptions
from validation.studies.quantities import LOAD

ROBOT_FILE = load_robot("ifw")
CASES = [task for task in catalogue(ROBOT_FILE) if isinstance(task, Case)]


def of(*patterns):
    cases = [case for case in headlines(CASES) if case.id in patterns]
    assert len(cases) == len(patterns)
    return independence(cases, ROBOT_FILE, "quick")


def modules(functions):
    return {one.partition(":")[0] for one in functions}


def test_a_solid_leg_and_beam_theory_with_held_faces_rest_on_other_code():
    (found,) = of("leg1.compliance.solid[c44]")
    assert "fem.bodies.doubling" in modules(found.value)
    assert "fem.couplings.end_effects" not in modules(found.value)
    assert {"fem.couplings.end_effects", "fem.sections.section_constants"} <= modules(
        found.reference
    )
    assert "fem.bodies.doubling" not in modules(found.reference)
    # Saint-Venant's tractions define the ends of one and the constants of the other.
    assert modules(found.shared) <= {
        "fem.sections.saint_venant",
        "fem.sections.section_constants",
        "fem.couplings.end_coupling",
    }


def test_segments_are_no_beams():
    (found,) = of("leg1.compliance.segments[c33]")
    assert found.shared == frozenset()


def own_by_itself(context: Context) -> Measurement:
    leg = context.robot.leg1
    one = context.get(leg_compliance, "beam", leg, ModelOptions())
    other = context.get(leg_compliance, "beam", leg, ModelOptions(elements=10))
    return Measurement(float(one[2, 2] * LOAD), float(other[2, 2] * LOAD), exact=True)


def test_a_comparison_of_a_thing_with_itself_is_told():
    case = Case(
        "leg1.compliance.itself", "a beam beside itself", "c33", "m", "finer-model", "made up",
        Absolute(1.0), "made up", own_by_itself,
    )  # fmt: skip
    (found,) = independence([case], ROBOT_FILE, "quick")
    assert "fem.beams.beam" in modules(found.shared)
    assert found.value == found.reference
    text = as_text([found])
    assert "both rest on" in text
    assert "fem.beams.beam:beam_leg" in text


def test_headlines_are_the_robot_and_its_legs():
    ids = [case.id for case in headlines(CASES)]
    assert len(ids) > 60
    assert not any(name.startswith(("guard.", "benchmark.", "paper.")) for name in ids)
