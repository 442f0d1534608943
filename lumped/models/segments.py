"""Rigid segments joined by 6-DOF springs, eqs (13)–(23), as one free leg.

A spring between two rigid elements represents the beam piece between their centres. Referred to the
middle of that piece its compliance is diagonal if the section has two axes of symmetry. Two layouts
of n equal elements:

half     full springs (length L/n) between elements and springs of length L/2n at both ends:
         second order in 1/n in the frequencies, exact in statics for every n;
literal  text of §3.2: springs between elements only, the end elements rigid with the ends, so
         that a length L/n of the leg is rigid: first order in 1/n.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.errors import InputError
from lumped.legs import BeamProperties
from lumped.mechanism.body_model import LegMatrices
from lumped.screws import shift
from lumped.system.joint_motion import printed_release

Layout: TypeAlias = Literal["half", "literal"]
# Release of the robot's revolute joints: by condensation, or by eq. (25) as printed.
Release: TypeAlias = Literal["condensed", "printed"]

# Twist components that each kind of deformation uses in a spring referred to its piece's middle.
KINDS = {"tension": (0,), "torsion": (3,), "bending y": (2, 4), "bending z": (1, 5)}


@dataclass(frozen=True, eq=False)
class SegmentChain:
    """Bodies from root to tip, rigid elements or massless ends, and springs between neighbours.

    `places` (b) of the bodies' reference points and `springs_at` (b−1) are in m from the root,
    `masses` (b×6×6, at these points) and `stiffnesses` (b−1×6×6, on the relative twist at the
    spring) in leg axes, SI.
    """

    length: float
    places: Array
    masses: Array
    springs_at: Array
    stiffnesses: Array


def segment_chain(
    properties: BeamProperties, length: float, elements: int, layout: Layout = "half"
) -> SegmentChain:
    """Chain of `elements` equal rigid elements for a leg of `length` (m).

    Raises InputError for fewer elements than the layout needs (half 1, literal 2).
    """
    least = 1 if layout == "half" else 2
    if elements < least:
        raise InputError(f"elements = {elements}: the {layout} layout needs {least} or more")
    piece = length / elements
    centres = (np.arange(elements) + 0.5) * piece
    masses = np.tile(_element_mass(properties, piece), (elements, 1, 1))
    pieces: Array = np.full(elements - 1, piece)
    middles: Array = np.asarray(centres[:-1] + piece / 2.0, dtype=float)
    if layout == "half":
        places = np.array([0.0, *centres, length])
        masses = np.pad(masses, ((1, 1), (0, 0), (0, 0)))
        pieces = np.array([piece / 2.0, *pieces, piece / 2.0])
        middles = np.array([piece / 4.0, *middles, length - piece / 4.0])
    else:
        # The end elements are referred to the leg's ends, to which the robot's joints are attached.
        places = np.array([0.0, *centres[1:-1], length])
        levers = _shift_along_leg(centres - places)
        masses = levers.swapaxes(1, 2) @ masses @ levers
    springs = [_spring(properties, part) for part in pieces]
    return SegmentChain(length, places, masses, middles, np.array(springs))


def _spring(properties: BeamProperties, piece: float) -> Array:
    """6×6 stiffness of the spring that stands for a piece, referred to its middle."""
    compliance = properties.piece_compliance(piece)
    if properties.couples_bending or properties.couples_torsion:
        stiffness = np.linalg.inv(compliance)
        return np.asarray(0.5 * (stiffness + stiffness.T))
    return np.diag(1.0 / np.diag(compliance))


def _element_mass(properties: BeamProperties, piece: float) -> Array:
    """6×6 mass of a rigid element about its centre: a prism with the section's rotary inertia."""
    mass = properties.mu * piece
    slender = mass * piece**2 / 12.0
    inertia = np.diag(
        [
            mass,
            mass,
            mass,
            properties.rho_J * piece,
            properties.rho_Iy * piece + slender,
            properties.rho_Iz * piece + slender,
        ]
    )
    inertia[4, 5] = inertia[5, 4] = -properties.rho_Iyz * piece
    return inertia


def _shift_along_leg(offsets: Array | float) -> Array:
    """…×6×6 transformation of twists to points `offsets` (…, m) further along the leg."""
    return shift(np.asarray(offsets)[..., None] * np.eye(3)[0])


def with_printed_tip_joint(chain: SegmentChain) -> SegmentChain:
    """Chain with a revolute joint about z at its tip according to eq. (25) as printed.

    Row and column of φz of the last spring, referred to the tip, are set to zero. This is not a
    joint if φz is coupled to y: the spring becomes too stiff along y (errata).
    """
    printed = printed_release(_last_at_tip(chain))
    return replace(
        chain,
        springs_at=np.append(chain.springs_at[:-1], chain.length),
        stiffnesses=np.concatenate([chain.stiffnesses[:-1], printed[None]]),
    )


