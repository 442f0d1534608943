"""Pairing by shape at every pose: partners, absence, places in the order, close modes."""

import numpy as np
import pytest

from lumped.acceptance.requirement import Requirement
from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Coordinate, Entry
from validation.adequacy.partners import frequency_changes, partners
from validation.adequacy.response import (
    Alternative,
    Candidate,
    Reference,
    Response,
    Subject,
    Vibration,
)

WEIGHTS = np.ones(4)
AXES = np.eye(4)


def vibration(frequencies: list[float], *shapes: np.ndarray) -> Vibration:
    """One pose; shapes as columns."""
    return Vibration(np.array([frequencies]), np.column_stack(shapes)[None])


TRUTH = vibration([100.0, 150.0, 200.0, 300.0], *AXES)


def entry(
    model: Vibration, quantity: str, *others: Vibration, modes: int = 3, unsure: float = 0.0
) -> Entry:
    """What is said of a model against the truth above and other alternatives, limits 5 %."""
    truths = {f"ends {k}": truth for k, truth in enumerate((TRUTH, *others))}
    reference = Reference(
        "truth",
        [
            Alternative(name, Response(vibration=one), dynamic=np.full((1, 4), unsure))
            for name, one in truths.items()
        ],
        open="how the ends are held" if others else "",
        decides="say how the ends are held" if others else "",
    )
    subject = Subject(
        robot="toy",
        coordinates=(Coordinate("x", "m"),),
        poses=np.array([[0.5]]),
        weights=WEIGHTS,
        candidates=[Candidate("model", "a model", Response(vibration=model))],
        statics=Reference("none", []),
        dynamics=reference,
    )
    return judged(subject, Requirement(modes=modes)).entry("model", quantity)


def test_an_order_on_which_the_alternatives_disagree_is_undecided_and_names_the_modes() -> None:
    # The same robot with other ends: its second and third shape change places.
    swapped = vibration([100.0, 160.0, 190.0, 300.0], AXES[0], AXES[2], AXES[1], AXES[3])
    like_the_first = vibration([101.0, 151.0, 202.0, 303.0], *AXES)
    order = entry(like_the_first, "order", swapped, unsure=0.002)
    assert order.verdict == "undecided"
    # Its third stands where the other ends have 190 Hz, its second for 160: 202/190 misleads most.
    assert order.error == pytest.approx(202.0 / 190.0 - 1.0)
    assert order.uncertainty == pytest.approx(0.002 * 202.0 / 190.0)
    assert order.uncertainties == {"meshes": pytest.approx(order.uncertainty)}
    assert (order.value, order.expected) == pytest.approx((202.0, 190.0))
    assert order.reason == (
        "with ends 0, every mode is in its place; "
        "with ends 1, f2 is the model's f3, f3 is the model's f2; "
        "say how the ends are held"
    )


def test_modes_that_a_model_or_a_pose_does_not_have() -> None:
    fewer = vibration([100.0, 200.0], AXES[0], AXES[2])
    missing = entry(fewer, "f2")
    assert (missing.verdict, missing.error) == ("inadequate", None)
    assert "no mode of this shape" in missing.reason
    absent = vibration([100.0, np.nan], AXES[0], np.zeros(4))
    assert [entry(absent, name).verdict for name in ("f1", "f2")] == ["adequate", "inadequate"]


def test_close_modes_mix_and_count_as_the_space_they_span() -> None:
    turn = np.sqrt(0.5)
    close = vibration([100.0, 102.0, 200.0], AXES[0], AXES[1], AXES[2])
    mixed = vibration(
        [100.0, 102.0, 200.0], turn * (AXES[0] + AXES[1]), turn * (AXES[0] - AXES[1]), AXES[2]
    )
    found = partners(close, mixed, WEIGHTS, 3)
    assert found.likeness[0] == pytest.approx(1.0)
    assert found.frequency[0] == pytest.approx([100.0, 102.0, 200.0])
    assert found.number[0].tolist() == [0, 1, 2]


def changes(coarse: Vibration) -> list[float]:
    """Of the first three modes of three close ones and one apart."""
    fine = vibration([100.0, 102.0, 104.0, 200.0], *AXES)
    return frequency_changes(fine, coarse, WEIGHTS, 3)[0].tolist()


def test_a_mode_has_the_change_of_its_own_shape_where_close_modes_change_places() -> None:
    # By number it would be 2 % of each: the one that alone has changed comes from 4 % above.
    swapped = vibration([100.0, 104.0, 106.08, 200.0], AXES[0], AXES[2], AXES[1], AXES[3])
    assert changes(swapped) == pytest.approx([0.0, 0.04, 0.0])


def test_close_modes_that_mix_have_the_sum_of_their_changes() -> None:
    turn = np.sqrt(0.5)
    mixed = vibration(
        [101.0, 103.02, 104.0, 200.0],
        turn * (AXES[0] + AXES[1]),
        turn * (AXES[0] - AXES[1]),
        AXES[2],
        AXES[3],
    )
    # The third one of the same family looks like its partner alone.
    assert changes(mixed) == pytest.approx([0.02, 0.02, 0.0])


def test_the_change_of_a_mode_that_the_coarse_mesh_does_not_have_is_unknown() -> None:
    assert changes(vibration([100.0, 104.0], AXES[0], AXES[2])) == pytest.approx(
        [0.0, np.nan, 0.0], nan_ok=True
    )


@pytest.mark.parametrize(("common", "number"), [(0.4, -1), (0.6, 0)])
def test_a_mode_with_less_than_half_in_common_is_another_one(common: float, number: int) -> None:
    reference = vibration([100.0, 150.0, 200.0], *AXES[:3])
    model = vibration([100.0], np.sqrt(common) * AXES[0] + np.sqrt(1.0 - common) * AXES[3])
    found = partners(reference, model, WEIGHTS, 1)
    assert found.number.tolist() == [[number]]
    assert found.likeness[0, 0] == pytest.approx(common)


def test_close_modes_of_one_side_span_what_is_apart_on_the_other() -> None:
    """A pair that mixes evenly where it is close, one tenth and more apart where it does not."""
    mixed = np.array([AXES[0] + AXES[1], AXES[0] - AXES[1]]) / np.sqrt(2.0)
    close = vibration([100.0, 102.0, 300.0], *mixed, AXES[2])
    apart = vibration([100.0, 130.0, 300.0], AXES[0], AXES[1], AXES[2])
    for one, other in ((close, apart), (apart, close)):
        assert partners(one, other, WEIGHTS, 2).likeness == pytest.approx(1.0)


def test_the_reference_that_is_told_goes_with_the_mean_error() -> None:
    """Of two readings of the reference, 100 and 104 Hz."""
    model = vibration([101.0, 150.0, 200.0, 300.0], *AXES)
    told = entry(model, "f1", vibration([104.0, 150.0, 200.0, 300.0], *AXES))
    mean = np.mean([101.0 / 100.0 - 1.0, 101.0 / 104.0 - 1.0])
    assert told.value == pytest.approx(101.0)
    assert told.value / told.expected - 1.0 == pytest.approx(mean, rel=1e-12)
