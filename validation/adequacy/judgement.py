"""From errors to verdicts: which pose decides, what is left open, why, and what would help.

Every step of a model's ladder removes one named cause by a computation of its own, none of which
knows the reference; what the ladder does not reach is the rest, and is shown as such.
"""

from collections.abc import Mapping, Sequence
from itertools import compress
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from lumped.acceptance.quantities import ANY_FORCE, ORDER, Quantity, QuantityKind
from lumped.acceptance.requirement import Requirement
from lumped.arrays import Array, IntArray
from validation.adequacy.errors import Errors, ModelErrors, first_largest
from validation.adequacy.probability import Probability, UncertainInputs, probability
from validation.references.reference import NOT_FINER, SAY_LINEAR, Reference, Source, Subject
from validation.references.responses import Model
from validation.references.robot_on_path import NOMINAL
from validation.responses.statics_and_modes import Unsolved
from validation.verdicts import Adequacy, Cause, Entry, Matrix, ModelNote, worst_of

REST = "rest, not attributed"
_NO_MASS = "neither its rigid bodies nor its tool have mass: it has no frequencies"
_DECIDED_BY: Mapping[str, str] = {
    Source.DIGITS: "give the 6×6 in the robot file with more digits",
    Source.LINEARITY: SAY_LINEAR,
    Source.PAIRING: "shapes of close modes mix and do not decide which mode of the model is which",
}
_UNDECIDED_SHAPES = "several modes of the reference have the shape of one mode"
# Causes below this share of an error are not named, steps below this part of a limit not taken.
_WORTH_NAMING, _WORTH_TAKING = 0.005, 0.1
_NEARLY = 0.5
# Interpretation of the reference and pose, by number, that an entry has its numbers of.
Place: TypeAlias = tuple[int, int]


def judged(subject: Subject, requirement: Requirement) -> Matrix:
    """The matrix of a robot: every model by every quantity that it defines.

    Its parts are judged with it, what beams get wrong of one alone is noted. Where inputs of the
    robot are uncertain, a verdict that they leave less than 95 % probable is none.
    """
    model_errors = ModelErrors(subject, requirement.modes)
    inputs = UncertainInputs(model_errors, subject.inputs) if subject.inputs else None
    named = {*subject.loads, *subject.harmonics}
    quantities = tuple(
        quantity
        for quantity in requirement.quantities
        if quantity in named or not (quantity.kind is QuantityKind.LOAD or quantity.harmonic)
    )
    entries = [
        entry
        for model in subject.models
        for quantity in quantities
        if (entry := _entry(model_errors, model, quantity, requirement, inputs))
    ]
    return Matrix(
        robot=subject.robot,
        coordinates=subject.coordinates,
        poses=tuple(_pose(subject, p) for p in range(len(subject.poses))),
        models=tuple(
            ModelNote(one.name, one.title, _silent(subject, one)) for one in subject.models
        ),
        quantities=quantities,
        entries=tuple(entries),
        notes=subject.notes,
        supposed=subject.dynamics.supposed,
        parts=tuple(judged(part, requirement) for part in subject.parts),
        formulation=judged(subject.formulation, requirement) if subject.formulation else None,
        faults=(*subject.responses.faults, *subject.faults),
    )


def _silent(subject: Subject, model: Model) -> str:
    """Reason why a model does not define a half. "" if there is none."""
    massless = model.modes is not None and subject.responses.modes(model, NOMINAL) is None
    return model.silent or (_NO_MASS if massless else "")


