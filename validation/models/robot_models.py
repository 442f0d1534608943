"""Every model of any mechanism: models of its bodies, and what they say in a posture.

Bodies are modelled once, however many are alike and however many postures follow. Static models
are condensed to their interfaces, which is exact; dynamic ones are reduced with modes.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import ceil, isclose, log2
from typing import TypeVar

import numpy as np

from fem.beams.stepped import SteppedLeg
from fem.reduction.craig_bampton import CUTOFF_FACTOR
from lumped.arrays import Array
from lumped.dense.modes import Modes, too_few
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, tip_compliance
from lumped.mechanism.body_model import BodyModel, LegMatrices
from lumped.mechanism.joint import Joint
from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.memo import memo
from lumped.models import serial_chains
from lumped.models.bodies import legs_of, link, links, tip_compliances
from lumped.system.assembly import Assembly, System, assembly
from lumped.system.joint_motion import Portion, printed_release
from lumped.system.response import DampedModes, ToolResponse, damped_modes, tool_responses
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

T = TypeVar("T")
# Bodies whose lengths differ by what twelve typed digits leave are one body.
_ALIKE = 1e-9
# Frequencies that are compared one by one.
JUDGED_MODES = 4
# Beams and segments are cheap to reduce well: the error at the highest frequency falls with the
# seventh power of the cut-off, 1e-5 at 2.5 times and below 1e-6 at four.
CUTOFF = {"segments": 4.0, "beam": 4.0, "solid": CUTOFF_FACTOR}
# Unknowns in all that are solved as fast as they would be reduced.
FEW = 600
# Frequencies of few elements lie above the true ones (Rayleigh), those of solids by little more.
_ESTIMATE = ModelOptions(elements=2)


@dataclass(frozen=True, eq=False)
class PostureAnswer:
    """What a model says of a mechanism in one posture.

    `compliance` (6×6, SI, base axes) at the loaded point, `frequencies` (Hz, ascending), `idle`
    the number of mobilities that do not move the tool, whose zero frequencies are left out.
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
    """Compliance and the lowest `count` frequencies in each posture of one mechanism.

    `simplified` has as many frequencies as its rigid bodies and its tool have, at most `count`.
    Raises InputError for frequencies of a static model and for a leg that is no serial chain
    (vjm), ComputationError where the tool is free to move.
    """
    if not postures:
        return []
    mechanism = postures[0].mechanism
    if count:
        _require_mass(model)
    if model == "vjm":
        springs = springs_of(mechanism, options)
        return [
            PostureAnswer(at, serial_chains.compliance(at, springs), np.zeros(0), mobility(at).idle)
            for at in postures
        ]
    if model == "simplified":
        if not count:
            return _swept(assembly(on_drives_alone(mechanism), {}), postures, 0)
        return [
            PostureAnswer(one.posture, one.compliance, one.modes.frequencies, one.idle)
            for one in modes_on_drives(postures, count)
        ]
    postures = released(postures, options)
    at = postures[0].mechanism
    if not count:
        return _swept(assembly(at, static_bodies(model, mechanism, options)), postures, 0)
    return with_enough_modes(
        lambda highest: _swept(
            assembly(at, dynamic_bodies(model, mechanism, highest, options)), postures, count
        ),
        lambda found: np.array([one.frequencies for one in found]),
        postures,
        count,
        options,
    )


@dataclass(frozen=True, eq=False)
class PostureModes:
    """The lowest modes of a mechanism in one posture, idle motions left out."""

    posture: Posture
    solution: Solved
    modes: Modes

    @property
    def system(self) -> System:
        """The assembled mechanism."""
        return self.solution.system

    @property
    def idle(self) -> int:
        """Number of mobilities that do not move the tool."""
        return self.solution.idle

    @cached_property
    def compliance(self) -> Array:
        """6×6 (SI, base axes) at the loaded point; raises as `lumped.system.solution` does."""
        return compliance(self.solution)

    @cached_property
    def strain(self) -> Mapping[Portion, Array]:
        """Share of each mode's strain energy in every drive, body and elastic part of a joint.

        Of a body by kind of deformation where its model knows it; those of a mode sum to 1.
        """
        return strain_shares(self.system, self.modes.shapes)

    @cached_property
    def damped(self) -> DampedModes:
        """The complex modes, good for as many as there are real ones."""
        return damped_modes(self.solution, float(self.modes.frequencies.max(initial=0.0)))

    @cached_property
    def responses(self) -> tuple[ToolResponse, ...]:
        """The answers of the tool to the excitations of the mechanism."""
        return tool_responses(self.solution)


