"""A force that swings at the tip of a clamped leg, held against CalculiX on the same mesh."""

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from prismatic_legs import STEEL

from fem.bodies.solid import solid_leg, solid_leg_matrices
from fem.calculix import run as calculix_run
from fem.calculix.deck import deck_text
from fem.calculix.leg import leg_deck, mass_at_stiffness_points
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.legs import ConstantLeg
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.sections import Rectangle
from lumped.system.assembly import assemble
from lumped.system.response import damped_modes
from lumped.system.solution import solved
from meshes.prism.tetrahedra import tetrahedra
from validation.adequacy.robot import leg_alone

RATIO, MODES, FIRST, LAST = 0.02, 40, 50.0, 1500.0
SECTION, LENGTH = Rectangle(0.04, 0.06), 0.5


def by_calculix(text: str, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (Hz) and receptances (complex, m/N) of the tip along y, from modes alone.

    Printed are real parts, then imaginary ones, frequency by frequency, between resonances and at
    them.
    """
    tip = int(re.search(r"NSET=WATCHED\n(\d+)", text)[1])
    text = text.replace("*FREQUENCY\n", "*FREQUENCY, STORAGE=YES\n")
    text += (
        f"*STEP\n*STEADY STATE DYNAMICS\n{FIRST}, {LAST}, 10\n*MODAL DAMPING\n1, {MODES}, {RATIO}"
    )
    text += f"\n*CLOAD\n{tip}, 2, 1.0\n*NODE PRINT, NSET=WATCHED\nU\n*END STEP\n"
    (folder / "deck.inp").write_text(text, encoding="ascii")
    program = [calculix_run.calculix_program(), "-i", "deck"]
    subprocess.run(program, cwd=folder, check=True, capture_output=True)
    printed = (folder / "deck.dat").read_text(encoding="ascii")
    rows = re.findall(rf"and time +(\S+)\n\n +{tip} +\S+ +(\S+) ", printed)
    numbers = np.array(rows, dtype=float).reshape(-1, 2, 2)
    return numbers[:, 0, 0], numbers[:, 0, 1] + 1j * numbers[:, 1, 1]


@pytest.mark.skipif(
    not any(map(shutil.which, calculix_run.PROGRAMS)), reason="CalculiX (ccx) is not installed"
)
def test_a_damped_leg_swings_as_calculix_says(tmp_path):
    """What forty modes of CalculiX leave out stands still, and is too small to be seen at peaks."""
    leg = ConstantLeg(LENGTH, SECTION, STEEL)
    solid = solid_leg(leg, tetrahedra(SECTION, LENGTH, 1))
    solid = replace(solid, mass=mass_at_stiffness_points(solid.mesh, STEEL.rho))
    deck = replace(leg_deck(solid.mesh, STEEL, MODES), load_cases=())
    frequencies, theirs = by_calculix(deck_text(deck), tmp_path)
    assert len(frequencies) > 40
    reduced = craig_bampton(held_leg(solid_leg_matrices(solid)), LAST, 6.0 * LAST).matrices
    alone = replace(leg_alone("leg", leg), damping=RATIO)
    found = damped_modes(solved(assemble(reference_posture(alone), {"leg": reduced})), LAST)
    own = found.along(np.array([0.0, 1.0, 0.0])).receptance(frequencies)
    assert np.abs(theirs).max() > 10.0 * np.abs(theirs[0])
    apart = own - theirs
    left_out = apart[0].real
    assert 0.0 < left_out < 1e-4 * theirs[0].real
    # Seven digits of a frequency are 1e-5 of the answer beside a resonance.
    sizes = np.maximum(np.abs(theirs), np.abs(theirs[0]))
    assert (np.abs(apart - left_out) < 3e-5 * sizes).all()
