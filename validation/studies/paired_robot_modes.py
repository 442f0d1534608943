"""Modes of one robot by several models of its legs, and which of them belong together.

The shapes of all models are sampled alike, on the platform and on section points of both legs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fem.beams.beam import beam_leg
from fem.bodies.solid import Ends
from fem.reduction.craig_bampton import craig_bampton
from fem.sections.section_constants import beam_properties, section_constants
from lumped.arrays import Array, IntArray
from lumped.biglide import Biglide, with_equivalent_legs
from lumped.biglide import postures as biglide_postures
from lumped.legs import ConstantLeg, Theory, equivalent_leg
from lumped.mechanism.body_model import LegMatrices
from lumped.models.segments import segment_chain, segment_leg
from lumped.system.assembly import System, assembly
from lumped.system.solution import modes, solved
from meshes.section.section_mesh import section_mesh
from validation.agreement.mode_pairing import (
    centreline_samples,
    centreline_weights,
    largest_angle,
    neighbours,
    pair_modes,
)
from validation.context import Preset
from validation.models.biglide import highest_frequency
from validation.models.legs import filled
from validation.solids.legs import divisions_across
from validation.solids.robots import held_solid, renewed_where_needed

BoolArray: TypeAlias = NDArray[np.bool_]
# Divisions of the section of leg 1 and of leg 2.
LegDivisions: TypeAlias = tuple[int, int]

# Divisions of rectangles; the next coarser ones give the numerical uncertainty. Up to four, walls
# have one element across: half of that shows what the length of elements does, and what the section
# mesh leaves out it leaves out of the constants alike.
DIVISIONS: dict[Preset, int] = {"quick": 2, "standard": 3, "fine": 4}
WALL_DIVISIONS: dict[Preset, int] = {"quick": 2, "standard": 4, "fine": 8}
# Twice as many modes are offered as partners, so that none is missing where orders differ.
PAIRED, OFFERED = 6, 12
ELEMENTS = 20
STATIONS = 24


@dataclass(frozen=True)
class SampledModes:
    """The first `OFFERED` modes (m) of one model at p positions `x` (m).

    `frequencies` (Hz, p×m) and `samples` (p×k×m, SI) of the shapes: displacement of the platform's
    mass and twists of both legs' sections at common points. `torsion` (p×2×m×m, rad²/s²): share of
    each leg's torsion in the modal stiffness, coupling included, zero for solids and for segments
    whose joint couples torsion with bending.
    """

    x: Array
    frequencies: Array
    samples: Array
    torsion: Array


@dataclass(frozen=True)
class PairedModes:
    """The first modes (k) of a reference at p positions `x` (m) with partners in another model.

    Frequencies (Hz) `reference` and `found`, `partner` (number from 0) and `mac`, all p×k. `close`
    tells which modes have a neighbour within `CLOSE`, `shared` is cos² of the largest angle between
    the spaces of a mode and its close neighbours in both models. Which of two close modes is whose
    partner is an accident of how they mix: there `found` is in the order of frequencies, and
    `difference`, relative to `reference`, is the largest among the neighbours. `reached` tells for
    which modes the other model was asked far enough to have the partner, and those of the mode's
    neighbours, among its own: what stands for the others is no partner.
    """

    x: Array
    reference: Array
    found: Array
    partner: IntArray
    mac: Array
    close: BoolArray
    shared: Array
    difference: Array
    reached: BoolArray


def divisions_of(legs: Sequence[ConstantLeg], preset: Preset) -> tuple[LegDivisions, LegDivisions]:
    """Coarser and finer divisions of both legs."""
    flat, walls = DIVISIONS[preset], WALL_DIVISIONS[preset]

    def of_both(rectangle: int, others: int) -> LegDivisions:
        first, second = (divisions_across(leg, rectangle, others) for leg in legs)
        return first, second

    return of_both(flat - 1, walls // 2), of_both(flat, walls)


def model_modes(
    robot: Biglide, model: str, theory: Theory, elements: int, postures: int
) -> SampledModes:
    """Modes of the robot in segments or in beams of textbook constants."""

    def built(leg: ConstantLeg) -> LegMatrices:
        properties = leg.properties(theory)
        if model == "segments":
            return segment_leg(segment_chain(properties, leg.length, elements))
        return beam_leg(properties, leg.length, elements)

    leg1, leg2 = (built(leg) for leg in _constant_legs(robot))
    return sampled_modes(robot, (leg1, leg2), postures)


def own_beam_modes(robot: Biglide, divisions: LegDivisions, postures: int) -> SampledModes:
    """Modes of the robot in beams of the constants of the solids' section meshes."""
    leg1, leg2 = (
        own_beam(leg, number) for leg, number in zip(_constant_legs(robot), divisions, strict=True)
    )
    return sampled_modes(robot, (leg1, leg2), postures)


