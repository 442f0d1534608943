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
from validation.parts.refinement import refinement_uncertainty

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


def refinement_share(mechanism: Mechanism | None, answer: Callable[[int], Array]) -> Array | float:
    """What the meshes of the parts leave open of the answer on the finest, relative; its shape.

    `answer` gives the values on a rung of the ladder. A part that is a mesh cannot be refined: what
    it leaves open is unknown, and taken as all of it.
    """
    if mechanism is None or not mechanism.parts:
        return 0.0
    if any(found_in(body)[0].mesh is not None for body in mechanism.parts.values()):
        return UNKNOWN
    coarse, middle, fine = (answer(rung) for rung in RUNGS)
    left = refinement_uncertainty(coarse, middle, fine)
    # Where nothing yields, no mesh changes that.
    return np.divide(left, np.abs(fine), out=np.zeros_like(left), where=fine != 0.0)
