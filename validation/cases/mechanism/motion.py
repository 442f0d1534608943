"""A mechanism in motion: what its moves stir by differences of postures, beside the assembler's.

Postures come from closing the loops of rigid bodies; the assembler joins nodes by the twists that
the joints allow. Between them stand difference quotients of frames, and nothing that they share.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from lumped.arrays import Array
from lumped.legs import ConstantLeg, GivenLeg
from lumped.mechanism.body import Body, Frame, Rigid
from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import MOVES, UNITS_OF_MOVES, Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, modes, solved
from validation.adequacy.mechanism.path import path_postures
from validation.case import Absolute, Measurement, Sides, Skip
from validation.case_group import CaseGroup
from validation.cases.mechanism.quantities import ASSEMBLER, MODEL_CODE
from validation.context import Context
from validation.exhibits import PATH
from validation.models.legs import filled, leg_matrices
from validation.models.mechanism import constant_legs, on_drives_alone
from validation.models.options import ModelOptions

# Of the size of the mechanism or in rad: difference quotients err by its square.
_STEP = 1e-4
_QUOTIENTS = (
    "difference quotients: the square of their step, and what closing the loops leaves of it, 5e-8"
)

cases = CaseGroup(
    unit="1",
    reference_kind="independent-solver",
    section=PATH,
    group="mechanism.lumped",
    effort=1.0,
)
# Once where the tool is `moving`, else not at all.
_of_moves = cases.family(
    over={"moved": lambda moving: ["the tool"] if moving else []},
    tolerance=Absolute(5e-7),
    tolerance_reason=_QUOTIENTS,
    model="simplified",
    sides=Sides(ASSEMBLER, (posture,)),
)


@dataclass(frozen=True)
class _Moved:
    """The middle of the path, the mechanism on its drives alone, and a little on either side.

    `steps` (m or rad) of each move, `driven`: stiffness of the drives by the name of their joint.
    """

    middle: Posture
    mechanism: Mechanism
    steps: Array
    ahead: tuple[Posture, ...]
    behind: tuple[Posture, ...]
    driven: dict[str, float]

    @property
    def drives(self) -> Array:
        """QᵀKQ (moves × moves): stiffness against motions of the tool."""
        moved = [
            [one.coordinates[name][0] - other.coordinates[name][0] for name in self.driven]
            for one, other in zip(self.ahead, self.behind, strict=True)
        ]
        motion = np.array(moved) / (2.0 * self.steps[:, None])
        return np.asarray(motion @ np.diag(list(self.driven.values())) @ motion.T)

    @property
    def compliance(self) -> Array:
        """C (moves × moves) against wrenches at the tool's point, of the drives alone.

        A pose's rotations are a vector, whose rates are the body's only in the reference posture.
        """
        tool = self.mechanism.tool
        at_tool = self.mechanism.bodies[tool.body].interfaces[tool.point].position
        rows = [MOVES.index(move) for move in tool.moves]
        twists = np.hstack(self.velocity(tool.body, at_tool))[:, rows]
        return np.asarray(twists.T @ np.linalg.solve(self.drives, twists))

    def velocity(self, body: str, point: Array) -> tuple[Array, Array]:
        """Velocities of a point in body axes, and angular ones (moves × 3 each, base axes)."""
        along, about = [], []
        for one, other in zip(self.ahead, self.behind, strict=True):
            first, second = one.frames[body], other.frames[body]
            along.append((first @ Frame(point)).position - (second @ Frame(point)).position)
            about.append(Rotation.from_matrix(first.rotation @ second.rotation.T).as_rotvec())
        spans = 2.0 * self.steps[:, None]
        return np.array(along) / spans, np.array(about) / spans


def _moved(context: Context, step: float) -> _Moved:
    postures = path_postures(context)
    middle = postures[len(postures) // 2]
    mechanism = on_drives_alone(middle.mechanism)
    moves = mechanism.tool.moves
    drives = {joint.name: joint.drive for joint in mechanism.joints if joint.drive is not None}
    driven = {
        name: drive.stiffness for name, drive in drives.items() if drive.stiffness is not None
    }
    if not len(drives) == len(driven) == len(moves):
        raise Skip("drives are rigid, or there are not as many as moves of the tool")
    steps = np.array(
        [step * (1.0 if UNITS_OF_MOVES[move] == "rad" else mechanism.size) for move in moves]
    )
    ahead, behind = (
        tuple(posture(middle.mechanism, middle.pose + row, middle) for row in sign * np.diag(steps))
        for sign in (1.0, -1.0)
    )
    return _Moved(middle, mechanism, steps, ahead, behind, driven)


def _refined(context: Context, apart: Callable[[_Moved], float]) -> Measurement:
    """A relative difference by difference quotients, with what their step leaves open.

    Second order: twice the step errs four times, so that the change is three times the error.
    """
    found, by_twice_the_step = (apart(_moved(context, step)) for step in (_STEP, 2.0 * _STEP))
    return Measurement(found, 0.0, value_uncertainty=abs(by_twice_the_step - found))


@_of_moves.case(
    "mechanism.simplified",
    "The simplified model yields as its drives turn when the tool is moved",
    quantity="largest relative difference of the compliances along the moves, middle of path",
    citation="C = T (QᵀKQ)⁻¹ Tᵀ, Q the drives' motion and T the tool's twist per change of pose",
)
def _yielding(context: Context) -> Measurement:
    return _refined(context, _yielding_apart)


def _yielding_apart(moved: _Moved) -> float:
    rows = [MOVES.index(move) for move in moved.mechanism.tool.moves]
    system = assembly(moved.mechanism, {}).at(replace(moved.middle, mechanism=moved.mechanism))
    found = compliance(solved(system))[np.ix_(rows, rows)]
    expected = moved.compliance
    sizes = np.sqrt(np.diag(expected))
    return float(np.abs((found - expected) / np.outer(sizes, sizes)).max())


@_of_moves.case(
    "mechanism.inertia",
    "On its drives it swings with the energy of its bodies' motions",
    quantity="largest relative difference of the frequencies, all bodies rigid",
    citation="QᵀKQ against Σ m vᵀv + ωᵀIω of all bodies per motion of the tool",
)
def _swinging(context: Context) -> Measurement:
    return _refined(context, _swinging_apart)


def _swinging_apart(moved: _Moved) -> float:
    rigid = _with_rigid_legs(moved.mechanism)
    system = assembly(rigid, {}).at(replace(moved.middle, mechanism=rigid))
    count = len(moved.steps)
    found = modes(solved(system), count).frequencies
    energy = np.zeros((count, count))
    for name, body in rigid.bodies.items():
        if isinstance(body.shape, Rigid):
            velocity, turning = moved.velocity(name, body.shape.centre)
            own = turning @ moved.middle.frames[name].rotation
            if _spins(rigid, name):
                own[:, 0] = 0.0
            energy += body.shape.mass * velocity @ velocity.T + own @ body.shape.inertia @ own.T
    tool = rigid.tool
    at_tool = rigid.bodies[tool.body].interfaces[tool.point].position
    velocity, _ = moved.velocity(tool.body, at_tool)
    energy += tool.mass * velocity @ velocity.T
    expected = np.sqrt(eigh(moved.drives, energy, eigvals_only=True)) / (2.0 * np.pi)
    return float(np.abs(found / expected - 1.0).max())


def _spins(mechanism: Mechanism, name: str) -> bool:
    """Whether a leg between ball joints spins as it likes, and so takes no energy from that."""
    joints = [j for j in mechanism.joints if name in {j.first.body, j.second.body}]
    return name in legs_of(mechanism) and all(joint.kind == "spherical" for joint in joints)


def _with_rigid_legs(mechanism: Mechanism) -> Mechanism:
    """Legs with the inertia of lines, and as much about themselves."""
    legs = legs_of(mechanism)

    def rigid(body: Body) -> Body:
        if not isinstance(body.shape, ConstantLeg | GivenLeg):
            return body
        leg = legs[body.name]
        centre = np.array([0.5 * leg.length, 0.0, 0.0])
        inertia = leg.mass * leg.length**2 / 12.0 * np.eye(3)
        return replace(body, shape=Rigid(leg.mass, centre, inertia))

    bodies = {name: rigid(body) for name, body in mechanism.bodies.items()}
    return replace(mechanism, bodies=bodies)


@cases.case(
    "mechanism.idle",
    "The assembler leaves as many motions idle as the closed loops do",
    quantity="idle motions, in the pose where the two differ most",
    citation="null space of the joints' constraints on rigid bodies",
    tolerance=Absolute(0.5),
    tolerance_reason="a count is a whole number",
    model="beam",
    sides=Sides((*ASSEMBLER, *MODEL_CODE["beam"]), (mobility,)),
)
def _idle(context: Context) -> Measurement:
    postures = path_postures(context)
    mechanism = postures[0].mechanism
    beams = {
        name: filled(leg_matrices("beam", leg, own))
        for name, leg, own in constant_legs(mechanism, ModelOptions(elements=1))
    }
    prepared = assembly(mechanism, beams)
    counts = [(solved(prepared.at(at)).idle, mobility(at).idle) for at in postures]
    found, expected = max(counts, key=lambda pair: abs(pair[0] - pair[1]))
    return Measurement(float(found), float(expected), exact=True)
