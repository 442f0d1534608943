"""Reference for the displacements of a robot, and the causes of models' displacement errors.

Input: the robot along its path with its computed statics. Output: a `Reference` with one
interpretation for each set of end conditions that the robot file allows, and for each judged model
its sequence of intermediate models. Rule: the robot is assembled from its legs and CAD parts. Legs
with a cross-section and CAD parts are 3-D solids; other legs have the 6×6 compliance of the robot
file.
"""

from collections.abc import Mapping, Sequence

from validation.references.model_ladder import (
    COMPUTED_BEAMS,
    EQUIVALENT,
    GIVEN,
    RESTRAINED,
    SOLID,
    STRAIGHT,
    WARPING_BEAMS,
    with_parts,
)
from validation.references.reference import (
    TIMOSHENKO,
    USE_SOLID,
    Interpretation,
    Reference,
    Steps,
    StepTexts,
    steps_by_model,
    use,
)
from validation.references.reference_legs import finer_statics, solid_leg
from validation.references.reference_parts import FINER_PARTS, PART_STEPS, part_kinds
from validation.references.responses import Responses
from validation.references.robot_on_path import Reading, RobotOnPath
from validation.references.uncertainty_sources import STATIC_ROWS, budget

_BY = {"vjm": "virtual joints with ", "links": "links with "}


def static_reference(responses: Responses) -> Reference:
    """Static reference of a robot.

    Raises InputError if the mesh of a section would be too large.
    """
    robot = responses.robot
    context, parts = robot.context, robot.mechanism.parts
    # The legs are solved first, so that an error names a preset that can mesh the leg.
    for leg in robot.prisms:
        solid_leg(context, leg)
    interpretations = [
        Interpretation(name, reading, budget(STATIC_ROWS, responses, reading))
        for name, ends in robot.holding.alternatives.items()
        for reading in [Reading(ends)]
    ]
    leg_function = (
        "fem.bodies.doubling.condensed_leg" if robot.prisms else "lumped.legs.given_compliance"
    )
    return Reference(
        title=_reference_title(robot),
        model=SOLID,
        interpretations=interpretations,
        open=robot.holding.unspecified,
        decides=robot.holding.decides,
        masses=robot.masses_instruction,
        finer=FINER_PARTS if parts else finer_statics(context, robot.legs.values()),
        remedy=None if robot.given else USE_SOLID,
        computed_by=(
            *((leg_function,) if robot.legs else ()),
            *(("validation.models.reduced_parts.reduced",) if parts else ()),
            "lumped.system.solution.compliance",
        ),
    )


def _reference_title(robot: RobotOnPath) -> str:
    """Title of the static reference in reports."""
    names = ", ".join(robot.given)
    if robot.mechanism.parts:
        solid = " and solid legs" if robot.prisms else ""
        legs_text = f", {names} by their specified 6×6 compliance" if names else ""
        return f"robot assembled from solid parts{solid}{legs_text}"
    if not robot.legs:
        return "robot assembled from rigid bodies"
    if not robot.prisms:
        return "robot assembled from legs with the specified 6×6 matrices"
    legs_text = f" and {names} by their specified 6×6 compliance" if names else ""
    return f"robot assembled from solid legs{legs_text}"


def static_steps(robot: RobotOnPath, orders: Mapping[str, Sequence[str]]) -> Steps:
    """Intermediate models between each judged model and the static reference.

    The result and `orders` have the name of the judged model as key. Each intermediate model
    removes one cause of error. `orders`: names of the steps in `STATIC_STEPS`, from the judged
    model to the reference.
    """
    parts = robot.mechanism.parts
    equivalent = with_parts("equivalent") if parts else EQUIVALENT
    models = {"drives": GIVEN, "shear": equivalent}
    if robot.given:
        models |= {"diagonal": STRAIGHT, "couplings": GIVEN}
    models |= {kind: with_parts(kind) for kind in part_kinds(robot.mechanism)}
    if robot.prisms:
        models |= {"own": COMPUTED_BEAMS, "warping": WARPING_BEAMS, "contraction": RESTRAINED}
    return steps_by_model(
        orders, STATIC_STEPS, models, by=_BY[robot.static_model], static_model=robot.static_model
    )


STATIC_STEPS: Mapping[str, StepTexts] = {
    "drives": StepTexts(
        "elastic drives only, bodies and joints rigid",
        "{by}the specified legs",
        use("{static_model}"),
    ),
    "shear": StepTexts(
        "shear deformation neglected",
        "{by}Timoshenko's cantilever",
        TIMOSHENKO,
    ),
    # Steps from the equivalent prism to the 6×6 from which it was made, then steps of CAD parts.
    "diagonal": StepTexts(
        "equivalent leg, whose diagonal of the compliance differs from the 6×6 compliance",
        "{by}the straight leg's entries of the 6×6 compliance",
    ),
    "couplings": StepTexts(
        "equivalent leg, which lacks couplings of the 6×6 compliance",
        "{by}the specified 6×6 compliance",
        use("{static_model}", " with the specified 6×6 compliance: --legs given", "--legs"),
    ),
    **PART_STEPS,
    # Last steps: from textbook section constants to solids with rigid end faces.
    "own": StepTexts(
        "section constants by textbook formulas",
        "fem.sections.section_constants, tip of the cantilever",
    ),
    "warping": StepTexts(
        "restrained warping at the ends",
        "Reissner's torsion with restrained ends and the warping constant Γ of the section",
    ),
    "contraction": StepTexts(
        "restrained contraction and shear warping at the ends",
        "fem.couplings.end_effects, exact along the leg",
    ),
}
# Names of steps in `STATIC_STEPS`: from textbook section constants to solids, and from the
# equivalent prism to solids.
TO_SOLIDS = ("own", "warping", "contraction")
FROM_CONSTANT = ("diagonal", "couplings", *PART_STEPS, *TO_SOLIDS)
