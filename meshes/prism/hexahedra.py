"""A leg as extruded hexahedra, from its section and length."""

from math import ceil

from lumped.sections import Section
from meshes.elements import SectionElement, SolidElement
from meshes.prism.extrude import extrude, stations
from meshes.quality import LARGEST_ASPECT, check
from meshes.section.section_blocks import Divisions, thinnest_layer
from meshes.section.section_mesh import require_leg, section_mesh
from meshes.solid_mesh import SolidMesh

_SECTION: dict[SolidElement, SectionElement] = {"hex8": "quad4", "hex27": "quad9"}


def slice_count(section: Section, length: float, divisions: Divisions) -> int:
    """Slices as long as smaller side / divisions, so that all sizes refine together.

    In thin walls they are shorter where they would come near the aspect ratio that is refused.
    """
    across = divisions if isinstance(divisions, int) else min(divisions)
    of_four = ceil(4.0 * length / min(section.extent) - 1e-9)
    bounded = ceil(length / (LARGEST_ASPECT / 2.0 * thinnest_layer(section, across)) - 1e-9)
    return max(ceil(across * of_four / 4), bounded)


def hexahedra(
    section: Section,
    length: float,
    divisions: Divisions,
    element: SolidElement = "hex27",
    *,
    slices: int | None = None,
) -> SolidMesh:
    """The leg of `length` (m) in hex8 or hex27, `divisions` as in `section_blocks`.

    `slices` defaults to `slice_count`. Raises InputError for impossible requests,
    ComputationError where gmsh fails or elements are too distorted.
    """
    require_leg(section, length, divisions)
    count = slice_count(section, length, divisions) if slices is None else slices
    flat = section_mesh(section, divisions, _SECTION[element])
    mesh = extrude(flat, stations(length, count))
    check(mesh, f"extruded leg ({section.shape})")
    return mesh
