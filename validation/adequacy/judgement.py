"""Verdict on each model for each quantity, with its causes and a remedy.

Input: `Errors` of a model (intervals by pose) and the limits of `[accept]`. Output: an `Entry` of
the matrix. An interval covers the errors against all interpretations of the robot file (end
conditions, distributions of mass), each widened by its half-width. Rule: in each pose, the model is
adequate if all errors of the interval are within the limit, inadequate if all are beyond it on one
side, and otherwise undecided. The worst verdict over the poses is the verdict on the model; the
deciding pose has this verdict and the largest ratio of error to limit.

Causes: each step from the model to the reference is a computation that lacks one more cause of
error and does not use the reference. The error that no step removes is listed as the remainder.
Remedy: the fewest steps after which the error meets the limit in all poses.
"""

from collections.abc import Sequence

import numpy as np

from lumped.acceptance.quantities import ORDER, Quantity, QuantityKind
from lumped.acceptance.requirement import Requirement
from lumped.arrays import Array, IntArray
from validation.adequacy.errors import Errors, first_largest, verdicts_of
from validation.adequacy.model_errors import ModelErrors
from validation.adequacy.probability import probability
from validation.adequacy.reasons import Position, half_width_parts, reason_of
from validation.adequacy.uncertain_inputs import UncertainInputs
from validation.references.reference import Subject
from validation.references.responses import Model
from validation.references.robot_on_path import NOMINAL
from validation.verdicts import Adequacy, Cause, Entry, Matrix, ModelNote, worst_of

REST = "rest, not attributed"
_NO_MASS = "neither a rigid body nor the tool has mass, so there are no frequencies"
# Smallest share of an error that is listed as a cause.
_NAMED_SHARE = 0.005
# A step counts as a remedy if it changes the error by this fraction of the limit.
_STEP_SHARE = 0.1


def verdict_matrix(subject: Subject, requirement: Requirement) -> Matrix:
    """Matrix of verdicts of a robot: each model for each quantity that it defines.

    It contains the matrices of each leg alone, and the matrix for the robot with equivalent legs of
    constant section. If inputs of the robot are uncertain, a verdict with a probability below 95 %
    becomes undecided.
    """
    model_errors = ModelErrors(subject, requirement.modes)
    inputs = UncertainInputs(model_errors, subject.inputs) if subject.inputs else None
    defined = {*subject.loads, *subject.harmonics}
    quantities = tuple(
        quantity
        for quantity in requirement.quantities
        if quantity in defined or not (quantity.kind is QuantityKind.LOAD or quantity.harmonic)
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
            ModelNote(model.name, model.title, _undefined_reason(subject, model))
            for model in subject.models
        ),
        quantities=quantities,
        entries=tuple(entries),
        notes=subject.notes,
        supposed=subject.dynamics.supposed,
        parts=tuple(verdict_matrix(part, requirement) for part in subject.parts),
        formulation=verdict_matrix(subject.formulation, requirement)
        if subject.formulation
        else None,
        faults=(*subject.responses.faults, *subject.faults),
    )


