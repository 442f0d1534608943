"""Computation of `solve`: one model of a robot in the requested poses, or of one of its bodies.

Input: a `Question`. Output: a `Solution` with uncertainties. Rule: statics and modes come from
`Responses`, as for verdicts. For solids, a second mesh gives the half-widths; with --accuracy,
meshes are refined until the half-widths are small enough.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import ceil
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg, LineLeg
from lumped.mechanism.mechanism import UNITS_OF_MOVES, Mechanism, Posture
from lumped.models.bodies import RIGID_MOTIONS, bent_legs
from validation.context import Context
from validation.models.loads.pressures import resultants
from validation.models.loads.stability import gives_way_pressed, stabilities
from validation.models.loads.statics import load_forces
from validation.models.reduced_parts import free_body_part, with_finer_parts
from validation.models.robot_models import PostureModes
from validation.references.responses import Responses
from validation.references.robot_on_path import robot_at
from validation.responses.mode_partners import Partners, partners
from validation.solids.leg_meshes import formal_order
from validation.solve.answer import (
    Answer,
    HalfWidths,
    MeshUncertainty,
    ModePair,
    PairedModes,
    PartUncertainty,
    Place,
    Solution,
)
from validation.solve.cost import Cost, first_affordable, is_affordable, question_cost
from validation.solve.question import Question
from validation.solve.solved_model import solved_model
from validation.solve.uncertainty import (
    SolvedQuestion,
    extrapolated,
    of_digits,
    of_parts,
    of_prisms,
)
from validation.uncertainty.refinement import refined

# Additional modes of the compared model, since a partner can have a higher number.
_EXTRA_MODES = 6


@dataclass(frozen=True, eq=False)
class _Meshed:
    """Solved question with half-widths due to its meshes in each of P poses.

    `compliances` (P×6×6) and `frequencies` (an array for each pose) are extrapolated if an order is
    observed. `prisms`, `parts`: half-widths in each pose due to meshes of prisms and of CAD parts,
    () if the model has no such solids.
    """

    solved: SolvedQuestion
    compliances: Array
    frequencies: Sequence[Array]
    prisms: Sequence[MeshUncertainty] = ()
    parts: Sequence[PartUncertainty] = ()

    @property
    def largest_half_width(self) -> float:
        """Largest relative half-width, due to meshes, over all numbers and poses."""
        loads = self.solved.displacements
        shares = [
            share
            for half_widths in (self.prisms, self.parts)
            for pose, of_pose in enumerate(half_widths)
            for share in (
                *np.abs(of_pose.compliance / np.diag(self.compliances[pose])),
                *(of_pose.frequencies / self.frequencies[pose]),
                *of_pose.shares_of_loads(loads[pose]).values(),
            )
        ]
        return float(np.max(shares, initial=0.0))


def checked(question: Question) -> Cost:
    """Estimated cost of the answer to a question, after checks of the question.

    Raises InputError with all faults of the question, or if the cost is too high.
    """
    if faults := question.faults():
        raise InputError(faults)
    return question_cost(question)


def solve(question: Question) -> Solution:
    """Solution of the requested model.

    If the question has no number of modes, there are six frequencies, or fewer if the model has
    fewer modes. Raises the exceptions of `checked`, and ComputationError if the tool is free to
    move.
    """
    checked(question)
    return checked_solution(question)


def checked_solution(question: Question) -> Solution:
    """Solution of a question that is already `checked`."""
    if "ends" in question.given:
        question = _with_mechanism(question, _without_end_conditions(question.mechanism))
    accuracy = None
    if question.alone in question.mechanism.parts:
        answers = [_free_part_answer(question, question.alone)]
    else:
        solved = _solved(question)
        if question.accuracy is None:
            meshed = _meshed(solved)
        else:
            meshed, accuracy = refined(
                solved,
                _meshed,
                lambda meshed: meshed.largest_half_width,
                _finer,
                question.accuracy,
            )
        question, answers = meshed.solved.question, _answers(meshed)
    mechanism = question.mechanism
    moves = tuple(f"{move} ({UNITS_OF_MOVES[move]})" for move in mechanism.tool.moves)
    options = question.effective_options
    return Solution(mechanism.name, question.model, options, tuple(answers), accuracy, moves)


def _solved(question: Question) -> SolvedQuestion:
    """Question with its robot. The model is solved when its results are needed."""
    robot = robot_at(Context(question.robot_file, "quick"), question.postures())
    if not question.digits or question.model == "simplified":
        robot = replace(robot, printed=())
    return SolvedQuestion(question, Responses(robot, strict=True))


def _meshed(solved: SolvedQuestion) -> _Meshed:
    """Solved question with half-widths due to its meshes. Models without solids have none."""
    compliances, frequencies = solved.compliances, solved.frequencies
    prisms: Sequence[MeshUncertainty] = ()
    parts: Sequence[PartUncertainty] = ()
    if solved.question.model == "solid":
        prisms = of_prisms(solved, partial(is_affordable, solved.question))
        compliances, frequencies, prisms = extrapolated(solved, prisms)
        parts = of_parts(solved)
    existing = [values[~np.isnan(values)] for values in frequencies]
    return _Meshed(solved, compliances, existing, prisms, parts)


def _finer(solved: SolvedQuestion, factor: float) -> SolvedQuestion:
    """Question with finer meshes, expected to divide the half-widths by `factor`.

    Divisions grow at most by a factor of two. Raises InputError if the cost is too high, or if the
    file of a CAD part is a mesh, which cannot be refined.
    """
    question = solved.question
    if question.alone is None and question.mechanism.parts:
        # Solutions on other divisions have the old meshes of CAD parts, so they are discarded.
        question = _with_mechanism(question, with_finer_parts(question.mechanism, factor))
        solved = _solved(question)
    divisions, legs = question.options.divisions, question.legs
    if not legs:
        return solved
    order = min(formal_order(leg, question.options.ends) for leg in legs)
    # The smallest sufficient number of divisions is tried first. If its cost is too high, the
    # largest affordable number is used.
    wanted_divisions = min(
        max(ceil(divisions * factor ** (1.0 / order)), divisions + 1), 2 * divisions
    )
    counts = range(wanted_divisions, divisions, -1)
    return replace(solved, question=first_affordable(list(map(question.with_divisions, counts))))


def _answers(meshed: _Meshed) -> list[Answer]:
    """Answers in all poses."""
    solved = meshed.solved
    question, statics, modes = solved.question, solved.statics, solved.modes
    postures = modes.postures if modes else ()
    pairs = _pairs(solved) if question.against else ()
    loads = _load_fields(solved)
    digits = of_digits(solved)
    # The paper's simplified model defines the compliance along x and y alone.
    defined = slice(2 if question.numbered and question.model == "simplified" else None)
    return [
        Answer(
            _place(question, posture),
            meshed.compliances[pose][defined, defined],
            meshed.frequencies[pose],
            idle=None if statics is None else statics.idle[pose],
            uncertainty=meshed.prisms[pose] if meshed.prisms else None,
            of_parts=meshed.parts[pose] if meshed.parts else None,
            of_digits=digits[pose] if digits else None,
            paired=pairs[pose] if pairs else None,
            rigid=RIGID_MOTIONS if question.free else None,
            **(loads[pose] if loads else {}),
            **(_modal_fields(postures[pose]) if postures else {}),
        )
        for pose, posture in enumerate(solved.responses.robot.postures)
    ]


def _modal_fields(modes: PostureModes) -> dict[str, Any]:
    """Fields of `Answer`: strain energies and, if the robot is damped, damping and responses.

    Damping are the damping ratios of the modes, responses those to harmonic forces.
    """
    fields: dict[str, Any] = {"strain": modes.strain}
    count = len(modes.modes.frequencies)
    if count and modes.posture.mechanism.is_damped:
        damped = modes.damped
        # With dashpots, fewer motions can oscillate.
        oscillating = np.flatnonzero(np.isfinite(damped.frequencies))[:count]
        of_modes = damped.frequencies[oscillating], damped.losses[oscillating]
        fields |= {"responses": modes.responses, "damped": of_modes}
    return fields


def _load_fields(solved: SolvedQuestion) -> list[dict[str, Any]]:
    """Fields of each answer with displacements, stability and reactions under the loads."""
    question, names = solved.question, solved.loads
    if not names:
        return []
    model, postures, options = question.model, solved.responses.robot.postures, question.options
    loads = question.mechanism.loads
    pressures = resultants(question.mechanism)
    # Frequencies under load are computed for beams only: other models have another stiffness inside
    # the legs than the beams of this computation.
    beam_modes = solved.frequencies.shape[1] if model == "beam" else 0
    stability = stabilities(model, postures, options, beam_modes)
    forces = load_forces(model, postures, options)
    return [
        {
            "loads": displacements,
            "stability": {
                load.name: None if result and gives_way_pressed(load, result) else result
                for load, result in zip(loads, stability_of_pose, strict=True)
            },
            "bent": bent_legs(question.mechanism),
            "pressures": pressures,
            "reactions": {
                name: {reaction.joint: reaction.wrench for reaction in forces.reactions}
                for name, forces in zip(names, forces_of_pose, strict=True)
                if forces is not None
            },
        }
        for displacements, stability_of_pose, forces_of_pose in zip(
            solved.displacements, stability, forces, strict=True
        )
    ]


def _pairs(solved: SolvedQuestion) -> list[PairedModes]:
    """Pairs of all modes in each pose with those of another model, by energy-weighted MAC."""
    question, modes = solved.question, solved.modes
    against = question.against
    if against is None or modes is None:
        return []
    count = modes.count + _EXTRA_MODES
    other = solved_model(replace(question, model=against, modes=count))
    other_modes = solved.responses.required_modes(other, solved.reading)
    pairing = partners(modes.first(modes.count), other_modes.first(count), modes.count)
    return [
        PairedModes(against, tuple(_pair(pairing, pose, mode) for mode in range(modes.count)))
        for pose in range(len(modes.frequencies))
    ]


def _pair(pairing: Partners, pose: int, mode: int) -> ModePair:
    """Partner of a mode in a pose, both given by index."""
    partner_index = int(pairing.partner_indices[pose, mode])
    low, high = float(pairing.lowest[pose, mode]), float(pairing.highest[pose, mode])
    return ModePair(
        mode=mode + 1,
        partner=int(partner_index) + 1 if partner_index >= 0 else None,
        frequency=float(pairing.frequency[pose, mode]) if partner_index >= 0 else None,
        mac=float(pairing.mac[pose, mode]),
        seen=float(pairing.energy_shares[pose, mode]),
        local=bool(pairing.local[pose, mode]),
        open=(low, high) if high > low else None,
        undecided=bool(pairing.undecided[pose, mode]),
    )


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


def _with_mechanism(question: Question, mechanism: Mechanism) -> Question:
    """Copy of a question whose robot is `mechanism`."""
    return replace(question, robot_file=replace(question.robot_file, mechanism=mechanism))


def _place(question: Question, posture: Posture) -> Place:
    if question.leg is not None:
        return Place(leg=question.leg)
    if question.body is not None:
        return Place(body=question.body)
    pose = tuple(posture.pose.tolist())
    return Place(x=pose[0]) if question.numbered else Place(pose=pose)


def _without_end_conditions(mechanism: Mechanism) -> Mechanism:
    """Mechanism without end conditions of its prisms, so that those of the command line apply."""
    bodies = {
        name: replace(body, shape=replace(body.shape, ends=None))
        if isinstance(body.shape, ConstantLeg | LineLeg)
        else body
        for name, body in mechanism.bodies.items()
    }
    return replace(mechanism, bodies=bodies)
