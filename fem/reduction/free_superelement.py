"""Ends free to warp as the interface of a superelement.

The twist of a free end is the work conjugate q = Bᵀu of Saint-Venant's loads B, not an unknown of
the mesh. With both twists given, K u = B λ + f and Bᵀu = q. The leg held at its root alone gives
everything: its response to forces G (`FreeEnds`), to unit wrenches at the tip U = G B_tip, and the
tip's compliance C = B_tipᵀU. Then Ψ_tip = U C⁻¹, Ψ_root = R − Ψ_tip X with the rigid motions R and
their transport X from root to tip, and A = G − U C⁻¹ Uᵀ is the response with both ends held.
"""

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from fem.bodies.solid import ClampedLeg, section_twists
from fem.couplings.end_coupling import FreeEnds
from fem.reduction.superelement import HeldLeg, ends_stiffness
from lumped.arrays import Array, SparseMatrix
from lumped.errors import InputError
from lumped.screws import shift


def held_free_leg(clamped: ClampedLeg) -> HeldLeg:
    """A solid leg with the twists of both free ends given, on the displacements u (3N) of its mesh.

    `clamped` is the leg factorised with ends "free". Its centreline gives section means, which
    differ from the ends' twists by the warping there. Raises InputError for rigid ends.
    """
    ends, solid = clamped.ends, clamped.solid
    if not isinstance(ends, FreeEnds) or solid is None:
        raise InputError("the leg has rigid ends: its superelement is that of its leg matrices")
    free = ends

    def rooted_flexibility(forces: Array) -> Array:
        loads = free.equilibrated(forces.reshape(len(forces), -1))
        return free.expanded(clamped.factor.solve(loads)).reshape(forces.shape)

    response = rooted_flexibility(free.free_tip_loads)
    compliance = free.free_tip_loads.T @ response
    factor = cho_factor(0.5 * (compliance + compliance.T))
    tip_modes = cho_solve(factor, response.T).T
    to_tip = shift(np.array([solid.leg.length, 0.0, 0.0]))

    def flexibility(forces: Array) -> Array:
        held: Array = rooted_flexibility(forces) - tip_modes @ (response.T @ forces)
        return held

    def centreline(stations: Array) -> SparseMatrix:
        return section_twists(solid.mesh, stations)

    return HeldLeg(
        model="solid",
        length=solid.leg.length,
        constraint_modes=np.hstack([free.motions - tip_modes @ to_tip, tip_modes]),
        stiffness=ends_stiffness(cho_solve(factor, np.eye(6)), solid.leg.length),
        flexibility=flexibility,
        mass=solid.mass,
        centreline=centreline,
    )
