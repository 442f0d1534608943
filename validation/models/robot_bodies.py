"""Bodies and joints of a robot as each model represents them.

Input: a mechanism, name and options of a model. Output: a `BodyModel` for each body, and the
mechanism with the joints of the model. Rule: static models are condensed to the interfaces of their
bodies, which is exact; dynamic models are reduced with all modes below a cut-off frequency. Equal
bodies are modelled once for all postures.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import isclose
from typing import NamedTuple

import numpy as np

from fem.beams.stepped import SteppedLeg
from fem.reduction.craig_bampton import CUTOFF_FACTOR
from lumped.arrays import Array
from lumped.equivalent_leg import sectioned_leg
from lumped.legs import ConstantLeg, GivenLeg, LineLeg, SectionedLeg, given_compliance
from lumped.mechanism.body_model import BodyModel, LegMatrices
from lumped.mechanism.joint import Joint
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of, link, links, tip_compliances
from lumped.system.assembly import Assembly, assembly
from lumped.system.joint_motion import printed_release
from validation.models import reduced_parts
from validation.models.leg_models import (
    condensed_leg,
    filled,
    leg_matrices,
    reduced_leg,
)
from validation.models.options import DEFAULT_OPTIONS, OF_ELEMENTS, STATIC, ModelName, ModelOptions
from validation.models.part_legs import part_models, part_springs, require_legs
from validation.parts.meshes import FINEST


class PartMeshing(NamedTuple):
    """Mesh level of CAD parts, and coupling of interfaces for which the robot file states none."""

    level: int = FINEST
    hold: reduced_parts.Hold = "rigid"


FINE_PARTS = PartMeshing()
# Largest relative difference of the lengths of legs that count as equal. Points in a robot file may
# have only twelve digits.
_ALIKE = 1e-9
# Ratio of the cut-off frequency to the highest frequency of interest, by model. Beams and segments
# are cheap to reduce well: the error at the highest frequency falls with the seventh power of this
# factor, to 1e-5 at 2.5 and below 1e-6 at four.
CUTOFF: Mapping[str, float] = {**dict.fromkeys(OF_ELEMENTS, 4.0), "solid": CUTOFF_FACTOR}
# Total number of unknowns up to which a direct solution is as fast as a reduction.
FEW = 600


def springs_of(mechanism: Mechanism, options: ModelOptions) -> dict[str, Array]:
    """Tip compliance (6×6, SI, body axes) of each leg and CAD part for the virtual joint method.

    Raises InputError for a CAD part that does not have exactly two interfaces.
    """
    require_legs(mechanism)
    springs = tip_compliances(mechanism, options.legs, options.theory, options.equivalent)
    return springs | part_springs(mechanism, options)


def static_bodies(
    model: ModelName, mechanism: Mechanism, options: ModelOptions = DEFAULT_OPTIONS
) -> dict[str, BodyModel]:
    """Matrices of each leg and CAD part for statics, by name of the body.

    `model` represents the legs. The unknowns of a body are only the twists of its interfaces, to
    which it is condensed without an error in statics. The virtual joint method has the bodies of
    links.
    """
    if model in STATIC:
        springs = tip_compliances(mechanism, options.legs, options.theory, options.equivalent)
        link_options = replace(
            options, parts="equivalent" if options.legs == "equivalent" else "condensed"
        )
        return dict(links(mechanism, springs)) | part_models(mechanism, link_options, _link)
    if model == "solid":
        options = replace(options, parts="condensed")
    return bodies_of(mechanism, options, partial(condensed_leg, model))


def static_assembly(
    model: ModelName, postures: Sequence[Posture], options: ModelOptions = DEFAULT_OPTIONS
) -> Assembly:
    """Assembly of one mechanism for statics. The virtual joint method has the one of links."""
    mechanism = postures[0].mechanism
    if model == "simplified":
        return assembly(on_drives_alone(mechanism), {})
    bodies = static_bodies(model, mechanism, options)
    return assembly(released(postures, options)[0].mechanism, bodies)


def dynamic_bodies(
    model: ModelName,
    mechanism: Mechanism,
    highest: float,
    options: ModelOptions = DEFAULT_OPTIONS,
    part_mesh: PartMeshing = FINE_PARTS,
) -> dict[str, BodyModel]:
    """Matrices of each leg and CAD part, for frequencies of the mechanism up to `highest` (Hz).

    Bodies are reduced, unless beams or segments have so few unknowns that reduction saves no time.
    `part_mesh`: mesh and coupling of CAD parts as solids.
    """
    bodies = unreduced_bodies(model, mechanism, options)
    return (
        reduced_bodies(model, mechanism, highest, options, part_mesh) if bodies is None else bodies
    )


def unreduced_bodies(
    model: ModelName, mechanism: Mechanism, options: ModelOptions
) -> dict[str, BodyModel] | None:
    """Matrices of each leg and CAD part with all its modes. None if reduction saves time."""
    if model == "solid":
        return None
    bodies = bodies_of(mechanism, options, partial(leg_matrices, model))
    return bodies if sum(body_model.size for body_model in bodies.values()) <= FEW else None


def reduced_bodies(
    model: ModelName,
    mechanism: Mechanism,
    highest: float,
    options: ModelOptions,
    part_mesh: PartMeshing = FINE_PARTS,
) -> dict[str, BodyModel]:
    """Matrices of each leg and CAD part, reduced to modes below a cut-off above `highest` (Hz).

    `part_mesh`: mesh and coupling of CAD parts as solids.
    """
    cutoff = CUTOFF[model] * highest

    def reduced(leg: SectionedLeg | SteppedLeg, leg_options: ModelOptions) -> LegMatrices:
        return reduced_leg(model, leg, leg_options, highest, cutoff)

    if model == "solid":
        legs = sectioned_legs(mechanism, options)
        return {
            name: filled(reduced(leg, leg_options)) for name, leg, leg_options in legs
        } | reduced_parts_of(mechanism, highest, options, part_mesh)
    return bodies_of(mechanism, options, reduced)


def reduced_parts_of(
    mechanism: Mechanism, highest: float, options: ModelOptions, part_mesh: PartMeshing
) -> dict[str, BodyModel]:
    """CAD parts as solids, reduced for frequencies up to `highest` (Hz). Exact in statics."""
    cutoff = CUTOFF["solid"] * highest
    return {
        name: reduced_parts.reduced(body, highest, cutoff, *part_mesh, options.reduction)
        for name, body in mechanism.parts.items()
    }


def bodies_of(
    mechanism: Mechanism,
    options: ModelOptions,
    build: Callable[[SectionedLeg | SteppedLeg, ModelOptions], LegMatrices],
) -> dict[str, BodyModel]:
    """Matrices of each leg and CAD part, made by `build` if the body is modelled as a leg."""
    legs: dict[str, BodyModel] = {
        name: filled(build(leg, leg_options))
        for name, leg, leg_options in sectioned_legs(mechanism, options)
    }
    return legs | part_models(
        mechanism, options, lambda leg, leg_options: filled(build(leg, leg_options))
    )


def _link(leg: SectionedLeg | SteppedLeg, options: ModelOptions) -> LegMatrices:
    if isinstance(leg, SteppedLeg):
        return condensed_leg("beam", leg, options)
    return link(leg.length, given_compliance(leg, options.theory))


def released(postures: Sequence[Posture], options: ModelOptions) -> Sequence[Posture]:
    """Postures whose joints are released by eq. (25) as printed in the paper.

    This is done if `options.release` is "printed". Otherwise, the postures are returned unchanged.
    """
    if options.release != "printed":
        return postures
    printed = as_printed(postures[0].mechanism)
    return [replace(posture, mechanism=printed) for posture in postures]


def sectioned_legs(
    mechanism: Mechanism, options: ModelOptions
) -> list[tuple[str, SectionedLeg, ModelOptions]]:
    """Name, leg with its section, and model options of each leg of a mechanism.

    A leg specified by its 6×6 compliance is replaced by its equivalent prism. Equal legs are one
    object.

    If `options.release` is "printed", the last spring of a leg contains the joint at its tip;
    `as_printed` fixes that joint in the mechanism.
    """
    representatives: list[SectionedLeg] = []
    legs = []
    for name, description in legs_of(mechanism).items():
        leg = sectioned_leg(description, options.equivalent)
        representative = next(
            (candidate for candidate in representatives if _are_equal(candidate, leg)), leg
        )
        representatives.append(representative)
        leg_options = replace(options, ends=leg.ends or options.ends)
        if not any(_at_tip(mechanism, joint) == name for joint in mechanism.joints):
            leg_options = replace(leg_options, release="condensed")
        legs.append((name, representative, leg_options))
    return legs


def as_printed(mechanism: Mechanism) -> Mechanism:
    """Mechanism whose passive revolute joints are released as eq. (25) of the paper prints it.

    In the stiffness of a joint with compliance, the couplings of the free rotation with all other
    motions are deleted; this equals the deletion of its row and column. If a joint has no
    compliance and its second side is the tip of a leg, the last spring of that leg's segments is
    released instead, and the joint is fixed.
    """
    return replace(mechanism, joints=tuple(_printed(mechanism, j) for j in mechanism.joints))


def _printed(mechanism: Mechanism, joint: Joint) -> Joint:
    if joint.kind != "revolute" or joint.drive is not None:
        return joint
    if _at_tip(mechanism, joint):
        return replace(joint, kind="fixed", axes=np.zeros((0, 3)))
    if joint.compliance is not None:
        stiffness: Array = np.linalg.inv(joint.compliance).astype(float)
        uncoupled = printed_release(stiffness)
        uncoupled[5, 5] = stiffness[5, 5]
        return replace(joint, compliance=np.linalg.inv(uncoupled).astype(float))
    return joint


def _at_tip(mechanism: Mechanism, joint: Joint) -> str:
    """Name of the leg whose tip is the second side of `joint`, if the joint has no spring.

    The paper's printed release changes the last spring of this leg if the joint is passive and
    revolute. "" for any other joint.
    """
    if joint.kind != "revolute" or joint.drive is not None or joint.compliance is not None:
        return ""
    body = mechanism.bodies[joint.second.body]
    is_leg = isinstance(body.shape, ConstantLeg | GivenLeg | LineLeg)
    return body.name if is_leg and joint.second.point == tuple(body.interfaces)[1] else ""


def _are_equal(leg: SectionedLeg, other: SectionedLeg) -> bool:
    if isinstance(leg, LineLeg) or isinstance(other, LineLeg):
        return leg == other
    return (
        leg.section == other.section
        and leg.material == other.material
        and isclose(leg.length, other.length, rel_tol=_ALIKE)
    )


def on_drives_alone(mechanism: Mechanism) -> Mechanism:
    """Mechanism with elastic drives and rigid joints.

    Drives have the stiffness of the simplified model.
    """
    return replace(mechanism, joints=tuple(_simplified(joint) for joint in mechanism.joints))


def _simplified(joint: Joint) -> Joint:
    drive = joint.drive
    if drive is not None and drive.simplified is not None:
        drive = replace(drive, stiffness=drive.simplified, simplified=None, screw=None)
    return replace(joint, drive=drive, compliance=None)
