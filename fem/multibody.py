"""Natural frequencies of a mechanism by EXUDYN, a multibody code, as an independent check.

The model consists of geometrically exact beams, rigid bodies and generic joints. Legs along a line
are chains of rigid bodies and springs. The model is unstrained in its posture. The frequencies are
those of EXUDYN's linearised equations (J. Gerstmayr, Multibody System Dynamics 60 (2024) 617).
EXUDYN is an optional extra and imported when it is used.
"""

from importlib.metadata import version
from itertools import pairwise
from math import ceil
from typing import Any, assert_never

import numpy as np

from fem.extras import missing_message
from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, LineLeg
from lumped.mechanism.body import Part, Rigid
from lumped.mechanism.free_twists import drive_in, free_twists, interface_position
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.models.bodies import leg_of
from lumped.screws import rotation_vector, skew, turn

# Singular value below which EXUDYN's projection on the joint constraints treats it as zero.
_TOLERANCE = 1e-6
# Number of spans of a leg along a line, without jumps, that have the requested number of elements.
# Each piece of a short span is then short enough for the second order.
_SPANS = 2


class ExudynMissing(Exception):  # noqa: N818  not an error: a comparison that cannot be made here
    """EXUDYN is not installed on this machine."""


def exudyn_version() -> str:
    """Version of EXUDYN. Raises ExudynMissing if it is not installed."""
    if message := missing_message("exudyn"):
        raise ExudynMissing(f"the comparison with EXUDYN {message}")
    return version("exudyn")


def require_beams(mechanism: Mechanism) -> None:
    """Raise InputError if the EXUDYN model does not support a property of the mechanism.

    The error contains one message per unsupported property.
    """
    faults = [
        f"{name}: the EXUDYN comparison needs a section; {name} is a {description}"
        for kind, description in (
            (GivenLeg, "leg specified by its 6×6 compliance"),
            (Part, "part"),
        )
        for name, body in mechanism.bodies.items()
        if isinstance(body.shape, kind)
    ]
    faults += [
        f"{name}: body without mass, which EXUDYN does not allow"
        for name, body in mechanism.bodies.items()
        if isinstance(body.shape, Rigid) and name != GROUND and not body.shape.mass
    ]
    faults += [
        (
            f"{name}: the EXUDYN comparison needs a section with two axes of symmetry, not a "
            f"{body.shape.section.shape}"
        )
        for name, body in mechanism.bodies.items()
        if isinstance(body.shape, ConstantLeg) and _is_coupled(body.shape)
    ]
    faults += [
        f"{joint.name}: the EXUDYN comparison does not support joints with a compliance"
        for joint in mechanism.joints
        if joint.compliance is not None
    ]
    faults += [
        f"{joint.name}: the EXUDYN comparison does not support rotors of drives"
        for joint in mechanism.joints
        if joint.drive is not None and joint.drive.inertia
    ]
    if faults:
        raise InputError(faults)


def _is_coupled(leg: ConstantLeg) -> bool:
    """True for a leg with coupled bending or torsion, several materials, or no section outline."""
    beam, section = leg.properties("euler-bernoulli"), leg.section
    outlined = section.has_outline and section.is_uniform
    return beam.couples_bending or beam.couples_torsion or not outlined


def frequencies(posture: Posture, elements: int, count: int) -> Array:
    """The lowest `count` natural frequencies (Hz) of a mechanism.

    They include a zero for each idle motion, which does not move the tool. `elements` is the number
    of beam elements per leg, or that of springs for each two spans of a leg along a line. Raises
    ExudynMissing if EXUDYN is not installed, and InputError as `require_beams` does.
    """
    exudyn_version()
    require_beams(posture.mechanism)
    system = _ExudynModel(posture, elements)
    system.mbs.Assemble()
    eigenvalues = system.mbs.ComputeODE2Eigenvalues(
        convert2Frequencies=True, singularValuesTolerance=_TOLERANCE
    )
    return np.sort(np.asarray(eigenvalues[0], dtype=float))[:count]


