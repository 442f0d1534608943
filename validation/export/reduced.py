"""Reduced matrices of a body, or of a robot in one pose, with bounds on frequency errors.

Input: a mechanism and the number of frequencies. Output: K and M in K q + M q̈ = Σ Pᵀ f, with ports
P. Each port P (k×n) maps q to the motion of a point or of a drive, and Pᵀ maps a wrench or a drive
force f to forces on q. Rule: prisms and CAD parts are solids, reduced as in
`fem.reduction.craig_bampton`. A leg specified by its 6×6 has this compliance, and its mass along
the leg.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.linalg import eigh

from fem.reduction.craig_bampton import Truncated, craig_bampton, frequency_bounds
from lumped.arrays import Array, dense
from lumped.dense.modes import Modes
from lumped.errors import InputError
from lumped.legs import GivenLeg
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.free_twists import drive_in, interface_position
from lumped.mechanism.joint import Side
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.system.assembly import assemble
from lumped.system.joint_motion import Portion
from lumped.system.solution import Solved, modes_with_mass, solved
from validation.models import reduced_parts
from validation.models.leg_models import filled, leg_with_held_ends
from validation.models.loads.leg_masses import MASSES, Inside, leg_with_inside
from validation.models.options import DEFAULT_OPTIONS
from validation.models.robot_bodies import CUTOFF, sectioned_legs
from validation.models.robot_models import with_enough_modes

TWIST = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
# Fraction of the cut-off frequency up to which frequencies of a free body are exported.
_HIGHEST_SHARE = 0.8
# Number of modes of a body with fixed interfaces, and the frequency (Hz) below which they lie.
Count: TypeAlias = tuple[int, float]
# Solid model of a body, its reduction with error bounds, and its number of modes.
_Solid: TypeAlias = tuple[BodyModel, Truncated, Count]


@dataclass(frozen=True, eq=False)
class Reduced:
    """Reduced stiffness and mass (n×n, SI, symmetric) for n named `unknowns` q.

    `ports`: matrices by name from q to twists (6×n) or to displacements of drives (1×n). `points`
    (3, m): points of the twists. `about`: text on the axes and on the end conditions of the
    `frequencies` (k, Hz, ascending). The frequencies are too high by at most `bounds` (k, Hz).
    `counted`: for each body, the number of modes with all interfaces fixed and the frequency (Hz)
    below which all of them are kept.
    """

    name: str
    about: str
    unknowns: tuple[str, ...]
    stiffness: Array
    mass: Array
    ports: Mapping[str, Array]
    points: Mapping[str, Array]
    frequencies: Array
    bounds: Array
    counted: Mapping[str, Count]


@dataclass(frozen=True, eq=False)
class ReducedRobot:
    """Reduced matrices of a robot, with its solution and modes for the state space."""

    matrices: Reduced
    solution: Solved
    modes: Modes


def reduced_body(mechanism: Mechanism, name: str, highest: float) -> Reduced:
    """Reduced free body, accurate up to `highest` (Hz).

    Its `frequencies` have the first interface clamped. Raises InputError if the body is neither a
    prism nor a CAD part, and ComputationError if it cannot be meshed or solved.
    """
    solids = dict(_solids(mechanism, highest, only=name))
    if name not in solids:
        kind = (
            "a rigid body"
            if name not in legs_of(mechanism)
            else "a leg specified by its 6×6 compliance"
        )
        raise InputError(f"--body {name}: is {kind}; must be a leg with a section, or a CAD part")
    model, truncated, count = solids[name]
    stiffness, mass = dense(model.stiffness), dense(model.mass)
    clamped = slice(6, None)

    def eigenvalues(added_stiffness: Array, added_mass: Array) -> Array:
        changed_stiffness = (stiffness + added_stiffness)[clamped, clamped]
        changed_mass = (mass + added_mass)[clamped, clamped]
        return np.asarray(eigh(changed_stiffness, changed_mass, eigvals_only=True))

    zeros = np.zeros_like(stiffness)
    upper = eigenvalues(zeros, zeros)
    upper = upper[np.sqrt(upper) < 2.0 * np.pi * _HIGHEST_SHARE * truncated.cutoff]
    lower = [eigenvalues(*truncated.loosened(value))[j] for j, value in enumerate(upper)]
    frequencies = np.sqrt(upper) / (2.0 * np.pi)
    points = {key: frame.position for key, frame in mechanism.bodies[name].interfaces.items()}
    twists = [f"{point} {component}" for point in points for component in TWIST]
    ports = np.eye(len(stiffness))[: len(twists)].reshape(len(points), 6, -1)
    first = next(iter(points))
    return Reduced(
        name=f"{mechanism.name}, {name}",
        about=f"free body in its own axes, solid; frequencies with {first} clamped",
        unknowns=(*twists, *(f"mode {i + 1}" for i in range(len(stiffness) - len(twists)))),
        stiffness=stiffness,
        mass=mass,
        ports=dict(zip(points, ports, strict=True)),
        points=points,
        frequencies=frequencies,
        bounds=np.maximum(0.0, frequencies - np.sqrt(lower) / (2.0 * np.pi)),
        counted={name: count},
    )


def reduced_robot(posture: Posture, count: int) -> ReducedRobot:
    """Reduced robot about one pose, accurate for its first `count` frequencies.

    There are fewer frequencies if fewer modes move mass. Raises the exceptions of `reduced_body`.
    """
    mechanism = posture.mechanism

    legs = legs_of(mechanism)
    six_by_six_legs = {name: leg for name, leg in legs.items() if isinstance(leg, GivenLeg)}

    def solve(highest: float) -> tuple[Solved, Modes, dict[str, _Solid]]:
        solids = dict(_solids(mechanism, highest))
        models: dict[str, BodyModel] = {name: model for name, (model, _, _) in solids.items()}
        for name, leg in six_by_six_legs.items():
            models[name] = leg_with_inside(leg, Inside(MASSES[0]), highest)
        solution = solved(assemble(posture, models))
        return solution, modes_with_mass(solution, count), solids

    solution, modes, solids = with_enough_modes(
        solve, lambda solved_robot: solved_robot[1].frequencies, [posture], count
    )
    system = solution.system
    frequencies = modes.frequencies
    bounds = np.zeros_like(frequencies)
    if solids and len(frequencies):
        truncated = {name: reduction for name, (_, reduction, _) in solids.items()}
        bounds = frequencies - frequency_bounds(system, truncated, len(frequencies)).lower
    drives = {
        f"drive {joint.name}": system.motions.springs[Portion(joint.name, "drive")]
        / np.sqrt(drive.stiffness)
        for joint in mechanism.joints
        if (drive := drive_in(posture, joint)) is not None and drive.stiffness is not None
    }
    # Drive ports are zero for the inner unknowns of bodies.
    inner_zeros = np.zeros((1, system.size - system.outer))
    pose = shown_pose(mechanism, posture.pose) or "the reference posture"
    masses = (
        ", legs specified by a 6×6 compliance with their mass along them" if six_by_six_legs else ""
    )
    matrices = Reduced(
        name=mechanism.name,
        about=(
            f"robot at {pose}, base axes, legs and parts as solids{masses}; frequencies of "
            "the supported robot"
        ),
        unknowns=tuple(str(i + 1) for i in range(system.size)),
        stiffness=dense(system.stiffness),
        mass=dense(system.mass),
        ports={
            **{name: np.hstack([rows, inner_zeros]) for name, rows in drives.items()},
            "tool": system.tool,
        },
        points={
            "tool": interface_position(posture, Side(mechanism.tool.body, mechanism.tool.point))
        },
        frequencies=frequencies,
        bounds=bounds,
        counted={name: body_count for name, (_, _, body_count) in solids.items()},
    )
    return ReducedRobot(matrices, solution, modes)


def _solids(
    mechanism: Mechanism, highest: float, only: str | None = None
) -> Iterator[tuple[str, _Solid]]:
    """Prisms and CAD parts as solids, accurate up to `highest` (Hz), by name.

    If `only` is not None, only the body with this name.
    """
    cutoff, legs = CUTOFF["solid"] * highest, legs_of(mechanism)
    for name, leg, options in sectioned_legs(mechanism, DEFAULT_OPTIONS):
        if only in {None, name} and not isinstance(legs[name], GivenLeg):
            reduced = craig_bampton(leg_with_held_ends("solid", leg, options), highest, cutoff)
            yield name, (filled(reduced.matrices), reduced, (len(reduced.frequencies), cutoff))
    for name, body in mechanism.parts.items():
        if only in {None, name}:
            part = reduced_parts.reduced(body, highest, cutoff)
            yield name, (part, part, (part.counted, part.cutoff))
