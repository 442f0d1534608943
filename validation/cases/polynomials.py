"""Every number of a mechanism's first screen by polynomials along its legs.

The numbers are those that the models are judged by, in the poses that they are judged in. What
they are held against takes the frames of the bodies, measures anew that they close every joint,
and shares nothing else: neither what eliminates joints nor what sums chains, elements or segments.
"""

from collections.abc import Mapping
from math import inf

import numpy as np
from numpy.typing import NDArray

from lumped.acceptance.quantities import AXES, ROTATIONS
from lumped.arrays import Array
from lumped.dense.modes import FewerModesError
from lumped.legs import Theory
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models import vjm
from lumped.models.bodies import tip_compliances
from lumped.models.serial_chains import serial_chains
from lumped.system.assembly import assembly
from lumped.system.solution import rounding, solved
from lumped.text import counted
from validation.adequacy.judged_models import JudgedModel, judged_models
from validation.case import Measurement, Relative, Skip
from validation.case_group import CaseGroup, numbered
from validation.cases.ritz import DEGREE, compliance, frequencies, on_drives
from validation.context import Context
from validation.models.options import STATIC, ModelName, ModelOptions
from validation.models.part_legs import part_springs
from validation.models.robot_models import answers, static_bodies
from validation.references.model_ladder import model_statics
from validation.references.robot_on_path import path_postures, why_not_serial
from validation.studies_and_figures import PATH

LOAD = 1000.0  # N or N m
_MICRO, _MILLI = 1e-6, 1e-3
# The static quantities, what is said of them, and their units.
SHOWN = (
    *((name, f"deflection along {name} under {LOAD:g} N along it", "µm") for name in AXES[:3]),
    *(
        (name, f"rotation about {ROTATIONS[name]} under {LOAD:g} N m about it", "mrad")
        for name in AXES[3:]
    ),
)
# Degrees of polynomials that are all exact in statics.
_EXACT = (3, 4, 5)
# Rounding is a number at random in each: they seldom differ all by less than a tenth of it.
_SELDOM = 10.0
# Digits of differences that are more than rounding.
_DIGITS = 8
# What yields by less, of the largest of its unit, is rounding of rigid.
_RIGID = 1e-11
_DYNAMIC = {
    "beam": (Relative(1e-4), "fourth order in 1/n: below 1e-5 with 20 elements"),
    "segments": (Relative(0.01), "second order in 1/n: below 1 % with 20 segments"),
    "simplified": (
        Relative(1e-10),
        "rigid bodies on springs: rounding alone, grown by idle motions, 6e-12 and less",
    ),
}


def _models(mechanism: Mechanism) -> Mapping[str, JudgedModel]:
    """Those of the first screen; with parts, which are no polynomials, rigid bodies alone."""
    models = judged_models(mechanism)
    return {"simplified": models["simplified"]} if mechanism.parts else models


def _of_modes(mechanism: Mechanism) -> list[tuple[str, Relative, str]]:
    """Models that have modes, how near their frequencies are, and why."""
    models = _models(mechanism).items()
    return [(model, *_DYNAMIC[kind]) for model, (kind, _, _) in models if kind in _DYNAMIC]


cases = CaseGroup(
    reference_kind="independent-solver",
    citation="Ritz's method, Legendre polynomials along the legs (validation.cases.ritz)",
    tolerance=Relative(1e-9),
    tolerance_reason="statics of legs are cubic polynomials: rounding alone, grown by the "
    "condition, 2e-11 and less of robots at random",
    section=PATH,
    group="mechanism.lumped",
)


def expected_statics(
    postures: tuple[Posture, ...], kind: str, theory: Theory, degree: int
) -> Array:
    """Diagonal of the 6×6 (poses × 6, SI) by polynomials.

    `kind` "rigid" legs, legs "given" by their 6×6, or "equivalent".
    """
    if kind == "rigid":
        return np.array([np.diag(on_drives(at, 0)[0]) for at in postures])
    given = kind == "given"
    return np.array([np.diag(compliance(at, theory, degree, given=given)) for at in postures])


def expected_frequencies(at: Posture, theory: Theory, degree: int, modes: int) -> Array:
    """The first frequencies (Hz) by polynomials of `degree`, rigid legs of degree 0."""
    if not degree:
        return on_drives(at, modes)[1]
    return frequencies(at, modes, theory, degree)


def _model(context: Context, model: str) -> tuple[ModelName, ModelOptions]:
    kind, _, options = judged_models(context.robot_file.mechanism)[model]
    return kind, options


