"""Interfaces of parts by number, name, cylinder and plane; volume meshes of a wanted size."""

import numpy as np
import pytest
from support.robots import drawn_parts
from support.robots.drawn_parts import meshed, plane_ends, read_here, written
from support.robots.paper_legs import STEEL

from fem.bodies.part import meshed_part
from lumped.errors import ComputationError, InputError
from lumped.mechanism.body import ByCylinder, ByFaces, ByName, ByPlane, PartInterface
from lumped.sections import Rectangle
from meshes.elements import ELEMENTS
from meshes.part import volume
from meshes.part.boundary import Facets, PartMesh, area_vectors, boundary
from meshes.part.inner_edges import cut_at_inner_edges, inner_edges, second_order_unknowns
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.part.spread import cell_volumes, spread_over
from meshes.part.straighten import straightened
from meshes.part.volume import Grading, volume_mesh
from meshes.prism import extrude
from meshes.processes import Crashed
from meshes.section.section_mesh import section_mesh

pytestmark = pytest.mark.usefixtures("in_this_process")


@pytest.fixture(scope="module")
def bar(box_step):
    part = read_here(box_step)
    return part, find_interfaces(part, plane_ends(0.1))


def test_crashing_optimiser_is_skipped(bar, monkeypatch):
    """gmsh crashes in Netgen's optimiser at two sizes: the part is meshed without it."""
    tried = []

    def crashing(_seconds, function, *arguments):
        *_, size, netgen, _ = arguments
        tried.append((size.size, netgen))
        if netgen:
            raise Crashed("crashed")
        return function(*arguments)

    monkeypatch.setattr(volume, "within_limits", crashing)
    plain = volume_mesh(*bar, Grading(0.02))
    assert tried == [(0.02, 1), (0.97 * 0.02, 1), (0.02, 0)]
    assert np.ptp(plain.nodes, axis=0) == pytest.approx([0.1, 0.02, 0.03])


@pytest.mark.parametrize(
    ("error", "kind"),
    [
        (Crashed("was ended by SIGSEGV"), InputError),
        (ComputationError("2 tetrahedra are flat"), ComputationError),
    ],
)
def test_unmeshable_part_is_reported(bar, monkeypatch, error, kind):
    """A crash of gmsh or flat tetrahedra: part, size and remedy in one message."""

    def failing(*_):
        raise error

    monkeypatch.setattr(volume, "within_limits", failing)
    with pytest.raises(kind, match=rf"box.step: gmsh makes no valid .* m: {error}; choose"):
        volume_mesh(*bar, Grading(0.02))
    if isinstance(error, Crashed):
        with pytest.raises(kind, match=rf"box.step: gmsh fails to mesh .* \({error}\); choose"):
            volume.refined_gradings(*bar, 20_000)


def test_size_search_skips_bad_facets(tmp_path):
    """Coarse facets of a thin conical tube intersect, so that the search starts finer."""

    def tube(occ):
        """Draw a conical tube of 600 mm whose wall of 12 mm is crossed by coarse facets."""
        outer, inner = (occ.addCone(0, 0, 0, 600, 0, 0, r, 0.7 * r) for r in (61.4, 49.3))
        occ.cut([(3, outer)], [(3, inner)])

    part = read_part(written(tmp_path / "tube.step", tube))
    mesh = volume_mesh(part, (), volume.refined_gradings(part, (), 8_000)[0])
    assert mesh.unknowns == pytest.approx(8_000, rel=0.35)


