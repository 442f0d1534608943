"""Each leg as a solid: its mesh in its first modes, the lumped model's shape drawn over it."""

from dataclasses import dataclass

import numpy as np

from fem.bodies import solid
from fem.bodies.leg_energies import kind_energies
from lumped.arrays import Array, IntArray
from lumped.legs import ConstantLeg
from lumped.models.cantilever import clamped_modes
from meshes.elements import ELEMENTS
from meshes.solid_mesh import SolidMesh
from validation.agreement.mode_pairing import centreline_samples, centreline_weights, pair_modes
from validation.context import Context
from validation.drawing.opengl import require_vtk
from validation.drawing.prisms import (
    Surface,
    edges,
    frames,
    prism_points,
    section_displacements,
)
from validation.drawing.rendering import (
    Body,
    Wire,
    colour_bar,
    picture_of,
    squares,
    staged,
)
from validation.drawing.scenes import interactive
from validation.drawing.style import LOOKS, canvas, csv_of, plot_style
from validation.kinematics.solids import outlines
from validation.models.legs import constant_leg_of, leg_matrices, solid_modes
from validation.models.options import DEFAULT_OPTIONS
from validation.report.figures.declared import FigureGroup, Shown
from validation.report.figures.mechanism.mode_names import leading_kind
from validation.solids.size import skip_too_large

MODES = 4
# Enough for a picture: the numbers of the report come from finer meshes.
DIVISIONS = 2
_SPARE_MODES = 6
_STATIONS = 24
_DRAWN = 0.14
# How much larger than the leg the lumped model's outlines are drawn, to be seen on its surface.
_OUTSET = 1.04
_HEIGHT = 2.1
_CAMERA = np.array([0.55, -1.0, 0.65]), np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class LegModes:
    """Modes of a clamped leg as a solid beside those of its segments.

    `shapes` 3N×m on the mesh; `twists` and `lumped` (6s×m) of both models at the same s `stations`
    (m from the root), `lumped` in the solid's sense; `kinds` name the deformation.
    """

    mesh: SolidMesh
    frequencies: Array
    shapes: Array
    stations: Array
    twists: Array
    lumped: Array
    lumped_frequencies: Array
    mac: Array
    kinds: tuple[str, ...]


_REPEATED = (
    " Two modes at one frequency can be combined at will, so that their MAC may lie below 1 for "
    "the same shapes."
)


of_leg1, of_leg2 = FigureGroup("Leg 1", "pictures"), FigureGroup("Leg 2", "pictures")


@of_leg1.figure("leg1.solid-modes", "Leg 1 as a solid: first modes", effort=2.0)
def first_leg(context: Context) -> Shown:
    """Leg 1."""
    return _mode_shapes(context, 1)


@of_leg2.figure("leg2.solid-modes", "Leg 2 as a solid: first modes", effort=2.0)
def second_leg(context: Context) -> Shown:
    """Leg 2."""
    return _mode_shapes(context, 2)


def _mode_shapes(context: Context, number: int) -> Shown:
    """Four panels: the first modes of leg 1 or 2, root clamped."""
    require_vtk()
    leg = constant_leg_of(context, f"leg{number}")
    skip_too_large([leg], [DIVISIONS], context.preset)
    found = context.get(leg_modes, leg, MODES)
    faces = boundary_faces(found.mesh)
    said, scenes = [], []
    with plot_style():
        picture, panels = canvas(rows=2, columns=2, height=2.0 * _HEIGHT + 1.3)
        for mode, (axes, letter) in enumerate(zip(panels, "abcd", strict=True)):
            moved = found.shapes[:, mode].reshape(-1, 3)
            sizes = np.linalg.norm(moved, axis=1)
            factor = _DRAWN * leg.length / float(sizes.max())
            deformed = found.mesh.nodes + factor * moved
            surface = Surface(deformed, faces, sizes / sizes.max(), factor * moved)
            bodies, rest = [Body(surface, edge="#30343a")], [at_rest(leg)]
            room = 2, _HEIGHT
            scene = staged(axes, bodies, rest, (0.0, 1.0), _CAMERA, room, [found.mesh.nodes])
            lumped = found.lumped[:, mode].reshape(-1, 6)[:, :3]
            straight = np.column_stack([found.stations, np.zeros((len(found.stations), 2))])
            squares(axes, scene.view, straight + factor * lumped, LOOKS["segments"].colour)
            title = (
                f"({letter}) mode {mode + 1}: {found.frequencies[mode]:.1f} Hz, {found.kinds[mode]}"
            )
            axes.set_title(title)
            twists = factor * found.lumped[:, mode].reshape(-1, 6)
            scenes.append(interactive(title, scene, [segments_over(leg, found.stations, twists)]))
            said.append(
                f"{found.lumped_frequencies[mode]:.1f} Hz (MAC {found.mac[mode]:.3f}, {letter})"
            )
        colour_bar(picture, panels, (0.0, 1.0), "displacement, largest = 1", aspect=50.0)
        drawn = picture_of(picture)
    return Shown(
        (
            "Equivalent constant-section leg, root end face clamped (left), thin lines: at rest; "
            f"quadratic hexahedra, coarse mesh of {len(found.mesh.cells)} elements. Orange "
            "squares, and frames in three dimensions: the same mode of the segments, at "
            f"{', '.join(said)}. A MAC of 1 means the same shape; "
            "where torsion of the solid lies higher, the cause is the warping that the rigid end "
            "faces restrain."
            + (
                _REPEATED
                if np.any(np.diff(found.frequencies) < 1e-3 * found.frequencies[1:])
                else ""
            )
        ),
        picture=drawn,
        data=_table(found),
        scenes=tuple(scenes),
    )


