"""A column of solids that CalculiX buckles and loads behaves as a prestressed beam does."""

import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from fem.beams.prestressed import prestressed_leg
from fem.calculix.deck import deck_text
from fem.calculix.leg import leg_deck
from fem.calculix.run import PROGRAMS, calculix_program
from lumped.arrays import dense
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle
from meshes.prism.tetrahedra import tetrahedra

COLUMN = ConstantLeg(0.8, Rectangle(0.05, 0.06), Material.isotropic(2.1e11, 0.0, 7850.0))
# A quarter of what buckles it.
LOAD = 1.2e5
STEPS = """*STEP
*BUCKLE
2
*CLOAD
{node}, 1, -1.0
*END STEP
*STEP
*STATIC
*CLOAD, OP=NEW
{node}, 1, -{load}
*END STEP
*STEP, PERTURBATION
*FREQUENCY
2
*END STEP
"""


@pytest.mark.skipif(not any(map(shutil.which, PROGRAMS)), reason="CalculiX (ccx) is not installed")
def test_calculix_buckles_and_loads_the_same_column(tmp_path):
    mesh = tetrahedra(COLUMN.section, COLUMN.length, 2)
    deck = replace(leg_deck(mesh, COLUMN.material), load_cases=(), modes=0)
    text = deck_text(deck) + STEPS.format(node=deck.watched[0] + 1, load=LOAD)
    (tmp_path / "column.inp").write_text(text, encoding="ascii")
    subprocess.run(
        [calculix_program(), "-i", "column"], cwd=tmp_path, check=True, capture_output=True
    )
    printed = (tmp_path / "column.dat").read_text(encoding="ascii")
    buckled, _, vibrating = printed.partition("E I G E N V A L U E   O U T P U T")
    factors = [float(x) for x in re.findall(r"^ +\d+ +(\S+E\S+) *$", buckled, re.MULTILINE)]
    squares = [float(x) for x in re.findall(r"^ +\d+ +(\S+E\S+) ", vibrating, re.MULTILINE)]
    p = COLUMN.timoshenko
    leg = prestressed_leg(p, COLUMN.length, 10, 10_000)
    push = np.array([LOAD, 0, 0, 0, 0, 0, -LOAD, 0, 0, 0, 0, 0])
    added = leg.geometric_stiffness(push, np.zeros(12))[6:, 6:]
    stiffness, mass = (dense(m)[6:, 6:] for m in (leg.matrices.stiffness, leg.matrices.mass))
    own = -LOAD / eigh(added, stiffness, eigvals_only=True)[:2]
    assert factors[:2] == pytest.approx(own, rel=3e-3)
    own = eigh(stiffness + added, mass, eigvals_only=True)[:2]
    assert squares[:2] == pytest.approx(own, rel=3e-3)
    unloaded = eigh(stiffness, mass, eigvals_only=True)[:2]
    assert (own < 0.85 * unloaded).all()
