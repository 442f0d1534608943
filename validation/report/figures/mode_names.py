"""Names of modes, such as "torsion" or "along z", for titles, captions and tables.

Input: mode shapes of an assembled system. Output: a name and a sentence for each mode. Rule: a mode
with most strain energy in torsion is called "torsion"; for a planar mechanism, the shares of
kinetic energy by direction, rotation of sections included, decide between "in the plane" and "along
z".
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.legs import LineLeg
from lumped.mechanism.body import Body, Part, Rigid
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import Side
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import leg_of, legs_of
from lumped.system.assembly import System
from lumped.system.joint_motion import Portion
from lumped.system.solution import strain_shares
from validation.drawing.style import FILLS
from validation.kinematics.solids import in_one_plane
from validation.models.reduced_parts import identified

IN_THE_PLANE = "in the plane"
# Kinds of bending of a leg: about its axes y and z, or about both if its section couples them
# (lumped.mechanism.body_model).
_BENDING = ("bending y", "bending z", "bending")
DRIVES, JOINTS, PARTS = "drives", "joint compliance", "parts"
# Stations along a leg, and corners about its centreline that have a section's second moments.
_STATIONS = 12
_CORNERS = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])


@dataclass(frozen=True, eq=False)
class ModeNames:
    """Shares of energy of m modes, which determine the names of the modes.

    `strain`: share (m) of each mode's strain energy by kind of deformation. `kinetic` (3×m): shares
    of kinetic energy along base x, y and z. `planar`: true if all interfaces of the mechanism lie
    in one plane z = constant.
    """

    strain: Mapping[str, Array]
    kinetic: Array
    planar: bool

    def name(self, mode: int) -> str:
        """Name of a mode (index from 0): "torsion", "in the plane", "along z".

        If the mechanism is not planar, the mode's leading kind of deformation, such as "bending".
        "" if this kind is deformation of CAD parts.
        """
        kind = leading_kind(self._without_axes(), mode)
        if kind == "torsion":
            return kind
        if self.planar:
            return "along z" if self.kinetic[2, mode] > 0.5 else IN_THE_PLANE
        return "" if kind == PARTS else kind

    def sentence(self, mode: int) -> str:
        """Sentence on a mode (index from 0): its name, and the energy shares that determine it."""
        shares = self._without_axes()
        kind, name = leading_kind(shares, mode), self.name(mode)
        return (
            f"Mode {mode + 1}{name and f', {name}'}: {100.0 * shares[kind][mode]:.0f} % of the "
            f"strain energy in {kind}, {100.0 * self.kinetic[2, mode]:.0f} % of the kinetic energy "
            "along z."
        )

    def _without_axes(self) -> Mapping[str, Array]:
        """Shares (m) of strain energy by kind of deformation, with all bending as one kind.

        Bending about y and about z are summed, because the axes differ between legs.
        """
        bending = [self.strain[kind] for kind in _BENDING if kind in self.strain]
        remaining = {kind: share for kind, share in self.strain.items() if kind not in _BENDING}
        return remaining | ({"bending": np.sum(bending, axis=0)} if bending else {})


def leading_kind(strain: Mapping[str, Array], mode: int) -> str:
    """Kind of deformation with the largest share of a mode's strain energy."""
    return max(strain, key=lambda kind: float(strain[kind][mode]))


def mode_names(system: System, shapes: Array) -> ModeNames:
    """Energy shares that determine the names of the modes of a system, from their shapes (n×m).

    Shapes: m modes, n unknowns.
    """
    mechanism = system.posture.mechanism
    strain = shares_by_kind(strain_shares(system, shapes), mechanism)
    return ModeNames(strain, kinetic_shares(system, shapes), in_one_plane(system.posture))


def shares_by_kind(strain: Mapping[Portion, Array], mechanism: Mechanism) -> dict[str, Array]:
    """Shares of strain energy by kind of deformation.

    The shares of all drives are summed to one kind. The same is done for all joints and for all CAD
    parts.
    """
    legs = legs_of(mechanism)

    def kind(part: Portion) -> str:
        if part.of in mechanism.parts:
            return PARTS
        if part.of in legs:
            return part.kind
        return DRIVES if part.kind == "drive" else JOINTS

    return sum_shares(strain, kind)


