"""Meshes that gmsh crashes over, or leaves with elements that are none."""

import numpy as np
import pytest

from lumped.errors import ComputationError
from lumped.mechanism.part import ByPlane, PartInterface
from meshes.own_process import Crashed
from meshes.part import volume
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part


@pytest.fixture
def bar(box_step):
    part = read_part(box_step)
    plane = ByPlane((-1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return part, find_interfaces(part, {"A": PartInterface(plane, "rigid")})


def test_the_optimiser_is_left_out_where_it_crashes(bar, monkeypatch):
    grading = volume.Grading(0.02)
    usual = volume.volume_mesh(*bar, grading)
    tried = []

    def crashing(function, *arguments):
        *_, size, netgen = arguments
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
