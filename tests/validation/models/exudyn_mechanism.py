"""A mechanism in EXUDYN: geometrically exact beams, rigid bodies, generic joints, springs.

The model stands in its posture without strain; its own linearisation gives the frequencies.
"""

from itertools import pairwise

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    GenericJoint,
    MarkerBodyRigid,
    MarkerNodeRigid,
    NodeRigidBodyRotVecLG,
    ObjectBeamGeometricallyExact,
    ObjectConnectorRigidBodySpringDamper,
    ObjectGround,
    ObjectRigidBody,
)
from scipy.spatial.transform import Rotation

from lumped.mechanism.body import Prism, Rigid
from lumped.mechanism.free_twists import free_twists, interface_position
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.mechanism import GROUND, Posture
from lumped.models.bodies import leg_of

# Its projection on the joints takes singular values below this one for none.
TOLERANCE = 1e-6


def frequencies(posture: Posture, elements: int, count: int) -> np.ndarray:
    """The lowest `count` frequencies (Hz), idle ones included, `elements` beams a leg."""
    system = _System(posture, elements)
    system.mbs.Assemble()
    found = system.mbs.ComputeODE2Eigenvalues(
        convert2Frequencies=True, singularValuesTolerance=TOLERANCE
    )
    return np.sort(np.asarray(found[0]))[:count]


class _System:
    def __init__(self, posture: Posture, elements: int) -> None:
        self.posture, self.elements = posture, elements
        container = exu.SystemContainer()
        self.container, self.mbs = container, container.AddSystem()
        # Marker and rotation of what carries each interface.
        self.markers: dict[tuple[str, str], tuple[int, np.ndarray]] = {}
        for name, body in posture.mechanism.bodies.items():
            if name == GROUND:
                ground = self.mbs.AddObject(ObjectGround())
                for point, frame in body.interfaces.items():
                    self._mark_body(ground, name, point, frame.position, np.eye(3))
            elif isinstance(body.shape, Prism):
                self._add_beam(name)
            else:
                self._add_rigid(name, body.shape)
        self._add_tool()
        for joint in posture.mechanism.joints:
            self._add_joint(joint)

    def _node(self, position: np.ndarray, rotation: np.ndarray) -> int:
        vector = Rotation.from_matrix(rotation).as_rotvec()
        return self.mbs.AddNode(NodeRigidBodyRotVecLG(referenceCoordinates=[*position, *vector]))

    def _mark_body(self, number, name, point, position, rotation) -> None:
        marker = self.mbs.AddMarker(MarkerBodyRigid(bodyNumber=number, localPosition=position))
        self.markers[name, point] = marker, rotation

    def _add_beam(self, name: str) -> None:
        body, frame = self.posture.mechanism.bodies[name], self.posture.frames[name]
        leg = leg_of(body)
        p = leg.timoshenko
        section = exu.BeamSection()
        section.stiffnessMatrix = np.diag([p.EA, p.GAy, p.GAz, p.GJ, p.EIy, p.EIz])
        section.massPerLength = p.mu
        section.inertia = np.diag([p.rho_J, p.rho_Iy, p.rho_Iz])
        stations = np.linspace(0.0, leg.length, self.elements + 1)
        nodes = [
            self._node(frame.position + x * frame.rotation[:, 0], frame.rotation) for x in stations
        ]
        for pair in pairwise(nodes):
            self.mbs.AddObject(
                ObjectBeamGeometricallyExact(
                    nodeNumbers=list(pair),
                    length=leg.length / self.elements,
                    sectionData=section,
                )
            )
        for point, node in zip(body.interfaces, (nodes[0], nodes[-1]), strict=True):
            marker = self.mbs.AddMarker(MarkerNodeRigid(nodeNumber=node))
            self.markers[name, point] = marker, frame.rotation

    def _add_rigid(self, name: str, shape: Rigid) -> None:
        frame = self.posture.frames[name]
        number = self._rigid(frame.position + frame.rotation @ shape.centre, frame.rotation, shape)
        for point, place in self.posture.mechanism.bodies[name].interfaces.items():
            self._mark_body(number, name, point, place.position - shape.centre, frame.rotation)

    def _rigid(self, centre: np.ndarray, rotation: np.ndarray, shape: Rigid) -> int:
        J = shape.inertia
        return self.mbs.AddObject(
            ObjectRigidBody(
                mass=shape.mass,
                inertia=[J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 2], J[0, 1]],
                nodeNumber=self._node(centre, rotation),
            )
        )

    def _add_tool(self) -> None:
        tool = self.posture.mechanism.tool
        if not tool.mass:
            return
        at = interface_position(self.posture, Side(tool.body, tool.point))
        load = self._rigid(at, np.eye(3), Rigid(tool.mass))
        mine = self.mbs.AddMarker(MarkerBodyRigid(bodyNumber=load, localPosition=np.zeros(3)))
        marker, rotation = self.markers[tool.body, tool.point]
        self.mbs.AddObject(GenericJoint(markerNumbers=[marker, mine], rotationMarker0=rotation.T))

    def _add_joint(self, joint: Joint) -> None:
        assert joint.compliance is None, "rigid joints alone"
        marker0, rotation0 = self.markers[joint.first.body, joint.first.point]
        marker1, rotation1 = self.markers[joint.second.body, joint.second.point]
        free = free_twists(self.posture, joint)
        axes, constrained, driven = _joint_axes(joint, free)
        if joint.drive is not None and joint.drive.stiffness is None:
            constrained[driven] = 1
        frames = {
            "markerNumbers": [marker0, marker1],
            "rotationMarker0": rotation0.T @ axes,
            "rotationMarker1": rotation1.T @ axes,
        }
        self.mbs.AddObject(GenericJoint(constrainedAxes=constrained, **frames))
        if joint.drive is not None and joint.drive.stiffness is not None:
            stiffness, offset = np.zeros((6, 6)), np.zeros(6)
            stiffness[driven, driven] = joint.drive.stiffness
            gap = interface_position(self.posture, joint.second) - interface_position(
                self.posture, joint.first
            )
            offset[:3] = axes.T @ gap
            self.mbs.AddObject(
                ObjectConnectorRigidBodySpringDamper(
                    stiffness=stiffness, offset=list(offset), **frames
                )
            )


def _joint_axes(joint: Joint, free: np.ndarray) -> tuple[np.ndarray, list[int], int]:
    """Axes of the joint (columns, base axes), what it holds along and about them, its drive."""
    held = [1, 1, 1, 1, 1, 1]
    if joint.kind == "fixed":
        return np.eye(3), held, 0
    if joint.kind == "spherical":
        return np.eye(3), [1, 1, 1, 0, 0, 0], 3
    if joint.kind == "universal":
        first, second = free[3:, 0], free[3:, 1]
        normal = np.cross(first, second)
        return _with_x(first, normal), [1, 1, 1, 0, 0, 1], 3
    axis = free[:3, 0] if joint.kind in ("prismatic", "cylindrical") else free[3:, 0]
    if joint.kind in ("prismatic", "cylindrical"):
        held[0] = 0
    if joint.kind in ("revolute", "cylindrical"):
        held[3] = 0
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    return _with_x(axis, across), held, 3 if joint.kind == "revolute" else 0


def _with_x(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    z = z / np.linalg.norm(z)
    return np.column_stack([x, np.cross(z, x), z])
