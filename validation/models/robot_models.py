"""Compliance and modes of any mechanism by each model, in its postures.

Input: postures of one mechanism, name and options of a model. Output: 6×6 compliance at the loaded
point, natural frequencies and modes. Rule: static models are condensed to the interfaces of their
bodies, which is exact; dynamic models are reduced with all modes below a cut-off frequency, which
is raised until it covers the requested modes. Equal bodies are modelled once for all postures.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import ceil, isclose, log2
from typing import NamedTuple, TypeVar

import numpy as np

from fem.beams.stepped import SteppedLeg
from fem.reduction.craig_bampton import CUTOFF_FACTOR
from lumped.arrays import Array
from lumped.dense.modes import Modes, too_few
from lumped.equivalent_leg import sectioned_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, LineLeg, SectionedLeg, sectioned_compliance
from lumped.mechanism.body_model import BodyModel, LegMatrices
from lumped.mechanism.joint import Joint
from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.memo import memo
from lumped.models import serial_chains
from lumped.models.bodies import legs_of, link, links, tip_compliances
from lumped.system.assembly import Assembly, System, assembly
from lumped.system.joint_motion import Portion, printed_release
from lumped.system.response import DampedModes, HarmonicResponse, damped_modes, harmonic_responses
from lumped.system.solution import (
    Solved,
    compliance,
    modes,
    modes_with_mass,
    solved,
    strain_shares,
)
from lumped.system.sweep import swept
from validation.models import reduced_parts
from validation.models.leg_models import (
    condensed_leg,
    filled,
    leg_matrices,
    reduced_leg,
)
from validation.models.options import DEFAULT_OPTIONS, STATIC, ModelName, ModelOptions, PartLegs
from validation.models.part_legs import part_models, part_springs, require_legs
from validation.parts.meshes import FINEST


class PartMeshing(NamedTuple):
    """Mesh level of CAD parts, and coupling of interfaces for which the robot file states none."""

    level: int = FINEST
    hold: reduced_parts.Hold = "rigid"


FINE_PARTS = PartMeshing()
T = TypeVar("T")
# Largest relative difference of the lengths of legs that count as equal. Points in a robot file may
# have only twelve digits.
_ALIKE = 1e-9
# Number of frequencies that are compared one by one.
JUDGED_MODES = 4
# Ratio of the cut-off frequency to the highest frequency of interest, by model. Beams and segments
# are cheap to reduce well: the error at the highest frequency falls with the seventh power of this
# factor, to 1e-5 at 2.5 and below 1e-6 at four.
CUTOFF = {"segments": 4.0, "beam": 4.0, "solid": CUTOFF_FACTOR}
# Total number of unknowns up to which a direct solution is as fast as a reduction.
FEW = 600
# Coarse beams for estimates: their frequencies lie above the true ones (Rayleigh), and frequencies
# of solids are hardly higher than those.
_ESTIMATE = ModelOptions(elements=2)


@dataclass(frozen=True, eq=False)
class PostureAnswer:
    """Compliance and frequencies of a mechanism by a model, in one posture.

    `compliance` (6×6, SI, base axes) at the loaded point. `frequencies` (Hz, ascending) exclude the
    zero frequencies of the `idle` mobilities, which do not move the tool.
    """

    posture: Posture
    compliance: Array
    frequencies: Array
    idle: int


def answers(
    model: ModelName,
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> list[PostureAnswer]:
    """Compliance and the lowest `count` frequencies of one mechanism in each posture.

    `simplified` has at most `count` frequencies: as many as its rigid bodies have elastic motions.
    Raises InputError for frequencies of a static model and for a leg that is not a serial chain
    (vjm), and ComputationError if the tool is free to move.
    """
    if not postures:
        return []
    mechanism = postures[0].mechanism
    if count:
        _require_dynamic_model(model)
    if model == "vjm":
        springs = springs_of(mechanism, options)
        return [
            PostureAnswer(
                released_mechanism,
                serial_chains.compliance(released_mechanism, springs),
                np.zeros(0),
                mobility(released_mechanism).idle,
            )
            for released_mechanism in postures
        ]
    if model == "simplified":
        if not count:
            return _swept(assembly(on_drives_alone(mechanism), {}), postures, 0)
        return [
            PostureAnswer(result.posture, result.compliance, result.modes.frequencies, result.idle)
            for result in modes_on_drives(postures, count)
        ]
    postures = released(postures, options)
    released_mechanism = postures[0].mechanism
    if not count:
        return _swept(
            assembly(released_mechanism, static_bodies(model, mechanism, options)), postures, 0
        )
    return with_dynamic_bodies(
        model,
        mechanism,
        lambda bodies: _swept(assembly(released_mechanism, bodies), postures, count),
        lambda results: np.array([result.frequencies for result in results]),
        postures,
        count,
        options,
    )


@dataclass(frozen=True, eq=False)
class PostureModes:
    """Compliance and lowest modes of a mechanism in one posture. Idle motions are omitted.

    `compliance` (6×6, SI, base axes) at the loaded point.
    """

    posture: Posture
    solution: Solved
    compliance: Array
    modes: Modes

    @property
    def system(self) -> System:
        """Assembled system of the mechanism."""
        return self.solution.system

    @property
    def idle(self) -> int:
        """Number of mobilities that do not move the tool."""
        return self.solution.idle

    def first(self, count: int) -> "PostureModes":
        """Solution with the first `count` modes only."""
        frequencies, shapes = self.modes.frequencies[:count], self.modes.shapes[:, :count]
        return replace(self, modes=Modes(frequencies, shapes))

    @cached_property
    def strain(self) -> Mapping[Portion, Array]:
        """Share of each mode's strain energy in each drive, body and elastic part of a joint.

        Shares of a body are listed by kind of deformation if its model distinguishes kinds. The
        shares of a mode sum to 1.
        """
        return strain_shares(self.system, self.modes.shapes)

    @cached_property
    def damped(self) -> DampedModes:
        """Complex modes, accurate up to the highest frequency of the undamped modes."""
        return damped_modes(self.solution, float(self.modes.frequencies.max(initial=0.0)))

    @cached_property
    def responses(self) -> tuple[HarmonicResponse, ...]:
        """Responses to each excitation of the mechanism."""
        return harmonic_responses(self.solution)


def mechanism_modes(
    model: ModelName,
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
    part_mesh: PartMeshing = FINE_PARTS,
    spare: int = 0,
) -> list[PostureModes]:
    """Lowest `count` modes of one mechanism in each posture. `simplified` may have fewer.

    `part_mesh`: mesh and coupling of CAD parts as solids. `spare`: number of modes that are
    computed in addition, as far as they exist. The cut-off frequency of the reduction is not raised
    for them.

    Raises InputError for a static model, and ComputationError if the tool is free to move or, for
    any model except `simplified`, fewer than `count` modes move mass.
    """
    _require_dynamic_model(model)
    if not postures:
        return []
    mechanism = postures[0].mechanism
    if model == "simplified":
        return list(modes_on_drives(postures, count))
    postures = released(postures, options)

    def solve(bodies: Mapping[str, BodyModel]) -> list[PostureModes]:
        prepared = assembly(postures[0].mechanism, bodies)
        solutions = list(modes_along(prepared, postures, count + spare))
        if any(len(solution.modes.frequencies) < count for solution in solutions):
            raise too_few(mechanism.name, count)
        return solutions

    return with_dynamic_bodies(
        model,
        mechanism,
        solve,
        lambda solutions: np.array([solution.modes.frequencies[:count] for solution in solutions]),
        postures,
        count,
        options,
        part_mesh,
    )


def modes_on_drives(postures: Sequence[Posture], count: int) -> Iterator[PostureModes]:
    """Lowest `count` modes of rigid bodies on elastic drives. All modes if fewer move mass."""
    rigid = on_drives_alone(postures[0].mechanism)
    return modes_along(assembly(rigid, {}), postures, count)


def modes_along(
    prepared: Assembly, postures: Sequence[Posture], count: int
) -> Iterator[PostureModes]:
    """Lowest `count` modes of an assembly in each posture. All modes if fewer move mass.

    Raises ComputationError if round-off dominates the compliance at the loaded point: frequencies
    of such a system are as wrong as its compliance, without any sign of it.
    """
    for system in prepared.along(postures):
        solution = solved(system)
        at_tool = compliance(solution)
        yield PostureModes(system.posture, solution, at_tool, modes_with_mass(solution, count))


def springs_of(mechanism: Mechanism, options: ModelOptions) -> dict[str, Array]:
    """Tip compliance (6×6, SI, body axes) of each leg and CAD part for the virtual joint method.

    Raises InputError for a CAD part that does not have exactly two interfaces.
    """
    require_legs(mechanism)
    springs = tip_compliances(mechanism, options.legs, options.theory, options.equivalent)
    return springs | part_springs(mechanism, options)


def with_enough_modes(
    solve: Callable[[float], T],
    frequencies: Callable[[T], Array],
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> T:
    """Solution by `solve` with bodies reduced up to a frequency (Hz) that covers `count` modes.

    The first estimate of that frequency is by beams. Restrained warping of open sections can raise
    frequencies far above it. Therefore `solve` is repeated until the `frequencies` of the solution
    lie below the limit of the reduction. More modes in the reduction only lower frequencies
    (Rayleigh), so the second reduction suffices, apart from round-off.
    """
    highest = highest_frequency(postures, count, options)
    while (highest_solved := float(np.max(frequencies(solution := solve(highest))))) > highest:
        highest = _half_octave_above(highest_solved)
    return solution


def with_dynamic_bodies(
    model: ModelName,
    mechanism: Mechanism,
    solve: Callable[[Mapping[str, BodyModel]], T],
    frequencies: Callable[[T], Array],
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
    part_mesh: PartMeshing = FINE_PARTS,
) -> T:
    """Solution by `solve` with models of the bodies of `mechanism`, accurate for `count` modes.

    Bodies that are not reduced have all their modes, and are solved once. If bodies are reduced,
    `solve` is repeated as in `with_enough_modes`, until the `frequencies` of its solution lie below
    the limit of the reduction. `part_mesh`: mesh and coupling of CAD parts as solids.
    """
    if unreduced := _unreduced_bodies(model, mechanism, options):
        return solve(unreduced)
    return with_enough_modes(
        lambda highest: solve(dynamic_bodies(model, mechanism, highest, options, part_mesh)),
        frequencies,
        postures,
        count,
        options,
    )


def static_bodies(
    model: ModelName, mechanism: Mechanism, options: ModelOptions = DEFAULT_OPTIONS
) -> dict[str, BodyModel]:
    """Model of each body on the twists of its interfaces, exact in statics."""
    if model == "links":
        springs = tip_compliances(mechanism, options.legs, options.theory, options.equivalent)
        part_legs: PartLegs = "equivalent" if options.legs == "equivalent" else "condensed"
        link_options = replace(options, parts=part_legs)
        return dict(links(mechanism, springs)) | part_models(mechanism, link_options, _link)
    if model == "solid":
        options = replace(options, parts="condensed")
    return bodies_of(mechanism, options, partial(condensed_leg, model))


def dynamic_bodies(
    model: ModelName,
    mechanism: Mechanism,
    highest: float,
    options: ModelOptions = DEFAULT_OPTIONS,
    part_mesh: PartMeshing = FINE_PARTS,
) -> dict[str, BodyModel]:
    """Model of each body, accurate for frequencies of the mechanism up to `highest` (Hz).

    Bodies are reduced, unless beams or segments have so few unknowns that reduction saves no time.
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
    unreduced = _unreduced_bodies(model, mechanism, options)
    return bodies_of(mechanism, options, reduced) if unreduced is None else unreduced


