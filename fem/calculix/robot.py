"""The whole robot with solid legs solved by CalculiX: the independent judge of the assembly.

Rigid end faces, revolute joints and the platform are linear equations that share freedoms: both
faces at B have the platform's translation and its rotations about x and y, and a φz each. Feet are
rigid: of a root only φz is free. The legs' material axes turn with them.
"""

import numpy as np

from fem.bodies.solid import SolidLeg
from fem.calculix.deck import Deck, Freedom, NodalForce, Part, PointMass, rigid_face
from fem.calculix.run import run_calculix
from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.errors import InputError
from lumped.screws import shift

# Nodes beside those of the legs, after which they are numbered: what moves, and where a rotation
# is kept as the displacement of a node of its own.
_EXTRA = (
    "B",
    "platform's rotation",
    "leg 2's rotation at B",
    "A",
    "leg 1's rotation at A",
    "C",
    "leg 2's rotation at C",
    "P",
)


def robot_deck(robot: Biglide, x: float, legs: tuple[SolidLeg, SolidLeg], modes: int) -> Deck:
    """The robot with B at `x` (m), six unit wrenches at P, then its modes; robot axes.

    `legs` are the solids of leg 1 and leg 2 in their own axes; their stiffness and mass matrices
    are not used. Watched are B and the node of the platform's rotation. Raises InputError outside
    the stroke and for a robot with elastic feet or tool, which this deck does not have.
    """
    if robot.foot_compliance is not None or robot.tool_compliance is not None:
        raise InputError(f"{robot.name}: the CalculiX deck has rigid feet and no tool spring")
    posture = robot.posture(x)
    loaded = posture.tip + robot.tool_offset
    bases = posture.root1, posture.root2
    rotations = posture.rotation1, posture.rotation2
    nodes = [
        leg.mesh.nodes @ rotation.T + base
        for leg, rotation, base in zip(legs, rotations, bases, strict=True)
    ]
    offsets = 0, len(nodes[0])
    start = len(nodes[0]) + len(nodes[1])
    number = {name: start + place for place, name in enumerate(_EXTRA)}

    platform = _twist(number["B"], number["platform's rotation"])
    roots = (
        _twist(number["A"], number["leg 1's rotation at A"]),
        _twist(number["C"], number["leg 2's rotation at C"]),
    )
    hinged: list[Freedom] = [*platform[:5], (number["leg 2's rotation at B"], 2)]
    equations = list(rigid_face(np.array([number["P"]]), loaded[None], posture.tip, platform))
    for which, tip in enumerate((platform, hinged)):
        faces = legs[which].mesh.root.nodes, legs[which].mesh.tip.nodes
        points, twists = (bases[which], posture.tip), (roots[which], tip)
        for face, point, twist in zip(faces, points, twists, strict=True):
            equations += rigid_face(face + offsets[which], nodes[which][face], point, twist)
    return Deck(
        title=f"{robot.name} at x = {x:g} m",
        # A node that keeps a rotation lies where its body turns.
        nodes=np.vstack([*nodes, *[posture.tip] * 3, *[bases[0]] * 2, *[bases[1]] * 2, loaded]),
        parts=tuple(
            Part(leg.mesh.cells + offset, leg.mesh.element, leg.leg.material, rotation)
            for leg, offset, rotation in zip(legs, offsets, rotations, strict=True)
        ),
        equations=tuple(equations),
        held=tuple(freedom for root in roots for freedom in root[:5]),
        masses=(PointMass(number["P"], robot.platform_mass),),
        # Unit wrenches at P are moved to B, where the platform's freedoms are.
        load_cases=tuple(
            tuple(NodalForce(platform[k], float(row[k])) for k in np.flatnonzero(row))
            for row in shift(robot.tool_offset)
        ),
        watched=(number["B"], number["platform's rotation"]),
        modes=modes,
    )


def compliance_and_frequencies(
    robot: Biglide,
    x: float,
    legs: tuple[SolidLeg, SolidLeg],
    modes: int = 10,
    threads: int = 1,
    timeout: float = 600.0,
) -> tuple[Array, Array]:
    """CalculiX's 6×6 compliance (SI, robot axes) at P and frequencies (Hz) of the robot.

    As printed: seven digits, not symmetrised. Raises as `robot_deck` and `run_calculix` do.
    """
    results = run_calculix(robot_deck(robot, x, legs, modes), threads, timeout)
    at_b = results.displacements.reshape(6, 6).T
    return shift(robot.tool_offset) @ at_b, results.frequencies


def _twist(translation: int, rotation: int) -> list[Freedom]:
    return [(node, component) for node in (translation, rotation) for component in range(3)]
