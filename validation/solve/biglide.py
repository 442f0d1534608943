"""One model of the biglide or of one of its legs, at the positions typed."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from lumped.biglide import Biglide
from lumped.errors import InputError, each
from lumped.legs import ConstantLeg, Leg, equivalent_leg
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.legs import leg_compliance, leg_frequencies
from validation.models.options import STATIC, ModelName, ModelOptions
from validation.solve.answer import Answer, Solution
from validation.solve.cost import Cost, dense_cost, require_affordable, solid_cost
from validation.solve.question import OF_ELEMENTS, OPTIONS, Question
from validation.solve.uncertainty import with_uncertainty


def _option_faults(question: "BiglideQuestion") -> list[str]:
    """Options that change nothing for this model and these legs, or values that are not allowed.

    What is typed and would change nothing is refused: whoever typed it expects that it does.
    """
    model, given, leg = question.model, question.given, question.leg
    faults = question.option_faults(OPTIONS[model])
    if leg is not None and leg not in (1, 2):
        faults.append(f"--leg = {leg}: must be 1 or 2")
    if leg is not None and model == "simplified":
        faults.append("--leg: the legs of the simplified model are rigid")
    if faults:
        return faults
    unheard = _unheard(model, given.get("legs", ModelOptions.legs), leg, question.legs)
    return [f"--{name}: {unheard[name]}" for name in given if name in unheard]


def _unheard(
    model: ModelName, springs: str, leg: int | None, legs: Sequence[Leg]
) -> dict[str, str]:
    """Options of the model that have nothing to act on here, and why."""
    unheard = dict.fromkeys(
        ("parts", "reduction"), "the biglide's legs are no parts from files; leave it out"
    )
    if all(isinstance(one, ConstantLeg) for one in legs):
        unheard["equivalent"] = (
            "a leg given by section and material is its own equivalent; leave it out"
        )
    if leg is not None:
        unheard["release"] = "a leg alone has no joint to release; leave it out, or --leg"
    if model in STATIC and springs == "given":
        unheard |= dict.fromkeys(
            ("theory", "equivalent"),
            f"the {model} model takes the legs as they are given; add --legs equivalent or leave "
            "it out",
        )
    return unheard


@dataclass(frozen=True, eq=False)
class BiglideQuestion(Question):
    """A model at `positions` x (m) of B, or of one leg."""

    robot: Biglide
    positions: tuple[float, ...]
    leg: int | None

    @property
    def legs(self) -> tuple[Leg, ...]:
        """The legs that are asked about."""
        both = (self.robot.leg1, self.robot.leg2)
        return both[self.leg - 1 : self.leg] if self.leg in (1, 2) else both


def checked_biglide(question: BiglideQuestion) -> Cost:
    """What the answer will cost.

    Raises InputError, all faults of the question at once, or where it costs too much.
    """
    model = question.model
    faults = _option_faults(question) + question.mode_faults()
    if question.leg is not None and question.positions:
        faults.append("--x: a leg alone has no position; leave out --x or --leg")
    outside = each(question.robot.posture, question.positions)[1]
    faults += [f"--x: {fault}" for fault in outside]
    if faults:
        raise InputError(faults)
    options = ModelOptions(**question.given)
    if model == "solid":
        what = f"--divisions {options.divisions}"
        cost = _solid_cost(question, options)
    elif model in OF_ELEMENTS:
        what = f"--elements {options.elements}"
        unknowns = 6 * (options.elements + 1) * len(question.legs)
        cost = dense_cost(unknowns, len(question.positions) or 1)
    else:
        return Cost(0.0, 0.0, 0.0)
    require_affordable(cost, what)
    return cost


def solve_biglide(question: BiglideQuestion) -> Solution:
    """The model's answers; raises InputError as `checked_biglide` does, ComputationError."""
    checked_biglide(question)
    model, leg, legs, count = question.model, question.leg, question.legs, question.count
    robot, options = question.robot, ModelOptions(**question.given)
    unheard = _unheard(model, options.legs, leg, legs)
    heard = {
        name: value
        for name, value in asdict(options).items()
        if name in OPTIONS[model] and name not in unheard
    }

    def answered(options: ModelOptions) -> list[Answer]:
        if leg is not None:
            return [_leg_answer(model, leg, legs[0], count, options)]
        return [
            _robot_answer(model, robot, x, count, options)
            for x in question.positions or (robot.centre,)
        ]

    answers = answered(options)
    if model == "solid":
        answers = with_uncertainty(
            answers,
            answered,
            legs,
            options,
            lambda other: require_affordable(_solid_cost(question, other), ""),
        )
    return Solution(robot.name, model, heard, tuple(answers))


def _solid_cost(question: BiglideQuestion, options: ModelOptions) -> Cost:
    legs = tuple(equivalent_leg(one, options.equivalent) for one in question.legs)
    return solid_cost(legs, options.divisions, question.count)


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
