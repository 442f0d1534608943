"""Rigid segments joined by 6-DOF springs, eqs (13)–(23), as one free leg.

A spring between two rigid elements stands for the beam piece between their centres; referred to
the middle of that piece its compliance is diagonal. Two layouts of n equal elements:

half     full springs (length L/n) between elements and springs of length L/2n at both ends:
         second order in 1/n in the frequencies, exact in statics for every n;
literal  as §3.2 reads: springs between elements only, the end elements rigid with the ends, so
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
from lumped.screws import move_compliance, shift
from lumped.system.joint_motion import printed_release

Layout: TypeAlias = Literal["half", "literal"]
# How the robot's revolute joints are released: by condensation, or as eq. (25) prints it.
Release: TypeAlias = Literal["condensed", "printed"]

# Twist components that each kind of deformation uses in a spring referred to its piece's middle.
KINDS = {"tension": (0,), "torsion": (3,), "bending y": (2, 4), "bending z": (1, 5)}


@dataclass(frozen=True)
class Segment:
    """Node of the chain: a rigid element, or a massless end.

    `position` (m from the root) is its reference point, `mass` its 6×6 mass matrix there (leg
    axes, SI).
    """

    position: float
    mass: Array


@dataclass(frozen=True)
class SegmentSpring:
    """6-DOF spring between bodies `first` and `second`.

    `stiffness` (6×6, leg axes, SI) acts on the relative twist at `position` (m from the root).
    """

    first: int
    second: int
    position: float
    stiffness: Array


@dataclass(frozen=True)
class SegmentChain:
    """Bodies from root to tip, and the springs between neighbours."""

    length: float
    bodies: tuple[Segment, ...]
    springs: tuple[SegmentSpring, ...]


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
    element_mass = _element_mass(properties, piece)
    if layout == "half":
        massless = np.zeros((6, 6))
        inner = [Segment(centre, element_mass) for centre in centres]
        bodies = [Segment(0.0, massless), *inner, Segment(length, massless)]
        pieces = [piece / 2.0] + [piece] * (elements - 1) + [piece / 2.0]
        middles = [piece / 4.0, *(centres[:-1] + piece / 2.0), length - piece / 4.0]
    else:
        # The end elements are referred to the leg's ends, where the robot takes hold of them.
        ends = [0.0, length]
        first, last = (
            _at(element_mass, c - end) for c, end in zip(centres[[0, -1]], ends, strict=True)
        )
        inner = [Segment(centre, element_mass) for centre in centres[1:-1]]
        bodies = [Segment(0.0, first), *inner, Segment(length, last)]
        pieces = [piece] * (elements - 1)
        middles = list(centres[:-1] + piece / 2.0)
    springs = tuple(
        SegmentSpring(k, k + 1, middle, np.diag(1.0 / np.diag(properties.piece_compliance(part))))
        for k, (part, middle) in enumerate(zip(pieces, middles, strict=True))
    )
    return SegmentChain(length, tuple(bodies), springs)


def _element_mass(properties: BeamProperties, piece: float) -> Array:
    """6×6 mass of a rigid element about its centre: a prism with the section's rotary inertia."""
    mass = properties.mu * piece
    slender = mass * piece**2 / 12.0
    return np.diag(
        [
            mass,
            mass,
            mass,
            properties.rho_J * piece,
            properties.rho_Iy * piece + slender,
            properties.rho_Iz * piece + slender,
        ]
    )


def _at(mass: Array, centre: float) -> Array:
    """Mass matrix referred to a point that lies `centre` (m, along x) before the mass centre."""
    adjoint = shift(np.array([centre, 0.0, 0.0]))
    moved: Array = adjoint.T @ mass @ adjoint
    return moved


def with_printed_tip_joint(chain: SegmentChain) -> SegmentChain:
    """The chain with a revolute joint about z at its tip as eq. (25) prints it.

    Row and column of φz of the last spring, referred to the tip, are zeroed. That is no joint
    where φz is coupled to y: the spring becomes too stiff along y (errata).
    """
    *others, last = chain.springs
    lever = shift(np.array([last.position - chain.length, 0.0, 0.0]))
    at_tip = lever.T @ last.stiffness @ lever
    printed = replace(last, position=chain.length, stiffness=printed_release(at_tip))
    return replace(chain, springs=(*others, printed))


