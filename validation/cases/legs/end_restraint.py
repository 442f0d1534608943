"""Where beam and solid must differ, and how fast the difference vanishes as the leg grows longer.

A leg is doubled in length again and again, its section kept. Each named cause then falls with a
power of the slenderness s = length / larger side:

torsion, warping restrained   a rigid face stops the warping of a constant torque over a depth of
                              about one side: a fixed length of leg twists less, h of L: s⁻¹.
contraction restrained        likewise σxx = N/A or My/I at a face that cannot contract (ν > 0): a
                              fixed length stretches or bends less under the face's full load: s⁻¹.
shear deformation left out    γ = V/κGA all along, L/κGA beside L³/3EI: s⁻².
rotary inertia left out       ρI w′² beside ρA w² in the kinetic energy, (h/L)²: s⁻².
shear, warping restrained     without contraction the faces of bending stay plane, M has no end
                              effect. V has the same one at any length, h/GA beside L³/3EI: s⁻³.

Local exponents approach these from the next power of s: with the full wrench (V, M = V L) at the
root the restraint of bending is a L² + b L + c. They are therefore extrapolated in 1/s.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from fem.beams.beam import beam_leg
from fem.bodies import doubling
from fem.sections.section_constants import beam_properties, section_constants
from lumped.arrays import Array
from lumped.legs import BeamProperties, ConstantLeg, Material, tip_compliance
from lumped.models.cantilever import kind_frequencies
from lumped.sections import Circle, Rectangle, Tube
from meshes.prism.hexahedra import slice_count
from validation.agreement.convergence import step_factor
from validation.case import Absolute, Measurement, Sides, Skip
from validation.case_group import CaseGroup
from validation.cases.legs.beams import ENTRIES
from validation.context import Context, Preset
from validation.exhibits import Study
from validation.models.legs import constant_leg_of
from validation.solids.legs import (
    FORMAL_ORDER,
    decay_of_warping,
    face_mesh,
    own_properties,
    section_counts,
)
from validation.solids.size import face_too_large, larger_preset

SECTION = "End restraint"
THEORY = (
    "Saint-Venant's principle: an end effect takes a fixed length of the leg; S. P. Timoshenko, "
    "J. N. Goodier, Theory of Elasticity, §§19, 109, 119; Timoshenko, Phil. Mag. 41 (1921) 744"
)
# Relative differences below it are rounding.
_ROUND_OFF = 1e-11
_POISSON = 0.3
_SOLID = (doubling.condensed_leg, doubling.tip_compliance)
_DIAGONALS = tuple(name for name, ((i, j), *_) in ENTRIES.items() if i == j)
# Unknowns of a rectangle's section mesh at most, elements across the smaller side of the others. A
# round rim needs eight for its flexure (ν > 0) to reach 1e-4.
RECTANGLE: dict[Preset, int] = {"quick": 300, "standard": 600, "fine": 1000}
WALLS: dict[Preset, int] = {"quick": 4, "standard": 4, "fine": 8}
ROUND: dict[Preset, int] = {"quick": 8, "standard": 8, "fine": 12}
# Exponents are from the three longest lengths, their uncertainty from the three before the longest
# and falls fourfold with each doubling: a box's torsion needs the fourth.
DOUBLINGS = 4
# Depths over which an end effect decays that the shortest leg of an exponent must have: e⁻³ and
# less then reach from end to end.
_DEPTHS = 3.0
_RECTANGLE_LADDER = (8, 6, 4, 3, 2)
_BEAM_ELEMENTS = 20


@dataclass(frozen=True)
class Lengthened:
    """Diagonals of tip compliances (m×6, SI) of a leg at m `lengths` (m), each twice the last.

    Solids with `rigid` and with `free` ends, Timoshenko's `beam` and Euler–Bernoulli's
    (`slender`), both with the section's own constants.
    """

    lengths: Array
    rigid: Array
    free: Array
    beam: Array
    slender: Array


def lengthened(leg: ConstantLeg, divisions: int, doublings: int) -> Lengthened:
    """The leg, its length doubled so many times: each costs one dense step."""
    beam = own_properties(leg, divisions)
    slices = slice_count(leg.section, leg.length, section_counts(leg, divisions))
    pieces = [doubling.condensed_leg(leg, face_mesh(leg, divisions), slices)]
    for _ in range(doublings):
        pieces.append(doubling.doubled(pieces[-1]))
    lengths = [leg.length * 2.0**k for k in range(len(pieces))]
    slender = beam.as_euler_bernoulli()
    return Lengthened(
        lengths=np.array(lengths),
        rigid=np.array([np.diag(doubling.tip_compliance(p, "rigid")) for p in pieces]),
        free=np.array([np.diag(doubling.tip_compliance(p, "free")) for p in pieces]),
        beam=np.array([np.diag(tip_compliance(beam, length)) for length in lengths]),
        slender=np.array([np.diag(tip_compliance(slender, length)) for length in lengths]),
    )


def limit_exponent(lengths: Array, amounts: Array) -> float:
    """Exponent −p of amounts = C s⁻ᵖ (1 + D/s + …): local ones of the three longest, extrapolated.

    Local exponents differ from −p by a term in 1/s, halved with each doubling.
    """
    before, last = np.diff(np.log(amounts[-3:])) / np.diff(np.log(lengths[-3:]))
    return float(2.0 * last - before)


def fundamental_ratio(properties: BeamProperties, length: float) -> float:
    """First frequency of bending y without rotary inertia over that with it, no shear."""
    slender = properties.as_euler_bernoulli()
    rayleigh = replace(slender, rho_Iy=properties.rho_Iy)
    legs = (beam_leg(beam, length, _BEAM_ELEMENTS) for beam in (slender, rayleigh))
    (without,), (with_inertia,) = (kind_frequencies(leg, "bending y", 1) for leg in legs)
    return float(without / with_inertia)


def affordable_divisions(leg: ConstantLeg, preset: Preset) -> int:
    """Elements across the smaller side that a preset affords."""
    match leg.section:
        case Rectangle():
            sizes = ((n, 3 * len(face_mesh(leg, n).nodes)) for n in _RECTANGLE_LADDER)
            return next((n for n, unknowns in sizes if unknowns <= RECTANGLE[preset]), 1)
        case Circle() | Tube():
            return ROUND[preset]
        case _:
            return WALLS[preset]


def doublings_needed(leg: ConstantLeg, divisions: int) -> int:
    """Doublings after which the last five lengths are free of effects from end to end.

    The depth of an end effect is the larger side, or √(EΓ/GJ) of an open section (Vlasov).
    """
    shortest = _DEPTHS * max(*leg.section.extent, decay_of_warping(leg, divisions))
    return DOUBLINGS + max(0, int(np.ceil(np.log2(shortest / leg.length))))


@dataclass(frozen=True)
class Restraint:
    """A named difference of two models and its exponent in the slenderness.

    `amounts` gives its relative size (m) at all lengths of leg 1 or 2.
    """

    label: str
    claim: str
    exponent: float
    amounts: Callable[[Context, str], Array]


def _study_of(context: Context, body: str, material: Material) -> Lengthened:
    own = constant_leg_of(context, body)
    divisions = affordable_divisions(own, context.preset)
    if reason := _too_large(own, context.preset):
        takes = larger_preset(context.preset, lambda one: not _too_large(own, one))
        raise Skip(f"{reason}; {takes} takes it")
    leg = replace(own, material=material)
    doublings = context.get(doublings_needed, own, divisions)
    return context.get(lengthened, leg, divisions, doublings)


def _too_large(leg: ConstantLeg, preset: Preset) -> str:
    return face_too_large(leg, affordable_divisions(leg, preset), preset)


def _own(context: Context, body: str) -> Lengthened:
    return _study_of(context, body, constant_leg_of(context, body).material)


def _without_contraction(context: Context, body: str) -> Lengthened:
    return _study_of(context, body, replace(constant_leg_of(context, body).material, nu=0.0))


def _isotropic(context: Context, body: str) -> Lengthened:
    own = constant_leg_of(context, body).material
    return _study_of(context, body, Material.isotropic(own.E, _POISSON, own.rho))


def _torsion(context: Context, body: str) -> Array:
    if isinstance(constant_leg_of(context, body).section, (Circle, Tube)):
        return np.zeros_like(_own(context, body).lengths)
    found = _without_contraction(context, body)
    return np.asarray(1.0 - found.rigid[:, 3] / found.free[:, 3])


def _shear_warping(context: Context, body: str) -> Array:
    found = _without_contraction(context, body)
    return np.asarray((found.free - found.rigid)[:, 2] / found.slender[:, 2])


def _shear_left_out(context: Context, body: str) -> Array:
    found = _own(context, body)
    lengths, turning = found.lengths, found.free[:, 4]
    # 1/EI of this very mesh: what the mesh lacks of it has no exponent. Cells that cannot contract
    # as they should (round sections) hold both faces a little: the root's share of that, felt at
    # the tip by the lever L, would be s⁻¹.
    per_length = (turning[-1] - turning[0]) / (lengths[-1] - lengths[0])
    at_faces = turning - per_length * lengths
    slender = per_length * lengths**3 / 3.0 + 0.5 * at_faces * lengths**2
    return np.asarray(found.free[:, 2] / slender - 1.0)


def _rotary_inertia(context: Context, body: str) -> Array:
    beam = constant_leg_of(context, body).timoshenko
    lengths = _own(context, body).lengths
    return np.array(
        [context.get(fundamental_ratio, beam, float(length)) - 1.0 for length in lengths]
    )


def _contraction(context: Context, body: str, entry: int) -> Array:
    found = _isotropic(context, body)
    return np.asarray((found.free - found.rigid)[:, entry] / found.slender[:, entry])


CAUSES: dict[str, Restraint] = {
    "torsion": Restraint(
        "c44, warping restrained",
        "what rigid end faces take from torsion vanishes",
        -1.0,
        _torsion,
    ),
    **{
        f"contraction.{name}": Restraint(
            f"{name}, contraction restrained (ν = 0.3)",
            f"Poisson's contraction held at a rigid face, {load}: vanishes",
            -1.0,
            partial(_contraction, entry=entry),
        )
        for entry, (name, load) in enumerate(
            (("c11", "tension"), ("c22", "bending z"), ("c33", "bending y"))
        )
    },
    "shear": Restraint(
        "c33, shear deformation left out",
        "Euler–Bernoulli's theory against the solid, bending y: the difference vanishes",
        -2.0,
        _shear_left_out,
    ),
    "rotary-inertia": Restraint(
        "first frequency along z, rotary inertia left out",
        "what rotary inertia takes from the first bending frequency vanishes",
        -2.0,
        _rotary_inertia,
    ),
    "shear-warping": Restraint(
        "c33, warping of shear restrained",
        "warping of shear held at rigid faces (ν = 0), bending y: vanishes",
        -3.0,
        _shear_warping,
    ),
}


cases = CaseGroup(
    over={"body": lambda legs: legs},
    unit="1",
    reference_kind="closed-form",
    section=SECTION,
    group="restraint.{body}",
    effort=0.5,
)


@cases.case(
    "restraint.{body}.exponent[{name}]",
    "{body}: {cause.claim} with the slenderness to the power {cause.exponent:g}",
    over={"name, cause": CAUSES.items()},
    quantity="exponent of the slenderness, {cause.label}",
    citation=THEORY,
    tolerance=Absolute(0.05),
    tolerance_reason="local exponents of three lengths, extrapolated in 1/s: the term after next "
    "leaves 0.02 at most; the nearest other cause is a whole power away",
    sides=Sides(_SOLID),
)
def _exponent(context: Context, body: str, cause: Restraint) -> Measurement:
    lengths = _own(context, body).lengths
    amounts = cause.amounts(context, body)
    if amounts[-1] < _ROUND_OFF:
        raise Skip(
            f"{body}, {cause.label}: {amounts[-1]:.1g} of the value at {lengths[-1]:.3g} m, "
            "no more than rounding (round sections do not warp)"
        )
    slenderness = _slenderness(context, body)
    return Measurement(
        limit_exponent(lengths, amounts),
        cause.exponent,
        # What the longest length has changed: the term after next of the expansion in 1/s.
        value_uncertainty=abs(
            limit_exponent(lengths, amounts) - limit_exponent(lengths[:-1], amounts[:-1])
        ),
        notes=(
            f"the leg as it is, length / larger side {slenderness[0]:.3g}: {cause.label}, "
            f"{100.0 * amounts[0]:.3g} %",
        ),
        table={
            "length (m)": tuple(lengths.tolist()),
            "length / larger side": tuple(slenderness.tolist()),
            "relative difference (%)": tuple((100.0 * amounts).tolist()),
        },
        studies=(_study(context, body),),
    )


def _slenderness(context: Context, body: str) -> Array:
    side = max(constant_leg_of(context, body).section.extent)
    return np.asarray(_own(context, body).lengths / side)


def _study(context: Context, body: str) -> Study:
    lengths = _own(context, body).lengths
    found = {cause.label: cause.amounts(context, body) for cause in CAUSES.values()}
    visible = {label: amounts for label, amounts in found.items() if amounts[-1] >= _ROUND_OFF}
    shares = ", ".join(f"{label} {100.0 * amounts[0]:.3g} %" for label, amounts in visible.items())
    return Study(
        id=f"restraint.{body}",
        title=f"{body}: what sets beam and solid apart, and how it vanishes with length",
        x_label="slenderness: length / larger side",
        y_label="relative difference",
        unit="1",
        x=tuple(float(f"{s:.3g}") for s in _slenderness(context, body)),
        series={label: tuple(amounts.tolist()) for label, amounts in visible.items()},
        orders={label: -limit_exponent(lengths, amounts) for label, amounts in visible.items()},
        limits=dict.fromkeys(visible, 0.0),
        notes=(f"At the leg's own length: {shares}.",),
    )


@cases.case(
    "restraint.{body}.free",
    "{body}: with ends free to warp and contract the solid is a Timoshenko beam",
    quantity="largest relative difference of the six diagonal compliances, all lengths",
    citation="Clapeyron's theorem on Saint-Venant's exact solution: C = ∫ of unit resultants over "
    "EA … κGA, κ by strain energy",
    tolerance=Absolute(1e-4),
    tolerance_reason="no cause is left: the mesh alone, 0.003 % and less; 1e-4 is what the project "
    "asks for",
    sides=Sides(_SOLID, (section_constants, beam_properties)),
)
def _free(context: Context, body: str) -> Measurement:
    found = _own(context, body)
    apart = found.free / found.beam - 1.0
    own = constant_leg_of(context, body)
    divisions = affordable_divisions(own, context.preset)
    other = divisions // 2 or 2
    rougher = context.get(lengthened, own, other, context.get(doublings_needed, own, divisions))
    length, entry = np.unravel_index(int(np.argmax(np.abs(apart))), apart.shape)
    step = apart[length, entry] - (rougher.free / rougher.beam - 1.0)[length, entry]
    held = found.rigid / found.beam - 1.0
    return Measurement(
        float(np.abs(apart).max()),
        0.0,
        value_uncertainty=abs(float(step)) * step_factor(divisions / other, FORMAL_ORDER),
        table={
            "compliance": _DIAGONALS,
            "free ends, off beam theory (%)": tuple((100.0 * apart[0]).tolist()),
            "rigid ends, off beam theory (%)": tuple((100.0 * held[0]).tolist()),
        },
        notes=(f"largest at the leg's own length: {np.abs(apart[0]).max():.2g}",),
    )