@pytest.mark.exhaustive
def test_rounded_bar_mesh_keeps_volume(tmp_path):
    """Quadratic elements on rounded edges lack less than 1 % of the volume that chords cut off."""

    def rounded(occ):
        """Draw a bar of 80 × 40 × 40 mm whose long edges are rounded with a radius of 8 mm."""
        bar = occ.addBox(0, -20, -20, 80, 40, 40)
        occ.synchronize()
        boxes = {tag: occ.getBoundingBox(1, tag) for _, tag in occ.getEntities(1)}
        occ.fillet([bar], [tag for tag, box in boxes.items() if box[3] - box[0] > 50], [8])

    part = read_part(written(tmp_path / "rounded.step", rounded))
    mesh = volume_mesh(part, find_interfaces(part, plane_ends(0.08)), Grading(0.02))
    corners = mesh.nodes[mesh.cells[:, :4]]
    edges = corners[:, 1:] - corners[:, :1]
    chords = np.linalg.det(edges).sum() / 6.0 / part.exact.volume - 1.0
    assert chords < -3e-3
    assert mesh.straightened == 0
    # The area error of a parabola over a short arc is below a hundredth of that of a chord.
    filled = meshed_part("part", mesh, STEEL).properties().mass / STEEL.rho
    assert abs(filled / part.exact.volume - 1.0) < 0.01 * abs(chords)


