"""Reduction of a square bar with one or two interfaces, held or free, against dense solutions."""

from dataclasses import dataclass, replace
from functools import cached_property
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh, null_space
from scipy.sparse import eye_array
from support.robots.drawn_parts import meshed, plane_ends, read_here
from support.robots.paper_legs import STEEL

import fem.reduction.counted_modes as counting
from fem.bodies.part import MeshedPart, grips_of, held_part, meshed_part, require_memory
from fem.bodies.rooted import RootedBody
from fem.reduction.counted_modes import counted_modes, interface_modes
from fem.reduction.craig_bampton import reduction
from fem.reduction.free_interface import free_interface
from fem.reduction.held import Held, VibratingBody, free_body, held_body
from lumped.dense.modes import Modes
from lumped.errors import ComputationError, InputError
from meshes.part.boundary import Facets
from meshes.part.interfaces import Interface, find_interfaces

LENGTH, SIDE = 0.14, 0.03
COUPLINGS = {"two": {"A": "rigid", "B": "average"}, "one": {"A": "average"}}


@dataclass(frozen=True)
class Bar:
    """A square bar with interfaces at its ends, as a part and as reduced bodies."""

    part: MeshedPart
    rooted: RootedBody
    held: Held

    def frequencies(self, fixed):
        """Return all frequencies (Hz) with the first `fixed` components of interface twists held.

        The dense solution uses no code of the reduction.
        """
        solid = self.rooted.solid
        free = null_space(solid.twists[:, :fixed].T) if fixed else np.eye(solid.size)
        stiffness, mass = (free.T @ (matrix @ free) for matrix in (solid.stiffness, solid.mass))
        squared = eigh(stiffness, mass, eigvals_only=True)
        return np.sqrt(np.maximum(squared, 0.0)) / (2.0 * np.pi)

    @cached_property
    def held_frequencies(self):
        return self.frequencies(self.rooted.solid.twists.shape[1])

    @cached_property
    def free_frequencies(self):
        """Return the frequencies (Hz) of the free bar, without its rigid-body motions."""
        return self.frequencies(0)[6:]

    @property
    def cutoff(self):
        return 1.001 * self.free_frequencies[6]


@pytest.fixture(scope="module", params=COUPLINGS.values(), ids=COUPLINGS)
def bar(request, tmp_path_factory):
    """Return the bar; its bending modes come in pairs that differ only by the mesh."""
    path = tmp_path_factory.mktemp("bar") / "bar.msh"
    meshed(path, lambda kernel: kernel.addBox(0.0, -15.0, -15.0, 140.0, 30.0, 30.0), 80.0)
    file, planes = read_here(path, "mm"), plane_ends(LENGTH)
    couplings = request.param.items()
    ends = {name: replace(planes[name], coupling=coupling) for name, coupling in couplings}
    part = meshed_part("bar", file.mesh, STEEL)
    rooted = held_part(part, grips_of(file.mesh, find_interfaces(file, ends)))
    return Bar(part, rooted, held_body(rooted))


def test_interface_couples_all_its_faces():
    """An interface of faces 1 and 2 contains the element faces of both."""
    faces = {number: Facets(np.array([[number, 8, 9]]), "tri3") for number in (1, 2, 3, 4)}
    interfaces = [
        Interface(name, numbers, np.eye(3)[index], "rigid", "", None, None, 1.0)
        for index, (name, numbers) in enumerate({"A": (1, 2), "B": (3,), "C": (4,)}.items())
    ]
    grips = grips_of(SimpleNamespace(faces=faces), interfaces)
    assert [grip.facets.cells[:, 0].tolist() for grip in grips] == [[1, 2], [3], [4]]


def test_box_has_exact_mass_properties(bar):
    """m = ρLa², centre at L/2, moments m(a² + b²)/12 of a square bar."""
    properties = bar.part.properties()
    mass = STEEL.rho * LENGTH * SIDE**2
    assert properties.mass == pytest.approx(mass, rel=1e-12)
    assert properties.centre == pytest.approx([LENGTH / 2.0, 0.0, 0.0], abs=1e-14)
    box = mass / 12.0 * np.diag([2.0 * SIDE**2, LENGTH**2 + SIDE**2, LENGTH**2 + SIDE**2])
    assert properties.inertia == pytest.approx(box, rel=1e-11, abs=1e-16)
    with pytest.raises(ComputationError, match="choose fewer unknowns"):
        require_memory(1e9, "leg.step")


