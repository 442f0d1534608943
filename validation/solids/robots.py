"""Both legs of a robot as solids: meshed, reduced to their ends, and the whole robot of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, log2
from typing import TypeVar

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.sparse import csr_array

from fem.bodies.leg_energies import kind_energies
from fem.bodies.solid import (
    Ends,
    SolidLeg,
    clamped_leg,
    solid_leg,
    solid_leg_matrices,
    solid_mesh,
)
from fem.couplings.end_coupling import rigid_ends
from fem.couplings.end_effects import restrained_compliance
from fem.reduction.free_superelement import held_free_leg
from fem.reduction.superelement import ENDS, HeldLeg, Superelement, ends_stiffness, held_leg
from fem.sections.section_constants import beam_properties
from fem.solvers import sparse_system
from lumped.arrays import Array, SparseMatrix
from lumped.biglide import Biglide, in_words, with_equivalent_legs
from lumped.biglide import system as robot_system
from lumped.dense.modes import Modes
from lumped.errors import InputError, naming
from lumped.legs import ConstantLeg, Leg, equivalent_leg, tip_compliance
from lumped.mechanism.body_model import LegMatrices
from lumped.system import solution
from lumped.system.assembly import System
from lumped.system.joint_motion import Portion
from validation.solids.legs import (
    COARSEST_WALLS,
    doubled_tip,
    face_mesh,
    leg_constants,
    static_ladder,
    static_slices,
)

# Tasks of this group share what is kept of the robot's solids.
SHARED_SOLIDS = "robot.solid.modes"
# Frequencies of two modes of a double one differ by no more (relative): rounding alone.
_OF_ONE = 1e-9

T = TypeVar("T")


def meshed_leg(leg: ConstantLeg, divisions: int) -> SolidLeg:
    """A leg as a solid, `divisions` quadratic elements across the smaller side of its section."""
    return solid_leg(leg, solid_mesh(leg, divisions))


def held_solid(leg: ConstantLeg, divisions: int, ends: Ends) -> HeldLeg:
    """The solid leg with the twists of both ends given; `ends` as in its coupling."""
    solid = meshed_leg(leg, divisions)
    with naming(leg.name):
        if ends == "free":
            return held_free_leg(clamped_leg(solid, "free"))
        return held_leg(solid_leg_matrices(solid))


def renewed_where_needed(
    highest: float, solve: Callable[[float], T], frequencies: Callable[[T], Array]
) -> T:
    """`solve(highest)` with legs reduced for `highest` (Hz), again with more where that was low.

    What beams lead to expect, end faces that hold warping in open sections may exceed by far: what
    counts are the solid's own `frequencies` of the solution. More modes only lower them (Rayleigh),
    so that the second reduction suffices but for rounding.
    """
    while (top := float(np.max(frequencies(solution := solve(highest))))) > highest:
        highest = half_octave_above(top)
    return solution


def half_octave_above(frequency: float) -> float:
    """The next frequency (Hz) in steps of half an octave, so that postures share reduced legs."""
    return float(2.0 ** (0.5 * ceil(2.0 * log2(frequency))))


def static_leg(leg: Leg, compliance: Array, model: str) -> LegMatrices:
    """A leg of given tip compliance (6×6, SI, leg axes, root clamped) condensed to its ends.

    `model` is its name. Without mass; between its ends it is drawn as a straight line.
    """

    def centreline(at: Array) -> SparseMatrix:
        share = np.asarray(at, dtype=float) / leg.length
        return csr_array(np.kron(np.column_stack([1.0 - share, share]), np.eye(6)))

    return LegMatrices(
        model=model,
        length=leg.length,
        stiffness=ends_stiffness(np.linalg.inv(compliance).astype(float), leg.length),
        mass=np.zeros((ENDS, ENDS)),
        centreline=centreline,
    )


@dataclass(frozen=True)
class TipCompliances:
    """6×6 tip compliances (SI, leg axes) of one mesh of a leg and of its section.

    The solid's with `rigid` and with `free` ends, `own`: the Timoshenko cantilever's with the
    constants of the same section mesh, and `restrained`: what rigid faces take from it in theory.
    """

    rigid: Array
    free: Array
    own: Array
    restrained: Array

    @property
    def held(self) -> Array:
        """The cantilever's with end faces held plane and rigid."""
        return np.asarray(self.own + self.restrained)


@dataclass(frozen=True)
class TwoMeshes:
    """A leg on two similar meshes; sizes of the `coarse` one are `ratio` times the `fine` one's."""

    coarse: TipCompliances
    fine: TipCompliances
    ratio: float


def two_meshes(leg: ConstantLeg, most: int) -> TwoMeshes:
    """Tip compliances of a leg by doubling, on the meshes of `mesh_pair`."""
    coarse, fine = mesh_pair(leg, most)
    with naming(leg.name):
        return TwoMeshes(
            coarse=_compliances(leg, *coarse),
            fine=_compliances(leg, *fine),
            ratio=fine[1] / coarse[1],
        )


