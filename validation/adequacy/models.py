"""The models that are judged, by the names that the matrix has them under."""

from collections.abc import Mapping
from typing import NamedTuple

from validation.models.options import ModelName, ModelOptions


class JudgedModel(NamedTuple):
    """Which model it is, what it is in words, and with which options it is asked."""

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
# Those whose legs are rigid or the robot's own; all others stand on equivalent legs.
LEGS_AS_GIVEN = ("simplified", "vjm", "links")