def mechanism_modes(
    model: ModelName,
    postures: Sequence[Posture],
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> list[PostureModes]:
    """The lowest `count` modes in each posture of one mechanism; of rigid bodies as many as are.

    Raises InputError for a static model, ComputationError where the tool is free to move and where
    fewer modes have mass.
    """
    _require_mass(model)
    if not postures:
        return []
    mechanism = postures[0].mechanism
    if model == "simplified":
        return list(modes_on_drives(postures, count))
    postures = released(postures, options)

    def solve(highest: float) -> list[PostureModes]:
        bodies = dynamic_bodies(model, mechanism, highest, options)
        found = list(modes_along(assembly(postures[0].mechanism, bodies), postures, count))
        if any(len(one.modes.frequencies) < count for one in found):
            raise too_few(mechanism.name, count)
        return found

    return with_enough_modes(
        solve,
        lambda found: np.array([one.modes.frequencies for one in found]),
        postures,
        count,
        options,
    )


def modes_on_drives(postures: Sequence[Posture], count: int) -> Iterator[PostureModes]:
    """At most `count` modes of rigid bodies on elastic drives, as many as have mass."""
    rigid = on_drives_alone(postures[0].mechanism)
    return modes_along(assembly(rigid, {}), postures, count)


def modes_along(
    prepared: Assembly, postures: Sequence[Posture], count: int
) -> Iterator[PostureModes]:
    """At most `count` modes in each posture, as many as have mass; one posture after the other."""
    for system in prepared.along(postures):
        solution = solved(system)
        yield PostureModes(system.posture, solution, modes_with_mass(solution, count))


def springs_of(mechanism: Mechanism, options: ModelOptions) -> dict[str, Array]:
    """Tip compliances (6×6, SI, body axes) that virtual joints take of legs and parts.

    Raises InputError for a part that is no leg.
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
    """`solve` with bodies reduced up to a frequency (Hz), again with more where that was low.

    What beams lead to expect, end faces that hold warping in open sections may exceed by far: what
    counts are the solution's own `frequencies`. More modes only lower them (Rayleigh), so that the
    second reduction suffices but for rounding.
    """
    highest = highest_frequency(postures, count, options)
    while (top := float(np.max(frequencies(solution := solve(highest))))) > highest:
        highest = _half_octave_above(top)
    return solution


def static_bodies(
    model: ModelName, mechanism: Mechanism, options: ModelOptions = DEFAULT_OPTIONS
) -> dict[str, BodyModel]:
    """Models of the bodies on the twists of their interfaces alone, exact in statics."""
    if model == "links":
        springs = tip_compliances(mechanism, options.legs, options.theory, options.equivalent)
        whole: PartLegs = "equivalent" if options.legs == "equivalent" else "condensed"
        own = replace(options, parts=whole)
        return dict(links(mechanism, springs)) | part_models(mechanism, own, _link)
    if model == "solid":
        options = replace(options, parts="condensed")
    return bodies_of(mechanism, options, partial(condensed_leg, model))


def dynamic_bodies(
    model: ModelName,
    mechanism: Mechanism,
    highest: float,
    options: ModelOptions = DEFAULT_OPTIONS,
) -> dict[str, BodyModel]:
    """Models of the bodies good for frequencies of the mechanism up to `highest` (Hz).

    Reduced, unless beams or segments are so few that they are solved as they stand.
    """
    cutoff = CUTOFF[model] * highest

    def reduced(leg: ConstantLeg | SteppedLeg, own: ModelOptions) -> LegMatrices:
        return reduced_leg(model, leg, own, highest, cutoff)

    if model == "solid":
        legs = constant_legs(mechanism, options)
        bodies = mechanism.parts
        return {name: filled(reduced(leg, own)) for name, leg, own in legs} | {
            name: reduced_parts.reduced(body, highest, cutoff, by=options.reduction)
            for name, body in bodies.items()
        }
    whole = bodies_of(mechanism, options, partial(leg_matrices, model))
    if sum(one.size for one in whole.values()) <= FEW:
        return whole
    return bodies_of(mechanism, options, reduced)


def bodies_of(
    mechanism: Mechanism,
    options: ModelOptions,
    build: Callable[[ConstantLeg | SteppedLeg, ModelOptions], LegMatrices],
) -> dict[str, BodyModel]:
    """Every leg, and every part that a leg stands for, as `build` makes it."""
    legs: dict[str, BodyModel] = {
        name: filled(build(leg, own)) for name, leg, own in constant_legs(mechanism, options)
    }
    return legs | part_models(mechanism, options, lambda leg, own: filled(build(leg, own)))


def _link(leg: ConstantLeg | SteppedLeg, options: ModelOptions) -> LegMatrices:
    if isinstance(leg, SteppedLeg):
        return condensed_leg("beam", leg, options)
    return link(leg.length, tip_compliance(leg.properties(options.theory), leg.length))


def highest_frequency(
    postures: Sequence[Posture], count: int, options: ModelOptions = DEFAULT_OPTIONS
) -> float:
    """Frequency (Hz) up to which bodies should be good for the first `count`, by coarse beams.

    In the middle posture, and for all excitations; rounded up in steps of half an octave, so that
    others share the bodies.
    """
    middle = postures[len(postures) // 2]
    # Half of the six modes that an element adds to a leg are near the true ones.
    legs = max(1, len(legs_of(middle.mechanism)) + len(middle.mechanism.parts))
    coarse = replace(
        _ESTIMATE,
        equivalent=options.equivalent,
        theory=options.theory,
        elements=max(_ESTIMATE.elements, ceil(count / (3 * legs))),
    )
    return _by_beams(middle, count, coarse)


@memo(64)
def _by_beams(middle: Posture, count: int, coarse: ModelOptions) -> float:
    bodies = bodies_of(middle.mechanism, coarse, partial(leg_matrices, "beam"))
    solution = solved(assembly(middle.mechanism, bodies).at(middle))
    # Parts on their interfaces alone have few modes, and so have rigid bodies.
    only_legs = legs_of(middle.mechanism) and not middle.mechanism.parts
    found = (modes if only_legs else modes_with_mass)(solution, count).frequencies
    if not len(found):
        raise too_few(middle.mechanism.name, count)
    excited = [one.last for one in middle.mechanism.excitations]
    return _half_octave_above(max([float(found[-1]), *excited]))


def _half_octave_above(frequency: float) -> float:
    return float(2.0 ** (0.5 * ceil(2.0 * log2(frequency))))


def _require_mass(model: ModelName) -> None:
    if model in STATIC:
        raise InputError(f"--modes: the {model} model is static and has no frequencies")


def released(postures: Sequence[Posture], options: ModelOptions) -> Sequence[Posture]:
    """With the joints as they are printed, where that is asked for."""
    if options.release != "printed":
        return postures
    printed = as_printed(postures[0].mechanism)
    return [replace(at, mechanism=printed) for at in postures]


def _swept(prepared: Assembly, postures: Sequence[Posture], count: int) -> list[PostureAnswer]:
    found = swept(prepared, postures, count)
    each = zip(postures, found.compliances, found.frequencies, found.idle, strict=True)
    return [PostureAnswer(*one) for one in each]


def constant_legs(
    mechanism: Mechanism, options: ModelOptions
) -> list[tuple[str, ConstantLeg, ModelOptions]]:
    """Every leg as a constant-section one, alike ones the same, with its own ends as options.

    With `release="printed"` the last spring of a leg carries the joint at its tip that `as_printed`
    fixes in the `mechanism` given here as it is described.
    """
    known: list[ConstantLeg] = []
    legs = []
    for name, described in legs_of(mechanism).items():
        leg = equivalent_leg(described, options.equivalent)
        alike = next((one for one in known if _are_alike(one, leg)), leg)
        known.append(alike)
        told = replace(options, ends=leg.ends or options.ends)
        if not any(_at_tip(mechanism, joint) == name for joint in mechanism.joints):
            told = replace(told, release="condensed")
        legs.append((name, alike, told))
    return legs


def as_printed(mechanism: Mechanism) -> Mechanism:
    """The passive revolute joints of a mechanism as eq. (25) prints their release.

    Row and column of the rotation of a joint's own stiffness are zeroed, which is a joint in series
    with a give that is uncoupled from it. Where a joint has none and the tip of a leg is its second
    side, the last spring of that leg's segments is released so instead: the joint itself is fixed.
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
    """The leg whose last spring carries a passive revolute joint where it is printed; "" if none.

    The second side of the joint is that leg's tip, and the joint has no give of its own.
    """
    if joint.kind != "revolute" or joint.drive is not None or joint.compliance is not None:
        return ""
    body = mechanism.bodies[joint.second.body]
    is_leg = isinstance(body.shape, ConstantLeg | GivenLeg)
    return body.name if is_leg and joint.second.point == tuple(body.interfaces)[1] else ""


def _are_alike(one: ConstantLeg, other: ConstantLeg) -> bool:
    return (
        one.section == other.section
        and one.material == other.material
        and isclose(one.length, other.length, rel_tol=_ALIKE)
    )


def on_drives_alone(mechanism: Mechanism) -> Mechanism:
    """The mechanism without the joints' own give, its drives as the simplified model has them."""
    return replace(mechanism, joints=tuple(_simplified(joint) for joint in mechanism.joints))


def _simplified(joint: Joint) -> Joint:
    drive = joint.drive
    if drive is not None and drive.simplified is not None:
        drive = replace(drive, stiffness=drive.simplified, simplified=None)
    return replace(joint, drive=drive, compliance=None)
