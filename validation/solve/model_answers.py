"""One model of a robot in the poses asked for, or of one of its bodies."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from math import ceil
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.dense.modes import FewerModesError
from lumped.errors import InputError
from lumped.legs import ConstantLeg
from lumped.mechanism.mechanism import UNITS_OF_MOVES, Mechanism, Posture
from lumped.models.bodies import RIGID_MOTIONS, leg_of
from validation.models.leg_models import free_leg_frequencies, leg_compliance, leg_frequencies
from validation.models.loads.displacements import displacements
from validation.models.loads.stability import stabilities
from validation.models.reduced_parts import with_finer_parts
from validation.models.robot_models import (
    PostureAnswer,
    PostureModes,
    answers,
    constant_legs,
    mechanism_modes,
    static_bodies,
)
from validation.models.roundings import roundings_of
from validation.solids.solid_legs import formal_order
from validation.solve.answer import Answer, LeftOpen, Place, Solution
from validation.solve.cost import (
    LONGEST,
    LONGEST_REFINEMENT,
    PER_PART,
    Cost,
    dense_cost,
    require_affordable,
    solid_cost,
)
from validation.solve.question import OF_ELEMENTS, Question
from validation.solve.uncertainty import beside, extrapolated, with_uncertainty
from validation.uncertainty.combiners import Combiner, combined, relative_sizes
from validation.uncertainty.refinement import refined

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
    """The model's answers; unless `modes` are asked for, as many as there are of six.

    Raises InputError as `checked` does, ComputationError where the drives do not hold the tool.
    """
    checked(question)
    if question.modes is not None:
        return _solved(question)
    for count in range(question.count, 0, -1):
        with suppress(FewerModesError):
            return _solved(replace(question, modes=count))
    return _solved(replace(question, modes=0))


def _solved(question: Question) -> Solution:
    if "ends" in question.given:
        question = _of(question, _without_own_ends(question.mechanism))
    reached = None
    if question.accuracy is None:
        _, found = _on_its_mesh(question, {})
    else:
        meshes: dict[int, list[Answer]] = {}
        (question, found), reached = refined(
            question,
            lambda one: _on_its_mesh(one, meshes),
            _left_open,
            _finer,
            question.accuracy,
        )
    options = asdict(question.options)
    heard = {name: value for name, value in options.items() if name in question.listens}
    if question.digits and question.model != "simplified":
        found = _with_digits(question, question.postures(), found)
    tool = question.mechanism.tool
    moves = tuple(f"{move} ({UNITS_OF_MOVES[move]})" for move in tool.moves)
    return Solution(question.mechanism.name, question.model, heard, tuple(found), reached, moves)


def _on_its_mesh(
    question: Question, meshes: dict[int, list[Answer]]
) -> tuple[Question, list[Answer]]:
    """The answers, of solids with what their meshes leave open; `meshes` gather those of each."""
    if question.mechanism.parts:
        # Parts have other meshes every time: no step is that of the divisions alone.
        meshes = {}
    at = question.postures()
    found, options = _answers(question, at), question.options
    if question.model == "solid" and (legs := _shapes(question)):
        divisions = beside(options, legs)
        others = meshes.get(divisions) or _on_other_mesh(question, at, divisions)
        meshes |= {options.divisions: found} | ({divisions: others} if others else {})
        found = with_uncertainty(found, others, legs, options, divisions)
        found = extrapolated(found, meshes, legs, options)
    return question, found


def _left_open(found: tuple[Question, list[Answer]]) -> float:
    """The largest relative half-width of all answers that meshes leave."""
    shares = [
        abs(share)
        for one in found[1]
        for left in (one.uncertainty, one.of_parts)
        if left is not None
        for share in (
            *(np.concatenate([left.compliance, left.frequencies]) / _sizes(one)),
            *left.shares_of_loads(one.loads).values(),
        )
    ]
    return float(np.max(shares, initial=0.0))


def _finer(question: Question, factor: float) -> Question:
    """The question on meshes that leave so many times less open, of at most twice the divisions.

    Raises InputError where it takes too much, or a part is a mesh, which has no finer one.
    """
    if question.alone is None:
        question = _of(question, with_finer_parts(question.mechanism, factor))
    own, legs = question.options.divisions, _shapes(question)
    if not legs:
        return question
    order = min(formal_order(leg, question.options.ends) for leg in legs)
    # The fewest divisions that promise enough; where these are too many, as many as there can be.
    wanted = min(max(ceil(own * factor ** (1.0 / order)), own + 1), 2 * own)
    given = [{**question.given, "divisions": one} for one in range(wanted, own, -1)]
    return _affordable([replace(question, given=one) for one in given])


def _affordable(questions: Sequence[Question]) -> Question:
    """First question that one more mesh may cost. Raises the first InputError if there is none."""
    refused = []
    for question in questions:
        try:
            _cost(question, LONGEST_REFINEMENT)
        except InputError as error:
            refused.append(error)
        else:
            return question
    raise refused[0]


def _on_other_mesh(
    question: Question, at: Sequence[Posture], divisions: int
) -> list[Answer] | None:
    """The answers on a mesh of other `divisions`, None where a finer one is too large to be had."""
    other = replace(question, given={**question.given, "divisions": divisions}, against=None)
    if divisions > question.options.divisions:
        try:
            _cost(other)
        except InputError:
            return None
    return _answers(other, at, whole=False)


def _answers(question: Question, at: Sequence[Posture], *, whole: bool = True) -> list[Answer]:
    """The answers, `whole` with what parts among solids leave open."""
    if question.alone is not None:
        return [_of_body(question, question.alone)]
    model, count, options = question.model, question.count, question.options
    found = mechanism_modes(model, at, count, options) if count else []
    told = [
        Answer(
            _place(question, one.posture),
            _shown(question, one.compliance),
            one.modes.frequencies if isinstance(one, PostureModes) else one.frequencies,
            one.idle,
            strain=one.strain if isinstance(one, PostureModes) else {},
            **(_damped(one) if isinstance(one, PostureModes) else {}),
        )
        for one in found or answers(model, at, 0, options)
    ]
    if loads := question.mechanism.loads:
        names = [load.name for load in loads]
        moved = displacements(model, at, options)
        # Frequencies of other models have a stiffness inside their legs that is not a beam's.
        held = stabilities(model, at, options, count if model == "beam" else 0)
        told = [
            replace(
                one,
                loads=dict(zip(names, own, strict=True)),
                stability=dict(zip(names, near, strict=True)),
            )
            for one, own, near in zip(told, moved, held, strict=True)
        ]
    if question.against:
        # Rooms of the verdict, slow to load, that no other answer needs.
        from validation.solve.pairs import paired  # noqa: PLC0415

        pairs = paired(found, question.against, options)
        told = [replace(one, paired=own) for one, own in zip(told, pairs, strict=True)]
    if whole and model == "solid" and question.mechanism.parts:
        solids = found[0].system.models if found else None
        solids = solids or static_bodies(model, question.mechanism, options)
        from validation.solve.part_uncertainty import of_parts  # noqa: PLC0415

        parts = of_parts(at, solids, count, options.reduction)
        told = [replace(one, of_parts=own) for one, own in zip(told, parts, strict=True)]
    return told


def _damped(found: PostureModes) -> dict[str, Any]:
    """Responses, and frequencies (Hz) and loss factors of as many complex modes, where damped."""
    count = len(found.modes.frequencies)
    if not count or not found.posture.mechanism.is_damped:
        return {}
    known = found.damped.frequencies[:count], found.damped.losses[:count]
    return {"responses": found.responses, "damped": known}


def _of_body(question: Question, name: str) -> Answer:
    model, count, options = question.model, question.count, question.options
    leg = leg_of(question.mechanism.bodies[name])
    if isinstance(leg, ConstantLeg) and leg.ends is not None:
        options = replace(options, ends=leg.ends)
    place: Place = {"body": name} if question.leg is None else {"leg": question.leg}
    if question.free:
        frequencies = free_leg_frequencies(model, leg, count, options)
        return Answer(place, np.zeros((0, 0)), frequencies, rigid=RIGID_MOTIONS)
    frequencies = leg_frequencies(model, leg, count, options) if count else np.zeros(0)
    return Answer(place, leg_compliance(model, leg, options), frequencies)


def _shapes(question: Question) -> list[ConstantLeg]:
    """The legs that are asked about, those that are alike once."""
    legs = constant_legs(question.mechanism, question.options)
    return list({leg: None for name, leg, _ in legs if question.alone in (None, name)})


def _of(question: Question, mechanism: Mechanism) -> Question:
    """The same asked of another robot."""
    return replace(question, robot_file=replace(question.robot_file, mechanism=mechanism))


def _with_digits(
    question: Question, at: Sequence[Posture], found: Sequence[Answer]
) -> list[Answer]:
    """The answers with what the digits of the file's 6×6 leave open, where they leave something.

    By the model itself, of few elements, of solids by beams in their place: what a 6×6 changes is a
    small share, and which share it is depends little on the model.
    """
    roundings = roundings_of(question.robot_file.printed_compliances, at)
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
        rows: Sequence[Answer | PostureAnswer]
        if question.alone is not None:
            rows = [_of_body(_of(question, postures[0].mechanism), question.alone)]
        else:
            rows = answers(question.model, postures, question.count, question.options)
        sizes = np.array([_sizes(one) for one in rows])
        # Digits change nothing of what is infinite.
        return np.where(np.isfinite(sizes), sizes, 0.0)

    nominal = values(at)
    changes = np.array([one.factor * (values(one.postures) - nominal) for one in roundings])
    share = combined(changes, lambda own: relative_sizes(own, nominal), Combiner.LINEAR_SUM)
    if not share.any():
        return list(found)
    digits = [
        np.nan_to_num(own * np.abs(_sizes(one))) for one, own in zip(found, share, strict=True)
    ]
    return [
        replace(one, of_digits=LeftOpen(*np.split(left, [len(one.compliance)])))
        for one, left in zip(found, digits, strict=True)
    ]


def _sizes(one: Answer | PostureAnswer) -> Array:
    """The diagonal of the compliance (6), then the frequencies."""
    return np.concatenate([np.diag(one.compliance), one.frequencies])


def _place(question: Question, at: Posture) -> Place:
    return {"x": float(at.pose[0])} if question.numbered else {"pose": at.pose.tolist()}


def _shown(question: Question, compliance: Array) -> Array:
    """What the paper's simplified model knows of its robot: x and y."""
    planar = question.numbered and question.model == "simplified"
    return compliance[:2, :2] if planar else compliance


def _cost(question: Question, longest: float = LONGEST) -> Cost:
    """Of the legs that differ, each made once, and of the parts."""
    model, options = question.model, question.options
    seconds = PER_PART * len(question.mechanism.parts)
    shapes = _shapes(question)
    if model == "solid":
        cost, what = solid_cost(tuple(shapes), options.divisions, question.count), "divisions"
    elif model in OF_ELEMENTS:
        # Legs are reduced one by one, and small then.
        cost, what = dense_cost(6 * (options.elements + 1), len(shapes)), "elements"
    else:
        return Cost(0.0, 0.0, seconds)
    require_affordable(cost, f"--{what} {getattr(options, what)}", longest)
    return replace(cost, seconds=cost.seconds + seconds)


def _without_own_ends(mechanism: Mechanism) -> Mechanism:
    """What is typed goes before what the robot file says of its prisms."""
    bodies = {
        name: replace(body, shape=replace(body.shape, ends=None))
        if isinstance(body.shape, ConstantLeg)
        else body
        for name, body in mechanism.bodies.items()
    }
    return replace(mechanism, bodies=bodies)
