"""Bodies and joints of a mechanism as surfaces that go where its unknowns say."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.legs import equivalent_leg
from lumped.mechanism.body import Rigid
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism
from lumped.models.bodies import leg_of, legs_of
from lumped.system.assembly import System
from meshes.part.boundary import Facets
from validation.drawing.rendering import DARK, GREY, Body, Wire
from validation.drawing.style import LOOKS, ORANGE
from validation.drawing.surfaces import (
    Surface,
    edges,
    end_faces,
    frames,
    prism_faces,
    prism_points,
)
from validation.kinematics.solids import Face, body_faces, joint_faces, on_ground, outlines
from validation.models.parts import coarsest_mesh, identified

_STATIONS = 15
# Places along a leg where another model's outlines are drawn over it, slightly larger.
COMPARED = 6
_OUTSET = 1.06
# Pieces of a part's surface below which arcs would be seen as polygons; more fill the page.
_FEW = 1500
# Corners, then the middles of sides, as the triangles between them.
_IN_FOUR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
# Radius of a joint's symbol, of the size of the mechanism; a drum is longer than the thinner of the
# legs that it joins is thick.
_SYMBOL, _THROUGH = 0.04, 1.12


@dataclass(frozen=True, eq=False)
class Moved:
    """Points (n×3, m, base axes) at rest and their displacements (n×3), with faces and edges.

    `deformable`: a leg, whose displacements colour it.
    """

    points: Array
    displacements: Array
    faces: IntArray
    pairs: IntArray
    colour: str = GREY
    deformable: bool = False

    @property
    def sizes(self) -> Array:
        """Length of each point's displacement (n)."""
        return np.asarray(np.linalg.norm(self.displacements, axis=1))

    def body(self, factor: float, unit: float) -> Body:
        """Drawn with `factor` times its displacements; a leg coloured by their length in `unit`."""
        motion = factor * self.displacements
        values = self.sizes / unit if self.deformable else None
        return Body(Surface(self.points + motion, self.faces, values, motion), self.colour)

    def wire(self) -> Wire:
        """Its edges at rest."""
        return Wire(self.points, self.pairs, colour="#8a8f98")


def elastic(system: System, unknowns: Array) -> list[Moved]:
    """Legs and CAD parts, displaced by the unknowns (n) of the system."""
    return [*legs(system, unknowns), *parts(system, unknowns)]


def parts(system: System, unknowns: Array) -> list[Moved]:
    """CAD parts by the surface of their coarsest mesh, with the edges between their faces."""
    found = []
    for name, body in system.posture.mechanism.parts.items():
        mesh = coarsest_mesh(body)
        few = sum(len(facets.cells) for facets in mesh.faces.values()) < _FEW
        pieces = [_flat(facets, few=few) for facets in mesh.faces.values()]
        nodes = np.unique(np.concatenate(pieces))
        found.append(
            Moved(
                *_of_body(system, name, mesh.nodes[nodes], unknowns),
                faces=np.searchsorted(nodes, np.concatenate(pieces)),
                pairs=np.searchsorted(nodes, np.concatenate([_rim(piece) for piece in pieces])),
                deformable=True,
            )
        )
    return found


def legs(system: System, unknowns: Array) -> list[Moved]:
    """Legs with their true sections, displaced by the unknowns (n) of the system."""
    found = []
    for name in legs_of(system.posture.mechanism):
        leg = equivalent_leg(leg_of(system.posture.mechanism.bodies[name]))
        corners, bores = outlines(leg.section)
        stations = np.linspace(0.0, _length(system, name), _STATIONS)
        points = prism_points(corners, stations)
        count, sides = len(corners), prism_faces(len(corners), _STATIONS)
        if bores:
            rims = prism_points(bores[0], stations[[0, -1]])
            caps = _rings(count, len(points))
            points = np.vstack([points, rims])
        else:
            caps = end_faces(count, _STATIONS)
        found.append(
            Moved(
                *_of_body(system, name, points, unknowns),
                faces=np.vstack([sides, caps]),
                pairs=edges(count, _STATIONS),
                deformable=True,
            )
        )
    return found


def surroundings(system: System, unknowns: Array) -> list[Moved]:
    """Rigid bodies, joints and what carries them, moved along."""
    posture = system.posture
    mechanism = posture.mechanism
    radius = _SYMBOL * mechanism.size
    found = [
        _carried(system, Side(name, next(iter(body.interfaces))), faces, unknowns, GREY)
        for name, body in mechanism.bodies.items()
        if isinstance(body.shape, Rigid) and name != GROUND
        for faces in [tuple(body_faces(posture, name, mechanism.size))]
        if faces
    ]
    for joint in mechanism.joints:
        reach = _THROUGH * _thinner(mechanism, joint)
        faces = tuple(joint_faces(posture, joint, radius, reach))
        if faces:
            colour = ORANGE if joint.drive else DARK
            found.append(_carried(system, _symbol_at(joint), faces, unknowns, colour))
    return found


def rails(system: System) -> Iterator[Wire]:
    """Along ground, from where a joint stands in the reference posture to where it has slid."""
    for joint in system.posture.mechanism.joints:
        if on_ground(joint):
            ends = [interface_position(system.posture, one) for one in (joint.first, joint.second)]
            yield Wire(np.array(ends), np.array([[0, 1]]), DARK, 3.0)


