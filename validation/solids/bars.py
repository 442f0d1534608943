"""Legs of a mechanism as solid bars of their outer size: coarse meshes that other programs take."""

from dataclasses import replace

from fem.bodies.solid import SolidLeg, solid_leg
from fem.calculix.leg import mass_at_stiffness_points
from lumped.legs import ConstantLeg, equivalent_leg
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.sections import Rectangle
from meshes.prism.tetrahedra import tetrahedra


def with_bars(at: Posture) -> Posture:
    """The posture with every prism as a solid bar of its outer size, its ends rigid."""
    bodies = {
        name: replace(body, shape=replace(shape, section=Rectangle(*shape.section.extent)))
        if isinstance(shape := body.shape, ConstantLeg)
        else body
        for name, body in at.mechanism.bodies.items()
    }
    return replace(at, mechanism=replace(at.mechanism, bodies=bodies))


def bar_solids(mechanism: Mechanism) -> dict[str, SolidLeg]:
    """Every leg by name on second-order tetrahedra, one across; alike ones are one object.

    Legs known by a 6×6 as their equivalents; mass is summed over the points that CalculiX sums it
    over.
    """
    made: dict[ConstantLeg, SolidLeg] = {}
    found = {}
    for name, described in legs_of(mechanism).items():
        leg = equivalent_leg(described)
        if leg not in made:
            solid = solid_leg(leg, tetrahedra(leg.section, leg.length, 1))
            mass = mass_at_stiffness_points(solid.mesh, leg.material.rho)
            made[leg] = replace(solid, mass=mass)
        found[name] = made[leg]
    return found