def segment_leg(chain: SegmentChain) -> LegMatrices:
    """Stiffness and mass of the chain, eqs (13)–(23), unknowns (root 6, tip 6, inner bodies)."""
    count = len(chain.bodies)
    # Chain order root, inner, tip becomes root, tip, inner.
    block = np.concatenate([[0], np.arange(2, count), [1]]) if count > 2 else np.array([0, 1])
    size = 6 * count
    mass = _scatter(block[:, None], np.array([body.mass for body in chain.bodies]), size)
    full = _spring_matrix(chain, block, tuple(range(6)))
    parts = {kind: _spring_matrix(chain, block, rows) for kind, rows in KINDS.items()}
    # A printed joint couples the kinds: then the springs do not split into parts.
    splits = all(np.array_equal(s.stiffness, np.diag(np.diag(s.stiffness))) for s in chain.springs)

    def centreline(stations: Array) -> SparseMatrix:
        return _interpolate(chain, block, np.asarray(stations, dtype=float))

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
    `segment_leg` gives the same, but loses n³ · 1e-15 to rounding, since the springs of a fine
    chain are n³ times stiffer than the leg; this form keeps 1e-11 up to thousands of elements.
    """
    *others, last = chain.springs
    rest = sum((_tip_compliance(chain, spring) for spring in others), np.zeros((6, 6)))
    # The last spring may be released (singular stiffness), so it is joined as a stiffness.
    lever = shift(np.array([last.position - chain.length, 0.0, 0.0]))
    at_tip = lever.T @ last.stiffness @ lever
    tip = np.linalg.solve(np.eye(6) + at_tip @ rest, at_tip)
    deflection = np.hstack([-shift(np.array([chain.length, 0.0, 0.0])), np.eye(6)])
    ends = replace(chain, bodies=(chain.bodies[0], chain.bodies[-1]))
    return LegMatrices(
        model="segments",
        length=chain.length,
        stiffness=csr_matrix(deflection.T @ (0.5 * (tip + tip.T)) @ deflection),
        mass=csr_matrix((12, 12)),
        centreline=lambda stations: _interpolate(ends, np.array([0, 1]), np.asarray(stations)),
    )


def _tip_compliance(chain: SegmentChain, spring: SegmentSpring) -> Array:
    """What one spring (not released) adds to the compliance at the tip (6×6)."""
    offset = np.array([chain.length - spring.position, 0.0, 0.0])
    own: Array = np.linalg.inv(spring.stiffness).astype(float)
    return move_compliance(own, offset)


def _spring_matrix(chain: SegmentChain, block: IntArray, rows: Sequence[int]) -> SparseMatrix:
    """Σ [C₂ C₁]ᵀ K [C₂ C₁] of eq. (21), with the rows of the springs' deflection given."""
    chosen, springs = list(rows), chain.springs
    joined = np.array([(spring.first, spring.second) for spring in springs])
    positions = np.array([body.position for body in chain.bodies])
    levers = np.zeros((len(springs), 2, 3))
    levers[..., 0] = np.array([spring.position for spring in springs])[:, None] - positions[joined]
    before, after = shift(levers).swapaxes(0, 1)
    deflections = np.concatenate([-before, after], axis=2)[:, chosen]
    stiffness = np.array([spring.stiffness[np.ix_(chosen, chosen)] for spring in springs])
    terms = deflections.swapaxes(1, 2) @ stiffness @ deflections
    return _scatter(block[joined], terms, 6 * len(chain.bodies))


def _scatter(blocks: IntArray, matrices: Array, size: int) -> SparseMatrix:
    """Sum of dense matrices (s×6b×6b) placed at their 6×6 `blocks` (s×b), as CSR."""
    unknowns = (6 * blocks[:, :, None] + np.arange(6)).reshape(len(blocks), -1)
    width = unknowns.shape[1]
    rows = np.repeat(unknowns, width, axis=1).ravel()
    columns = np.tile(unknowns, (1, width)).ravel()
    return csr_matrix(coo_matrix((matrices.ravel(), (rows, columns)), shape=(size, size)))


def _interpolate(chain: SegmentChain, block: IntArray, stations: Array) -> SparseMatrix:
    """6m × n matrix of twists at `stations`, linear between the bodies' reference points."""
    positions = np.array([body.position for body in chain.bodies])
    left = np.clip(np.searchsorted(positions, stations, side="right") - 1, 0, len(positions) - 2)
    weight = (stations - positions[left]) / (positions[left + 1] - positions[left])
    component = np.arange(6)
    rows = (6 * np.arange(len(stations))[:, None] + component).ravel()
    columns = [(6 * block[body][:, None] + component).ravel() for body in (left, left + 1)]
    values = [np.repeat(w, 6) for w in (1.0 - weight, weight)]
    return csr_matrix(
        (np.concatenate(values), (np.tile(rows, 2), np.concatenate(columns))),
        shape=(6 * len(stations), 6 * len(chain.bodies)),
    )
