"""Parts of two interfaces as legs: what lumped and beam models put in their place.

A leg's x axis runs from the first interface's point to the second's, its z axis as nearly as it can
along the z axis of the file.
"""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse import block_diag as sparse_block_diag
from scipy.sparse import csr_array, eye_array, issparse

from fem.beams.stepped import SteppedLeg
from lumped.arrays import Array, SparseMatrix
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, tip_compliance
from lumped.mechanism.body import Body, Frame
from lumped.mechanism.body_model import ENDS, BodyModel, LegMatrices
from lumped.mechanism.mechanism import Mechanism
from lumped.screws import turn, turn_matrix
from lumped.text import counted
from validation.models.options import ModelOptions
from validation.models.reduced_parts import condensed, identified, is_leg, leg_axes
from validation.models.stepped_parts import stepped


def given_leg(body: Body) -> GivenLeg:
    """A part by its identified 6×6 and its mass, leg axes."""
    start, end = (frame.position for frame in body.interfaces.values())
    found = identified(body)
    compliance = turn_matrix(found.compliance, leg_axes(body).rotation.T)
    return GivenLeg(float(np.linalg.norm(end - start)), found.total, compliance)


def require_legs(mechanism: Mechanism) -> None:
    """Raise InputError for parts that are no legs: those of one interface, or of three and more."""
    others = [
        f"bodies.{name}: a part of {counted(len(body.interfaces), 'interface')} cannot be a link "
        "of a serial chain; use links"
        for name, body in mechanism.parts.items()
        if not is_leg(body)
    ]
    if others:
        raise InputError(others)


def part_springs(mechanism: Mechanism, options: ModelOptions) -> dict[str, Array]:
    """Compliance (6×6, SI, body axes) of every part that is a leg, as `options.legs` asks."""
    springs = {}
    for name, body in mechanism.parts.items():
        if is_leg(body) and options.legs == "equivalent":
            leg = equivalent_leg(given_leg(body), options.equivalent)
            own = tip_compliance(leg.properties(options.theory), leg.length)
            springs[name] = turn_matrix(own, leg_axes(body).rotation)
        elif is_leg(body):
            springs[name] = identified(body).compliance
    return springs


def part_models(
    mechanism: Mechanism,
    options: ModelOptions,
    build: Callable[[ConstantLeg | SteppedLeg, ModelOptions], LegMatrices],
) -> dict[str, BodyModel]:
    """Every part as `options.parts` asks: legs in its place by `build`, or condensed.

    Parts of one interface, or of three and more, are condensed in any case.
    """
    models = {}
    for name, body in mechanism.parts.items():
        if not is_leg(body) or options.parts == "condensed":
            models[name] = condensed(body)
            continue
        leg: ConstantLeg | SteppedLeg
        if options.parts == "stepped":
            leg = stepped(body)
        else:
            leg = equivalent_leg(given_leg(body), options.equivalent)
        models[name] = placed_leg(build(leg, options), leg_axes(body), tuple(body.interfaces))
    return models


def placed_leg(leg: LegMatrices, frame: Frame, interfaces: Sequence[str]) -> BodyModel:
    """The leg as the model of a body with two `interfaces`, the first at the leg's root.

    `frame`: the leg's axes in those of the body. Of the unknowns only the ends' twists turn. What
    lies before the root or behind the tip moves with the section there.
    """
    back = turn(frame.rotation).T
    size = leg.size - 6 * len(ENDS)
    turned: Array | SparseMatrix
    if issparse(leg.stiffness):
        turned = csr_array(sparse_block_diag([back, back, eye_array(size)], format="csr"))
    else:
        turned = block_diag(back, back, np.eye(size))

    def displacements(points: Array) -> SparseMatrix:
        own = (points - frame.position) @ frame.rotation
        stations = np.clip(own[:, 0], 0.0, leg.length)
        arms = own - np.outer(stations, [1.0, 0.0, 0.0])
        carried = [np.hstack([frame.rotation, _carried(frame.rotation, arm)]) for arm in arms]
        twists = leg.centreline(stations) @ csr_array(turned)
        return csr_array(sparse_block_diag(carried, format="csr") @ twists)

    return BodyModel(
        leg.model,
        tuple(interfaces),
        turned.T @ leg.stiffness @ turned,
        turned.T @ leg.mass @ turned,
        displacements,
        {kind: turned.T @ part @ turned for kind, part in leg.parts.items()},
    )


def _carried(rotation: Array, arm: Array) -> Array:
    """φ ↦ R (φ × r) for rotations in leg axes."""
    return np.asarray(rotation @ np.cross(np.eye(3), arm).T)
