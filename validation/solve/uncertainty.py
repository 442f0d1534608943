"""Numerical uncertainty of solid prisms in `solve`, from a second mesh.

Input: answers on two or more meshes. Output: answers with half-widths; extrapolated if at least
four meshes show an order of convergence.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import cbrt, inf, sqrt

import numpy as np

from lumped.arrays import Array
from lumped.equivalent_leg import sectioned_leg
from lumped.errors import InputError
from lumped.legs import Leg
from lumped.sections import Rectangle, Section
from meshes.section.section_blocks import element_count
from validation.models.options import ModelOptions
from validation.solids.solid_legs import GRIDS_FOR_ORDER, ROUND_OFF, formal_order, section_of
from validation.solve.answer import Answer, MeshUncertainty
from validation.uncertainty.grid_convergence import richardson_limits
from validation.uncertainty.mesh_half_widths import MeshPolicy, mesh_half_widths

# Smallest ratio of element sizes of both meshes. Walls with one element across keep one, so that
# half the divisions give a ratio of only 1.2 (tubes) or 1.3.
_RATIO = 1.2


def second_divisions(options: ModelOptions, legs: Sequence[Leg]) -> int:
    """Divisions of a second mesh: half of the first, one, or the fewest more that change enough.

    Round and thin-walled sections need so many elements that fewer divisions often give the same
    mesh, whose answer would be called exact.
    """
    present = options.divisions
    candidates = (present // 2, 1, *range(present + 1, 8 * present + 1))
    sections = [section_of(sectioned_leg(leg, options.equivalent)) for leg in legs]
    divisions: int = next(
        candidate
        for candidate in candidates
        if candidate and all(_ratio(section, present, candidate) >= _RATIO for section in sections)
    )
    return divisions


def _ratio(section: Section, first: int, second: int) -> float:
    """Ratio of the element sizes of two meshes of a section, at least 1."""
    try:
        coarse, fine = sorted(element_count(section, divisions) for divisions in (first, second))
    except InputError:
        # A section added by a user: elements in proportion to divisions.
        return max(first, second) / min(first, second)
    return sqrt(fine / coarse)


def with_uncertainty(
    answers: Sequence[Answer],
    other_answers: Sequence[Answer] | None,
    legs: Sequence[Leg],
    options: ModelOptions,
    divisions: int,
) -> list[Answer]:
    """Answers with half-widths (95 %), from answers on a mesh with other `divisions`.

    The change between both meshes times Roache's factor, with r³ the ratio of their element counts
    (Celik et al., J. Fluids Eng. 130 (2008) 078001). The error on the coarse mesh is rᵖ times that
    on the fine one. Half-widths are infinite if `other_answers` is None.
    """
    if other_answers is None:
        frequencies = np.full_like(answers[0].frequencies, inf)
        loads = dict.fromkeys(answers[0].loads, np.full(6, inf))
        unknown = MeshUncertainty(np.full(6, inf), frequencies, divisions, loads=loads)
        return [replace(answer, uncertainty=unknown) for answer in answers]
    policy = mesh_policy(options, legs, divisions)

    def half_widths(first: Array, second: Array) -> Array:
        return mesh_half_widths([np.abs(first - second)], policy)

    results = []
    for answer, other_answer in zip(answers, other_answers, strict=True):
        uncertainty = MeshUncertainty(
            half_widths(np.diag(answer.compliance), np.diag(other_answer.compliance)),
            half_widths(answer.frequencies, other_answer.frequencies),
            divisions,
            loads={
                name: half_widths(answer.loads[name], other_answer.loads[name])
                for name in answer.loads
            },
        )
        results.append(replace(answer, uncertainty=uncertainty))
    return results


def mesh_policy(options: ModelOptions, legs: Sequence[Leg], divisions: int) -> MeshPolicy:
    """Rule for half-widths on the mesh of `options` from the change to one of other `divisions`."""
    present = options.divisions
    solid = [sectioned_leg(leg, options.equivalent) for leg in legs]
    order = min(formal_order(leg, options.ends) for leg in solid)
    along = max(present, divisions) / min(present, divisions)
    ratio = min(cbrt(along * _ratio(section_of(leg), present, divisions) ** 2) for leg in solid)
    return MeshPolicy.of_order(ratio if present > divisions else 1.0 / ratio, order)


def extrapolated(
    answers: Sequence[Answer],
    meshes: Mapping[int, Sequence[Answer]],
    legs: Sequence[Leg],
    options: ModelOptions,
) -> list[Answer]:
    """Answers on the finest of the `meshes` (by divisions), extrapolated if an order is observed.

    Each number is treated on its own, if there are at least four meshes and all sections are
    rectangles: walls keep one element across for several divisions, and would show only the order
    of their slices along the leg.
    """
    solid = [sectioned_leg(leg, options.equivalent) for leg in legs]
    if len(meshes) < GRIDS_FOR_ORDER or not all(
        isinstance(section_of(answer), Rectangle) for answer in solid
    ):
        return list(answers)
    divisions = tuple(sorted(meshes))
    elements = [
        sum(n * element_count(section_of(answer), n) for answer in solid) for n in divisions
    ]
    order = min(formal_order(leg, options.ends) for leg in solid)
    upper = np.triu_indices(6)
    diagonal, count = upper[0] == upper[1], len(upper[0])
    results = []
    for answer, *on_meshes in zip(answers, *(meshes[n] for n in divisions), strict=True):
        values = np.array(
            [
                np.append(mesh_answer.compliance[upper], mesh_answer.frequencies)
                for mesh_answer in on_meshes
            ]
        )
        sizes = np.cbrt(1.0 / np.array(elements))
        limits, widths = richardson_limits(sizes, values, order, ROUND_OFF)
        numbers = np.where(np.isnan(limits), values[-1], limits)
        compliance = np.zeros((6, 6))
        compliance[upper] = compliance.T[upper] = numbers[:count]
        mesh_uncertainty = answer.uncertainty
        if mesh_uncertainty is None:
            return list(answers)
        uncertainty = MeshUncertainty(
            _known(widths[:count][diagonal], mesh_uncertainty.compliance),
            _known(widths[count:], mesh_uncertainty.frequencies),
            mesh_uncertainty.divisions,
            divisions,
            loads=mesh_uncertainty.loads,
        )
        results.append(
            replace(
                answer, compliance=compliance, frequencies=numbers[count:], uncertainty=uncertainty
            )
        )
    return results


def _known(first: Array, otherwise: Array) -> Array:
    return np.where(np.isnan(first), otherwise, first)
