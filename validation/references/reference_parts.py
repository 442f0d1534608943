"""Solids of the CAD parts of a mechanism, and their uncertainty due to meshes."""

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
# Relative half-width of a number without an estimate of its uncertainty: all of it.
UNKNOWN = 1.0
# The meshes of parts are of one size in all presets.
FINER_PARTS = "needs finer meshes of the parts, such as --accuracy 0.002 makes"
# Steps above models with equivalent legs.
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
    """Each part on one of its three meshes, reduced for `count` computed modes.

    Statics are exact. `ends`: condition of interfaces that the robot file does not specify, rigid
    or, if free, averaged. `by`: reduction with modes of fixed or free interfaces.
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
    """Condition of interfaces that the robot file does not specify."""
    return "rigid" if ends == "rigid" else "average"


def highest_of_parts(postures: Sequence[Posture], count: int) -> tuple[float, float]:
    """Highest frequency (Hz) of accurate reductions for `count` computed modes, and cut-off.

    It covers the judged modes and as many again: the rest only serves to identify mode shapes.
    """
    highest = highest_frequency(postures, max(_FEWEST, count // 3))
    return highest, CUTOFF["solid"] * highest


def reduction_note(
    postures: Sequence[Posture], count: int, ends: Mapping[str, Ends], judged: int
) -> tuple[str, ...]:
    """Note on the modes kept by the reduction of parts, and its largest error at mid-path.

    Empty if no body is a part. Arguments as in `solid_parts`. Raises ComputationError and
    InputError if the robot has fewer modes than are `judged`.
    """
    parts = solid_parts(postures, count, ends)
    if not parts:
        return ()
    bounds = bounded_frequencies(postures, count, ends, judged)
    counts = ", ".join(
        f"{name} {part.counted} below {part.cutoff:.4g} Hz" for name, part in parts.items()
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

    Arguments as in `solid_parts`, errors as in `reduction_note`.
    """
    parts = solid_parts(postures, count, ends, level, by)
    middle = postures[len(postures) // 2]
    bodies = {**static_bodies("beam", middle.mechanism), **parts}
    return frequency_bounds(assemble(middle, bodies), parts, judged)


def condensed_parts(mechanism: Mechanism) -> dict[str, BodyModel]:
    """Each part condensed on its interfaces, with Guyan's mass."""
    return {name: condensed(body) for name, body in mechanism.parts.items()}


def assembled(
    postures: Sequence[Posture],
    springs: Springs,
    parts: Bodies | None = None,
    masses: Masses = MASSES[0],
) -> Statics:
    """Statics by the assembler, each leg by its tip's compliance (6×6).

    `parts`: models of the CAD parts, condensed on their interfaces if None. `masses`: mass
    distribution of legs known by their 6×6, for loads on masses.
    """
    mechanism = postures[0].mechanism
    part_models = condensed_parts(mechanism) if parts is None else parts
    prepared = assembly(mechanism, {**links(mechanism, springs), **part_models})
    solutions = {system.posture: solved(system) for system in prepared.along(postures)}
    load_displacements = displacements_by(
        lambda posture, loads: tool_displacements(solutions[posture], loads),
        postures,
        masses_of(mechanism, masses, part_models),
    )
    return Statics.of(
        np.array([compliance(solution) for solution in solutions.values()]), load_displacements
    )


def part_kinds(mechanism: Mechanism) -> tuple[PartLegs, ...]:
    """Idealisations of parts in the order of `PART_STEPS`. Empty without parts.

    The last one removes all errors of stepped legs. It is the only one if parts cannot be stepped.
    """
    if not mechanism.parts:
        return ()
    return ("condensed",) if why_not_stepped(mechanism) else ("stepped", "condensed")


def part_policy(mechanism: Mechanism) -> MeshPolicy | float:
    """Policy for the meshes of the parts. 0 without parts.

    A part given as a mesh cannot be refined: its half-width is unknown, and taken as one.
    """
    if not mechanism.parts:
        return 0.0
    has_mesh_file = any(found_in(body)[0].mesh is not None for body in mechanism.parts.values())
    return UNKNOWN if has_mesh_file else TETRAHEDRA
