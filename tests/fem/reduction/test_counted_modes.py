"""Modes of a part with its interfaces held, counted: against all of them dense, and one missing."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh, null_space

import fem.reduction.counted_modes as counting
from fem.bodies.part import grips_of, held_part, meshed_part
from fem.reduction.counted_modes import counted_modes
from fem.reduction.craig_bampton import reduction
from fem.reduction.held import HeldBody
from fem.reduction.interface_modes import interface_modes
from lumped.dense.modes import Modes
from lumped.errors import ComputationError
from lumped.legs import Material
from lumped.mechanism.part import ByPlane, PartInterface
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from validation.cases.program.parts.drawing import meshed
from validation.faults.catalogue import FAULTS

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
LENGTH, SIDE = 0.2, 0.03
COUPLINGS = {"rigid": ("rigid", "rigid"), "averaged": ("rigid", "average"), "one": ("average",)}


@dataclass(frozen=True)
class Bar:
    """A square bar held at its ends, and all its frequencies (Hz) then."""

    held: HeldBody
    frequencies: np.ndarray


@pytest.fixture(scope="module", params=COUPLINGS.values(), ids=COUPLINGS)
def bar(request, tmp_path_factory):
    """Its bending modes come in pairs, alike but for the mesh."""
    folder = tmp_path_factory.mktemp("bar")
    drawn = meshed(
        folder / "bar.msh",
        lambda kernel: kernel.addBox(0.0, -15.0, -15.0, 200.0, 30.0, 30.0),
        30.0,
        4.0,
    )
    part = read_part(drawn, "mm")
    ends = {
        name: PartInterface(ByPlane((way, 0.0, 0.0), (x, 0.0, 0.0)), coupling)
        for (name, way, x), coupling in zip(
            (("A", -1.0, 0.0), ("B", 1.0, LENGTH)), request.param, strict=False
        )
    }
    grips = grips_of(part.mesh, find_interfaces(part, ends))
    held = HeldBody(held_part(meshed_part(part.mesh, STEEL), grips, "bar"))
    # All that moves with the twists held, by no code of the reduction's.
    solid = held.rooted.solid
    free = null_space(solid.twists.T)
    stiffness, mass = (free.T @ (matrix @ free) for matrix in (solid.stiffness, solid.mass))
    squared = eigh(stiffness, mass, eigvals_only=True)
    return Bar(held, np.sqrt(squared) / (2.0 * np.pi))


def test_inertia_counts_what_a_dense_eigensolver_finds(bar):
    assert bar.held.size > 400
    for below in (0, 1, 2, 5, 12, 40):
        lowest, next_one = np.append(0.0, bar.frequencies)[[below, below + 1]]
        if next_one < 1.001 * lowest:
            continue
        found = bar.held.inertia((np.pi * (lowest + next_one)) ** 2)
        assert (found.negative, found.zero) == (below, 0)


def test_a_reduction_has_the_modes_that_are_counted(bar):
    cutoff = 1.001 * bar.frequencies[14]
    found = reduction(bar.held, 0.4 * cutoff, cutoff)
    below = bar.frequencies[bar.frequencies < found.cutoff]
    assert found.counted == len(below) >= 15
    assert_allclose(found.frequencies[: len(below)], below, rtol=1e-8)


@pytest.mark.parametrize("missed", [0, 3, 7])
def test_a_mode_that_the_search_missed_is_counted_and_searched_for(bar, missed, monkeypatch):
    cutoff = 1.001 * bar.frequencies[9]

    def blind(held, cutoff, search=0):
        found = interface_modes(held, cutoff, search)
        if search:
            return found
        kept = np.arange(len(found.frequencies)) != missed
        return Modes(found.frequencies[kept], found.shapes[:, kept])

    sound = counted_modes(bar.held, cutoff)
    monkeypatch.setattr(counting, "interface_modes", blind)
    found = counted_modes(bar.held, cutoff)
    assert found.counted == sound.counted
    assert_allclose(found.frequencies, sound.frequencies, rtol=1e-9)
    gram = found.shapes.T @ (bar.held.mass @ found.shapes)
    assert_allclose(gram, np.eye(len(gram)), atol=1e-8)


def test_a_mode_that_is_never_found_or_found_twice_is_an_error(bar, monkeypatch):
    cutoff = 1.001 * bar.frequencies[9]

    def without_the_first(held, cutoff, search=0):
        found = interface_modes(held, cutoff, search)
        return Modes(found.frequencies[1:], found.shapes[:, 1:])

    monkeypatch.setattr(counting, "interface_modes", without_the_first)
    with pytest.raises(ComputationError, match="bar, all interfaces held: certificate"):
        counted_modes(bar.held, cutoff)

    def first_twice(held, cutoff, search=0):
        found = interface_modes(held, cutoff, search)
        twice = np.r_[0, 0 : len(found.frequencies)]
        return Modes(found.frequencies[twice], found.shapes[:, twice])

    monkeypatch.setattr(counting, "interface_modes", first_twice)
    with pytest.raises(ComputationError, match="certificate of the modes failed"):
        counted_modes(bar.held, cutoff)


@pytest.mark.parametrize("fault", ["reduction.cutoff", "reduction.modes-missing"])
def test_faults_of_the_search_are_errors_of_the_reduction(bar, fault):
    cutoff = 1.001 * bar.frequencies[9]
    (mistake,) = (one for one in FAULTS if one.id == fault)
    with mistake.inject(), pytest.raises(ComputationError, match="certificate of the modes failed"):
        reduction(bar.held, 0.4 * cutoff, cutoff)
