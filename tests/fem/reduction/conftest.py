"""A square bar as a part: held in several ways, with its matrices dense."""

from dataclasses import dataclass

import numpy as np
import pytest
from drawn_parts import meshed
from prismatic_legs import STEEL
from scipy.linalg import eigh, null_space

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.bodies.rooted import RootedBody
from fem.reduction.held import Held, held_body
from lumped.mechanism.part import ByPlane, PartInterface
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part

LENGTH = 0.2
COUPLINGS = {"two": ("rigid", "average"), "one": ("average",)}


@dataclass(frozen=True)
class Bar:
    """A square bar and its interfaces at its ends."""

    rooted: RootedBody
    held: Held

    def frequencies(self, fixed):
        """All frequencies (Hz) with the first `fixed` components of the interfaces' twists held.

        Dense, by no code of the reduction's.
        """
        solid = self.rooted.solid
        free = null_space(solid.twists[:, :fixed].T) if fixed else np.eye(solid.size)
        stiffness, mass = (free.T @ (matrix @ free) for matrix in (solid.stiffness, solid.mass))
        squared = eigh(stiffness, mass, eigvals_only=True)
        return np.sqrt(np.maximum(squared, 0.0)) / (2.0 * np.pi)


@pytest.fixture(scope="session", params=COUPLINGS.values(), ids=COUPLINGS)
def bar(request, tmp_path_factory):
    """Its bending modes come in pairs, alike but for the mesh."""
    folder = tmp_path_factory.mktemp("bar")
    drawn = meshed(
        folder / "bar.msh",
        lambda kernel: kernel.addBox(0.0, -15.0, -15.0, 200.0, 30.0, 30.0),
        80.0,
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
    rooted = held_part(meshed_part(part.mesh, STEEL), grips, "bar")
    return Bar(rooted, held_body(rooted))


@pytest.fixture(scope="session")
def held_frequencies(bar):
    """All that moves with the twists of all interfaces held (Hz)."""
    return bar.frequencies(bar.rooted.solid.twists.shape[1])
