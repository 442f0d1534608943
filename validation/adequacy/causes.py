"""Why a model is off and what would help: steps from the model towards the reference.

Every step of a model's ladder removes one named cause by a computation of its own, none of which
knows the reference; what the ladder does not reach is the rest, and is shown as such.
"""

from collections.abc import Sequence

import numpy as np

from lumped.acceptance.requirement import STATIC_QUANTITIES
from validation.adequacy.errors import Errors, Scale
from validation.adequacy.matrix import Cause
from validation.adequacy.response import Candidate, Response, Step
from validation.agreement.displacement import displacement

REST = "rest, not attributed"
# Causes below this share of an error are not named, steps below this part of a limit not taken.
_WORTH_NAMING, _WORTH_TAKING = 0.005, 0.1


def explained(
    scale: Scale, candidate: Candidate, quantity: str, errors: Errors, pose: int
) -> tuple[Cause, ...]:
    """Causes of the error at a pose (its index), the largest first; shares sum to one.

    Where the reference has alternatives, error and amounts are means over them. The error of a
    deflection is the length of a vector; a step takes off it what it does along that vector, under
    the load that the error is of.
    """
    if errors.missing[:, pose].any():
        return ()
    total = float(np.mean(errors.error[:, pose]))
    if total == 0.0:
        return ()
    amounts: dict[str, float] = {}
    sources: dict[str, str] = {REST: "error less the causes named"}
    before = [candidate.response] * len(errors.names)
    for step in steps_of(candidate, quantity):
        after = [step.responses[name] for name in errors.names]
        amount = _amount(scale, quantity, errors, before, after, pose)
        if amount is None:
            if unsolved := next(filter(None, (one.unsolved(quantity) for one in after)), ""):
                sources[REST] += f"; {step.cause} cannot be computed: {unsolved}"
            break
        amounts[step.cause] = amounts.get(step.cause, 0.0) + amount
        sources.setdefault(step.cause, step.source)
        before = after
    amounts[REST] = total - sum(amounts.values())
    found = [Cause(name, amount / total, sources[name]) for name, amount in amounts.items()]
    named = [cause for cause in found if abs(cause.share) >= _WORTH_NAMING]
    return tuple(sorted(named, key=lambda cause: -abs(cause.share)))


def _amount(
    scale: Scale,
    quantity: str,
    errors: Errors,
    before: Sequence[Response],
    after: Sequence[Response],
    pose: int,
) -> float | None:
    """What the step from `before` to `after` takes off an error; None where it has no answer."""
    if errors.loaded is None:
        first, second = scale.errors(before, quantity), scale.errors(after, quantity)
        if first is None or second is None or second.missing[:, pose].any():
            return None
        return float(np.mean(first.error[:, pose] - second.error[:, pose]))
    loaded, amounts = errors.loaded, []
    for k, (one, other) in enumerate(zip(before, after, strict=True)):
        if one.compliance is None or other.compliance is None:
            return None
        change = one.compliance[pose] - other.compliance[pose]
        step = displacement(change, loaded.load[k, pose], quantity)
        off, size = loaded.off[k, pose], float(errors.error[k, pose])
        amounts.append(float(step @ off) / (loaded.length[k, pose] * size) if size > 0.0 else 0.0)
    return float(np.mean(amounts))


def remedied(
    scale: Scale, candidate: Candidate, quantity: str, errors: Errors, limit: float, pose: int
) -> tuple[str, float | None]:
    """The shortest way up the ladder that brings the error within its limit, or nearest to it.

    With the error that it leaves: the largest over all poses, in the middle of what is left open.
    Only those steps are named that change anything worth the name. ("", None) where none helps.
    """
    tried: list[tuple[float, float, str]] = []
    remedies: list[str] = []
    start = before = float(errors.middle[pose])
    for step in steps_of(candidate, quantity):
        after = scale.errors([step.responses[name] for name in errors.names], quantity)
        if after is None:
            break
        middle = after.middle
        if step.remedy and not abs(middle[pose] - before) < _WORTH_TAKING * limit:
            remedies.append(step.remedy)
        if step.remedy and remedies and np.isfinite(middle).all():
            worst = float(middle[np.argmax(np.abs(middle))])
            tried.append((abs(worst), worst, ", ".join(dict.fromkeys(remedies))))
        # A step without a remedy of its own is taken together with the next one.
        before = float(middle[pose]) if step.remedy else before
    if not tried:
        return "", None
    enough = [one for one in tried if one[0] <= limit]
    size, error, remedy = enough[0] if enough else min(tried)
    if np.isfinite(start) and size >= abs(start):
        return "", None
    return remedy, error


def steps_of(candidate: Candidate, quantity: str) -> Sequence[Step]:
    """The candidate's ladder for a quantity."""
    static = quantity in STATIC_QUANTITIES
    return candidate.static_steps if static else candidate.dynamic_steps