def solid_modes(
    robot: Biglide, divisions: LegDivisions, ends: Ends | tuple[Ends, Ends], postures: int
) -> SampledModes:
    """Modes of the robot with solid legs of so many divisions, reduced to their ends.

    `ends` of both legs or of leg 1 and leg 2.
    """
    both: tuple[Ends, Ends] = (ends, ends) if isinstance(ends, str) else ends
    member = with_equivalent_legs(robot)
    places = (member.stroke[0], member.centre, member.stroke[1])
    legs = [
        held_solid(leg, number, hold)
        for leg, number, hold in zip(_constant_legs(robot), divisions, both, strict=True)
    ]

    def sampled(highest: float) -> SampledModes:
        leg1, leg2 = (craig_bampton(leg, highest).matrices for leg in legs)
        return sampled_modes(robot, (leg1, leg2), postures)

    return renewed_where_needed(
        max(highest_frequency(member, at, OFFERED) for at in places),
        sampled,
        frequencies=lambda modes: modes.frequencies,
    )


def _constant_legs(robot: Biglide) -> tuple[ConstantLeg, ConstantLeg]:
    return equivalent_leg(robot.leg1), equivalent_leg(robot.leg2)


def own_beam(leg: ConstantLeg, divisions: int) -> LegMatrices:
    """Timoshenko beam of the constants of the very section mesh that the solid has."""
    material = leg.material
    mesh = section_mesh(leg.section, divisions)
    constants = section_constants(mesh, material.nu, material.G / material.E)
    return beam_leg(beam_properties(constants, material), leg.length, ELEMENTS)


def sampled_modes(
    robot: Biglide, legs: tuple[LegMatrices, LegMatrices], postures: int, offered: int = OFFERED
) -> SampledModes:
    """The first `offered` modes of the robot from two legs of any model, over the stroke."""
    member = with_equivalent_legs(robot)
    x = member.stations(postures)
    frequencies, samples, torsion = [], [], []
    places = biglide_postures(member, x)
    prepared = assembly(places[0].mechanism, {"leg1": filled(legs[0]), "leg2": filled(legs[1])})
    for at in places:
        system = prepared.at(at)
        found = modes(solved(system), offered)
        frequencies.append(found.frequencies)
        samples.append(_sampled(system, legs, found.shapes))
        torsion.append([_in_torsion(system, name, found.shapes) for name in ("leg1", "leg2")])
    return SampledModes(x, np.array(frequencies), np.array(samples), np.array(torsion))


def _in_torsion(system: System, body: str, shapes: Array) -> Array:
    own = system.own(body, shapes)
    part = system.models[body].parts.get("torsion")
    size = shapes.shape[1]
    return np.zeros((size, size)) if part is None else np.asarray(own.T @ (part @ own))


def paired(robot: Biglide, reference: SampledModes, other: SampledModes) -> PairedModes:
    """Each mode of the reference with its partner by shape in another model of the robot."""
    weights = sample_weights(robot)
    rows = [
        _pair(weights, *of_posture)
        for of_posture in zip(
            reference.frequencies, reference.samples, other.frequencies, other.samples, strict=True
        )
    ]
    found, partner, mac, close, shared, difference, reached = (
        np.array(column) for column in zip(*rows, strict=True)
    )
    first = reference.frequencies[:, :PAIRED]
    return PairedModes(reference.x, first, found, partner, mac, close, shared, difference, reached)


def _pair(
    weights: Array, frequencies: Array, samples: Array, others: Array, other_samples: Array
) -> tuple[Array, IntArray, Array, BoolArray, Array, Array, BoolArray]:
    pairing = pair_modes(samples, other_samples, weights)
    found, first = others[pairing.partner], slice(PAIRED)
    close, shared = np.zeros(PAIRED, dtype=bool), pairing.mac[first].copy()
    difference, reached = np.zeros(PAIRED), np.zeros(PAIRED, dtype=bool)
    for mode in range(PAIRED):
        family = neighbours(frequencies, mode)
        reached[mode] = frequencies[family[family < PAIRED]].max() <= others[-1]
        if len(family) > 1:
            close[mode] = True
            partners = pairing.partner[family]
            angle = largest_angle(samples[:, family], other_samples[:, partners], weights)
            shared[mode] = np.cos(angle) ** 2
            found[family] = np.sort(others[partners])
        difference[mode] = np.abs(found[family] / frequencies[family] - 1.0).max()
    partner, mac = pairing.partner[first], pairing.mac[first]
    return found[first], partner, mac, close, shared, difference, reached


def _sampled(system: System, legs: tuple[LegMatrices, LegMatrices], shapes: Array) -> Array:
    """Displacement of the platform's mass, and twists of both legs' sections (k×m, SI)."""
    rows = [(system.tool @ shapes)[:3]]
    for name, leg in zip(("leg1", "leg2"), legs, strict=True):
        stations, _ = centreline_samples(leg.length, STATIONS)
        rows.append(leg.centreline(stations) @ system.own(name, shapes))
    return np.vstack(rows)


def sample_weights(robot: Biglide) -> Array:
    """Masses (k) of what `_sampled` gives."""
    masses = [np.full(3, robot.platform_mass)]
    for leg in (equivalent_leg(robot.leg1), equivalent_leg(robot.leg2)):
        _, lengths = centreline_samples(leg.length, STATIONS)
        masses.append(centreline_weights(leg.timoshenko, lengths))
    return np.concatenate(masses)
