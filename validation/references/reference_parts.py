"""CAD parts of a mechanism as reduced solids, their mesh policy, and statics of assembled models.

Input: postures, end conditions of the interfaces and the mesh level (0 coarse, 1, 2 fine). Output:
models of the parts, reduced to their interfaces with all modes below a cut-off frequency, and
rigorous bounds of the robot's frequencies, which enclose the effect of the omitted modes. Rule for
the cut-off: it lies above the highest judged frequency by the factor `CUTOFF["solid"]`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from fem.reduction.craig_bampton import FrequencyBounds, frequency_bounds
from lumped.arrays import Array
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.load import LineLoad
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.model_choices import Ends, PartLegs, ReductionBy
from lumped.models.bodies import links
from lumped.system.assembly import assemble, assembly
from lumped.system.loads import tool_displacements
from lumped.system.solution import compliance, solved
from lumped.text import counted
from validation.drawing.text import percent
from validation.models.loads.leg_masses import MASSES, Masses
from validation.models.loads.statics import displacements_by, interface_loads
from validation.models.reduced_parts import Hold, ReducedPart, condensed, found_in, reduced
from validation.models.robot_bodies import CUTOFF, static_bodies
from validation.models.robot_models import highest_frequency
from validation.models.stepped_parts import why_not_stepped
from validation.parts.meshes import FINEST
from validation.parts.refinement import TETRAHEDRA
from validation.references.robot_on_path import Springs
from validation.responses.statics_and_modes import Statics
from validation.uncertainty.half_widths import MeshPolicy

Bodies = Mapping[str, BodyModel]
_FEWEST = 8
# Relative half-width of a number whose uncertainty cannot be estimated: 100 %.
UNKNOWN = 1.0
# Names --accuracy, since no preset has finer meshes of parts.
FINER_PARTS = "undecided because of the mesh uncertainty of the parts; refine with --accuracy 0.002"


def solid_parts(
    postures: Sequence[Posture],
    count: int,
    ends: Mapping[str, Ends],
    level: int = FINEST,
    by: ReductionBy = "fixed",
) -> dict[str, ReducedPart]:
    """Reduced model of each CAD part on the mesh `level`, for a robot with `count` computed modes.

    Statics are exact. `ends` is the condition of interfaces for which the robot file states none:
    "rigid", or "free" for averaged ones. `by` selects modes with fixed or with free interfaces.
    """
    mechanism = postures[0].mechanism
    if not mechanism.parts:
        return {}
    highest, cutoff = highest_of_parts(postures, count)
    return {
        name: reduced(body, highest, cutoff, level, interface_coupling(ends[name]), by)
        for name, body in mechanism.parts.items()
    }


def interface_coupling(ends: Ends) -> Hold:
    """Coupling of an interface for an end condition: rigid, or averaged if the ends are free."""
    return "rigid" if ends == "rigid" else "average"


def highest_of_parts(postures: Sequence[Posture], count: int) -> tuple[float, float]:
    """Highest frequency (Hz) at which reduced parts must be accurate, and cut-off frequency (Hz).

    The first frequency covers `count`/3 modes, at least `_FEWEST`. Of the `count` computed modes,
    at most a sixth are judged. The highest ones only help to identify mode shapes.
    """
    highest = highest_frequency(postures, max(_FEWEST, count // 3))
    return highest, CUTOFF["solid"] * highest


def reduction_note(
    postures: Sequence[Posture], count: int, ends: Mapping[str, Ends], judged: int
) -> tuple[str, ...]:
    """Note on the modes kept in each reduced part, and the frequency error due to omitted modes.

    The error is the largest one among the `judged` lowest frequencies in the middle pose. Empty if
    there are no CAD parts. The other arguments are those of `solid_parts`. Raises ComputationError
    or InputError if the modes cannot be computed.
    """
    parts = solid_parts(postures, count, ends)
    if not parts:
        return ()
    bounds = bounded_frequencies(postures, count, ends, judged)
    counts = ", ".join(
        f"{name} {part.counted} below {part.cutoff:.4g} Hz" for name, part in parts.items()
    )
    return (
        (
            "Reduction of the CAD parts keeps all fixed-interface modes below a cut-off, "
            f"confirmed by a mode count: {counts}; the omitted higher modes lower the "
            f"{counted(judged, 'lowest frequency', 'lowest frequencies')} by "
            f"{percent(bounds.relative_width.max(), signed=False)} at most"
        ),
    )


def bounded_frequencies(
    postures: Sequence[Posture],
    count: int,
    ends: Mapping[str, Ends],
    judged: int,
    level: int = FINEST,
    by: ReductionBy = "fixed",
) -> FrequencyBounds:
    """First `judged` frequencies in the middle pose with their bounds due to omitted part modes.

    Other bodies are beams. The other arguments are those of `solid_parts`, and exceptions are those
    of `reduction_note`.
    """
    parts = solid_parts(postures, count, ends, level, by)
    middle = postures[len(postures) // 2]
    bodies = {**static_bodies("beam", middle.mechanism), **parts}
    return frequency_bounds(assemble(middle, bodies), parts, judged)


def condensed_parts(mechanism: Mechanism) -> dict[str, BodyModel]:
    """Model of each CAD part condensed to its interfaces by its stiffness, with Guyan's mass."""
    return {name: condensed(body) for name, body in mechanism.parts.items()}


def assembled(
    postures: Sequence[Posture],
    springs: Springs,
    parts: Bodies | None = None,
    masses: Masses = MASSES[0],
    line_wrenches: Mapping[str, Callable[[LineLoad], Array]] | None = None,
) -> Statics:
    """Statics of the assembled mechanism, with each leg replaced by its 6×6 tip compliance.

    `parts` are models of the CAD parts; if None, they are condensed to their interfaces. `masses`
    is the mass distribution of legs specified by their 6×6 compliance, for loads that act on
    masses. `line_wrenches` is that of `InterfaceLoads`; None is an empty one.
    """
    mechanism = postures[0].mechanism
    part_models = condensed_parts(mechanism) if parts is None else parts
    prepared = assembly(mechanism, {**links(mechanism, springs), **part_models})
    solutions = {system.posture: solved(system) for system in prepared.along(postures)}
    load_displacements = displacements_by(
        lambda posture, loads: tool_displacements(solutions[posture], loads),
        postures,
        replace(interface_loads(mechanism, masses, part_models), line_wrenches=line_wrenches or {}),
    )
    return Statics(
        np.array([compliance(solution) for solution in solutions.values()]), load_displacements
    )


def part_kinds(mechanism: Mechanism) -> tuple[PartLegs, ...]:
    """Idealisations of CAD parts between beam and solid, in the order of `model_ladder.PART_STEPS`.

    Empty if there are no parts. Only "condensed" if a part cannot be represented by prismatic
    pieces.
    """
    if not mechanism.parts:
        return ()
    return ("condensed",) if why_not_stepped(mechanism) else ("stepped", "condensed")


def part_policy(mechanism: Mechanism) -> MeshPolicy | float:
    """Mesh policy of the CAD parts, or their half-width as a number: 0 if there are no parts.

    If the file of a part is a mesh, this mesh cannot be refined, and the relative half-width is
    taken as 1.
    """
    if not mechanism.parts:
        return 0.0
    has_mesh_file = any(found_in(body)[0].mesh is not None for body in mechanism.parts.values())
    return UNKNOWN if has_mesh_file else TETRAHEDRA
