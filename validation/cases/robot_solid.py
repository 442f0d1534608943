"""Statics of the robot with solid legs over its stroke, against virtual joints."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from fem.solid import Ends
from lumped import mechanism, vjm
from lumped.arrays import Array
from lumped.biglide import Biglide, with_equivalent_legs
from lumped.legs import ConstantLeg, equivalent_leg, tip_compliance
from validation.case import Absolute, Allowance, Case, Measurement, Relation, Relative
from validation.cases.robot import CURVES
from validation.cases.solids import own_beam
from validation.context import Context, Preset
from validation.exhibits import Study
from validation.quantities import Deflections, deflections_of
from validation.robot_solids import TipCompliances, static_solid, two_meshes

SECTION = "The robot with solid legs"
POSTURES = 9
# Unknowns of the finest section mesh; three meshes at least are taken from the ladder.
UNKNOWNS: dict[Preset, int] = {"quick": 900, "standard": 900, "fine": 2000}
_CITATION = "virtual joint method, eqs (3) to (9), "


def cases() -> tuple[Case, ...]:
    """Both kinds of ends over the stroke, every difference with its named cause."""
    return (
        *_curves(
            name="rigid",
            title="Solid legs with rigid end faces give the virtual joints' {}",
            citation=_CITATION + "same equivalent legs (Timoshenko)",
            tolerance=1e-3,
            reason="rigid end faces and textbook constants are allowed for by their own effect; "
            "what is left is the mesh: below 0.1 % in torsion",
        ),
        *_curves(
            name="free",
            title="Solid legs with ends free to warp give the virtual joints' {}",
            citation=_CITATION + "Timoshenko legs of the sections' own finite-element constants",
            tolerance=1e-3,
            reason="with Saint-Venant's tractions both are one theory: the mesh alone, 0.1 %",
        ),
    )


def paper_cases() -> tuple[Case, ...]:
    """What holds of the paper's robot (ν = 0) without any allowance."""
    planar = "ν = 0: rigid faces restrain torsion alone, which no planar load causes"
    along_z = "torsional warping restrained at rigid faces: 2 % at these slendernesses"
    bare = (
        _bare_case("planar-x", 0.01, 0.005, planar),
        _bare_case("planar-y", 0.01, 0.005, planar),
        _bare_case("along-z", 2.1, 0.1, along_z),
    )
    torsion = _curves(
        name="torsion",
        title="Rigid end faces change hardly anything but torsion: {}",
        citation=_CITATION + "equivalent legs whose c44 alone is that of the rigid-faced solid",
        tolerance=5e-4,
        reason="what is left is warping by shear forces, restrained as well: 0.02 % (measured)",
    )
    return (*bare, torsion[2])


def _bare_case(curve: str, limit: float, tolerance: float, reason: str) -> Case:
    attribute, meaning = CURVES[curve]
    return Case(
        id=f"robot.solid.statics-bare.{curve}",
        title=f"Solid legs with rigid end faces, nothing allowed for: {meaning}",
        quantity="largest difference from the virtual joints over the stroke",
        unit="%",
        reference_kind="independent-solver",
        citation=_CITATION + "same equivalent legs (Timoshenko)",
        tolerance=Absolute(tolerance),
        tolerance_reason=f"rounding of the bound; {reason}",
        compute=partial(_bare, curve=attribute, limit=limit),
        relation=Relation.AT_MOST,
        section=SECTION,
        group="robot.solid.statics",
        effort=1.0,
    )


def _curves(name: str, title: str, citation: str, tolerance: float, reason: str) -> list[Case]:
    return [
        Case(
            id=f"robot.solid.statics-{name}.{curve}",
            title=title.format(meaning),
            quantity=f"{meaning}, posture of the largest difference",
            unit="µm",
            reference_kind="independent-solver",
            citation=citation,
            tolerance=Relative(tolerance),
            tolerance_reason=reason,
            compute=partial(_COMPUTE[name], curve=attribute),
            section=SECTION,
            group="robot.solid.statics",
            effort=1.0,
        )
        for curve, (attribute, meaning) in CURVES.items()
    ]


@dataclass(frozen=True)
class StrokeStatics:
    """Deflections (µm) at the positions `x` (m) over the stroke.

    `rigid`, `free`: solid legs by their ends, on the coarser and on the finer mesh. Virtual joints
    with legs of textbook constants, of the sections' own, and with the textbook's but for c44,
    which is that of the rigid-faced solid: `textbook`, `own`, `torsion`.
    """

    x: Array
    rigid: tuple[Deflections, Deflections]
    free: tuple[Deflections, Deflections]
    textbook: Deflections
    own: Deflections
    torsion: Deflections


def stroke_statics(robot: Biglide, most: int) -> StrokeStatics:
    """All curves, on section meshes of at most `most` unknowns."""
    member = with_equivalent_legs(robot)
    legs = equivalent_leg(member.leg1), equivalent_leg(member.leg2)
    meshes = two_meshes(legs, most)
    textbook = [tip_compliance(leg.timoshenko, leg.length) for leg in legs]
    own = [tip_compliance(own_beam(leg), leg.length) for leg in legs]
    torsion = [
        _with_torsion(springs, mesh[1].rigid)
        for springs, mesh in zip(textbook, meshes, strict=True)
    ]
    x = member.stations(POSTURES)

    def solids(ends: Ends, mesh: int) -> Deflections:
        pair = (meshes[0][mesh], meshes[1][mesh])
        return _solid_deflections(member, x, legs, pair, ends)

    return StrokeStatics(
        x=x,
        rigid=(solids("rigid", 0), solids("rigid", 1)),
        free=(solids("free", 0), solids("free", 1)),
        textbook=_vjm_deflections(member, x, (textbook[0], textbook[1])),
        own=_vjm_deflections(member, x, (own[0], own[1])),
        torsion=_vjm_deflections(member, x, (torsion[0], torsion[1])),
    )


