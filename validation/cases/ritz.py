"""Any mechanism of prisms and rigid bodies by the method of Ritz, in a posture that closes.

A way of its own to deflections and frequencies, which takes nothing but the robot's data: legs are
polynomials, their energies by quadrature. Unknowns are the coefficients of the legs, the twists of
the rigid bodies, and what the joints let happen; joints are linear constraints between them.
Nothing is eliminated joint by joint, and where bodies are is read off the frames, whose joints are
measured here once more. CAD parts have no polynomials: they are rigid and without mass.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import assert_never

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import block_diag, eigh, null_space, pinvh

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import ComputationError
from lumped.legs import BeamProperties, ConstantLeg, GivenLeg, Leg, Theory
from lumped.mechanism.body import Rigid
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture

# Statics of Timoshenko beams are cubic; modes converge geometrically.
STATIC_DEGREE = 3
# Modes up to the second of a bar between its joints, to six digits.
DEGREE = 8
# Eigenvalues of stiffness below this share of the largest are idle motions.
_IDLE = 1e-15
# Shares of the largest inertia over stiffness below which a motion has no mass.
_MASSLESS = 1e-14
# Gaps of joints, of the size of the mechanism or in rad: loops are closed to 1e-12.
_CLOSED = 1e-9


_EXCHANGE = np.array([[0.0, 1.0], [1.0, 0.0]])


@dataclass(frozen=True, eq=False)
class RitzLeg:
    """A leg on n coefficients, SI, leg axes.

    Twice its energies, `stiffness` and `mass` (n×n); twists of its `root` and `tip` (6×n).
    """

    stiffness: Array
    mass: Array
    root: Array
    tip: Array

    @property
    def size(self) -> int:
        """How many coefficients there are."""
        return len(self.stiffness)


def of_beam(beam: BeamProperties, length: float, degree: int) -> RitzLeg:
    """Legendre polynomials of `degree` in stretch, shear strains and rotations of a prism.

    Deflections follow from the shear strains and rotations: were they unknowns, strains would be
    their differences, and bending lost beside what a material hardly shears. Euler and Bernoulli
    have no shear strains. Shear strains and the deflections that they bend with are those of the
    shear centre, v − z_s φx and w + y_s φx; the mass moves with the centroid.
    """
    points, weights = legendre.leggauss(degree + 2)
    weights = 0.5 * length * weights
    q, slopes = fields(beam, length, points, degree)
    shears = (
        slopes[1] - beam.centre_z * slopes[3] - q[5],
        slopes[2] + beam.centre_y * slopes[3] + q[4],
    )
    flexibilities = np.diag([1.0 / beam.GAy, 1.0 / beam.GAz]) + beam.shear_yz * _EXCHANGE
    shear = np.linalg.inv(flexibilities) if np.isfinite(beam.GAy) else np.zeros((2, 2))
    terms = [
        (beam.EA, slopes[0], slopes[0]),
        (beam.GJ, slopes[3], slopes[3]),
        (beam.EIy, slopes[4], slopes[4]),
        (beam.EIz, slopes[5], slopes[5]),
        (-beam.EIyz, slopes[4], slopes[5]),
        (-beam.EIyz, slopes[5], slopes[4]),
        *((shear[i, j], shears[i], shears[j]) for i in range(2) for j in range(2)),
    ]
    inertias = (beam.mu, beam.mu, beam.mu, beam.rho_J, beam.rho_Iy, beam.rho_Iz)
    products = [(m, f, f) for m, f in zip(inertias, q, strict=True)]
    products += [(-beam.rho_Iyz, q[4], q[5]), (-beam.rho_Iyz, q[5], q[4])]
    size = q.shape[2]
    ends, _ = fields(beam, length, np.array([-1.0, 1.0]), degree)
    return RitzLeg(
        stiffness=_sum([k * (one.T * weights) @ other for k, one, other in terms], size),
        mass=_sum([m * (one.T * weights) @ other for m, one, other in products], size),
        root=ends[:, 0],
        tip=ends[:, 1],
    )


def fields(beam: BeamProperties, length: float, at: Array, degree: int) -> tuple[Array, Array]:
    """Twist of the centreline and its slope (6×p×n) on the coefficients of `of_beam`.

    `at` p points, the root at −1, the tip at 1. Coefficients are those of u, φx, φy, φz, then of
    the root's v with γy, of its w with γz.
    """
    unit = np.eye(degree + 1)
    values = legendre.legvander(at, degree)
    slopes = legendre.legval(at, legendre.legder(unit)).T * 2.0 / length
    integrals = legendre.legval(at, legendre.legint(unit, lbnd=-1.0)).T * 0.5 * length
    count = degree + 1
    sheared = [1 + count * bool(np.isfinite(k)) for k in (beam.GAy, beam.GAz)]
    firsts = (4 * count, 4 * count + sheared[0])
    total = firsts[1] + sheared[1]
    q, moving = np.zeros((6, len(at), total)), np.zeros((6, len(at), total))
    for block, component in enumerate((0, 3, 4, 5)):
        own = slice(block * count, (block + 1) * count)
        q[component, :, own], moving[component, :, own] = values, slopes
    # v' = γy + φz, w' = γz − φy.
    for component, first, sign, about in ((1, firsts[0], 1.0, 3), (2, firsts[1], -1.0, 2)):
        own, turning = (
            slice(first + 1, first + count + 1),
            slice(about * count, (about + 1) * count),
        )
        q[component, :, first] = 1.0
        q[component, :, turning], moving[component, :, turning] = sign * integrals, sign * values
        if sheared[component - 1] > 1:
            q[component, :, own], moving[component, :, own] = integrals, values
    for field in (q, moving):
        field[1] += beam.centre_z * field[3]
        field[2] -= beam.centre_y * field[3]
    return q, moving


def of_compliance(compliance: Array, length: float) -> RitzLeg:
    """A leg known by its 6×6 at the tip, root clamped; massless, on the twists of its ends."""
    root, tip = np.vsplit(np.eye(12), 2)
    bent = tip - carried(np.array([length, 0.0, 0.0])) @ root
    stiffness = np.asarray(bent.T @ np.linalg.solve(compliance, bent))
    return RitzLeg(0.5 * (stiffness + stiffness.T), np.zeros((12, 12)), root, tip)


def rigid(length: float) -> RitzLeg:
    """A rigid leg without mass, on the twist of its root."""
    tip = carried(np.array([length, 0.0, 0.0]))
    return RitzLeg(np.zeros((6, 6)), np.zeros((6, 6)), np.eye(6), tip)


def placed(block: Array, first: int, total: int) -> Array:
    """The columns of `block` from number `first` on among `total`, zeros elsewhere."""
    wide = np.zeros((len(block), total))
    wide[:, first : first + block.shape[1]] = block
    return wide


def carried(offset: Array) -> Array:
    """Twist (6×6) at a point `offset` (3, m) away on the same body: u + φ × r."""
    x, y, z = offset
    moved = np.eye(6)
    moved[:3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return moved


def free_motions(stiffness: Array, conditions: Array) -> Array:
    """Basis (n×k) of what `conditions` (c×n), which must vanish, leave free of n unknowns.

    Each unknown is measured by its own stiffness (n×n), each condition has unit size: in rounding
    torsion of a thin wall would be lost beside what holds the wall along, a small lever taken for
    none.
    """
    own = np.diag(stiffness)
    # What has none of its own, rigid motions, is measured by the softest.
    softest = np.min(own[own > 0.0], initial=np.max(own) or 1.0)
    units = 1.0 / np.sqrt(np.where(own > 0.0, own, softest))
    measured = conditions * units
    free = null_space(measured / np.linalg.norm(measured, axis=1, keepdims=True))
    return np.asarray(units[:, None] * free)


def _sum(parts: list[Array], size: int) -> Array:
    return np.asarray(sum(parts, start=np.zeros((size, size))))


@dataclass(frozen=True, eq=False)
class _System:
    """Stiffness and mass (n×n) and twist of the loaded point (6×n, base axes), SI."""

    stiffness: Array
    mass: Array
    loaded: Array


def compliance(
    at: Posture,
    theory: Theory = "timoshenko",
    degree: int = STATIC_DEGREE,
    *,
    given: bool = True,
) -> Array:
    """6×6 compliance (SI, base axes) at the loaded point; prisms as beams of `theory`.

    Legs known by their 6×6 are that, or their equivalent prisms where not `given`. Raises
    ComputationError where the posture's joints are not closed.
    """
    legs = {
        name: of_compliance(shape.compliance, shape.length)
        if given and isinstance(shape, GivenLeg)
        else _beam(shape, theory, degree)
        for name, shape in _legs(at.mechanism)
    }
    return _compliance(_system(at, legs))


def frequencies(
    at: Posture, count: int, theory: Theory = "timoshenko", degree: int = DEGREE
) -> Array:
    """First natural frequencies (Hz, ascending), idle motions left out; prisms as beams."""
    legs = {name: _beam(shape, theory, degree) for name, shape in _legs(at.mechanism)}
    return _frequencies(_system(at, legs), count)


def on_drives(at: Posture, count: int) -> tuple[Array, Array]:
    """Compliance and up to `count` frequencies with rigid legs without mass, elastic drives."""
    legs = {name: rigid(shape.length) for name, shape in _legs(at.mechanism)}
    system = _system(at, legs, simplified=True)
    return _compliance(system), _frequencies(system, count)


def _legs(mechanism: Mechanism) -> list[tuple[str, Leg]]:
    shapes = ((name, body.shape) for name, body in mechanism.bodies.items())
    return [(name, shape) for name, shape in shapes if isinstance(shape, ConstantLeg | GivenLeg)]


def _beam(shape: Leg, theory: Theory, degree: int) -> RitzLeg:
    if isinstance(shape, GivenLeg):
        leg = equivalent_leg(GivenLeg(shape.length, shape.mass, shape.compliance))
    else:
        leg = ConstantLeg(shape.length, shape.section, shape.material)
    return of_beam(leg.properties(theory), leg.length, degree)


def _compliance(system: _System) -> Array:
    # Forces at the tool do no work on idle motions.
    elastic, _ = _motions(system)
    moved = system.loaded @ elastic
    return np.asarray(moved @ moved.T)


def _frequencies(system: _System, count: int) -> Array:
    elastic, idle = _motions(system)
    momenta = system.mass @ elastic
    mass = elastic.T @ momenta
    if idle.shape[1]:
        # Idle motions go with the others such that they have no momentum.
        along = idle.T @ momenta
        mass -= along.T @ pinvh(idle.T @ system.mass @ idle) @ along
    inverse = np.linalg.eigvalsh(mass)[::-1]
    squares = 1.0 / inverse[inverse > _MASSLESS * inverse.max(initial=0.0)][:count]
    return np.asarray(np.sqrt(squares) / (2.0 * np.pi))


def _motions(system: _System) -> tuple[Array, Array]:
    """Motions (n×k) in which the stiffness is the unit matrix, and idle ones, of no stiffness."""
    values, vectors = eigh(system.stiffness)
    idle = values < _IDLE * len(values) * values.max(initial=0.0)
    return vectors[:, ~idle] / np.sqrt(values[~idle]), vectors[:, idle]


def _system(at: Posture, legs: Mapping[str, RitzLeg], *, simplified: bool = False) -> _System:
    """Of the unknowns that the joints leave; `simplified`: joints do not give but for drives."""
    _require_closed(at)
    mechanism = at.mechanism
    shapes = {name: body.shape for name, body in mechanism.bodies.items() if name != GROUND}
    joints = [_Joint.of(at, joint, simplified=simplified) for joint in mechanism.joints]
    sizes = [legs[name].size if name in legs else 6 for name in shapes]
    sizes += [joint.motions.shape[1] for joint in joints]
    firsts = np.concatenate([[0], np.cumsum(sizes)])
    total = int(firsts[-1])
    first_of = dict(zip(shapes, firsts.tolist(), strict=False))

    def twist(side: Side, place: Array) -> Array:
        """Twist (6×total, base axes) at `place` of what a side of a joint belongs to."""
        if side.body == GROUND:
            return np.zeros((6, total))
        frame, first = at.frames[side.body], first_of[side.body]
        if side.body not in legs:
            return carried(place - frame.position) @ placed(np.eye(6), first, total)
        names = list(mechanism.bodies[side.body].interfaces)
        end = legs[side.body].root if side.point == names[0] else legs[side.body].tip
        turned = block_diag(frame.rotation, frame.rotation) @ end
        return carried(place - _place(at, side)) @ placed(turned, first, total)

    stiffness, mass = (
        block_diag(
            *(getattr(legs[name], kind) if name in legs else np.zeros((6, 6)) for name in shapes),
            *(
                np.diag(joint.springs if kind == "stiffness" else joint.inertias)
                for joint in joints
            ),
        )
        for kind in ("stiffness", "mass")
    )
    for name, shape in shapes.items():
        if isinstance(shape, Rigid):
            frame = at.frames[name]
            centre = twist(Side(name, ""), frame.position + frame.rotation @ shape.centre)
            inertia = frame.rotation @ shape.inertia @ frame.rotation.T
            mass += shape.mass * centre[:3].T @ centre[:3] + centre[3:].T @ inertia @ centre[3:]
    tool = Side(mechanism.tool.body, mechanism.tool.point)
    loaded = twist(tool, _place(at, tool))
    mass += mechanism.tool.mass * loaded[:3].T @ loaded[:3]
    shut = []
    for joint, first in zip(joints, firsts[len(shapes) :].tolist(), strict=False):
        apart = twist(joint.second, joint.place) - twist(joint.first, joint.place)
        shut.append(apart - placed(joint.motions, first, total))
    free = free_motions(stiffness, np.vstack(shut))
    return _System(free.T @ stiffness @ free, free.T @ mass @ free, loaded @ free)


@dataclass(frozen=True, eq=False)
class _Joint:
    """Relative twists (6×k, base axes) at `place` that a joint lets happen.

    With their springs and the inertia that moves by them (k each).
    """

    first: Side
    second: Side
    place: Array
    motions: Array
    springs: Array
    inertias: Array

    @classmethod
    def of(cls, at: Posture, joint: Joint, *, simplified: bool) -> "_Joint":
        turned, _ = _turned(at, joint)
        motions, springs, inertias = [], [], []
        for number, twist in enumerate(_free(at, joint).T):
            stiffness: float | None = 0.0
            inertia = 0.0
            if joint.drive is not None and number == 0:
                special = joint.drive.simplified if simplified else None
                stiffness = joint.drive.stiffness if special is None else special
                inertia = joint.drive.inertia
            if stiffness is not None:
                motions.append(twist)
                springs.append(stiffness)
                inertias.append(inertia)
        if joint.compliance is not None and not simplified:
            # Along eigenvectors of its compliance, in series with all the rest.
            gives, along = np.linalg.eigh(joint.compliance)
            own = block_diag(turned, turned) @ along
            for give, twist in zip(gives, own.T, strict=True):
                if give > 0.0:
                    motions.append(twist)
                    springs.append(1.0 / give)
                    inertias.append(0.0)
        columns = np.array(motions).reshape(len(motions), 6).T
        place = _place(at, joint.first)
        return cls(joint.first, joint.second, place, columns, np.array(springs), np.array(inertias))


def _free(at: Posture, joint: Joint) -> Array:
    """Free relative twists (6×k) by what the kind of joint is, the drive's first."""
    first, second = _turned(at, joint)
    axes = joint.axes @ first.T
    along, about = (
        np.vstack([np.eye(3), np.zeros((3, 3))]),
        np.vstack([np.zeros((3, 3)), np.eye(3)]),
    )
    slide, turn = along @ axes[:1].T, about @ axes[:1].T
    match joint.kind:
        case "fixed":
            free = np.zeros((6, 0))
        case "prismatic":
            free = slide
        case "revolute":
            free = turn
        case "cylindrical":
            free = np.hstack([slide, turn])
        case "universal":
            free = about @ np.column_stack([axes[0], second @ joint.axes[1]])
        case "spherical":
            free = about
        case "planar":
            free = np.hstack([along @ null_space(axes[:1]), turn])
        case _:
            assert_never(joint.kind)
    return free


