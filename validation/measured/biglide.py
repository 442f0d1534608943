"""What every model of the biglide says of the measured values, and how they compare."""

from collections.abc import Mapping
from dataclasses import replace

from lumped.biglide import Biglide
from lumped.measured import Measured
from lumped.requirement import STATIC_QUANTITIES, Requirement
from validation.adequacy.biglide.subject import CANDIDATES
from validation.adequacy.judgement import worst_of
from validation.adequacy.matrix import MEASURED, Entry, Matrix, ModelNote
from validation.context import Context
from validation.measured.comparison import COVERAGE, Comparison, propagated
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.legs import leg_compliance
from validation.models.options import STATIC, ModelName, ModelOptions

# Models of elements; the others have none and no discretisation.
_OF_ELEMENTS = ("segments", "beam")
# Second order in the number of elements: the error of n of them is 4/3 of what 2n change.
_OF_A_DOUBLING = 4.0 / 3.0


def measured_matrix(context: Context) -> Matrix:
    """Every model by every measured quantity; the poses are those of the measurements."""
    robot_file, robot = context.robot_file, context.robot
    ones = robot_file.measured
    off = robot_file.with_inputs_off()
    quantities = tuple(dict.fromkeys(one.quantity for one in ones))
    entries = []
    for name, (model, _, options) in CANDIDATES.items():
        for quantity in quantities:
            found = {
                one: compared
                for one in ones
                if one.quantity == quantity
                and (compared := _compared(model, robot, one, options, off))
            }
            if found:
                entries.append(_entry(name, quantity, found, robot_file.requirement))
    poses = tuple(sorted({one.pose for one in ones if one.pose}))
    return Matrix(
        robot=robot.name,
        coordinates=("x (m)",),
        poses=poses,
        models=tuple(ModelNote(name, title) for name, (_, title, _) in CANDIDATES.items()),
        quantities=quantities,
        entries=tuple(entries),
    )


def predicted(
    model: ModelName, robot: Biglide, one: Measured, options: ModelOptions
) -> float | None:
    """The model's number for a measured value, in its unit; None where the model has none."""
    if one.leg_entry is not None:
        if model == "simplified":
            return None
        number, row, column = one.leg_entry
        leg = robot.leg1 if number == 1 else robot.leg2
        return float(leg_compliance(model, leg, options)[row, column])
    (x,) = one.pose
    if one.mode is not None:
        if model in STATIC:
            return None
        frequencies = robot_frequencies(model, robot, x, one.mode, options)
        return float(frequencies[one.mode - 1]) if len(frequencies) >= one.mode else None
    index = STATIC_QUANTITIES.index(one.quantity)
    compliance = robot_compliance(model, robot, x, options)
    # Where a model knows x and y alone it is rigid otherwise.
    return one.load * float(compliance[index, index]) if index < len(compliance) else 0.0


def _compared(
    model: ModelName,
    robot: Biglide,
    one: Measured,
    options: ModelOptions,
    off: tuple[tuple[str, Biglide, Biglide], ...],
) -> Comparison | None:
    value = predicted(model, robot, one, options)
    if value is None:
        return None
    changes = [
        (predicted(model, below, one, options) or 0.0, predicted(model, above, one, options) or 0.0)
        for _, below, above in off
    ]
    numerical = 0.0
    if model in _OF_ELEMENTS:
        finer = predicted(model, robot, one, replace(options, elements=2 * options.elements))
        # The estimate is a half-width of 95 %.
        numerical = _OF_A_DOUBLING * abs(value - (finer or 0.0)) / COVERAGE
    return Comparison(value, one.value, numerical, propagated(changes), one.uncertainty)


def _entry(
    model: str, quantity: str, found: Mapping[Measured, Comparison], requirement: Requirement
) -> Entry:
    limit = requirement.limit(quantity) if "." not in quantity else requirement.deflection
    verdicts = {one: compared.verdict(limit) for one, compared in found.items()}
    verdict = worst_of(list(verdicts.values()))
    alike = [one for one in found if verdicts[one] == verdict]
    worst = max(alike, key=lambda one: abs(found[one].error / one.value))
    compared, scale = found[worst], abs(worst.value)
    return Entry(
        model=model,
        quantity=quantity,
        error=compared.error / scale,
        uncertainty=COVERAGE * compared.validation_uncertainty / scale,
        limit=limit,
        verdict=verdict,
        pose=worst.pose,
        reference=f"{MEASURED}{worst.source}",
        reason="" if verdict != "undecided" else "a smaller validation uncertainty would decide",
        value=compared.value,
        expected=worst.value,
        uncertainties={
            "numerics": COVERAGE * compared.numerical / scale,
            "inputs": COVERAGE * compared.inputs / scale,
            "measurement": COVERAGE * compared.measurement / scale,
        },
        computed_by=("validation.measured.biglide.predicted", "validation.measured.comparison"),
    )
