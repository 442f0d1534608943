"""CAD parts with two interfaces as legs of lumped and beam models.

Input: a body that is a CAD part, and options. Output: its `BodyModel`: by its 6×6 compliance, as an
equivalent or stepped leg, or condensed. The x axis of the leg that represents the part runs from
the point of the first interface to that of the second; its z axis is as near as possible to the z
axis of the part's file.
"""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse import block_diag as sparse_block_diag
from scipy.sparse import csr_array, eye_array, issparse

from fem.beams.stepped import SteppedLeg
from lumped.arrays import Array, SparseMatrix
from lumped.beam_properties import tip_compliance
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.legs import GivenLeg, SectionedLeg
from lumped.mechanism.body import Body, Frame
from lumped.mechanism.body_model import ENDS, BodyModel, LegMatrices
from lumped.mechanism.mechanism import Mechanism
from lumped.screws import turn, turn_matrix
from lumped.text import counted
from validation.models.options import ModelOptions
from validation.models.reduced_parts import condensed, identified, is_leg, leg_axes
from validation.models.stepped_parts import stepped


def given_leg(body: Body) -> GivenLeg:
    """CAD part as a leg in leg axes, specified by its identified compliance and mass."""
    start, end = (frame.position for frame in body.interfaces.values())
    part = identified(body)
    compliance = turn_matrix(part.compliance, leg_axes(body).rotation.T)
    return GivenLeg(float(np.linalg.norm(end - start)), part.total, compliance)


def require_legs(mechanism: Mechanism) -> None:
    """Raise InputError if a CAD part does not have exactly two interfaces."""
    faults = [
        (
            f"bodies.{name}: a part with {counted(len(body.interfaces), 'interface')} cannot "
            "be a link of a serial chain; use --model links"
        )
        for name, body in mechanism.parts.items()
        if not is_leg(body)
    ]
    if faults:
        raise InputError(faults)


def part_springs(mechanism: Mechanism, options: ModelOptions) -> dict[str, Array]:
    """Tip compliance (6×6, SI, body axes) of each CAD part with two interfaces, by body name.

    It is the compliance identified from the solid part, or that of the equivalent prism if
    `options.legs` is "equivalent".
    """
    springs = {}
    for name, body in mechanism.parts.items():
        if is_leg(body) and options.legs == "equivalent":
            leg = equivalent_leg(given_leg(body), options.equivalent)
            leg_compliance = tip_compliance(leg.properties(options.theory), leg.length)
            springs[name] = turn_matrix(leg_compliance, leg_axes(body).rotation)
        elif is_leg(body):
            springs[name] = identified(body).compliance
    return springs


def part_models(
    mechanism: Mechanism,
    options: ModelOptions,
    build: Callable[[SectionedLeg | SteppedLeg, ModelOptions], LegMatrices],
) -> dict[str, BodyModel]:
    """Model of each CAD part by `options.parts`: a leg made by `build`, or the condensed part.

    A part that does not have two interfaces is condensed in any case.
    """
    models = {}
    for name, body in mechanism.parts.items():
        if not is_leg(body) or options.parts == "condensed":
            models[name] = condensed(body)
            continue
        leg: SectionedLeg | SteppedLeg
        if options.parts == "stepped":
            leg = stepped(body)
        else:
            leg = equivalent_leg(given_leg(body), options.equivalent)
        models[name] = placed_leg(build(leg, options), leg_axes(body), tuple(body.interfaces))
    return models


def placed_leg(leg: LegMatrices, frame: Frame, interfaces: Sequence[str]) -> BodyModel:
    """Model of a body with two `interfaces` from the matrices of a leg; the first is at its root.

    `frame`: leg axes in body axes. The twists of the ends are rotated to body axes, all other
    unknowns are kept. An interface before the root or beyond the tip moves rigidly with the end
    section.
    """
    to_leg = turn(frame.rotation).T
    size = leg.size - 6 * len(ENDS)
    rotation: Array | SparseMatrix
    if issparse(leg.stiffness):
        rotation = csr_array(sparse_block_diag([to_leg, to_leg, eye_array(size)], format="csr"))
    else:
        rotation = block_diag(to_leg, to_leg, np.eye(size))

    def displacements(points: Array) -> SparseMatrix:
        local = (points - frame.position) @ frame.rotation
        stations = np.clip(local[:, 0], 0.0, leg.length)
        arms = local - np.outer(stations, [1.0, 0.0, 0.0])
        transfers = [
            np.hstack([frame.rotation, _rotation_to_displacement(frame.rotation, arm)])
            for arm in arms
        ]
        twists = leg.centreline(stations) @ csr_array(rotation)
        return csr_array(sparse_block_diag(transfers, format="csr") @ twists)

    return BodyModel(
        leg.model,
        tuple(interfaces),
        rotation.T @ leg.stiffness @ rotation,
        rotation.T @ leg.mass @ rotation,
        displacements,
        {kind: rotation.T @ part @ rotation for kind, part in leg.parts.items()},
    )


def _rotation_to_displacement(rotation: Array, arm: Array) -> Array:
    """Matrix (3×3) of φ ↦ R (φ × r), with R = `rotation` and r = `arm`; φ is in leg axes."""
    return np.asarray(rotation @ np.cross(np.eye(3), arm).T)