def test_inverted_tetrahedra_are_straightened():
    """Mid-edge nodes move to the middles of their edges. Flat and mirrored elements are refused."""
    # Two tetrahedra with a common face; a mid-edge node of that face is pulled through one of them.
    tetrahedron = ELEMENTS["tet10"].nodes
    cells = np.arange(20).reshape(2, 10)
    mirrored = (tetrahedron * [-1.0, 1.0, 1.0])[[0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    nodes = np.vstack([tetrahedron, mirrored])
    nodes[4] += [0.0, 0.4, 0.4]
    new_nodes, count = straightened(nodes, cells)
    assert count == 1
    assert new_nodes[4] == pytest.approx([0.5, 0.0, 0.0], abs=1e-15)
    assert np.array_equal(np.delete(new_nodes, 4, axis=0), np.delete(nodes, 4, axis=0))
    for height, message in ((1e-12, "1 tetrahedron is flat"), (-1.0, "stays inverted")):
        with pytest.raises(ComputationError, match=f"{message}, the first at"):
            straightened(tetrahedron * [1.0, 1.0, height], np.arange(10)[None])


def test_sample_nodes_share_box_volume():
    """Volumes of the sample nodes sum to that of the box, and the nodes reach its ends."""
    box = extrude(section_mesh(Rectangle(0.05, 0.08), 2), np.linspace(0.0, 0.5, 11))
    rows, volumes = spread_over(box)
    assert len(set(rows.tolist())) == len(rows) == len(volumes)
    assert volumes.sum() == pytest.approx(0.5 * 0.05 * 0.08, rel=1e-12)
    assert np.ptp(box.nodes[rows], axis=0) == pytest.approx([0.5, 0.05, 0.08])
    # A few sample nodes, far apart, give the mass centre to a tenth of the length.
    assert volumes @ box.nodes[rows] / volumes.sum() == pytest.approx([0.25, 0.0, 0.0], abs=0.05)
    # A coarse mesh has as many sample nodes as element corners, no more.
    coarse = extrude(section_mesh(Rectangle(0.05, 0.08), 1), np.array([0.0, 0.5]))
    assert len(spread_over(coarse)[0]) == len(
        np.unique(coarse.cells[:, [0, 1, 2, 3, 18, 19, 20, 21]])
    )


def box_tube(occ):
    outer, inner = (occ.addBox(0, -y, -z, 200, 2 * y, 2 * z) for y, z in ((50, 80), (37.5, 67.5)))
    occ.cut([(3, outer)], [(3, inner)])


def with_boss(occ):
    """Draw a plate with a round boss, whose edge is re-entrant and curved, and a bore."""
    plate, boss = occ.addBox(-50, -40, 0, 100, 80, 15), occ.addCylinder(0, 0, 10, 0, 0, 30, 25)
    solid, _ = occ.fuse([(3, plate)], [(3, boss)])
    occ.cut(solid, [(3, occ.addCylinder(0, 0, -10, 0, 0, 60, 12))])


def rounded_corner(occ):
    """Draw an L-shaped plate whose inner corner is an arc without a sharp edge."""
    outline = [(0, 0), (80, 0), (80, 20), (35, 20), (20, 35), (20, 80), (0, 80)]
    points = [occ.addPoint(x, y, 0) for x, y in outline]
    sides = list(zip(points, points[1:] + points[:1], strict=True))
    arc = occ.addCircleArc(points[3], occ.addPoint(35, 35, 0), points[4])
    lines = [arc if side == 3 else occ.addLine(*ends) for side, ends in enumerate(sides)]
    occ.extrude([(2, occ.addPlaneSurface([occ.addCurveLoop(lines)]))], 0, 0, 30)


def mesh_of(folder, build):
    return volume_mesh(read_part(written(folder / "part.step", build)), (), Grading(0.03))


def test_part_without_sharp_inner_edge_is_not_cut(tmp_path):
    """A rounded inner edge is no re-entrant corner."""
    mesh = mesh_of(tmp_path, rounded_corner)
    assert cut_at_inner_edges(mesh) is mesh


@pytest.mark.parametrize("shape", [box_tube, with_boss])
def test_cut_at_reentrant_edge_keeps_part_shape(tmp_path, shape):
    """Elements at inner edges of a box or a boss are divided: mass and faces are unchanged."""
    mesh = mesh_of(tmp_path, shape)
    x, y, z = mesh.nodes[inner_edges(mesh)].T
    assert len(x) >= 12
    across, up = (np.abs(y), 0.0675) if shape is box_tube else (np.hypot(x, y), 0.015)
    assert across == pytest.approx(0.0375 if shape is box_tube else 0.025, abs=1e-9)
    assert np.abs(z) == pytest.approx(up, abs=1e-9)
    cut = cut_at_inner_edges(mesh)
    # Curved elements keep their shape, too: a piece of a quadratic element is quadratic.
    masses = [meshed_part("part", m, STEEL).properties().mass for m in (mesh, cut)]
    assert masses[1] == pytest.approx(masses[0], rel=1e-12)
    assert cell_volumes(cut).min() > 0.0
    # No gap inside: facets that belong to a single element are those on the faces of the part.
    on_faces = np.vstack([facets.corners for facets in cut.faces.values()])
    outside = boundary(cut).corners
    assert np.array_equal(*(np.unique(np.sort(c, axis=1), axis=0) for c in (on_faces, outside)))
    for number, facets in mesh.faces.items():
        area = area_vectors(cut.nodes, cut.faces[number]).sum(axis=0)
        expected = area_vectors(mesh.nodes, facets).sum(axis=0)
        assert area == pytest.approx(expected, abs=2e-3 * 0.1**2)
    corners, numbers = np.unique(mesh.cells[:, :4], return_inverse=True)
    faces = {
        number: Facets(np.searchsorted(corners, facets.corners), "tri3")
        for number, facets in mesh.faces.items()
    }
    straight = PartMesh(mesh.nodes[corners], numbers.reshape(-1, 4), "tet4", faces)
    assert second_order_unknowns(straight, cut=True) == cut.unknowns
    assert second_order_unknowns(straight, cut=False) == mesh.unknowns


@pytest.fixture(scope="module")
def lug(tmp_path_factory):
    return read_here(written(tmp_path_factory.mktemp("parts") / "lug.step", drawn_parts.lug))


def test_faces_are_selected_by_geometry(lug):
    """Two bores by radius and axis, an end by its normal: faces, points and coupling of each."""
    interfaces = {
        "A": PartInterface(ByCylinder(0.008)),
        "C": PartInterface(ByCylinder(0.005, axis=(0.0, 0.0, -2.0)), "average"),
        "end": PartInterface(ByPlane((1.0, 0.0, 0.0), point=(0.2, 0.01, 0.0))),
    }
    first, second, end = find_interfaces(lug, interfaces)
    # The interface point is halfway along the axis of a bore, or in the middle of a plane.
    for interface, x in ((first, 0.02), (second, 0.18), (end, 0.2)):
        assert interface.point == pytest.approx([x, 0.0, 0.0], abs=1e-9)
    assert (first.coupling, second.coupling) == ("rigid", "average")
    assert first.reason.startswith("rigid by default")
    assert end.area == pytest.approx(0.04 * 0.03, rel=1e-9)
    by_number = {"A": PartInterface(ByFaces(first.faces), "pin")}
    assert find_interfaces(lug, by_number)[0].area == pytest.approx(first.area)


def fork(occ):
    """Draw a bar of 200 × 40 × 30 mm with bores of radius 6 mm at x = 100 and 180 mm.

    A slot divides the bore at x = 180 mm.
    """
    bar, slot = occ.addBox(0, -20, -15, 200, 40, 30), occ.addBox(150, -40, -5, 100, 80, 10)
    bores = [occ.addCylinder(x, 0, -30, 0, 0, 60, 6) for x in (100, 180)]
    occ.cut([(3, bar)], [(3, tag) for tag in (*bores, slot)])


@pytest.mark.parametrize("suffix", ["step", "msh"])
def test_equal_bores_are_selected_by_position(suffix, tmp_path):
    """Two bores of one radius, one of them in two halves; selected by a point on the axis."""
    path = tmp_path / f"fork.{suffix}"
    file = meshed(path, fork, 20.0, 12.0) if suffix == "msh" else written(path, fork)
    interfaces = {
        name: PartInterface(ByCylinder(0.006, point=(x, 0.0, 0.0)))
        for name, x in (("whole", 0.1), ("broken", 0.18))
    }
    undivided, divided = find_interfaces(read_here(file, "mm"), interfaces)
    assert (len(undivided.faces), len(divided.faces)) == (1, 2)
    for bore, x, height in ((undivided, 0.1, 0.03), (divided, 0.18, 0.02)):
        assert bore.point == pytest.approx([x, 0.0, 0.0], abs=1e-8)
        # Areas of a mesh are those of plane facets: some twenty per circle, an error of 0.6 %.
        assert bore.area == pytest.approx(2.0 * np.pi * 0.006 * height, rel=1e-2)


END, BORE = ByPlane((1.0, 0.0, 0.0), (0.2, 0.0, 0.0)), ByCylinder(0.008)


@pytest.mark.parametrize(
    ("selection", "message"),
    [
        (ByFaces((99,)), "face 99 does not exist; the part has faces 1 to 8"),
        (ByFaces(()), "no face is given"),
        (ByCylinder(0.009), "no cylinder of radius 0.009 m; the nearest is face"),
        (ByCylinder(0.008, axis=(1.0, 0.0, 0.0)), "of radius 0.008 m, runs along"),
        (ByCylinder(0.008, axis=(0.0, 0.0, 0.0)), "must not be zero"),
        (BORE, "its axis passes 10 mm from (0.03, 0, 0); check the position of the part"),
        (ByPlane((1.0, 1.0, 0.0), (0.0, 0.0, 0.0)), "no plane face has"),
        (ByPlane((1.0, 0.0, 0.0), (0.19, 0.0, 0.0)), "10 mm off"),
        (ByPlane((1.0, 0.0, 0.0)), "a plane needs point"),
        (ByName("bore"), "the file names none"),
    ],
)
def test_wrong_selection_names_nearest_face(lug, selection, message):
    """Number, radius, direction or point that fits no face: the nearest face in one line."""
    points = {"A": np.array([0.03, 0.0, 0.0])} if selection is BORE else {}
    with pytest.raises(InputError) as error:
        find_interfaces(lug, {"A": PartInterface(selection)}, points)
    (line,) = error.value.faults
    assert message in line
    assert "lug.step: interface A: " in line


@pytest.mark.parametrize(
    ("interfaces", "message"),
    [
        ({"A": (BORE, None), "C": (BORE, None)}, "interfaces A and C both take face"),
        (
            {"A": (BORE, None), "C": (ByPlane((0.0, 0.0, 1.0), (0.0, 0.0, 0.015)), None)},
            "A and C share the edge between their faces",
        ),
        ({"A": (END, "pin")}, "is only for a bore"),
        ({}, "no interface is given"),
    ],
)
def test_shared_interface_faces_are_refused(lug, interfaces, message):
    """A face belongs to one interface."""
    with pytest.raises(InputError, match=message):
        find_interfaces(lug, {name: PartInterface(*choice) for name, choice in interfaces.items()})
