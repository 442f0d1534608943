"""Reference for the displacements of a robot, and the causes of models' displacement errors.

Input: the robot along its path with its computed statics. Output: a `Reference` with one
interpretation for each set of end conditions that the robot file allows, and for each judged model
its sequence of intermediate models. Rule: the robot is assembled from its legs and CAD parts. Legs
with a cross-section and CAD parts are 3-D solids; other legs have the 6×6 compliance of the robot
file.
"""

from validation.references.corners_and_steps import CORNERS, SOURCE, STEPS, has_jumps
from validation.references.model_ladder import (
    COMPUTED_BEAMS,
    EQUIVALENT,
    GIVEN,
    PART_STEPS,
    RESTRAINED,
    SOLID,
    STRAIGHT,
    WARPING_BEAMS,
    WITH_JUMPS,
    with_parts,
)
from validation.references.reference import (
    TIMOSHENKO,
    USE_SOLID,
    Interpretation,
    Reference,
    Step,
    use,
)
from validation.references.reference_legs import finer_statics, solid_leg
from validation.references.reference_parts import FINER_PARTS, part_kinds
from validation.references.responses import Model, Responses
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


def static_steps(robot: RobotOnPath) -> dict[str, Step]:
    """Steps of `all_static_steps` that exist for a robot, by name."""
    parts = robot.mechanism.parts
    steps = all_static_steps(robot.static_model, with_parts("equivalent") if parts else EQUIVALENT)
    applicable = {"drives", "shear", *part_kinds(robot.mechanism)}
    if robot.given:
        applicable |= {"diagonal", "couplings"}
    if robot.prisms:
        applicable |= set(TO_SOLIDS)
    if not any(has_jumps(leg) for leg in robot.prisms):
        applicable.discard("jumps")
    return {name: steps[name] for name in applicable}


def all_static_steps(static_model: str, equivalent: Model) -> dict[str, Step]:
    """Steps from all judged models to the static reference, by name.

    `static_model` is the model that the intermediate models use, and `equivalent` the one with
    equivalent legs of constant section.
    """
    by = _BY[static_model]
    given = use(static_model, " with the specified 6×6 compliance: --legs given", "--legs")
    return {
        "drives": Step(
            "elastic drives only, bodies and joints rigid",
            f"{by}the specified legs",
            GIVEN,
            use(static_model),
        ),
        "shear": Step(
            "shear deformation neglected", f"{by}Timoshenko's cantilever", equivalent, TIMOSHENKO
        ),
        # Steps from the equivalent prism to the 6×6 from which it was made, then steps of CAD
        # parts.
        "diagonal": Step(
            "equivalent leg, whose diagonal of the compliance differs from the 6×6 compliance",
            f"{by}the straight leg's entries of the 6×6 compliance",
            STRAIGHT,
        ),
        "couplings": Step(
            "equivalent leg, which lacks couplings of the 6×6 compliance",
            f"{by}the specified 6×6 compliance",
            GIVEN,
            given,
        ),
        **PART_STEPS,
        # Last steps: from textbook section constants to solids with rigid end faces.
        "own": Step(
            "section constants by textbook formulas",
            "fem.sections.section_constants, tip of the cantilever",
            COMPUTED_BEAMS,
        ),
        "warping": Step(
            "restrained warping at the ends",
            "Reissner's torsion with restrained ends and the warping constant Γ of the section",
            WARPING_BEAMS,
        ),
        "contraction": Step(
            "restrained contraction and shear warping at the ends",
            "fem.couplings.end_effects, exact along the leg",
            RESTRAINED,
        ),
        "jumps": Step(f"{CORNERS}, {STEPS}", SOURCE, WITH_JUMPS),
    }


# Names of steps in `all_static_steps`: from textbook section constants to solids, and from the
# equivalent prism to solids.
TO_SOLIDS = ("own", "warping", "contraction", "jumps")
FROM_CONSTANT = ("diagonal", "couplings", *PART_STEPS, *TO_SOLIDS)
