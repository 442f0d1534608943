"""Numerical uncertainty of `solve` due to CAD parts: meshes, interfaces and reduction.

Input: postures and models of the bodies. Output: `PartUncertainty` in each posture. Rule: each part
is solved on its three meshes, and with averaged instead of rigid interfaces if the robot file does
not specify them.
"""

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np

from fem.reduction.craig_bampton import frequency_bounds
from lumped.arrays import Array
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import System, assembly
from lumped.system.sweep import swept
from validation.models.loads.displacements import displacements_of
from validation.models.options import ReductionBy
from validation.models.reduced_parts import Hold, ReducedPart, has_specified_couplings, reduced
from validation.models.robot_models import CUTOFF
from validation.parts.meshes import FINEST, LEVELS
from validation.references.reference_parts import UNKNOWN, part_policy
from validation.solve.answer import HalfWidths, PartUncertainty
from validation.uncertainty.combiners import relative_sizes
from validation.uncertainty.mesh_half_widths import half_widths_on

# Cut-off frequency (Hz) of CAD parts in statics, below all their modes.
_LOWEST_CUTOFF = 1e-3


def of_parts(
    postures: Sequence[Posture],
    models: Mapping[str, BodyModel],
    count: int,
    by: ReductionBy = "fixed",
) -> list[PartUncertainty]:
    """Uncertainty due to the CAD parts of a mechanism, in each posture.

    It covers the compliance, `count` frequencies and displacements under the loads. `models` of all
    bodies contain the parts as solids; other bodies are unchanged. `by`: reduction with modes of
    fixed or free interfaces.
    """
    mechanism = postures[0].mechanism
    bodies, names = mechanism.parts, [load.name for load in mechanism.loads]
    solids = {name: part for name, part in models.items() if isinstance(part, ReducedPart)}
    highest = max((part.highest for part in solids.values()), default=_LOWEST_CUTOFF)

    @cache
    def again(level: int, hold: Hold = "rigid") -> Array:
        parts = {
            name: reduced(body, highest, CUTOFF["solid"] * highest, level, hold, by)
            for name, body in bodies.items()
        }
        all_models = {**models, **parts}
        sweep = swept(assembly(mechanism, all_models), postures, count)
        diagonals = np.diagonal(sweep.compliances, axis1=1, axis2=2)
        displaced = displacements_of(all_models, postures).reshape(len(postures), -1)
        return np.hstack([diagonals, sweep.frequencies, displaced])

    fine = again(FINEST)
    scale = np.hstack([np.abs(fine[:, : 6 + count]), _lengths(fine[:, 6 + count :])])

    def mesh_shares(columns: slice) -> Array:
        share = half_widths_on(
            LEVELS,
            part_policy(mechanism),
            lambda level: again(level)[:, columns],
            lambda first, second, _: relative_sizes(first - second, scale[:, columns]),
        )
        return np.broadcast_to(share, fine[:, columns].shape)

    # Compliances have one common order of convergence, frequencies another, displacements a third.
    kinds = slice(6), slice(6, 6 + count), slice(6 + count, None)
    share = np.hstack([mesh_shares(columns) for columns in kinds])
    half_widths = np.where(np.equal(share, UNKNOWN), np.inf, share * scale)
    all_specified = all(has_specified_couplings(body) for body in bodies.values())
    bracket = np.zeros_like(fine) if all_specified else again(FINEST, "average") - fine
    prepared = assembly(mechanism, models)

    def split(values: Array) -> HalfWidths:
        diagonal, frequencies, displacements = np.split(values, [6, 6 + count])
        loads = dict(zip(names, displacements.reshape(-1, 6), strict=True))
        return HalfWidths(diagonal, frequencies, loads=loads)

    return [
        PartUncertainty(
            of_meshes.compliance,
            of_meshes.frequencies,
            loads=of_meshes.loads,
            bracket=of_ends,
            reduction=_bound(prepared.at(posture), solids, count),
            counted={name: (part.counted, part.cutoff) for name, part in solids.items()},
            by=by,
        )
        for posture, of_meshes, of_ends in zip(
            postures, map(split, half_widths), map(split, bracket), strict=True
        )
    ]


def _lengths(displacements: Array) -> Array:
    """Lengths of translations and of rotations (p×6l), repeated for each of their components.

    Shapes: p postures, l loads.
    """
    sizes = np.linalg.norm(displacements.reshape(len(displacements), -1, 3), axis=2)
    return np.repeat(sizes, 3, axis=1)


def _bound(system: System, solids: Mapping[str, ReducedPart], count: int) -> Array:
    """Bounds (Hz) on the increase of the first frequencies due to modes that the parts lack."""
    if not count:
        return np.zeros(0)
    bounds = frequency_bounds(system, solids, count)
    return np.asarray(bounds.upper - bounds.lower)