def _entry(
    model_errors: ModelErrors,
    model: Model,
    quantity: Quantity,
    requirement: Requirement,
    inputs: UncertainInputs | None,
) -> Entry | None:
    subject = model_errors.subject
    reference = subject.reference(quantity)
    errors = model_errors.errors(model, quantity)
    if errors is None:
        return _unknown(subject, model, quantity, requirement.limit(quantity))
    limits = _limits(errors, quantity, requirement)
    verdicts = verdicts_of(errors, limits)
    verdict = worst_of(verdicts)
    pose = _deciding(verdicts, verdict, errors.bound / limits)
    limit = float(limits[pose])
    path = np.arange(len(limits))
    chosen = _chosen(errors, pose)
    place = int(chosen[pose]), pose
    missing = np.asarray(errors.missing.any(axis=0))
    error, spread, low, high = (
        _optional(np.where(missing, np.nan, one))
        for one in (errors.error[chosen, path], errors.spread[chosen, path], *errors.interval)
    )
    alongs = _alongs(errors, chosen)
    causes = (
        explained(model_errors, model, quantity, errors, place) if verdict != "adequate" else ()
    )
    remedy, left = "", None
    if verdict == "inadequate":
        remedy, left = remedied(model_errors, model, quantity, errors, limit, pose)
    off = inputs.error(model, quantity, errors) if inputs else None
    known = probability(off, verdict, limits, pose) if off else None
    there = not missing[pose]
    return Entry(
        model=model.name,
        quantity=quantity,
        error=error[pose],
        uncertainty=spread[pose],
        low=low[pose],
        high=high[pose],
        readings=_readings(errors, pose),
        limit=limit,
        verdict=known.settled(verdict) if known else verdict,
        pose=_pose(subject, pose),
        reference=reference.title,
        causes=causes,
        remedy=remedy,
        error_with_remedy=left,
        reason=(known.decides if known else "")
        or _reason(errors, model, quantity, verdict, reference, place, limits),
        value=float(errors.value[place]) if there else None,
        expected=float(errors.expected[place]) if there else None,
        expected_range=_expected_range(errors, pose) if there else (),
        along=alongs[pose] if alongs else None,
        force=_force(errors, quantity, place),
        uncertainties=_parts(errors, reference, place) | _of_inputs(known) if there else {},
        errors=error,
        spreads=spread,
        lows=low,
        highs=high,
        # Of another force, or another mode, at every pose numbers make no series.
        values=() if quantity in (ANY_FORCE, ORDER) else _optional(errors.value[0]),
        alongs=alongs,
        computed_by=(*model.computed_by, *reference.computed_by),
        probability=known.within if known else None,
        probability_beyond=known.beyond if known else None,
        input_shares=known.shares if known else {},
        value_spread=known.of_value if known else None,
        assumed=reference.supposed,
    )


def _limits(errors: Errors, quantity: Quantity, requirement: Requirement) -> Array:
    """Largest relative errors (p) that are accepted of a quantity."""
    absolute = requirement.absolute(quantity)
    if absolute is None or errors.displaced is None:
        return np.full(errors.error.shape[1], requirement.limit(quantity))
    length = errors.displaced.length.max(axis=0)
    limits = np.divide(absolute, length, out=np.full(len(length), np.inf), where=length > 0.0)
    return np.asarray(limits)


def _of_inputs(known: Probability | None) -> dict[str, float]:
    return {"inputs": known.half_width} if known else {}


def _unknown(subject: Subject, model: Model, quantity: Quantity, limit: float) -> Entry | None:
    """Entry for a quantity without a reference or a solution. None if the model is silent on it."""
    half, reference = subject.responses.half(model, NOMINAL, quantity), subject.reference(quantity)
    if half is None:
        return None
    unsolved = half.reason if isinstance(half, Unsolved) else ""
    return Entry(
        model=model.name,
        quantity=quantity,
        limit=limit,
        verdict="undecided",
        pose=_pose(subject, 0),
        reference=reference.title,
        reason=f"{model.name}: {unsolved}" if unsolved else reference.decides,
        computed_by=model.computed_by,
    )


def verdicts_of(errors: Errors, limits: Array) -> list[Adequacy]:
    """The verdict at every pose, by its limit (p).

    Adequate where no error that is left open exceeds the limit, inadequate where all do, on one
    side. The order of modes is judged by each interpretation alone: undecided where they disagree.
    """
    poses = range(errors.error.shape[1])
    if errors.numbers is None:
        low, high = errors.interval
        return [
            _verdict(low[p], high[p], errors.missing[:, p], errors.unknown[:, p], limits[p])
            for p in poses
        ]
    low, high = errors.bounds
    alone = [
        {
            _verdict(low[k, p], high[k, p], errors.missing[k, p], errors.unknown[k, p], limits[p])
            for k in range(len(errors.names))
        }
        for p in poses
    ]
    return [said.pop() if len(said) == 1 else "undecided" for said in alone]


