"""Guards of legs reduced to their ends, on a short solid leg with both kinds of ends.

It is small: what is guarded here is otherwise seen in expensive comparisons alone.
"""

from dataclasses import dataclass

import numpy as np

from fem.bodies import leg_modes, solid
from fem.bodies.leg_energies import DISTORTION, kind_energies
from fem.bodies.solid import Ends
from fem.couplings.end_coupling import rigid_ends
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.free_superelement import held_free_leg
from fem.reduction.superelement import ENDS, held_leg, mass_properties, rigid_motions
from lumped.arrays import Array
from lumped.dense.modes import dense, solve_modes
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.body_model import LegMatrices
from lumped.models.segments import KINDS
from lumped.sections import Rectangle
from meshes.prism.hexahedra import hexahedra
from validation.agreement.differences import farthest_off, scaled_difference
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.guards.robot import MODES, SECTION
from validation.context import Context
from validation.solids.robots import full_mac

# Unlike in both planes, contracting, with a shear modulus of its own: more than 400 unknowns, so
# that modes are found by Lanczos, in a few hundredths of a second.
_LEG = ConstantLeg(
    0.6, Rectangle(0.08, 0.14), Material(E=2.1e11, G=0.7 * 2.1e11 / 2.6, nu=0.3, rho=7850.0)
)
_SLICES = 6
# Hz: some of the leg's modes between held ends are below.
_CUTOFF = 4000.0
_REDUCED = "the same mesh without reduction (fem.bodies.solid)"


@dataclass(frozen=True, eq=False)
class ReducedSolid:
    """The guards' leg before and after its reduction: `stiffness`, `mass` (r×r), root free.

    Root clamped: `compliance` (6×6, SI), `frequencies` (Hz) and `mac` of their shapes on all
    unknowns of the mesh; `full_…` without reduction. `moved` (3N×6) are the
    displacements by the six rigid motions about the root, less these motions.
    """

    matrices: LegMatrices
    compliance: Array
    full_compliance: Array
    frequencies: Array
    full_frequencies: Array
    mac: Array
    moved: Array


cases = CaseGroup(
    section=SECTION, group="guard.reduction", unit="1", reference_kind="closed-form", effort=0.05
)
_held = cases.family(over={"ends": ("rigid", "free")})


def reduced_solid_leg(ends: Ends) -> ReducedSolid:
    """The guards' leg, reduced and not."""
    mesh = hexahedra(_LEG.section, _LEG.length, (1, 2), slices=_SLICES)
    whole = solid.solid_leg(_LEG, mesh)
    clamped = solid.clamped_leg(whole, ends)
    held = held_free_leg(clamped) if ends == "free" else held_leg(solid.solid_leg_matrices(whole))
    full = leg_modes.modes(clamped, MODES)
    reduced = craig_bampton(held, float(full.frequencies[-1]))
    # Without the root's six unknowns the leg is clamped.
    stiffness, mass = (
        dense(matrix)[6:, 6:] for matrix in (reduced.matrices.stiffness, reduced.matrices.mass)
    )
    modes = solve_modes(stiffness, mass, MODES, "reduced leg")
    unknowns = np.vstack([np.zeros((6, MODES)), modes.shapes])
    rigid = reduced.recover(rigid_motions(reduced.matrices))
    field = reduced.recover(unknowns)
    if ends == "rigid":
        onto_mesh = rigid_ends(mesh).transformation
        rigid, field = np.asarray(onto_mesh @ rigid), np.asarray(onto_mesh @ field)
    return ReducedSolid(
        matrices=reduced.matrices,
        compliance=np.asarray(np.linalg.inv(stiffness[:6, :6])),
        full_compliance=solid.tip_compliance(clamped),
        frequencies=modes.frequencies,
        full_frequencies=full.frequencies,
        mac=full_mac(whole.mass, full.shapes, field, modes.frequencies),
        moved=rigid - _rigid_fields(mesh.nodes),
    )


def _rigid_fields(points: Array) -> Array:
    """Displacements (3N×6) of points (N×3, m) by unit translations and rotations about 0."""
    units = np.eye(3)
    shifted = [np.tile(unit, len(points)) for unit in units]
    turned = [np.cross(unit, points).ravel() for unit in units]
    return np.column_stack([*shifted, *turned])


@_held.case(
    "guard.reduction.compliance[{ends}]",
    "A reduced solid leg has the tip compliance of its mesh ({ends} ends)",
    quantity="largest difference of the 6×6 in units of √(c_ii c_jj)",
    citation=_REDUCED,
    tolerance=Absolute(1e-7),
    tolerance_reason="exact in theory: rounding, by the condition of a solid",
)
def _compliance(context: Context, ends: Ends) -> Measurement:
    found = context.get(reduced_solid_leg, ends)
    return farthest_off(scaled_difference(found.compliance, found.full_compliance))


@_held.case(
    "guard.reduction.frequency[{ends}]",
    "A reduced solid leg, clamped at its root, has the frequencies of its mesh ({ends} ends)",
    quantity=f"largest relative difference of the first {MODES}",
    citation=_REDUCED,
    tolerance=Absolute(1e-4),
    tolerance_reason="the cut-off is chosen for 1e-4 at the highest frequency asked for",
)
def _frequencies(context: Context, ends: Ends) -> Measurement:
    found = context.get(reduced_solid_leg, ends)
    return farthest_off(found.frequencies / found.full_frequencies - 1.0)


