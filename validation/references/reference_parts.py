"""CAD parts of a mechanism as their solids, and what their meshes leave open."""

from collections.abc import Mapping, Sequence

import numpy as np

from fem.reduction.craig_bampton import FrequencyBounds, frequency_bounds
from lumped.legs import Ends
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import links
from lumped.system.assembly import assemble, assembly
from lumped.system.loads import tool_displacements
from lumped.system.solution import compliance, solved
from lumped.text import counted
from validation.drawing.text import percent
from validation.models.loads.displacements import displacements_by, masses_of
from validation.models.loads.leg_masses import MASSES, Masses
from validation.models.options import PartLegs, ReductionBy
from validation.models.reduced_parts import Hold, ReducedPart, condensed, found_in, reduced
from validation.models.robot_models import CUTOFF, highest_frequency, static_bodies
from validation.models.stepped_parts import why_not_stepped
from validation.parts.meshes import FINEST
from validation.parts.refinement import TETRAHEDRA
from validation.references.reference import Remedy, StepTexts
from validation.references.robot_on_path import Springs
from validation.responses.statics_and_modes import Statics
from validation.uncertainty.mesh_half_widths import MeshPolicy

Bodies = Mapping[str, BodyModel]
_FEWEST = 8
# Share of an answer that is left open where nothing tells it: all of it.
UNKNOWN = 1.0
# The meshes of parts are of one size in all presets.
FINER_PARTS = "needs finer meshes of the parts, such as --accuracy 0.002 makes"
# Above models with equivalent legs.
PART_STEPS: Mapping[str, StepTexts] = {
    "stepped": StepTexts(
        "one constant section instead of the part",
        "ten prismatic pieces with the part's own sections, beam elements",
        Remedy("step the parts: --parts stepped", "--parts"),
    ),
    "condensed": StepTexts(
        "beam pieces instead of the part",
        "the part condensed on its interfaces",
        Remedy("condense the parts on their interfaces: --parts condensed", "--parts"),
    ),
}


def solid_parts(
    postures: Sequence[Posture],
    count: int,
    ends: Mapping[str, Ends],
    level: int = FINEST,
    by: ReductionBy = "fixed",
) -> dict[str, ReducedPart]:
    """Every part on one of its three meshes, reduced where `count` modes are looked at.

    Statics are exact. `ends`: interfaces of which nobody said how they are held are rigid, or
    averaged where free; `by` modes with interfaces fixed or free.
    """
    mechanism = postures[0].mechanism
    if not mechanism.parts:
        return {}
    highest, cutoff = highest_of_parts(postures, count)
    return {
        name: reduced(body, highest, cutoff, level, hold_of(ends[name]), by)
        for name, body in mechanism.parts.items()
    }


def hold_of(ends: Ends) -> Hold:
    """How interfaces are held of which the robot file does not say it."""
    return "rigid" if ends == "rigid" else "average"


def highest_of_parts(postures: Sequence[Posture], count: int) -> tuple[float, float]:
    """Frequency (Hz) up to which parts are reduced where `count` modes are looked at, and cut-off.

    For those that are judged and as many again: the rest is only there to be told apart from them.
    """
    highest = highest_frequency(postures, max(_FEWEST, count // 3))
    return highest, CUTOFF["solid"] * highest


def reduction_note(
    postures: Sequence[Posture], count: int, ends: Mapping[str, Ends], judged: int
) -> tuple[str, ...]:
    """What the reduction of the parts has kept, and most by which that errs in the middle posture.

    Nothing where no body is a part. Arguments as of `solid_parts`; raises ComputationError and
    InputError where the robot has not as many modes as are `judged`.
    """
    parts = solid_parts(postures, count, ends)
    if not parts:
        return ()
    bounds = bounded_frequencies(postures, count, ends, judged)
    counts = ", ".join(
        f"{name} {one.counted} below {one.cutoff:.4g} Hz" for name, one in parts.items()
    )
    return (
        f"CAD parts keep all modes with fixed interfaces, by count: {counts}; higher ones lower "
        f"the {counted(judged, 'lowest frequency', 'lowest frequencies')} by "
        f"{percent(bounds.relative_width.max(), signed=False)} at most",
    )


def bounded_frequencies(
    postures: Sequence[Posture],
    count: int,
    ends: Mapping[str, Ends],
    judged: int,
    level: int = FINEST,
    by: ReductionBy = "fixed",
) -> FrequencyBounds:
    """The first `judged` frequencies in the middle posture, other bodies beams, and their bounds.

    Arguments as of `solid_parts`; raises as `reduction_note` does.
    """
    parts = solid_parts(postures, count, ends, level, by)
    middle = postures[len(postures) // 2]
    bodies = {**static_bodies("beam", middle.mechanism), **parts}
    return frequency_bounds(assemble(middle, bodies), parts, judged)


def condensed_parts(mechanism: Mechanism) -> dict[str, BodyModel]:
    """Every part on its interfaces alone, with Guyan's mass."""
    return {name: condensed(body) for name, body in mechanism.parts.items()}


def assembled(
    postures: Sequence[Posture],
    springs: Springs,
    parts: Bodies | None = None,
    masses: Masses = MASSES[0],
) -> Statics:
    """Statics by the assembler, every leg by its tip's compliance (6×6).

    `parts`: models of those bodies that are CAD parts; condensed on their interfaces without.
    `masses`: where legs known by their 6×6 have theirs, which loads act on.
    """
    mechanism = postures[0].mechanism
    of_parts = condensed_parts(mechanism) if parts is None else parts
    prepared = assembly(mechanism, {**links(mechanism, springs), **of_parts})
    solutions = {system.posture: solved(system) for system in prepared.along(postures)}
    moved = displacements_by(
        lambda at, loads: tool_displacements(solutions[at], loads),
        postures,
        masses_of(mechanism, masses, of_parts),
    )
    return Statics.of(np.array([compliance(one) for one in solutions.values()]), moved)


def part_kinds(mechanism: Mechanism) -> tuple[PartLegs, ...]:
    """Idealisations of parts by the `PART_STEPS`, in their order; none without parts.

    The last one is all that stepped legs lack, and the only one if parts cannot be stepped.
    """
    if not mechanism.parts:
        return ()
    return ("condensed",) if why_not_stepped(mechanism) else ("stepped", "condensed")


def part_policy(mechanism: Mechanism) -> MeshPolicy | float:
    """Policy for the meshes of the parts; 0 without any. A part that is a mesh cannot be refined.

    Its half-width is unknown, and taken as the whole.
    """
    if not mechanism.parts:
        return 0.0
    given = any(found_in(body)[0].mesh is not None for body in mechanism.parts.values())
    return UNKNOWN if given else TETRAHEDRA