def _verdict(
    low: float,
    high: float,
    missing: NDArray[np.bool_],
    unknown: NDArray[np.bool_],
    limit: float,
) -> Adequacy:
    if missing.any():
        return "inadequate" if missing.all() and not unknown.any() else "undecided"
    if low >= -limit and high <= limit:
        return "undecided" if unknown.any() else "adequate"
    return "inadequate" if low > limit or high < -limit else "undecided"


def _deciding(verdicts: Sequence[Adequacy], verdict: Adequacy, shares: Array) -> int:
    """The pose with the verdict of the whole in which most of its limit is left open.

    Poses that are alike up to rounding, as in a symmetric robot, leave it to the first of them.
    """
    alike = np.array([one == verdict for one in verdicts])
    size = np.where(np.isnan(shares), -0.5, np.abs(shares))
    size = np.where(alike, size, -1.0)
    return int(first_largest(size))


def _reason(
    errors: Errors,
    model: Model,
    quantity: Quantity,
    verdict: Adequacy,
    reference: Reference,
    place: Place,
    limits: Array,
) -> str:
    if verdict == "adequate":
        return ""
    pose = place[1]
    unknown, of_response = errors.unknown[:, pose], quantity.harmonic
    if errors.missing[:, pose].all() and not unknown.any():
        return f"{model.name} {_lacking(errors, quantity, pose)}"
    if verdict == "inadequate":
        rigid = errors.displaced is not None and not errors.value[:, pose].any()
        return model.rigid if rigid else ""
    places = _places(errors, reference, pose)
    if errors.paired is not None and errors.paired.undecided[:, pose].any():
        places.append(f"{_UNDECIDED_SHAPES} of {model.name}")
        unknown = unknown & ~errors.paired.undecided[:, pose]
    if unknown.any():
        without = [one.name for one in compress(reference.interpretations, unknown)]
        lacking = "nothing damps it" if of_response else "there are fewer modes than are judged"
        places.append(f"with {', '.join(without)} {lacking}")
    decides = _decides(errors, reference, pose, limits)
    if places or errors.missing[:, pose].any():
        return "; ".join(filter(None, (*places, decides or reference.finer)))
    parts = _parts(errors, reference, place)
    decided = {Source.MESHES: reference.finer, **_DECIDED_BY, reference.open: decides}
    decided[Source.INTERIOR] = reference.interior
    decided[Source.MASSES] = reference.masses or reference.decides
    widest = max(parts.values())
    ranked = sorted(parts, key=lambda name: -parts[name])
    # Where nothing helps against what leaves most open, what helps against nearly as much does.
    helps = [decided[name] for name in ranked if parts[name] >= _NEARLY * widest and decided[name]]
    return next((said for said in helps if said != NOT_FINER), reference.finer)


def _lacking(errors: Errors, quantity: Quantity, pose: int) -> str:
    """Why a model has nothing to compare."""
    if quantity.static:
        return "is elastic where the reference is rigid"
    if quantity.harmonic:
        return "has no peak there, or one without bound that nothing damps"
    if quantity == ORDER or errors.paired is None:
        return "has too few modes"
    paired = errors.paired
    seen, likeness = (float(of[:, pose].max()) for of in (paired.seen, paired.likeness))
    lacking = f"energy-weighed MAC at most {likeness:.2f} with each of its modes"
    if paired.local[:, pose].all():
        return (
            "does not have this mode, a local one of a leg's section: "
            f"{100.0 * seen:.2g} % of its kinetic energy is motion of whole cross-sections and "
            f"bodies; {lacking}"
        )
    return f"has no mode of this shape: {lacking}"


def _decides(errors: Errors, reference: Reference, pose: int, limits: Array) -> str:
    """What settles the interpretations: the legs' interior if none of the others is enough."""
    if not reference.interior:
        return reference.decides
    alone = [verdicts_of(errors.rows(rows), limits)[pose] for rows in reference.by_interior]
    return reference.interior if set(alone) == {"undecided"} else reference.decides


