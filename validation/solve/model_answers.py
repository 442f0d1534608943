"""Computation of `solve`: one model of a robot in the requested poses, or of one of its bodies.

Input: a `Question`. Output: a `Solution` with uncertainties. Rule: for solids, a second mesh gives
the half-widths; with --accuracy, meshes are refined until these are small enough.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from math import ceil
from typing import TypeGuard

import numpy as np

from lumped.arrays import Array
from lumped.dense.modes import FewerModesError
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, LineLeg, SectionedLeg
from lumped.mechanism.mechanism import UNITS_OF_MOVES, Mechanism, Posture
from lumped.models.bodies import RIGID_MOTIONS, leg_of
from validation.models.leg_models import free_leg_frequencies, leg_compliance, leg_frequencies
from validation.models.loads.displacements import displacements
from validation.models.loads.forces import load_forces
from validation.models.loads.pressures import resultants
from validation.models.loads.stability import bent_legs, gives_way_pressed, stabilities
from validation.models.reduced_parts import free_body_part, with_finer_parts
from validation.models.robot_models import (
    PostureAnswer,
    PostureModes,
    answers,
    mechanism_modes,
    sectioned_legs,
    static_bodies,
)
from validation.models.roundings import roundings_of
from validation.solids.solid_legs import formal_order
from validation.solve.answer import Answer, HalfWidths, PartUncertainty, Place, Solution
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
from validation.solve.uncertainty import extrapolated, second_divisions, with_uncertainty
from validation.uncertainty.combiners import Combiner, combined, relative_sizes
from validation.uncertainty.refinement import refined

# Elements per leg for the effect of printed digits: for six modes it differs by a hundredth from
# that with 20.
_FEW_ELEMENTS = 6


def checked(question: Question) -> Cost:
    """Estimated cost of the answer to a question.

    Raises InputError with all faults of the question, or if the cost is too high.
    """
    if faults := question.faults():
        raise InputError(faults)
    return _cost(question)


def solve(question: Question) -> Solution:
    """Solution of the requested model. Without `modes`, six modes, or all if there are fewer.

    Raises InputError like `checked`, and ComputationError if the drives do not support the tool.
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
        question = _with_mechanism(question, _without_end_conditions(question.mechanism))
    accuracy = None
    if question.accuracy is None:
        _, solved = _answers_with_uncertainty(question, {})
    else:
        meshes: dict[int, list[Answer]] = {}
        (question, solved), accuracy = refined(
            question,
            lambda one: _answers_with_uncertainty(one, meshes),
            _largest_half_width,
            _finer,
            question.accuracy,
        )
    options = asdict(question.options)
    effective = {
        name: value for name, value in options.items() if name in question.effective_options
    }
    if question.digits and question.model != "simplified":
        solved = _with_digits(question, question.postures(), solved)
    tool = question.mechanism.tool
    moves = tuple(f"{move} ({UNITS_OF_MOVES[move]})" for move in tool.moves)
    return Solution(
        question.mechanism.name, question.model, effective, tuple(solved), accuracy, moves
    )


def _answers_with_uncertainty(
    question: Question, meshes: dict[int, list[Answer]]
) -> tuple[Question, list[Answer]]:
    """Answers; for solids with mesh uncertainty. `meshes` collects answers by divisions."""
    if question.mechanism.parts:
        # CAD parts have other meshes each time, so that no change is due to the divisions alone.
        meshes = {}
    postures = question.postures()
    solved, options = _answers(question, postures), question.options
    if question.model == "solid" and (legs := _shapes(question)):
        divisions = second_divisions(options, legs)
        other_mesh = meshes.get(divisions) or _on_other_mesh(question, postures, divisions)
        meshes |= {options.divisions: solved} | ({divisions: other_mesh} if other_mesh else {})
        solved = with_uncertainty(solved, other_mesh, legs, options, divisions)
        solved = extrapolated(solved, meshes, legs, options)
    return question, solved


def _largest_half_width(solved: tuple[Question, list[Answer]]) -> float:
    """Largest relative half-width, due to meshes, over all answers."""
    shares = [
        abs(share)
        for answer in solved[1]
        for half_widths in (answer.uncertainty, answer.of_parts)
        if half_widths is not None
        for share in (
            *(
                np.concatenate([half_widths.compliance, half_widths.frequencies])
                / _compliance_and_frequencies(answer)
            ),
            *half_widths.shares_of_loads(answer.loads).values(),
        )
    ]
    return float(np.max(shares, initial=0.0))


def _finer(question: Question, factor: float) -> Question:
    """Question with finer meshes, whose half-widths are smaller by `factor`.

    Divisions grow at most by a factor of two. Raises InputError if the cost is too high, or if a
    CAD part is given as a mesh, which cannot be refined.
    """
    if question.alone is None:
        question = _with_mechanism(question, with_finer_parts(question.mechanism, factor))
    divisions, legs = question.options.divisions, _shapes(question)
    if not legs:
        return question
    order = min(formal_order(leg, question.options.ends) for leg in legs)
    # The smallest sufficient number of divisions; if its cost is too high, the largest affordable
    # one.
    wanted_divisions = min(
        max(ceil(divisions * factor ** (1.0 / order)), divisions + 1), 2 * divisions
    )
    options = [
        {**question.given, "divisions": count} for count in range(wanted_divisions, divisions, -1)
    ]
    return _affordable([replace(question, given=count) for count in options])