@cases.case(
    "mechanism.anchor.statics[{model}, {entry}]",
    "The mechanism: {said} by {model}, recomputed without its code",
    over={"model": _models, "entry, said, unit": SHOWN},
    quantity="{said}, pose of the largest difference",
    effort=0.05,
    figure="mechanism.deflections",
)
def _static(context: Context, model: str, entry: str) -> Measurement:
    postures, index = path_postures(context), AXES.index(entry)
    kind, options = _model(context, model)
    if kind == "vjm" and (branches := why_not_serial(postures)):
        raise Skip(branches)
    try:
        statics = context.get(model_statics, postures, kind, options)
        found = np.diagonal(statics.compliances, axis1=1, axis2=2)
    except vjm.RigidChainError as rigid:
        raise Skip(str(rigid)) from None
    legs = "given" if kind in STATIC and options.legs == "given" else "equivalent"
    legs = "rigid" if kind == "simplified" else legs
    expected, *others = (
        context.get(expected_statics, postures, legs, options.theory, degree) for degree in _EXACT
    )
    size = postures[0].mechanism.size
    known = _yielding(expected, size) | _yielding(found, size)
    if not known[:, index].any():
        raise Skip(f"{model}: bodies and drives do not let the tool move that way")
    at = farthest(found[:, index], expected[:, index], known[:, index])
    left_open = 0.0
    if kind != "simplified":
        left_open = context.get(path_roundings, postures, kind, options)[at, index, index]
    # From m/N or rad/(N m) to what is shown.
    scale = LOAD / (_MICRO if entry in AXES[:3] else _MILLI)
    return Measurement(
        scale * float(found[at, index]),
        scale * float(expected[at, index]),
        value_uncertainty=scale * float(left_open),
        reference_uncertainty=scale
        * _rounding(float(expected[at, index]), *(float(one[at, index]) for one in others)),
        decides="double precision leaves so much open where stiffnesses differ widely or legs "
        "nearly align, and no finer model narrows it",
        pose=tuple(postures[at].pose.tolist()),
    )


def path_roundings(postures: tuple[Posture, ...], model: ModelName, options: ModelOptions) -> Array:
    """What rounding leaves open of a model's compliances (p×6×6, SI; 95 %, of both signs)."""
    mechanism = postures[0].mechanism
    if model == "vjm":
        springs = tip_compliances(mechanism, options.legs, options.theory, options.equivalent)
        springs |= part_springs(mechanism, options)
        return np.array([vjm.rounding(serial_chains(at, springs)[0]) for at in postures])
    prepared = assembly(mechanism, static_bodies(model, mechanism, options))
    systems = prepared.along(postures)
    return np.array([rounding(one, solved(one).displacements(one.tool.T)) for one in systems])


def farthest(found: Array, reference: Array, known: NDArray[np.bool_]) -> int:
    """Number of the posture (of p) that is farthest off, relatively, among those `known`.

    Of those off by rounding alone that of the largest number: rounding differs from machine to
    machine. What is not there where it should be is farthest of all.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.round(np.abs(found / reference - 1.0), _DIGITS)
    off = np.where(known, np.where(np.isnan(off), np.inf, off), -1.0)
    return int(np.lexsort((np.where(known, reference, -np.inf), off))[-1])


def _rounding(found: float, *others: float) -> float:
    """What rounding leaves open of a number that further degrees of polynomials ought to share."""
    return _SELDOM * max(abs(found - other) for other in others)


def _yielding(numbers: Array, size: float) -> NDArray[np.bool_]:
    """Where numbers (poses × 6) are more than rounding of the softest, by the size (m)."""
    units = np.array([1.0] * 3 + [size**2] * 3)
    return np.asarray(numbers * units > _RIGID * np.max(numbers * units))


@cases.case(
    "mechanism.anchor.frequencies[{model}, {mode}]",
    "The mechanism: frequency {mode} by {model}, recomputed without its code",
    over={
        "model, tolerance, tolerance_reason": _of_modes,
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
        (own,) = context.get(answers, kind, (middle,), modes, options)
    except FewerModesError as fewer:
        raise Skip(str(fewer)) from None
    found = own.frequencies
    degrees = (0, 0) if kind == "simplified" else (DEGREE, DEGREE - 2)
    expected, rougher = (
        context.get(expected_frequencies, middle, options.theory, degree, modes)
        for degree in degrees
    )
    if index >= max(len(found), len(expected)):
        raise Skip(f"{model} has {counted(len(found), 'mode')}")
    value, reference, other = (
        float(numbers[index]) if index < len(numbers) else inf
        for numbers in (found, expected, rougher)
    )
    return Measurement(
        value,
        reference,
        # What elements leave is what is judged: the reference alone leaves it uncertain.
        judged_uncertainty=_rounding(reference, other),
        pose=tuple(middle.pose.tolist()),
    )
