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
from validation.references.modal_reference import (
    MODES_FROM_BEAMS,
    MODES_FROM_SEGMENTS,
    MODES_TO_SOLIDS,
)
from validation.references.model_ladder import formulation
from validation.references.responses import Model
from validation.references.robot_on_path import RobotOnPath, why_not_serial
from validation.references.static_reference import FROM_CONSTANT, TO_SOLIDS


class JudgedModel(NamedTuple):
    """A judged model: a row of the matrix of verdicts.

    `kind`: formulation. `title`: description in the report. `words`: name of the model inside a
    sentence, "" if it is the name in the matrix. `static_steps` and `modal_steps`: names of the
    steps in `all_static_steps` and `all_modal_steps` from the model to the reference, each of which
    removes a cause of its error. `plotted`: True if the model is a curve in the figures of
    compliances and frequencies along the path.
    """

    kind: ModelName
    title: str
    options: ModelOptions = ModelOptions()
    words: str = ""
    static_steps: Sequence[str] = ()
    modal_steps: Sequence[str] = ()
    plotted: bool = True


_EQUIVALENT = ModelOptions(legs="equivalent")
_EULER = ModelOptions(theory="euler-bernoulli")
JUDGED: Mapping[str, JudgedModel] = {
    "simplified": JudgedModel(
        "simplified",
        "elastic drives, rigid bodies",
        words="the simplified model",
        static_steps=("drives", *TO_SOLIDS),
        modal_steps=("drives", *MODES_FROM_BEAMS),
    ),
    "vjm": JudgedModel(
        "vjm",
        "virtual joints, legs as given",
        words="VJM with the specified legs",
        static_steps=TO_SOLIDS,
    ),
    "vjm-equivalent": JudgedModel(
        "vjm",
        "virtual joints, legs of constant section",
        _EQUIVALENT,
        words="VJM on equivalent legs",
        static_steps=FROM_CONSTANT,
        plotted=False,
    ),
    "links": JudgedModel(
        "links", "matrix structural analysis, legs as given", static_steps=TO_SOLIDS
    ),
    "segments": JudgedModel(
        "segments",
        "20 rigid segments per leg, Timoshenko",
        static_steps=FROM_CONSTANT,
        modal_steps=MODES_FROM_SEGMENTS,
    ),
    "segments-stepped": JudgedModel(
        "segments",
        "parts stepped in ten prismatic pieces",
        ModelOptions(parts="stepped"),
        words="stepped segments",
        static_steps=("condensed", *TO_SOLIDS),
        modal_steps=("condensed", *MODES_TO_SOLIDS),
    ),
    "segments-condensed": JudgedModel(
        "segments",
        "parts condensed on their interfaces",
        ModelOptions(parts="condensed"),
        words="condensed segments",
        static_steps=TO_SOLIDS,
        modal_steps=("modes inside", *MODES_TO_SOLIDS),
    ),
    "beam": JudgedModel(
        "beam",
        "20 beam elements per leg, Timoshenko",
        words="beams",
        static_steps=FROM_CONSTANT,
        modal_steps=MODES_FROM_BEAMS,
    ),
    "segments-euler-bernoulli": JudgedModel(
        "segments",
        "20 rigid segments per leg, Euler–Bernoulli",
        _EULER,
        words="Euler–Bernoulli segments",
        static_steps=("shear", *FROM_CONSTANT),
        modal_steps=("shear of segments", *MODES_FROM_SEGMENTS),
        plotted=False,
    ),
    "beam-euler-bernoulli": JudgedModel(
        "beam",
        "20 beam elements per leg, Euler–Bernoulli",
        _EULER,
        words="Euler–Bernoulli beams",
        static_steps=("shear", *FROM_CONSTANT),
        modal_steps=("shear of beams", *MODES_FROM_BEAMS),
    ),
}
# Models whose legs are rigid or as in the robot file. All others use equivalent prisms.
LEGS_AS_GIVEN = tuple(
    name
    for name, model in JUDGED.items()
    if model.kind == "simplified" or (model.kind in STATIC and model.options.legs == "given")
)
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
