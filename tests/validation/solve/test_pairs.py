"""Printed partners of a model's modes in another model."""

from dataclasses import replace

import numpy as np
import pytest

from lumped.robot_file import load_robot
from validation.record_fields import plain_data
from validation.solve import solved_model
from validation.solve.answer_json import answer_record
from validation.solve.answer_text import as_text
from validation.solve.model_answers import solve
from validation.solve.question import Question


@pytest.mark.parametrize(
    ("share", "line"),
    [
        (1.0, "mode 2, {second:.5g} Hz, MAC 1.0000"),
        (
            0.07,
            "none, a local mode of the section (7 % of its kinetic energy in rigid motion of",
        ),
        (
            0.4,
            "none, a local mode of the section (40 % of its kinetic energy in rigid motion of",
        ),
    ],
)
def test_missing_partner_has_reason(monkeypatch, share, line):
    """Made-up data: a part `share` of mode 2's kinetic energy is in the compared points."""
    sampled, of_models = solved_model.vibration_of, []

    def second_seen(*arguments):
        of_models.append(sampled(*arguments))
        if len(of_models) > 1:
            return of_models[1]
        shares = of_models[0].energy_shares.copy()
        shares[:, 1] = share
        return replace(of_models[0], energy_shares=shares)

    monkeypatch.setattr(solved_model, "vibration_of", second_seen)
    solution = solve(Question(load_robot("five-bar"), "beam", {}, 3, against="beam"))
    (answer,) = solution.answers
    second = answer.paired.pairs[1]
    assert second.mac == pytest.approx(share)
    assert (second.partner is None) == second.local == (share < 0.5)
    assert np.isfinite([pair.frequency or 0.0 for pair in answer.paired.pairs]).all()
    names = ["mode", "partner", "frequency", "mac", "seen", "local", "open", "undecided"]
    assert list(plain_data(answer_record(answer))["partners"]["pairs"][1]) == names
    assert f"    2: {line.format(second=answer.frequencies[1])}" in as_text(solution)
