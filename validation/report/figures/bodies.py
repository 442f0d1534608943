"""Bodies and joints of a mechanism as surfaces that go where its unknowns say."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.mechanism.body import Body
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import leg_of, legs_of
from lumped.system.assembly import System
from validation.drawing.scene import DARK, DrawnBody, Wire
from validation.drawing.style import LOOKS
from validation.drawing.surfaces import Surface, faceted, joined
from validation.kinematics.solids import COLOURS, Solid, on_ground, section_prism, solids
from validation.models.parts import coarsest_mesh, identified

# Places along a leg where another model's outlines are drawn over it, slightly larger.
COMPARED = 6
_SHARES = (np.arange(COMPARED) + 0.5) / COMPARED
_OUTSET = 1.06
# Pieces of a part's surface below which arcs would be seen as polygons; more fill the page.
_FEW = 1500
# Corners, then the middles of sides, as the triangles between them.
_IN_FOUR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])


@dataclass(frozen=True, eq=False)
class Moved:
    """What is drawn of a body or joint, at rest, with the displacements (n×3, m) of its points."""

    solid: Solid
    displacements: Array

    @property
    def deforms(self) -> bool:
        """Whether it is a leg or part, whose displacements colour it."""
        return self.solid.carrier is None

    @property
    def sizes(self) -> Array:
        """Length of each point's displacement (n)."""
        return np.asarray(np.linalg.norm(self.displacements, axis=1))

    def body(self, factor: float, unit: float) -> DrawnBody:
        """Drawn with `factor` times its displacements; a leg coloured by their length in `unit`."""
        motion = factor * self.displacements
        values = self.sizes / unit if self.deforms else None
        return DrawnBody(
            self.solid.surface.moved(motion), COLOURS[self.solid.matter], values, motion
        )

    def wire(self) -> Wire:
        """Its edges at rest."""
        return Wire(self.solid.surface.points, self.solid.surface.edges, colour="#8a8f98")


def moved(system: System, unknowns: Array) -> list[Moved]:
    """Bodies and joints, displaced by the unknowns (n) of the system."""
    return [_moved(system, solid, unknowns) for solid in solids(system.posture)]


def _moved(system: System, solid: Solid, unknowns: Array) -> Moved:
    if solid.carrier is None:
        part = system.posture.mechanism.parts.get(solid.name)
        frame = system.posture.frames[solid.name]
        if part:
            own = _of_mesh(part)
            shown = replace(solid, surface=own.placed(frame.position, frame.rotation))
            return Moved(shown, displacements(system, solid.name, own.points, unknowns))
        within = (solid.surface.points - frame.position) @ frame.rotation
        return Moved(solid, displacements(system, solid.name, within, unknowns))
    place = interface_position(system.posture, solid.carrier)
    motion = system.motions.at(solid.carrier.body, solid.carrier.point, place)
    twist = motion @ unknowns[: system.outer]
    return Moved(solid, twist[:3] + np.cross(twist[3:], solid.surface.points - place))


def rails(system: System) -> Iterator[Wire]:
    """Along ground, from where a joint stands in the reference posture to where it has slid."""
    for joint in system.posture.mechanism.joints:
        if on_ground(joint):
            ends = [interface_position(system.posture, one) for one in (joint.first, joint.second)]
            yield Wire(np.array(ends), np.array([[0, 1]]), DARK, 3.0)


def compared_points(system: System, unknowns: Array) -> tuple[Array, Array]:
    """`COMPARED` places of each leg and part (m, base axes), their displacements.

    On the centreline of legs, in a row from the first interface of a part to its last one.

    `unknowns` n or n×k, displacements m×3 or m×3×k.
    """
    mechanism = system.posture.mechanism
    own: dict[str, Array] = {}
    for name in legs_of(mechanism):
        own[name] = np.zeros((COMPARED, 3))
        own[name][:, 0] = _SHARES * leg_of(mechanism.bodies[name]).length
    for name in mechanism.parts:
        own[name] = _in_a_row(mechanism, name)
    frames = system.posture.frames
    points = [frames[n].position + within @ frames[n].rotation.T for n, within in own.items()]
    moves = [displacements(system, name, within, unknowns) for name, within in own.items()]
    return np.vstack(points), np.concatenate(moves)


def outlines_of(system: System, displaced: Array) -> Wire:
    """Outlines of the legs at as many places, `displaced` (n, times the factor drawn) moved.

    Of parts the edges between their faces.
    """
    mechanism = system.posture.mechanism
    own = {name: _of_mesh(part) for name, part in mechanism.parts.items()}
    for name in legs_of(mechanism):
        leg = leg_of(mechanism.bodies[name])
        section, stations = equivalent_leg(leg).section, _SHARES * leg.length
        own[name] = section_prism(section, stations, scale=_OUTSET, rims=True)
    frames = system.posture.frames
    whole = joined([one.placed(frames[n].position, frames[n].rotation) for n, one in own.items()])
    motion = np.vstack([displacements(system, n, one.points, displaced) for n, one in own.items()])
    return Wire(whole.points + motion, whole.edges, LOOKS["segments"].colour, 2.5, motion)


def displacements(system: System, name: str, points: Array, unknowns: Array) -> Array:
    """Displacements (base axes) of points of a leg or part (n×3, body axes).

    `unknowns` n or n×k, displacements n×3 or n×3×k.
    """
    model = system.models[name]
    if isinstance(model, LegMatrices):
        # Legs alike but for rounding share a model, of which no point may lie beyond its end.
        points = np.column_stack([np.clip(points[:, 0], 0.0, model.length), points[:, 1:]])
    own = model.displacements(points) @ system.body_unknowns(
        name, unknowns.reshape(system.size, -1)
    )
    rotation = system.posture.frames[name].rotation
    found = np.einsum("ij,njk->nik", rotation, own.reshape(len(points), 3, -1))
    return np.asarray(found.reshape((len(points), 3, *unknowns.shape[1:])))


def _of_mesh(part: Body) -> Surface:
    """The surface of a part's coarsest mesh, smaller than that of its file, body axes."""
    mesh = coarsest_mesh(part)
    few = sum(len(facets.cells) for facets in mesh.faces.values()) < _FEW
    pieces = [
        facets.cells[:, _IN_FOUR].reshape(-1, 3)
        if few and facets.element == "tri6"
        else facets.corners
        for facets in mesh.faces.values()
    ]
    whole = faceted(mesh.nodes, pieces)
    nodes = np.unique(whole.faces)
    faces, edges = (np.searchsorted(nodes, one) for one in (whole.faces, whole.edges))
    return Surface(mesh.nodes[nodes], faces, edges)


def _in_a_row(mechanism: Mechanism, part: str) -> Array:
    """Places (`COMPARED`×3, body axes) of a part next to a line from its first interface on.

    To its last one; places where its displacements are known whatever the model.
    """
    body = mechanism.parts[part]
    ends = [frame.position for frame in body.interfaces.values()]
    line = ends[0] + _SHARES[:, None] * (ends[-1] - ends[0])
    places = identified(body).places
    away = np.linalg.norm(line[:, None] - places, axis=2)
    return np.asarray(places[np.argmin(away, axis=1)])
