"""Compliances of a mechanism over its path: models, the assembler, and virtual joints."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, Leg
from lumped.mechanism.mechanism import Posture
from lumped.models import serial_chains
from lumped.models.bodies import tip_compliances
from lumped.models.links import links
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, solved
from validation.adequacy.mechanism.digits import left_by_digits
from validation.adequacy.mechanism.part_solids import Bodies, condensed_parts, solid_parts
from validation.adequacy.mechanism.path import known_legs, left_open, offered
from validation.adequacy.subject.posed import Springs, Statics
from validation.context import Context
from validation.models.mechanism import answers
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.models.part_legs import part_springs, require_legs
from validation.models.stepped_parts import why_not_stepped


def compliances(postures: Sequence[Posture], model: ModelName, options: ModelOptions) -> Array:
    """What a model of the mechanism answers to unit wrenches at the loaded point (p×6×6, SI)."""
    return np.array([answer.compliance for answer in answers(model, postures, 0, options)])


def is_serial(postures: Sequence[Posture]) -> str:
    """Empty where virtual joints can be summed along every leg, else why they cannot."""
    mechanism = postures[0].mechanism
    try:
        require_legs(mechanism)
        springs = tip_compliances(mechanism) | part_springs(mechanism, DEFAULT_OPTIONS)
        serial_chains.serial_chains(postures[0], springs)
    except serial_chains.NoChainError as error:
        return error.reason
    except InputError as error:
        return str(error)
    return ""


def unanswered(postures: Sequence[Posture], model: ModelName, options: ModelOptions) -> str:
    """Empty where a model answers for the mechanism, else why it cannot."""
    if options.parts == "stepped":
        return why_not_stepped(postures[0].mechanism)
    return is_serial(postures) if model == "vjm" else ""


def assembled(postures: Sequence[Posture], springs: Springs, parts: Bodies | None = None) -> Array:
    """Compliances (p×6×6) by the assembler, every leg by its tip's compliance (6×6).

    `parts`: models of those bodies that are CAD parts; condensed on their interfaces without.
    """
    mechanism = postures[0].mechanism
    of_parts = condensed_parts(mechanism) if parts is None else parts
    prepared = assembly(mechanism, {**links(mechanism, springs), **of_parts})
    return np.array([compliance(solved(prepared.at(posture))) for posture in postures])


def summed(postures: Sequence[Posture], springs: Springs) -> Array:
    """The same by virtual joints along serial chains."""
    return np.array([serial_chains.compliance(posture, springs) for posture in postures])


def mechanism_statics(context: Context, postures: Sequence[Posture]) -> Statics:
    """What computes deflections in these postures; by the assembler where vjm cannot, or parts."""
    mechanism = postures[0].mechanism
    legs, parts = known_legs(mechanism), bool(mechanism.parts)
    count = offered(context.robot_file.requirement.modes)
    solid = any(isinstance(leg, ConstantLeg) for leg in legs.values())
    own = "fem.bodies.doubling.condensed_leg" if solid else "lumped.legs.given_compliance"
    serial = not (parts or is_serial(postures))
    return Statics(
        context,
        assembled_title("mechanism", legs, parts=parts),
        legs,
        left_open(mechanism),
        mechanism if parts else None,
        answer=partial(compliances, postures),
        unanswered=partial(unanswered, postures),
        assembled=lambda tips, ends, rung: assembled(
            postures, tips, solid_parts(postures, count, ends, rung)
        ),
        climbed=partial(summed if serial else assembled, postures),
        climbs="vjm" if serial else "links",
        tips=partial(tip_compliances, mechanism),
        rigid="bodies and joints rigid",
        computed_by=(
            *((own,) if legs else ()),
            *(("validation.models.parts.reduced",) if parts else ()),
            "lumped.system.solution.compliance",
        ),
        digits=partial(context.get, left_by_digits, context.robot_file.text, tuple(postures)),
    )


def assembled_title(robot: str, legs: Mapping[str, Leg], *, parts: bool = False) -> str:
    """What models of a "robot", say, are held against in statics."""
    given = [name for name, leg in legs.items() if isinstance(leg, GivenLeg)]
    if parts:
        solid = " and solid legs" if len(given) < len(legs) else ""
        own = f", {', '.join(given)} by their own 6×6" if given else ""
        return f"{robot} assembled from its parts as solids{solid}{own}"
    if not legs:
        return f"{robot} of rigid bodies, assembled"
    if len(given) == len(legs):
        return f"{robot} assembled from the legs' own 6×6"
    own = f" and {', '.join(given)} by their own 6×6" if given else ""
    return f"{robot} assembled from solid legs{own}"
