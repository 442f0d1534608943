"""The catalogue of faults against adequacy: no faulty model is called adequate in frequencies.

A robot whose segments and beams are adequate meets the faults of masses, elements, modes,
reductions, joints and the robot's assembly. A model whose own frequencies have then left the limits
must not be called adequate in all of them and their order. Where the reference errs alike, in code
that all of them share, the polynomials of `validation.studies.ritz`, which do not share it and
which every run holds the models against, must be off.
"""

import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))

from faulty_robot import LIMIT, faults_met, its_context, robot_of

from lumped.acceptance.requirement import Requirement
from lumped.arrays import Array
from validation.adequacy.biglide.closure import require_closed
from validation.adequacy.biglide.dynamics import biglide_dynamics
from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Coordinate, Matrix
from validation.adequacy.response import Candidate, Reference, Subject, modes_of
from validation.adequacy.subject.dynamics import dynamic_reference
from validation.faults.catalogue import FAULTS
from validation.faults.fault import Fault
from validation.models.options import ModelName, ModelOptions
from validation.studies.paired_robot_modes import sample_weights
from validation.studies.ritz import biglide as ritz

MODELS: tuple[ModelName, ...] = ("segments", "beam")
MODES, POSTURES = 4, 3
SHORT = robot_of(0.48, 0.45, 0.4)
# What runs hold models to against polynomials: a percent for segments.
ANCHORED = 0.01


def solids() -> Reference:
    """What the models are held against."""
    return dynamic_reference(biglide_dynamics(its_context(SHORT), SHORT, MODES, POSTURES))


def frequencies(known: Reference | None = None) -> tuple[dict[str, Array], Matrix]:
    """Frequencies (p×4, Hz, ascending) by model and for "reference", and the matrix.

    `known`: the reference where a fault is known to leave it as it is.
    """
    context, x = its_context(SHORT), SHORT.stations(POSTURES)
    require_closed(SHORT, x)
    reference = known or solids()
    answer = biglide_dynamics(context, SHORT, MODES, POSTURES).answer
    responses = {model: modes_of(partial(answer, model, ModelOptions())) for model in MODELS}
    subject = Subject(
        robot="faulty",
        coordinates=(Coordinate("x", "m"),),
        poses=x[:, None],
        weights=sample_weights(SHORT),
        candidates=[Candidate(name, name, one) for name, one in responses.items()],
        statics=Reference("none", ()),
        dynamics=reference,
    )
    everything = responses | {"reference": reference.alternatives[0].response}
    found = {}
    for name, response in everything.items():
        assert response.vibration is not None, response.unsolved_modes
        found[name] = response.vibration.frequencies[:, :MODES]
    return found, judged(subject, Requirement(frequency=LIMIT, modes=MODES))


def by_polynomials() -> Array:
    """The same without the code of models and reference."""
    return np.array([ritz.frequencies(SHORT, x, MODES) for x in SHORT.stations(POSTURES).tolist()])


def is_off(found: Array, expected: Array, limit: float) -> bool:
    return not np.abs(found / expected - 1.0).max() <= limit


def adequate(matrix: Matrix, model: str) -> bool:
    """Whether the model is called adequate in all frequencies and in their order."""
    judged_of = [one for one in matrix.of_model(model) if one.quantity in matrix.quantities[6:]]
    return {one.verdict for one in judged_of} == {"adequate"}


def called_adequate(fault: Fault, truth: Array, known: Reference | None = None) -> list[str]:
    """Models that a fault spoils and that are called adequate nevertheless."""
    with fault.inject():
        try:
            found, matrix = frequencies(known)
            anchor = by_polynomials()
        except Exception:  # noqa: BLE001  a computation that fails has been noticed
            return []
    spoilt = []
    for model in MODELS:
        wrong = is_off(found[model], truth, 1.2 * LIMIT)
        noticed = is_off(found[model], anchor, 1.2 * ANCHORED)
        if wrong and adequate(matrix, model) and not noticed:
            spoilt.append(f"{fault.id}: {model}")
        if is_off(found["reference"], truth, 1.2 * LIMIT) and not wrong and adequate(matrix, model):
            spoilt.append(f"{fault.id}: reference of {model}")
    return spoilt


@pytest.fixture(scope="module")
def sound() -> Reference:
    return solids()


@pytest.fixture(scope="module")
def truth(sound: Reference) -> Array:
    found, matrix = frequencies(sound)
    assert all(adequate(matrix, model) for model in MODELS)
    assert not is_off(by_polynomials(), found["beam"], 0.1 * ANCHORED)
    return found["reference"]


def named(*ids: str) -> Sequence[Fault]:
    return [fault for fault in FAULTS if fault.id in ids]


def test_faulty_beams_are_not_called_adequate(truth: Array, sound: Reference) -> None:
    (fault,) = named("beam.three-for-twelve")
    with fault.inject():
        found, matrix = frequencies(sound)
    assert is_off(found["beam"], truth, 1.2 * LIMIT)
    assert [model for model in MODELS if adequate(matrix, model)] == ["segments"]
    assert called_adequate(fault, truth, sound) == []


# Of the reference alone, and of what all of them share.
SPOILT = named("element.half-density", "modes.angular-frequency")


@pytest.mark.exhaustive
@pytest.mark.parametrize("fault", SPOILT, ids=lambda fault: fault.id)
def test_no_model_is_called_adequate_beside_a_faulty_reference(fault: Fault, truth: Array) -> None:
    assert called_adequate(fault, truth) == []


@pytest.mark.soak
def test_no_fault_makes_wrong_frequencies_adequate(truth: Array) -> None:
    tried = faults_met(frequencies)
    assert len(tried) > 60
    assert [line for fault in tried for line in called_adequate(fault, truth)] == []
