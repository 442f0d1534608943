"""Random parts: tapered boxes and tubes as STEP files, and their solutions on other meshes.

The reference of a part is computed without its file, by slices of 27-node hexahedra. The mesh of
the section shrinks along the part. Sections and slices are graded towards edges with singular
stresses.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from support.robots.drawn_parts import plane_ends, written

from fem.bodies.part import held_part, meshed_part
from fem.couplings.grips import Grip
from lumped.arrays import Array
from lumped.legs import Material
from lumped.mechanism.body import PartInterface
from lumped.sections import Circle, HollowRectangle, Rectangle, Section, Tube
from meshes.part.boundary import Facets, PartMesh
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.prism import extrude
from meshes.section.section_mesh import SectionMesh, section_mesh
from validation.parts.identify import identify

# Slices at the ends are shorter than in the middle by this, elements at the edges of sections too,
# at inner ones, where a layer h from it misses as h^(4/3) of the energy, by the second.
_GRADING, _SHARP = 8.0, 30.0
# Elements across a section, solid or walled: three across a wall.
_SOLID, _WALLED = 6, 12


@dataclass(frozen=True)
class RandomPart:
    """Prism of `section` and `length` (m) whose sides shrink by the factors `taper` along y and z.

    `coupling` is that of both ends.
    """

    section: Section
    length: float
    taper: tuple[float, float]
    material: Material
    coupling: str
    unknowns: int

    @property
    def ends(self) -> dict[str, PartInterface]:
        """Interfaces on the two end faces."""
        return plane_ends(self.length, self.coupling)


def random_part(rng: np.random.Generator) -> RandomPart:
    """Random box or tube, solid or hollow, with a length of two and a half to eight sides."""
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
    """Write the part as a STEP file in millimetres."""

    def loft(occ: Any, width: float, height: float) -> tuple[int, int]:
        wires = []
        for x, (y, z) in ((0.0, (1.0, 1.0)), (1e3 * part.length, part.taper)):
            corners = [(-y, -z), (y, -z), (y, z), (-y, z)]
            points = [occ.addPoint(x, a * width * 500, b * height * 500) for a, b in corners]
            lines = [occ.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
            wires.append(occ.addWire(lines))
        return next(
            entity for entity in occ.addThruSections(wires, makeRuled=True) if entity[0] == 3
        )

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


def graded(t: Array, grading: float = _GRADING) -> Array:
    """Graded coordinates from 0 to 1 for t from 0 to 1, with smaller steps at both ends.

    dx/dt is proportional to `grading`^(2t) up to t = 1/2: elements in the middle are `grading`
    times as long as at the ends.
    """
    nearer = np.expm1(2.0 * np.minimum(t, 1.0 - t) * np.log(grading)) / (grading - 1.0) / 2.0
    return np.where(t <= 0.5, nearer, 1.0 - nearer)


def _section(section: Section, fineness: float) -> SectionMesh:
    """Mesh of the section, with smaller elements at singular edges. Round sections have none."""
    across = round(fineness * (_WALLED if isinstance(section, HollowRectangle) else _SOLID))
    mesh = section_mesh(section, max(across, 4))
    nodes = mesh.nodes.copy()
    match section:
        case Rectangle(width, height):
            sides = np.array([width, height])
            nodes = sides * (graded(nodes / sides + 0.5) - 0.5)
        case HollowRectangle(width, height, wall):
            inner = np.array([width, height]) / 2.0 - wall
            out = np.abs(nodes)
            within = inner * (2.0 * graded(0.5 + 0.5 * np.minimum(out / inner, 1.0), _SHARP) - 1.0)
            beyond = wall * graded(np.maximum(out - inner, 0.0) / wall, _SHARP)
            nodes = np.sign(nodes) * (within + beyond)
    return replace(mesh, nodes=nodes)


def true_compliance(part: RandomPart, fineness: float = 1.0) -> Array:
    """Compliance (6×6, SI) of the tip on graded hexahedra."""
    mesh = _section(part.section, fineness)
    slices = round(fineness * (10 + part.length / np.ptp(mesh.nodes, axis=0).min()))
    solid = extrude(mesh, part.length * graded(np.linspace(0.0, 1.0, slices + 1)))
    nodes = solid.nodes.copy()
    nodes[:, 1:] *= 1.0 - (nodes[:, :1] / part.length) * (1.0 - np.array(part.taper))
    faces = {
        number: Facets(end.nodes[end.mesh.cells], "quad9")
        for number, end in enumerate((solid.root, solid.tip))
    }
    hexahedra = PartMesh(nodes=nodes, cells=solid.cells, element=solid.element, faces=faces)
    grips = [
        Grip(part.coupling, faces[number], np.array([number * part.length, 0.0, 0.0]))
        for number in (0, 1)
    ]
    return held_part(meshed_part("hexahedra", hexahedra, part.material), grips).compliance


def stated(part: RandomPart, folder: Path) -> tuple[Array, Array]:
    """Relative uncertainties (6) and true errors (6) of the diagonal compliances.

    The uncertainties are those of `identify`, which uses only the file.
    """
    file = read_part(step_of(part, folder / "part.step"))
    identified = identify(
        file, find_interfaces(file, part.ends), part.material, part.unknowns, modes=0
    )
    true = np.diag(true_compliance(part))
    half_widths = np.diag(identified.compliance_refinement) / true
    return half_widths, np.diag(identified.compliance) / true - 1.0
