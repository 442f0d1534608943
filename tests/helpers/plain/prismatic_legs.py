"""Steel, the equivalent legs of the paper's demonstrator, and solids of legs on small meshes."""

from fem.bodies.solid import SolidLeg, solid_leg
from lumped.legs import ConstantLeg, Material, constant_leg
from meshes.prism.hexahedra import extrude, stations
from meshes.section.section_mesh import Divisions, section_mesh

STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
# Paper §2.3 applied to its appendix.
LEG_1 = constant_leg(0.85, EA=8.613e8, EIy=4.771e6, EIz=1.832e6, GJ=9.212e6, mass=69.705)
LEG_2 = constant_leg(0.775, EA=4.316e9, EIy=5.980e7, EIz=4.182e6, GJ=6.478e6, mass=49.366)


def meshed(leg: ConstantLeg, divisions: Divisions, slices: int) -> SolidLeg:
    """A leg in hexahedra of second order, by elements across its section and along it."""
    section = section_mesh(leg.section, divisions)
    return solid_leg(leg, extrude(section, stations(leg.length, slices)))
