"""Parts at random: tapered boxes and tubes as STEP files, and their solutions on other meshes.

The truth of a part is computed without its file: hexahedra of 27 nodes in slices, the section's
mesh drawn in along the part.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from drawn_parts import plane_ends, written

from fem.bodies.part import held_part, meshed_part
from fem.couplings.grips import Grip
from lumped.arrays import Array
from lumped.legs import Material
from lumped.mechanism.body import PartInterface
from lumped.sections import Circle, HollowRectangle, Rectangle, Section, Tube
from meshes.part.boundary import Facets, PartMesh
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.prism.hexahedra import hexahedra
from validation.parts.identify import identify

# Rotation about x on the diagonal.
TORSION = 3


@dataclass(frozen=True)
class RandomPart:
    """A prism of `section` and `length` (m) whose sides along y and z shrink to `taper` at x = L.

    Its ends are held by `coupling`.
    """

    section: Section
    length: float
    taper: tuple[float, float]
    material: Material
    coupling: str
    unknowns: int

    @property
    def ends(self) -> dict[str, PartInterface]:
        """Its two end faces."""
        return plane_ends(self.length, self.coupling)


def random_part(rng: np.random.Generator) -> RandomPart:
    """A box or a tube, solid or hollow, two and a half to eight sides long."""
    size, ratio = rng.uniform(0.06, 0.2), rng.uniform(0.6, 1.0)
    width, height = rng.permutation([size, ratio * size]).tolist()
    wall = rng.uniform(0.1, 0.2) * ratio * size
    shapes: tuple[Section, ...] = (
        Rectangle(width, height),
        HollowRectangle(width, height, wall),
        Circle(size),
        Tube(size, wall),
    )
    section = shapes[rng.choice(4, p=[0.3, 0.35, 0.15, 0.2])]
    along_y, along_z = rng.uniform(0.5, 1.0, 2).tolist()
    return RandomPart(
        section,
        float(rng.uniform(2.5, 8.0) * size),
        (along_y, along_y if isinstance(section, Circle | Tube) else along_z),
        Material.isotropic(2.1e11, float(rng.uniform(0.2, 0.35)), 7850.0),
        str(rng.choice(["rigid", "average"])),
        int(rng.uniform(6e3, 1.5e4)),
    )


def step_of(part: RandomPart, path: Path) -> Path:
    """The part as STEP in millimetres."""

    def loft(occ: Any, width: float, height: float) -> tuple[int, int]:
        wires = []
        for x, (y, z) in ((0.0, (1.0, 1.0)), (1e3 * part.length, part.taper)):
            corners = [(-y, -z), (y, -z), (y, z), (-y, z)]
            points = [occ.addPoint(x, a * width * 500, b * height * 500) for a, b in corners]
            lines = [occ.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
            wires.append(occ.addWire(lines))
        return next(one for one in occ.addThruSections(wires, makeRuled=True) if one[0] == 3)

    def cone(occ: Any, diameter: float) -> tuple[int, int]:
        radius = 500.0 * diameter
        tip = radius * part.taper[0]
        return 3, occ.addCone(0.0, 0.0, 0.0, 1e3 * part.length, 0.0, 0.0, radius, tip)

    def draw(occ: Any) -> None:
        match part.section:
            case Rectangle(width, height):
                loft(occ, width, height)
            case HollowRectangle(width, height, wall):
                inner = loft(occ, width - 2 * wall, height - 2 * wall)
                occ.cut([loft(occ, width, height)], [inner])
            case Circle(diameter):
                cone(occ, diameter)
            case Tube(diameter, wall):
                occ.cut([cone(occ, diameter)], [cone(occ, diameter - 2.0 * wall)])
        # The wires of a loft are no part of it.
        occ.remove([*occ.getEntities(2), *occ.getEntities(1)])

    return written(path, draw)


def true_compliance(part: RandomPart) -> Array:
    """Compliance (6×6, SI) of the tip on hexahedra, extrapolated from two meshes.

    Where stresses are singular, at held edges and inward ones of 270°, energies err as h^(4/3).
    """
    coarse, fine = (_on_hexahedra(part, divisions) for divisions in (3, 6))
    return fine + (fine - coarse) / (2.0 ** (4.0 / 3.0) - 1.0)


def _on_hexahedra(part: RandomPart, divisions: int) -> Array:
    # As long as elements are wide.
    slices = np.ceil(4.0 * part.length / min(part.section.extent)) * divisions / 4.0
    solid = hexahedra(part.section, part.length, divisions, int(np.ceil(slices)))
    nodes = solid.nodes.copy()
    nodes[:, 1:] *= 1.0 - (nodes[:, :1] / part.length) * (1.0 - np.array(part.taper))
    faces = {
        number: Facets(end.nodes[end.mesh.cells], "quad9")
        for number, end in enumerate((solid.root, solid.tip))
    }
    mesh = PartMesh(nodes=nodes, cells=solid.cells, element=solid.element, faces=faces)
    grips = [
        Grip(part.coupling, faces[number], np.array([number * part.length, 0.0, 0.0]))
        for number in (0, 1)
    ]
    return held_part(meshed_part(mesh, part.material), grips, "hexahedra").compliance


def stated(part: RandomPart, folder: Path) -> Iterator[tuple[str, float, float]]:
    """Of each number of the six on the diagonal: what it is, uncertainty and error, relative.

    Uncertainty as it is stated by identification, which sees the file alone.
    """
    file = read_part(step_of(part, folder / "part.step"))
    found = identify(file, find_interfaces(file, part.ends), part.material, part.unknowns, modes=0)
    true = np.diag(true_compliance(part))
    uncertainty = np.diag(found.compliance_refinement) / true
    errors = np.diag(found.compliance) / true - 1.0
    kind = f"{type(part.section).__name__}, {part.coupling}"
    for row, (one, error) in enumerate(zip(uncertainty, errors, strict=True)):
        yield f"{kind}, torsion" if row == TORSION else kind, float(one), float(error)
