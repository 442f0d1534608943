"""What both sides of a comparison rest on, and how that is found out."""

import pytest

from lumped.robot_file import load_robot
from validation.adequacy.robot import judged_models
from validation.case import Absolute, Case, Measurement
from validation.cases.anchors import independence as check
from validation.catalogue import catalogue
from validation.context import Context
from validation.independence.headlines import HeadlineNumber, headline_numbers
from validation.independence.listing import NOTHING, as_text, rows, without
from validation.independence.trace import independence
from validation.models.legs import leg_compliance
from validation.models.options import ModelOptions
from validation.studies.quantities import LOAD

ROBOT_FILE = load_robot("ifw")
CASES = [task for task in catalogue(ROBOT_FILE) if isinstance(task, Case)]


def of(*patterns):
    cases = [case for case in CASES if case.id in patterns]
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
        Absolute(1.0), "made up", own_by_itself, headlines=("itself",),
    )  # fmt: skip
    (found,) = independence([case], ROBOT_FILE, "quick")
    assert "fem.beams.beam" in modules(found.shared)
    assert found.value == found.reference
    assert not found.independent
    number = HeadlineNumber("itself", "made up", "a beam beside itself")
    text = as_text(rows([number], [found]), without([number], [found]))
    assert "– leg1.compliance.itself" in text
    assert "both rest on        fem.beams.beam" in text
    assert "without an independent comparison: a beam beside itself (made up)" in text


def test_polynomials_share_nothing_with_the_models_of_the_first_screen():
    found = of("robot.anchor.statics[beam, z]", "robot.anchor.frequencies[segments, 1]")
    for one in found:
        assert one.independent
        assert "lumped.system.assembly" in modules(one.value)
        assert "validation.studies.ritz.biglide" in modules(one.reference)


@pytest.mark.parametrize("name", ["ifw", "biglide", "five-bar", "delta"])
def test_every_number_of_the_first_screen_is_a_headline_number(name):
    """Models and quantities of the matrix, of the robot and of its legs, and both references."""
    robot_file = load_robot(name)
    numbers = headline_numbers(robot_file)
    static = {one.model for one in numbers if one.static and "alone" not in one.shown}
    dynamic = {one.model for one in numbers if not one.static}
    judged = set(judged_models(robot_file))
    assert judged <= static
    without_mass = {"vjm", "vjm-equivalent", "links"}
    assert judged - without_mass <= dynamic
    assert sum("reference" in one.number and "alone" not in one.shown for one in numbers) >= 2
    cases = [task for task in catalogue(robot_file) if isinstance(task, Case)]
    for number in numbers:
        if number.shown != "paper's table":
            assert any(number.is_compared_by(case) for case in cases), number.number


# A biglide's numbers are many: a quarter of a minute.
MANY = {"guard.independence[biglide]": pytest.mark.exhaustive}


@pytest.mark.parametrize(
    "case",
    [pytest.param(case, id=case.id, marks=MANY.get(case.id, ())) for case in check.cases()],
)
def test_no_headline_number_is_without_an_independent_comparison(case):
    measured = case.measure(Context(ROBOT_FILE, "quick"))
    assert measured.value == 0.0, measured.notes
    shared = measured.table["both rest on"]
    assert shared.count(NOTHING) > 10
    assert len(shared) == len(measured.table["number"])