def _places(errors: Errors, reference: Reference, pose: int) -> list[str]:
    """Modes in other places by interpretation of the order. [] if all interpretations agree."""
    if errors.numbers is None:
        return []
    said: dict[str, list[str]] = {}
    for one, numbers in zip(reference.interpretations, errors.numbers[:, pose], strict=True):
        moved = [
            f"f{k + 1} is " + (f"the model's f{number + 1}" if number >= 0 else "missing")
            for k, number in enumerate(numbers)
            if number != k
        ]
        said.setdefault(", ".join(moved), []).append(one.name)
    if len(said) == 1:
        return []
    told = [f"{moved} with {' or '.join(names)}" for moved, names in said.items() if moved]
    return [*told, "otherwise every mode is in its place"] if "" in said else told


def _chosen(errors: Errors, pose: int) -> IntArray:
    """The interpretation (p) whose numbers an entry has: at `pose` the one of the largest error.

    The others follow it, so that a curve over the poses is of one interpretation. The order, which
    jumps anyway, has the largest at every pose.
    """
    largest = errors.largest
    return largest if errors.numbers is not None else np.full_like(largest, largest[pose])


def _readings(errors: Errors, pose: int) -> dict[str, float]:
    """The error by each interpretation at a pose; {} if there is one or an error lacks.

    Interpretations that compare modes of different numbers are no readings of one error.
    """
    if len(errors.names) == 1 or errors.numbers is not None or errors.missing[:, pose].any():
        return {}
    return dict(zip(errors.names, errors.error[:, pose].tolist(), strict=True))


def _expected_range(errors: Errors, pose: int) -> tuple[float, float]:
    """Lowest and highest number of the reference by all interpretations, with half-widths."""
    expected, spread = errors.expected[:, pose], errors.spread[:, pose]
    # Half-widths of an error are those of the reference times this.
    reach = np.ones_like(expected)
    reach = np.abs(np.divide(errors.value[:, pose], expected, out=reach, where=expected != 0.0))
    half = np.divide(spread, reach, out=spread.copy(), where=reach > 0.0)
    return float(np.min(expected * (1.0 - half))), float(np.max(expected * (1.0 + half)))


def _alongs(errors: Errors, chosen: IntArray) -> tuple[float | None, ...]:
    """Signed errors along the load at every pose; () for frequencies."""
    if errors.displaced is None:
        return ()
    along = errors.displaced.along[chosen, np.arange(len(chosen))]
    return _optional(np.where(errors.missing.any(axis=0), np.nan, along))


def _force(errors: Errors, quantity: Quantity, place: Place) -> tuple[float, ...]:
    """The worst direction of force; () of any other quantity."""
    if errors.displaced is None or quantity != ANY_FORCE:
        return ()
    return tuple(float(number) for number in errors.displaced.wrench[place][:3])


def _parts(errors: Errors, reference: Reference, place: Place) -> dict[str, float]:
    """Parts of the half-width, and half of the distance between the interpretations."""
    parts: dict[str, float] = {
        source: float(half_widths[place])
        for source, half_widths in errors.budget.items()
        if source is Source.MESHES or half_widths.any()
    }
    if errors.paired is not None:
        mixed = 0.5 * float(errors.paired.below[place] + errors.paired.above[place])
        parts |= {Source.PAIRING: mixed} if mixed else {}
    if reference.open and errors.numbers is None:
        low = high = errors.error[:, place[1]]
        if errors.paired is not None:
            low = low - errors.paired.beyond_below[:, place[1]]
            high = high + errors.paired.beyond_above[:, place[1]]
        interior = 0.0
        if reference.interior:
            alike = reference.by_interior
            interior = max(0.5 * float(high[rows].max() - low[rows].min()) for rows in alike)
            parts[Source.INTERIOR] = interior
        parts[reference.open] = 0.5 * float(high.max() - low.min()) - interior
    return {str(name): half_width for name, half_width in parts.items()}


def _pose(subject: Subject, index: int) -> tuple[float, ...]:
    return tuple(float(number) for number in subject.poses[index])


def _optional(numbers: Array) -> tuple[float | None, ...]:
    return tuple(None if np.isnan(number) else float(number) for number in numbers)