def compared_points(system: System, unknowns: Array, count: int = COMPARED) -> tuple[Array, Array]:
    """`count` places of each leg and part (m, base axes), their displacements.

    On the centreline of legs, in a row from the first interface of a part to its last one.

    `unknowns` n or n×k, displacements m×3 or m×3×k.
    """
    points, moved = [], []
    own: dict[str, Array] = {}
    for name in legs_of(system.posture.mechanism):
        straight = np.zeros((count, 3))
        straight[:, 0] = (np.arange(count) + 0.5) * _length(system, name) / count
        own[name] = straight
    for name in system.posture.mechanism.parts:
        own[name] = _in_a_row(system.posture.mechanism, name, count)
    for name, within in own.items():
        places, displacements = _of_body(system, name, within, unknowns)
        points.append(places)
        moved.append(displacements)
    return np.vstack(points), np.concatenate(moved)


def outlines_of(system: System, displaced: Array, count: int = COMPARED) -> Wire:
    """Outlines of the legs at as many places, `displaced` (n, times the factor drawn) moved.

    Of parts the edges between their faces.
    """
    points, motions, pairs, begun = [], [], [], 0
    for name in legs_of(system.posture.mechanism):
        leg = equivalent_leg(leg_of(system.posture.mechanism.bodies[name]))
        corners = _OUTSET * outlines(leg.section)[0]
        stations = (np.arange(count) + 0.5) * _length(system, name) / count
        places, moved = _of_body(system, name, prism_points(corners, stations), displaced)
        points.append(places + moved)
        motions.append(moved)
        pairs.append(frames(len(corners), count) + begun)
        begun += len(places)
    for part in parts(system, displaced):
        points.append(part.points + part.displacements)
        motions.append(part.displacements)
        pairs.append(part.pairs + begun)
        begun += len(part.points)
    colour = LOOKS["segments"].colour
    return Wire(np.vstack(points), np.vstack(pairs), colour, 2.5, np.vstack(motions))


def _in_a_row(mechanism: Mechanism, part: str, count: int) -> Array:
    """Places (`count`×3, body axes) of a part next to a line from its first interface on.

    To its last one; places where its displacements are known whatever the model.
    """
    body = mechanism.parts[part]
    ends = [frame.position for frame in body.interfaces.values()]
    shares = (np.arange(count) + 0.5)[:, None] / count
    line = ends[0] + shares * (ends[-1] - ends[0])
    places = identified(body).places
    away = np.linalg.norm(line[:, None] - places, axis=2)
    return np.asarray(places[np.argmin(away, axis=1)])


def _flat(facets: Facets, *, few: bool) -> IntArray:
    """Flat polygons (f×c) of the pieces of a face; curved triangles in four where they are few."""
    if few and facets.element == "tri6":
        return np.asarray(facets.cells[:, _IN_FOUR].reshape(-1, 3))
    return facets.corners


def _rim(corners: IntArray) -> IntArray:
    """Edges (e×2) of the facets (f×c) of a face that one of them alone has."""
    sides = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    edges_of, counts = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    return np.asarray(edges_of[counts == 1])


def _length(system: System, name: str) -> float:
    """Length (m) of a leg as its model has it, which legs alike but for rounding share."""
    model = system.models[name]
    if isinstance(model, LegMatrices):
        return model.length
    return leg_of(system.posture.mechanism.bodies[name]).length


def _of_body(system: System, name: str, points: Array, unknowns: Array) -> tuple[Array, Array]:
    """Places (base axes) of points of a body (n×3, body axes) and their displacements."""
    frame = system.posture.frames[name]
    columns = unknowns.reshape(system.size, -1)
    own = system.models[name].displacements(points) @ system.own(name, columns)
    moved = np.einsum("ij,njk->nik", frame.rotation, own.reshape(len(points), 3, -1))
    shaped = moved.reshape((len(points), 3, *unknowns.shape[1:]))
    return frame.position + points @ frame.rotation.T, shaped


def _carried(
    system: System, side: Side, faces: Iterable[Face], unknowns: Array, colour: str
) -> Moved:
    """Polygons that move with an interface, as triangles."""
    points, triangles, begun = [], [], 0
    pairs = []
    for face in faces:
        count = len(face.corners)
        points.append(face.corners)
        triangles += [(begun, begun + i, begun + j) for i, j in pairwise(range(1, count))]
        pairs += [(begun + i, begun + (i + 1) % count) for i in range(count)]
        begun += count
    corners = np.vstack(points)
    place = interface_position(system.posture, side)
    twist = system.motions.at(side.body, side.point, place) @ unknowns[: system.outer]
    moved = twist[:3] + np.cross(twist[3:], corners - place)
    return Moved(corners, moved, np.array(triangles), np.array(pairs), colour)


def _symbol_at(joint: Joint) -> Side:
    return joint.second if on_ground(joint) else joint.first


def _thinner(mechanism: Mechanism, joint: Joint) -> float:
    """Extent (m) of the thinner of the legs that meet in a joint, 0 where there is none."""
    known = legs_of(mechanism)
    names = [side.body for side in (joint.first, joint.second) if side.body in known]
    return min((max(equivalent_leg(known[name]).section.extent) for name in names), default=0.0)


def _rings(count: int, first: int) -> IntArray:
    """Quadrangles between the outer rim and the bore's at both ends; bores start at `first`."""
    ring = np.arange(count)
    following = np.roll(ring, -1)
    tip = (_STATIONS - 1) * count
    near = np.column_stack([following, ring, first + ring, first + following])
    far = np.column_stack([ring, following, count + following + first, count + ring + first])
    far[:, :2] += tip
    return np.vstack([near, far])