def _turned(at: Posture, joint: Joint) -> tuple[Array, Array]:
    """Rotations of both bodies since the reference posture."""
    first, second = (
        at.frames[side.body].rotation @ at.mechanism.reference[side.body].rotation.T
        for side in (joint.first, joint.second)
    )
    return first, second


def _place(at: Posture, side: Side) -> Array:
    frame = at.frames[side.body]
    own = at.mechanism.bodies[side.body].interfaces[side.point].position
    return np.asarray(frame.position + frame.rotation @ own)


def _require_closed(at: Posture) -> None:
    """Raise ComputationError where a joint's sides have gone where it does not let them."""
    for joint in at.mechanism.joints:
        if (gap := max(_gaps(at, joint))) > _CLOSED:
            raise ComputationError(f"joint {joint.name}: open by {gap:.2g} in the posture")


def _gaps(at: Posture, joint: Joint) -> tuple[float, float]:
    """Of positions (over the size of the mechanism) and of directions (rad)."""
    first, second = _turned(at, joint)
    apart = (_place(at, joint.second) - _place(at, joint.first)) / at.mechanism.size
    axis = first @ joint.axes[0] if len(joint.axes) else np.zeros(3)
    relative = first.T @ second
    match joint.kind:
        case "prismatic" | "cylindrical":
            apart = np.cross(axis, apart)
        case "planar":
            apart = np.atleast_1d(axis @ apart)
    match joint.kind:
        case "spherical":
            turned = np.zeros(1)
        case "universal":
            angles = joint.axes[0] @ relative @ joint.axes[1] - joint.axes[0] @ joint.axes[1]
            turned = np.atleast_1d(angles)
        case "fixed" | "prismatic":
            turned = (relative - np.eye(3)).ravel()
        case "revolute" | "cylindrical" | "planar":
            turned = (relative - np.eye(3)) @ joint.axes[0]
        case _:
            assert_never(joint.kind)
    return float(np.linalg.norm(apart)), float(np.linalg.norm(turned))
