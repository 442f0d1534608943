"""Tables by name have a row for each name, and a new model needs a row in two of them.

A name without a row would be found only by the run that needs the row.
"""

from dataclasses import fields, replace
from typing import get_args

import numpy as np
import pytest
from support.robots.paper_robot_variants import placed_at

from fem.beams.beam import beam_leg
from lumped.acceptance import quantities
from lumped.acceptance.requirement import MODEL_KINDS
from lumped.robot_file import load_robot
from validation.adequacy.judged_models import JUDGED, JudgedModel, judged_model
from validation.comparisons.convergence_series import SeriesRecord
from validation.comparisons.discretisations import PARAMETERS, Discretisation
from validation.context import Context
from validation.export.command import FORMATS, Kind
from validation.export.formats import OF_BODIES, OF_ROBOTS
from validation.models import leg_models
from validation.models.options import (
    MODELS,
    OF_ELEMENTS,
    ModelName,
    ModelOptions,
)
from validation.models.robot_models import answers
from validation.references.modal_reference import all_modal_steps
from validation.references.model_ladder import EQUIVALENT
from validation.references.responses import Responses
from validation.references.robot_on_path import NOMINAL, robot_at
from validation.references.static_reference import all_static_steps

EULER = ModelOptions(theory="euler-bernoulli")


def test_each_name_has_its_row():
    assert set(quantities._KINDS) == set(quantities.QuantityKind)
    assert set(MODELS) == set(get_args(ModelName))
    assert set(leg_models.ELEMENTS) == set(OF_ELEMENTS)
    assert all(MODELS[model].order for model in OF_ELEMENTS)
    assert set(JUDGED) == set(MODEL_KINDS)
    assert set(FORMATS) == set(get_args(Kind)) == {*OF_BODIES, *OF_ROBOTS}


@pytest.mark.parametrize("name", JUDGED)
def test_steps_of_judged_model_have_texts(name):
    assert set(JUDGED[name].static_steps) <= set(all_static_steps("vjm", EQUIVALENT))
    assert set(JUDGED[name].modal_steps) <= set(all_modal_steps(EQUIVALENT, EQUIVALENT))


def test_parameters_are_fields_of_formulation_and_json():
    formulation_fields = {field.name for field in fields(Discretisation)}
    assert set(PARAMETERS) <= formulation_fields & set(SeriesRecord.__struct_fields__)
    solid, beam = Discretisation("solid"), Discretisation("beam")
    assert replace(solid, divisions=7) == solid.with_count(7) != solid
    assert replace(beam, elements=7) == beam.with_count(7) != beam


def test_model_with_own_leg_matrices_is_solved_and_judged(monkeypatch):
    """A model without shear, given by its leg matrices alone, equals beams without shear."""

    def leg_without_shear(leg, options):
        return beam_leg(leg.properties("euler-bernoulli"), leg.length, options.elements)

    def piece(properties, length, options):
        return beam_leg(properties.as_euler_bernoulli(), length, options.elements)

    matrices = leg_models.ElementMatrices(leg_without_shear, piece)
    monkeypatch.setattr(leg_models, "ELEMENTS", leg_models.ELEMENTS | {"slender": matrices})
    ifw = load_robot("ifw")
    postures = placed_at(ifw.mechanism, 0.4)
    own, beam = (
        answers(*model) for model in (("slender", postures, 2), ("beam", postures, 2, EULER))
    )
    assert np.allclose(own.frequencies, beam.frequencies, rtol=1e-12)
    responses = Responses(robot_at(Context(ifw, "quick"), postures))
    rows = {"slender": JudgedModel("slender", ""), "beam": JudgedModel("beam", "", EULER)}
    compliances = [
        responses.required_statics(judged_model(responses.robot, *row), NOMINAL).compliances
        for row in rows.items()
    ]
    assert np.allclose(*compliances, rtol=1e-12, atol=0.0)
