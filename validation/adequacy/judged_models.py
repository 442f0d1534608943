"""Table of the lumped and beam models that are judged, by their names in the matrix of verdicts.

Input: a mechanism. Output: for each model its formulation, options and title, and a `Model` that
can be solved. Rule: a model that cannot represent the mechanism stays in the table with the reason,
but has no functions that solve it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from lumped.legs import GivenLeg
from lumped.mechanism.mechanism import Mechanism, Posture
from validation.models.options import STATIC, ModelName, ModelOptions
from validation.models.reduced_parts import is_leg
from validation.models.stepped_parts import why_not_stepped
from validation.references.model_ladder import formulation
from validation.references.responses import Model
from validation.references.robot_on_path import RobotOnPath, why_not_serial


class JudgedModel(NamedTuple):
    """Formulation (`kind`), options, and title in the report of a judged model."""

    kind: ModelName
    title: str
    options: ModelOptions = ModelOptions()


_EQUIVALENT = ModelOptions(legs="equivalent")
_EULER = ModelOptions(theory="euler-bernoulli")
JUDGED: Mapping[str, JudgedModel] = {
    "simplified": JudgedModel("simplified", "elastic drives, rigid bodies"),
    "vjm": JudgedModel("vjm", "virtual joints, legs as given"),
    "vjm-equivalent": JudgedModel("vjm", "virtual joints, legs of constant section", _EQUIVALENT),
    "links": JudgedModel("links", "matrix structural analysis, legs as given"),
    "segments": JudgedModel("segments", "20 rigid segments per leg, Timoshenko"),
    "segments-stepped": JudgedModel(
        "segments", "parts stepped in ten prismatic pieces", ModelOptions(parts="stepped")
    ),
    "segments-condensed": JudgedModel(
        "segments", "parts condensed on their interfaces", ModelOptions(parts="condensed")
    ),
    "beam": JudgedModel("beam", "20 beam elements per leg, Timoshenko"),
    "segments-euler-bernoulli": JudgedModel(
        "segments", "20 rigid segments per leg, Euler–Bernoulli", _EULER
    ),
    "beam-euler-bernoulli": JudgedModel(
        "beam", "20 beam elements per leg, Euler–Bernoulli", _EULER
    ),
}
# Models whose legs are rigid or as in the robot file. All others use equivalent prisms.
LEGS_AS_GIVEN = ("simplified", "vjm", "links")
_STATIC = "static model without mass, so it has no frequencies"
_RIGID = "all bodies and joints are rigid, and no elastic drive yields to the force or moment"


def judged_models(mechanism: Mechanism) -> dict[str, JudgedModel]:
    """Judged models by name, in the order of the matrix of verdicts.

    "vjm-equivalent" is omitted if it equals "vjm", that is, if no leg is specified by its 6×6
    compliance matrix and no CAD part is replaced by a leg.
    """
    parts = mechanism.parts.values()
    left_out = set() if parts else {"segments-stepped", "segments-condensed"}
    has_stiffness_leg = any(isinstance(body.shape, GivenLeg) for body in mechanism.bodies.values())
    if not has_stiffness_leg and not any(is_leg(body) for body in parts):
        left_out.add("vjm-equivalent")
    return {name: model for name, model in JUDGED.items() if name not in left_out}


def why_unable(postures: Sequence[Posture], model: JudgedModel) -> str:
    """Reason why a model cannot represent the mechanism. "" if it can."""
    if model.options.parts == "stepped":
        return why_not_stepped(postures[0].mechanism)
    return why_not_serial(postures) if model.kind == "vjm" else ""


def judged_models_of(
    robot: RobotOnPath, recipes: Mapping[str, JudgedModel] | None = None
) -> dict[str, Model]:
    """Solvable models of a robot by name, made from `recipes`.

    `recipes`: formulation and options of each model by name. If None, those of all judged models.
    """
    recipes_by_name = judged_models(robot.mechanism) if recipes is None else recipes
    return {name: judged_model(robot, name, recipe) for name, recipe in recipes_by_name.items()}


def judged_model(robot: RobotOnPath, name: str, recipe: JudgedModel) -> Model:
    """Solvable model called `name` in the matrix, from its formulation and options (`recipe`).

    Statics and modes are None if the model cannot represent the robot.
    """
    unable = why_unable(robot.postures, recipe)
    static = recipe.kind in STATIC
    model = formulation(name, recipe.kind, recipe.options)
    return replace(
        model,
        title=recipe.title,
        statics=None if unable else model.statics,
        modes=None if unable or static else model.modes,
        undefined_reason=unable or (_STATIC if static else ""),
        rigid=_RIGID if name == "simplified" else "",
        computed_by=(f"validation.models.robot_models.answers({recipe.kind!r})",),
    )
