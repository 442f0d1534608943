"""Legs along a line as beams whose section constants are computed on the mesh of their solid.

Input: a leg along a line and the elements across its section. Output: the beam's sections and tip
compliance, and the rotation of its tip by distorted walls of a tube. Beam and solid then share the
errors of one section mesh.
"""

from collections.abc import Callable

import numpy as np

from fem.beams.box_distortion import distortion_work
from fem.sections.wall_frame import mesh_frame_stiffness
from lumped.arrays import Array
from lumped.beam_properties import BeamProperties
from lumped.legs import ConstantLeg, LineLeg
from lumped.line_sections import LineSections
from meshes.loft import solid_section
from meshes.section.section_mesh import SectionMesh
from validation.solids.solid_legs import mesh_properties


def on_solid_mesh(leg: LineLeg, divisions: int) -> Callable[[ConstantLeg], SectionMesh]:
    """Function that returns the section mesh that the leg's solid has at one section of the leg.

    `divisions` are the elements across the section. The argument of the function is a prism with
    the section of the leg at one position.
    """
    return lambda prism: solid_section(leg, prism.section, divisions)


def computed_along(leg: LineLeg, divisions: int) -> LineSections:
    """Sections along a leg with constants by finite elements, on the mesh of its solid."""
    mesh = on_solid_mesh(leg, divisions)

    def properties(prism: ConstantLeg) -> BeamProperties:
        return mesh_properties(prism, mesh(prism))

    return leg.sections_by(properties)


def computed_tip(leg: LineLeg, divisions: int) -> Array:
    """Tip compliance (6×6, SI) of the beam with section constants by finite elements."""
    return computed_along(leg, divisions).tip_compliance


def mesh_frames(leg: LineLeg, divisions: int) -> Callable[[ConstantLeg], float]:
    """Function that returns the frame stiffness (N) of a tube on the section mesh of the solid.

    Bent walls with one element across are up to 20 % too stiff.
    """
    mesh = on_solid_mesh(leg, divisions)
    return lambda prism: mesh_frame_stiffness(mesh(prism), prism.material)


def wall_distortion(leg: LineLeg, divisions: int) -> float:
    """Rotation of the tip (rad/(N m)) due to distortion of the section by converging walls."""
    return distortion_work(leg, np.ones_like, mesh_frames(leg, divisions))
