"""How near to buckling the designer's own loads bring every model, and what stiffness they take.

Each model has its own statics, that of its bodies on their interfaces. Between these legs bend as
beams do, whatever the model: so they buckle, and so what they carry stiffens or softens them.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from fem.beams.prestressed import PrestressedLeg, between, prestressed_leg
from lumped.acceptance.quantities import AXES, Quantity, load_quantities
from lumped.acceptance.requirement import Requirement
from lumped.arrays import dense
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, Theory
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import Posture
from lumped.memo import memo
from lumped.system.assembly import Assembly, assembly
from lumped.system.loads import loading
from lumped.system.prestress import Prestressed, geometric_stiffness
from lumped.system.solution import solved
from lumped.system.stability import Stability, stability
from validation.drawing.text import number, percent
from validation.models.leg_models import filled
from validation.models.loads.displacements import load_masses
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.models.robot_models import (
    constant_legs,
    on_drives_alone,
    released,
    static_bodies,
)

# Buckling of a leg between clamped ends is off by 2e-4 with ten elements, by less with any others;
# of its modes with held ends these leave 1e-4.
_ELEMENTS, _MODES = 10, 24
# Less is left open of no error.
_NOTHING = 1e-3


def stabilities(
    model: ModelName,
    postures: Sequence[Posture],
    options: ModelOptions = DEFAULT_OPTIONS,
    count: int = 0,
) -> list[list[Stability | None]]:
    """Of each posture under each of the loads, with the lowest `count` frequencies.

    None where the mechanism cannot move as a load says. Raises as `displacements` does.
    """
    mechanism = postures[0].mechanism
    if not mechanism.loads:
        return [[] for _ in postures]
    masses = load_masses(model, mechanism, options)
    prepared, legs = prestressed_assembly(model, postures, options)

    found: list[list[Stability | None]] = []
    for at in postures:
        solution = solved(prepared.at(at))
        row: list[Stability | None] = []
        for load in mechanism.loads:
            try:
                ones = loading(at, load, masses)
            except ComputationError:
                row.append(None)
                continue
            geometric = geometric_stiffness(solution, ones, legs)
            row.append(stability(solution, geometric, ones, count))
        found.append(row)
    return found


def prestressed_assembly(
    model: ModelName, postures: Sequence[Posture], options: ModelOptions
) -> tuple[Assembly, dict[str, Prestressed]]:
    """The mechanism with such bodies, and what forces in its legs add to their stiffness."""
    mechanism = postures[0].mechanism
    if model == "simplified":
        return assembly(on_drives_alone(mechanism), {}), {}
    # Virtual joints are links where they can be summed.
    own = static_bodies("links" if model == "vjm" else model, mechanism, options)
    bodies = {name: filled(body) for name, body in own.items()}
    legs: dict[str, Prestressed] = {}
    for name, leg, _ in constant_legs(mechanism, options):
        bent = _prestressed(leg, options.theory)
        bodies[name] = between(bent, dense(own[name].stiffness))
        legs[name] = bent.geometric_stiffness
    return assembly(released(postures, options)[0].mechanism, bodies), legs


@memo(64)
def _prestressed(leg: ConstantLeg, theory: Theory) -> PrestressedLeg:
    try:
        properties = leg.properties(theory)
    except ComputationError:
        # Where the formula of κ does not hold solids have stiff ends all the same.
        properties = leg.properties("euler-bernoulli")
    return prestressed_leg(properties, leg.length, _ELEMENTS, _MODES)


def stability_notes(
    postures: Sequence[Posture],
    found: Sequence[Sequence[Stability | None]],
    requirement: Requirement,
) -> tuple[str, ...]:
    """A line for each load that takes stiffness: where it is nearest to buckling, and how much.

    `found` in each posture under each load.
    """
    loads = load_quantities([load.name for load in postures[0].mechanism.loads])
    return tuple(
        f"Load {load.key}: {'; '.join(said)}"
        for load, row in zip(loads, zip(*found, strict=True), strict=True)
        if (known := [(at, one) for at, one in zip(postures, row, strict=True) if one])
        and (said := [*_said(load, requirement, known)])
    )


def _said(
    load: Quantity, requirement: Requirement, found: Sequence[tuple[Posture, Stability]]
) -> Iterator[str]:
    lost = np.array([one.stiffness_losses for _, one in found])
    taken, moved = float(lost.max()), max(abs(one.extra_displacement) for _, one in found)
    if np.isfinite(lost).all() and max(taken, moved) < _NOTHING:
        return
    buckling = [(one.factor, at, one) for at, one in found if one.factor is not None]
    if buckling:
        factor, at, one = min(buckling, key=lambda place: place[0])
        place = shown_pose(at.mechanism, at.pose)
        where = f", first at {place}" if place else ""
        most = next(iter(one.shares))
        yield f"buckles the robot at {number(factor, 3)} times this load{where}, in {most}"
    else:
        yield "buckles the robot nowhere"
    if not np.isfinite(lost).all():
        yield "nothing that is said of the robot under it holds"
        return
    axis = AXES[int(np.argmax(lost.max(axis=0)))]
    said = (
        f"takes up to {percent(max(taken, 0.0), signed=False)} of the tool's stiffness ({axis}) "
        f"and changes its displacement by {percent(moved, signed=False)}, which no linear "
        "model sees"
    )
    limit = requirement.limit(load)
    if requirement.absolute(load) is None and moved > limit:
        said += f": more than the {percent(limit, signed=False)} that are accepted"
    yield said
