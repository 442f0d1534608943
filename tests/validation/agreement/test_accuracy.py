"""Meshes refined until they leave little enough open: an error that falls with a known order."""

import pytest

from lumped.errors import InputError
from validation.agreement import accuracy
from validation.agreement.accuracy import Accuracy, refined

LIMIT = 64


def finer(divisions: int, factor: float) -> int:
    """At most twice the divisions of an answer that converges with h²."""
    wanted = min(2 * divisions, int(divisions * factor**0.5) + 1)
    if wanted > LIMIT:
        raise InputError(f"--divisions {wanted}: takes more memory than there is")
    return wanted


def left(divisions: int) -> float:
    return 0.1 / divisions**2


@pytest.mark.parametrize("asked", [0.2, 0.01, 1e-4])
def test_the_first_mesh_that_is_fine_enough_answers(asked: float) -> None:
    found, told = refined(2, lambda one: one, left, finer, asked)
    assert left(found) <= asked
    assert told == Accuracy(asked, left(found))
    assert found == 2 or left(found // 2) > asked


def test_what_memory_does_not_allow_is_missed_with_what_was_reached() -> None:
    found, told = refined(2, lambda one: one, left, finer, 1e-6)
    assert found == LIMIT
    assert told.reached == left(LIMIT)
    assert "takes more memory than there is" in told.missed
    assert told.text.startswith("accuracy ±0.0024 %, asked for ±0.0001 %; --divisions 128")


def test_nothing_is_begun_that_takes_longer_than_one_waits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = iter(range(0, 1000, 90))
    monkeypatch.setattr(accuracy, "perf_counter", lambda: float(next(clock)))
    found, told = refined(2, lambda one: one, left, finer, 1e-6)
    assert found == 2
    assert told.missed == "a finer mesh would take over 600 s"
