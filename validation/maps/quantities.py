"""What is mapped over a workspace: lowest stiffness, first frequency, error of the chosen model."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from fem.beams.stepped import SteppedLeg
from lumped.acceptance.quantities import ANY_FORCE
from lumped.acceptance.requirement import Requirement
from lumped.arrays import Array
from lumped.legs import ConstantLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import links
from lumped.system.assembly import Assembly, assembly
from lumped.system.sweep import swept
from validation.adequacy.mechanism.legs import solid_tip
from validation.adequacy.mechanism.parts import solid_parts
from validation.adequacy.mechanism.path import RobotOnPath, path_postures, robot_at
from validation.adequacy.mechanism.solids import model_statics
from validation.adequacy.models import JudgedModel, judged_models, why_unable
from validation.adequacy.responses import UNSOLVED
from validation.agreement.displacement import relative
from validation.agreement.responses import Statics
from validation.context import Context
from validation.maps.workspace import Solve
from validation.models.legs import reduced_leg
from validation.models.mechanism import CUTOFF, bodies_of, with_enough_modes
from validation.models.options import ModelOptions

_MICRO, _PERCENT = 1e-6, 100.0


@dataclass(frozen=True, eq=False)
class Mapped:
    """A quantity over the workspace: its `id`, `title`, `unit` and `model`, what it is in words.

    `largest`: whether its worst value is the largest one.
    """

    id: str
    title: str
    unit: str
    model: str
    said: str
    solve: Solve
    largest: bool = False


def mapped(context: Context, mechanism: Mechanism) -> list[Mapped]:
    """What is mapped of a mechanism, the run's robot without its loads, as far as it can be solved.

    The chosen model is the first that is relied on, else the simplest whose error stays within the
    limit on the path, else the one of the smallest error.
    """
    postures = [replace(at, mechanism=mechanism) for at in path_postures(context)]
    robot = robot_at(context, postures)
    references: Sequence[Assembly] = ()
    with suppress(*UNSOLVED):
        references = _references(robot)
    model, chosen = _chosen(robot, references, context.robot_file.requirement)
    found = [
        Mapped(
            "map.stiffness",
            "lowest stiffness",
            "N/µm",
            model,
            "the least force per displacement of the tool over all directions of force, one over "
            f"the largest eigenvalue of its translational compliance, by {model}",
            partial(_lowest_stiffness, chosen),
        )
    ]
    elements = "beam elements" + (", parts as solids" if mechanism.parts else "")
    with suppress(*UNSOLVED):
        found.append(
            Mapped(
                "map.f1",
                "first frequency",
                "Hz",
                elements,
                f"the lowest natural frequency, by {elements}",
                partial(_first_frequency, _finite_elements(robot)),
            )
        )
    if references:
        found.append(
            Mapped(
                "map.error",
                f"error of {model}",
                "%",
                model,
                "how far the displacement under any force is from that of the reference, the "
                "largest over what the robot file leaves open",
                partial(_error, chosen, references),
                largest=True,
            )
        )
    return found


def _chosen(
    robot: RobotOnPath, references: Sequence[Assembly], requirement: Requirement
) -> tuple[str, JudgedModel]:
    able = {
        name: model
        for name, model in judged_models(robot.mechanism).items()
        if not why_unable(robot.postures, model)
    }
    for name in requirement.rely:
        if name in able:
            return name, able[name]
    errors = {}
    for name, model in able.items() if references else ():
        with suppress(*UNSOLVED):
            errors[name] = float(np.max(_error(model, references, robot.postures)))
            if errors[name] <= _PERCENT * requirement.limit(ANY_FORCE):
                break
    name = min(errors, key=errors.__getitem__, default="beam")
    return name, able[name]


def _references(robot: RobotOnPath) -> list[Assembly]:
    """The robot as its statics are judged by, for each of what its file leaves open."""
    found = []
    for ends in robot.holding.alternatives.values():
        tips = {name: solid_tip(robot.context, leg, ends[name]) for name, leg in robot.legs.items()}
        parts = solid_parts(robot.postures, robot.offered, ends)
        found.append(assembly(robot.mechanism, {**links(robot.mechanism, tips), **parts}))
    return found


def _finite_elements(robot: RobotOnPath) -> Assembly:
    """Beams, always reduced, with parts as solids."""
    mechanism, options = robot.mechanism, ModelOptions(parts="condensed")
    parts = solid_parts(robot.postures, robot.offered, robot.holding.first)

    def made(highest: float) -> Assembly:
        def reduce(leg: ConstantLeg | SteppedLeg, own: ModelOptions) -> LegMatrices:
            return reduced_leg("beam", leg, own, highest, CUTOFF["beam"] * highest)

        return assembly(mechanism, {**bodies_of(mechanism, options, reduce), **parts})

    def frequencies(prepared: Assembly) -> Array:
        return _first_frequency(prepared, robot.postures)

    return with_enough_modes(made, frequencies, robot.postures, 1, options)


def _lowest_stiffness(model: JudgedModel, postures: Sequence[Posture]) -> Array:
    found = model_statics(postures, model.kind, model.options).compliances[:, :3, :3]
    with np.errstate(divide="ignore"):
        return np.asarray(_MICRO / np.linalg.eigvalsh(found)[:, -1])


def _first_frequency(prepared: Assembly, postures: Sequence[Posture]) -> Array:
    return swept(prepared, postures, 1).frequencies[:, 0]


def _error(
    model: JudgedModel, references: Sequence[Assembly], postures: Sequence[Posture]
) -> Array:
    """In percent, the largest of those from all references."""
    found = model_statics(postures, model.kind, model.options)
    none = np.zeros_like(found.load_displacements)
    truths = [Statics(swept(one, postures, 0).compliances, none) for one in references]
    sizes = [relative(found - truth, truth, ANY_FORCE).size for truth in truths]
    return np.asarray(_PERCENT * np.max(sizes, axis=0))
