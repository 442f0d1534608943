"""A whole mechanism with solid legs solved by CalculiX, as an independent check of the assembly.

Each rigid body and each end face has a twist. Joints are linear conditions on these twists and on
the deflections of springs in the joints. Gauss–Jordan elimination expresses all twists by
independent freedoms. End faces, masses and springs are then coupled to these freedoms by linear
equations. The functions for the free twists of a joint are those of `lumped.system`; all other
steps are independent of it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem.bodies.solid import SolidLeg
from fem.calculix.deck import Deck, ElementSet, Equation, Freedom, OnFreedom
from fem.calculix.run import run_calculix
from fem.couplings.grips import rigid_motions
from lumped.arrays import Array, IntArray
from lumped.mechanism.body import Rigid
from lumped.mechanism.free_twists import (
    drive_in,
    free_twists,
    interface_position,
    rotation_since_reference,
)
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import GROUND, Posture
from lumped.screws import shift, turn_matrix

# Dimensionless residual below which a condition is satisfied. Loops are closed to 1e-12.
_DEPENDENT = 1e-9
_NOTHING = 1e-13
# Stiffness (N m/rad) of springs that restrain idle motions, which would make the stiffness
# singular. The resulting frequencies are far below all others and do not affect these.
_IDLE_STIFFNESS = 1e-3


@dataclass(frozen=True, eq=False)
class _Freedoms:
    """Twists and spring deflections of a mechanism as functions of n independent freedoms.

    `places` are points (3, in m, base axes). `twists` (6×n) are the matrices from the freedoms to
    the twists at these points. Both are keyed by (body, interface), with "" as interface for a
    rigid body. Each of the `springs` is a tuple of three: the row (n) that gives its deflection
    from the freedoms, its stiffness (N/m or N m/rad), and the inertia (kg or kg m²) that moves with
    this deflection. `idle` (k×n) are the k idle motions, which do not move the tool, as unit
    vectors of freedoms.
    """

    places: Mapping[tuple[str, str], Array]
    twists: Mapping[tuple[str, str], Array]
    springs: tuple[tuple[Array, float, float], ...]
    idle: Array


@dataclass(frozen=True, eq=False)
class MechanismDeck:
    """Deck of a mechanism, with the data to evaluate its results.

    `tool` (6×n) is the matrix from the displacements of n freedoms, which CalculiX prints, to the
    twist of the loaded point. `idle` is the number of idle motions, which do not move the tool.
    """

    deck: Deck
    tool: Array
    idle: int


class _Builder:
    """Data of a deck while it is built: its nodes, and their coupling to independent freedoms."""

    def __init__(self, freedoms: _Freedoms) -> None:
        self.freedoms = freedoms
        count = freedoms.idle.shape[1]
        self.independent = [(k // 3, k % 3) for k in range(count)]
        # Freedoms are packed into nodes, three each. Unused components of the last node are fixed.
        self.packed = -(-count // 3)
        self.held: list[Freedom] = [(k // 3, k % 3) for k in range(count, 3 * self.packed)]
        self.equations: list[Equation] = []
        self.nodes: list[Array] = [np.zeros((self.packed, 3))]
        self.count = self.packed

    def add(self, points: Array) -> int:
        """Add nodes at `points` (k×3, in m). Return the number of the first one."""
        self.nodes.append(points)
        self.count += len(points)
        return int(self.count - len(points))

    def tie(self, freedom: Freedom, row: Array) -> None:
        """Express `freedom` by the n independent freedoms, with the coefficients `row` (n)."""
        terms = self.terms(row)
        if terms:
            self.equations.append(Equation(freedom, terms))
        else:
            self.held.append(freedom)

    def carry(self, numbers: IntArray, points: Array, node: tuple[str, str]) -> None:
        """Couple nodes rigidly to `node`, the key (body, interface) of a rigid body or an end face.

        `numbers` (k) are the numbers of the nodes, `points` (k×3, in m) their positions.
        """
        motions = rigid_motions(points, self.freedoms.places[node]) @ self.freedoms.twists[node]
        for number, rows in zip(numbers.tolist(), motions.reshape(len(points), 3, -1), strict=True):
            for component, row in enumerate(rows):
                self.tie((number, component), row)

    def terms(self, row: Array) -> tuple[OnFreedom, ...]:
        """Pairs of an independent freedom and its coefficient, for the coefficients in `row` (n).

        Coefficients that are only round-off are omitted. If the row couples a freedom to the
        independent ones, its coefficients are also the generalised forces of a unit load on this
        freedom.
        """
        significant = np.flatnonzero(np.abs(row) > _NOTHING)
        return tuple((self.independent[k], float(row[k])) for k in significant)


def mechanism_deck(posture: Posture, legs: Mapping[str, SolidLeg], modes: int) -> MechanismDeck:
    """Deck of a mechanism in one posture: six unit wrenches at its loaded point, then its modes.

    `legs` contains the solid of each body that is not rigid, by body name. The solids have rigid
    end faces and are in body axes. `modes` is the number of modes without idle motions.
    """
    mechanism = posture.mechanism
    motions = _freedoms(posture, legs)
    build = _Builder(motions)
    parts = [_add_leg(build, posture, name, leg) for name, leg in legs.items()]
    masses = []
    for name, body in mechanism.bodies.items():
        if name != GROUND and isinstance(body.shape, Rigid) and body.shape.mass:
            frame = posture.frames[name]
            points = _six_points(body.shape) @ frame.rotation.T + frame.position
            first = build.add(points)
            build.carry(first + np.arange(6), points, (name, ""))
            masses += [(first + k, body.shape.mass / 6.0) for k in range(6)]
    tool = mechanism.tool
    carrier = (tool.body, tool.point if tool.body in legs else "")
    tool_position = interface_position(posture, Side(tool.body, tool.point))
    if tool.mass:
        first = build.add(tool_position[None])
        build.carry(np.array([first]), tool_position[None], carrier)
        masses.append((first, tool.mass))
    springs = []
    idle = ((row, _IDLE_STIFFNESS, 0.0) for row in motions.idle)
    for row, stiffness, inertia in (*motions.springs, *idle):
        number = build.add(np.zeros((1, 3)))
        if inertia:
            masses.append((number, inertia))
        build.tie((number, 0), row)
        build.held += [(number, 1), (number, 2)]
        springs.append(((number, 0), stiffness))
    # CalculiX couples freedoms by mass only if they are also coupled by stiffness. Springs of zero
    # stiffness provide this coupling.
    springs += [((node, component), 0.0) for node, _ in masses for component in range(3)]
    loaded: Array = shift(tool_position - motions.places[carrier]) @ motions.twists[carrier]
    deck = Deck(
        title=f"{mechanism.name} {shown_pose(mechanism, posture.pose)}",
        nodes=np.vstack(build.nodes),
        parts=tuple(parts),
        equations=tuple(build.equations),
        held=tuple(build.held),
        masses=tuple(masses),
        springs=tuple(springs),
        load_cases=tuple(build.terms(row) for row in loaded),
        watched=tuple(range(build.packed)),
        modes=modes + len(motions.idle) if modes else 0,
    )
    return MechanismDeck(deck, loaded, len(motions.idle))


def _add_leg(build: _Builder, posture: Posture, name: str, leg: SolidLeg) -> ElementSet:
    frame = posture.frames[name]
    placed = leg.mesh.nodes @ frame.rotation.T + frame.position
    first = build.add(placed)
    points = posture.mechanism.bodies[name].interfaces
    ends = leg.mesh.root.nodes, leg.mesh.tip.nodes
    for nodes, point in zip(ends, points, strict=True):
        build.carry(nodes + first, placed[nodes], (name, point))
    material = leg.leg.material
    return ElementSet(leg.mesh.cells + first, leg.mesh.element, material, frame.rotation)


def compliance_and_frequencies(
    posture: Posture, legs: Mapping[str, SolidLeg], modes: int = 10
) -> tuple[Array, Array]:
    """Compliance (6×6, SI, base axes) at the loaded point and natural frequencies (Hz) by CalculiX.

    `legs` contains the solid of each body that is not rigid, by body name. `modes` is the number of
    frequencies. Values are those that CalculiX prints, with seven digits. The compliance is not
    made symmetric. Idle motions are omitted. Raises errors as `run_calculix` does.
    """
    model = mechanism_deck(posture, legs, modes)
    results = run_calculix(model.deck)
    freedoms = results.displacements.reshape(6, -1)[:, : model.tool.shape[1]]
    compliance: Array = model.tool @ freedoms.T
    return compliance, results.frequencies[model.idle :]


def _freedoms(posture: Posture, legs: Mapping[str, SolidLeg]) -> _Freedoms:
    mechanism = posture.mechanism
    places: dict[tuple[str, str], Array] = {}
    for name, body in mechanism.bodies.items():
        if name in legs:
            for point in body.interfaces:
                places[name, point] = interface_position(posture, Side(name, point))
        elif name != GROUND:
            places[name, ""] = posture.frames[name].position
    order = {key: 6 * i for i, key in enumerate(places)}
    elastic = [_elastic_directions(posture, joint) for joint in mechanism.joints]
    size = 6 * len(order) + sum(len(stiffnesses) for _, stiffnesses in elastic)
    # Translations are divided by the mechanism's size, so that the conditions are dimensionless.
    unit = np.array([1.0 / mechanism.size] * 3 + [1.0] * 3)

    def twist(side: Side, position: Array) -> Array:
        rows = np.zeros((6, size))
        if side.body != GROUND:
            key = (side.body, side.point if side.body in legs else "")
            rows[:, order[key] : order[key] + 6] = (
                unit[:, None] * shift(position - places[key]) / unit
            )
        return rows

    conditions, springs, first = [np.zeros((0, size))], [], 6 * len(order)
    for joint, (directions, stiffnesses) in zip(mechanism.joints, elastic, strict=True):
        joint_position = interface_position(posture, joint.first)
        relative = twist(joint.second, joint_position) - twist(joint.first, joint_position)
        columns = slice(first, first + len(stiffnesses))
        relative[:, columns] -= unit[:, None] * directions
        # The spring of a drive, if there is one, is the first spring of its joint.
        rotor = joint.drive.inertia if joint.drive is not None and joint.drive.stiffness else 0.0
        springs += [
            (first + k, stiffness, 0.0 if k else rotor) for k, stiffness in enumerate(stiffnesses)
        ]
        first = columns.stop
        free = free_twists(posture, joint)
        passive = unit[:, None] * (free if joint.drive is None else free[:, 1:])
        across = np.linalg.qr(passive, mode="complete")[0][:, passive.shape[1] :]
        conditions.append(across.T @ relative)
    all_unknowns = _eliminated(np.vstack(conditions))
    strains = [all_unknowns[6 * len(order) :]]
    for name in legs:
        root, *other_ends = ((name, point) for point in mechanism.bodies[name].interfaces)
        for tip in other_ends:
            rigid_transfer: Array = unit[:, None] * shift(places[tip] - places[root]) / unit
            strains.append(
                all_unknowns[order[tip] : order[tip] + 6]
                - rigid_transfer @ all_unknowns[order[root] : order[root] + 6]
            )
    _, values, right = np.linalg.svd(np.vstack(strains))
    return _Freedoms(
        places=places,
        twists={key: all_unknowns[i : i + 6] / unit[:, None] for key, i in order.items()},
        springs=tuple((all_unknowns[k], *rest) for k, *rest in springs),
        idle=right[int(np.sum(values > _DEPENDENT)) :],
    )


def _elastic_directions(posture: Posture, joint: Joint) -> tuple[Array, Array]:
    """Directions (6×r, base axes) in which a joint is elastic, and its r stiffnesses along them.

    The elasticity is that of the spring of a drive, which comes first, and that of the joint
    itself.
    """
    directions, stiffnesses = np.zeros((6, 0)), np.zeros(0)
    drive = drive_in(posture, joint)
    if drive is not None and drive.stiffness is not None:
        directions = free_twists(posture, joint)[:, :1]
        stiffnesses = np.array([drive.stiffness])
    if joint.compliance is not None:
        turned = turn_matrix(joint.compliance, rotation_since_reference(posture, joint.first.body))
        values, vectors = np.linalg.eigh(turned)
        soft = values > _NOTHING * values[-1]
        directions = np.hstack([directions, vectors[:, soft]])
        stiffnesses = np.append(stiffnesses, 1.0 / values[soft])
    return directions, stiffnesses


def _eliminated(conditions: Array) -> Array:
    """Matrix (N×n) from n independent unknowns to all N unknowns that satisfy linear conditions.

    The conditions are `conditions` u = 0 for the N unknowns u. The matrix is computed by
    Gauss–Jordan elimination.
    """
    rows = conditions.copy()
    size = rows.shape[1]
    dependent: list[int] = []
    for step in range(len(rows)):
        remaining = np.abs(rows[step:])
        pivot, column = divmod(int(np.argmax(remaining)), size)
        if remaining[pivot, column] <= _DEPENDENT:
            break
        rows[[step, step + pivot]] = rows[[step + pivot, step]]
        rows[step] /= rows[step, column]
        other_rows = np.arange(len(rows)) != step
        rows[other_rows] -= np.outer(rows[other_rows, column], rows[step])
        dependent.append(column)
    independent = np.setdiff1d(np.arange(size), dependent)
    all_unknowns = np.zeros((size, len(independent)))
    all_unknowns[independent] = np.eye(len(independent))
    all_unknowns[dependent] = -rows[: len(dependent), independent]
    all_unknowns[np.abs(all_unknowns) < _NOTHING] = 0.0
    return all_unknowns


def _six_points(shape: Rigid) -> Array:
    """Six points (6×3, in m, body axes) that represent the mass of a rigid body.

    Six equal masses at these points have the mass centre and the inertia of the body.
    """
    moments, axes = np.linalg.eigh(shape.inertia)
    # ∫ x² dm along each principal axis is that of two points at ±d with a sixth of the mass each.
    squares = 0.5 * moments.sum() - moments
    arms = np.sqrt(np.maximum(squares, 0.0) * 3.0 / shape.mass)
    return np.vstack([shape.centre + sign * arms[:, None] * axes.T for sign in (1.0, -1.0)])
