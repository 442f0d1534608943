"""Numerical uncertainty of what `solve` says of CAD parts: of meshes, and of how they are held."""

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from fem.reduction.craig_bampton import frequency_bounds
from lumped.arrays import Array
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import System, assembly
from lumped.system.sweep import swept
from validation.models.loads.displacements import displacements_of
from validation.models.options import ReductionBy
from validation.models.reduced_parts import Hold, ReducedPart, is_held_as_said, reduced
from validation.models.robot_models import CUTOFF
from validation.parts.meshes import FINEST, LEVELS
from validation.references.reference_parts import UNKNOWN, part_policy
from validation.solve.answer import LeftOpen, PartUncertainty
from validation.uncertainty.combiners import relative_sizes
from validation.uncertainty.mesh_half_widths import half_widths_on

# Parts are reduced for statics alone by modes up to here (Hz), where they have none.
_STILL = 1e-3


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
        share = half_widths_on(
            LEVELS,
            part_policy(mechanism),
            lambda level: again(level)[:, own],
            lambda one, other, _: relative_sizes(one - other, scale[:, own]),
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
