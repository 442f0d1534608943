"""The designer's own loads on every model of a mechanism: how far they move the tool.

Models with mass take their own. Of those without, legs have the mass of their beams, or of the file
where they are known by their 6×6; parts their own: rigid bodies carry it by static equivalence.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from fem.beams.stepped import SteppedLeg
from fem.reduction.superelement import held_leg, static_superelement
from lumped.arrays import Array, dense
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, GivenLeg
from lumped.mechanism.body_model import BodyModel, LegMatrices
from lumped.mechanism.load import Loading
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models import serial_chains
from lumped.models.bodies import legs_of
from lumped.system.assembly import Assembly, assembly
from lumped.system.loads import loading, tool_displacements
from lumped.system.solution import solved
from validation.models.leg_models import condensed_leg, leg_matrices
from validation.models.loads.leg_masses import MASSES, Masses, ends_mass
from validation.models.options import DEFAULT_OPTIONS, STATIC, ModelName, ModelOptions
from validation.models.reduced_parts import condensed
from validation.models.robot_models import (
    bodies_of,
    on_drives_alone,
    released,
    springs_of,
    static_bodies,
)

# Masses (6m×6m, SI, body axes) of bodies on the twists of their interfaces.
BodyMasses: TypeAlias = Mapping[str, Array]


def displacements(
    model: ModelName, postures: Sequence[Posture], options: ModelOptions = DEFAULT_OPTIONS
) -> Array:
    """Displacements (p×l×6, m and rad, base axes) of the loaded point under each of the loads.

    NaN where the mechanism cannot move as a load says. Raises as `answers` does.
    """
    mechanism = postures[0].mechanism
    if not mechanism.loads:
        return np.zeros((len(postures), 0, 6))
    masses = load_masses(model, mechanism, options)
    if model == "vjm":
        springs = springs_of(mechanism, options)
        return displacements_by(by_chains(springs), postures, masses)
    if model == "simplified":
        prepared = assembly(on_drives_alone(mechanism), {})
    else:
        ready = released(postures, options)[0].mechanism
        prepared = assembly(ready, static_bodies(model, mechanism, options))
    return displacements_by(_assembled(prepared), postures, masses)


def displacements_of(bodies: Mapping[str, BodyModel], postures: Sequence[Posture]) -> Array:
    """The same of a mechanism whose `bodies` have these models, with their masses."""
    mechanism = postures[0].mechanism
    masses = {name: _of_ends(body) for name, body in bodies.items()}
    return displacements_by(_assembled(assembly(mechanism, bodies)), postures, masses)


def _assembled(prepared: Assembly) -> Callable[[Posture, list[Loading]], Array]:
    return lambda at, loads: tool_displacements(solved(prepared.at(at)), loads)


def by_chains(springs: Mapping[str, Array]) -> Callable[[Posture, list[Loading]], Array]:
    """How far loads move the tool by serial chains with such tip compliances of their legs."""
    return lambda at, loads: serial_chains.tool_displacements(at, springs, loads)


def displacements_by(
    solve: Callable[[Posture, list[Loading]], Array],
    postures: Sequence[Posture],
    masses: BodyMasses,
) -> Array:
    """Displacements (p×l×6) that `solve` gives under what the loads do in each of the postures."""
    loads = postures[0].mechanism.loads
    found = np.full((len(postures), len(loads), 6), np.nan)
    for at, rows in zip(postures, found, strict=True):
        known, ones = [], []
        for number, load in enumerate(loads):
            try:
                ones.append(loading(at, load, masses))
            except ComputationError:
                continue
            known.append(number)
        if known:
            rows[known] = solve(at, ones)
    return found


def masses_of(
    mechanism: Mechanism,
    masses: Masses = MASSES[0],
    parts: Mapping[str, BodyModel] | None = None,
) -> BodyMasses:
    """Of beams, of legs known by their 6×6 with such a distribution, and of parts as solids.

    `parts`: models of these, condensed ones without. None where no load acts on mass.
    """
    if not any(load.acts_on_mass for load in mechanism.loads):
        return {}
    if parts is None:
        parts = {name: condensed(body) for name, body in mechanism.parts.items()}
    legs = {name: _of_leg(leg, masses) for name, leg in legs_of(mechanism).items()}
    return legs | {name: _of_ends(model) for name, model in parts.items()}


def _of_ends(model: BodyModel) -> Array:
    """A model's mass on its interfaces: that of Craig and Bampton is Guyan's there."""
    ends = slice(6 * len(model.interfaces))
    return dense(model.mass)[ends, ends]


def _of_leg(leg: ConstantLeg | GivenLeg, masses: Masses) -> Array:
    if isinstance(leg, ConstantLeg):
        return dense(condensed_leg("beam", leg, DEFAULT_OPTIONS).mass)
    return ends_mass(leg, masses)


def load_masses(model: ModelName, mechanism: Mechanism, options: ModelOptions) -> BodyMasses:
    """Masses that loads act on: a model's own where it has mass, else as `masses_of` has them."""
    if model == "simplified" or model in STATIC:
        return masses_of(mechanism)
    if not any(load.acts_on_mass for load in mechanism.loads):
        return {}
    bodies = static_bodies(model, mechanism, options)
    if model == "segments":
        bodies |= bodies_of(mechanism, replace(options, release="condensed"), _segments)
    return {name: _of_ends(body) for name, body in bodies.items()}


def _segments(leg: ConstantLeg | SteppedLeg, options: ModelOptions) -> LegMatrices:
    """Segments on their ends with their mass, which the springs in series do not have."""
    whole = leg_matrices("segments", leg, replace(options, release="condensed"))
    return static_superelement(held_leg(whole)).matrices
