"""`flexproof solve`: one model of a leg or of the robot, printed or as JSON."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Leg, equivalent_leg
from lumped.robot_file import RobotFile
from validation.cost import Cost, dense_cost, require_affordable, solid_cost
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.legs import leg_compliance, leg_frequencies
from validation.models.options import ModelName, ModelOptions

# What each model listens to; anything else given on the command line is a fault.
_OPTIONS: dict[ModelName, tuple[str, ...]] = {
    "simplified": (),
    "vjm": ("legs", "theory", "equivalent"),
    "segments": ("theory", "elements", "release", "layout", "equivalent"),
    "beam": ("theory", "elements", "equivalent"),
    "solid": ("ends", "divisions", "equivalent"),
}
# Models that have no mass, so no frequencies.
_STATIC: tuple[ModelName, ...] = ("vjm",)
# Models of elements, solved dense.
_OF_ELEMENTS: tuple[ModelName, ...] = ("segments", "beam")
_DEFAULT_MODES = 6


@dataclass(frozen=True)
class Answer:
    """Compliance (6×6 or 2×2, SI) and frequencies (Hz, ascending) at one posture or of one leg."""

    place: dict[str, float | int]
    compliance: Array
    frequencies: Array


@dataclass(frozen=True)
class Solution:
    """The answers of one model, and the options that had a say in them."""

    robot: str
    model: ModelName
    options: dict[str, Any]
    answers: tuple[Answer, ...]


def option_faults(
    model: ModelName, given: dict[str, Any], leg: int | None, legs: Sequence[Leg]
) -> list[str]:
    """Options that change nothing for this model and these `legs`, or values that are not allowed.

    What is typed and would change nothing is refused: whoever typed it expects that it does.
    """
    faults = []
    allowed = ", ".join(f"--{option}" for option in _OPTIONS[model]) or "none"
    faults += [
        f"--{name}: not an option of the {model} model; it takes {allowed}"
        for name in given
        if name not in _OPTIONS[model]
    ]
    for name in ("elements", "divisions"):
        if given.get(name, 1) < 1:
            faults.append(f"--{name} = {given[name]}: must be 1 or more")
    if leg is not None and leg not in (1, 2):
        faults.append(f"--leg = {leg}: must be 1 or 2")
    if leg is not None and model == "simplified":
        faults.append("--leg: the legs of the simplified model are rigid")
    if faults:
        return faults
    unheard = _unheard(model, given.get("legs", ModelOptions.legs), leg, legs)
    return [f"--{name}: {unheard[name]}" for name in given if name in unheard]


def _unheard(
    model: ModelName, springs: str, leg: int | None, legs: Sequence[Leg]
) -> dict[str, str]:
    """Options of the model that have nothing to act on here, and why."""
    unheard = {}
    if all(isinstance(one, ConstantLeg) for one in legs):
        unheard["equivalent"] = (
            "a leg given by section and material is its own equivalent; leave it out"
        )
    if leg is not None:
        unheard["release"] = "a leg alone has no joint to release; leave it out, or --leg"
    if model == "vjm" and springs == "given":
        unheard |= dict.fromkeys(
            ("theory", "equivalent"),
            "the vjm model takes the legs as they are given; add --legs equivalent or leave it out",
        )
    return unheard


@dataclass(frozen=True)
class Question:
    """A model at `positions` x (m) of B, or of one leg; `given` are the options that were typed."""

    robot_file: RobotFile
    model: ModelName
    positions: tuple[float, ...]
    leg: int | None
    modes: int | None
    given: dict[str, Any]

    @property
    def legs(self) -> tuple[Leg, ...]:
        """The legs that are asked about."""
        both = (self.robot_file.robot.leg1, self.robot_file.robot.leg2)
        return both[self.leg - 1 : self.leg] if self.leg in (1, 2) else both

    @property
    def count(self) -> int:
        """Number of frequencies."""
        asked = _DEFAULT_MODES if self.modes is None else self.modes
        return 0 if self.model in _STATIC else asked


def checked(question: Question) -> Cost:
    """What the answer will cost.

    Raises InputError, all faults of the question at once, or where it costs too much.
    """
    model, modes, leg = question.model, question.modes, question.leg
    faults = option_faults(model, question.given, leg, question.legs)
    if modes is not None and modes < 0:
        faults.append(f"--modes = {modes}: must be 0 or more")
    if modes and (model in _STATIC):
        faults.append(f"--modes: the {model} model is static and has no frequencies")
    if leg is not None and question.positions:
        faults.append("--x: a leg alone has no position; leave out --x or --leg")
    faults += _position_faults(question.robot_file, question.positions)
    if faults:
        raise InputError(faults)
    options = ModelOptions(**question.given)
    if model == "solid":
        what = f"--divisions {options.divisions}"
        legs = tuple(equivalent_leg(one, options.equivalent) for one in question.legs)
        cost = solid_cost(legs, options.divisions, question.count)
    elif model in _OF_ELEMENTS:
        what = f"--elements {options.elements}"
        unknowns = 6 * (options.elements + 1) * len(question.legs)
        cost = dense_cost(unknowns, len(question.positions) or 1)
    else:
        return Cost(0.0, 0.0, 0.0)
    require_affordable(cost, what)
    return cost


def solve(question: Question) -> Solution:
    """The model's answers; raises InputError as `checked` does, ComputationError."""
    checked(question)
    model, leg, legs, count = question.model, question.leg, question.legs, question.count
    robot, options = question.robot_file.robot, ModelOptions(**question.given)
    unheard = _unheard(model, options.legs, leg, legs)
    heard = {
        name: value
        for name, value in asdict(options).items()
        if name in _OPTIONS[model] and name not in unheard
    }
    if leg is not None:
        answers = [_leg_answer(model, leg, legs[0], count, options)]
    else:
        answers = [
            _robot_answer(model, robot, x, count, options)
            for x in question.positions or (robot.centre,)
        ]
    return Solution(robot.name, model, heard, tuple(answers))


