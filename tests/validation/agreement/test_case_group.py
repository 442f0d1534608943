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
    "model": "none",
}


def exact(*values):
    return Measurement(float(sum(values)), 0.0, exact=True)


def test_cases_stand_in_the_order_of_parameters_of_the_group_then_of_declaration():
    """Fields are said by the case, its parameters, its family or the group; the nearest counts."""
    cases = CaseGroup(over={"leg": (1, 2)}, group="all", **COMMON)

    @cases.case(
        "leg{leg}.{model}.{mode}",
        "Leg {leg}: {model}, {size:.1f}",
        over={
            "model, size": [("beam", 1.25), ("rigid", 2.5)],
            "index, mode": lambda model, modes: numbered(modes[model]),
        },
        tolerance=lambda size: Absolute(2.0 * size),
        effort=3.0,
    )
    def named(context, leg, size, index):
        return exact(context, leg, size, 0.01 * index)

    family = cases.family(group="of {leg}")

    @cases.case("leg{leg}.last", "Leg {leg}", unit="{leg} m")
    def last(context):
        return exact(context)

    family.case("leg{leg}.one", "One", over={"model": ("own",)}, model="")(last)
    found = cases(modes={"beam": 2, "rigid": 1})
    names = ("beam.1", "beam.2", "rigid.1", "one", "last")
    assert [case.id for case in found] == [f"leg{leg}.{name}" for leg in (1, 2) for name in names]
    assert [case.title for case in found[1:3]] == ["Leg 1: beam, 1.2", "Leg 1: rigid, 2.5"]
    assert [case.tolerance.amount for case in found[:5]] == [2.5, 2.5, 5.0, 0.5, 0.5]
    assert [case.effort for case in found[2:4]] == [3.0, 0.1]
    assert [case.model for case in found[:5]] == ["beam", "beam", "rigid", "", "none"]
    assert [case.group for case in found[5:]] == [*["all"] * 3, "of 2", "all"]
    assert found[9].unit == "2 m"
    # 100 + leg + size + index; what names no parameter is given none.
    assert [case.compute(100.0).value for case in found[:4]] == [102.25, 102.26, 103.5, 100.0]
    assert found[4].compute is last


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
