"""Cases on compliances and frequencies of a mechanism, recomputed by Ritz's method.

Input: the postures of a run and each lumped or beam model. Output: verdicts on the diagonal of the
6×6 compliance in the pose of the largest difference, and on frequencies in the middle pose. Rule:
the reference represents legs by polynomials (`validation.cases.ritz`). It uses the positions of the
bodies and checks that they close every joint. It has no other code in common with the models:
neither elimination of joints nor assembly of chains, elements or segments.
"""

from collections.abc import Mapping
from math import inf

import numpy as np
from numpy.typing import NDArray

from lumped.acceptance.quantities import AXES, ROTATIONS
from lumped.arrays import Array
from lumped.dense.modes import FewerModesError
from lumped.legs import LineLeg
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.model_choices import Theory
from lumped.models import vjm
from lumped.models.bodies import legs_of, tip_compliances
from lumped.models.serial_chains import serial_chains
from lumped.system.assembly import assembly
from lumped.system.solution import rounding, solved
from lumped.text import counted
from validation.adequacy.judged_models import JudgedModel, judged_models
from validation.case import Measurement, Relative, Skip
from validation.case_group import CaseGroup, numbered
from validation.cases.ritz import DEGREE, compliance, frequencies, simplified_response
from validation.context import Context
from validation.models.options import STATIC, ModelName, ModelOptions
from validation.models.part_legs import part_springs
from validation.models.robot_bodies import static_bodies
from validation.models.robot_models import answers
from validation.references.model_ladder import model_statics
from validation.references.robot_on_path import path_postures, why_not_serial
from validation.studies_and_figures import PATH

LOAD = 1000.0  # N or N m
_MICRO, _MILLI = 1e-6, 1e-3
# Static quantities: name, description and unit.
STATIC_QUANTITIES = (
    *(
        (name, f"deflection along {name} under a force of {LOAD:g} N along {name}", "µm")
        for name in AXES[:3]
    ),
    *(
        (
            name,
            (
                f"rotation about {ROTATIONS[name]} under a moment of {LOAD:g} N m about "
                f"{ROTATIONS[name]}"
            ),
            "mrad",
        )
        for name in AXES[3:]
    ),
)
# Degrees of polynomials, all exact in statics.
_EXACT_DEGREES = (3, 4, 5)
# Factor from the differences between these degrees to the half-width of round-off. Round-off is
# random in each, and rarely do all differ by less than a tenth of it.
_ROUND_OFF_FACTOR = 10.0
# Decimals to which relative differences are rounded, so that round-off vanishes.
_DIFFERENCE_DIGITS = 8
# Fraction of the largest compliance below which a compliance is round-off, all converted to m/N.
_RIGID_SHARE = 1e-11
_DYNAMIC = {
    "beam": (Relative(1e-4), "fourth order in 1/n: below 1e-5 with 20 elements"),
    "segments": (Relative(0.01), "second order in 1/n: below 1 % with 20 segments"),
    "simplified": (
        Relative(1e-10),
        "rigid bodies on springs: round-off amplified by idle mobilities, 6e-12 and less",
    ),
}


def _models(mechanism: Mechanism) -> Mapping[str, JudgedModel]:
    """Judged models by name, as far as Ritz's method with polynomials can check them.

    Only `simplified` if there are CAD parts or legs along a line, since the polynomials represent
    prisms only.
    """
    models = judged_models(mechanism)
    lines = any(isinstance(leg, LineLeg) for leg in legs_of(mechanism).values())
    return {"simplified": models["simplified"]} if mechanism.parts or lines else models


def _dynamic_models(mechanism: Mechanism) -> list[tuple[str, Relative, str]]:
    """Models with modes, each with the tolerance of its frequencies and the reason."""
    models = _models(mechanism).items()
    return [(name, *_DYNAMIC[model.kind]) for name, model in models if model.kind in _DYNAMIC]


cases = CaseGroup(
    reference_kind="independent-solver",
    citation="Ritz's method, Legendre polynomials along the legs (validation.cases.ritz)",
    tolerance=Relative(1e-9),
    tolerance_reason=(
        "statics of legs are cubic polynomials: round-off amplified by the condition number, "
        "2e-11 and less for random robots"
    ),
    section=PATH,
    group="mechanism.lumped",
)


def expected_statics(
    postures: tuple[Posture, ...], kind: str, theory: Theory, degree: int
) -> Array:
    """Diagonal of the 6×6 compliance in p poses (p×6, SI, base axes), by polynomials.

    `kind` of the legs is "rigid", "given" (their 6×6), or "equivalent" (their equivalent prisms).
    """
    if kind == "rigid":
        return np.array([np.diag(simplified_response(posture, 0)[0]) for posture in postures])
    with_given_legs = kind == "given"
    return np.array(
        [
            np.diag(compliance(posture, theory, degree, given=with_given_legs))
            for posture in postures
        ]
    )


def expected_frequencies(posture: Posture, theory: Theory, degree: int, modes: int) -> Array:
    """First `modes` frequencies (Hz) by polynomials of a `degree`. If it is 0, legs are rigid."""
    if not degree:
        return simplified_response(posture, modes)[1]
    return frequencies(posture, modes, theory, degree)


def _model(context: Context, model: str) -> tuple[ModelName, ModelOptions]:
    judged = judged_models(context.robot_file.mechanism)[model]
    return judged.kind, judged.options


