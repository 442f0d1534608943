"""The whole robot with solid legs solved by CalculiX: the independent judge of the assembly.

Rigid end faces, revolute joints and the platform are linear equations that share freedoms: both
faces at B have the platform's translation and its rotations about x and y, and a φz each. Of a root
only φz is free where feet are rigid; elastic feet and the tool are full 6×6 springs, each of six
springs on freedoms of their own (`fem.calculix.deck.full_spring`), and a foot has a φz beside the
leg's. The legs' material axes turn with them.
"""

import numpy as np

from fem.bodies.solid import SolidLeg
from fem.calculix.deck import (
    Deck,
    Equation,
    Freedom,
    GroundedSpring,
    NodalForce,
    Part,
    PointMass,
    full_spring,
    rigid_face,
)
from fem.calculix.run import run_calculix
from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.screws import shift

# Nodes beside those of the legs, after which they are numbered: what moves, and where a rotation
# is kept as the displacement of a node of its own. Strains of springs are such displacements too.
_EXTRA = (
    "B",
    "platform's rotation",
    "leg 2's rotation at B",
    "A",
    "leg 1's rotation at A",
    "C",
    "leg 2's rotation at C",
    "P",
    "P's rotation",
    "foot 1's rotation",
    "foot 2's rotation",
    *(f"{spring}'s strains {part}" for spring in ("foot 1", "foot 2", "tool") for part in (1, 2)),
)


def robot_deck(robot: Biglide, x: float, legs: tuple[SolidLeg, SolidLeg], modes: int) -> Deck:
    """The robot with B at `x` (m), six unit wrenches at P, then its modes; robot axes.

    `legs` are the solids of leg 1 and leg 2 in their own axes; their stiffness and mass matrices
    are not used. Watched are P and the node of its rotation. Raises InputError outside the stroke.
    """
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
    at_p = _twist(number["P"], number["P's rotation"])
    equations, springs = _tool(robot, at_p, platform, _strains(number, "tool"))
    for which, tip in enumerate((platform, hinged)):
        faces = legs[which].mesh.root.nodes, legs[which].mesh.tip.nodes
        points, twists = (bases[which], posture.tip), (roots[which], tip)
        for face, point, twist in zip(faces, points, twists, strict=True):
            equations += rigid_face(face + offsets[which], nodes[which][face], point, twist)
    held: list[Freedom] = []
    for name, root in zip(("foot 1", "foot 2"), roots, strict=True):
        foot = [*root[:5], (number[f"{name}'s rotation"], 2)]
        if robot.foot_compliance is None:
            held += root[:5]
            continue
        strain = [[(freedom, 1.0)] for freedom in foot]
        stiffness = np.asarray(np.linalg.inv(robot.foot_compliance), dtype=float)
        found = full_spring(stiffness, strain, _strains(number, name))
        equations += found[0]
        springs += found[1]
    places = {"A": bases[0], "C": bases[1], "B": posture.tip, "P": loaded}
    return Deck(
        title=f"{robot.name} at x = {x:g} m",
        nodes=np.vstack([*nodes, *(_place(name, places) for name in _EXTRA)]),
        parts=tuple(
            Part(leg.mesh.cells + offset, leg.mesh.element, leg.leg.material, rotation)
            for leg, offset, rotation in zip(legs, offsets, rotations, strict=True)
        ),
        equations=tuple(equations),
        held=tuple(held),
        masses=(PointMass(number["P"], robot.platform_mass),),
        springs=tuple(springs),
        load_cases=_unit_wrenches(robot, platform, at_p),
        watched=(number["P"], number["P's rotation"]),
        modes=modes,
    )


def _strains(number: dict[str, int], name: str) -> list[Freedom]:
    return _twist(number[f"{name}'s strains 1"], number[f"{name}'s strains 2"])


def _place(name: str, places: dict[str, Array]) -> Array:
    """A node that keeps a rotation or a strain lies where its body turns; where, nothing asks."""
    last = name[-1]
    return places.get(last, places["P"] if "tool" in name or "P's" in name else places["B"])


def _tool(
    robot: Biglide, at_p: list[Freedom], platform: list[Freedom], strains: list[Freedom]
) -> tuple[list[Equation], list[GroundedSpring]]:
    """P's twist from the platform's: moved there rigidly, or with the tool's spring between."""
    arm = shift(robot.tool_offset)
    moved = [[(platform[k], float(row[k])) for k in np.flatnonzero(row)] for row in arm]
    if robot.tool_compliance is None:
        rigid = [Equation(own, tuple(terms)) for own, terms in zip(at_p, moved, strict=True)]
        return rigid, []
    strain = [
        [(own, 1.0), *((freedom, -factor) for freedom, factor in terms)]
        for own, terms in zip(at_p, moved, strict=True)
    ]
    stiffness = np.asarray(np.linalg.inv(robot.tool_compliance), dtype=float)
    equations, springs = full_spring(stiffness, strain, strains)
    return list(equations), list(springs)


def _unit_wrenches(
    robot: Biglide, platform: list[Freedom], at_p: list[Freedom]
) -> tuple[tuple[NodalForce, ...], ...]:
    """Six unit wrenches at P; on a rigid platform at its own freedoms, moved to B."""
    if robot.tool_compliance is not None:
        return tuple((NodalForce(freedom, 1.0),) for freedom in at_p)
    return tuple(
        tuple(NodalForce(platform[k], float(row[k])) for k in np.flatnonzero(row))
        for row in shift(robot.tool_offset)
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
    return results.displacements.reshape(6, 6).T, results.frequencies


def _twist(translation: int, rotation: int) -> list[Freedom]:
    return [(node, component) for node in (translation, rotation) for component in range(3)]