def mesh_pair(leg: ConstantLeg, most: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """Divisions of the section and slices along it of the two finest meshes, coarse and fine.

    Their section meshes have at most `most` unknowns. Where one alone of thin walls can have so
    few, both share it and the coarser one is half as fine along the leg: what the section mesh
    leaves out of a solid it leaves out of the constants alike. Raises InputError where not even
    that one is small enough.
    """
    ladder = static_ladder(leg, most)
    if ladder:
        coarse, fine = ladder[-2:]
        return (coarse, static_slices(leg, coarse)), (fine, static_slices(leg, fine))
    if (unknowns := _coarsest_unknowns(leg)) > most:
        raise InputError(
            f"{leg.name or 'leg'}: the coarsest section mesh of its {leg.section.shape} has "
            f"{unknowns} unknowns, more than {most}"
        )
    along = static_slices(leg, COARSEST_WALLS)
    return (COARSEST_WALLS, along), (COARSEST_WALLS, 2 * along)


def has_meshes(leg: ConstantLeg, most: int) -> bool:
    """Whether there is a `mesh_pair` of a leg."""
    return bool(static_ladder(leg, most)) or _coarsest_unknowns(leg) <= most


def _coarsest_unknowns(leg: ConstantLeg) -> int:
    return 3 * len(face_mesh(leg, COARSEST_WALLS).nodes)


def _compliances(leg: ConstantLeg, divisions: int, along: int) -> TipCompliances:
    return TipCompliances(
        rigid=doubled_tip(leg, divisions, along, "rigid"),
        free=doubled_tip(leg, divisions, along, "free"),
        own=own_tip(leg, divisions),
        restrained=restrained_tip(leg, divisions),
    )


def own_tip(leg: ConstantLeg, divisions: int) -> Array:
    """The Timoshenko cantilever's with the constants of the same section mesh."""
    properties = beam_properties(leg_constants(leg, divisions), leg.material)
    return tip_compliance(properties, leg.length)


def restrained_tip(leg: ConstantLeg, divisions: int) -> Array:
    """What rigid faces take from it in theory."""
    return restrained_compliance(face_mesh(leg, divisions), leg.material, leg.length)


@dataclass(frozen=True, eq=False)
class UnreducedRobot:
    """A robot with both legs meshed and no reduction, in one posture.

    `compliance` (6×6, SI, robot axes) at the loaded point and what `rounding` leaves open of it
    (half-widths, 95 %); `modes` with shapes on the unknowns of `system`; `solids` are the legs,
    rigid end faces, `legs` their matrices.
    """

    system: System
    compliance: Array
    rounding: Array
    modes: Modes
    solids: tuple[SolidLeg, SolidLeg]
    legs: tuple[LegMatrices, LegMatrices]


def unreduced_robot(
    robot: Biglide, positions: Sequence[float], divisions: int, count: int
) -> tuple[UnreducedRobot, ...]:
    """The whole robot in 3-D with B at each of `positions` (m), `count` modes each."""
    member = with_equivalent_legs(robot)
    solids = tuple(meshed_leg(equivalent_leg(leg), divisions) for leg in (member.leg1, member.leg2))
    pair = solids[0], solids[1]
    return tuple(solved_robot(member, x, pair, count) for x in positions)


def solved_robot(
    robot: Biglide, x: float, solids: tuple[SolidLeg, SolidLeg], count: int
) -> UnreducedRobot:
    """The whole robot with B at `x` (m) from two meshed legs with rigid end faces."""
    legs = solid_leg_matrices(solids[0]), solid_leg_matrices(solids[1])
    found = sparse_system.factorised(robot_system(robot, x, *legs))
    return UnreducedRobot(
        system=found.system,
        compliance=sparse_system.compliance(found),
        rounding=sparse_system.rounding(found),
        modes=sparse_system.modes(found, count),
        solids=solids,
        legs=legs,
    )


def recovered(reduced: System, legs: Mapping[str, Superelement], shapes: Array) -> Array:
    """Shapes of the robot of reduced `legs` on the unknowns of the unreduced robot (n×m).

    Both number the nodes of the robot first and alike, then the insides of the legs.
    """
    inner = [leg.recover(reduced.own(name, shapes))[ENDS:] for name, leg in legs.items()]
    return np.vstack([shapes[: reduced.outer], *inner])


def full_mac(mass: SparseMatrix, first: Array, second: Array, frequencies: Array) -> Array:
    """MAC (m) of each of the shapes `first` (n×m) with its partner in `second` (n×k), k ≥ m.

    Optimal pairing, weighted with the full `mass` (n×n): every unknown of the mesh counts. Shapes
    of one of the `frequencies` (k, Hz, of `second`) are any of their space: they count together,
    so that the last of `first` needs all of its space among the k.
    """
    momenta = mass @ second
    sizes = np.einsum("ij,ij->j", first, mass @ first)[:, None] * np.einsum(
        "ij,ij->j", second, momenta
    )
    mac = np.square(first.T @ momenta) / sizes
    _, partners = linear_sum_assignment(mac, maximize=True)
    of_one = np.abs(frequencies / frequencies[partners, None] - 1.0) < _OF_ONE
    return np.asarray(np.sum(mac, axis=1, where=of_one))


def strain_energy_shares(robot: UnreducedRobot) -> dict[Portion, Array]:
    """Share of the strain energy of each mode in feet, tool, and each leg's kinds.

    Foot 1, …, bending z of leg 1, …, section distortion of leg 2 (m values each) sum to 1.
    """
    kinds = {}
    for name, solid in zip(("leg1", "leg2"), robot.solids, strict=True):
        own = robot.system.own(name, robot.modes.shapes)
        energies = kind_energies(solid, np.asarray(rigid_ends(solid.mesh).transformation @ own))
        whole = sum(energies.values())
        kinds[name] = {kind: energy / whole for kind, energy in energies.items()}
    shares: dict[Portion, Array] = {}
    for part, share in solution.strain_shares(robot.system, robot.modes.shapes).items():
        said = in_words(part)
        of = {replace(said, kind=kind): own * share for kind, own in kinds.get(part.of, {}).items()}
        shares |= of or {said: share}
    return shares