def _unreduced_bodies(
    model: ModelName, mechanism: Mechanism, options: ModelOptions
) -> dict[str, BodyModel] | None:
    """Model of each body with all its modes. None if reduced models save time."""
    if model == "solid":
        return None
    bodies = bodies_of(mechanism, options, partial(leg_matrices, model))
    return bodies if sum(body_model.size for body_model in bodies.values()) <= FEW else None


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
    """Model of each leg and CAD part, made by `build` if the body is modelled as a leg."""
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
    return link(leg.length, sectioned_compliance(leg, options.theory))


def highest_frequency(
    postures: Sequence[Posture], count: int, options: ModelOptions = DEFAULT_OPTIONS
) -> float:
    """Frequency (Hz) up to which bodies must be accurate for `count` modes, by coarse beams.

    The estimate is made in the middle posture and covers all excitations. It is rounded up in steps
    of half an octave, so that other postures and counts can use the same bodies.
    """
    middle = postures[len(postures) // 2]
    # An element adds six modes to a leg, half of which are close to the true ones.
    legs = max(1, len(legs_of(middle.mechanism)) + len(middle.mechanism.parts))
    coarse = replace(
        _ESTIMATE,
        equivalent=options.equivalent,
        theory=options.theory,
        elements=max(_ESTIMATE.elements, ceil(count / (3 * legs))),
    )
    return _highest_by_beams(middle, count, coarse)


@memo(64)
def _highest_by_beams(middle: Posture, count: int, coarse: ModelOptions) -> float:
    bodies = bodies_of(middle.mechanism, coarse, partial(leg_matrices, "beam"))
    solution = solved(assembly(middle.mechanism, bodies).at(middle))
    # Rigid bodies and condensed CAD parts may have fewer than `count` modes with mass.
    only_legs = legs_of(middle.mechanism) and not middle.mechanism.parts
    frequencies = (modes if only_legs else modes_with_mass)(solution, count).frequencies
    if not len(frequencies):
        raise too_few(middle.mechanism.name, count)
    excited = [excitation.last for excitation in middle.mechanism.excitations]
    return _half_octave_above(max([float(frequencies[-1]), *excited]))


def _half_octave_above(frequency: float) -> float:
    return float(2.0 ** (0.5 * ceil(2.0 * log2(frequency))))


def _require_dynamic_model(model: ModelName) -> None:
    if model in STATIC:
        raise InputError(
            f"--modes: model {model} is static and has no frequencies; leave --modes out or "
            "choose another --model"
        )


def released(postures: Sequence[Posture], options: ModelOptions) -> Sequence[Posture]:
    """Postures whose joints are released by eq. (25) as printed in the paper.

    This is done if `options.release` is "printed". Otherwise, the postures are returned unchanged.
    """
    if options.release != "printed":
        return postures
    printed = as_printed(postures[0].mechanism)
    return [replace(posture, mechanism=printed) for posture in postures]


def _swept(prepared: Assembly, postures: Sequence[Posture], count: int) -> list[PostureAnswer]:
    results = swept(prepared, postures, count)
    rows = zip(postures, results.compliances, results.frequencies, results.idle, strict=True)
    return [PostureAnswer(*row) for row in rows]


def sectioned_legs(
    mechanism: Mechanism, options: ModelOptions
) -> list[tuple[str, SectionedLeg, ModelOptions]]:
    """Name, leg with its section, and model options of each leg of a mechanism.

    A leg specified by its 6×6 is replaced by its equivalent prism. Equal legs are one object.

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