def _undefined_reason(subject: Subject, model: Model) -> str:
    """Reason why a model does not define statics or modes. "" if it defines both of them."""
    massless = model.modes is not None and subject.responses.modes(model, NOMINAL) is None
    return model.undefined_reason or (_NO_MASS if massless else "")


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
        return _unsolved_entry(subject, model, quantity, requirement.limit(quantity))
    limits = _pose_limits(errors, quantity, requirement)
    verdicts, compared = verdicts_of(errors, limits), errors.compared
    verdict = worst_of(
        [verdict for verdict, counts in zip(verdicts, compared, strict=True) if counts]
    )
    pose = _deciding_pose(verdicts, verdict, np.where(compared, errors.bound / limits, np.nan))
    limit = float(limits[pose])
    path = np.arange(len(limits))
    rows = _interpretation_rows(errors, pose)
    position = int(rows[pose]), pose
    missing = np.asarray(errors.missing.any(axis=0) | ~compared)
    error, spread, low, high = (
        _optional(np.where(missing, np.nan, numbers))
        for numbers in (errors.error[rows, path], errors.spread[rows, path], *errors.interval)
    )
    alongs = _errors_along_load(errors, rows)
    causes = (
        causes_of_error(model_errors, model, quantity, errors, position)
        if verdict != "adequate"
        else ()
    )
    remedy, remaining = "", None
    if verdict == "inadequate":
        remedy, remaining = shortest_remedy(model_errors, model, quantity, errors, limits, pose)
    input_error = inputs.error(model, quantity, errors) if inputs else None
    chances = probability(input_error, verdict, limits, pose) if input_error else None
    defined = not missing[pose]
    return Entry(
        model=model.name,
        quantity=quantity,
        error=error[pose],
        uncertainty=spread[pose],
        low=low[pose],
        high=high[pose],
        readings=_readings(errors, pose),
        limit=limit,
        verdict=chances.settled(verdict) if chances else verdict,
        pose=_pose(subject, pose),
        reference=reference.title,
        causes=causes,
        remedy=remedy,
        error_with_remedy=remaining,
        reason=(chances.decides if chances else "")
        or reason_of(errors, model, quantity, verdict, reference, position, limits),
        value=float(errors.value[position]) if defined else None,
        expected=float(errors.expected[position]) if defined else None,
        expected_range=_expected_range(errors, pose) if defined else (),
        along=alongs[pose] if alongs else None,
        force=_worst_force(errors, quantity, position),
        uncertainties=half_width_parts(errors, reference, position)
        | ({"inputs": chances.half_width} if chances else {})
        if defined
        else {},
        errors=error,
        lows=low,
        highs=high,
        # Empty if the values of the poses belong to different forces or modes and are no curve.
        values=() if quantity.any_direction or quantity == ORDER else _optional(errors.value[0]),
        alongs=alongs,
        computed_by=(*model.computed_by, *reference.computed_by),
        probability=chances.within if chances else None,
        probability_beyond=chances.beyond if chances else None,
        input_shares=chances.shares if chances else {},
        value_spread=chances.value_half_width if chances else None,
        assumed=reference.supposed,
    )


def _pose_limits(errors: Errors, quantity: Quantity, requirement: Requirement) -> Array:
    """Largest accepted relative error (P) of a quantity in each pose.

    An absolute limit is divided by the length of the reference's displacement. Array sizes: P
    poses.
    """
    absolute = requirement.absolute(quantity)
    if absolute is None or errors.displacement is None:
        return np.full(errors.error.shape[1], requirement.limit(quantity))
    length = errors.displacement.length.max(axis=0)
    limits = np.divide(absolute, length, out=np.full(len(length), np.inf), where=length > 0.0)
    return np.asarray(limits)


def _unsolved_entry(
    subject: Subject, model: Model, quantity: Quantity, limit: float
) -> Entry | None:
    """Entry for a quantity whose reference or model is unsolved, with the reason.

    None if the model does not define the quantity.
    """
    responses, reference = subject.responses, subject.reference(quantity)
    if responses.solution(model, NOMINAL, quantity) is None:
        return None
    unsolved = responses.unsolved(model, NOMINAL, quantity)
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


def _deciding_pose(verdicts: Sequence[Adequacy], verdict: Adequacy, shares: Array) -> int:
    """Index of the pose with the overall `verdict` and the largest error over its limit.

    `shares` (P) are errors divided by limits. If several are equal up to round-off, as in a
    symmetric robot, the first one decides. Array sizes: P poses.
    """
    deciding = np.array([pose_verdict == verdict for pose_verdict in verdicts])
    size = np.where(np.isnan(shares), -0.5, np.abs(shares))
    size = np.where(deciding, size, -1.0)
    return int(first_largest(size))


