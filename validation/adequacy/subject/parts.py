"""From a leg that stands for a CAD part to the part itself, and what the part's meshes leave open.

Of a robot without parts, nothing.
"""

from collections.abc import Callable, Iterable

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.mechanism import Mechanism
from validation.adequacy.response import Response, Rung
from validation.models.options import PartLegs
from validation.models.parts import found_in
from validation.models.stepped_parts import why_not_stepped
from validation.parts.meshes import RUNGS
from validation.parts.refinement import left_by_changes

# Share of an answer that is left open where nothing tells it: all of it.
UNKNOWN = 1.0
# The meshes of parts are of one size in all presets.
FINER_PARTS = "finer meshes of the parts than any preset makes"
_STEPS: dict[PartLegs, tuple[str, str, str]] = {
    "stepped": (
        "one section from end to end in the place of the part",
        "ten prismatic pieces with the part's own sections, beam elements",
        "step the legs along the parts: --parts stepped",
    ),
    "condensed": (
        "pieces of beams in the place of the part",
        "the part condensed on its interfaces",
        "condense the parts on their interfaces: --parts condensed",
    ),
}


def part_rungs(
    mechanism: Mechanism | None,
    alternatives: Iterable[str],
    idealised: Callable[[PartLegs], Response],
) -> tuple[Rung, ...]:
    """Rungs above models with equivalent legs, or none without parts.

    The last one is all that stepped legs lack, and the only one where parts cannot be stepped.
    `idealised` gives the response with parts idealised otherwise, all else as in the model.
    """
    if mechanism is None or not mechanism.parts:
        return ()
    unstepped = why_not_stepped(mechanism)
    return tuple(
        Rung(cause, source, dict.fromkeys(alternatives, idealised(kind)), remedy)
        for kind, (cause, source, remedy) in _STEPS.items()
        if kind != "stepped" or not unstepped
    )


def number_by_number(difference: Array, values: Array) -> Array:
    """Sizes of differences relative to the values; 0 where nothing yields: no mesh changes that."""
    share = np.zeros_like(values)
    return np.divide(np.abs(difference), np.abs(values), out=share, where=values != 0.0)


def refinement_share(
    mechanism: Mechanism | None,
    answer: Callable[[int], Array],
    sizes: Callable[[Array, Array], Array] = number_by_number,
) -> Array | float:
    """What the meshes of the parts leave open of the answer on the finest, relative.

    `answer` gives the values on a rung of the ladder, `sizes` how large differences of them are
    relative to those on the finest, number by number where nothing else is said. A part that is a
    mesh cannot be refined: what it leaves open is unknown, and taken as all of it.
    """
    if mechanism is None or not mechanism.parts:
        return 0.0
    if any(found_in(body)[0].mesh is not None for body in mechanism.parts.values()):
        return UNKNOWN
    coarse, middle, fine = (answer(rung) for rung in RUNGS)
    return left_by_changes(sizes(middle - coarse, fine), sizes(fine - middle, fine))