def _leg_answer(
    model: ModelName, number: int, leg: Leg, count: int, options: ModelOptions
) -> Answer:
    frequencies = leg_frequencies(model, leg, count, options) if count else np.zeros(0)
    return Answer({"leg": number}, leg_compliance(model, leg, options), frequencies)


def _robot_answer(
    model: ModelName, robot: Biglide, x: float, count: int, options: ModelOptions
) -> Answer:
    frequencies = robot_frequencies(model, robot, x, count, options) if count else np.zeros(0)
    return Answer({"x": x}, robot_compliance(model, robot, x, options), frequencies)


def _position_faults(robot_file: RobotFile, positions: tuple[float, ...]) -> list[str]:
    faults: list[str] = []
    for x in positions:
        try:
            robot_file.robot.posture(x)
        except InputError as error:
            faults += [f"--x: {fault}" for fault in error.faults]
    return faults


def as_json(solution: Solution) -> str:
    """The answers as JSON (schema 1); an infinite frequency is null."""
    document = {
        "schema": 1,
        "robot": solution.robot,
        "model": solution.model,
        "options": solution.options,
        "results": [
            {
                **answer.place,
                "compliance": answer.compliance.tolist(),
                "frequencies": [f if np.isfinite(f) else None for f in answer.frequencies.tolist()],
            }
            for answer in solution.answers
        ],
    }
    return json.dumps(document, allow_nan=False)


def as_text(solution: Solution) -> str:
    """The answers for people: deflections at 1000 N, the compliance, the frequencies."""
    heard = ", ".join(f"{name} {value}" for name, value in solution.options.items())
    lines = [f"{solution.robot}, {solution.model}" + (f" ({heard})" if heard else "")]
    for answer in solution.answers:
        lines += ["", *_answer_lines(answer)]
    return "\n".join(lines)


def _answer_lines(answer: Answer) -> list[str]:
    size = len(answer.compliance)
    if "leg" in answer.place:
        head = f"leg {answer.place['leg']}, root clamped, leg axes"
    else:
        head = f"x = {answer.place['x']:.6g} m, at the loaded point, robot axes"
    under = ["x", "y"] if size == 2 else ["x", "y", "z"]
    lines = [head, "  deflection (µm) along its own load of 1000 N:"]
    lines.append(
        "    "
        + ", ".join(f"{axis} {answer.compliance[i, i] * 1e9:.4g}" for i, axis in enumerate(under))
    )
    lines.append(f"  compliance {size}×{size} (m/N, rad/N, rad/(N m)):")
    lines += ["    " + " ".join(f"{value: .4e}" for value in row) for row in answer.compliance]
    if len(answer.frequencies):
        listed = ", ".join(f"{value:.5g}" for value in answer.frequencies)
        lines.append(f"  natural frequencies (Hz): {listed}")
    return lines