@_held.case(
    "guard.reduction.mac[{ends}]",
    "… and its shapes, recovered on all unknowns of the mesh ({ends} ends)",
    quantity=f"smallest mass-weighted MAC of the first {MODES}",
    citation=_REDUCED,
    tolerance=Absolute(1e-4),
    tolerance_reason="shapes are right to the root of the frequencies' 1e-4",
)
def _mac(context: Context, ends: Ends) -> Measurement:
    return Measurement(float(context.get(reduced_solid_leg, ends).mac.min()), 1.0, exact=True)


@_held.case(
    "guard.reduction.mass[{ends}]",
    "A reduced solid leg weighs what it did, about the same point ({ends} ends)",
    quantity="largest relative difference of mass, centre and moments of inertia",
    citation="a homogeneous block: m, L/2, m (b² + h²)/12 …",
    tolerance=Absolute(1e-9),
    tolerance_reason="rigid motions are among those of the ends: rounding alone",
)
def _mass(context: Context, ends: Ends) -> Measurement:
    leg = context.get(reduced_solid_leg, ends).matrices
    found = mass_properties(leg, rigid_motions(leg))
    b, h, l = _LEG.section.extent[0], _LEG.section.extent[1], _LEG.length
    mass = _LEG.material.rho * b * h * l
    inertia = mass / 12.0 * np.diag([b**2 + h**2, l**2 + h**2, l**2 + b**2])
    off = [
        found.mass / mass - 1.0,
        *(found.centre / l - np.array([0.5, 0.0, 0.0])),
        *((found.inertia - inertia) / inertia.max()).ravel(),
    ]
    return farthest_off(off)


@_held.case(
    "guard.reduction.rigid-motion[{ends}]",
    "A reduced solid leg whose ends move as one body moves as that body ({ends} ends)",
    quantity="largest difference of displacements on the mesh, rotations about the root by 1/L",
    citation="u + φ × r",
    tolerance=Absolute(1e-7),
    tolerance_reason="constraint modes hold rigid motions exactly: rounding, by the condition of a "
    "solid",
)
def _rigid_motion(context: Context, ends: Ends) -> Measurement:
    moved = context.get(reduced_solid_leg, ends).moved
    scale = np.array([1.0, 1.0, 1.0, *[1.0 / _LEG.length] * 3])
    return farthest_off(moved * scale)


def dropped_modes() -> tuple[Array, Array]:
    """W (12×12) of the modes that a reduction drops: as it states it, and from all modes.

    Σ p pᵀ/ω⁶ over the modes above the cut-off, both ends held, by a dense solution of the mesh.
    """
    mesh = hexahedra(_LEG.section, _LEG.length, (1, 2), slices=_SLICES)
    leg = solid.solid_leg_matrices(solid.solid_leg(_LEG, mesh))
    reduced = craig_bampton(held_leg(leg), 1.0, _CUTOFF)
    stiffness, mass = dense(leg.stiffness), dense(leg.mass)
    own = stiffness[ENDS:, ENDS:]
    constraint = np.vstack([np.eye(ENDS), -np.linalg.solve(own, stiffness[ENDS:, :ENDS])])
    modes = solve_modes(own, mass[ENDS:, ENDS:], len(own), "held leg")
    dropped = modes.frequencies > _CUTOFF
    squares = np.square(2.0 * np.pi * modes.frequencies[dropped])
    share = modes.shapes[:, dropped].T @ (mass @ constraint)[ENDS:]
    return reduced.truncated, np.asarray((share.T / squares**3) @ share)


@cases.case(
    "guard.reduction.dropped",
    "What bounds the error of a reduction is that of all the modes that it drops",
    quantity="largest difference of the 12×12 in units of √(w_ii w_jj)",
    citation="Σ p pᵀ/ω⁶ over every mode of the mesh above the cut-off, LAPACK",
    tolerance=Absolute(1e-9),
    tolerance_reason="one sum, from static responses and term by term: rounding",
)
def _dropped(context: Context) -> Measurement:
    stated, summed = context.get(dropped_modes)
    return farthest_off(scaled_difference(stated, summed))


def loaded_solid_energies() -> dict[str, Array]:
    """Strain energies (J, six values) by kind under unit wrenches at the tip, free ends."""
    mesh = hexahedra(_LEG.section, _LEG.length, (2, 4), slices=_SLICES)
    whole = solid.solid_leg(_LEG, mesh)
    clamped = solid.clamped_leg(whole, "free")
    fields = clamped.ends.expanded(clamped.factor.solve(clamped.ends.tip_loads()))
    return kind_energies(whole, np.asarray(fields))


@cases.case(
    "guard.reduction.energies",
    "A solid leg under one resultant has the energy of that kind alone",
    quantity="largest part of the strain energy that is in another kind",
    citation="Clapeyron: Saint-Venant's exact solution is tension, torsion or bending and no more",
    tolerance=Absolute(0.005),
    tolerance_reason="so coarse a mesh leaves 5e-4 to the distortion of the section: ten times "
    "that",
)
def _energies(context: Context) -> Measurement:
    found = context.get(loaded_solid_energies)
    total = np.sum(list(found.values()), axis=0)
    own = {load: kind for kind, loads in KINDS.items() for load in loads}
    shares = [found[own[load]][load] / total[load] for load in range(6)]
    return Measurement(
        float(1.0 - min(shares)),
        0.0,
        exact=True,
        notes=(f"distortion of the section {np.max(found[DISTORTION] / total):.2g} at most",),
    )
