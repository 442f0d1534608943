"""Numerical uncertainty of what `solve` says of solids, from other meshes of prisms."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import cbrt, inf, sqrt

import numpy as np

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.legs import Leg
from lumped.sections import Rectangle, Section
from meshes.section.section_blocks import element_count
from validation.models.options import ModelOptions
from validation.solids.solid_legs import GRIDS_FOR_ORDER, ROUND_OFF, formal_order
from validation.solve.answer import Answer, MeshUncertainty
from validation.uncertainty.grid_convergence import richardson_limits
from validation.uncertainty.mesh_half_widths import MeshPolicy, mesh_half_widths

# Elements of one mesh to those of the other, in size: walls of one element across keep that one,
# so that half the divisions come to 1.2 (tubes) and 1.3.
_RATIO = 1.2


def beside(options: ModelOptions, legs: Sequence[Leg]) -> int:
    """Divisions of another mesh: half of them, one, or the fewest more that change enough.

    Round and thin-walled sections need so many elements as they are that fewer divisions often give
    them the same mesh, whose answer would be called exact.
    """
    own = options.divisions
    others = (own // 2, 1, *range(own + 1, 8 * own + 1))
    sections = [equivalent_leg(leg, options.equivalent).section for leg in legs]
    chosen: int = next(
        other
        for other in others
        if other and all(_ratio(section, own, other) >= _RATIO for section in sections)
    )
    return chosen


def _ratio(section: Section, one: int, other: int) -> float:
    """Of the sizes of elements of two meshes of a section, at least 1."""
    try:
        coarse, fine = sorted(element_count(section, divisions) for divisions in (one, other))
    except InputError:
        # A shape that a user has added: as its divisions say.
        return max(one, other) / min(one, other)
    return sqrt(fine / coarse)


def with_uncertainty(
    answers: Sequence[Answer],
    others: Sequence[Answer] | None,
    legs: Sequence[Leg],
    options: ModelOptions,
    divisions: int,
) -> list[Answer]:
    """The answers with half-widths of 95 % intervals, from the `others` on a mesh of `divisions`.

    The step between both meshes times Roache's factor, r³ the ratio of their elements (Celik et
    al., J. Fluids Eng. 130 (2008) 078001). The coarser one's error is rᵖ times the finer one's.
    Nothing is known without others.
    """
    if others is None:
        frequencies = np.full_like(answers[0].frequencies, inf)
        loads = dict.fromkeys(answers[0].loads, np.full(6, inf))
        unknown = MeshUncertainty(np.full(6, inf), frequencies, divisions, loads=loads)
        return [replace(one, uncertainty=unknown) for one in answers]
    own = options.divisions
    solid = [equivalent_leg(leg, options.equivalent) for leg in legs]
    order = min(formal_order(leg, options.ends) for leg in solid)
    along = max(own, divisions) / min(own, divisions)
    ratio = min(cbrt(along * _ratio(leg.section, own, divisions) ** 2) for leg in solid)
    policy = MeshPolicy.of_order(ratio if own > divisions else 1.0 / ratio, order)

    def half_widths(first: Array, second: Array) -> Array:
        return mesh_half_widths([np.abs(first - second)], policy)

    found = []
    for one, other in zip(answers, others, strict=True):
        left_open = MeshUncertainty(
            half_widths(np.diag(one.compliance), np.diag(other.compliance)),
            half_widths(one.frequencies, other.frequencies),
            divisions,
            loads={name: half_widths(one.loads[name], other.loads[name]) for name in one.loads},
        )
        found.append(replace(one, uncertainty=left_open))
    return found


def extrapolated(
    answers: Sequence[Answer],
    meshes: Mapping[int, Sequence[Answer]],
    legs: Sequence[Leg],
    options: ModelOptions,
) -> list[Answer]:
    """The answers on the finest of the `meshes` (by divisions), extrapolated where these show it.

    Number by number, by four meshes of rectangles or more: those of walls keep one element across
    for several divisions, and would show the order of their slices alone.
    """
    solid = [equivalent_leg(leg, options.equivalent) for leg in legs]
    if len(meshes) < GRIDS_FOR_ORDER or not all(
        isinstance(one.section, Rectangle) for one in solid
    ):
        return list(answers)
    divisions = tuple(sorted(meshes))
    elements = [sum(n * element_count(one.section, n) for one in solid) for n in divisions]
    order = min(formal_order(leg, options.ends) for leg in solid)
    upper = np.triu_indices(6)
    diagonal, count = upper[0] == upper[1], len(upper[0])
    found = []
    for one, *on_meshes in zip(answers, *(meshes[n] for n in divisions), strict=True):
        values = np.array([np.append(own.compliance[upper], own.frequencies) for own in on_meshes])
        sizes = np.cbrt(1.0 / np.array(elements))
        limits, left = richardson_limits(sizes, values, order, ROUND_OFF)
        numbers = np.where(np.isnan(limits), values[-1], limits)
        compliance = np.zeros((6, 6))
        compliance[upper] = compliance.T[upper] = numbers[:count]
        stated = one.uncertainty
        if stated is None:
            return list(answers)
        left_open = MeshUncertainty(
            _known(left[:count][diagonal], stated.compliance),
            _known(left[count:], stated.frequencies),
            stated.divisions,
            divisions,
            loads=stated.loads,
        )
        found.append(
            replace(one, compliance=compliance, frequencies=numbers[count:], uncertainty=left_open)
        )
    return found


def _known(first: Array, otherwise: Array) -> Array:
    return np.where(np.isnan(first), otherwise, first)
