"""A free leg as a chain of rigid segments joined by 6-DOF springs, eqs (13)–(23) of the paper.

A spring between two rigid elements represents the piece of the beam between their centres. Referred
to the middle of that piece, its compliance is diagonal if the section has two axes of symmetry. A
leg of length L is divided into n equal elements in one of two layouts:

  half     Springs for pieces of length L/n lie between elements, and springs for pieces of length
           L/2n at both ends of the leg. Frequencies converge with second order in 1/n. Static
           displacements are exact for every n.
  literal  This is the layout in the text of §3.2. Springs lie between elements only. The first and
           the last element are rigidly connected to the ends of the leg, so that a length L/n of
           the leg is rigid. Frequencies and displacements converge with first order in 1/n.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.beam_properties import BeamProperties
from lumped.centre_line import CentreLine
from lumped.errors import InputError
from lumped.line_sections import LineSections
from lumped.mechanism.body_model import LegMatrices
from lumped.model_choices import Layout
from lumped.screws import shift
from lumped.system.joint_motion import printed_release

_ALONG = np.array([1.0, 0.0, 0.0])
# Twist components of each kind of deformation, for a spring referred to the middle of its piece.
KINDS = {"tension": (0,), "torsion": (3,), "bending y": (2, 4), "bending z": (1, 5)}


@dataclass(frozen=True, eq=False)
class SegmentChain:
    """Chain of b rigid bodies from the root of a leg to its tip, with springs between neighbours.

    The bodies are the rigid elements and, in the layout "half", the massless ends of the leg. All
    data are in leg axes and SI units. `points` (b×3) are the reference points of the bodies, at
    `stations` (b, in m along the leg). `masses` (b×6×6) are the mass matrices at these points.
    `springs_at` ((b−1)×3) are the reference points of the springs, whose `stiffnesses` ((b−1)×6×6)
    act on the relative twists at these points. `length` is the straight distance (m) from root to
    tip. `line` is the centre line, None if it is the x axis.
    """

    length: float
    stations: Array
    points: Array
    masses: Array
    springs_at: Array
    stiffnesses: Array
    line: CentreLine | None = None

    @property
    def tip(self) -> Array:
        """Position (3, in m) of the tip of the chain."""
        return self.length * _ALONG


def segment_chain(
    properties: BeamProperties, length: float, elements: int, layout: Layout = "half"
) -> SegmentChain:
    """Chain of `elements` equal rigid elements for a prismatic leg of `length` (m).

    Raises InputError if there are fewer elements than the layout needs: one for "half", two for
    "literal".
    """
    layout_stations = _stations(length, elements, layout)
    piece = length / elements
    masses = np.tile(_element_mass(properties, piece), (elements, 1, 1))
    pieces: Array = np.full(len(layout_stations.springs), piece, dtype=float)
    if layout == "half":
        pieces[[0, -1]] = piece / 2.0
    centres, points, springs_at = (
        np.multiply.outer(stations, _ALONG)
        for stations in (
            layout_stations.centres,
            layout_stations.bodies,
            layout_stations.springs,
        )
    )
    return SegmentChain(
        length=length,
        stations=layout_stations.bodies,
        points=points,
        masses=_body_masses(masses, centres, points),
        springs_at=springs_at,
        stiffnesses=np.array([_spring(properties, part) for part in pieces]),
    )


def line_segment_chain(
    sections: LineSections, elements: int, layout: Layout = "half"
) -> SegmentChain:
    """Chain of `elements` rigid elements, equally long along a leg's centre line.

    Each spring has the flexibility of the piece of the line between the centres of two elements, or
    between an end of the leg and the nearest centre. Static displacements of the layout "half" are
    therefore exact for any taper, step, corner and arc. Raises InputError under the conditions of
    `segment_chain`.
    """
    line = sections.line
    layout_stations = _stations(line.length, elements, layout)
    centres, points, springs_at = (
        line.frames(stations)[0]
        for stations in (
            layout_stations.centres,
            layout_stations.bodies,
            layout_stations.springs,
        )
    )
    edges = np.linspace(0.0, line.length, elements + 1)
    stiffnesses = np.linalg.inv(sections.compliances(layout_stations.spring_ends, springs_at))
    return SegmentChain(
        length=line.chord,
        stations=layout_stations.bodies,
        points=points,
        masses=_body_masses(sections.masses(edges, centres), centres, points),
        springs_at=springs_at,
        stiffnesses=0.5 * (stiffnesses + stiffnesses.swapaxes(1, 2)),
        line=line,
    )


class _Stations(NamedTuple):
    """Positions (m along a leg) of the parts of a chain, in order from root to tip.

    `centres` (n) are those of the element centres, `bodies` (b) and `springs` (b − 1) those of the
    reference points. `spring_ends` (b) are the ends of the pieces that the springs represent.
    """

    centres: Array
    bodies: Array
    springs: Array
    spring_ends: Array


def _stations(length: float, elements: int, layout: Layout) -> _Stations:
    least = 1 if layout == "half" else 2
    if elements < least:
        raise InputError(f"elements = {elements}: the {layout} layout needs {least} or more")
    piece = length / elements
    centres: Array = np.asarray((np.arange(elements) + 0.5) * piece, dtype=float)
    if layout == "half":
        ends = bodies = np.array([0.0, *centres, length])
    else:
        # The end elements are referred to the ends of the leg, to which joints are attached.
        ends, bodies = centres, np.array([0.0, *centres[1:-1], length])
    return _Stations(centres, bodies, 0.5 * (ends[1:] + ends[:-1]), ends)


def _body_masses(masses: Array, centres: Array, points: Array) -> Array:
    """Mass matrices (b×6×6) at the reference `points` (b×3) of the bodies of a chain.

    `masses` (n×6×6) are those of the elements, at their `centres` (n×3). If b = n + 2, the first
    and the last body are the massless ends of the leg.
    """
    if len(points) > len(centres):
        return np.pad(masses, ((1, 1), (0, 0), (0, 0)))
    levers = shift(centres - points)
    return np.asarray(levers.swapaxes(1, 2) @ masses @ levers)


def _spring(properties: BeamProperties, piece: float) -> Array:
    """6×6 stiffness (SI) of the spring for a piece of a leg of length `piece` (m).

    It is referred to the middle of the piece.
    """
    compliance = properties.piece_compliance(piece)
    if properties.couples_bending or properties.couples_torsion or properties.is_helical:
        stiffness = np.linalg.inv(compliance)
        return np.asarray(0.5 * (stiffness + stiffness.T))
    return np.diag(1.0 / np.diag(compliance))


def _element_mass(properties: BeamProperties, piece: float) -> Array:
    """6×6 mass matrix of a rigid prismatic element of length `piece` (m), about its centre."""
    slender = properties.mu * piece**3 / 12.0
    return np.asarray(properties.section_mass * piece + np.diag([0.0] * 4 + [slender] * 2))


def with_printed_tip_joint(chain: SegmentChain) -> SegmentChain:
    """Chain with a revolute joint about z at the tip, released by eq. (25) as printed.

    Row and column φz of the stiffness of the last spring, referred to the tip, are set to zero. If
    this stiffness couples φz to y, the result differs from a revolute joint: it is too stiff along
    y (see the errata of the paper).
    """
    printed = printed_release(_last_at_tip(chain))
    return replace(
        chain,
        springs_at=np.vstack([chain.springs_at[:-1], chain.tip]),
        stiffnesses=np.concatenate([chain.stiffnesses[:-1], printed[None]]),
    )


def _last_at_tip(chain: SegmentChain) -> Array:
    """Stiffness (6×6) of the last spring, referred to the tip."""
    lever = shift(chain.springs_at[-1] - chain.tip)
    at_tip: Array = lever.T @ chain.stiffnesses[-1] @ lever
    return at_tip


def segment_leg(chain: SegmentChain) -> LegMatrices:
    """Stiffness and mass matrices of a leg that is modelled as a chain, eqs (13)–(23).

    The unknowns are the twist of the first body at the root (6), that of the last body at the tip
    (6), and those of the bodies between them (6 each).
    """
    count = len(chain.points)
    # The order root, inner bodies, tip of the chain becomes root, tip, inner bodies.
    block = np.array([0, *range(2, count), 1])
    mass = _scatter(block[:, None], chain.masses, 6 * count)
    full = _spring_matrix(chain, block, tuple(range(6)))
    parts = {kind: _spring_matrix(chain, block, rows) for kind, rows in KINDS.items()}
    # A joint released by eq. (25) as printed couples the kinds of deformation, as do a taper and a
    # section without two axes of symmetry. The stiffness is then not split.
    splits = chain.line is None and not (chain.stiffnesses * (1.0 - np.eye(6))).any()

    def centreline(stations: Array) -> SparseMatrix:
        return _interpolate(chain.stations, block, np.asarray(stations, dtype=float))

    return LegMatrices(
        model="segments",
        length=chain.length,
        line=chain.line,
        stiffness=full,
        mass=mass,
        centreline=centreline,
        parts=parts if splits else {},
    )


def static_leg(chain: SegmentChain) -> LegMatrices:
    """Massless leg with the stiffness of the chain between its ends. Unknowns: root 6, tip 6.

    The springs are in series, so that their compliances at the tip add up: C = Σ X Cₖ Xᵀ, where X
    transforms twists at spring k to the tip (`shift`). The relative error of this sum is below
    1e-11 up to thousands of elements. The assembled matrix of `segment_leg` gives the same
    displacements with a relative round-off error of n³ · 1e-15, because the springs of a chain of n
    elements are n³ times as stiff as the leg.
    """
    levers = shift(chain.tip - chain.springs_at[:-1])
    other_compliance = np.sum(
        levers @ np.linalg.inv(chain.stiffnesses[:-1]) @ levers.swapaxes(1, 2), axis=0
    )
    # The last spring may be released and then has no compliance, so its stiffness is used.
    at_tip = _last_at_tip(chain)
    tip = np.linalg.solve(np.eye(6) + at_tip @ other_compliance, at_tip)
    deflection = np.hstack([-shift(chain.tip), np.eye(6)])
    ends = chain.stations[[0, -1]]
    return LegMatrices(
        model="segments",
        length=chain.length,
        line=chain.line,
        stiffness=csr_matrix(deflection.T @ (0.5 * (tip + tip.T)) @ deflection),
        mass=csr_matrix((12, 12)),
        centreline=lambda stations: _interpolate(ends, np.array([0, 1]), np.asarray(stations)),
    )


def _spring_matrix(chain: SegmentChain, block: IntArray, rows: Sequence[int]) -> SparseMatrix:
    """Stiffness Σ [C₂ C₁]ᵀ K [C₂ C₁] of eq. (21), summed over all springs.

    [C₂ C₁] maps the twists of two neighbouring bodies to the deflection of the spring K between
    them. Only the components `rows` of the deflections are used. `block` (b) contains, for each of
    the b bodies, the index of its block of six unknowns.
    """
    components, count = list(rows), len(chain.springs_at)
    neighbours = np.column_stack([np.arange(count), np.arange(count) + 1])
    levers = shift(chain.springs_at[:, None] - chain.points[neighbours])
    deflections = np.concatenate([-levers[:, 0], levers[:, 1]], axis=2)[:, components]
    stiffness = chain.stiffnesses[:, components][:, :, components]
    terms = deflections.swapaxes(1, 2) @ stiffness @ deflections
    return _scatter(block[neighbours], terms, 6 * len(chain.points))


def _scatter(blocks: IntArray, matrices: Array, size: int) -> SparseMatrix:
    """Sparse sum of dense matrices (s×6b×6b), each placed at its b blocks of six unknowns.

    `blocks` (s×b) contains the indices of the blocks. `size` is the number of all unknowns.
    """
    unknowns = (6 * blocks[:, :, None] + np.arange(6)).reshape(len(blocks), -1)
    width = unknowns.shape[1]
    rows = np.repeat(unknowns, width, axis=1).ravel()
    columns = np.tile(unknowns, (1, width)).ravel()
    return csr_matrix(coo_matrix((matrices.ravel(), (rows, columns)), shape=(size, size)))


def _interpolate(positions: Array, block: IntArray, stations: Array) -> SparseMatrix:
    """6k × 6b matrix that maps the unknowns of b bodies to the twists at k `stations`.

    `stations` and the `positions` (b) of the bodies are distances (m along the leg) from the root.
    Between bodies, twists are interpolated linearly. `block` (b) contains the index of the block of
    six unknowns of each body.
    """
    previous = np.clip(
        np.searchsorted(positions, stations, side="right") - 1, 0, len(positions) - 2
    )
    weight = (stations - positions[previous]) / (positions[previous + 1] - positions[previous])
    component = np.arange(6)
    rows = (6 * np.arange(len(stations))[:, None] + component).ravel()
    columns = [(6 * block[body][:, None] + component).ravel() for body in (previous, previous + 1)]
    values = [np.repeat(w, 6) for w in (1.0 - weight, weight)]
    return csr_matrix(
        (np.concatenate(values), (np.tile(rows, 2), np.concatenate(columns))),
        shape=(6 * len(stations), 6 * len(positions)),
    )
