"""CAD parts as stepped legs: prismatic pieces with the part's sections along its centre line.

Input: a body that is a CAD part with two interfaces. Output: a `SteppedLeg` of ten pieces with beam
properties, and the masses of the part before the first and after the last piece. Rule: planes cut
the mesh of the part; the constants of each section are computed by finite elements. A part whose
sections are not those of prisms is refused with NotPrismaticError.
"""

from dataclasses import astuple
from itertools import pairwise
from typing import Any

import numpy as np

from fem.beams.stepped import Piece, SteppedLeg
from fem.sections.section_constants import beam_properties, section_constants
from lumped.arrays import Array
from lumped.beam_properties import BeamProperties
from lumped.errors import InputError
from lumped.legs import Material
from lumped.mechanism.body import Body
from lumped.mechanism.mechanism import Mechanism
from lumped.memo import memo
from lumped.screws import shift, skew
from meshes.part.boundary import Facets, PartMesh, boundary
from meshes.part.slices import NotPrismaticError, slice_meshes, slices_of
from meshes.part.spread import cell_volumes
from meshes.section.section_mesh import SectionMesh
from validation.models import reduced_parts
from validation.parts.meshes import MIDDLE, mesh_entries, part_key, part_mesh
from validation.run.cache import Arrays, CacheEntry, require_shape

PIECES = 10
# Number of iterations for the centre line. Each cuts the part at right angles to the line through
# the centroids of the previous iteration.
_ROUNDS = 3
# Largest ratio of neighbouring sections. By Saint-Venant, a section acts as that of a prism if it
# extends over its own size at least. A section smaller by this factor than others on both sides,
# closer than half its size, makes a tenth of the leg too soft by a quarter: 2.5 % of its
# compliance, half of the usual limit.
_LARGEST_RATIO = 1.25
# Number of sections examined over a length of one section size.
_CUTS_PER_SIZE = 8
_MEASURES = ("area", "area inside the outline", "second moment of area", "second moment of area")


@memo(16)
def stepped(body: Body, pieces: int = PIECES) -> SteppedLeg:
    """CAD part with two interfaces as a leg of prismatic `pieces`, in leg axes.

    Raises NotPrismaticError if the interfaces overlap along the leg, a plane misses the part, or a
    section is not that of a prism.
    """
    return stepped_entry(body, pieces).value()


def stepped_entry(body: Body, pieces: int = PIECES) -> CacheEntry[SteppedLeg]:
    """Cache entry for the result of `stepped`."""
    file, interfaces = reduced_parts.found_in(body)
    material = reduced_parts.shape_of(body).material
    frame = reduced_parts.leg_axes(body)
    unknowns = reduced_parts.unknowns_of(body)
    key = part_key(file, interfaces, material, "stepped", unknowns, pieces)

    def compute() -> dict[str, Any]:
        mesh = part_mesh(file, interfaces, unknowns, MIDDLE)
        positions = (mesh.nodes - frame.position) @ frame.rotation
        extents = [
            positions[np.unique(np.concatenate([mesh.faces[n].nodes for n in interface.faces])), 0]
            for interface in interfaces
        ]
        begin, end = float(extents[0].max()), float(extents[1].min())
        if begin >= end:
            raise NotPrismaticError(
                f"bodies.{body.name}: the interfaces of the part overlap along the line "
                "between them, so that no prismatic pieces fit in between; use --parts condensed"
            )
        try:
            return _pieces_and_masses(mesh, positions, (begin, end), pieces, material)
        except InputError as error:
            # The class is kept: NotPrismaticError is a fault of neither the program nor the file.
            kind = type(error)
            raise kind(f"bodies.{body.name}: {fault}" for fault in error.faults) from error

    def read(arrays: Arrays) -> SteppedLeg:
        length = float(np.linalg.norm(np.subtract(*(i.point for i in reversed(interfaces)))))
        require_shape(arrays, line=(pieces + 1, 3), root_mass=(6, 6), tip_mass=(6, 6))
        return SteppedLeg(
            length=length,
            pieces=tuple(
                Piece(start, end, axes, BeamProperties(*numbers.tolist()))
                for start, end, axes, numbers in zip(
                    arrays["line"][:-1],
                    arrays["line"][1:],
                    arrays["axes"],
                    arrays["properties"],
                    strict=True,
                )
            ),
            root_mass=arrays["root_mass"],
            tip_mass=_about_tip(arrays["tip_mass"], length),
        )

    return CacheEntry(key, compute, read, mesh_entries(file, interfaces, unknowns, [MIDDLE]))