def _interpretation_rows(errors: Errors, pose: int) -> IntArray:
    """Index (P) of the interpretation whose numbers an entry contains in each pose.

    It is the interpretation with the largest error in the deciding `pose`, so that a curve over the
    poses belongs to one interpretation. For the order of modes, whose error jumps from pose to pose
    in any case, it is the interpretation with the largest error in each pose. Array sizes: P poses.
    """
    largest = errors.largest
    return largest if errors.numbers is not None else np.full_like(largest, largest[pose])


def _readings(errors: Errors, pose: int) -> dict[str, float]:
    """Error in a pose against each interpretation, by name of the interpretation.

    {} if there is only one interpretation, an error is missing, or the quantity is the order of
    modes, whose errors belong to different modes.
    """
    if len(errors.names) == 1 or errors.numbers is not None or errors.missing[:, pose].any():
        return {}
    return dict(zip(errors.names, errors.error[:, pose].tolist(), strict=True))


def _expected_range(errors: Errors, pose: int) -> tuple[float, float]:
    """Lowest and highest value of the reference in a pose over all interpretations.

    The half-widths of the reference are included.
    """
    expected, spread = errors.expected[:, pose], errors.spread[:, pose]
    # Half-width of the error over the relative half-width of the reference.
    ratio = np.ones_like(expected)
    ratio = np.abs(np.divide(errors.value[:, pose], expected, out=ratio, where=expected != 0.0))
    half_width = np.divide(spread, ratio, out=spread.copy(), where=ratio > 0.0)
    return float(np.min(expected * (1.0 - half_width))), float(
        np.max(expected * (1.0 + half_width))
    )


def _errors_along_load(errors: Errors, rows: IntArray) -> tuple[float | None, ...]:
    """Signed errors along the load in each pose, None if missing. () for frequencies.

    `rows` (P): index of the interpretation in each of P poses.
    """
    if errors.displacement is None:
        return ()
    along = errors.displacement.along[rows, np.arange(len(rows))]
    return _optional(np.where(errors.missing.any(axis=0), np.nan, along))


def _worst_force(errors: Errors, quantity: Quantity, position: Position) -> tuple[float, ...]:
    """Direction (3) of the force with the largest error, for a force in any direction.

    () for quantities with another load. `position`: index of the interpretation and of the pose.
    """
    if errors.displacement is None or not quantity.any_direction:
        return ()
    return tuple(errors.displacement.wrench[position][:3].tolist())


def _pose(subject: Subject, index: int) -> tuple[float, ...]:
    return tuple(float(number) for number in subject.poses[index])


def _optional(numbers: Array) -> tuple[float | None, ...]:
    return tuple(None if np.isnan(number) else float(number) for number in numbers)


def causes_of_error(
    model_errors: ModelErrors, model: Model, quantity: Quantity, errors: Errors, position: Position
) -> tuple[Cause, ...]:
    """Causes of the error in one interpretation and pose (`position`), the largest first.

    All shares sum to one; those below 0.5 % are omitted. The error of a displacement is the length
    of a vector: the amount of a step is the component, along that vector, of the change that the
    step causes under the same load.
    """
    if errors.missing[:, position[1]].any():
        return ()
    total = float(errors.error[position])
    if total == 0.0:
        return ()
    subject = model_errors.subject
    readings = [
        interpretation.reading for interpretation in subject.reference(quantity).interpretations
    ]
    amounts: dict[str, float] = {}
    sources: dict[str, str] = {REST: "error minus the sum of the named causes"}
    previous = model
    for step in subject.steps(model, quantity):
        amount = _removed_error(model_errors, quantity, errors, (previous, step.model), position)
        if amount is None:
            reasons = (subject.responses.unsolved(step.model, r, quantity) for r in readings)
            if unsolved := next(filter(None, reasons), ""):
                sources[REST] += f"; effect of {step.cause} cannot be computed: {unsolved}"
            break
        amounts[step.cause] = amounts.get(step.cause, 0.0) + amount
        sources.setdefault(step.cause, step.source)
        previous = step.model
    amounts[REST] = total - sum(amounts.values())
    causes = [Cause(name, amount / total, sources[name]) for name, amount in amounts.items()]
    significant = [cause for cause in causes if abs(cause.share) >= _NAMED_SHARE]
    return tuple(sorted(significant, key=lambda cause: -abs(cause.share)))