def _with_torsion(springs: Array, source: Array) -> Array:
    changed = springs.copy()
    changed[3, 3] = source[3, 3]
    return changed


def _solid_deflections(
    robot: Biglide,
    x: Array,
    legs: tuple[ConstantLeg, ConstantLeg],
    compliances: tuple[TipCompliances, TipCompliances],
    ends: Ends,
) -> Deflections:
    leg1, leg2 = (
        static_solid(leg, found.rigid if ends == "rigid" else found.free, ends)
        for leg, found in zip(legs, compliances, strict=True)
    )
    return deflections_of(
        np.array(
            [mechanism.compliance(mechanism.assemble(robot, at, leg1, leg2)) for at in x.tolist()]
        )
    )


def _vjm_deflections(robot: Biglide, x: Array, springs: tuple[Array, Array]) -> Deflections:
    return deflections_of(np.array([vjm.compliance(robot, at, springs) for at in x.tolist()]))


@dataclass(frozen=True)
class _Curve:
    """One deflection over the stroke (µm, m values each), named as in StrokeStatics."""

    x: Array
    rigid: Array
    free: Array
    textbook: Array
    own: Array
    torsion: Array
    uncertainty_rigid: Array
    uncertainty_free: Array


def _curve(context: Context, curve: str) -> _Curve:
    found = context.get(stroke_statics, context.robot, UNKNOWNS[context.preset])
    (rigid, rigid_step), (free, free_step) = (
        (getattr(fine, curve), np.abs(getattr(fine, curve) - getattr(coarse, curve)))
        for coarse, fine in (found.rigid, found.free)
    )
    return _Curve(
        x=found.x,
        rigid=rigid,
        free=free,
        textbook=getattr(found.textbook, curve),
        own=getattr(found.own, curve),
        torsion=getattr(found.torsion, curve),
        # The whole step from the coarser mesh, which is several times the error left.
        uncertainty_rigid=rigid_step,
        uncertainty_free=free_step,
    )


def _rigid(context: Context, curve: str) -> Measurement:
    found = _curve(context, curve)
    restraint, textbook = found.rigid - found.free, found.own - found.textbook
    unexplained = found.rigid - found.textbook - restraint - textbook
    worst = _worst(unexplained, found.textbook)
    share = 100.0 * (found.rigid / found.textbook - 1.0)
    return Measurement(
        float(found.rigid[worst]),
        float(found.textbook[worst]),
        value_uncertainty=float(found.uncertainty_rigid[worst]),
        allowances=(
            Allowance(
                cause="end faces kept plane and rigid: torsional warping (and, for ν > 0, "
                "contraction) restrained",
                amount=float(restraint[worst]),
                source="same meshes with ends free to warp (Saint-Venant tractions)",
            ),
            Allowance(
                cause="textbook section constants (thin walls, Cowper's shear)",
                amount=float(textbook[worst]),
                source="fem.section_constants on the section's own mesh",
            ),
        ),
        notes=(f"largest difference at x = {found.x[worst]:.4g} m",),
        table={
            "x (m)": tuple(found.x.tolist()),
            "virtual joints (µm)": tuple(found.textbook.tolist()),
            "solid, rigid faces (µm)": tuple(found.rigid.tolist()),
            "solid, free ends (µm)": tuple(found.free.tolist()),
            "rigid faces to virtual joints (%)": tuple(share.tolist()),
        },
        studies=(_study(curve, found),),
    )


def _free(context: Context, curve: str) -> Measurement:
    found = _curve(context, curve)
    return _against(found, found.free, found.own, found.uncertainty_free)


def _bare(context: Context, curve: str, limit: float) -> Measurement:
    found = _curve(context, curve)
    raw = _against(found, found.rigid, found.textbook, found.uncertainty_rigid)
    percent = 100.0 / abs(raw.reference)
    return replace(
        raw,
        value=percent * abs(raw.difference),
        reference=limit,
        value_uncertainty=percent * (raw.value_uncertainty or 0.0),
    )


def _torsion(context: Context, curve: str) -> Measurement:
    found = _curve(context, curve)
    # Both sides have the same mesh's torsion: only what is left of the step counts.
    return _against(found, found.rigid, found.torsion, None)


def _against(
    found: _Curve, value: Array, reference: Array, uncertainty: Array | None
) -> Measurement:
    worst = _worst(value - reference, reference)
    return Measurement(
        float(value[worst]),
        float(reference[worst]),
        value_uncertainty=None if uncertainty is None else float(uncertainty[worst]),
        notes=(f"largest difference at x = {found.x[worst]:.4g} m",),
    )


_COMPUTE = {"rigid": _rigid, "free": _free, "torsion": _torsion}


def _worst(difference: Array, reference: Array) -> int:
    return int(np.argmax(np.abs(difference / reference)))


def _study(curve: str, found: _Curve) -> Study:
    return Study(
        id=f"robot.solid.statics.{curve}",
        kind="sweep",
        title=f"{curve.replace('_', ' ')}: solid legs and virtual joints",
        x_label="x (m)",
        y_label="deflection",
        unit="µm",
        x=tuple(found.x.tolist()),
        series={
            "vjm": tuple(found.textbook.tolist()),
            "solid, rigid end faces": tuple(found.rigid.tolist()),
            "solid, free ends": tuple(found.free.tolist()),
        },
    )
