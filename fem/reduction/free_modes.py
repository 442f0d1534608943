"""Lowest elastic modes of an unsupported solid, and a count of its rigid-body motions."""

from dataclasses import replace

import numpy as np

from fem.bodies.rooted import RootedBody
from fem.reduction.held import free_body
from fem.solvers.factor import Inertia
from fem.solvers.modes import CertifiedModes, lowest_modes
from lumped.errors import ComputationError
from lumped.models.bodies import RIGID_MOTIONS


def free_modes(rooted: RootedBody, count: int) -> CertifiedModes:
    """The lowest `count` elastic modes of the solid of `rooted`, without its support.

    The interfaces of the solid must be averaged or of Saint-Venant's kind, which do not stiffen it.
    The signs of the eigenvalues of K − σM count the rigid motions and the elastic modes below σ.
    Raises ComputationError if there are not six rigid motions, and errors as
    `fem.solvers.modes.lowest_modes` does.
    """
    body = free_body(rooted)
    body.require_count()

    def counted(sigma: float) -> Inertia:
        # The memory of the stiffness factor is released for the factor of the count.
        rooted.factor.give_up()
        return body.inertia(sigma)

    space = body.space()
    modes = lowest_modes(body.flexibility, body.mass, count, counted, body.state, space)
    rigid = rooted.free_inertia((np.pi * modes.frequencies[0]) ** 2).negative
    if rigid != RIGID_MOTIONS:
        raise ComputationError(
            f"{rigid} rigid-body modes found; a free body must have {RIGID_MOTIONS}",
            part=body.state,
        )
    return replace(modes, shapes=rooted.solid.transformation @ modes.shapes)
