"""Mistakes in parts: their files, faces and edges, how they are held, transports, weights."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csr_array, eye_array

from fem.bodies.part import MassProperties
from lumped.arrays import Array, SparseMatrix
from lumped.legs import Material
from lumped.screws import shift
from meshes.part.interfaces import Interface
from meshes.part.part_mesh import PartMesh
from validation.faults.fault import Faulty, fault, fault_around, fault_in_value

# Corners at the ends of the edges of a second-order tetrahedron, in the order of their middles.
_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))


@fault_in_value(
    "part.unit", "Parts: millimetres read as centimetres", "meshes.part.reading.units.chosen_unit"
)
def _ten_times(unit: str) -> str:
    return "cm" if unit == "mm" else unit


@fault_around(
    "part.wrong-bore",
    "Parts: the bore of that radius that is farthest from the point",
    "meshes.part.interfaces._on_cylinder",
)
def _farthest(sound: Faulty, faces: Sequence[Any], wanted: Any, place: Array | None) -> Any:
    centre = np.mean([face.centre for face in faces], axis=0)
    through = 2.0 * centre - np.array(wanted.point if wanted.point is not None else place)
    fitting = [f for f in faces if f.kind == "bore" and np.isclose(f.radius, wanted.radius)]
    if not fitting:
        return sound(faces, wanted, place)
    nearest = min(fitting, key=lambda f: float(np.linalg.norm(f.centre - through)))
    return [nearest]


@fault_around(
    "part.one-face", "Parts: the first of an interface's faces alone", "fem.bodies.part.grips_of"
)
def _first_face(
    sound: Faulty, mesh: PartMesh, interfaces: Sequence[Interface], *coupling: Any
) -> Any:
    return sound(mesh, [replace(i, faces=i.faces[:1]) for i in interfaces], *coupling)


@fault_around(
    "part.interface-dropped", "Parts: the last interface left free", "fem.bodies.part.grips_of"
)
def _dropped(sound: Faulty, mesh: PartMesh, interfaces: Sequence[Interface], *coupling: Any) -> Any:
    return sound(mesh, interfaces[:-1] if len(interfaces) > 2 else interfaces, *coupling)


@fault_around("part.all-rigid", "Parts: every interface held rigidly", "fem.bodies.part.grips_of")
def _all_rigid(
    sound: Faulty, mesh: PartMesh, interfaces: Sequence[Interface], *_coupling: Any
) -> Any:
    return sound(mesh, interfaces, "rigid")


@fault_around(
    "part.point",
    "Parts: an interface's point in the middle of its nodes",
    "fem.bodies.part.grips_of",
)
def _in_the_middle(sound: Faulty, mesh: PartMesh, *rest: Any) -> Any:
    grips: Sequence[Any] = sound(mesh, *rest)
    return tuple(replace(one, point=mesh.nodes[one.nodes].mean(axis=0)) for one in grips)


@fault(
    "part.transport-sign",
    "Parts: arms between interfaces with the wrong sign",
    "fem.bodies.rooted.RootedBody.relative",
)
def _other_way(self: Any) -> Array:
    points = self.solid.points
    X = np.vstack([shift(points[0] - point) for point in points[1:]])
    return np.hstack([-X, np.eye(len(X))])


@fault_around(
    "part.twist-transport",
    "Parts: wrenches taken at the first interface's point",
    "fem.couplings.coupled_solid._Numbering.twist",
)
def _at_the_first(sound: Faulty, self: Any, which: int, motions: Array) -> Any:
    found: Array = sound(self, which, motions)
    return found @ shift(self.grips[0].point - self.grips[which].point)


@fault_in_value(
    "part.equal-weights",
    "Parts: averages over nodes, not over areas",
    "fem.couplings.grips.area_weights",
)
def _equal(weights: SparseMatrix) -> SparseMatrix:
    size = weights.shape[0]
    return csr_array(float(weights.sum()) / size * eye_array(size))


@fault_around(
    "part.straight-edges",
    "Parts: edges of elements straight where the surface is curved",
    "fem.bodies.part.meshed_part",
)
def _straight(sound: Faulty, mesh: PartMesh, material: Material) -> Any:
    places = mesh.nodes.copy()
    for middle, (first, second) in enumerate(_EDGES, start=4):
        ends = mesh.nodes[mesh.cells[:, first]], mesh.nodes[mesh.cells[:, second]]
        places[mesh.cells[:, middle]] = (ends[0] + ends[1]) / 2.0
    return sound(replace(mesh, nodes=places), material)


@fault_in_value(
    "part.inertia-at-origin",
    "Parts: inertia about the origin of the file",
    "fem.bodies.part.MeshedPart.properties",
)
def _about_origin(found: MassProperties) -> MassProperties:
    c = found.centre
    steiner = found.mass * (c @ c * np.eye(3) - np.outer(c, c))
    return replace(found, inertia=found.inertia + steiner)


@fault_around(
    "part.pin-about-point",
    "Parts: a pin's radii from its point, not from its axis",
    "fem.couplings.grips.Grip.local_axes",
)
def _from_the_point(sound: Faulty, self: Any, nodes: Array) -> Any:
    return sound(replace(self, on_axis=self.point), nodes)