def explained(
    model_errors: ModelErrors, model: Model, quantity: Quantity, errors: Errors, place: Place
) -> tuple[Cause, ...]:
    """Causes of the error at a place, the largest first; shares sum to one.

    The error of a deflection is the length of a vector; a step takes off it what it does along that
    vector, under the load that the error is of.
    """
    if errors.missing[:, place[1]].any():
        return ()
    total = float(errors.error[place])
    if total == 0.0:
        return ()
    subject = model_errors.subject
    readings = [one.reading for one in subject.reference(quantity).interpretations]
    amounts: dict[str, float] = {}
    sources: dict[str, str] = {REST: "the error minus the named causes"}
    before = model
    for step in subject.steps(model, quantity):
        amount = _amount(model_errors, quantity, errors, (before, step.model), place)
        if amount is None:
            reasons = (subject.responses.unsolved(step.model, r, quantity) for r in readings)
            if unsolved := next(filter(None, reasons), ""):
                sources[REST] += f"; {step.cause} cannot be computed: {unsolved}"
            break
        amounts[step.cause] = amounts.get(step.cause, 0.0) + amount
        sources.setdefault(step.cause, step.source)
        before = step.model
    amounts[REST] = total - sum(amounts.values())
    causes = [Cause(name, amount / total, sources[name]) for name, amount in amounts.items()]
    named = [cause for cause in causes if abs(cause.share) >= _WORTH_NAMING]
    return tuple(sorted(named, key=lambda cause: -abs(cause.share)))


def _amount(
    model_errors: ModelErrors,
    quantity: Quantity,
    errors: Errors,
    models: tuple[Model, Model],
    place: Place,
) -> float | None:
    """Amount that the step between two models takes off an error. None if one is not solved."""
    row, pose = place
    displaced = errors.displaced
    if displaced is None:
        before, after = (model_errors.errors(model, quantity) for model in models)
        if before is None or after is None or after.missing[:, pose].any():
            return None
        return float(before.error[place] - after.error[place])
    subject = model_errors.subject
    reading = subject.reference(quantity).interpretations[row].reading
    first, second = (subject.responses.known_statics(model, reading) for model in models)
    if first is None or second is None:
        return None
    step = (first - second).displacements(quantity, displaced.wrench[row])[pose]
    size = float(errors.error[row, pose])
    amount = step @ displaced.off[row, pose]
    return float(amount / (displaced.length[row, pose] * size)) if size > 0.0 else 0.0


def remedied(
    model_errors: ModelErrors,
    model: Model,
    quantity: Quantity,
    errors: Errors,
    limit: float,
    pose: int,
) -> tuple[str, float | None]:
    """The shortest way up the ladder that brings the error within its limit, with what it leaves.

    If all leave it inadequate, the model that answers as the reference; without one the way that
    comes nearest to the limit. The error left is the largest over all poses and interpretations.
    Only those steps are named that change anything worth the name. ("", None) if none helps.
    """
    subject = model_errors.subject
    tried: list[tuple[float, float, str, bool]] = []
    remedies: dict[str, str] = {}
    start = before = float(errors.worst[pose])
    for step in subject.steps(model, quantity):
        after = model_errors.errors(step.model, quantity)
        if after is None:
            break
        errors_after = after.worst
        if step.remedy and not abs(errors_after[pose] - before) < _WORTH_TAKING * limit:
            # Another model takes the place of what was before, an option that of its other value.
            remedies = {} if step.remedy.model else remedies
            remedies[step.remedy.option or step.remedy.text] = step.remedy.text
        if step.remedy and remedies and np.isfinite(errors_after).all():
            worst = float(errors_after[np.argmax(np.abs(errors_after))])
            beyond = "inadequate" in verdicts_of(after, np.full(len(errors_after), limit))
            tried.append((abs(worst), worst, ", ".join(remedies.values()), beyond))
        # A step without a remedy of its own is taken together with the next one.
        before = float(errors_after[pose]) if step.remedy else before
    enough = [one for one in tried if one[0] <= limit]
    replacement = subject.reference(quantity).remedy
    if replacement and not enough and all(beyond for *_, beyond in tried):
        return replacement.text, 0.0
    if not tried:
        return "", None
    size, error, remedy, _ = enough[0] if enough else min(tried)
    if np.isfinite(start) and size >= abs(start):
        return "", None
    return remedy, error
