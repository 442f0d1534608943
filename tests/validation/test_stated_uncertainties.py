"""Every comparison of a catalogue states its uncertainty, or is exact, and is decided."""

from math import isfinite

import pytest

from lumped.errors import ComputationError
from lumped.robot_file import load_robot
from validation.case import Case, Measurement, Skip, judge
from validation.catalogue import catalogue
from validation.context import Context
from validation.solids.legs import edge_order

# The sweeps of the decision, which take their uncertainties from two meshes of the judge.
LEFT_OUT = ("decision.", "family.", "paper.decision.")


# A minute and a half; those of the paper's robot are the business of test_cases.
@pytest.mark.soak
def test_every_case_states_an_uncertainty_or_is_exact():
    context = Context(load_robot("biglide"), "quick")
    cases = [
        task
        for task in catalogue(context.robot_file)
        if isinstance(task, Case) and "quick" in task.presets
    ]
    found: dict[str, Measurement] = {}
    for case in cases:
        if case.id.startswith(LEFT_OUT):
            continue
        try:
            found[case.id] = case.measure(context)
        except (Skip, ComputationError):
            continue
        assert judge(case, found[case.id], 0.0).verdict == "agree", case.id
    exact = [name for name, measured in found.items() if measured.exact]
    uncertain = {n: m for n, m in found.items() if not m.exact}
    assert len(found) > 200
    # What has elements, meshes, samples or orders: more than half of what says something.
    assert len(uncertain) > 100
    for measured in uncertain.values():
        assert measured.numerical_uncertainty is not None
        assert isfinite(measured.numerical_uncertainty)
    solids = [n for n in exact if "solid" in n and "reduction" not in n and "element" not in n]
    # One mesh on both sides, or an identity of energies: nothing of a mesh is left to be uncertain.
    assert set(solids) <= {"robot.solid.sixty.energy"}


def test_orders_of_edges_are_williams():
    # M. L. Williams (1952), clamped and free sides at 90°, ν = 0.3: λ = 0.711.
    assert edge_order(0.3) == pytest.approx(2.0 * 0.711, abs=2e-3)
    assert edge_order(0.0) == 4.0
    orders = [edge_order(nu) for nu in (0.01, 0.1, 0.2, 0.3, 0.4)]
    assert orders == sorted(orders, reverse=True)
    assert orders[0] == pytest.approx(2.0, abs=0.05)
