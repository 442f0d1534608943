"""One model of a robot in the poses asked for, or of one of its bodies."""

from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import leg_of
from validation.models.legs import leg_compliance, leg_frequencies
from validation.models.mechanism import (
    PostureAnswer,
    answers,
    constant_legs,
    mechanism_modes,
    static_bodies,
)
from validation.models.options import ModelOptions
from validation.models.roundings import roundings_of, share_by_digits
from validation.solve.answer import Answer, LeftOpen, PartUncertainty, Solution
from validation.solve.cost import Cost, dense_cost, require_affordable, solid_cost
from validation.solve.pairs import paired
from validation.solve.question import OF_ELEMENTS, Question
from validation.solve.uncertainty import of_parts, with_uncertainty

# Per leg: shares of six modes by these and by 20 differ by a hundredth of themselves.
_FEW_ELEMENTS = 6


def checked(question: Question) -> Cost:
    """What the answer will cost.

    Raises InputError, all faults of the question at once, or where it costs too much.
    """
    if faults := question.faults():
        raise InputError(faults)
    return _cost(question)


def solve(question: Question) -> Solution:
    """The model's answers.

    Raises InputError as `checked` does, ComputationError where the drives do not hold the tool.
    """
    checked(question)
    if "ends" in question.given:
        question = replace(question, mechanism=_without_own_ends(question.mechanism))
    mechanism, model, options = question.mechanism, question.model, question.options
    heard = {name: value for name, value in asdict(options).items() if name in question.listens}
    at = question.postures()

    def answered(options: ModelOptions, *, alone: bool = False) -> list[Answer]:
        if question.body is not None:
            return [_of_body(question, question.body, options)]
        return _in_postures(question, at, options, alone=alone)

    found = answered(options)
    legs = _meshed(question, options)
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
    if question.text and model != "simplified":
        found = _with_digits(question, at, found)
    return Solution(mechanism.name, model, heard, tuple(found))


def _with_digits(
    question: Question, at: Sequence[Posture], found: Sequence[Answer]
) -> list[Answer]:
    """The answers with what the digits of the file's 6×6 leave open, where they leave something.

    By the model itself, of few elements, of solids by beams in their place: what a 6×6 changes is a
    small share, and which share it is depends little on the model.
    """
    roundings = roundings_of(question.text, at)
    if not roundings:
        return list(found)
    given = question.given
    if question.model == "solid":
        given = {name: given[name] for name in ("equivalent",) if name in given}
        question = replace(question, model="beam")
    if question.model in OF_ELEMENTS:
        given = {**given, "elements": min(question.options.elements, _FEW_ELEMENTS)}
    question = replace(question, given=given)

    def values(postures: Sequence[Posture]) -> Array:
        mechanism, options = postures[0].mechanism, question.options
        one_body = replace(question, mechanism=mechanism)
        rows: Sequence[Answer | PostureAnswer]
        if question.body is not None:
            rows = [_of_body(one_body, question.body, options)]
        else:
            rows = answers(question.model, postures, question.count, options)
        return np.array([_sizes(one) for one in rows])

    share = share_by_digits(roundings, at, values)
    if not share.any():
        return list(found)
    digits = [
        np.nan_to_num(own * np.abs(_sizes(one))) for one, own in zip(found, share, strict=True)
    ]
    return [
        replace(one, of_digits=LeftOpen(left[:6], left[6:]))
        for one, left in zip(found, digits, strict=True)
    ]


def _sizes(one: Answer | PostureAnswer) -> Array:
    """The diagonal of the compliance (6), then the frequencies."""
    return np.concatenate([np.diag(one.compliance), one.frequencies])


def _meshed(question: Question, options: ModelOptions) -> list[ConstantLeg]:
    """The legs that are solids here, each shape once."""
    if question.model != "solid":
        return []
    legs = constant_legs(question.mechanism, options)
    return list({leg: None for name, leg, _ in legs if question.body in (None, name)})


def _in_postures(
    question: Question, at: Sequence[Posture], options: ModelOptions, *, alone: bool
) -> list[Answer]:
    """The answers, unless `alone` with what parts among the solids leave open."""
    model, count, mechanism = question.model, question.count, question.mechanism
    left_open = model == "solid" and not alone and bool(mechanism.parts)
    parts: list[PartUncertainty | None] = [None] * len(at)
    if not count:
        if left_open:
            parts = [*of_parts(at, static_bodies(model, mechanism, options), 0)]
        return [
            Answer(
                _place(question, one.posture),
                _shown(question, one.compliance),
                one.frequencies,
                one.idle,
                of_parts=part,
            )
            for one, part in zip(answers(model, at, 0, options), parts, strict=True)
        ]
    found = mechanism_modes(model, at, count, options)
    pairs = paired(found, question.against, options) if question.against else None
    if left_open:
        parts = [*of_parts(at, found[0].system.models, count, options.reduction)]
    return [
        Answer(
            _place(question, one.posture),
            _shown(question, one.compliance),
            one.modes.frequencies,
            one.idle,
            of_parts=parts[place],
            strain=one.strain,
            pairs=pairs.record(place) if pairs else {},
        )
        for place, one in enumerate(found)
    ]


def _place(question: Question, at: Posture) -> dict[str, float | int | str | list[float]]:
    return {"x": float(at.pose[0])} if question.numbered else {"pose": at.pose.tolist()}


def _shown(question: Question, compliance: Array) -> Array:
    """What the paper's simplified model knows of its robot: x and y."""
    planar = question.numbered and question.model == "simplified"
    return compliance[:2, :2] if planar else compliance


def _cost(question: Question) -> Cost:
    """Of the legs that differ, each made once, and of the postures."""
    model, options = question.model, question.options
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


def _of_body(question: Question, name: str, options: ModelOptions) -> Answer:
    body, model, count = question.mechanism.bodies[name], question.model, question.count
    leg = leg_of(body)
    if isinstance(leg, ConstantLeg) and leg.ends is not None:
        options = replace(options, ends=leg.ends)
    frequencies = leg_frequencies(model, leg, count, options) if count else np.zeros(0)
    place: dict[str, float | int | str | list[float]] = {"body": name}
    if question.numbered:
        place = {"leg": int(name.removeprefix("leg"))}
    return Answer(place, leg_compliance(model, leg, options), frequencies)


def _without_own_ends(mechanism: Mechanism) -> Mechanism:
    """What is typed goes before what the robot file says of its prisms."""
    bodies = {
        name: replace(body, shape=replace(body.shape, ends=None))
        if isinstance(body.shape, ConstantLeg)
        else body
        for name, body in mechanism.bodies.items()
    }
    return replace(mechanism, bodies=bodies)