@pytest.mark.parametrize("free", [False, True])
def test_mode_count_equals_dense_count(bar, free):
    """Bar with fixed interfaces, and free bar without its rigid-body motions."""
    body = free_body(bar.rooted) if free else bar.held
    frequencies = bar.free_frequencies if free else bar.held_frequencies
    # Bodies with fewer unknowns are solved by a dense method instead of being counted.
    assert body.size > counting._DENSE_SIZE
    if free:
        assert body.rigid.T @ (body.mass @ body.rigid) == pytest.approx(np.eye(6), abs=1e-10)
    for below in (0, 1, 2, 5, 12, 40):
        lowest, next_one = np.append(0.0, frequencies)[[below, below + 1]]
        if next_one > 1.001 * lowest:
            count = body.inertia((np.pi * (lowest + next_one)) ** 2)
            assert (count.negative, count.zero) == (below, 0)


def test_reduction_modes_equal_dense_modes(bar):
    """Modes with all interfaces fixed, below a cut-off, against dense eigenvalues."""
    held_frequencies = bar.held_frequencies
    cutoff = 1.001 * held_frequencies[14]
    reduced = reduction(bar.held, 0.4 * cutoff, cutoff)
    below = held_frequencies[held_frequencies < reduced.cutoff]
    assert reduced.counted == len(below) >= 15
    assert_allclose(reduced.frequencies[: len(below)], below, rtol=1e-8)
    # Two thirds of all modes are more than the Lanczos method may search for.
    largest_count = 2 * bar.held.size // 3
    every = interface_modes(bar.held, held_frequencies[largest_count : largest_count + 2].mean())
    assert_allclose(every.frequencies, held_frequencies[: largest_count + 1], rtol=1e-8)
    assert_allclose(
        every.shapes.T @ (bar.held.mass @ every.shapes), np.eye(largest_count + 1), atol=1e-8
    )


@pytest.mark.parametrize("rounding", [0.0, 1e-26, -1e-26])
def test_clamped_body_has_no_rounding_mode(rounding):
    """Ten masses on springs and a fixed unknown, from which a mode at 1e-116 Hz once resulted."""
    squared = np.arange(1.0, 11.0) ** 2 * 1e6
    flexibility = np.diag(np.append(1.0 / squared, rounding))
    flexibility[0, 10] = flexibility[10, 0] = abs(rounding)
    body = VibratingBody(
        state="held", flexibility=flexibility.__matmul__, mass=eye_array(11).tocsr()
    )
    modes = interface_modes(body, 1e4)
    assert_allclose(modes.frequencies, np.sqrt(squared) / (2.0 * np.pi), rtol=1e-12)


def search_returning(rows, searches):
    """Return a mode search that returns only the modes `rows` in its first `searches` calls."""

    def blind(body, cutoff, search=0):
        modes = interface_modes(body, cutoff, search)
        rows_of_modes = rows(len(modes.frequencies)) if search < searches else slice(None)
        return Modes(modes.frequencies[rows_of_modes], modes.shapes[:, rows_of_modes])

    return blind


def test_missed_body_mode_is_reported(bar, monkeypatch):
    """A mode that the first search misses is found by the next; otherwise the part is refused."""
    cutoff = 1.001 * bar.held_frequencies[9]
    for missed in (0, 7):
        blind = search_returning(
            lambda count, missed=missed: np.delete(np.arange(count), missed), 1
        )
        monkeypatch.setattr(counting, "interface_modes", blind)
        modes = counted_modes(bar.held, cutoff)
        below = bar.held_frequencies[bar.held_frequencies < cutoff]
        assert modes.counted == len(below)
        assert_allclose(modes.frequencies, below, rtol=1e-8)
        gram = modes.shapes.T @ (bar.held.mass @ modes.shapes)
        assert_allclose(gram, np.eye(len(gram)), atol=1e-8)
    # Searches that never find the first mode, or find it twice.
    for rows in (lambda count: np.arange(1, count), lambda count: np.r_[0, 0:count]):
        monkeypatch.setattr(counting, "interface_modes", search_returning(rows, 9))
        with pytest.raises(
            ComputationError, match="bar, all interfaces held: wrong number of modes"
        ):
            counted_modes(bar.held, cutoff)


