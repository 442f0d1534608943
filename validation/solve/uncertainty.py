"""Numerical uncertainty of what `solve` says of solids, from other meshes of prisms and parts."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from math import cbrt, inf, sqrt
from typing import Any

import numpy as np

from fem.reduction.craig_bampton import frequency_bounds
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import Leg, equivalent_leg
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Posture
from lumped.sections import Rectangle, Section
from lumped.system.assembly import System, assembly
from lumped.system.sweep import swept
from meshes.section.section_blocks import element_count
from validation.adequacy.mechanism.parts import UNKNOWN, number_by_number, refinement_share
from validation.agreement.convergence import richardson_limits, step_factor
from validation.models.loads.displacements import displacements_of
from validation.models.mechanism import CUTOFF
from validation.models.options import ModelOptions, ReductionBy
from validation.models.parts import Hold, ReducedPart, is_held_as_said, reduced
from validation.parts.meshes import FINEST
from validation.solids.legs import GRIDS_FOR_ORDER, ROUND_OFF, formal_order
from validation.solve.answer import Answer, LeftOpen, MeshUncertainty, PartUncertainty

# Parts are reduced for statics alone by modes up to here (Hz), where they have none.
_STILL = 1e-3
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
    factor = step_factor(ratio if own > divisions else 1.0 / ratio, order)
    found = []
    for one, other in zip(answers, others, strict=True):
        left_open = MeshUncertainty(
            factor * np.abs(np.diag(one.compliance - other.compliance)),
            factor * np.abs(one.frequencies - other.frequencies),
            divisions,
            loads={
                name: factor * np.abs(one.loads[name] - other.loads[name]) for name in one.loads
            },
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


def of_parts(
    postures: Sequence[Posture],
    models: Mapping[str, BodyModel],
    count: int,
    by: ReductionBy = "fixed",
) -> list[PartUncertainty]:
    """What the parts of a mechanism, solids among its `models`, leave open in every posture.

    Of its compliance, `count` frequencies and displacements under its loads: each part on its three
    meshes, and with averaged interfaces in the place of rigid ones where the robot file does not
    say how they are held. All other bodies as they are; parts are reduced `by` their modes with
    interfaces fixed or free.
    """
    mechanism = postures[0].mechanism
    bodies, names = mechanism.parts, [load.name for load in mechanism.loads]
    solids = {name: one for name, one in models.items() if isinstance(one, ReducedPart)}
    highest = max((one.highest for one in solids.values()), default=_STILL)

    @cache
    def again(level: int, hold: Hold = "rigid") -> Array:
        own = {
            name: reduced(body, highest, CUTOFF["solid"] * highest, level, hold, by)
            for name, body in bodies.items()
        }
        whole = {**models, **own}
        found = swept(assembly(mechanism, whole), postures, count)
        diagonals = np.diagonal(found.compliances, axis1=1, axis2=2)
        moved = displacements_of(whole, postures).reshape(len(postures), -1)
        return np.hstack([diagonals, found.frequencies, moved])

    fine = again(FINEST)
    scale = np.hstack([np.abs(fine[:, : 6 + count]), _lengths(fine[:, 6 + count :])])

    def left_by_meshes(own: slice) -> Array:
        share = refinement_share(
            mechanism,
            lambda level: again(level)[:, own],
            lambda change, _: number_by_number(change, scale[:, own]),
        )
        return np.broadcast_to(share, fine[:, own].shape)

    # Compliances show one order together, frequencies another, displacements a third.
    kinds = slice(6), slice(6, 6 + count), slice(6 + count, None)
    share = np.hstack([left_by_meshes(own) for own in kinds])
    left = np.where(np.equal(share, UNKNOWN), np.inf, share * scale)
    said = all(is_held_as_said(body) for body in bodies.values())
    bracket = np.zeros_like(fine) if said else again(FINEST, "average") - fine
    prepared = assembly(mechanism, models)

    def split(values: Array) -> dict[str, Any]:
        loads = zip(names, values[6 + count :].reshape(-1, 6), strict=True)
        return {
            "compliance": values[:6],
            "frequencies": values[6 : 6 + count],
            "loads": dict(loads),
        }

    return [
        PartUncertainty(
            **split(of_meshes),
            bracket=LeftOpen(**split(of_holding)),
            reduction=_bound(prepared.at(at), solids, count),
            counted={name: (one.counted, one.cutoff) for name, one in solids.items()},
            by=by,
        )
        for at, of_meshes, of_holding in zip(postures, left, bracket, strict=True)
    ]


def _lengths(moved: Array) -> Array:
    """Lengths of translations and rotations (p×6l), one for each of their components."""
    sizes = np.linalg.norm(moved.reshape(len(moved), -1, 3), axis=2)
    return np.repeat(sizes, 3, axis=1)


def _bound(system: System, solids: Mapping[str, ReducedPart], count: int) -> Array:
    """Most by which the first frequencies (Hz) are too high for the modes that parts have not."""
    if not count:
        return np.zeros(0)
    found = frequency_bounds(system, solids, count)
    return np.asarray(found.upper - found.lower)
