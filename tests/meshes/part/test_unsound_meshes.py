"""Meshes that gmsh crashes over, or leaves with elements that are none."""

import numpy as np
import pytest

from lumped.errors import ComputationError, InputError
from lumped.mechanism.part import ByPlane, PartInterface
from meshes.own_process import Crashed
from meshes.part import volume
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.cad import cad_model, naming_the_place
from meshes.part.reading.read import read_part
from meshes.part.spread import cell_volumes


@pytest.fixture(scope="module")
def bar(box_step):
    part = read_part(box_step)
    plane = ByPlane((-1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return part, find_interfaces(part, {"A": PartInterface(plane, "rigid")})


def test_the_optimiser_is_left_out_where_it_crashes(bar, monkeypatch):
    grading = volume.Grading(0.02)
    usual = volume.volume_mesh(*bar, grading)
    tried = []

    def crashing(function, *arguments):
        *_, size, netgen, _ = arguments
        tried.append((size.size, netgen))
        if netgen:
            raise Crashed
        return function(*arguments)

    monkeypatch.setattr(volume, "in_own_process", crashing)
    plain = volume.volume_mesh(*bar, grading)
    assert tried == [(0.02, 1), (0.97 * 0.02, 1), (0.02, 0)]
    # Another mesh of the same block, which is as long.
    assert np.ptp(plain.nodes, axis=0) == pytest.approx(np.ptp(usual.nodes, axis=0))
    assert len(plain.nodes) != len(usual.nodes) or np.abs(plain.nodes - usual.nodes).max() > 1e-6


@pytest.mark.parametrize(
    ("error", "said"),
    [(Crashed(), "it ends its process"), (ComputationError("2 tetrahedra are flat"), "2 tetra")],
)
def test_what_has_no_sound_mesh_is_said(bar, monkeypatch, error, said):
    def failing(*_):
        raise error

    monkeypatch.setattr(volume, "in_own_process", failing)
    with pytest.raises(ComputationError, match=rf"box.step: gmsh makes no sound .* m: {said}"):
        volume.volume_mesh(*bar, volume.Grading(0.02))


def tube(occ, s):
    """A tapered tube, 898 mm long, whose wall of 12 mm falls between facets of half its length."""
    outer, inner = (
        (3, occ.addCone(0.0, 0.0, 0.0, 898.0 * s, 0.0, 0.0, r * s, 0.6 * r * s))
        for r in (61.4, 49.3)
    )
    occ.cut([outer], [inner])


def test_the_search_for_a_size_goes_on_after_a_surface_that_crosses_itself(part_file):
    part = read_part(part_file("tube.step", tube))
    with cad_model(part.path, part.unit) as model:
        volume._set_sizes(model, (), volume.Grading(max(part.extent) / 2.0).refined())
        with pytest.raises(InputError, match="crosses itself"), naming_the_place(part.path, model):
            model.gmsh.model.mesh.generate(3)
    wanted = 40_000
    found = volume.volume_mesh(part, (), volume.ladder(part, (), wanted)[-1])
    assert found.unknowns == pytest.approx(wanted, rel=0.35)


def box_beam(occ, s):
    """A tapered box beam, 627 mm long, whose walls of 11 mm are a sixth as thick as elements."""

    def loft(y, z):
        wires = []
        for x, (a, b) in ((0.0, (1.0, 1.0)), (627.0 * s, (0.52, 0.74))):
            places = [(-y * a, -z * b), (y * a, -z * b), (y * a, z * b), (-y * a, z * b)]
            points = [occ.addPoint(x, u * s, v * s) for u, v in places]
            lines = [occ.addLine(points[i - 1], points[i]) for i in range(4)]
            wires.append(occ.addWire(lines))
        return next(one for one in occ.addThruSections(wires, makeRuled=True) if one[0] == 3)

    occ.cut([loft(33.5, 53.0)], [loft(22.5, 42.0)])


@pytest.mark.exhaustive
def test_elements_much_longer_than_walls_are_thick_are_sound(part_file):
    part = read_part(part_file("box_beam.step", box_beam))
    ends = {
        name: PartInterface(ByPlane((way, 0.0, 0.0), (x, 0.0, 0.0)), "average")
        for name, way, x in (("A", -1.0, 0.0), ("B", 1.0, 0.627))
    }
    mesh = volume.volume_mesh(part, find_interfaces(part, ends), volume.Grading(0.07))
    assert mesh.unknowns < 6000
    # Flat faces: every element has a volume of its own, and all of them the part's.
    volumes = cell_volumes(mesh)
    assert volumes.min() > 1e-5 * volumes.mean()
    assert volumes.sum() == pytest.approx(part.exact.volume, rel=1e-12)