def _removed_error(
    model_errors: ModelErrors,
    quantity: Quantity,
    errors: Errors,
    models: tuple[Model, Model],
    position: Position,
) -> float | None:
    """Change of the error by the step from the first to the second of two `models`.

    `position`: index of the interpretation and of the pose. None if one of the models is unsolved.
    """
    row, pose = position
    displacement = errors.displacement
    if displacement is None:
        before, after = (model_errors.errors(model, quantity) for model in models)
        if before is None or after is None or after.missing[:, pose].any():
            return None
        return float(before.error[position] - after.error[position])
    subject = model_errors.subject
    reading = subject.reference(quantity).interpretations[row].reading
    first, second = (subject.responses.known_statics(model, reading) for model in models)
    if first is None or second is None:
        return None
    step = (first - second).displacements(quantity, displacement.wrench[row])[pose]
    size = float(errors.error[row, pose])
    amount = step @ displacement.difference[row, pose]
    return float(amount / (displacement.length[row, pose] * size)) if size > 0.0 else 0.0


def shortest_remedy(
    model_errors: ModelErrors,
    model: Model,
    quantity: Quantity,
    errors: Errors,
    limits: Array,
    pose: int,
) -> tuple[str, float | None]:
    """Remedy with the fewest steps after which the errors meet the `limits` (P) in all P poses.

    It is returned with the remaining error, in the pose in which this error is largest relative to
    the limit. Half-widths are not considered. If the model remains inadequate after any number of
    steps, the remedy is a model equal to the reference; if there is no such model, it consists of
    the steps with the smallest remaining error relative to the limit. A step is listed if it
    changes the error in any pose by at least a tenth of the limit there. ("", None) if the error
    that remains after the best steps is no smaller, relative to the limit, than the error in the
    deciding `pose`.
    """
    subject = model_errors.subject
    tried: list[tuple[float, float, str, bool]] = []
    remedies: dict[str, str] = {}
    start, before = float(errors.worst[pose]), errors.worst
    for step in subject.steps(model, quantity):
        after = model_errors.errors(step.model, quantity)
        if after is None:
            break
        errors_after = after.worst
        changes = np.abs(errors_after - before)
        if step.remedy and not (changes < _STEP_SHARE * limits).all():
            # A remedy that changes the model discards all earlier remedies; a remedy with an option
            # replaces an earlier one with the same option.
            remedies = {} if step.remedy.model else remedies
            remedies[step.remedy.option or step.remedy.text] = step.remedy.text
        if step.remedy and remedies and np.isfinite(errors_after).all():
            shares = np.abs(errors_after) / limits
            worst = int(np.argmax(shares))
            beyond = "inadequate" in verdicts_of(after, limits)
            remaining = float(errors_after[worst])
            tried.append((float(shares[worst]), remaining, ", ".join(remedies.values()), beyond))
        # The effect of a step without a remedy is added to that of the next step.
        before = errors_after if step.remedy else before
    sufficient = [attempt for attempt in tried if attempt[0] <= 1.0]
    replacement = subject.reference(quantity).remedy
    if replacement and not sufficient and all(beyond for *_, beyond in tried):
        return replacement.text, 0.0
    if not tried:
        return "", None
    share, error, remedy, _ = sufficient[0] if sufficient else min(tried)
    if np.isfinite(start) and share >= abs(start) / limits[pose]:
        return "", None
    return remedy, error