def _last_at_tip(chain: SegmentChain) -> Array:
    """Stiffness (6×6) of the last spring, referred to the tip."""
    lever = _shift_along_leg(chain.springs_at[-1] - chain.length)
    at_tip: Array = lever.T @ chain.stiffnesses[-1] @ lever
    return at_tip


def segment_leg(chain: SegmentChain) -> LegMatrices:
    """Stiffness and mass of the chain, eqs (13)–(23), unknowns (root 6, tip 6, inner bodies)."""
    count = len(chain.places)
    # Chain order root, inner, tip becomes root, tip, inner.
    block = np.array([0, *range(2, count), 1])
    mass = _scatter(block[:, None], chain.masses, 6 * count)
    full = _spring_matrix(chain, block, tuple(range(6)))
    parts = {kind: _spring_matrix(chain, block, rows) for kind, rows in KINDS.items()}
    # A printed joint or a section without two axes of symmetry couples the kinds, so that the
    # springs do not split into parts.
    splits = not (chain.stiffnesses * (1.0 - np.eye(6))).any()

    def centreline(stations: Array) -> SparseMatrix:
        return _interpolate(chain.places, block, np.asarray(stations, dtype=float))

    return LegMatrices(
        model="segments",
        length=chain.length,
        stiffness=full,
        mass=mass,
        centreline=centreline,
        parts=parts if splits else {},
    )


def static_leg(chain: SegmentChain) -> LegMatrices:
    """The chain condensed to its two ends, unknowns (root 6, tip 6), without mass.

    Springs in series: compliances add at the tip, C = Σ X Cₖ Xᵀ. The assembled matrix of
    `segment_leg` gives the same result with a round-off of n³ · 1e-15, since the springs of a fine
    chain are n³ times stiffer than the leg. The error of this form is below 1e-11 up to thousands
    of elements.
    """
    levers = _shift_along_leg(chain.length - chain.springs_at[:-1])
    other_compliance = np.sum(
        levers @ np.linalg.inv(chain.stiffnesses[:-1]) @ levers.swapaxes(1, 2), axis=0
    )
    # The last spring may be released (singular stiffness), so it is joined as a stiffness.
    at_tip = _last_at_tip(chain)
    tip = np.linalg.solve(np.eye(6) + at_tip @ other_compliance, at_tip)
    deflection = np.hstack([-_shift_along_leg(chain.length), np.eye(6)])
    ends = np.array([0.0, chain.length])
    return LegMatrices(
        model="segments",
        length=chain.length,
        stiffness=csr_matrix(deflection.T @ (0.5 * (tip + tip.T)) @ deflection),
        mass=csr_matrix((12, 12)),
        centreline=lambda stations: _interpolate(ends, np.array([0, 1]), np.asarray(stations)),
    )


def _spring_matrix(chain: SegmentChain, block: IntArray, rows: Sequence[int]) -> SparseMatrix:
    """Stiffness Σ [C₂ C₁]ᵀ K [C₂ C₁] of eq. (21) from the components `rows` of the deflections."""
    components, count = list(rows), len(chain.springs_at)
    neighbours = np.column_stack([np.arange(count), np.arange(count) + 1])
    levers = _shift_along_leg(chain.springs_at[:, None] - chain.places[neighbours])
    deflections = np.concatenate([-levers[:, 0], levers[:, 1]], axis=2)[:, components]
    stiffness = chain.stiffnesses[:, components][:, :, components]
    terms = deflections.swapaxes(1, 2) @ stiffness @ deflections
    return _scatter(block[neighbours], terms, 6 * len(chain.places))


def _scatter(blocks: IntArray, matrices: Array, size: int) -> SparseMatrix:
    """Sum of dense matrices (s×6b×6b) placed at their 6×6 `blocks` (s×b), as CSR."""
    unknowns = (6 * blocks[:, :, None] + np.arange(6)).reshape(len(blocks), -1)
    width = unknowns.shape[1]
    rows = np.repeat(unknowns, width, axis=1).ravel()
    columns = np.tile(unknowns, (1, width)).ravel()
    return csr_matrix(coo_matrix((matrices.ravel(), (rows, columns)), shape=(size, size)))


def _interpolate(positions: Array, block: IntArray, stations: Array) -> SparseMatrix:
    """6m × n matrix of twists at `stations`, linear between the bodies' reference points."""
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