def segments_over(leg: ConstantLeg, stations: Array, twists: Array) -> Wire:
    """Outlines of the lumped model at s `stations` (m), moved by `twists` (s×6), around the leg."""
    corners = _OUTSET * outlines(leg.section)[0]
    points = prism_points(corners, stations)
    moved = section_displacements(points, np.repeat(twists, len(corners), axis=0))
    pairs = frames(len(corners), len(stations))
    return Wire(points + moved, pairs, LOOKS["segments"].colour, 2.5, moved)


def at_rest(leg: ConstantLeg) -> Wire:
    """Edges of the undeformed leg."""
    corners, _ = outlines(leg.section)
    return Wire(prism_points(corners, np.array([0.0, leg.length])), edges(len(corners), 2))


def leg_modes(leg: ConstantLeg, count: int) -> LegModes:
    """The first `count` modes of the solid, each with the segments' mode of largest MAC."""
    modes = solid_modes(leg, DIVISIONS, "rigid", count)
    mesh = solid.solid_mesh(leg, DIVISIONS)
    stations, lengths = centreline_samples(leg.length, _STATIONS)
    weights = centreline_weights(leg.timoshenko, lengths)
    segments = leg_matrices("segments", leg, DEFAULT_OPTIONS)
    lumped = clamped_modes(segments, count + _SPARE_MODES)
    twists = solid.section_twists(mesh, stations) @ modes.shapes
    candidates = segments.centreline(stations) @ lumped.shapes
    pairing = pair_modes(twists, candidates, weights)
    partners = candidates[:, pairing.partner]
    sense = np.sign(np.sum(weights[:, None] * twists * partners, axis=0))
    strain = kind_energies(solid.solid_leg(leg, mesh), modes.shapes)
    return LegModes(
        mesh=mesh,
        frequencies=modes.frequencies,
        shapes=modes.shapes,
        stations=stations,
        twists=twists,
        lumped=partners * sense,
        lumped_frequencies=lumped.frequencies[pairing.partner],
        mac=pairing.mac,
        kinds=tuple(leading_kind(strain, mode) for mode in range(count)),
    )


def boundary_faces(mesh: SolidMesh) -> IntArray:
    """Quadrangles (q×4 node numbers) on the surface of a mesh of hexahedra, through its corners."""
    corners = mesh.cells[:, list(ELEMENTS[mesh.element].vtk_order)][:, :8]
    faces = np.concatenate([corners[:, list(face)] for face in _HEXAHEDRON])
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    outer: IntArray = faces[first[count == 1]]
    return outer


# Faces of VTK's hexahedron, normals outwards.
_HEXAHEDRON = (
    (0, 4, 7, 3),
    (1, 2, 6, 5),
    (0, 1, 5, 4),
    (3, 7, 6, 2),
    (0, 3, 2, 1),
    (4, 5, 6, 7),
)


def _table(found: LegModes) -> str:
    columns = {"distance from the root (m)": found.stations.tolist()}
    for mode in range(MODES):
        largest = float(np.abs(found.twists[:, mode].reshape(-1, 6)[:, :3]).max())
        for model, twists in (("solid FE", found.twists), ("segments", found.lumped)):
            moved = twists[:, mode].reshape(-1, 6)[:, :3] / largest
            columns |= {
                f"{model}: mode {mode + 1} along {axis} (largest of the solid = 1)": c.tolist()
                for axis, c in zip("xyz", moved.T, strict=True)
            }
    return csv_of(columns)
