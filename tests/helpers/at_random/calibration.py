"""How often a stated uncertainty holds the finest solution, over legs and robots at random.

Every number is stated from coarse meshes alone, as a run states it, and then computed on a mesh at
least half again as fine as the finest of those.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from like_ifw import like_ifw, placed_at, stations

from fem.bodies.solid import Ends
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.mechanism import Posture
from lumped.models.bodies import link
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Section, Tube
from lumped.system.assembly import assemble
from lumped.system.solution import compliance, solved
from validation.solids.legs import (
    Refinement,
    formal_order,
    solid_compliances,
    solid_frequencies,
)

_BOTH: tuple[Ends, Ends] = ("rigid", "free")
_FREQUENCIES = 3
# Two meshes from which robots of rectangles are stated, and one twice as fine.
_OF_ROBOTS = (1, 2, 4)


@dataclass(frozen=True)
class Stated:
    """A number's `uncertainty` and its true `error`, both relative, and what number it is."""

    quantity: str
    uncertainty: float
    error: float


def random_leg(rng: np.random.Generator, walls: float = 0.0) -> ConstantLeg:
    """A rectangle, or with probability `walls` each of the other four shapes.

    ν is 0 or 0.1 to 0.4, the length three to twelve sides.
    """
    size, ratio = rng.uniform(0.06, 0.2), rng.uniform(0.6, 1.0)
    width, height = rng.permutation([size, ratio * size]).tolist()
    wall = rng.uniform(0.08, 0.2) * ratio * size
    shapes: tuple[Section, ...] = (
        Rectangle(width, height),
        Circle(size),
        Tube(size, wall),
        HollowRectangle(width, height, wall),
        ISection(width, height, wall, rng.uniform(0.5, 1.0) * wall),
    )
    section = shapes[rng.choice(5, p=[1.0 - 4.0 * walls, walls, walls, walls, walls])]
    material = Material.isotropic(2.1e11, float(rng.choice([0.0, rng.uniform(0.1, 0.4)])), 7850.0)
    return ConstantLeg(float(rng.uniform(3.0, 12.0) * size), section, material)


def ladders(leg: ConstantLeg) -> tuple[tuple[int, ...], int]:
    """Divisions from which numbers are stated, as in a run, and those of the finest solution."""
    return ((1, 2, 3, 4), 6) if isinstance(leg.section, Rectangle) else ((4, 8), 12)


def of_statics(leg: ConstantLeg) -> Iterator[Stated]:
    """The six diagonal compliances with both ends, from all meshes and from the coarsest two."""
    coarse, fine = ladders(leg)
    meshes = solid_compliances(leg, (*coarse, fine))
    walls = "" if isinstance(leg.section, Rectangle) else ", round or walled"
    for count in {2, len(coarse)}:
        for ends, found in _both(leg, coarse[:count], {e: meshes[e].values for e in _BOTH}):
            for i in range(6):
                name = f"compliance, {ends}{walls}, {count} meshes"
                yield _stated(name, found, meshes[ends].values[-1][i, i], (i, i))


def of_frequencies(leg: ConstantLeg) -> Iterator[Stated]:
    """First frequencies of a clamped rectangle from two meshes, and on one twice as fine."""
    divisions = (1, 2, 4)
    values = {
        ends: solid_frequencies(leg, divisions, ends, _FREQUENCIES).frequencies.values
        for ends in _BOTH
    }
    for ends, found in _both(leg, divisions[:2], values):
        for k in range(_FREQUENCIES):
            yield _stated(f"frequency, {ends}, 2 meshes", found, values[ends][-1][k], (k,))


def _both(
    leg: ConstantLeg, divisions: tuple[int, ...], values: dict[Ends, Array]
) -> Iterator[tuple[Ends, Refinement]]:
    """What the coarser meshes say of both ends."""
    count = len(divisions)
    free = Refinement(divisions, values["free"][:count], formal_order(leg, "free"))
    yield "free", free
    yield "rigid", Refinement(divisions, values["rigid"][:count], formal_order(leg, "rigid"), free)


def of_robots(rng: np.random.Generator) -> Iterator[Stated]:
    """Deflections of a robot of two random legs at a random posture, from two meshes."""
    legs = random_leg(rng), random_leg(rng)
    a = float(rng.uniform(0.7, 0.95) * (legs[0].length + legs[1].length))
    share = rng.uniform(0.1, 0.9)
    try:
        robot = like_ifw(a=a, leg1=legs[0], leg2=legs[1])
    except InputError:
        return
    first, last = stations(robot, 2)
    (place,) = placed_at(robot, first + share * (last - first))
    by_leg = [solid_compliances(leg, _OF_ROBOTS) for leg in legs]
    values = {
        ends: np.array([_deflections(place, legs, by_leg, ends, at) for at in range(3)])
        for ends in _BOTH
    }
    # Of two legs of unlike order the lower one is for both.
    slowest = min(legs, key=lambda leg: formal_order(leg, "rigid"))
    for ends, found in _both(slowest, _OF_ROBOTS[:2], values):
        for i in range(3):
            yield _stated(f"robot, {ends}, 2 meshes", found, values[ends][-1][i], (i,))


def _deflections(
    place: Posture,
    legs: tuple[ConstantLeg, ConstantLeg],
    by_leg: list[dict[Ends, Refinement]],
    ends: Ends,
    at: int,
) -> Array:
    springs = {
        f"leg{number}": link(leg.length, of_leg[ends].values[at])
        for number, (leg, of_leg) in enumerate(zip(legs, by_leg, strict=True), start=1)
    }
    return np.diag(compliance(solved(assemble(place, springs))))[:3]


def _stated(quantity: str, found: Refinement, finest: float, at: tuple[int, ...]) -> Stated:
    value = float(found.values[-1][at])
    uncertainty = found.uncertainty(*at)
    return Stated(quantity, uncertainty / abs(finest), abs(value - finest) / abs(finest))


# Below this (relative) rounding of the solutions is what differs.
ROUNDING = 1e-9


def coverage(numbers: list[Stated]) -> tuple[float, float]:
    """Share of the numbers whose interval holds the finest solution, and its width over the error.

    The width is the median of uncertainty over error, of the numbers that differ at all.
    """
    real = [one for one in numbers if one.error > ROUNDING]
    held = np.mean([one.error <= one.uncertainty for one in real])
    return float(held), float(np.median([one.uncertainty / one.error for one in real]))