def _affordable(questions: Sequence[Question]) -> Question:
    """First question with an affordable mesh. Raises the first InputError if there is none."""
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
    question: Question, postures: Sequence[Posture], divisions: int
) -> list[Answer] | None:
    """Answers on a mesh of other `divisions`. None if a finer mesh is too large."""
    other = replace(question, given={**question.given, "divisions": divisions}, against=None)
    if divisions > question.options.divisions:
        try:
            _cost(other)
        except InputError:
            return None
    return _answers(other, postures, with_parts=False)


def _answers(
    question: Question, postures: Sequence[Posture], *, with_parts: bool = True
) -> list[Answer]:
    """Answers in all poses. If `with_parts`, solids include the uncertainty of CAD parts."""
    if question.alone is not None:
        return [_body_answer(question, question.alone)]
    model, count, options = question.model, question.count, question.options
    modes = mechanism_modes(model, postures, count, options) if count else []
    solved = [
        Answer(
            _place(question, answer.posture),
            _defined_compliance(question, answer.compliance),
            answer.modes.frequencies if isinstance(answer, PostureModes) else answer.frequencies,
            answer.idle,
            strain=answer.strain if isinstance(answer, PostureModes) else {},
            responses=answer.responses if _is_damped(answer) else (),
            damped=_damped(answer) if _is_damped(answer) else None,
        )
        for answer in modes or answers(model, postures, 0, options)
    ]
    if loads := question.mechanism.loads:
        names = [load.name for load in loads]
        displaced = displacements(model, postures, options)
        bent = bent_legs(question.mechanism)
        # Frequencies of other models have a stiffness inside the legs that is not that of beams.
        stability_by_posture = stabilities(
            model, postures, options, count if model == "beam" else 0
        )
        forces_by_posture = load_forces(model, postures, options)
        pressures = resultants(question.mechanism)
        solved = [
            replace(
                answer,
                loads=dict(zip(names, displacement, strict=True)),
                # Bent legs have no geometric stiffness.
                stability={}
                if bent
                else {
                    load.name: None if result and gives_way_pressed(load, result) else result
                    for load, result in zip(loads, near, strict=True)
                },
                reactions={
                    name: {one.joint: one.wrench for one in found.reactions}
                    for name, found in zip(names, forces, strict=True)
                    if found is not None
                },
                pressures=pressures,
            )
            for answer, displacement, near, forces in zip(
                solved, displaced, stability_by_posture, forces_by_posture, strict=True
            )
        ]
    if question.against:
        # Imported here: packages that are slow to load, which no other answer needs.
        from validation.solve.pairs import paired  # noqa: PLC0415

        pairs = paired(modes, question.against, options)
        solved = [
            replace(answer, paired=pair_list)
            for answer, pair_list in zip(solved, pairs, strict=True)
        ]
    if with_parts and model == "solid" and question.mechanism.parts:
        solids = modes[0].system.models if modes else None
        solids = solids or static_bodies(model, question.mechanism, options)
        from validation.solve.part_uncertainty import of_parts  # noqa: PLC0415

        parts = of_parts(postures, solids, count, options.reduction)
        solved = [
            replace(answer, of_parts=part_uncertainty)
            for answer, part_uncertainty in zip(solved, parts, strict=True)
        ]
    return solved


def _is_damped(answer: PostureModes | PostureAnswer) -> TypeGuard[PostureModes]:
    """True for modes of a robot with damping."""
    if not isinstance(answer, PostureModes):
        return False
    return len(answer.modes.frequencies) > 0 and answer.posture.mechanism.is_damped


def _damped(modes: PostureModes) -> tuple[Array, Array]:
    """Frequencies (Hz) and loss factors of complex modes."""
    # With dashpots, fewer motions can oscillate.
    count = len(modes.modes.frequencies)
    oscillating = np.flatnonzero(np.isfinite(modes.damped.frequencies))[:count]
    return modes.damped.frequencies[oscillating], modes.damped.losses[oscillating]


def _body_answer(question: Question, name: str) -> Answer:
    model, count, options = question.model, question.count, question.options
    if name in question.mechanism.parts:
        return _free_part_answer(question, name)
    leg = leg_of(question.mechanism.bodies[name])
    if not isinstance(leg, GivenLeg) and leg.ends is not None:
        options = replace(options, ends=leg.ends)
    place = Place(body=name) if question.leg is None else Place(leg=question.leg)
    if question.free:
        frequencies = free_leg_frequencies(model, leg, count, options)
        return Answer(place, np.zeros((0, 0)), frequencies, rigid=RIGID_MOTIONS)
    frequencies = leg_frequencies(model, leg, count, options) if count else np.zeros(0)
    return Answer(place, leg_compliance(model, leg, options), frequencies)


