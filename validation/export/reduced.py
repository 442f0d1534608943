"""A body, or a robot in one pose, as small matrices that other programs take, with their bound.

K q + M q̈ = Σ Pᵀ f: every port P (k×n) is what q moves somewhere, and Pᵀ what a force does there.
Prisms and CAD parts are solids, reduced as in `fem.reduction.craig_bampton`; a leg known by its 6×6
has that, and its mass along it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.linalg import eigh

from fem.reduction.craig_bampton import Truncated, frequency_bounds
from lumped.arrays import Array, dense
from lumped.dense.modes import Modes
from lumped.errors import InputError
from lumped.legs import GivenLeg
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import Side
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.system.assembly import assemble
from lumped.system.joint_motion import Portion
from lumped.system.solution import Solved, modes_with_mass, solved
from validation.models import parts
from validation.models.legs import filled, reduced_superelement
from validation.models.loads.leg_masses import MASSES, Inside, leg_with_inside
from validation.models.mechanism import CUTOFF, constant_legs, with_enough_modes
from validation.models.options import DEFAULT_OPTIONS

TWIST = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
# Of a cut-off: frequencies of a body alone that are spoken of.
_WELL_BELOW = 0.8
# How many modes of a body with its interfaces held, and below which frequency (Hz).
Count: TypeAlias = tuple[int, float]
# A body as a solid, what bounds its reduction, and its modes.
_Solid: TypeAlias = tuple[BodyModel, Truncated, Count]


@dataclass(frozen=True, eq=False)
class Reduced:
    """Stiffness and mass (n×n, SI, symmetric) on the `unknowns` q (n), by name.

    `ports`: rows (6×n twists, 1×n displacements of drives) by name; `points` (3, m) are where the
    twists are, in the axes that `about` names. `frequencies` (m, Hz, ascending) are too high by
    `bounds` (m, Hz) at most, held as `about` says; `counted`: how many modes of a body with its
    interfaces held lie below a frequency (Hz), all of which are kept.
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
    """A robot reduced, and solved: what its state space is made of."""

    matrices: Reduced
    solution: Solved
    modes: Modes


def reduced_body(mechanism: Mechanism, name: str, highest: float) -> Reduced:
    """One body, free, good up to `highest` (Hz); frequencies are those with its first point held.

    Raises InputError where it is neither a prism nor a part, ComputationError where it cannot be
    meshed or solved.
    """
    solids = dict(_solids(mechanism, highest, only=name))
    if name not in solids:
        known = "a rigid body" if name not in legs_of(mechanism) else "known by its 6×6 alone"
        raise InputError(f"--body {name}: is {known}; must be a leg with a section, or a CAD part")
    model, truncated, kept = solids[name]
    stiffness, mass = dense(model.stiffness), dense(model.mass)
    held = slice(6, None)

    def squares(softer: Array, heavier: Array) -> Array:
        loose = (stiffness + softer)[held, held], (mass + heavier)[held, held]
        return np.asarray(eigh(*loose, eigvals_only=True))

    none = np.zeros_like(stiffness)
    upper = squares(none, none)
    upper = upper[np.sqrt(upper) < 2.0 * np.pi * _WELL_BELOW * truncated.cutoff]
    lower = [squares(*truncated.loosened(one))[j] for j, one in enumerate(upper)]
    frequencies = np.sqrt(upper) / (2.0 * np.pi)
    points = {key: frame.position for key, frame in mechanism.bodies[name].interfaces.items()}
    twists = [f"{point} {way}" for point in points for way in TWIST]
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
        counted={name: kept},
    )


def reduced_robot(posture: Posture, count: int) -> ReducedRobot:
    """The robot about one pose, good for its first `count` frequencies, as many as have mass.

    Raises InputError and ComputationError as `reduced_body` does.
    """
    mechanism = posture.mechanism

    legs = legs_of(mechanism)
    given = {name: leg for name, leg in legs.items() if isinstance(leg, GivenLeg)}

    def solve(highest: float) -> tuple[Solved, Modes, dict[str, _Solid]]:
        solids = dict(_solids(mechanism, highest))
        models: dict[str, BodyModel] = {name: model for name, (model, _, _) in solids.items()}
        for name, leg in given.items():
            models[name] = leg_with_inside(leg, Inside(MASSES[0]), highest)
        solution = solved(assemble(posture, models))
        return solution, modes_with_mass(solution, count), solids

    solution, modes, solids = with_enough_modes(
        solve, lambda found: found[1].frequencies, [posture], count
    )
    system = solution.system
    found = modes.frequencies
    bounds = np.zeros_like(found)
    if solids and len(found):
        truncated = {name: one for name, (_, one, _) in solids.items()}
        bounds = found - frequency_bounds(system, truncated, len(found)).lower
    drives = {
        f"drive {joint.name}": system.motions.springs[Portion(joint.name, "drive")]
        / np.sqrt(joint.drive.stiffness)
        for joint in mechanism.joints
        if joint.drive is not None and joint.drive.stiffness is not None
    }
    inside = np.zeros((1, system.size - system.outer))
    pose = shown_pose(mechanism, posture.pose) or "the reference posture"
    masses = ", legs known by their 6×6 with their mass along them" if given else ""
    matrices = Reduced(
        name=mechanism.name,
        about=f"robot at {pose}, base axes, legs and parts solid{masses}; frequencies as it stands",
        unknowns=tuple(str(i + 1) for i in range(system.size)),
        stiffness=dense(system.stiffness),
        mass=dense(system.mass),
        ports={
            **{name: np.hstack([rows, inside]) for name, rows in drives.items()},
            "tool": system.tool,
        },
        points={
            "tool": interface_position(posture, Side(mechanism.tool.body, mechanism.tool.point))
        },
        frequencies=found,
        bounds=bounds,
        counted={name: kept for name, (_, _, kept) in solids.items()},
    )
    return ReducedRobot(matrices, solution, modes)


def _solids(
    mechanism: Mechanism, highest: float, only: str | None = None
) -> Iterator[tuple[str, _Solid]]:
    """Every prism and part good up to `highest` (Hz), or `only` one."""
    cutoff, described = CUTOFF["solid"] * highest, legs_of(mechanism)
    for name, leg, own in constant_legs(mechanism, DEFAULT_OPTIONS):
        if only in {None, name} and not isinstance(described[name], GivenLeg):
            found = reduced_superelement("solid", leg, own, highest, cutoff)
            yield name, (filled(found.matrices), found, (len(found.frequencies), cutoff))
    for name, body in mechanism.parts.items():
        if only in {None, name}:
            part = parts.reduced(body, highest, cutoff)
            yield name, (part, part, (part.counted, part.cutoff))
