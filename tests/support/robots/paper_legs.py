"""Steel, the equivalent legs of the paper's demonstrator, and solids of legs on small meshes."""

import numpy as np

from fem.bodies.solid import SolidLeg, solid_leg
from lumped.arrays import Array, dense
from lumped.dense.modes import solve_modes
from lumped.equivalent_leg import constant_leg
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.body_model import LegMatrices
from meshes.prism import extrude, stations
from meshes.section.section_mesh import Divisions, section_mesh

STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
# Its G is half as much again as the isotropic one: as far from isotropy as the legs below.
CUBIC = Material(E=2.1e11, G=1.3e11, nu=0.25, rho=7850.0)
# Paper §2.3 applied to its appendix.
LEG_1 = constant_leg(0.85, EA=8.613e8, EIy=4.771e6, EIz=1.832e6, GJ=9.212e6, mass=69.705)
LEG_2 = constant_leg(0.775, EA=4.316e9, EIy=5.980e7, EIz=4.182e6, GJ=6.478e6, mass=49.366)


def meshed(leg: ConstantLeg, divisions: Divisions, slices: int) -> SolidLeg:
    """Solid leg of second-order hexahedra, by divisions of its section and number of slices."""
    section = section_mesh(leg.section, divisions)
    return solid_leg(leg, extrude(section, stations(leg.length, slices)))


def kind_frequencies(leg: LegMatrices, kind: str, count: int) -> Array:
    """The lowest frequencies (Hz) of one kind of deformation of the clamped leg.

    The kinds of a straight leg are uncoupled. Each is solved on its own unknowns, so that modes of
    two kinds with equal frequencies are not mixed.
    """
    stiffness = dense(leg.parts[kind])
    unknowns = np.flatnonzero(np.diag(stiffness) > 0.0)
    pick = np.ix_(unknowns[unknowns >= 6], unknowns[unknowns >= 6])
    return solve_modes(stiffness[pick], dense(leg.mass)[pick], count, kind).frequencies
