"""From a leg that stands for a part to the part itself: what each idealisation costs."""

from collections.abc import Callable, Iterable

from lumped.mechanism.mechanism import Mechanism
from validation.adequacy.response import Response, Rung
from validation.models.options import PartLegs
from validation.models.stepped_parts import why_not_stepped

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
    mechanism: Mechanism,
    alternatives: Iterable[str],
    idealised: Callable[[PartLegs], Response],
) -> tuple[Rung, ...]:
    """Rungs above models with equivalent legs, or none where no body is a part.

    The last one is all that stepped legs lack, and the only one where parts cannot be stepped.
    `idealised` gives the response with parts idealised otherwise, all else as in the model.
    """
    if not mechanism.parts:
        return ()
    unstepped = why_not_stepped(mechanism)
    return tuple(
        Rung(cause, source, dict.fromkeys(alternatives, idealised(kind)), remedy)
        for kind, (cause, source, remedy) in _STEPS.items()
        if kind != "stepped" or not unstepped
    )