def why_not_stepped(mechanism: Mechanism) -> str:
    """Reason why CAD parts cannot be modelled as stepped legs. "" if all of them can."""
    legs = [body for body in mechanism.parts.values() if reduced_parts.is_leg(body)]
    if not legs:
        return "no part has exactly two interfaces; only such parts can be stepped"
    try:
        for body in legs:
            stepped(body)
    except InputError as error:
        return str(error)
    return ""


def _pieces_and_masses(
    mesh: PartMesh, positions: Array, span: tuple[float, float], count: int, material: Material
) -> dict[str, Any]:
    """Arrays of a stepped leg by name: "line", "axes", "properties", "root_mass" and "tip_mass".

    `positions` (N×3, in m, leg axes) are the nodes of the mesh, and `span` the x coordinates (m) of
    both ends of the pieces. The first three arrays describe the `count` pieces: points of the
    centre line (count+1 × 3), axes (count×3×3) and beam properties (one row for each piece). The
    masses (6×6 about the root, in leg axes) are those of the part before the first and after the
    last piece.
    """
    facets = boundary(mesh)
    line = np.zeros((count + 1, 3))
    line[:, 0] = np.linspace(*span, count + 1)
    for _ in range(_ROUNDS):
        line = _through_centroids(positions, facets, line)
    _require_prisms(positions, facets, line)
    across = [_across(end - start) for start, end in pairwise(line)]
    middles = 0.5 * (line[:-1] + line[1:])
    sections = slice_meshes(
        [slices_of(positions, facets, *cut)[0] for cut in zip(middles, across, strict=True)]
    )
    properties = [astuple(_properties(section, material)) for section in sections]
    masses = material.rho * cell_volumes(mesh)
    centres = positions[mesh.cells].mean(axis=1)
    before = (centres - line[0]) @ across[0][:, 0] < 0.0
    behind = (centres - line[-1]) @ across[-1][:, 0] > 0.0
    return {
        "line": line,
        "axes": np.array(across),
        "properties": np.array(properties),
        "root_mass": _mass(masses[before], centres[before]),
        "tip_mass": _mass(masses[behind], centres[behind]),
    }


