"""Guards of what is said of solid modes: kinds of their energy, and how far a reduction may err.

On legs of a few elements: elsewhere both are seen in expensive comparisons alone.
"""

from dataclasses import dataclass, replace

import numpy as np

from fem.bodies import leg_modes, solid
from fem.bodies.leg_energies import kind_energies
from fem.reduction.craig_bampton import craig_bampton, frequency_bounds
from fem.reduction.superelement import held_leg
from fem.solvers import sparse_system
from lumped import biglide
from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle
from meshes.prism.hexahedra import hexahedra
from validation.agreement.differences import farthest_off
from validation.case import Absolute, Measurement, Relation
from validation.case_group import CaseGroup
from validation.cases.program.guards.robot import SECTION, guarded_posture
from validation.context import Context

# Slender, and deeper along z than along y.
_LEG = ConstantLeg(0.8, Rectangle(0.04, 0.07), Material.isotropic(2.1e11, 0.3, 7850.0))
_SLICES = 8
_LOWEST = ("bending z", "bending y")
# Frequencies that are bounded, and the cut-off (Hz) in units of the highest: low, so that what is
# dropped is far above rounding.
_COUNT, _LOW_CUTOFF = 6, 1.2

cases = CaseGroup(section=SECTION, group="guard.modes", unit="1", effort=0.1)


@cases.case(
    "guard.modes.energies",
    "A solid leg's lowest modes bend it first in its thin, then in its deep direction",
    quantity="largest part of ω²/2 that is not the energy of that kind",
    reference_kind="closed-form",
    citation="Euler–Bernoulli: the lowest frequencies are as the depths; a mode of unit mass has "
    "the strain energy ω²/2 (Rayleigh)",
    tolerance=Absolute(0.005),
    tolerance_reason=f"forces of inertia within a slice: 2e-3 with {_SLICES} slices, a twelfth of "
    "that with twice as many",
)
def _energies(_context: Context) -> Measurement:
    mesh = hexahedra(_LEG.section, _LEG.length, (1, 2), slices=_SLICES)
    whole = solid.solid_leg(_LEG, mesh)
    found = leg_modes.modes(solid.clamped_leg(whole, "free"), len(_LOWEST))
    energies = kind_energies(whole, found.shapes)
    whole_energy = np.square(2.0 * np.pi * found.frequencies) / 2.0
    own = np.array([energies[kind][mode] for mode, kind in enumerate(_LOWEST)])
    return farthest_off(own / whole_energy - 1.0)


@dataclass(frozen=True)
class Bounded:
    """Frequencies (Hz) of a robot of solid legs, `lower` and `upper` bounds, and without them."""

    lower: Array
    upper: Array
    unreduced: Array


def bounded_frequencies(robot: Biglide) -> Bounded:
    """Of the guards' legs on the robot's feet, reduced far too little, and not at all."""
    legs = [replace(_LEG, length=leg.length) for leg in (robot.leg1, robot.leg2)]
    meshes = (hexahedra(leg.section, leg.length, 1, slices=_SLICES) for leg in legs)
    wholes = [
        solid.solid_leg_matrices(solid.solid_leg(leg, mesh))
        for leg, mesh in zip(legs, meshes, strict=True)
    ]
    bare = replace(robot, leg1=legs[0], leg2=legs[1])
    x = guarded_posture(bare)
    whole = sparse_system.factorised(biglide.system(bare, x, *wholes))
    unreduced = sparse_system.modes(whole, _COUNT).frequencies
    highest = float(unreduced[-1])
    reduced = [craig_bampton(held_leg(leg), highest, _LOW_CUTOFF * highest) for leg in wholes]
    system = biglide.system(bare, x, *(one.matrices for one in reduced))
    bounds = frequency_bounds(system, dict(zip(("leg1", "leg2"), reduced, strict=True)), _COUNT)
    return Bounded(bounds.lower, bounds.upper, unreduced)


@cases.case(
    "guard.modes.bounds",
    "A robot of legs reduced far too little errs by less than it says",
    quantity="largest error of a frequency in units of its stated bound",
    reference_kind="independent-solver",
    citation="the same meshes without reduction (fem.solvers.sparse_system)",
    tolerance=Absolute(1e-3),
    tolerance_reason="a bound: nothing but rounding may exceed it",
    relation=Relation.AT_MOST,
)
def _bounds(context: Context) -> Measurement:
    found = context.get(bounded_frequencies, context.robot)
    error, stated = found.upper - found.unreduced, found.upper - found.lower
    # A bound of nothing is infinitely exceeded.
    with np.errstate(divide="ignore", invalid="ignore"):
        return Measurement(float(np.max(error / stated)), 1.0, exact=True)