CLAMPED, COUNT = 6, 6


@pytest.fixture(scope="module")
def free_reduction(bar):
    return free_interface(bar.rooted, bar.cutoff / 2.5, bar.cutoff)


def test_free_interface_statics_are_exact(bar, free_reduction):
    """Matrices against dense triple products; the first unknowns are the interface twists."""
    reduced, _ = free_reduction
    assert reduced.counted == len(reduced.frequencies) == 7
    assert_allclose(reduced.frequencies, bar.free_frequencies[:7], rtol=1e-8)
    squared = eigh(reduced.stiffness, reduced.mass, eigvals_only=True)[6:]
    assert_allclose(np.sqrt(squared[:7]) / (2.0 * np.pi), bar.free_frequencies[:7], rtol=1e-8)
    solid, V = bar.rooted.solid, reduced.recovery
    for full, small in ((solid.stiffness, reduced.stiffness), (solid.mass, reduced.mass)):
        assert V.T @ (full @ V) == pytest.approx(small, abs=1e-10 * np.abs(small).max())
    twists = solid.twists.T @ V
    # The rounding error of the solid's solution is 1.5e-11.
    assert twists == pytest.approx(np.eye(*twists.shape), abs=1e-9)
    count = len(twists)
    assert reduced.stiffness[:count, :count] == pytest.approx(bar.held.stiffness)
    assert not reduced.stiffness[:count, count:].any()


def clamped(stiffness, mass):
    """Return the frequencies (Hz) with the first interface held; massless unknowns have none."""
    free = slice(CLAMPED, None)
    inverse_squares = eigh(mass[free, free], stiffness[free, free], eigvals_only=True)[::-1]
    with_mass = inverse_squares[inverse_squares > 1e-12 * inverse_squares[0]]
    return 1.0 / (2.0 * np.pi * np.sqrt(with_mass))


def test_free_interface_modes_bound_clamped_ones(bar, free_reduction):
    """With one interface clamped, the reduction gives upper and lower bounds of frequencies."""
    exact = bar.frequencies(CLAMPED)[:COUNT]
    reduced, truncation = free_reduction
    assert exact[-1] < bar.cutoff
    upper = clamped(reduced.stiffness, reduced.mass)[:COUNT]
    fixed = reduction(bar.held, bar.cutoff / 2.5, bar.cutoff)
    assert (upper >= exact * (1.0 - 1e-9)).all()
    # Observed errors: 3e-8 for the first two modes, 1e-4 for a mode just below the cut-off.
    assert_allclose(upper, exact, rtol=2e-4)
    assert_allclose(upper[:2], clamped(fixed.stiffness, fixed.mass)[:2], rtol=1e-7)
    looser = [truncation.loosened((2.0 * np.pi * frequency) ** 2) for frequency in upper]
    lower = np.array([clamped(*matrices)[j] for j, matrices in enumerate(looser)])
    assert (lower <= exact * (1.0 + 1e-9)).all()
    # The bounds are useful: at most ten times as wide as the error.
    assert (upper - lower <= 10.0 * (upper - exact) + 1e-8 * exact).all()


def test_cut_off_above_all_modes_is_refused(bar):
    """Free interfaces need omitted modes. The cut-off must exceed the requested frequency."""
    if len(bar.rooted.solid.points) == 1:
        with pytest.raises(ComputationError, match=r"bar, free: modes up to .* contain all of the"):
            free_interface(bar.rooted, 1e8, 1e9)
    with pytest.raises(InputError, match="must be above the highest requested frequency"):
        free_interface(bar.rooted, 1000.0, 900.0)
