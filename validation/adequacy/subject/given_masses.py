"""Legs known by a 6×6 and a mass alone, with the masses that they plausibly have.

Statics are those of the 6×6. Between the ends a leg is taken to bend as its equivalent prism does;
its mass lies along it as in that prism, or in one lump with the inertia that the file gives. The
truth, which only a mass distribution can tell, is likely between what the two of them answer.
"""

from typing import Literal, TypeAlias

import numpy as np
from scipy.sparse import csr_array

from fem.beams.beam import beam_leg
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import ENDS, ends_stiffness, held_leg
from lumped.arrays import Array, SparseMatrix
from lumped.dense.modes import dense
from lumped.legs import GivenLeg, equivalent_leg
from lumped.mechanism.body_model import LegMatrices

Masses: TypeAlias = Literal["mass as in a prism", "mass and inertia as given"]
MASSES: tuple[Masses, ...] = ("mass as in a prism", "mass and inertia as given")
_ELEMENTS = 20


def leg_with_masses(leg: GivenLeg, masses: Masses, highest: float) -> LegMatrices:
    """The leg's own stiffness between its ends and plausible masses, up to `highest` (Hz).

    Without `mass_centre` the lump lies in the middle, without `inertia` it is a point.
    """
    prism = equivalent_leg(leg)
    held = held_leg(beam_leg(prism.timoshenko, prism.length, _ELEMENTS))
    own = ends_stiffness(np.linalg.inv(leg.compliance).astype(float), leg.length)
    if masses == "mass as in a prism":
        reduced = craig_bampton(held, highest).matrices
        stiffness = dense(reduced.stiffness).copy()
        stiffness[:ENDS, :ENDS] = own
        return LegMatrices(
            model=f"6×6, {masses}",
            length=leg.length,
            stiffness=csr_array(stiffness),
            mass=reduced.mass,
            centreline=reduced.centreline,
        )

    def centreline(stations: Array) -> SparseMatrix:
        return csr_array(held.centreline(stations) @ held.constraint_modes)

    centre = 0.5 * leg.length if leg.mass_centre is None else leg.mass_centre
    lump = np.diag([leg.mass] * 3 + [0.0] * 3)
    if leg.inertia is not None:
        lump[3:, 3:] = leg.inertia
    motion = centreline(np.array([centre])).toarray()
    return LegMatrices(
        model=f"6×6, {masses}",
        length=leg.length,
        stiffness=csr_array(own),
        mass=csr_array(motion.T @ lump @ motion),
        centreline=centreline,
    )
