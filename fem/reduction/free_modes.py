"""Lowest elastic modes of a solid that nothing holds, with its rigid-body motions counted."""

from dataclasses import replace

import numpy as np

from fem.bodies.rooted import RootedBody
from fem.reduction.held import free_body
from fem.solvers.factor import Inertia
from fem.solvers.modes import CertifiedModes, lowest_modes
from lumped.errors import ComputationError
from lumped.models.bodies import RIGID_MOTIONS


def free_modes(rooted: RootedBody, count: int) -> CertifiedModes:
    """The lowest `count` elastic modes of a solid with nothing held.

    Its interfaces must not stiffen it: averaged or Saint-Venant ones. The inertia of the shifted
    stiffness counts the elastic modes and, below them, the rigid motions. Raises ComputationError
    if there are not six of these, and errors like `fem.solvers.modes.lowest_modes`.
    """
    body = free_body(rooted)

    def counted(sigma: float) -> Inertia:
        # The factor of the stiffness leaves its memory to that of the count.
        rooted.factor.give_up()
        signs = rooted.free_inertia(sigma)
        return signs._replace(negative=signs.negative - RIGID_MOTIONS)

    space = body.space()
    modes = lowest_modes(body.flexibility, body.mass, count, counted, body.state, space)
    rigid = rooted.free_inertia((np.pi * modes.frequencies[0]) ** 2).negative
    if rigid != RIGID_MOTIONS:
        raise ComputationError(
            f"{rigid} rigid-body modes found; a free body must have {RIGID_MOTIONS}",
            part=body.state,
        )
    return replace(modes, shapes=rooted.solid.transformation @ modes.shapes)
