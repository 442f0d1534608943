"""Modes of whole mechanisms: solids with free ends and beams of their sections' own constants.

The modal assurance criterion weighs the displacement of points along every leg's axis, and of the
tool, with the mass that is there.
"""

import numpy as np
import pytest

from fem.beams.beam import beam_leg
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from fem.sections.section_constants import beam_properties, section_constants
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.system.assembly import assemble
from lumped.system.solution import modes, solved
from meshes.section.section_mesh import section_mesh
from validation.models.mechanism import dynamic_bodies, highest_frequency
from validation.models.options import ModelOptions

DIVISIONS, COUNT, STATIONS = 2, 6, 6


def beams_of_own_constants(mechanism, highest):
    bodies = {}
    for name, leg in legs_of(mechanism).items():
        material = leg.material
        mesh = section_mesh(leg.section, DIVISIONS)
        constants = section_constants(mesh, material.nu, material.G / material.E)
        held = held_leg(beam_leg(beam_properties(constants, material), leg.length, 20))
        bodies[name] = craig_bampton(held, highest, 4.0 * highest).matrices
    return bodies


def sampled(at, bodies):
    """Frequencies (Hz), and displacements (rows) of the modes times the root of the mass there."""
    system = assemble(at, bodies)
    # Two more than asked for: a double mode may be cut in two.
    found = modes(solved(system), COUNT + 2)
    rows = [np.sqrt(at.mechanism.tool.mass) * (system.tool[:3] @ found.shapes)]
    for name, leg in legs_of(at.mechanism).items():
        x = (np.arange(STATIONS) + 0.5) / STATIONS * leg.length
        moved = bodies[name].displacements(np.column_stack([x, 0.0 * x, 0.0 * x]))
        rows.append(np.sqrt(leg.mass / STATIONS) * (moved @ system.own(name, found.shapes)))
    return found.frequencies, np.vstack(rows)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        *("five-bar", "delta"),
        *(
            pytest.param(n, marks=pytest.mark.exhaustive)
            for n in ("3-rrr", "orthoglide", "hexapod")
        ),
    ],
)
def test_first_six_modes_have_the_beams_shapes(name):
    at = reference_posture(load_robot(name).mechanism)
    highest = 2.0 * highest_frequency([at], COUNT)
    options = ModelOptions(ends="free", divisions=DIVISIONS)
    of_solids, solids = sampled(at, dynamic_bodies("solid", at.mechanism, highest, options))
    of_beams, beams = sampled(at, beams_of_own_constants(at.mechanism, highest))
    mac = np.square(beams.T @ solids) / np.outer(
        np.square(beams).sum(axis=0), np.square(solids).sum(axis=0)
    )
    for mode, frequency in enumerate(of_beams[:COUNT]):
        # Of modes of one frequency, any mixture is as good: their shares add up.
        alike = np.abs(of_solids / frequency - 1.0) < 5e-3
        assert mac[mode, alike].sum() >= 0.99