def sum_shares(
    strain: Mapping[Portion, Array], group: Callable[[Portion], str]
) -> dict[str, Array]:
    """Shares of strain energy, summed over all portions with the same `group`.

    Groups that have a fixed colour in the drawings come first.
    """
    sums: dict[str, Array] = {}
    for part, share in strain.items():
        sums[group(part)] = sums.get(group(part), 0.0) + share
    return {key: sums[key] for key in dict.fromkeys((*FILLS, *sums)) if key in sums}


def kinetic_shares(system: System, shapes: Array) -> Array:
    """Shares (3×m) of the kinetic energy of mode shapes (n×m) along base x, y and z.

    Shapes: m modes, n unknowns.
    """
    energy = kinetic_energies(system, shapes)
    return np.asarray(energy / energy.sum(axis=0))


def kinetic_energies(system: System, shapes: Array) -> Array:
    """∫ρ uᵢ² dV (3×m, kg m²) of mode shapes u along base axes i = x, y, z.

    The mass of each body is lumped in points.

    Shapes: m modes.
    """
    mechanism, posture = system.posture.mechanism, system.posture
    energy = np.zeros((3, shapes.shape[1]))
    for name, model in system.models.items():
        points, masses = _mass_points(mechanism.bodies[name])
        local_motions = (model.displacements(points) @ system.body_unknowns(name, shapes)).reshape(
            len(points), 3, -1
        )
        motions = np.einsum("ij,njm->nim", posture.frames[name].rotation, local_motions)
        energy += np.einsum("n,nim->im", masses, np.square(motions))
    loaded = Side(mechanism.tool.body, mechanism.tool.point)
    point_masses = [
        (loaded, interface_position(posture, loaded)[None], np.array([mechanism.tool.mass]))
    ]
    for name, body in mechanism.bodies.items():
        if isinstance(body.shape, Rigid) and body.shape.mass and body.interfaces:
            points, masses = _mass_points(body)
            frame = posture.frames[name]
            places = frame.position + points @ frame.rotation.T
            point_masses.append((Side(name, next(iter(body.interfaces))), places, masses))
    for side, places, masses in point_masses:
        point = interface_position(posture, side)
        twists = system.motions.at(side.body, side.point, point) @ shapes[: system.outer]
        rotations = np.cross(twists[3:].T, (places - point)[:, None])
        energy += np.einsum("n,nmi->im", masses, np.square(twists[:3].T + rotations))
    return energy


def _mass_points(body: Body) -> tuple[Array, Array]:
    """Points (n×3, m, body axes) with masses (n, kg) that are equivalent to a body's mass."""
    if isinstance(body.shape, Rigid):
        moments = 0.5 * np.trace(body.shape.inertia) * np.eye(3) - body.shape.inertia
        squared, axes = np.linalg.eigh(moments / body.shape.mass)
        arms = axes * np.sqrt(3.0 * np.maximum(squared, 0.0))
        points = body.shape.centre + np.vstack([arms.T, -arms.T])
        return points, np.full(6, body.shape.mass / 6.0)
    if isinstance(body.shape, Part):
        samples = identified(body)
        return samples.places, samples.shares
    described = leg_of(body)
    nodes, weights = np.polynomial.legendre.leggauss(_STATIONS)
    if isinstance(described, LineLeg):
        half = 0.5 * described.line.length
        points, mu = described.inertia_points(half * (1.0 + nodes), _CORNERS)
        return points.reshape(-1, 3), np.repeat(mu * half * weights / 4.0, 4)
    leg = equivalent_leg(described)
    section = leg.section
    radii = np.sqrt(np.array([section.second_moment_z, section.second_moment_y]) / section.area)
    corners = np.column_stack([np.zeros(4), _CORNERS * radii])
    along = np.column_stack([0.5 * leg.length * (1.0 + nodes), np.zeros((_STATIONS, 2))])
    points = (along[:, None] + corners).reshape(-1, 3)
    return points, np.repeat(leg.mass * 0.5 * weights / 4.0, 4)