class _ExudynModel:
    def __init__(self, posture: Posture, elements: int) -> None:
        import exudyn  # noqa: PLC0415  an optional extra, and slow to import
        from exudyn import itemInterface  # noqa: PLC0415

        self.posture, self.elements = posture, elements
        self.items: Any = itemInterface
        container = exudyn.SystemContainer()
        # The container is stored because EXUDYN deletes the system together with it.
        self.container, self.mbs = container, container.AddSystem()
        self.section: Any = exudyn.BeamSection
        # For each interface: type of marker, body or node, position on it, and rotation of the
        # body.
        self.interfaces: dict[tuple[str, str], tuple[Any, dict[str, int], Array, Array]] = {}
        for name, body in posture.mechanism.bodies.items():
            if name == GROUND:
                ground = self.mbs.AddObject(self.items.ObjectGround())
                for point, frame in body.interfaces.items():
                    self._mark_body(ground, name, point, frame.position, np.eye(3))
            elif isinstance(body.shape, ConstantLeg):
                self._add_beam(name)
            elif isinstance(body.shape, LineLeg):
                self._add_line_leg(name, body.shape)
            elif isinstance(body.shape, Rigid):
                self._add_rigid(name, body.shape)
        self._add_tool()
        for joint in posture.mechanism.joints:
            self._add_joint(joint)

    def _node(self, position: Array, rotation: Array) -> int:
        vector = rotation_vector(rotation)
        node_item = self.items.NodeRigidBodyRotVecLG(referenceCoordinates=[*position, *vector])
        node: int = self.mbs.AddNode(node_item)
        return node

    def _mark_body(
        self, number: int, name: str, point: str, position: Array, rotation: Array
    ) -> None:
        carrier = {"bodyNumber": number}
        self.interfaces[name, point] = self.items.MarkerBodyRigid, carrier, position, rotation

    def marker(self, side: Side, axes: Array) -> int:
        """Add a marker at the interface `side`, with `axes` (3×3, columns) in base axes.

        Returns the number of the marker.
        """
        marker, carrier, position, rotation = self.interfaces[side.body, side.point]
        return self._aligned(marker, rotation.T @ axes, position, **carrier)

    def _aligned(self, marker: Any, axes: Array, position: Array, **carrier: int) -> int:
        """Add a marker at a `position` (3, in m) with `axes` (3×3), in axes of its carrier."""
        transform = np.eye(4)
        transform[:3, :3], transform[:3, 3] = axes, position
        number: int = self.mbs.AddMarker(marker(**carrier, localHT=transform))
        return number

    def _add_beam(self, name: str) -> None:
        body, frame = self.posture.mechanism.bodies[name], self.posture.frames[name]
        leg = equivalent_leg(leg_of(body))
        p = leg.timoshenko
        section = self.section()
        section.stiffnessMatrix = np.diag([p.EA, p.GAy, p.GAz, p.GJ, p.EIy, p.EIz])
        section.massPerLength = p.mu
        section.inertia = np.diag([p.rho_J, p.rho_Iy, p.rho_Iz])
        stations = np.linspace(0.0, leg.length, self.elements + 1)
        nodes = [
            self._node(frame.position + x * frame.rotation[:, 0], frame.rotation) for x in stations
        ]
        for pair in pairwise(nodes):
            self.mbs.AddObject(
                self.items.ObjectBeamGeometricallyExact(
                    nodeNumbers=list(pair),
                    length=leg.length / self.elements,
                    sectionData=section,
                )
            )
        for point, node in zip(body.interfaces, (nodes[0], nodes[-1]), strict=True):
            carrier = {"nodeNumber": node}
            marked = self.items.MarkerNodeRigid, carrier, np.zeros(3), frame.rotation
            self.interfaces[name, point] = marked

    def _add_line_leg(self, name: str, leg: LineLeg) -> None:
        """Chain of rigid bodies with the mass of the leg, joined by springs with its flexibility.

        EXUDYN's beams have no coupled stiffness, as of arcs and tapers. Each spring therefore has
        the flexibility of a piece of the line by the section in its middle. The bodies at its ends
        have half the mass of the piece each, whose centre may lie beside the line.
        """
        body, frame = self.posture.mechanism.bodies[name], self.posture.frames[name]
        sections = leg.sections("timoshenko")
        edges = sections.edges(self.elements * ceil(len(leg.spans) / _SPANS))
        middles, lengths = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
        field = sections.at(sections.span_at(middles), middles)
        halves = 0.5 * lengths[:, None, None] * field.mass
        masses = np.zeros((len(edges), 6, 6))
        masses[:-1] += halves
        masses[1:] += halves
        points, (_, axes) = leg.line.frames(edges)[0], leg.line.frames(middles)
        along = skew(np.array([1.0, 0.0, 0.0]))
        bodies = []
        for point, mass in zip(points, masses, strict=True):
            shape = _rigid_of_mass(mass)
            centre = point + shape.centre
            placed = frame.position + frame.rotation @ centre
            bodies.append((self._rigid(placed, frame.rotation, shape), centre))
        for point, end in zip(body.interfaces, (0, -1), strict=True):
            number, centre = bodies[end]
            self._mark_body(number, name, point, points[end] - centre, frame.rotation)
        for middle, length, section_axes, flexibility, pair in zip(
            field.points, lengths, axes, field.flexibility, pairwise(bodies), strict=True
        ):
            to_axes = turn(section_axes)
            compliance = length * to_axes.T @ flexibility @ to_axes
            # A piece bends by its shear force, too, even if it is rigid in shear.
            compliance[:3, :3] += length**2 / 12.0 * along @ compliance[3:, 3:] @ along.T
            markers = [
                self._aligned(
                    self.items.MarkerBodyRigid, section_axes, middle - centre, bodyNumber=number
                )
                for number, centre in pair
            ]
            self.mbs.AddObject(
                self.items.ObjectConnectorRigidBodySpringDamper(
                    markerNumbers=markers,
                    stiffness=np.linalg.inv(compliance),
                )
            )

    def _add_rigid(self, name: str, shape: Rigid) -> None:
        frame = self.posture.frames[name]
        number = self._rigid(frame.position + frame.rotation @ shape.centre, frame.rotation, shape)
        for point, interface in self.posture.mechanism.bodies[name].interfaces.items():
            self._mark_body(number, name, point, interface.position - shape.centre, frame.rotation)

    def _rigid(self, centre: Array, rotation: Array, shape: Rigid) -> int:
        J = shape.inertia
        number: int = self.mbs.AddObject(
            self.items.ObjectRigidBody(
                mass=shape.mass,
                inertia=[J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 2], J[0, 1]],
                nodeNumber=self._node(centre, rotation),
            )
        )
        return number

    def _add_tool(self) -> None:
        tool = self.posture.mechanism.tool
        if not tool.mass:
            return
        side = Side(tool.body, tool.point)
        load = self._rigid(interface_position(self.posture, side), np.eye(3), Rigid(tool.mass))
        mass_marker = self.items.MarkerBodyRigid(bodyNumber=load, localPosition=np.zeros(3))
        markers = [self.marker(side, np.eye(3)), self.mbs.AddMarker(mass_marker)]
        self.mbs.AddObject(self.items.GenericJoint(markerNumbers=markers))

    def _add_joint(self, joint: Joint) -> None:
        free = free_twists(self.posture, joint)
        axes, constrained, driven = _joint_axes(joint, free)
        if joint.drive is not None and joint.drive.stiffness is None:
            constrained[driven] = 1
        markers = [self.marker(side, axes) for side in (joint.first, joint.second)]
        self.mbs.AddObject(
            self.items.GenericJoint(markerNumbers=markers, constrainedAxes=constrained)
        )
        drive = drive_in(self.posture, joint)
        if drive is not None and drive.stiffness is not None:
            stiffness, offset = np.zeros((6, 6)), np.zeros(6)
            stiffness[driven, driven] = drive.stiffness
            gap = interface_position(self.posture, joint.second) - interface_position(
                self.posture, joint.first
            )
            offset[:3] = axes.T @ gap
            self.mbs.AddObject(
                self.items.ObjectConnectorRigidBodySpringDamper(
                    markerNumbers=markers, stiffness=stiffness, offset=list(offset)
                )
            )


