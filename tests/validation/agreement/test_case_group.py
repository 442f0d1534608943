"""Declared cases: order, parameters, templates, and what is said of a wrong declaration."""

import pytest

from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup, numbered

COMMON = {
    "quantity": "a number",
    "unit": "1",
    "reference_kind": "closed-form",
    "citation": "by hand",
    "tolerance": Absolute(0.5),
    "tolerance_reason": "a count",
}


def exact(*values):
    return Measurement(float(sum(values)), 0.0, exact=True)


def test_cases_stand_in_the_order_of_parameters_of_the_group_then_of_declaration():
    cases = CaseGroup(over={"leg": (1, 2)}, **COMMON)

    @cases.case(
        "leg{leg}.{name}",
        "Leg {leg}: {name}, {size:.1f}",
        over={"name, size": [("a", 1.25), ("b", 2.5)]},
        tolerance=lambda size: Absolute(2.0 * size),
        effort=3.0,
    )
    def named(context, leg, size):
        return exact(context, leg, size)

    @cases.case("leg{leg}.last", "Leg {leg}", unit="{leg} m")
    def last(context):
        return exact(context)

    found = cases()
    assert [case.id for case in found] == [
        *("leg1.a", "leg1.b", "leg1.last"),
        *("leg2.a", "leg2.b", "leg2.last"),
    ]
    assert [case.title for case in found[:2]] == ["Leg 1: a, 1.2", "Leg 1: b, 2.5"]
    assert [case.tolerance for case in found[:3]] == [Absolute(a) for a in (2.5, 5.0, 0.5)]
    assert [case.effort for case in found[1:3]] == [3.0, 0.1]
    assert found[5].unit == "2 m"
    # 100 + leg + size; what names no parameter is given none.
    assert [case.compute(100.0).value for case in found] == [
        *(102.25, 103.5, 100.0),
        *(103.25, 104.5, 100.0),
    ]
    assert found[2].compute is last


def test_parameters_may_follow_from_others_and_from_what_a_robot_file_gives():
    cases = CaseGroup(**COMMON)

    @cases.case(
        "{model}.{mode}",
        "{model}",
        over={
            "model": ("beam", "rigid"),
            "index, mode": lambda model, modes: numbered(modes[model]),
        },
    )
    def one(context, index):
        return exact(context, index)

    found = cases(modes={"beam": 2, "rigid": 1})
    assert [case.id for case in found] == ["beam.1", "beam.2", "rigid.1"]
    assert [case.compute(10.0).value for case in found] == [10.0, 11.0, 10.0]


def test_a_parameter_with_the_name_of_a_field_is_that_field():
    cases = CaseGroup(section="Robot", model="none", **COMMON)
    rows = [("beam", Absolute(1.0)), ("solid", Absolute(2.0))]
    cases.case("{model}", "One", over={"model, tolerance": rows})(exact)
    cases.case("own.{model}", "Two", over={"model, tolerance": rows}, model="")(exact)
    found = cases()
    assert [case.model for case in found] == ["beam", "solid", "", ""]
    assert [case.tolerance.amount for case in found] == [1.0, 2.0, 1.0, 2.0]


def test_a_family_stands_in_its_place_and_changes_what_is_in_common():
    cases = CaseGroup(section="Robot", group="all", **COMMON)
    cases.case("first", "First")(exact)
    family = cases.family(over={"name": "ab"}, group="of {name}")
    cases.case("last", "Last")(exact)
    family.case("{name}.one", "One")(exact)
    family.case("{name}.two", "Two", over={"at": (1, 2)}, unit="m{at}")(exact)
    found = cases()
    assert [case.id for case in found] == [
        "first",
        *("a.one", "a.two", "a.two", "b.one", "b.two", "b.two"),
        "last",
    ]
    assert [case.group for case in found] == ["all", *["of a"] * 3, *["of b"] * 3, "all"]
    assert {case.section for case in found} == {"Robot"}
    assert [case.unit for case in found[2:4]] == ["m1", "m2"]


@pytest.mark.parametrize(
    ("declaration", "fault"),
    [
        ({"compute": lambda _context, lenght: exact(lenght)}, TypeError),
        ({"title": "{lenght}"}, KeyError),
        ({"quantity": ""}, ValueError),
        ({"effrot": 1.0}, TypeError),
    ],
)
def test_a_wrong_declaration_is_an_error_when_cases_are_listed(declaration, fault):
    cases = CaseGroup(over={"length": (1, 2)}, **COMMON)
    own = {"title": "One", "compute": exact, **declaration}
    compute = own.pop("compute")
    cases.case("{length}", **own)(compute)
    with pytest.raises(fault):
        cases()


def test_without_parameters_braces_are_braces_and_the_title_is_the_quantity():
    cases = CaseGroup(**{name: field for name, field in COMMON.items() if name != "quantity"})
    cases.case("one", "Legs of {a}")(exact)
    cases.case("two", "Number of feet", quantity="feet")(exact)
    assert [case.quantity for case in cases()] == ["Legs of {a}", "feet"]
