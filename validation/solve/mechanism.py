"""One model of a mechanism of schema 2 in the poses typed, or of one of its bodies."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial

import numpy as np

from lumped.errors import InputError, each
from lumped.legs import ConstantLeg
from lumped.mechanism.body import Prism
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.models.bodies import leg_of, legs_of
from validation.kinematics.poses import parsed_pose
from validation.models.legs import leg_compliance, leg_frequencies
from validation.models.mechanism import answers, constant_legs, static_bodies
from validation.models.mechanism_modes import mechanism_modes
from validation.models.options import STATIC, ModelName, ModelOptions
from validation.solve.answer import Answer, PartUncertainty, Solution
from validation.solve.cost import Cost, dense_cost, require_affordable, solid_cost
from validation.solve.pairs import paired
from validation.solve.question import OF_ELEMENTS, OPTIONS, Question
from validation.solve.uncertainty import of_parts, with_uncertainty

# Eq. (25) as printed is a statement about the paper's own robot.
_BIGLIDE_ALONE = ("release",)
# What only parts from files listen to.
_OF_PARTS = ("parts", "reduction")


@dataclass(frozen=True, eq=False)
class MechanismQuestion(Question):
    """A model in the typed `poses` ("0.25,0.6"; the reference posture without), or of one `body`.

    The modes are paired with those of `against`.
    """

    mechanism: Mechanism
    poses: tuple[str, ...] = ()
    body: str | None = None
    against: ModelName | None = None


def checked_mechanism(question: MechanismQuestion) -> Cost:
    """What the answer will cost.

    Raises InputError, all faults of the question at once, or where it costs too much.
    """
    mechanism, model = question.mechanism, question.model
    faults = _option_faults(question) + question.mode_faults()
    if question.body is not None:
        faults += _body_faults(mechanism, model, question.body, question.poses)
    faults += _against_faults(question)
    faults += each(lambda text: posture(mechanism, parsed_pose(mechanism, text)), question.poses)[1]
    if faults:
        raise InputError(faults)
    return _cost(question)


def solve_mechanism(question: MechanismQuestion) -> Solution:
    """The model's answers.

    Raises InputError as `checked_mechanism` does, ComputationError where the drives do not hold
    the tool.
    """
    checked_mechanism(question)
    mechanism, model, count = question.mechanism, question.model, question.count
    if "ends" in question.given:
        mechanism = _without_own_ends(mechanism)
    options = ModelOptions(**question.given)
    heard = {
        name: value
        for name, value in asdict(options).items()
        if name in _listens(model) and name not in _unheard(mechanism)
    }

    typed = [parsed_pose(mechanism, text) for text in question.poses]
    at = [posture(mechanism, pose) for pose in typed] or [reference_posture(mechanism)]

    def answered(options: ModelOptions, *, alone: bool = False) -> list[Answer]:
        if question.body is not None:
            return [_of_body(mechanism, model, question.body, count, options)]
        return _in_postures(question, at, options, alone=alone)

    found = answered(options)
    legs = _meshed(question, mechanism, options)
    if legs:
        found = with_uncertainty(
            found,
            partial(answered, alone=True),
            legs,
            options,
            lambda other: _cost(
                replace(question, given={**question.given, "divisions": other.divisions})
            ),
        )
    return Solution(mechanism.name, model, heard, tuple(found))


def _meshed(
    question: MechanismQuestion, mechanism: Mechanism, options: ModelOptions
) -> list[ConstantLeg]:
    """The legs that are solids here, each shape once."""
    if question.model != "solid":
        return []
    legs = constant_legs(mechanism, options)
    return list({leg: None for name, leg, _ in legs if question.body in (None, name)})


def _in_postures(
    question: MechanismQuestion, at: Sequence[Posture], options: ModelOptions, *, alone: bool
) -> list[Answer]:
    """The answers, unless `alone` with what parts among the solids leave open."""
    model, count, mechanism = question.model, question.count, question.mechanism
    left_open = model == "solid" and not alone and bool(mechanism.parts)
    parts: list[PartUncertainty | None] = [None] * len(at)
    if not count:
        if left_open:
            parts = [*of_parts(at, static_bodies(model, mechanism, options), 0)]
        return [
            Answer(_place(one.posture), one.compliance, one.frequencies, one.idle, of_parts=part)
            for one, part in zip(answers(model, at, 0, options), parts, strict=True)
        ]
    found = mechanism_modes(model, at, count, options)
    pairs = paired(found, question.against, options) if question.against else None
    if left_open:
        parts = [*of_parts(at, found[0].system.models, count, options.reduction)]
    return [
        Answer(
            _place(one.posture),
            one.compliance,
            one.modes.frequencies,
            one.idle,
            of_parts=parts[place],
            strain=one.strain,
            pairs=pairs.record(place) if pairs else {},
        )
        for place, one in enumerate(found)
    ]


def _place(at: Posture) -> dict[str, float | int | str | list[float]]:
    return {"pose": at.pose.tolist()}


def _against_faults(question: MechanismQuestion) -> list[str]:
    if question.against is None:
        return []
    if question.against in STATIC:
        return [f"--against {question.against}: the model is static and has no modes"]
    if question.model in STATIC or not question.count or question.body is not None:
        return ["--against: there are no modes of the mechanism to be paired"]
    return []


def _cost(question: MechanismQuestion) -> Cost:
    """Of the legs that differ, each made once, and of the postures."""
    model, options = question.model, ModelOptions(**question.given)
    legs = constant_legs(question.mechanism, options)
    shapes = {leg for name, leg, _ in legs if question.body in (None, name)}
    if model == "solid":
        cost, what = solid_cost(tuple(shapes), options.divisions, question.count), "divisions"
    elif model in OF_ELEMENTS:
        # Legs are reduced one by one, and small then.
        cost, what = dense_cost(6 * (options.elements + 1), len(shapes)), "elements"
    else:
        return Cost(0.0, 0.0, 0.0)
    require_affordable(cost, f"--{what} {getattr(options, what)}")
    return cost


def _listens(model: ModelName) -> tuple[str, ...]:
    return tuple(name for name in OPTIONS[model] if name not in _BIGLIDE_ALONE)


def _option_faults(question: MechanismQuestion) -> list[str]:
    mechanism, listens = question.mechanism, _listens(question.model)
    unheard = _unheard(mechanism)
    return question.option_faults(listens, " of a mechanism") + [
        f"--{name}: no leg of {mechanism.name} is given by a "
        f"{'file' if name in _OF_PARTS else '6×6'}, so nothing would change"
        for name in question.given
        if name in listens and name in unheard
    ]


def _unheard(mechanism: Mechanism) -> tuple[str, ...]:
    """What changes nothing where every leg is a prism, or where no body is a part from a file."""
    if mechanism.parts:
        return ()
    prisms = all(isinstance(leg, ConstantLeg) for leg in legs_of(mechanism).values())
    return ("legs", "equivalent", *_OF_PARTS) if prisms else _OF_PARTS


def _body_faults(
    mechanism: Mechanism, model: ModelName, body: str, poses: Sequence[str]
) -> list[str]:
    names = list(legs_of(mechanism))
    faults = []
    if body not in names:
        rigid = body in mechanism.bodies and body != GROUND
        what = "is rigid" if rigid else "no such body"
        if body in mechanism.parts:
            what = "is a part from a file, see flexproof identify ROBOT --body"
        faults.append(f"--body {body}: {what}; must be one of {', '.join(names)}")
    if poses:
        faults.append("--pose: a body alone has no pose; leave out --pose or --body")
    if model == "simplified":
        faults.append("--body: the bodies of the simplified model are rigid")
    return faults


def _of_body(
    mechanism: Mechanism, model: ModelName, name: str, count: int, options: ModelOptions
) -> Answer:
    body = mechanism.bodies[name]
    leg = leg_of(body)
    if isinstance(body.shape, Prism) and body.shape.ends is not None:
        options = replace(options, ends=body.shape.ends)
    frequencies = leg_frequencies(model, leg, count, options) if count else np.zeros(0)
    return Answer({"body": name}, leg_compliance(model, leg, options), frequencies)


def _without_own_ends(mechanism: Mechanism) -> Mechanism:
    """What is typed goes before what the robot file says of its prisms."""
    bodies = {
        name: replace(body, shape=replace(body.shape, ends=None))
        if isinstance(body.shape, Prism)
        else body
        for name, body in mechanism.bodies.items()
    }
    return replace(mechanism, bodies=bodies)