def _rigid_of_mass(mass: Array) -> Rigid:
    """Rigid body with a mass matrix (6×6) about a point, from which its centre is given."""
    total = float(mass[0, 0])
    first = mass[3:, :3] / total
    centre = np.array([first[2, 1], first[0, 2], first[1, 0]])
    return Rigid(total, centre, mass[3:, 3:] + total * skew(centre) @ skew(centre))


def _joint_axes(joint: Joint, free: Array) -> tuple[Array, list[int], int]:
    """Axes (3×3, columns) of a joint, flags of constrained components, and the driven component.

    `free` (6×r) are the joint's free twists. The six flags (x y z φx φy φz, in the axes of the
    joint) are 1 for a constrained component, otherwise 0. The driven component is an index from 0
    to 5.
    """
    match joint.kind:
        case "fixed":
            return np.eye(3), [1, 1, 1, 1, 1, 1], 0
        case "spherical":
            return np.eye(3), [1, 1, 1, 0, 0, 0], 3
        case "universal":
            first, second = free[3:, 0], free[3:, 1]
            return _with_x(first, np.cross(first, second)), [1, 1, 1, 0, 0, 1], 3
        case "planar":
            return np.column_stack([free[:3, 0], free[:3, 1], free[3:, 2]]), [0, 0, 1, 1, 1, 0], 5
        case "revolute":
            return _with_x(free[3:, 0]), [1, 1, 1, 0, 1, 1], 3
        case "prismatic" | "cylindrical":
            about = int(joint.kind == "prismatic")
            return _with_x(free[:3, 0]), [0, 1, 1, about, 1, 1], 0
        case _:
            assert_never(joint.kind)


def _with_x(x: Array, across: Array | None = None) -> Array:
    """Axes (3×3, columns) whose x axis is `x` (3).

    The z axis has the direction of `across` (3), which is normal to x. If `across` is None, it is
    any direction normal to x.
    """
    z = np.cross(x, np.eye(3)[np.argmin(np.abs(x))]) if across is None else across
    z = z / np.linalg.norm(z)
    return np.column_stack([x, np.cross(z, x), z])
