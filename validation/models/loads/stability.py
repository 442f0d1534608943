"""Buckling factors and loss of stiffness under the loads of the robot file, by any model.

Input: postures of a mechanism with loads, and a model. Output: a `Stability` for each posture and
load, and notes for the report. Rule: statics are those of the model, on the interfaces of its
bodies. Between the interfaces, legs bend as beams in all models; this determines their buckling and
the effect of the axial force on their stiffness.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from fem.beams.prestressed import (
    PrestressedLeg,
    between,
    prestressed_leg,
    prestressed_line_leg,
)
from lumped.acceptance.quantities import AXES, Quantity, load_quantities
from lumped.acceptance.requirement import Requirement
from lumped.arrays import dense
from lumped.errors import ComputationError
from lumped.legs import LineLeg, SectionedLeg
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.load import Load
from lumped.mechanism.mechanism import Posture
from lumped.memo import memo
from lumped.model_choices import Theory
from lumped.models.bodies import bent_legs
from lumped.system.assembly import Assembly
from lumped.system.solution import solved
from lumped.system.stability import Prestressed, Stability, geometric_stiffness, stability
from validation.drawing.text import number, percent
from validation.models.loads.statics import interface_loads_of, loadings
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.models.robot_bodies import sectioned_legs, static_assembly

# Elements and modes of a leg. With ten elements the error of the buckling load is 2e-4 for clamped
# ends and less for others; with 24 modes with clamped ends the error of the reduction is 1e-4. For
# bent legs 48 modes have this error; it is 5e-3 if both ends are clamped and pieces buckle alone.
_ELEMENTS, _MODES, _BENT_MODES = 10, 24, 48
# Relative loss of stiffness, and change of displacement, below which a load gets no note.
_NEGLIGIBLE = 1e-3


def stabilities(
    model: ModelName,
    postures: Sequence[Posture],
    options: ModelOptions = DEFAULT_OPTIONS,
    count: int = 0,
) -> list[list[Stability | None]]:
    """Stability in each posture under each load, with the lowest `count` frequencies under load.

    The outer list is over postures, the inner list over loads. None if the mechanism cannot move as
    a load requires. Raises the exceptions of `displacements`.
    """
    mechanism = postures[0].mechanism
    if not mechanism.loads:
        return [[] for _ in postures]
    prepared, legs = prestressed_assembly(model, postures, options)
    loaded_bodies = interface_loads_of(model, mechanism, options)
    rows: list[list[Stability | None]] = []
    for posture in postures:
        solution = solved(prepared.at(posture))
        row: list[Stability | None] = []
        for load in loadings(posture, loaded_bodies, options.theory):
            if load is None:
                row.append(None)
                continue
            geometric = geometric_stiffness(solution, load, legs)
            row.append(stability(solution, geometric, load, count))
        rows.append(row)
    return rows


def gives_way_pressed(load: Load, result: Stability) -> bool:
    """True if the body that gives way first is one on whose faces the load presses.

    The buckling factor is then not known: a pressure turns with its face, whereas the wrenches that
    stand for it keep their direction. They would buckle even a body under equal pressure from all
    sides.
    """
    return next(iter(result.shares), None) in {pressure.body for pressure in load.pressures}


def prestressed_assembly(
    model: ModelName, postures: Sequence[Posture], options: ModelOptions
) -> tuple[Assembly, dict[str, Prestressed]]:
    """Assembly of a model, and data for the geometric stiffness of its legs, by body name."""
    prepared = static_assembly(model, postures, options)
    bodies = dict(prepared.models)
    legs: dict[str, Prestressed] = {}
    for name, leg, _ in sectioned_legs(postures[0].mechanism, options):
        # Legs are rigid in the simplified model.
        if name in bodies:
            prestressed = _prestressed(leg, options.theory)
            bodies[name] = between(prestressed, dense(prepared.models[name].stiffness))
            legs[name] = prestressed.geometric_stiffness
    return replace(prepared, models=bodies), legs


@memo(64)
def _prestressed(leg: SectionedLeg, theory: Theory) -> PrestressedLeg:
    try:
        return _prestressed_by(leg, theory)
    except ComputationError:
        # If the formula for the shear factor κ does not apply, the end stiffness of the solid is
        # still known: the beam between the ends has no shear deformation.
        return _prestressed_by(leg, "euler-bernoulli")


def _prestressed_by(leg: SectionedLeg, theory: Theory) -> PrestressedLeg:
    if isinstance(leg, LineLeg):
        modes = _MODES if leg.line.is_straight else _BENT_MODES
        return prestressed_line_leg(leg.sections(theory), _ELEMENTS, modes)
    return prestressed_leg(leg.properties(theory), leg.length, _ELEMENTS, _MODES)


def stability_notes(
    postures: Sequence[Posture],
    rows: Sequence[Sequence[Stability | None]],
    requirement: Requirement,
) -> tuple[str, ...]:
    """Notes for the report, one for each load that reduces stiffness.

    A note has the smallest buckling factor and the largest loss of stiffness over the postures.

    `rows` (postures × loads) is the result of `stabilities`.
    """
    mechanism = postures[0].mechanism
    bent = bent_legs(mechanism)
    remark = f"; {bending_before_buckling(bent)}" if bent else ""
    loads = load_quantities([load.name for load in mechanism.loads])
    return tuple(
        f"Load {load.key}: {'; '.join(statements)}{remark}"
        for load, applied, row in zip(loads, mechanism.loads, zip(*rows, strict=True), strict=True)
        if (
            solved_postures := [
                (posture, stability_result)
                for posture, stability_result in zip(postures, row, strict=True)
                if stability_result and not gives_way_pressed(applied, stability_result)
            ]
        )
        and (statements := [*_statements(load, requirement, solved_postures)])
    )


def bending_before_buckling(bent: Sequence[str]) -> str:
    """Sentence on the neglect of bending before buckling, for the `bent` legs of a robot."""
    return f"deflection of bent legs before buckling is neglected: {', '.join(bent)}"


def _statements(
    load: Quantity, requirement: Requirement, solved_postures: Sequence[tuple[Posture, Stability]]
) -> Iterator[str]:
    losses = np.array([result.stiffness_losses for _, result in solved_postures])
    largest_loss, largest_change = (
        float(losses.max()),
        max(abs(result.extra_displacement) for _, result in solved_postures),
    )
    if np.isfinite(losses).all() and max(largest_loss, largest_change) < _NEGLIGIBLE:
        return
    buckling = [
        (result.factor, posture, result)
        for posture, result in solved_postures
        if result.factor is not None
    ]
    if buckling:
        factor, posture, result = min(buckling, key=lambda item: item[0])
        pose = shown_pose(posture.mechanism, posture.pose)
        location = f", first at {pose}" if pose else ""
        portion = next(iter(result.shares))
        yield f"buckling at {number(factor, 3)} times this load{location}, mostly in {portion}"
    else:
        yield "no buckling"
    if not np.isfinite(losses).all():
        yield (
            "the robot has no stiffness left under this load, so that results under it are invalid"
        )
        return
    axis = AXES[int(np.argmax(losses.max(axis=0)))]
    statement = (
        "reduces the stiffness of the tool by up to "
        f"{percent(max(largest_loss, 0.0), signed=False)} ({axis}) and changes its "
        f"displacement by {percent(largest_change, signed=False)}, an effect that linear "
        "models neglect"
    )
    limit = requirement.limit(load)
    if requirement.absolute(load) is None and largest_change > limit:
        statement += f": more than the accepted {percent(limit, signed=False)}"
    yield statement
