"""Surfaces of bodies and joints, displaced by the solution of an assembled mechanism.

Input: a system and its unknowns (a mode shape or a deflection). Output: displaced surfaces in base
axes, and displacements at points common to all models.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.legs import LineLeg
from lumped.mechanism.body import Body
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import leg_of, legs_of
from lumped.system.assembly import System
from validation.drawing.scene import DARK, DrawnBody, Wire
from validation.drawing.style import LOOKS
from validation.drawing.surfaces import Surface, faceted, joined
from validation.kinematics.solids import (
    COLOURS,
    Solid,
    line_surface,
    on_ground,
    section_prism,
    solids,
)
from validation.models.reduced_parts import coarsest_mesh, identified

# Number of points along a leg at which another model is drawn, as slightly larger outlines.
COMPARED_POINTS = 6
_SHARES = (np.arange(COMPARED_POINTS) + 0.5) / COMPARED_POINTS
_OUTSET = 1.06
# With fewer surface pieces, arcs look like polygons, so each piece is divided. More pieces would
# make the page too large.
_COARSE_PIECES = 1500
# Four triangles between the corners (0 to 2) and the mid-side nodes (3 to 5) of a tri6 face.
_SUBTRIANGLES = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])


@dataclass(frozen=True, eq=False)
class DisplacedSolid:
    """Surface of a body or joint at rest, with the displacements (n×3, m) of its points."""

    solid: Solid
    displacements: Array

    @property
    def deforms(self) -> bool:
        """True for a leg or CAD part. Its surface is coloured by displacement."""
        return self.solid.carrier is None

    @property
    def sizes(self) -> Array:
        """Length (m) of the displacement of each of n points."""
        return np.asarray(np.linalg.norm(self.displacements, axis=1))

    def body(self, factor: float, unit: float) -> DrawnBody:
        """Surface to be drawn, with displacements enlarged by `factor`.

        Legs and CAD parts are coloured by displacement, as a multiple of `unit` (m).
        """
        motion = factor * self.displacements
        values = self.sizes / unit if self.deforms else None
        return DrawnBody(
            self.solid.surface.moved(motion), COLOURS[self.solid.matter], values, motion
        )

    def wire(self) -> Wire:
        """Edges of the surface at rest."""
        return Wire(self.solid.surface.points, self.solid.surface.edges, colour="#8a8f98")


def displaced_solids(system: System, unknowns: Array) -> list[DisplacedSolid]:
    """Bodies and joints, displaced by the unknowns (n) of the system."""
    return [_displaced_solid(system, solid, unknowns) for solid in solids(system.posture)]


def _displaced_solid(system: System, solid: Solid, unknowns: Array) -> DisplacedSolid:
    if solid.carrier is None:
        part = system.posture.mechanism.parts.get(solid.name)
        frame = system.posture.frames[solid.name]
        if part:
            surface = _part_surface(part)
            drawn = replace(solid, surface=surface.placed(frame.position, frame.rotation))
            return DisplacedSolid(
                drawn, displacements(system, solid.name, surface.points, unknowns)
            )
        local_points = (solid.surface.points - frame.position) @ frame.rotation
        return DisplacedSolid(solid, displacements(system, solid.name, local_points, unknowns))
    position = interface_position(system.posture, solid.carrier)
    motion = system.motions.at(solid.carrier.body, solid.carrier.point, position)
    twist = motion @ unknowns[: system.outer]
    return DisplacedSolid(solid, twist[:3] + np.cross(twist[3:], solid.surface.points - position))


def rails(system: System) -> Iterator[Wire]:
    """Rails: lines between the two interfaces of each sliding joint on the ground."""
    for joint in system.posture.mechanism.joints:
        if on_ground(joint):
            ends = [
                interface_position(system.posture, side) for side in (joint.first, joint.second)
            ]
            yield Wire(np.array(ends), np.array([[0, 1]]), DARK, 3.0)


def compared_points(system: System, unknowns: Array) -> tuple[Array, Array]:
    """Points (p×3) of all legs and CAD parts, and the displacements of the points (base axes).

    Each body has `COMPARED_POINTS` points. They lie on the centreline of a leg, and in a row from
    the first interface of a part to its last. The displacements of the p points have the shape p×3
    if `unknowns` has the shape n, and p×3×k if it has the shape n×k.
    """
    mechanism = system.posture.mechanism
    points_by_body: dict[str, Array] = {}
    for name in legs_of(mechanism):
        leg = leg_of(mechanism.bodies[name])
        if isinstance(leg, LineLeg):
            points_by_body[name], _ = leg.line.frames(_SHARES * leg.line.length)
        else:
            points_by_body[name] = np.multiply.outer(_SHARES * leg.length, [1.0, 0.0, 0.0])
    for name in mechanism.parts:
        points_by_body[name] = _points_in_a_row(mechanism, name)
    frames = system.posture.frames
    points = [
        frames[n].position + local_points @ frames[n].rotation.T
        for n, local_points in points_by_body.items()
    ]
    motions = [
        displacements(system, name, local_points, unknowns)
        for name, local_points in points_by_body.items()
    ]
    return np.vstack(points), np.concatenate(motions)


def leg_outlines(system: System, displaced: Array) -> Wire:
    """Displaced outlines of leg sections, and displaced edges between the faces of CAD parts.

    The sections of straight legs lie at the points of `compared_points`, those of other legs along
    the leg's line. `displaced`: unknowns (n) of the system, enlarged by the factor of the drawing.
    """
    mechanism = system.posture.mechanism
    surfaces = {name: _part_surface(part) for name, part in mechanism.parts.items()}
    for name in legs_of(mechanism):
        leg = leg_of(mechanism.bodies[name])
        if isinstance(leg, LineLeg):
            surfaces[name] = line_surface(leg, scale=_OUTSET, rims=True)
            continue
        section, stations = equivalent_leg(leg).section, _SHARES * leg.length
        surfaces[name] = section_prism(section, stations, scale=_OUTSET, rims=True)
    frames = system.posture.frames
    outlines = joined(
        [surface.placed(frames[n].position, frames[n].rotation) for n, surface in surfaces.items()]
    )
    motion = np.vstack(
        [displacements(system, n, surface.points, displaced) for n, surface in surfaces.items()]
    )
    return Wire(outlines.points + motion, outlines.edges, LOOKS["segments"].colour, 2.5, motion)


def displacements(system: System, name: str, points: Array, unknowns: Array) -> Array:
    """Displacements (base axes) of points (n×3, body axes) of a leg or CAD part.

    Displacements are n×3 for a vector of `unknowns`, n×3×k for k columns.
    """
    model = system.models[name]
    if isinstance(model, LegMatrices) and model.line is None:
        # Legs that are equal up to round-off share a model, beyond whose end no point may lie.
        points = np.column_stack([np.clip(points[:, 0], 0.0, model.length), points[:, 1:]])
    local_motions = model.displacements(points) @ system.body_unknowns(
        name, unknowns.reshape(system.size, -1)
    )
    rotation = system.posture.frames[name].rotation
    motions = np.einsum("ij,njk->nik", rotation, local_motions.reshape(len(points), 3, -1))
    return np.asarray(motions.reshape((len(points), 3, *unknowns.shape[1:])))


def _part_surface(part: Body) -> Surface:
    """Surface of a CAD part's coarsest mesh in body axes, simplified to fewer faces."""
    mesh = coarsest_mesh(part)
    coarse = sum(len(facets.cells) for facets in mesh.faces.values()) < _COARSE_PIECES
    pieces = [
        facets.cells[:, _SUBTRIANGLES].reshape(-1, 3)
        if coarse and facets.element == "tri6"
        else facets.corners
        for facets in mesh.faces.values()
    ]
    surface = faceted(mesh.nodes, pieces)
    nodes = np.unique(surface.faces)
    faces, edges = (np.searchsorted(nodes, indices) for indices in (surface.faces, surface.edges))
    return Surface(mesh.nodes[nodes], faces, edges)


def _points_in_a_row(mechanism: Mechanism, part: str) -> Array:
    """Sample points (`COMPARED_POINTS`×3, body axes) of a CAD part near a line between interfaces.

    The line runs from the first interface to the last. For each of `COMPARED_POINTS` points on the
    line, the closest sample point is chosen. Every model provides the displacements of the sample
    points.
    """
    body = mechanism.parts[part]
    ends = [frame.position for frame in body.interfaces.values()]
    line = ends[0] + _SHARES[:, None] * (ends[-1] - ends[0])
    samples = identified(body).places
    distances = np.linalg.norm(line[:, None] - samples, axis=2)
    return np.asarray(samples[np.argmin(distances, axis=1)])
