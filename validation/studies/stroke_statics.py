"""The robot's deflections over its stroke by solid legs, and by virtual joints of those legs."""

from dataclasses import dataclass

import numpy as np

from fem.bodies.solid import Ends
from lumped.arrays import Array
from lumped.biglide import Biglide, postures, with_equivalent_legs
from lumped.legs import ConstantLeg, equivalent_leg, tip_compliance
from lumped.models import vjm
from lumped.system.assembly import assembly
from lumped.system.sweep import swept
from validation.agreement.convergence import step_factor
from validation.solids.legs import FORMAL_ORDER, formal_order
from validation.solids.robots import TipCompliances, TwoMeshes, static_leg, two_meshes
from validation.studies.quantities import Deflections, deflections_of

POSTURES = 9


@dataclass(frozen=True)
class StrokeStatics:
    """Deflections (µm) at the positions `x` (m) over the stroke.

    `rigid`, `free`: solid legs by their ends. `held`, `own`: virtual joints with legs of the
    constants of their section meshes, end faces held or free in theory. `torsion`: virtual joints
    with legs of textbook constants but for c44, which is that of the rigid-faced solid. Each on
    the coarser and on the finer mesh. `textbook`: legs of these constants throughout, without a
    mesh. `factors`: uncertainty over the step between both meshes, of a smooth solution, of free
    ends and of rigid faces.
    """

    x: Array
    rigid: tuple[Deflections, Deflections]
    free: tuple[Deflections, Deflections]
    held: tuple[Deflections, Deflections]
    own: tuple[Deflections, Deflections]
    textbook: Deflections
    torsion: tuple[Deflections, Deflections]
    factors: tuple[float, float, float]


def stroke_statics(robot: Biglide, most: int) -> StrokeStatics:
    """All curves; section meshes have at most `most` unknowns, InputError where they cannot."""
    member = with_equivalent_legs(robot)
    legs = equivalent_leg(member.leg1), equivalent_leg(member.leg2)
    meshes = two_meshes(legs[0], most), two_meshes(legs[1], most)
    both = [(meshes[0].coarse, meshes[1].coarse), (meshes[0].fine, meshes[1].fine)]
    textbook = [tip_compliance(leg.timoshenko, leg.length) for leg in legs]
    torsion = [
        (
            _with_torsion(textbook[0], first.rigid),
            _with_torsion(textbook[1], second.rigid),
        )
        for first, second in both
    ]
    x = member.stations(POSTURES)
    rigid, free = (
        [_solid_deflections(member, x, legs, pair, ends) for pair in both]
        for ends in ("rigid", "free")
    )
    own = [_vjm_deflections(member, x, (first.own, second.own)) for first, second in both]
    held = [_vjm_deflections(member, x, (first.held, second.held)) for first, second in both]
    return StrokeStatics(
        x=x,
        rigid=(rigid[0], rigid[1]),
        free=(free[0], free[1]),
        held=(held[0], held[1]),
        own=(own[0], own[1]),
        textbook=_vjm_deflections(member, x, (textbook[0], textbook[1])),
        torsion=(
            _vjm_deflections(member, x, torsion[0]),
            _vjm_deflections(member, x, torsion[1]),
        ),
        # One of the legs may be refined by less than the other: its factor holds for both.
        factors=(
            max(step_factor(mesh.ratio, FORMAL_ORDER) for mesh in meshes),
            _factor(legs, meshes, "free"),
            _factor(legs, meshes, "rigid"),
        ),
    )


def _factor(
    legs: tuple[ConstantLeg, ConstantLeg], meshes: tuple[TwoMeshes, TwoMeshes], ends: Ends
) -> float:
    return max(
        step_factor(mesh.ratio, formal_order(leg, ends))
        for leg, mesh in zip(legs, meshes, strict=True)
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
        static_leg(leg, found.rigid if ends == "rigid" else found.free, f"solid, {ends} ends")
        for leg, found in zip(legs, compliances, strict=True)
    )
    places = postures(robot, x)
    prepared = assembly(places[0].mechanism, {"leg1": leg1, "leg2": leg2})
    return deflections_of(swept(prepared, places, 0).compliances)


def _vjm_deflections(robot: Biglide, x: Array, springs: tuple[Array, Array]) -> Deflections:
    return deflections_of(np.array([vjm.compliance(robot, at, springs) for at in x.tolist()]))
