"""Parts: what they weigh, and those that are too large; test_oblique_shaft has their stiffness."""

import numpy as np
import pytest
from drawn_parts import meshed
from prismatic_legs import STEEL

from fem.bodies.part import meshed_part, require_memory
from lumped.errors import ComputationError
from meshes.part.reading.read import read_part


def test_a_bar_has_the_mass_the_centre_and_the_inertia_of_a_box(tmp_path):
    length, b, h = 0.12, 0.04, 0.024
    file = meshed(tmp_path / "bar.msh", lambda kernel: kernel.addBox(0, -20, -12, 120, 40, 24), 20)
    properties = meshed_part(read_part(file, "mm").mesh, STEEL).properties()
    mass = STEEL.rho * length * b * h
    assert properties.mass == pytest.approx(mass, rel=1e-12)
    assert properties.centre == pytest.approx([length / 2.0, 0.0, 0.0], abs=1e-14)
    box = mass / 12.0 * np.diag([b**2 + h**2, length**2 + h**2, length**2 + b**2])
    assert properties.inertia == pytest.approx(box, rel=1e-11, abs=1e-16)


def test_a_mesh_beyond_memory_is_refused_before_it_is_made():
    with pytest.raises(ComputationError, match="ask for fewer unknowns"):
        require_memory(1e9, "leg.step")