@cases.case(
    "mechanism.anchor.statics[{model}, {entry}]",
    "Robot, model {model}: {said} equals an independent Ritz solution",
    over={"model": _models, "entry, said, unit": STATIC_QUANTITIES},
    quantity="{said}, at the pose with the largest difference",
    effort=0.05,
    figure="mechanism.deflections",
)
def _static(context: Context, model: str, entry: str) -> Measurement:
    postures, index = path_postures(context), AXES.index(entry)
    kind, options = _model(context, model)
    if kind == "vjm" and (reason := why_not_serial(postures)):
        raise Skip(reason)
    try:
        statics = context.get(model_statics, postures, kind, options)
        computed = np.diagonal(statics.compliances, axis1=1, axis2=2)
    except vjm.RigidChainError as rigid:
        raise Skip(str(rigid)) from None
    legs = "given" if kind in STATIC and options.legs == "given" else "equivalent"
    legs = "rigid" if kind == "simplified" else legs
    expected, *other_degrees = (
        context.get(expected_statics, postures, legs, options.theory, degree)
        for degree in _EXACT_DEGREES
    )
    size = postures[0].mechanism.size
    mobile = _above_round_off(expected, size) | _above_round_off(computed, size)
    if not mobile[:, index].any():
        direction = f"about {ROTATIONS[entry]}" if entry in ROTATIONS else f"along {entry}"
        raise Skip(
            f"model {model} is rigid {direction}: neither bodies nor drives yield {direction}"
        )
    worst = farthest_posture(computed[:, index], expected[:, index], mobile[:, index])
    round_off = 0.0
    if kind != "simplified":
        round_off = context.get(path_round_off, postures, kind, options)[worst, index, index]
    # From m/N or rad/(N m) to the displayed unit.
    scale = LOAD / (_MICRO if entry in AXES[:3] else _MILLI)
    return Measurement(
        scale * float(computed[worst, index]),
        scale * float(expected[worst, index]),
        value_uncertainty=scale * float(round_off),
        reference_uncertainty=scale
        * _half_width(
            float(expected[worst, index]),
            *(float(values[worst, index]) for values in other_degrees),
        ),
        decides=(
            "round-off in double precision has a large half-width if stiffnesses differ widely "
            "or legs are nearly aligned; a finer model does not reduce round-off"
        ),
        pose=tuple(postures[worst].pose.tolist()),
    )


def path_round_off(postures: tuple[Posture, ...], model: ModelName, options: ModelOptions) -> Array:
    """Half-widths (p×6×6, SI, 95 %) of a model's compliances due to round-off.

    Shapes: p poses.
    """
    mechanism = postures[0].mechanism
    if model == "vjm":
        springs = tip_compliances(mechanism, options.legs, options.theory, options.equivalent)
        springs |= part_springs(mechanism, options)
        return np.array([vjm.rounding(serial_chains(posture, springs)[0]) for posture in postures])
    prepared = assembly(mechanism, static_bodies(model, mechanism, options))
    systems = prepared.along(postures)
    return np.array(
        [rounding(system, solved(system).displacements(system.tool.T)) for system in systems]
    )


def farthest_posture(values: Array, reference: Array, mobile: NDArray[np.bool_]) -> int:
    """Index of the posture with the largest relative error.

    `values` and `reference` (p each): one number in each of p postures. Postures in which `mobile`
    (p) is false are not considered. If all errors are round-off, which depends on the machine, it
    is the posture with the largest reference. A missing value counts as the largest error.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = np.round(np.abs(values / reference - 1.0), _DIFFERENCE_DIGITS)
    errors = np.where(mobile, np.where(np.isnan(errors), np.inf, errors), -1.0)
    return int(np.lexsort((np.where(mobile, reference, -np.inf), errors))[-1])


def _half_width(value: float, *others: float) -> float:
    """Half-width of a value due to round-off.

    It is estimated from `others`, the same value by polynomials of other degrees.
    """
    return _ROUND_OFF_FACTOR * max(abs(value - other) for other in others)


def _above_round_off(numbers: Array, size: float) -> NDArray[np.bool_]:
    """True for compliances (p×6) above the round-off of the largest one.

    For this comparison, rotational ones are converted to m/N by `size`² (m²). Shapes: p poses.
    """
    units = np.array([1.0] * 3 + [size**2] * 3)
    return np.asarray(numbers * units > _RIGID_SHARE * np.max(numbers * units))


@cases.case(
    "mechanism.anchor.frequencies[{model}, {mode}]",
    "Robot, model {model}: frequency {mode} equals an independent Ritz solution",
    over={
        "model, tolerance, tolerance_reason": _dynamic_models,
        "index, mode": numbered,
    },
    quantity="natural frequency {mode}, middle of the path",
    figure="mechanism.frequencies",
    unit="Hz",
    effort=0.05,
)
def _frequency(context: Context, model: str, index: int, modes: int) -> Measurement:
    postures = path_postures(context)
    middle = postures[len(postures) // 2]
    kind, options = _model(context, model)
    try:
        response = context.get(answers, kind, (middle,), modes, options)
    except FewerModesError as fewer:
        raise Skip(str(fewer)) from None
    computed = response.frequencies[0]
    degrees = (0, 0) if kind == "simplified" else (DEGREE, DEGREE - 2)
    expected, rougher = (
        context.get(expected_frequencies, middle, options.theory, degree, modes)
        for degree in degrees
    )
    if index >= max(len(computed), len(expected)):
        raise Skip(f"model {model} has only {counted(len(computed), 'mode')}")
    value, reference, rougher_value = (
        float(numbers[index]) if index < len(numbers) else inf
        for numbers in (computed, expected, rougher)
    )
    return Measurement(
        value,
        reference,
        # The discretisation error of the model is judged, so it does not count as uncertainty.
        judged_uncertainty=_half_width(reference, rougher_value),
        pose=tuple(middle.pose.tolist()),
    )