def _free_part_answer(question: Question, name: str) -> Answer:
    """Frequencies of a CAD part without supports, with the half-widths of its meshes."""
    part = free_body_part(question.mechanism.bodies[name], modes=question.count)
    half_widths = np.nan_to_num(part.frequency_refinement, nan=np.inf)
    unchanged = HalfWidths(np.zeros(0), np.zeros(len(half_widths)))
    return Answer(
        Place(body=name),
        np.zeros((0, 0)),
        part.frequencies,
        rigid=part.rigid,
        of_parts=PartUncertainty(
            np.zeros(0),
            half_widths,
            bracket=unchanged,
            reduction=unchanged.frequencies,
            counted={},
            by=question.options.reduction,
        ),
    )


def _shapes(question: Question) -> list[SectionedLeg]:
    """Legs of the question, equal ones once."""
    legs = sectioned_legs(question.mechanism, question.options)
    return list({leg: None for name, leg, _ in legs if question.alone in (None, name)})


def _with_mechanism(question: Question, mechanism: Mechanism) -> Question:
    """Question about another robot."""
    return replace(question, robot_file=replace(question.robot_file, mechanism=mechanism))


def _with_digits(
    question: Question, postures: Sequence[Posture], solved: Sequence[Answer]
) -> list[Answer]:
    """Answers with bounds due to the printed digits of the file's 6×6, if there are any.

    Computed by the model itself with few elements, for solids by beams: the relative effect of a
    6×6 is small and depends little on the model.
    """
    roundings = roundings_of(question.robot_file.printed_compliances, postures)
    if not roundings:
        return list(solved)
    options = question.given
    if question.model == "solid":
        options = {name: options[name] for name in ("equivalent",) if name in options}
        question = replace(question, model="beam")
    if question.model in OF_ELEMENTS:
        options = {**options, "elements": min(question.options.elements, _FEW_ELEMENTS)}
    question = replace(question, given=options)

    def values(postures: Sequence[Posture]) -> Array:
        rows: Sequence[Answer | PostureAnswer]
        if question.alone is not None:
            rows = [_body_answer(_with_mechanism(question, postures[0].mechanism), question.alone)]
        else:
            rows = answers(question.model, postures, question.count, question.options)
        sizes = np.array([_compliance_and_frequencies(answer) for answer in rows])
        # Infinite numbers do not depend on digits.
        return np.where(np.isfinite(sizes), sizes, 0.0)

    nominal = values(postures)
    changes = np.array(
        [answer.factor * (values(answer.postures) - nominal) for answer in roundings]
    )
    share = combined(
        changes,
        lambda values_of_answer: relative_sizes(values_of_answer, nominal),
        Combiner.LINEAR_SUM,
    )
    if not share.any():
        return list(solved)
    digits = [
        np.nan_to_num(values_of_answer * np.abs(_compliance_and_frequencies(answer)))
        for answer, values_of_answer in zip(solved, share, strict=True)
    ]
    return [
        replace(answer, of_digits=HalfWidths(*np.split(half_widths, [len(answer.compliance)])))
        for answer, half_widths in zip(solved, digits, strict=True)
    ]


def _compliance_and_frequencies(answer: Answer | PostureAnswer) -> Array:
    """Diagonal of the compliance (6), followed by the frequencies."""
    return np.concatenate([np.diag(answer.compliance), answer.frequencies])


def _place(question: Question, posture: Posture) -> Place:
    pose = tuple(posture.pose.tolist())
    return Place(x=pose[0]) if question.numbered else Place(pose=pose)


def _defined_compliance(question: Question, compliance: Array) -> Array:
    """Block of the compliance that the model defines: x and y in the paper's simplified model."""
    planar = question.numbered and question.model == "simplified"
    return compliance[:2, :2] if planar else compliance


def _cost(question: Question, longest: float = LONGEST) -> Cost:
    """Cost of the distinct legs, each once, and of the CAD parts."""
    model, options = question.model, question.options
    seconds = PER_PART * len(question.mechanism.parts)
    shapes = _shapes(question)
    if model == "solid":
        cost, option = solid_cost(tuple(shapes), options.divisions, question.count), "divisions"
    elif model in OF_ELEMENTS:
        # Legs are reduced one by one and are small then.
        cost, option = dense_cost(6 * (options.elements + 1), len(shapes)), "elements"
    else:
        return Cost(0.0, 0.0, seconds)
    require_affordable(cost, f"--{option} {getattr(options, option)}", longest)
    return replace(cost, seconds=cost.seconds + seconds)


def _without_end_conditions(mechanism: Mechanism) -> Mechanism:
    """Mechanism without end conditions of its prisms, so that those of the command line apply."""
    bodies = {
        name: replace(body, shape=replace(body.shape, ends=None))
        if isinstance(body.shape, ConstantLeg | LineLeg)
        else body
        for name, body in mechanism.bodies.items()
    }
    return replace(mechanism, bodies=bodies)
