"""Meshes that gmsh crashes over, or leaves with elements that are none."""

import numpy as np
import pytest

from lumped.errors import ComputationError, InputError
from lumped.mechanism.part import ByPlane, PartInterface
from meshes.part import volume
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.cad import cad_model, naming_the_place
from meshes.part.reading.read import read_part
from meshes.processes import Crashed


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
    wanted = 20_000
    found = volume.volume_mesh(part, (), volume.ladder(part, (), wanted)[-1])
    assert found.unknowns == pytest.approx(wanted, rel=0.35)
