"""The whole robot from its legs, whatever model a leg is: feet, revolute joints, platform.

Unknowns of the robot: platform (6, at B), tool (6, with a tool spring), foot 1 and foot 2 (6 each,
unless rigid), the absolute rotations φz of both leg roots and of leg 2's tip, then the legs'
internal unknowns. All but the internal ones are in robot axes. A revolute joint about z is exact:
its two sides share five components and have a φz each, which is what static condensation of a
spring's φz gives.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy.sparse import block_diag, coo_matrix, csr_matrix, identity

from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.biglide import Biglide
from lumped.leg_matrices import LegMatrices
from lumped.modes import Modes, solve_modes
from lumped.screws import shift, turn
from lumped.segments import printed_release
from lumped.statics import flexibility

Release: TypeAlias = Literal["condensed", "printed"]


@dataclass(frozen=True)
class Mechanism:
    """Stiffness and mass of the robot in one posture, n unknowns, SI.

    `loaded` (6×n) gives the twist of the loaded point P in robot axes, `legs` the two sparse
    matrices from robot unknowns to each leg's own (leg axes). `springs` holds the stiffness of
    the elastic parts beside the legs ("foot 1", "foot 2", "tool").
    """

    name: str
    stiffness: SparseMatrix
    mass: SparseMatrix
    loaded: SparseMatrix
    legs: tuple[SparseMatrix, ...]
    springs: Mapping[str, SparseMatrix]

    @property
    def turned(self) -> int:
        """How many unknowns come first that are vectors of three in robot axes: the bodies'."""
        return 6 * (1 + len(self.springs))


def assemble(
    robot: Biglide, x: float, leg1: LegMatrices, leg2: LegMatrices, release: Release = "condensed"
) -> Mechanism:
    """The robot with B at `x` (m), from two legs in their own axes.

    `release`: "condensed" joins feet and legs by exact revolute joints; "printed" zeroes row and
    column of φz of the foot's stiffness as eq. (25) prints it and shares all six components at B
    (leg 2 then carries the printed joint itself, `segments.with_printed_tip_joint`).
    Raises InputError for x outside the stroke.
    """
    posture = robot.posture(x)
    unknowns = _Unknowns(robot, leg1, leg2, release)
    size = unknowns.size
    ends = zip((leg1, leg2), (posture.rotation1, posture.rotation2), (0, 1), strict=True)
    maps = tuple(_leg_map(leg, rotation, unknowns, which) for leg, rotation, which in ends)
    stiffness = sum(t.T @ leg.stiffness @ t for t, leg in zip(maps, (leg1, leg2), strict=True))
    mass = sum(t.T @ leg.mass @ t for t, leg in zip(maps, (leg1, leg2), strict=True))
    springs = _springs(robot, unknowns, release)
    loaded = _loaded(robot, unknowns)
    platform_mass = np.diag([robot.platform_mass] * 3 + [0.0] * 3)
    return Mechanism(
        name=f"{robot.name} at x = {x:g} m",
        stiffness=csr_matrix(stiffness + sum(springs.values(), csr_matrix((size, size)))),
        mass=csr_matrix(mass + loaded.T @ csr_matrix(platform_mass) @ loaded),
        loaded=loaded,
        legs=maps,
        springs=springs,
    )


def compliance(mechanism: Mechanism) -> Array:
    """6×6 compliance (SI, robot axes) at the loaded point.

    Dense: for models of up to about 2000 unknowns.

    Raises ComputationError where a part of the robot is free to move.
    """
    wrenches = mechanism.loaded.toarray().T
    return flexibility(mechanism.stiffness, wrenches, mechanism.name)


def modes(mechanism: Mechanism, count: int) -> Modes:
    """The lowest `count` modes of the robot (shapes in robot unknowns); dense."""
    return solve_modes(mechanism.stiffness, mechanism.mass, count, mechanism.name)


class _Unknowns:
    """Numbering of the robot's unknowns; a held component has number −1."""

    def __init__(
        self, robot: Biglide, leg1: LegMatrices, leg2: LegMatrices, release: Release
    ) -> None:
        self.platform = np.arange(6)
        self.size = 6
        self.tool = self._new(6) if robot.tool_compliance is not None else self.platform
        held = np.full(6, -1)
        rigid_feet = robot.foot_compliance is None
        self.feet = tuple(held if rigid_feet else self._new(6) for _ in range(2))
        # In the printed variant the foot's spring, without its φz, acts on the leg's root itself.
        shared_root = release == "printed" and not rigid_feet
        self.roots = tuple(foot if shared_root else self._released(foot) for foot in self.feet)
        tip2 = self.platform if release == "printed" else self._released(self.platform)
        self.tips = (self.platform, tip2)
        self.inner = tuple(self._new(leg.size - 12) for leg in (leg1, leg2))

    def _new(self, count: int) -> IntArray:
        numbers = np.arange(self.size, self.size + count)
        self.size += count
        return numbers

    def _released(self, body: IntArray) -> IntArray:
        return np.concatenate([body[:5], self._new(1)])


def _leg_map(leg: LegMatrices, rotation: Array, unknowns: _Unknowns, which: int) -> SparseMatrix:
    """Sparse matrix from robot unknowns to the leg's own, in leg axes."""
    to_leg_axes = turn(rotation).T
    numbers = [unknowns.roots[which], unknowns.tips[which], unknowns.inner[which]]
    turned = block_diag([to_leg_axes, to_leg_axes, identity(leg.size - 12)], format="csr")
    return csr_matrix(turned @ _select(np.concatenate(numbers), unknowns.size))


def _select(numbers: IntArray, size: int) -> SparseMatrix:
    """Rows of the identity for `numbers`; a zero row for a held component."""
    kept = np.flatnonzero(numbers >= 0)
    return csr_matrix(
        coo_matrix((np.ones(len(kept)), (kept, numbers[kept])), shape=(len(numbers), size))
    )


def _loaded(robot: Biglide, unknowns: _Unknowns) -> SparseMatrix:
    """6×n matrix to the twist of the loaded point: the tool's, or the platform's moved to P."""
    if robot.tool_compliance is not None:
        return _select(unknowns.tool, unknowns.size)
    return csr_matrix(shift(robot.tool_offset)) @ _select(unknowns.platform, unknowns.size)


def _springs(robot: Biglide, unknowns: _Unknowns, release: Release) -> dict[str, SparseMatrix]:
    """Stiffness of the feet and of the tool on the robot's unknowns."""
    springs: dict[str, SparseMatrix] = {}
    size = unknowns.size
    if robot.foot_compliance is not None:
        foot: Array = np.linalg.inv(robot.foot_compliance).astype(float)
        if release == "printed":
            foot = printed_release(foot)
        for number, where in enumerate(unknowns.feet, start=1):
            select = _select(where, size)
            springs[f"foot {number}"] = select.T @ csr_matrix(foot) @ select
    if robot.tool_compliance is not None:
        platform = csr_matrix(shift(robot.tool_offset)) @ _select(unknowns.platform, size)
        deflection = _select(unknowns.tool, size) - platform
        tool = csr_matrix(np.linalg.inv(robot.tool_compliance))
        springs["tool"] = deflection.T @ tool @ deflection
    return springs
