"""CAD parts of a mechanism as their solids: what models are held against, and how surely."""

from collections.abc import Mapping, Sequence

from fem.reduction.craig_bampton import FrequencyBounds, frequency_bounds
from lumped.legs import Ends
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.system.assembly import assemble
from validation.drawing.text import percent
from validation.models.mechanism import CUTOFF, highest_frequency, static_bodies
from validation.models.options import ReductionBy
from validation.models.parts import Hold, ReducedPart, condensed, reduced
from validation.parts.meshes import FINEST

Bodies = Mapping[str, BodyModel]
_FEWEST = 8


def solid_parts(
    postures: Sequence[Posture],
    count: int,
    ends: Mapping[str, Ends],
    rung: int = FINEST,
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
        name: reduced(body, highest, cutoff, rung, hold_of(ends[name]), by)
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
        f"Modes of the parts as solids with interfaces held, counted by inertia and all kept: "
        f"{counts}; those dropped lower the first {judged} frequencies by "
        f"{percent(bounds.relative_width.max(), signed=False)} at most",
    )


def bounded_frequencies(
    postures: Sequence[Posture],
    count: int,
    ends: Mapping[str, Ends],
    judged: int,
    rung: int = FINEST,
    by: ReductionBy = "fixed",
) -> FrequencyBounds:
    """The first `judged` frequencies in the middle posture, other bodies beams, and their bounds.

    Arguments as of `solid_parts`; raises as `reduction_note` does.
    """
    parts = solid_parts(postures, count, ends, rung, by)
    middle = postures[len(postures) // 2]
    bodies = {**static_bodies("beam", middle.mechanism), **parts}
    return frequency_bounds(assemble(middle, bodies), parts, judged)


def condensed_parts(mechanism: Mechanism) -> dict[str, BodyModel]:
    """Every part on its interfaces alone, with Guyan's mass."""
    return {name: condensed(body) for name, body in mechanism.parts.items()}
