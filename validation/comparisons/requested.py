"""Convergence study that a user requests by command or Python, of a robot or one of its legs.

Input: a robot file and the options of the request. Output: a `ConvergenceStudy`. Raises InputError
with all faults of the options.
"""

from collections.abc import Sequence

from lumped.acceptance.requirement import MOST_ELEMENTS
from lumped.equivalent_leg import sectioned_leg
from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.model_choices import Theory
from lumped.models.bodies import legs_of
from lumped.robot_file import RobotFile
from validation.comparisons.convergence_study import ConvergenceStudy
from validation.comparisons.discretisations import EULER_BERNOULLI, FORMULATIONS
from validation.comparisons.element_convergence import COUNTS, leg_convergence, robot_convergence
from validation.comparisons.mesh_convergence import DIVISIONS, leg_mesh_convergence
from validation.context import Context
from validation.models.options import RefinedModel
from validation.models.reduced_parts import is_leg
from validation.models.stepped_parts import PIECES, stepped
from validation.references.responses import Responses
from validation.references.robot_on_path import robot_at
from validation.run.executor import Executor, in_turn


def convergence(
    robot_file: RobotFile,
    *,
    model: RefinedModel | None = None,
    body: str | None = None,
    elements: Sequence[int] | None = None,
    divisions: Sequence[int] | None = None,
    theory: Theory | None = None,
    executor: Executor = in_turn,
) -> ConvergenceStudy:
    """Convergence study of the robot in the middle of its path, or of the leg `body`.

    `model`: if None, segments in both layouts, and beam elements. `elements`: element counts per
    leg; if None, the counts of `element_convergence.COUNTS` and the count of table [agree].
    `divisions`: numbers of solid elements across the section of the leg; if they are given, the leg
    is a solid, and if None, a solid has those of `mesh_convergence.DIVISIONS`. `theory`: if None,
    Timoshenko's. `executor` computes the counts or meshes. Raises InputError with all faults of the
    arguments.
    """
    mechanism = robot_file.mechanism
    if faults := _faults(mechanism, model, body, elements, divisions, theory):
        raise InputError(faults)
    # A leg alone has no pose.
    at = middle_posture(mechanism) if body is None else reference_posture(mechanism)
    responses = Responses(robot_at(Context(robot_file), [at]), strict=True)
    if model == "solid" or divisions is not None:
        leg = sectioned_leg(legs_of(mechanism)[str(body)])
        return leg_mesh_convergence(
            responses, str(body), leg, divisions=divisions or DIVISIONS, executor=executor
        )
    formulations = EULER_BERNOULLI if theory == "euler-bernoulli" else FORMULATIONS
    discretisations = [
        discretisation for discretisation in formulations if model in (None, discretisation.model)
    ]
    counts = tuple(elements or {*COUNTS, robot_file.agreement.elements})
    if body in mechanism.parts or (body is None and mechanism.parts):
        # Each prismatic piece has a whole number of elements. The literal layout is defined for one
        # prism.
        discretisations = [
            discretisation
            for discretisation in discretisations
            if discretisation.layout != "literal"
        ]
        counts = tuple(count for count in counts if count % PIECES == 0)
        if not counts:
            raise InputError(
                f"elements: must be multiples of {PIECES}, the number of pieces of a "
                "stepped CAD part"
            )
    if body is None:
        return robot_convergence(responses, discretisations, counts, executor)
    legs = legs_of(mechanism)
    leg_alone = sectioned_leg(legs[body]) if body in legs else stepped(mechanism.parts[body])
    return leg_convergence(responses, body, leg_alone, discretisations, counts, executor)


def leg_names(mechanism: Mechanism) -> list[str]:
    """Names of bodies with a convergence study: all legs, and CAD parts with two interfaces."""
    parts = (name for name, part in mechanism.parts.items() if is_leg(part))
    return [*legs_of(mechanism), *parts]


def middle_posture(mechanism: Mechanism) -> Posture:
    """Posture in the middle of the path. The reference posture if the robot has no path."""
    poses = mechanism.poses
    return (
        posture(mechanism, poses[len(poses) // 2]) if len(poses) else reference_posture(mechanism)
    )


def _faults(
    mechanism: Mechanism,
    model: RefinedModel | None,
    body: str | None,
    elements: Sequence[int] | None,
    divisions: Sequence[int] | None,
    theory: Theory | None,
) -> list[str]:
    faults = []
    legs = legs_of(mechanism)
    names = leg_names(mechanism)
    solid = model == "solid" or divisions is not None
    if body is not None and body not in names:
        leg_list = ", ".join(names) or "none"
        faults.append(f"body {body}: not a leg of the robot; must be one of {leg_list}")
    elif solid and body is None:
        faults.append("model solid: needs a body, because solids converge leg by leg; add body")
    elif solid and body not in legs:
        faults.append(
            f"body {body}: is a CAD part; use the command identify, which refines its mesh"
        )
    if solid and elements is not None:
        faults.append(
            "elements: not for model solid, which has divisions; leave elements out or "
            "choose another model"
        )
    if solid and theory is not None:
        faults.append("theory: not for model solid; leave theory out or choose another model")
    if theory not in (None, "timoshenko", "euler-bernoulli"):
        faults.append(f"theory {theory}: must be timoshenko or euler-bernoulli")
    if divisions is not None and model not in (None, "solid"):
        faults.append(
            f"divisions: only for model solid; {model} has elements; leave divisions out or "
            "choose model solid"
        )
    for name, counts in (("elements", elements), ("divisions", divisions)):
        if counts is not None and (not counts or min(counts) < 1):
            listed = ", ".join(map(str, counts)) or "none"
            faults.append(f"{name} = {listed}: must be one or more whole numbers, each at least 1")
    if elements and max(elements) > MOST_ELEMENTS:
        faults.append(f"elements = {max(elements)}: must be at most {MOST_ELEMENTS}")
    return faults
