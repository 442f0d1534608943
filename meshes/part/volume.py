"""Second-order tetrahedra in a CAD part, graded to curvature, interfaces and inner edges: a ladder.

The meshes of a ladder are alike: sizes, sides of a circle and the grading near interfaces shrink
together from mesh to mesh, so that three of them show an order of convergence.
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
from meshes.part.reading.cad import CadModel, cad_model, naming_the_place
from meshes.part.reading.read import PartFile
from meshes.part.straighten import straightened
from meshes.processes import Crashed, within_limits
from meshes.shape_functions import gradients, quadrature

# Each mesh of a ladder has elements shorter by this: three meshes then span a factor of two.
RATIO = sqrt(2.0)
# Sides of a full circle on the coarsest mesh; curved tetrahedra on longer arcs come out folded.
_SIDES = 12.0
# Elements at an interface are shorter by this, growing to full size within so many of them: there
# the edges of what is held rigidly are singular.
_AT_INTERFACES, _REACH = 0.6, 4.0
# Power of 1/h with which unknowns grow, sides of circles kept: 3 in massive parts, 2 in walls, and
# below where fillets and bores rule the mesh.
_POWER, _LEAST_POWER = 2.5, 1.0
_ATTEMPTS = 8
# Found by wanted unknowns that are near enough. Of elements much longer than walls are thick the
# number hardly depends on their size: too few there would be far too coarse.
_LEAST_SHARE, _MOST_SHARE = 0.95, 1.25
# Unknowns from which on elements at re-entrant edges are cut. With fewer the cut ones leave too few
# for all else: at 6000 to 15 000 a fifth of what was stated of random box tubes did not hold.
_CUT_FROM = 50_000
# How often sizes are reduced for a surface whose facets cross.
_RETRIES = 8
# gmsh's numbers of its algorithms.
_DELAUNAY, _FRONTAL = 1, 4
# Share of the size, passes of Netgen's optimiser and algorithm, tried in turn. The optimiser takes
# as long as the mesh, and a quarter of the error with it. Where elements are as coarse as walls are
# thick it may end its process (gmsh 4.15), and a flat element stay at a wall: another size has
# another mesh. Of elements several times as long Delaunay's criterion leaves some with four corners
# on one flat face at any size; the advancing front, up to a quarter more of them, leaves none.
_TRIED = (
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
# No element is shorter than this share of the full size: long fillets would rule the whole mesh.
_SHORTEST = 0.2
# Computing (s) that a mesh, and the search for the sizes of a ladder, may take each; once a mesh
# has taken so long no other one is tried.
_SECONDS = 600.0
# Degree of the Jacobian of a curved tetrahedron.
_DEGREE = 3


@dataclass(frozen=True)
class Grading:
    """Element size `size` (m) away from curvature and interfaces, `sides` of a full circle.

    `sides` is zero if sizes do not follow the curvature.
    `cut`: elements at re-entrant edges are cut near these.
    """

    size: float
    sides: float = _SIDES
    cut: bool = False

    def refined(self, ratio: float = RATIO) -> "Grading":
        """The same grading with everything shorter by `ratio`."""
        return replace(self, size=self.size / ratio, sides=self.sides * ratio)


def volume_mesh(part: PartFile, interfaces: Sequence[Interface], grading: Grading) -> PartMesh:
    """The part in second-order tetrahedra; curved edges lie on the true surface.

    Where gmsh makes no sound mesh of that size, one of a little less. Raises InputError where the
    surface cannot be meshed or gmsh does not survive it, ComputationError where no size does; a
    part that is a mesh is refused.
    """
    if part.mesh is not None:
        raise InputError(f"{part.path}: is a mesh already; it cannot be meshed anew")
    uneven: InputError | None = None
    failed: ComputationError | None = None
    begun = monotonic()
    for share, netgen, algorithm in _TRIED:
        tried = replace(grading, size=share * grading.size)
        try:
            return within_limits(_SECONDS, _meshed, part, interfaces, tried, netgen, algorithm)
        # Delaunay's algorithm may fail to recover a surface that others fill.
        except InputError as error:
            uneven = uneven or error
        except ComputationError as error:
            # What says what is wrong with a mesh says more than a process that ended.
            failed = error if failed is None or not isinstance(error, Crashed) else failed
        if monotonic() - begun > _SECONDS:
            break
    crashed = failed is None or isinstance(failed, Crashed)
    if uneven and crashed:
        raise uneven
    raise (InputError if crashed else ComputationError)(
        f"{part.path}: gmsh makes no sound mesh of elements of {grading.size:.3g} m: {failed}; ask "
        "for another number of unknowns"
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
        with naming_the_place(part.path, model):
            gmsh.model.mesh.generate(3)
            gmsh.model.mesh.setOrder(2)
        mesh = _as_it_is(gmsh, model.faces(), "tet10", "tri6")
        _require_filled(mesh, part)
    # Not by gmsh's own optimisers of curved elements: where they do not succeed they may end the
    # whole process (std::runtime_error in 4.15).
    places, count = straightened(mesh.nodes, mesh.cells)
    mesh = replace(mesh, nodes=places, straightened=count)
    return cut_at_inner_edges(mesh) if grading.cut else mesh


def ladder(part: PartFile, interfaces: Sequence[Interface], unknowns: int) -> tuple[Grading, ...]:
    """Three gradings, coarse to fine, of which the finest gives about so many `unknowns`.

    Found by meshes of straight edges, which are quick, of the finest: from large elements on, by
    secants of the logarithms. Facets of thin round walls may cross where they are too
    coarse: then all three are finer. What cannot be meshed with sizes from its curvature is meshed
    without. Raises InputError as `volume_mesh` does.
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
        # A model of which a mesh has failed fills no other one.
        with cad_model(part.path, part.unit) as model:
            # Counted, not solved on: optimised ones have as many unknowns to a thousandth.
            _optimise(model.gmsh, 0, 0)
            _set_sizes(model, interfaces, grading)
            with naming_the_place(part.path, model):
                model.gmsh.model.mesh.generate(3)
            corners = _as_it_is(model.gmsh, model.faces(), "tet4", "tri3")
            return second_order_unknowns(corners, cut=cut)

    def feasible(size: float, rung: Callable[[Grading], Grading]) -> tuple[float, int]:
        for _ in range(_RETRIES):
            with suppress(InputError):
                return size, count(rung(Grading(size, sides, cut)))
            size /= RATIO
        return size, count(rung(Grading(size, sides, cut)))

    size, found = feasible(size, finest)
    for _ in range(_ATTEMPTS):
        if _LEAST_SHARE < found / unknowns < _MOST_SHARE or (size == largest and found > unknowns):
            break
        before = size, found
        size = min(size * (found / unknowns) ** (1.0 / power), largest)
        size, found = feasible(size, finest)
        if isclose(size, before[0], rel_tol=0.01):
            # What is coarser cannot be meshed.
            break
        power = max(log(found / before[1]) / log(before[0] / size), _LEAST_POWER)
    coarse = Grading(feasible(size, lambda coarse: coarse)[0], sides, cut)
    return coarse, coarse.refined(), finest(coarse)


def _optimise(gmsh: ModuleType, own: int, netgen: int) -> None:
    """Passes of gmsh's own optimiser and of Netgen's."""
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


def _as_it_is(
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
    """Raise InputError where tet10 with middles on the surface have another volume than the part.

    That is integrated over the faces, each with its own outline and outside; tetrahedra fill
    what lies between them. The mesh explains what lies between its curved facets and the flat ones
    of their corners: curved ones are nearer to the surface. The gap along all of the surface, too.
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
        places = mesh.nodes[facets.cells]
        rises = places[:, 3:] - places[:, SIMPLEX_EDGES[3]].mean(axis=2)
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
