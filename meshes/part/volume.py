"""Meshes of second-order tetrahedra in a CAD part, graded to curvature, interfaces and inner edges.

The three meshes of a refinement are similar: element sizes, sides per circle and the grading near
interfaces decrease together, so that an order of convergence can be determined.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import isclose, log, sqrt
from time import monotonic
from types import ModuleType

import numpy as np

from lumped.errors import ComputationError, InputError
from meshes.elements import SIMPLEX_EDGES, SectionElement, SolidElement
from meshes.gmsh_session import connectivity, numbered
from meshes.part.boundary import Facets, PartMesh, area_vectors
from meshes.part.enclosed import ROUNDING
from meshes.part.inner_edges import cut_at_inner_edges, second_order_unknowns
from meshes.part.interfaces import Interface
from meshes.part.reading.cad import CadModel, cad_model, locating_mesh_failures
from meshes.part.reading.read import PartFile
from meshes.part.straighten import straightened
from meshes.processes import Crashed, within_limits
from meshes.shape_functions import gradients, quadrature

# Ratio of the element sizes of successive meshes of a refinement. Three meshes span a factor of
# two.
RATIO = sqrt(2.0)
# Number of sides per full circle on the coarsest mesh. Curved tetrahedra on longer arcs would fold.
_SIDES = 12.0
# Ratio of element sizes at an interface to those away from it, and the distance in element sizes
# over which sizes grow. Stresses are singular at the edges of rigid interfaces.
_AT_INTERFACES, _REACH = 0.6, 4.0
# Initial value and lower limit of the exponent with which the number of unknowns grows with 1/h: 3
# in massive parts, 2 in walls, less if fillets and bores dominate the mesh.
_POWER, _LEAST_POWER = 2.5, 1.0
_ATTEMPTS = 8
# Accepted range of the ratio of actual to requested unknowns. If elements are much longer than the
# wall thickness, the number hardly depends on their size, so that slightly fewer unknowns would
# mean far too coarse elements.
_LEAST_SHARE, _MOST_SHARE = 0.95, 1.25
# Number of unknowns from which elements at re-entrant edges are cut. With fewer unknowns, too few
# remain elsewhere: at 6000 to 15 000, a fifth of the half-widths of random box tubes were too
# small.
_CUT_FROM = 50_000
# Largest number of reductions of the element size for a surface whose facets intersect.
_RETRIES = 8
# Numbers of meshing algorithms in gmsh.
_DELAUNAY, _FRONTAL = 1, 4
# Factor on the size, passes of Netgen's optimiser, and algorithm of successive attempts. The
# optimiser takes as long as the mesh and reduces the error by a quarter. If elements are as coarse
# as the wall thickness, it may crash (gmsh 4.15), or leave a flat element at a wall; a slightly
# different size gives another mesh. If elements are several times as long, Delaunay's algorithm
# creates elements with four corners on one flat face at any size. The advancing front creates none,
# but up to a quarter more elements.
_ATTEMPTED_SETTINGS = (
    (1.0, 1, _DELAUNAY),
    (0.97, 1, _DELAUNAY),
    (1.0, 0, _DELAUNAY),
    (0.97, 0, _DELAUNAY),
    (0.94, 1, _DELAUNAY),
    (0.94, 0, _DELAUNAY),
    (1.0, 1, _FRONTAL),
    (1.0, 0, _FRONTAL),
    (0.9, 1, _FRONTAL),
    (0.9, 0, _FRONTAL),
)
# Smallest element relative to the full size. Otherwise long fillets would dominate the mesh.
_SHORTEST = 0.2
# Limit on the CPU time (s) of a mesh, and of the search for the element sizes of a refinement. No
# further mesh is attempted after this time.
_SECONDS = 600.0
# Polynomial degree of the Jacobian of a curved tetrahedron.
_DEGREE = 3


@dataclass(frozen=True)
class Grading:
    """Element sizes of a mesh.

    `size` (m) applies away from curvature and interfaces. `sides` is the number of element sides
    per full circle. Zero if sizes do not follow the curvature. If `cut` is True, elements at
    re-entrant edges are refined in the direction away from these edges (`meshes.part.inner_edges`).
    """

    size: float
    sides: float = _SIDES
    cut: bool = False

    def refined(self, ratio: float = RATIO) -> "Grading":
        """Grading of a finer mesh: `size` divided by `ratio`, `sides` multiplied by it."""
        return replace(self, size=self.size / ratio, sides=self.sides * ratio)


def volume_mesh(part: PartFile, interfaces: Sequence[Interface], grading: Grading) -> PartMesh:
    """Mesh of a part with second-order tetrahedra, whose curved edges lie on the true surface.

    If gmsh fails, other settings and slightly smaller sizes than those of `grading` are attempted.
    Raises InputError if the surface cannot be meshed, if gmsh crashes or if the part is a mesh
    already, ComputationError if all attempts fail.
    """
    if part.mesh is not None:
        raise InputError(f"{part.path}: is a mesh already; it cannot be meshed again")
    surface_error: InputError | None = None
    mesh_error: ComputationError | None = None
    start_time = monotonic()
    for share, netgen, algorithm in _ATTEMPTED_SETTINGS:
        attempt = replace(grading, size=share * grading.size)
        try:
            return within_limits(_SECONDS, _meshed, part, interfaces, attempt, netgen, algorithm)
        # Delaunay's algorithm may fail on a surface that other algorithms can fill.
        except InputError as error:
            surface_error = surface_error or error
        except ComputationError as error:
            # A fault of the mesh is more informative than a crash of the process.
            mesh_error = (
                error if mesh_error is None or not isinstance(error, Crashed) else mesh_error
            )
        if monotonic() - start_time > _SECONDS:
            break
    crashed = mesh_error is None or isinstance(mesh_error, Crashed)
    if surface_error and crashed:
        raise surface_error
    raise (InputError if crashed else ComputationError)(
        f"{part.path}: gmsh makes no valid mesh of elements of {grading.size:.3g} m: "
        f"{mesh_error}; choose another number of unknowns"
    )


def _meshed(
    part: PartFile,
    interfaces: Sequence[Interface],
    grading: Grading,
    netgen: int,
    algorithm: int,
) -> PartMesh:
    with cad_model(part.path, part.unit) as model:
        gmsh = model.gmsh
        gmsh.option.setNumber("Mesh.Algorithm3D", algorithm)
        _set_sizes(model, interfaces, grading)
        _optimise(gmsh, 1, netgen)
        with locating_mesh_failures(part.path, model):
            gmsh.model.mesh.generate(3)
            gmsh.model.mesh.setOrder(2)
        mesh = _current_mesh(gmsh, model.faces(), "tet10", "tri6")
        _require_filled(mesh, part)
    # The optimisers of gmsh for curved elements are not used, because they crash if they fail
    # (std::runtime_error in 4.15).
    positions, count = straightened(mesh.nodes, mesh.cells)
    mesh = replace(mesh, nodes=positions, straightened=count)
    return cut_at_inner_edges(mesh) if grading.cut else mesh


def refined_gradings(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int
) -> tuple[Grading, ...]:
    """Gradings of three similar meshes of a part, coarse to fine.

    The finest mesh has about the given number of `unknowns`. Its element size is found by the
    secant method on the logarithms of size and unknowns, starting from large elements. The unknowns
    of each trial size are counted on a mesh with straight edges, which is made fast. If elements
    are so coarse that facets of thin round walls intersect, all three gradings are made finer. If a
    part cannot be meshed with sizes that follow its curvature, sizes that do not follow it are
    used. Raises InputError as `volume_mesh` does.
    """
    if part.exact is None:
        raise InputError(f"{part.path}: is a mesh already; it cannot be meshed again")
    if not part.by_curvature:
        return _limited_gradings(part, interfaces, unknowns, 0.0)
    try:
        return _limited_gradings(part, interfaces, unknowns, _SIDES)
    except InputError as failed:
        try:
            return _limited_gradings(part, interfaces, unknowns, 0.0)
        except InputError:
            raise failed from None


def _limited_gradings(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int, sides: float
) -> tuple[Grading, ...]:
    try:
        return within_limits(_SECONDS, _find_gradings, part, interfaces, unknowns, sides)
    except Crashed as crash:
        raise InputError(
            f"{part.path}: gmsh fails to mesh the part ({crash}); choose another number of unknowns"
        ) from crash


def _find_gradings(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int, sides: float
) -> tuple[Grading, ...]:
    largest = max(part.extent) / 2.0
    size, power, cut = largest, _POWER, unknowns >= _CUT_FROM

    def finest(coarse: Grading) -> Grading:
        return coarse.refined().refined()

    def count(grading: Grading) -> int:
        # After a failed mesh, a model cannot be meshed again.
        with cad_model(part.path, part.unit) as model:
            # Only the number of unknowns is needed. Optimising would change it by a thousandth.
            _optimise(model.gmsh, 0, 0)
            _set_sizes(model, interfaces, grading)
            with locating_mesh_failures(part.path, model):
                model.gmsh.model.mesh.generate(3)
            corners = _current_mesh(model.gmsh, model.faces(), "tet4", "tri3")
            return second_order_unknowns(corners, cut=cut)

    def feasible(size: float, rung: Callable[[Grading], Grading]) -> tuple[float, int]:
        for _ in range(_RETRIES):
            with suppress(InputError):
                return size, count(rung(Grading(size, sides, cut)))
            size /= RATIO
        return size, count(rung(Grading(size, sides, cut)))

    size, count_at_size = feasible(size, finest)
    for _ in range(_ATTEMPTS):
        if _LEAST_SHARE < count_at_size / unknowns < _MOST_SHARE or (
            size == largest and count_at_size > unknowns
        ):
            break
        previous = size, count_at_size
        size = min(size * (count_at_size / unknowns) ** (1.0 / power), largest)
        size, count_at_size = feasible(size, finest)
        if isclose(size, previous[0], rel_tol=0.01):
            # Coarser meshes fail.
            break
        power = max(log(count_at_size / previous[1]) / log(previous[0] / size), _LEAST_POWER)
    coarse = Grading(feasible(size, lambda coarse: coarse)[0], sides, cut)
    return coarse, coarse.refined(), finest(coarse)


def _optimise(gmsh: ModuleType, gmsh_passes: int, netgen: int) -> None:
    """Set the number of passes of gmsh's optimiser and of Netgen's optimiser."""
    gmsh.option.setNumber("Mesh.Optimize", gmsh_passes)
    gmsh.option.setNumber("Mesh.OptimizeNetgen", netgen)


def _set_sizes(model: CadModel, interfaces: Sequence[Interface], grading: Grading) -> None:
    gmsh = model.gmsh
    gmsh.option.setNumber("Mesh.MeshSizeMax", grading.size)
    gmsh.option.setNumber("Mesh.MeshSizeMin", _SHORTEST * grading.size)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", grading.sides)
    field = gmsh.model.mesh.field
    for tag in field.list():
        field.remove(tag)
    faces = [number for interface in interfaces for number in interface.faces]
    if not faces:
        return
    edges = {tag for _, tag in gmsh.model.getBoundary([(2, f) for f in faces], combined=False)}
    distance, threshold = field.add("Distance"), field.add("Threshold")
    field.setNumbers(distance, "SurfacesList", faces)
    field.setNumbers(distance, "CurvesList", sorted({abs(tag) for tag in edges}))
    field.setNumber(distance, "Sampling", 40)
    field.setNumber(threshold, "InField", distance)
    field.setNumber(threshold, "SizeMin", _AT_INTERFACES * grading.size)
    field.setNumber(threshold, "SizeMax", grading.size)
    field.setNumber(threshold, "DistMin", 0.0)
    field.setNumber(threshold, "DistMax", _REACH * grading.size)
    field.setAsBackgroundMesh(threshold)


def _current_mesh(
    gmsh: ModuleType, faces: Sequence[int], element: SolidElement, facet: SectionElement
) -> PartMesh:
    tagged = connectivity(gmsh, element)
    tags, nodes = numbered(gmsh, tagged)
    return PartMesh(
        nodes=nodes,
        cells=np.searchsorted(tags, tagged),
        element=element,
        faces={
            tag: Facets(np.searchsorted(tags, connectivity(gmsh, facet, tag)), facet)
            for tag in faces
        },
    )


def _require_filled(mesh: PartMesh, part: PartFile) -> None:
    """Raise InputError if the volume of a mesh of tet10 differs from that of the part.

    The volume of the part is an integral over its faces, each with its own outline and orientation.
    The tetrahedra fill the space between the faces. Two differences are allowed. The first is the
    volume between the curved facets of the mesh and flat facets with the same corners, because
    curved facets are closer to the surface than flat ones. The second is the uncertainty of the
    part's volume, mainly the gap times the area.
    """
    if part.exact is None:
        return
    volume = part.exact.volume
    points, weights = quadrature("tet10", _DEGREE)
    slopes = gradients("tet10", points)
    jacobians = np.einsum("mki,kjq->mqij", mesh.nodes[mesh.cells], slopes, optimize=True)
    filled = float((np.linalg.det(jacobians) @ weights).sum())
    between = 0.0
    for facets in mesh.faces.values():
        positions = mesh.nodes[facets.cells]
        rises = positions[:, 3:] - positions[:, SIMPLEX_EDGES[3]].mean(axis=2)
        vectors = area_vectors(mesh.nodes, Facets(facets.corners, "tri3"))
        # The integral of the shape function of an edge midpoint is a third of the area.
        between += float(np.abs(np.einsum("fmi,fi->fm", rises, vectors)).sum()) / 3.0
    allowed = between + part.exact.error + (part.unknown_share + ROUNDING) * volume
    if not abs(filled - volume) <= allowed:
        raise InputError(
            f"{part.path}: the faces of the part enclose {1e6 * volume:.6g} cm³, tetrahedra "
            f"between them fill {1e6 * filled:.6g} cm³, and the mesh accounts for a difference of "
            f"{1e6 * allowed:.2g} cm³: a face points the wrong way or has a wrong boundary; "
            "export the part again from the CAD system"
        )
