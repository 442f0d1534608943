"""Decks for CalculiX and its results; solid legs and mechanisms compared with CalculiX."""

import os
import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from support.oracles.compliance_difference import scaled_difference
from support.robots.paper_legs import STEEL, meshed

from fem.bodies.solid import solid_leg, solid_leg_matrices
from fem.calculix.deck import Deck, ElementSet, Equation, deck_text
from fem.calculix.leg import leg_deck, mass_at_stiffness_points
from fem.calculix.mechanism import compliance_and_frequencies
from fem.calculix.run import (
    PROGRAMS,
    CalculixMissing,
    calculix_program,
    first_error,
    read_results,
    run_calculix,
)
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.body import Rigid
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.placing import clamped_leg
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from lumped.system.assembly import assemble
from lumped.system.response import damped_modes
from lumped.system.solution import compliance, modes, solved
from meshes.prism import tetrahedra


@pytest.mark.parametrize(
    ("behaviour", "timeout", "message"),
    [
        ("exec sleep 60", 0.2, "took more than 0.2 s"),
        ("echo Job finished; echo", 60.0, "0 of 1 load cases; its output ends with: Job finished"),
    ],
)
def test_calculix_failure_is_reported(behaviour, timeout, message, tmp_path, monkeypatch):
    """A program that hangs, or that prints no results: message with the title of the deck."""
    program = tmp_path / "ccx"
    program.write_text(f"#!/bin/sh\n{behaviour}\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    with pytest.raises(ComputationError, match=f"printed: .*{message}"):
        run_calculix(PRINTED_DECK, timeout=timeout)


def test_missing_calculix_is_reported(monkeypatch):
    """The message names the package. Elements of 27 nodes, which CalculiX lacks, are refused."""
    mesh = meshed(ConstantLeg(0.2, Rectangle(0.1, 0.1), STEEL), 1, 2).mesh
    with pytest.raises(InputError, match=r"hex27 .*27 nodes; take tet10"):
        deck_text(leg_deck(mesh, STEEL))
    monkeypatch.setenv("PATH", "")
    with pytest.raises(CalculixMissing, match="calculix-ccx"):
        calculix_program()


def test_one_tetrahedron_deck_is_valid():
    """All cards of the deck, with an equation, a mass, a load and a request for modes."""
    corners = np.vstack([np.zeros(3), np.eye(3)])
    # G is twice the isotropic value, like that of the paper's equivalent legs.
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
    # Keywords and order of data follow the CalculiX CrunchiX user's manual 2.20. Elastic constants
    # of the cubic material: C11 = E(1−ν)/(1+ν)(1−2ν) = 9.423…e10 Pa, C12 = 4.038…e10 Pa, C44 = G.
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


def test_calculix_results_are_read():
    """Displacements and frequencies of a printed file; incomplete or negative ones are refused."""
    results = read_results(PRINTED_RESULTS, PRINTED_DECK)
    assert results.displacements[0].tolist() == [
        [1.561671e-10, -1.184426e-13, -2.042256e-14],
        [4.528490e-14, 1.072606e-103, -2.378973e-13],
    ]
    # f = √(4e6 s⁻²)/2π.
    assert results.frequencies.tolist() == pytest.approx([1000.0 / np.pi], rel=1e-15)
    for deck, text, message in (
        (replace(PRINTED_DECK, modes=2), PRINTED_RESULTS, "1 of 2 frequencies"),
        (PRINTED_DECK, "", "0 of 1 load cases"),
        (replace(PRINTED_DECK, watched=(1,)), PRINTED_RESULTS, "not finite"),
        (PRINTED_DECK, PRINTED_RESULTS.replace(" 0.4000", "-0.4000"), "not finite"),
    ):
        with pytest.raises(ComputationError, match=rf"printed: .*{message}"):
            read_results(text, deck)
    output = (
        "header\n *ERROR reading *EQUATION:\n        node number is too large\n\n *ERROR later\n"
    )
    assert first_error(output) == "*ERROR reading *EQUATION: node number is too large"
    assert first_error("Job finished\n") is None


needs_calculix = pytest.mark.skipif(
    not any(map(shutil.which, PROGRAMS)), reason="CalculiX (ccx) is not installed"
)
# CalculiX prints seven digits; the modal truncation of the reduced legs, at four times the tenth
# frequency, has a smaller error.
PRINTED = 1e-6
# Sides (m) of solid square sections by robot and leg. Both programs use the same coarse meshes.
SECTIONS = {"five-bar": {"": 0.09}, "delta": {"arm": 0.06, "rod": 0.04}}


def of_squares(name):
    """Return the built-in mechanism with legs of square sections and of a cubic material."""
    mechanism = load_robot(name).mechanism
    bodies = dict(mechanism.bodies)
    for body in mechanism.bodies.values():
        for start, side in SECTIONS[name].items():
            if isinstance(body.shape, ConstantLeg) and body.name.startswith(start):
                cubic = replace(body.shape.material, G=1.2 * body.shape.material.G)
                shape = replace(body.shape, section=Rectangle(side, side), material=cubic)
                bodies[body.name] = replace(body, shape=shape)
    return replace(mechanism, bodies=bodies)


def solid_and_reduced(leg, highest, cutoff):
    """Return a tetrahedral leg with CalculiX's mass integration, and its reduced matrices."""
    solid = solid_leg(leg, tetrahedra(leg.section, leg.length, 1))
    solid = replace(solid, mass=mass_at_stiffness_points(solid.mesh, leg.material.rho))
    return solid, craig_bampton(held_leg(solid_leg_matrices(solid)), highest, cutoff).matrices


def solid_legs(mechanism):
    """Return solids and reduced matrices of all legs by body; equal legs are meshed once."""
    models, legs = {}, legs_of(mechanism)
    for leg in legs.values():
        key = leg.section, round(leg.length, 9)
        models[key] = models.get(key) or solid_and_reduced(leg, 1400.0, 5600.0)
    legs_by_body = {body: models[leg.section, round(leg.length, 9)] for body, leg in legs.items()}
    return ({body: pair[side] for body, pair in legs_by_body.items()} for side in (0, 1))


def assert_equal_to_calculix(posture) -> int:
    """Compare compliance and ten frequencies; return the number of idle motions."""
    solids, reduced = solid_legs(posture.mechanism)
    solution = solved(assemble(posture, reduced))
    by_calculix, frequencies = compliance_and_frequencies(posture, solids, 10)
    assert scaled_difference(by_calculix, compliance(solution)) < PRINTED
    np.testing.assert_allclose(frequencies, modes(solution, 10).frequencies, rtol=PRINTED)
    return solution.idle


@needs_calculix
def test_five_bar_equals_calculix():
    """Square legs, an offset rigid body, rotors and two elastic joints: statics and frequencies."""
    mechanism = of_squares("five-bar")
    *_, last = mechanism.bodies.values()
    rigid = Rigid(6.0, np.array([0.1, 0.02, 0.03]), np.diag([0.2, 0.3, 0.4]) + 0.01)
    bodies = {**mechanism.bodies, last.name: replace(last, shape=rigid)}
    root = np.random.default_rng(1).normal(size=(6, 6))
    elastic = 1e-8 * (root @ root.T + np.eye(6))
    # Elastic are a driven joint on the ground and a joint that has rotated with its crank.
    joints = tuple(
        replace(
            joint,
            drive=joint.drive and replace(joint.drive, inertia=0.5),
            compliance=elastic if joint.name in {"motor1", "elbow1"} else None,
        )
        for joint in mechanism.joints
    )
    soft = replace(mechanism, bodies=bodies, joints=joints)
    assert assert_equal_to_calculix(posture(soft, soft.poses[0])) == 0


@needs_calculix
@pytest.mark.exhaustive
def test_spinning_rods_delta_equals_calculix():
    """Statics and frequencies; both programs have six idle motions, one for each rod."""
    assert assert_equal_to_calculix(reference_posture(of_squares("delta"))) == 6


RATIO, MODES, FIRST, LAST = 0.02, 40, 50.0, 1500.0


def receptances_by_calculix(text, folder):
    """Return frequencies (Hz) and complex receptances (m/N) of the tip along y by CalculiX's modes.

    CalculiX prints, for each frequency, the real parts and then the imaginary parts. It chooses the
    frequencies at the resonances and between them.
    """
    tip = int(re.search(r"NSET=WATCHED\n(\d+)", text)[1])
    text = text.replace("*FREQUENCY\n", "*FREQUENCY, STORAGE=YES\n")
    text += f"*STEP\n*STEADY STATE DYNAMICS\n{FIRST}, {LAST}, 10\n*MODAL DAMPING\n1, {MODES}, "
    text += f"{RATIO}\n*CLOAD\n{tip}, 2, 1.0\n*NODE PRINT, NSET=WATCHED\nU\n*END STEP\n"
    (folder / "deck.inp").write_text(text, encoding="ascii")
    program = [calculix_program(), "-i", "deck"]
    subprocess.run(program, cwd=folder, check=True, capture_output=True)
    printed = (folder / "deck.dat").read_text(encoding="ascii")
    rows = re.findall(rf"and time +(\S+)\n\n +{tip} +\S+ +(\S+) ", printed)
    numbers = np.array(rows, dtype=float).reshape(-1, 2, 2)
    return numbers[:, 0, 0], numbers[:, 0, 1] + 1j * numbers[:, 1, 1]


@needs_calculix
@pytest.mark.exhaustive
def test_damped_leg_equals_calculix(tmp_path):
    """The modes above the fortieth, which CalculiX omits, add a constant of less than 1e-4."""
    leg = ConstantLeg(0.5, Rectangle(0.04, 0.06), STEEL)
    solid, reduced = solid_and_reduced(leg, LAST, 6.0 * LAST)
    deck = replace(leg_deck(solid.mesh, STEEL, MODES), load_cases=())
    frequencies, by_calculix = receptances_by_calculix(deck_text(deck), tmp_path)
    assert len(frequencies) > 40
    alone = replace(clamped_leg("leg", leg), damping=RATIO)
    damped = damped_modes(solved(assemble(reference_posture(alone), {"leg": reduced})), LAST)
    receptances = damped.along(np.array([0.0, 1.0, 0.0])).receptance(frequencies)
    assert np.abs(by_calculix).max() > 10.0 * np.abs(by_calculix[0])
    differences = receptances - by_calculix
    omitted = differences[0].real
    assert 0.0 < omitted < 1e-4 * by_calculix[0].real
    # Beside a resonance the seven digits of a frequency give the receptance to 1e-5.
    sizes = np.maximum(np.abs(by_calculix), np.abs(by_calculix[0]))
    assert (np.abs(differences - omitted) < 3e-5 * sizes).all()


@needs_calculix
def test_calculix_error_names_its_deck():
    """A deck whose equation refers to a missing node: CalculiX's message, with the deck's title."""
    deck = leg_deck(tetrahedra(Rectangle(0.1, 0.1), 0.2, 1), STEEL)
    foreign = Equation((10**6, 0), (((0, 0), 1.0),))
    broken = replace(deck, title="foreign node", equations=(*deck.equations, foreign))
    with pytest.raises(ComputationError, match=r"foreign node: .*\*ERROR"):
        run_calculix(broken)
