"""The catalogue of faults against adequacy: no faulty model is called adequate in statics.

A robot whose models are all adequate meets the faults of legs, sections and virtual joints, of beam
and solid elements, their meshes and ends, of joints, transports and the robot's assembly, and of
what they all share: postures and screws. A model whose own answer has then left the limits must not
be called adequate, unless models and reference err alike in code that they share; there the virtual
joints, which do not share it, must be called inadequate. Postures are drawn once more from points
alone before anything is judged.
"""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))

from faulty_robot import LIMIT, ROBOT, faults_met, its_context
from plain_displacement import plain_errors

from lumped.acceptance.requirement import STATIC_QUANTITIES, Requirement
from lumped.arrays import Array
from lumped.errors import ComputationError
from validation.adequacy.biglide.statics import biglide_statics
from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Coordinate, Matrix
from validation.adequacy.response import Candidate, Reference, Response, Subject
from validation.adequacy.subject.statics import static_reference
from validation.faults.catalogue import FAULTS
from validation.faults.fault import Fault
from validation.models.options import ModelName, ModelOptions

MODELS: tuple[ModelName, ...] = ("vjm", "segments", "beam")


def statics() -> tuple[dict[str, Array], Matrix]:
    """Compliances (p×6×6) by model and for "reference", and the matrix."""
    x = ROBOT.stations(5)
    robot = biglide_statics(its_context(ROBOT), ROBOT, x)
    reference = static_reference(robot)
    responses = {model: Response(robot.answer(model, ModelOptions())) for model in MODELS}
    subject = Subject(
        robot="faulty",
        coordinates=(Coordinate("x", "m"),),
        poses=x[:, None],
        weights=np.zeros(0),
        candidates=[Candidate(name, name, one) for name, one in responses.items()],
        statics=reference,
        dynamics=Reference("none", ()),
    )
    everything = responses | {"reference": reference.alternatives[0].response}
    found = {}
    for name, response in everything.items():
        assert response.compliance is not None
        found[name] = response.compliance
    return found, judged(subject, Requirement(deflection=LIMIT))


def called_adequate(fault: Fault, truth: Array) -> list[str]:
    """Entries that a fault spoils and that are called adequate nevertheless."""
    with fault.inject():
        try:
            found, matrix = statics()
        except Exception:  # noqa: BLE001  a computation that fails has been noticed
            return []
    wrong = {
        name: {
            quantity: errors.max() > 1.2 * LIMIT
            for quantity, errors in plain_errors(compliances, truth).items()
        }
        for name, compliances in found.items()
    }
    spoilt = []
    for quantity in STATIC_QUANTITIES:
        verdicts = {
            entry.model: entry.verdict for entry in matrix.entries if entry.quantity == quantity
        }
        shared = wrong["reference"][quantity]
        if shared and verdicts["vjm"] == "adequate":
            spoilt.append(f"{fault.id}: reference and virtual joints, {quantity}")
        spoilt += [
            f"{fault.id}: {model}, {quantity}"
            for model in MODELS
            if wrong[model][quantity] and not shared and verdicts[model] == "adequate"
        ]
    return spoilt


@pytest.fixture(scope="module")
def truth() -> Array:
    found, matrix = statics()
    assert {entry.verdict for entry in matrix.entries} == {"adequate"}
    return found["reference"]


def test_a_fault_in_the_virtual_joints_makes_them_inadequate(truth: Array) -> None:
    fault = next(one for one in FAULTS if one.where.startswith("lumped.models.vjm"))
    assert called_adequate(fault, truth) == []


SHARED = [
    f for f in FAULTS if f.where in ("lumped.biglide.Biglide.posture", "lumped.screws.rotation_z")
]


@pytest.mark.parametrize("fault", SHARED, ids=lambda fault: fault.id)
def test_a_fault_in_the_postures_that_all_models_share_is_named(fault: Fault) -> None:
    with fault.inject(), pytest.raises(ComputationError, match=r"the posture of leg \d is wrong"):
        statics()


@pytest.mark.soak
def test_no_fault_makes_a_wrong_model_adequate(truth: Array) -> None:
    tried = faults_met(statics)
    assert len(tried) > 100
    assert [line for fault in tried for line in called_adequate(fault, truth)] == []