def _require_prisms(positions: Array, facets: Facets, line: Array) -> None:
    """Raise NotPrismaticError if a section of the part is in two pieces or changes too fast.

    `line` (n+1×3, in m) are the ends of n pieces, `positions` (N×3, in m) the nodes of the part,
    both in leg axes. A change is too fast if it occurs over a length that is comparable to the size
    of the section. An opening in the part divides a beam into two beams side by side, and so its
    section into two. If the two beams bend apart, they are much softer than one section and much
    stiffer than either beam alone. A rib matters only if it lies at the middle of a prismatic
    piece, since the section of the piece is taken there.
    """
    cuts, sizes, middles, measured = [], [], [], []
    lengths = np.linalg.norm(np.diff(line, axis=0), axis=1)
    starts = np.cumsum(lengths) - lengths
    for k, (start, end) in enumerate(pairwise(line)):
        axes = _across(end - start)
        size = slices_of(positions, facets, 0.5 * (start + end), axes)[0].size
        # An odd number, so that one cut lies in the middle.
        count = 2 * int(np.ceil(0.5 * _CUTS_PER_SIZE * lengths[k] / size)) + 1
        for share in (np.arange(count) + 0.5) / count:
            # Cuts beyond the middles of the first and of the last piece would meet the edges of the
            # interfaces.
            if (k == 0 and share < 0.5) or (k == len(lengths) - 1 and share > 0.5):
                continue
            middle = start + share * (end - start)
            piece, *further_slices = slices_of(positions, facets, middle, axes)
            if further_slices:
                raise NotPrismaticError(
                    f"the cross-section {middle[0]:.4g} m from the first interface "
                    f"consists of {1 + len(further_slices)} separate areas, so that it is "
                    "not a prism there; use --parts condensed"
                )
            cuts.append((starts[k] + share * lengths[k], middle[0]))
            sizes.append(piece.size)
            middles.append(share == 0.5)
            measured.append(piece.measures)
    along, values = np.array(cuts)[:, 0], np.array(measured)
    for k, value in enumerate(values):
        distances = along - along[k]
        sides = [
            values[(sign * distances > 0.0) & (sign * distances < 0.5 * sizes[k])]
            for sign in (-1, 1)
        ]
        if not all(map(len, sides)):
            continue
        weaker = np.min([side.max(axis=0) for side in sides], axis=0) / value
        stronger = value / np.max([side.min(axis=0) for side in sides], axis=0)
        for factors, word in ((weaker, "smaller"), (stronger * middles[k], "larger")):
            if factors.max() > _LARGEST_RATIO:
                raise NotPrismaticError(
                    f"the cross-section {cuts[k][1]:.4g} m from the first interface is "
                    f"not prismatic: its {_MEASURES[factors.argmax()]} is "
                    f"{factors.max():.3g} times {word} than that of cross-sections within "
                    f"{0.5 * sizes[k]:.3g} m on both sides; use --parts condensed"
                )


def _through_centroids(positions: Array, facets: Facets, line: Array) -> Array:
    """Centre line of n pieces: its points (n+1×3, m), from the centroids of the n sections.

    `line` (n+1×3, in m) is an estimate of the result, `positions` (N×3, in m) are the nodes of the
    part, both in leg axes. Inner points lie midway between neighbouring centroids; both ends are
    extrapolated. If there is one piece, its line is shifted to the centroid.
    """
    centroids = []
    for start, end in pairwise(line):
        axes, middle = _across(end - start), 0.5 * (start + end)
        centroids.append(
            middle + axes[:, 1:] @ slices_of(positions, facets, middle, axes)[0].centroid
        )
    centres = np.array(centroids)
    if len(centres) == 1:
        return np.asarray(line + centres[0] - line.mean(axis=0))
    ends = 1.5 * centres[[0, -1]] - 0.5 * centres[[1, -2]]
    return np.vstack([ends[:1], 0.5 * (centres[:-1] + centres[1:]), ends[1:]])


def _across(direction: Array) -> Array:
    """Axes (3×3, columns) with x along `direction` and z as near as possible to the leg's z."""
    x = direction / np.linalg.norm(direction)
    y = np.cross([0.0, 0.0, 1.0], x)
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])


def _properties(mesh: SectionMesh, material: Material) -> BeamProperties:
    """Beam properties of a section, in the axes of its mesh."""
    constants = section_constants(mesh, material.nu, material.G / material.E)
    return beam_properties(constants, material)


def _mass(masses: Array, positions: Array) -> Array:
    """Mass matrix (6×6, about the origin) of point masses (n) at `positions` (n×3)."""
    total, first = float(masses.sum()), masses @ positions
    second = (positions * masses[:, None]).T @ positions
    inertia = np.trace(second) * np.eye(3) - second
    return np.block([[total * np.eye(3), -skew(first)], [skew(first), inertia]])


def _about_tip(mass: Array, length: float) -> Array:
    """Mass matrix (6×6) about the tip of a leg of `length` (m), from `mass` about its root."""
    back = shift(np.array([-length, 0.0, 0.0]))
    return np.asarray(back.T @ mass @ back)
