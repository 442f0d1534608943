"""Compliances of a mechanism over its path: models, ladders of causes, and the reference.

The reference assembles the mechanism from what its legs are: solids where they are prisms, the 6×6
of the file where they are given. Ladders climb by the virtual joint method where legs are serial
chains; it shares no code with the assembler.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Ends, GivenLeg, Leg, given_compliance
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models import serial_chains
from lumped.models.bodies import tip_compliances
from lumped.models.links import links
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, solved
from validation.adequacy.common.ladders import (
    given_leg_rungs,
    shear_rung,
    static_rungs,
    static_upper_rungs,
)
from validation.adequacy.legs import (
    ROUNDING,
    SECTION_DIVISIONS,
    SECTION_RATIO,
    finer_statics,
    held_spring,
    own_spring,
    restrained_spring,
    shares_section,
    solid_leg,
    solid_tip,
    step_uncertainty,
    straight_spring,
)
from validation.adequacy.mechanism.part_ladders import part_rungs
from validation.adequacy.mechanism.part_solids import (
    FINER_PARTS,
    Bodies,
    condensed_parts,
    refinement_share,
    solid_parts,
)
from validation.adequacy.mechanism.path import has_given, holds, known_legs, left_open, offered
from validation.adequacy.response import (
    UNSOLVED,
    Alternative,
    Reference,
    Response,
    Rung,
    statics_of,
)
from validation.context import Context
from validation.models.mechanism import answers
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions, PartLegs
from validation.models.part_legs import part_springs, require_legs
from validation.models.stepped_parts import why_not_stepped
from validation.parts.meshes import FINEST
from validation.solids.legs import COARSEST_WALLS

Springs = Mapping[str, Array]


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


def static_reference(context: Context, postures: Sequence[Posture]) -> Reference:
    """Solid or given legs, assembled; raises InputError where sections are too fine to mesh."""
    mechanism = postures[0].mechanism
    legs = known_legs(mechanism)
    solids = [leg for leg in legs.values() if isinstance(leg, ConstantLeg)]
    ratio = min((solid_leg(context, leg).ratio for leg in solids), default=1.0)
    section = _section_uncertainty(context, postures, legs)
    count = offered(context.robot_file.requirement.modes)
    is_open = left_open(mechanism)

    def answer(ends: Mapping[str, Ends], *, fine: bool = True, rung: int = FINEST) -> Array:
        tips = {body: solid_tip(context, leg, ends[body], fine=fine) for body, leg in legs.items()}
        return assembled(postures, tips, solid_parts(postures, count, ends, rung))

    stiff = next(iter(is_open.holds.values()))
    section = section + refinement_share(
        mechanism, lambda rung: _diagonals(answer(stiff, rung=rung))
    )
    alternatives = []
    for name, ends in is_open.holds.items():
        fine = answer(ends)
        step = np.full(section.shape, ROUNDING)
        if solids:
            step = step_uncertainty(_diagonals(answer(ends, fine=False)), _diagonals(fine), ratio)
        alternatives.append(Alternative(name, Response(compliance=fine), static=step + section))
    own = "fem.bodies.doubling.condensed_leg" if solids else "lumped.legs.given_compliance"
    return Reference(
        title=_title(mechanism, legs),
        alternatives=alternatives,
        open=is_open.what,
        decides=is_open.says,
        finer=FINER_PARTS if mechanism.parts else finer_statics(context, legs.values()),
        computed_by=(
            *((own,) if legs else ()),
            *(("validation.models.parts.reduced",) if mechanism.parts else ()),
            "lumped.system.solution.compliance",
        ),
    )


def _title(mechanism: Mechanism, legs: Mapping[str, Leg]) -> str:
    given = [name for name, leg in legs.items() if isinstance(leg, GivenLeg)]
    if mechanism.parts:
        solid = " and solid legs" if len(given) < len(legs) else ""
        own = f", {', '.join(given)} by their own 6×6" if given else ""
        return f"mechanism assembled from its parts as solids{solid}{own}"
    if not legs:
        return "mechanism of rigid bodies, assembled"
    if len(given) == len(legs):
        return "mechanism assembled from the legs' own 6×6"
    own = f" and {', '.join(given)} by their own 6×6" if given else ""
    return f"mechanism assembled from solid legs{own}"


def _section_uncertainty(
    context: Context, postures: Sequence[Posture], legs: Mapping[str, Leg]
) -> Array:
    """What section meshes leave open (p×6, relative) where both solids of a leg share one.

    By constants of that mesh and of one twice as fine; else zero.
    """
    shared = {name for name, leg in legs.items() if shares_section(context, leg)}
    if not shared:
        return np.zeros((len(postures), 6))

    def own(divisions: int) -> Array:
        springs = {
            name: own_spring(context, leg, divisions if name in shared else SECTION_DIVISIONS)
            for name, leg in legs.items()
        }
        return _diagonals(_climbing(postures)(postures, springs))

    return step_uncertainty(own(COARSEST_WALLS), own(SECTION_DIVISIONS), SECTION_RATIO)


def _diagonals(compliances: Array) -> Array:
    return np.diagonal(compliances, axis1=1, axis2=2)


def _climbing(
    postures: Sequence[Posture],
) -> Callable[[Sequence[Posture], Springs], Array]:
    if postures[0].mechanism.parts:
        return assembled
    return assembled if is_serial(postures) else summed


def static_ladders(context: Context, postures: Sequence[Posture]) -> dict[str, tuple[Rung, ...]]:
    """Rungs for statics by name of the model, each ladder from the model upwards."""
    mechanism = postures[0].mechanism
    alternatives, legs = holds(mechanism), known_legs(mechanism)
    climb = _climbing(postures)
    serial = climb is summed
    by = "virtual joints with " if serial else "links with "

    def joined(springs: Callable[[], Springs]) -> Response:
        return statics_of(lambda: climb(postures, springs()), UNSOLVED)

    def everywhere(springs: Callable[[], Springs]) -> dict[str, Response]:
        return dict.fromkeys(alternatives, joined(springs))

    def each(spring: Callable[[Leg], Array]) -> dict[str, Response]:
        return everywhere(lambda: {body: spring(leg) for body, leg in legs.items()})

    def idealised(parts: PartLegs) -> Response:
        return statics_of(
            partial(compliances, postures, "beam", ModelOptions(parts=parts)), UNSOLVED
        )

    def held(spring: Callable[[Context, Leg, Ends], Array]) -> dict[str, Response]:
        def springs(ends: Mapping[str, Ends]) -> Springs:
            return {body: spring(context, leg, ends[body]) for body, leg in legs.items()}

        return {name: joined(partial(springs, ends)) for name, ends in alternatives.items()}

    def straight(leg: Leg) -> Array:
        return straight_spring(leg) if isinstance(leg, GivenLeg) else given_compliance(leg)

    upper: tuple[Rung, ...] = ()
    if any(isinstance(leg, ConstantLeg) for leg in legs.values()):
        own = each(partial(own_spring, context))
        upper = static_upper_rungs(own, held(held_spring), held(restrained_spring))
    as_given = everywhere(partial(tip_compliances, mechanism))
    section: tuple[Rung, ...] = ()
    if has_given(mechanism):
        section = given_leg_rungs(by, each(straight), as_given)
    timoshenko = (
        dict.fromkeys(alternatives, idealised("equivalent"))
        if mechanism.parts
        else everywhere(partial(tip_compliances, mechanism, "equivalent"))
    )
    shear = shear_rung(by, timoshenko)
    drives = Rung(
        "drives only: bodies and joints rigid",
        f"{by}the legs as given",
        as_given,
        "use vjm" if serial else "use links",
    )
    idealisation = part_rungs(mechanism, alternatives, idealised)
    return static_rungs(drives, shear, section, upper, idealisation)
