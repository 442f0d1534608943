"""A volume mesh that knows which of its facets lie on which face of the part."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from meshes.part.boundary import Facets
from meshes.solid_mesh import VolumeMesh


@dataclass(frozen=True, eq=False)
class PartMesh(VolumeMesh):
    """Mesh of a part in the file's axes (m).

    `faces`: facets by the number of their face, outward; `names` of faces, where there are some;
    `bare`: sets of the file that hold no whole facet; `straightened`: how many elements were given
    straight edges because they had folded.
    """

    faces: Mapping[int, Facets]
    names: Mapping[int, str] = field(default_factory=dict)
    bare: tuple[str, ...] = ()
    straightened: int = 0

    @property
    def unknowns(self) -> int:
        """Displacements of its nodes."""
        return 3 * len(self.nodes)
