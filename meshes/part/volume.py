"""Second-order tetrahedra in a CAD part, graded to curvature, interfaces and inner edges.

The meshes of a ladder are similar: sizes, sides of a circle and the grading near interfaces shrink
together from mesh to mesh, so that three meshes define an order of convergence.
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

# Ratio of the element sizes of successive meshes of a ladder; three meshes span a factor of two.
RATIO = sqrt(2.0)
# Sides of a full circle on the coarsest mesh; curved tetrahedra on longer arcs would be folded.
_SIDES = 12.0
# Ratio of element sizes at an interface and away from it, and the distance, in elements, over which
# sizes grow. Edges of rigid interfaces are singular.
_AT_INTERFACES, _REACH = 0.6, 4.0
# Start value and lower bound of the exponent with which unknowns grow with 1/h at constant sides of
# circles: 3 in massive parts, 2 in walls, less if fillets and bores dominate the mesh.
_POWER, _LEAST_POWER = 2.5, 1.0
_ATTEMPTS = 8
# Accepted range of actual to requested unknowns. With elements much longer than the wall thickness
# the number hardly depends on their size, so that too few unknowns would mean far too coarse ones.
_LEAST_SHARE, _MOST_SHARE = 0.95, 1.25
# Number of unknowns from which elements at re-entrant edges are cut. With fewer unknowns, too few
# remain elsewhere: at 6000 to 15 000 a fifth of the stated half-widths of random box tubes failed.
_CUT_FROM = 50_000
# Number of size reductions for a surface whose facets intersect.
_RETRIES = 8
# gmsh's numbers of its algorithms.
_DELAUNAY, _FRONTAL = 1, 4
# Size factor, passes of Netgen's optimiser and algorithm of successive attempts. The optimiser
# takes as long as the mesh and reduces the error by a quarter. With elements as coarse as the wall
# thickness it may end its process (gmsh 4.15), and a flat element may remain at a wall; another
# size gives another mesh. With elements several times as long, Delaunay's criterion leaves some
# with four corners on one flat face at any size. The advancing front, with up to a quarter more
# elements, leaves none.
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
# Smallest element relative to the full size; otherwise long fillets would dominate the mesh.
_SHORTEST = 0.2
# Limit on the CPU time (s) of a mesh, and of the search for the sizes of a ladder. No further mesh
# is attempted after so much time.
_SECONDS = 600.0
# Degree of the Jacobian of a curved tetrahedron.
_DEGREE = 3


@dataclass(frozen=True)
class Grading:
    """Element size `size` (m) away from curvature and interfaces, `sides` of a full circle.

    `sides` is zero if sizes do not follow the curvature.
    `cut`: elements at re-entrant edges are refined across these.
    """

    size: float
    sides: float = _SIDES
    cut: bool = False

    def refined(self, ratio: float = RATIO) -> "Grading":
        """Grading with all lengths divided by `ratio`."""
        return replace(self, size=self.size / ratio, sides=self.sides * ratio)


def volume_mesh(part: PartFile, interfaces: Sequence[Interface], grading: Grading) -> PartMesh:
    """Mesh a part with second-order tetrahedra, whose curved edges lie on the true surface.

    If gmsh fails at that size, slightly smaller sizes are attempted. Raises InputError if the
    surface cannot be meshed, if gmsh crashes or if the part is a mesh, ComputationError if no size
    succeeds.
    """
    if part.mesh is not None:
        raise InputError(f"{part.path}: is a mesh already; it cannot be meshed anew")
    surface_error: InputError | None = None
    mesh_error: ComputationError | None = None
    start_time = monotonic()
    for share, netgen, algorithm in _ATTEMPTED_SETTINGS:
        attempt = replace(grading, size=share * grading.size)
        try:
            return within_limits(_SECONDS, _meshed, part, interfaces, attempt, netgen, algorithm)
        # Delaunay's algorithm may fail to recover a surface that others can fill.
        except InputError as error:
            surface_error = surface_error or error
        except ComputationError as error:
            # A fault of the mesh is more informative than the end of the process.
            mesh_error = (
                error if mesh_error is None or not isinstance(error, Crashed) else mesh_error
            )
        if monotonic() - start_time > _SECONDS:
            break
    crashed = mesh_error is None or isinstance(mesh_error, Crashed)
    if surface_error and crashed:
        raise surface_error
    raise (InputError if crashed else ComputationError)(
        f"{part.path}: gmsh makes no sound mesh of elements of {grading.size:.3g} m: {mesh_error}; "
        "ask for another number of unknowns"
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
    # gmsh's own optimisers of curved elements are not used, because they may end the process if
    # they fail (std::runtime_error in 4.15).
    positions, count = straightened(mesh.nodes, mesh.cells)
    mesh = replace(mesh, nodes=positions, straightened=count)
    return cut_at_inner_edges(mesh) if grading.cut else mesh


def ladder(part: PartFile, interfaces: Sequence[Interface], unknowns: int) -> tuple[Grading, ...]:
    """Three gradings, coarse to fine, of which the finest has about as many `unknowns`.

    The size is found by meshes of the finest grading with straight edges, which are fast, starting
    from large elements, with secants of the logarithms. If facets of thin round walls intersect
    because they are too coarse, all three gradings are finer. A part that cannot be meshed with
    sizes from its curvature is meshed without. Raises InputError under the conditions of
    `volume_mesh`.
    """
    if part.exact is None:
        raise InputError(f"{part.path}: is a mesh already; it cannot be meshed anew")
    if not part.by_curvature:
        return _limited_ladder(part, interfaces, unknowns, 0.0)
    try:
        return _limited_ladder(part, interfaces, unknowns, _SIDES)
    except InputError as failed:
        try:
            return _limited_ladder(part, interfaces, unknowns, 0.0)
        except InputError:
            raise failed from None


def _limited_ladder(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int, sides: float
) -> tuple[Grading, ...]:
    try:
        return within_limits(_SECONDS, _ladder, part, interfaces, unknowns, sides)
    except Crashed as crash:
        raise InputError(
            f"{part.path}: gmsh fails to mesh it ({crash}); ask for another number of unknowns"
        ) from crash


def _ladder(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int, sides: float
) -> tuple[Grading, ...]:
    largest = max(part.extent) / 2.0
    size, power, cut = largest, _POWER, unknowns >= _CUT_FROM

    def finest(coarse: Grading) -> Grading:
        return coarse.refined().refined()

    def count(grading: Grading) -> int:
        # After a failed mesh, a model cannot be meshed again.
        with cad_model(part.path, part.unit) as model:
            # The mesh is only counted; an optimised one differs by a thousandth of the unknowns.
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


def _optimise(gmsh: ModuleType, own: int, netgen: int) -> None:
    """Set the number of passes of gmsh's own optimiser and of Netgen's."""
    gmsh.option.setNumber("Mesh.Optimize", own)
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
    """Raise InputError if the volume of tet10 with middles on the surface differs from the part's.

    The part's volume is integrated over its faces, each with its own outline and orientation;
    tetrahedra fill the space between the faces. An allowed difference is the volume between the
    mesh's curved facets and the flat ones of their corners, since curved facets are closer to the
    surface, plus the gap along the whole surface.
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
        # The shape function of a middle integrates to a third of the area.
        between += float(np.abs(np.einsum("fmi,fi->fm", rises, vectors)).sum()) / 3.0
    allowed = between + part.exact.error + (part.unknown_share + ROUNDING) * volume
    if not abs(filled - volume) <= allowed:
        raise InputError(
            f"{part.path}: its faces enclose {1e6 * volume:.6g} cm³, tetrahedra between them fill "
            f"{1e6 * filled:.6g} cm³, and the mesh explains a difference of "
            f"{1e6 * allowed:.2g} cm³: a face looks the wrong way or is bounded wrongly; export it "
            "anew from the CAD system"
        )
