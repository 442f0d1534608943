"""Centre lines of legs: straight pieces and circular arcs from root to tip, in leg axes.

A leg's x axis points from its root to its tip, and so its centre line starts at the origin and ends
on the x axis. The axes of its sections follow the line: x along the tangent, z as close to one
direction `up` as possible.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.screws import rotation_about

Point: TypeAlias = tuple[float, float, float]

# Distance of `through` from the chord, over the chord, below which an arc counts as straight.
_STRAIGHT = 1e-9
# Sine of the angle below which the tangent is parallel to `up`.
SMALLEST_SINE = 1e-3
# Cosine of the largest angle between tangents of smooth pieces, 0.1°.
_SMOOTH = np.cos(np.radians(0.1))
# Number of points per piece at which a search for the nearest one starts, and Newton's steps.
_SEARCHED, _STEPS = 33, 20


@dataclass(frozen=True)
class LinePiece:
    """Piece of a centre line from `start` to `end` (m): straight, or an arc through `through`."""

    start: Point
    end: Point
    through: Point | None = None

    @cached_property
    def _rotation(self) -> tuple[Array, Array, float]:
        """Centre (3, in m), axis (unit vector) and angle (rad, up to 2π) of an arc.

        The angle of a straight piece is zero.
        """
        if self.through is None:
            return np.zeros(3), np.zeros(3), 0.0
        start, through, end = map(np.array, (self.start, self.through, self.end))
        a, b = through - start, end - start
        normal = np.cross(a, b)
        squared = float(normal @ normal)
        if squared <= (_STRAIGHT * float(b @ b)) ** 2:
            return np.zeros(3), np.zeros(3), 0.0
        # Centre of the circle through three points.
        to_centre = np.cross((a @ a) * b - (b @ b) * a, normal) / (2.0 * squared)
        radial, last = -to_centre, b - to_centre
        axis = normal / np.sqrt(squared)
        angle = float(np.arctan2(axis @ np.cross(radial, last), radial @ last))
        return start + to_centre, axis, angle % (2.0 * np.pi)

    @cached_property
    def length(self) -> float:
        """Length (m) of the piece along the centre line."""
        centre, _, angle = self._rotation
        radius = float(np.linalg.norm(np.array(self.start) - centre))
        return angle * radius if angle else float(np.linalg.norm(self._chord))

    @property
    def radius(self) -> float:
        """Radius (m) of an arc. Infinite for a straight piece."""
        angle = self._rotation[2]
        return self.length / angle if angle else np.inf

    @property
    def _chord(self) -> Array:
        return np.asarray(np.subtract(self.end, self.start))

    def at(self, shares: Array) -> tuple[Array, Array]:
        """Points (n×3, in m) and unit tangents (n×3) at n fractions `shares` of the length."""
        start = np.array(self.start)
        centre, axis, angle = self._rotation
        if not angle:
            tangent = self._chord / np.linalg.norm(self._chord)
            points = start + shares[:, None] * self._chord
            return points, np.broadcast_to(tangent, points.shape)
        turned = rotation_about(angle * shares[:, None] * axis)
        radial = turned @ (start - centre)
        return centre + radial, np.cross(axis, radial) / np.linalg.norm(start - centre)

    @cached_property
    def turning(self) -> Array:
        """Rotation vector of the tangent per length (3, in rad/m). Zero for a straight piece."""
        _, axis, angle = self._rotation
        return axis * (angle / self.length)


def point_of(vector: Array) -> Point:
    """Coordinates of a position vector (3) as a tuple."""
    x, y, z = vector.tolist()
    return x, y, z


def straight_line(length: float) -> "CentreLine":
    """Centre line of a straight leg of `length` (m): the x axis."""
    return CentreLine((LinePiece((0.0, 0.0, 0.0), (length, 0.0, 0.0)),), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class CentreLine:
    """Centre line of a leg (m, leg axes), and the direction `up` for the z axes of its sections."""

    pieces: tuple[LinePiece, ...]
    up: Point

    @cached_property
    def ends(self) -> Array:
        """Positions (p+1, in m along the line) of the ends of the pieces."""
        return np.concatenate([[0.0], np.cumsum([piece.length for piece in self.pieces])])

    @property
    def length(self) -> float:
        """Length (m) of the centre line from root to tip."""
        return float(self.ends[-1])

    @property
    def is_straight(self) -> bool:
        """True if the centre line is the x axis of the leg."""
        return self.length <= self.chord * (1.0 + _STRAIGHT)

    @property
    def chord(self) -> float:
        """Straight distance (m) from root to tip."""
        first, last = np.array(self.pieces[0].start), np.array(self.pieces[-1].end)
        return float(np.linalg.norm(last - first))

    @cached_property
    def turns(self) -> dict[int, float]:
        """Angle (rad) by which the direction of the line jumps at each corner.

        The keys are the indices of the pieces that begin at the corners.
        """
        turns = {}
        for number, (first, second) in enumerate(pairwise(self.pieces), start=1):
            before, after = first.at(np.ones(1))[1][0], second.at(np.zeros(1))[1][0]
            if float(before @ after) < _SMOOTH:
                sine = float(np.linalg.norm(np.cross(before, after)))
                turns[number] = float(np.arctan2(sine, before @ after))
        return turns

    @property
    def corners(self) -> tuple[float, ...]:
        """Positions (m along the line) at which the direction of the line jumps."""
        return tuple(float(self.ends[number]) for number in self.turns)

    def corner_axes(self, number: int) -> tuple[Array, Array]:
        """Axes of the sections (3×3 each) before and after the corner at which a piece begins.

        `number` is the index of the piece.
        """
        position = np.repeat(self.ends[number], 2)
        before, after = self.frames(position, np.array([number - 1, number]))[1]
        return before, after

    def mitre(self, number: int) -> tuple[Array, Array]:
        """Slopes (2 each) of the plane that bisects a corner, in the sections before and after it.

        A point (y, z) of a section at the corner lies in the plane if it is moved along its own
        piece of the line by the scalar product of (y, z) and the slopes. `number` is the index of
        the piece that begins at the corner.
        """
        before, after = self.corner_axes(number)
        normal = before[:, 0] + after[:, 0]
        first, second = (-(normal @ axes)[1:] / (normal @ axes)[0] for axes in (before, after))
        return first, second

    @property
    def run_ends(self) -> Array:
        """Positions (r+1, in m along the line) of the ends of the r parts between corners."""
        return np.array([0.0, *self.corners, self.length])

    def pieces_in_runs(self, positions: Array, runs: IntArray) -> IntArray:
        """Index of the piece at each of n `positions` (m along the line).

        `runs` (n) are the indices of the parts between corners to which the positions belong. They
        select the side of a corner.
        """
        firsts = np.array([0, *self.turns])
        lasts = np.append(firsts[1:], len(self.pieces)) - 1
        return np.clip(self.piece_at(positions), firsts[runs], lasts[runs])

    @property
    def smallest_radius(self) -> float:
        """Radius (m) of the tightest arc. Infinite if the line has no arcs."""
        return min(piece.radius for piece in self.pieces)

    def part(self, start: float, end: float) -> tuple[LinePiece, ...]:
        """Pieces (leg axes) of the line between two positions (m along the line), in order."""
        pieces = []
        for piece, first, last in zip(self.pieces, self.ends, self.ends[1:], strict=False):
            begin, finish = max(start, float(first)), min(end, float(last))
            if finish - begin <= _STRAIGHT * self.length:
                continue
            shares = (np.linspace(begin, finish, 3) - first) / piece.length
            root, middle, tip = (point_of(point) for point in piece.at(shares)[0])
            pieces.append(LinePiece(root, tip, middle if piece.turning.any() else None))
        return tuple(pieces)

    def piece_at(self, positions: Array) -> IntArray:
        """Index of the piece at each of n `positions` (m along the line).

        A position at which two pieces meet belongs to the second of them. The end of the line
        belongs to the last piece.
        """
        numbers = np.searchsorted(self.ends, positions, side="right") - 1
        return np.clip(numbers, 0, len(self.pieces) - 1)

    def frames(self, positions: Array, pieces: IntArray | None = None) -> tuple[Array, Array]:
        """Points (n×3, in m) and axes of the sections (n×3×3) at n `positions` (m along the line).

        Both are in leg axes. The columns of a 3×3 matrix are the x, y and z axis of a section.
        `pieces` (n) are the indices of the pieces to which the positions belong. If it is None,
        `piece_at` determines them.
        """
        positions = np.asarray(positions, dtype=float)
        numbers = self.piece_at(positions) if pieces is None else pieces
        points, tangents = np.empty((len(positions), 3)), np.empty((len(positions), 3))
        for number, piece in enumerate(self.pieces):
            on_piece = numbers == number
            shares = (positions[on_piece] - self.ends[number]) / piece.length
            points[on_piece], tangents[on_piece] = piece.at(shares)
        y = np.cross(np.array(self.up), tangents)
        y /= np.linalg.norm(y, axis=1)[:, None]
        return points, np.stack([tangents, y, np.cross(tangents, y)], axis=2)

    def curvatures(self, axes: Array, pieces: IntArray) -> Array:
        """Components (n×2, in 1/m) of the line's curvature along the y and z axes of n sections.

        `axes` (n×3×3, columns) are the axes of the sections. `pieces` (n) are the indices of the
        pieces of the line on which the sections lie.
        """
        turning = np.array([piece.turning for piece in self.pieces])[pieces]
        change = np.cross(turning, axes[:, :, 0])
        return np.asarray(np.einsum("ni,nij->nj", change, axes[:, :, 1:]))

    @property
    def smallest_sine(self) -> float:
        """Smallest sine, over the whole line, of the angle between `up` and the tangent."""
        samples = np.concatenate(
            [piece.at(np.linspace(0.0, 1.0, _SEARCHED))[1] for piece in self.pieces]
        )
        up = np.array(self.up) / np.linalg.norm(self.up)
        return float(np.linalg.norm(np.cross(samples, up), axis=1).min())

    def nearest(self, points: Array) -> Array:
        """Positions (n, in m along the line) nearest to `points` (n×3, in m, leg axes)."""
        shares = np.linspace(0.0, 1.0, _SEARCHED)
        best, distances = np.zeros(len(points)), np.full(len(points), np.inf)
        for piece, start in zip(self.pieces, self.ends, strict=False):
            samples, _ = piece.at(shares)
            share = shares[
                np.argmin(np.linalg.norm(points[:, None] - samples[None], axis=2), axis=1)
            ]
            for _ in range(_STEPS):
                foot, tangent = piece.at(share)
                step = np.einsum("ij,ij->i", points - foot, tangent) / piece.length
                share = np.clip(share + step, 0.0, 1.0)
            distance = np.linalg.norm(points - piece.at(share)[0], axis=1)
            closer = distance < distances - _STRAIGHT * self.length
            best[closer] = start + share[closer] * piece.length
            distances[closer] = distance[closer]
        return best
