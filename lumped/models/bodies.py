"""Legs as springs and as links of matrix structural analysis; statics and modes of one clamped leg.

A link is a leg represented by its stiffness between its two interfaces. The 12×12 stiffness of a
prism, or of a leg specified by its 6×6 compliance, follows by equilibrium from the compliance at
the tip with clamped root. Links are used in statics only, because they do not define how the mass
inside a body moves.

Tip compliance and natural modes of a single leg with its root clamped are computed from any model
that consists of stiffness and mass matrices.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from lumped.arrays import Array, dense, symmetric
from lumped.dense.modes import Modes, solve_modes
from lumped.dense.statics import balanced_flexibility, solve_statics
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import ComputationError, InputError
from lumped.legs import (
    ConstantLeg,
    GivenLeg,
    Leg,
    LineLeg,
    given_compliance,
    is_bent,
)
from lumped.mechanism.body import Body
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Mechanism
from lumped.model_choices import EquivalentBy, LegSprings, Theory
from lumped.screws import shift

_ROOT = 6
# Number of rigid-body motions of an unsupported body.
RIGID_MOTIONS = 6
# Eigenvalues ω² below this fraction of the shift are zero. Round-off is 1e-12 for 200 elements, and
# elastic modes lie far above.
_NO_FREQUENCY = 1e-6


def leg_of(body: Body) -> Leg:
    """Leg shape of a body. Raises InputError if the body is not a leg."""
    if isinstance(body.shape, ConstantLeg | GivenLeg | LineLeg):
        return body.shape
    raise InputError(f"bodies.{body.name}: must be a leg")


def legs_of(mechanism: Mechanism) -> dict[str, Leg]:
    """Legs of a mechanism, by the name of their body."""
    return {
        name: body.shape
        for name, body in mechanism.bodies.items()
        if isinstance(body.shape, ConstantLeg | GivenLeg | LineLeg)
    }


def bent_legs(mechanism: Mechanism) -> list[str]:
    """Names of the legs whose centre line is not straight."""
    return [name for name, leg in legs_of(mechanism).items() if is_bent(leg)]


def on_equivalent_legs(mechanism: Mechanism) -> Mechanism:
    """Mechanism in which equivalent prismatic legs replace legs given by a 6×6 compliance."""
    bodies = {
        name: replace(body, shape=replace(equivalent_leg(body.shape), name=name))
        if isinstance(body.shape, GivenLeg)
        else body
        for name, body in mechanism.bodies.items()
    }
    return replace(mechanism, bodies=bodies)


def tip_compliances(
    mechanism: Mechanism,
    springs: LegSprings = "given",
    theory: Theory = "timoshenko",
    by: EquivalentBy = "stiffness",
) -> dict[str, Array]:
    """6×6 compliance (SI, body axes) of each leg at its tip with its root clamped, by name.

    `springs` and `by` affect legs specified by their 6×6. If `springs` is "given", the result is
    the 6×6 in the robot file. If it is "equivalent", the result is the compliance of the prismatic
    leg that `equivalent_leg` matches to the stiffness or to the compliance (`by`). The compliance
    of legs with sections is computed by the beam theory `theory`.
    """
    compliances = {}
    for name, leg in legs_of(mechanism).items():
        model_leg = leg if springs == "given" else equivalent_leg(leg, by)
        compliances[name] = given_compliance(model_leg, theory)
    return compliances


def links(mechanism: Mechanism, legs: Mapping[str, Array]) -> dict[str, LegMatrices]:
    """Stiffness matrices of massless legs, from their tip compliances in `legs`.

    Each compliance is 6×6 (SI, leg axes, root clamped). Keys are the names of the legs.
    """
    lengths = {
        name: float(np.linalg.norm(tip.position - root.position))
        for name in legs
        for root, tip in [mechanism.bodies[name].interfaces.values()]
    }
    return {name: link(lengths[name], compliance) for name, compliance in legs.items()}


def link(length: float, compliance: Array) -> LegMatrices:
    """Stiffness matrix of a massless leg of `length` (m), from its tip compliance.

    `compliance` is 6×6 (SI, leg axes, root clamped). The centre line of the leg is the straight
    line between its ends, and twists are interpolated linearly along it.
    """
    relative = np.hstack([-shift(np.array([length, 0.0, 0.0])), np.eye(6)])
    stiffness = relative.T @ np.linalg.inv(compliance) @ relative

    def centreline(stations: Array) -> Array:
        share = np.asarray(stations, dtype=float) / length
        return np.kron(np.column_stack([1.0 - share, share]), np.eye(6)).astype(float)

    return LegMatrices(
        model="link",
        length=length,
        stiffness=symmetric(stiffness),
        mass=np.zeros((12, 12)),
        centreline=centreline,
    )


def tip_compliance_of(leg: LegMatrices) -> Array:
    """6×6 compliance (SI, leg axes) of a leg model at its tip with its root clamped.

    Raises ComputationError if the stiffness of the clamped leg is singular.
    """
    stiffness = leg.stiffness[_ROOT:, _ROOT:]
    part, loads = f"{leg.model} model of a leg", np.eye(stiffness.shape[0], 6)
    displacements = solve_statics(stiffness, loads, part)
    return balanced_flexibility(loads, displacements, stiffness @ displacements, part)


def clamped_modes(leg: LegMatrices, count: int) -> Modes:
    """The lowest `count` natural modes of a leg model with its root clamped.

    The shapes contain all n unknowns of the leg (n×count, zero at the root), so that
    `leg.centreline(stations) @ shapes` are twists of the sections. Raises ComputationError under
    the conditions of `solve_modes`.
    """
    free = solve_modes(
        dense(leg.stiffness)[_ROOT:, _ROOT:], dense(leg.mass)[_ROOT:, _ROOT:], count, leg.model
    )
    shapes = np.vstack([np.zeros((_ROOT, count)), free.shapes])
    return Modes(frequencies=free.frequencies, shapes=shapes)


def free_frequencies(leg: LegMatrices, count: int) -> Array:
    """The lowest `count` natural frequencies (Hz) of an unsupported leg, without rigid motions.

    They are computed with K + σM in place of K, which is positive definite and has the same mode
    shapes. The shift σ is ω² of the lowest mode of the clamped leg. Raises ComputationError unless
    exactly six frequencies are zero, and under the conditions of `solve_modes`.
    """
    stiffness, mass = dense(leg.stiffness), dense(leg.mass)
    shift_by = float(2.0 * np.pi * clamped_modes(leg, 1).frequencies[0]) ** 2
    total_count = count + RIGID_MOTIONS
    shifted = solve_modes(stiffness + shift_by * mass, mass, total_count, leg.model)
    squared = (2.0 * np.pi * shifted.frequencies) ** 2 - shift_by
    rigid = int(np.count_nonzero(np.abs(squared) <= _NO_FREQUENCY * shift_by))
    if rigid != RIGID_MOTIONS:
        raise ComputationError(
            f"{rigid} rigid-body modes found; a free body must have {RIGID_MOTIONS}",
            part=f"{leg.model} model of a leg",
        )
    frequencies: Array = np.sqrt(squared[RIGID_MOTIONS:]) / (2.0 * np.pi)
    return frequencies
