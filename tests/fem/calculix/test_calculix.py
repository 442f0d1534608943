"""Decks for CalculiX, runs of it, and what it prints; numbers are compared elsewhere."""

import os
from dataclasses import replace

import numpy as np
import pytest
from prismatic_legs import STEEL, meshed

from fem.calculix.deck import Deck, ElementSet, Equation, deck_text
from fem.calculix.leg import leg_deck
from fem.calculix.run import (
    CalculixMissing,
    calculix_program,
    first_error,
    read_results,
    run_calculix,
)
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle


@pytest.mark.parametrize(
    ("behaviour", "timeout", "message"),
    [
        ("exec sleep 60", 0.2, "took more than 0.2 s"),
        ("echo Job finished; echo", 60.0, "0 of 1 load cases; its output ends with: Job finished"),
    ],
)
def test_calculix_that_misbehaves(behaviour, timeout, message, tmp_path, monkeypatch):
    program = tmp_path / "ccx"
    program.write_text(f"#!/bin/sh\n{behaviour}\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    with pytest.raises(ComputationError, match=f"printed: .*{message}"):
        run_calculix(PRINTED_DECK, timeout=timeout)


def test_what_calculix_has_not_and_its_absence_are_named(monkeypatch):
    mesh = meshed(ConstantLeg(0.2, Rectangle(0.1, 0.1), STEEL), 1, 2).mesh
    with pytest.raises(InputError, match=r"hex27 .*27 nodes; take tet10"):
        deck_text(leg_deck(mesh, STEEL))
    monkeypatch.setenv("PATH", "")
    with pytest.raises(CalculixMissing, match="calculix-ccx"):
        calculix_program()


def test_deck_of_one_tetrahedron():
    corners = np.vstack([np.zeros(3), np.eye(3)])
    # G twice the isotropic value: as far from isotropy as the robot's equivalent legs.
    cubic = Material(E=7.0e10, G=5.4e10, nu=0.3, rho=2700.0)
    deck = Deck(
        title="*STEP",
        nodes=np.vstack([corners, [1 / 3, 0.0, 0.0]]),
        parts=(ElementSet(np.array([[0, 1, 2, 3]]), "tet4", cubic),),
        equations=(Equation((1, 0), (((4, 0), 0.5), ((4, 2), -0.25))),),
        held=((0, 1),),
        masses=((4, 2.0),),
        load_cases=((((4, 2), 10.0),),),
        watched=(4,),
        modes=3,
    )
    # Keywords and order of data: CalculiX CrunchiX user's manual 2.20, sections of these names.
    # Cubic: C11 = E(1−ν)/(1+ν)(1−2ν) = 9.423…e10 Pa, C12 = 4.038…e10 Pa, C44 = G.
    lines = deck_text(deck).splitlines()
    for block in (
        ["*HEADING", "deck of *STEP", "*NODE, NSET=ALL"],
        ["5, 0.3333333333333333, 0.0, 0.0", "*ELEMENT, TYPE=C3D4, ELSET=PART1", "1, 1, 2, 3, 4"],
        ["*ELEMENT, TYPE=MASS, ELSET=MASS1", "2, 5", "*MASS, ELSET=MASS1", "2.0"],
        ["*EQUATION", "3", "2, 1, 1.0, 5, 1, -0.5, 5, 3, 0.25"],
        ["*BOUNDARY", "1, 2", "*NSET, NSET=WATCHED", "5,"],
        ["*STEP", "*STATIC", "*CLOAD, OP=NEW", "5, 3, 10.0", "*NODE PRINT, NSET=WATCHED", "U"],
        ["*FREQUENCY", "3", "*END STEP"],
    ):
        start = lines.index(block[0])
        assert lines[start : start + len(block)] == block
    elastic = lines.index("*ELASTIC, TYPE=ORTHO")
    constants = [float(c) for c in ",".join(lines[elastic + 1 : elastic + 3]).split(",")]
    c11, c12 = 9.423076923e10, 4.038461538e10
    expected = [c11, c12, c11, c12, c12, c11, 5.4e10, 5.4e10, 5.4e10]
    assert constants == pytest.approx(expected, rel=1e-9)


PRINTED_RESULTS = """
 displacements (vx,vy,vz) for set WATCHED and time  0.1000000E+01

         8  4.528490E-14  1.072606-103 -2.378973E-13
         7  1.561671E-10 -1.184426E-13 -2.042256E-14

     E I G E N V A L U E   O U T P U T

 MODE NO    EIGENVALUE                       FREQUENCY

      1   0.4000000E+07   0.2000000E+04   0.3183099E+03   0.0000000E+00

     P A R T I C I P A T I O N   F A C T O R S

      1   0.1000000E+01   0.1000000E+01   0.1000000E+01   0.1000000E+01
"""
PRINTED_DECK = Deck("printed", np.zeros((8, 3)), (), load_cases=((),), watched=(6, 7), modes=1)


def test_printed_results_are_read_by_node_and_mode():
    results = read_results(PRINTED_RESULTS, PRINTED_DECK)
    assert results.displacements[0].tolist() == [
        [1.561671e-10, -1.184426e-13, -2.042256e-14],
        [4.528490e-14, 1.072606e-103, -2.378973e-13],
    ]
    # √4e6 / 2π
    assert results.frequencies.tolist() == pytest.approx([1000.0 / np.pi], rel=1e-15)
    for deck, text, message in (
        (replace(PRINTED_DECK, modes=2), PRINTED_RESULTS, "1 of 2 frequencies"),
        (PRINTED_DECK, "", "0 of 1 load cases"),
        (replace(PRINTED_DECK, watched=(1,)), PRINTED_RESULTS, "not finite"),
        (PRINTED_DECK, PRINTED_RESULTS.replace(" 0.4000", "-0.4000"), "not finite"),
    ):
        with pytest.raises(ComputationError, match=rf"printed: .*{message}"):
            read_results(text, deck)
    said = "header\n *ERROR reading *EQUATION:\n        node number is too large\n\n *ERROR later\n"
    assert first_error(said) == "*ERROR reading *EQUATION: node number is too large"
    assert first_error("Job finished\n") is None
