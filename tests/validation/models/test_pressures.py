"""Pressures on faces of CAD parts in robots: exact elasticity, equilibrium, fields, and faults."""

import json
from dataclasses import replace

import numpy as np
import pytest
from support.robots.drawn_parts import meshed, without_processes
from support.robots.robot_from_text import described, robot_of

from lumped.errors import InputError
from lumped.mechanism.body import ByFaces
from lumped.mechanism.kinematics.postures import reference_posture
from validation.forces.analysis import forces
from validation.models.loads.pressures import resultants
from validation.models.loads.stability import gives_way_pressed, stabilities
from validation.models.loads.statics import displacements, load_forces
from validation.models.options import ModelOptions
from validation.models.plausibility import parts_text
from validation.solve.answer_json import as_json
from validation.solve.answer_text import as_text
from validation.solve.model_answers import solve
from validation.solve.question import Question

E, NU, LENGTH, WIDTH, HEIGHT = 2.1e11, 0.3, 0.12, 0.05, 0.03
BLOCK = f"""
schema = 2
name = "block"
points = {{ A = [0.0, 0.0, 0.0], B = [{LENGTH}, 0.0, 0.0] }}
tool = {{ body = "block", point = "B", moves = [] }}
joints.clamp = {{ type = "fixed", between = ["ground", "block"], at = "A" }}
[bodies.block]
mesh = "block.msh"
unit = "mm"
material = {{ E = {E}, nu = {NU}, rho = 7850.0 }}
[bodies.block.interfaces]
A = {{ plane = {{ normal = [-1.0, 0.0, 0.0] }}, coupling = "average" }}
B = {{ plane = {{ normal = [1.0, 0.0, 0.0] }}, coupling = "average" }}
"""
END = "plane = { normal = [1.0, 0.0, 0.0], point = [0.12, 0.0, 0.0] }"
TOP = "plane = { normal = [0.0, 0.0, 1.0], point = [0.0, 0.0, 0.015] }"
ALL = "faces = [1, 2, 3, 4, 5, 6]"
LOADS = {"end": (4.0e6, END), "top": (1.0e5, TOP), "all": (1.0e7, ALL)}


def load_text(name, *pressures):
    rows = ", ".join(f'{{ body = "block", pressure = {p!r}, {faces} }}' for p, faces in pressures)
    return f'[[loads]]\nname = "{name}"\npressures = [{rows}]\n'


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    """Robot of a block whose end is held on average and free to contract, with all loads."""
    folder = tmp_path_factory.mktemp("block")
    meshed(folder / "block.msh", lambda kernel: kernel.addBox(0, -25, -15, 120, 50, 30), 40.0)
    text = BLOCK + "".join(load_text(name, load) for name, load in LOADS.items())
    with pytest.MonkeyPatch.context() as patch:
        without_processes(patch)
        yield robot_of(text, folder)


# Models that keep the part's own 6×6. Beams are in tension as exact.
@pytest.mark.parametrize("model", ["solid", "links", "vjm"])
def test_pressed_block_moves_as_by_elasticity(block, model):
    """Work of p on the exact fields of a unit force and a unit moment at the free end (Betti).

    Force: u_x = x/EA, u_z = −νz/EA. Moment M about −y: u_z = M (x² + ν(z² − y²))/2EI less its mean
    ν(h² − b²)M/24EI over the held end. p on all sides shortens by p(1 − 2ν)L/E.
    """
    block_posture = reference_posture(block.mechanism)
    (end, top, every) = displacements(model, [block_posture])[0]
    p = 1.0e5
    rotation = p * WIDTH * (LENGTH**3 / 6.0 + NU * HEIGHT**2 * LENGTH / 12.0)
    rotation /= E * WIDTH * HEIGHT**3 / 12.0
    # Quadratic elements with straight edges take these fields exactly.
    assert end[0] == pytest.approx(-4.0e6 * LENGTH / E, rel=1e-9)
    assert np.abs(end[1:]).max() <= 1e-9 * abs(end[0])
    assert top[0] == pytest.approx(NU * p * LENGTH / (2.0 * E), rel=1e-8)
    assert top[4] == pytest.approx(rotation, rel=1e-8)
    assert every[0] == pytest.approx(-1.0e7 * (1.0 - 2.0 * NU) * LENGTH / E, rel=1e-9)


def test_equivalent_beam_carries_wrenches_of_part(block):
    """A pressure p on the end acts as pA at the tip. One on a side of width b is a load q = p b."""
    block_posture = reference_posture(block.mechanism)
    (end, top, _) = displacements("beam", [block_posture], ModelOptions(parts="condensed"))[0]
    assert end[0] == pytest.approx(-4.0e6 * LENGTH / E, rel=1e-9)
    q, bending = 1.0e5 * WIDTH, E * WIDTH * HEIGHT**3 / 12.0
    shear = 10.0 * (1.0 + NU) / (12.0 + 11.0 * NU) * E / (2.0 * (1.0 + NU)) * WIDTH * HEIGHT
    beam = q * LENGTH**4 / (8.0 * bending) + q * LENGTH**2 / (2.0 * shear)
    # A block four times as long as high on a coarse mesh.
    assert -top[2] == pytest.approx(beam, rel=1e-2)


@pytest.mark.parametrize("model", ["solid", "beam", "simplified"])
def test_reactions_balance_pressures(block, model):
    """Reactions of a clamped block by hand: pA on its end, pLb on its top, none all around."""
    block_posture = reference_posture(block.mechanism)
    (by_load,) = load_forces(model, [block_posture])
    by_hand = {
        "end": [-4.0e6 * WIDTH * HEIGHT, 0, 0, 0, 0, 0],
        "top": [0, 0, -1.0e5 * LENGTH * WIDTH, 0, 1.0e5 * LENGTH**2 * WIDTH / 2.0, 0],
        "all": [0, 0, 0, 0, 0, 0],
    }
    totals = resultants(block.mechanism)
    for result, (name, wrench) in zip(by_load, by_hand.items(), strict=True):
        size = LOADS[name][0] * WIDTH * HEIGHT
        (reaction,), (total,) = result.reactions, totals[name]
        # Of the clamp on the block, about its point, the origin of the part.
        assert reaction.wrench == pytest.approx(np.negative(wrench), abs=1e-9 * size)
        resultant = np.concatenate([total.force, total.moment])
        assert resultant == pytest.approx(wrench, abs=1e-9 * size)


def test_hydrostatic_stress_field_is_uniform(block):
    """σ = −p 1 in the whole block."""
    analysis = forces(Question(block, "solid", {}), ["all"], solids=True)
    field = analysis.poses[0].loads["all"].solids["block"]
    expected = np.tile([-1e7, -1e7, -1e7, 0.0, 0.0, 0.0], (len(field.stresses), 1))
    np.testing.assert_allclose(field.stresses, expected, atol=1e-7 * 1e7)
    stretch = field.displacements[:, 0] + 1e7 * (1 - 2 * NU) / E * field.mesh.nodes[:, 0]
    assert np.abs(stretch).max() <= 1e-9 * 1e7 * LENGTH / E


def test_uniform_pressure_does_not_buckle_bar(block):
    """The pressure follows the surface. Loads of fixed direction would predict buckling."""
    block_posture = reference_posture(block.mechanism)
    (row,) = stabilities("links", [block_posture])
    every, load = row[-1], block.mechanism.loads[-1]
    assert every.factor is not None
    assert gives_way_pressed(load, every)


def test_check_and_solve_list_pressure_resultants(block):
    """Face, area, force and moment of each pressure, and why there is no buckling factor."""
    checked = parts_text(block.mechanism)
    assert "force (-6000, 0, 0) N, moment (0, 0, 0) N m" in checked
    solution = solve(Question(block, "links", {}, 0))
    text = as_text(solution)
    assert "top: 100000 Pa on face 3 of block (6000 mm²), force (0, 0, -600) N" in text
    assert "end: not computed, the pressures turn with the part that gives way first" in text
    loads = json.loads(as_json(solution))["results"][0]["loads"]
    (pressure,) = loads["top"]["pressures"]
    assert pressure["moment"] == pytest.approx([0.0, 36.0, 0.0], abs=1e-9)
    assert "buckling" not in loads["top"]


def test_points_of_pressures_have_the_file_unit():
    """Points and radii in mm; pressures stay in Pa."""
    plane = "plane = { normal = [1, 0, 0], point = [120.0, 0.0, 0.0] }"
    bore = "cylinder = { radius = 12.0, point = [60.0, 0.0, 0.0] }"
    text = BLOCK.replace("schema = 2", 'schema = 2\nunits = "mm"').replace(f"[{LENGTH},", "[120.0,")
    mechanism = described(text + load_text("both", (3.0e5, plane), (2.0e5, bore)))
    in_plane, in_bore = mechanism.loads[0].pressures
    assert in_plane.faces.point == pytest.approx((LENGTH, 0.0, 0.0))
    assert (in_bore.faces.radius, *in_bore.faces.point) == pytest.approx((0.012, 0.06, 0.0, 0.0))
    assert (in_plane.pressure, in_bore.pressure) == (3.0e5, 2.0e5)


FAULTS = {
    'body = "blocks", pressure = 1.0, faces = [1]': (
        'body = "blocks": must be a CAD part (step or mesh); did you mean "block"?'
    ),
    'body = "rod", pressure = 1.0, faces = [1]': (
        'body = "rod": must be a CAD part (step or mesh): block; "rod" has no faces, load the body '
        "by lines"
    ),
    'body = "plate", pressure = 1.0, faces = [1]': (
        'body = "plate": must be a CAD part (step or mesh): block; "plate" has no faces, load the '
        "body by wrench"
    ),
    'body = "block", pressure = 1.0': (
        "does not specify faces; must have one of faces, name, cylinder, plane"
    ),
    'body = "block", pressure = 1.0, name = "lid", faces = [1]': (
        "has faces and name; must have one of faces, name, cylinder, plane"
    ),
    'body = "block", pressure = 1.0, plane = { normal = [1.0, 0.0, 0.0] }': (
        "plane.point: missing; must be 3 numbers in m"
    ),
    'body = "block", pressure = 2.0e9, faces = [1]': (
        "pressure = 2000000000.0: must be at most 1e+09 Pa"
    ),
    'body = "block", faces = [1]': ("pressure: missing; must be a number from -1e+09 to 1e+09 Pa"),
}
OTHER_BODIES = """
[bodies.rod]
from = "B"
to = "C"
section = { shape = "circle", diameter = 0.01 }
material = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
[bodies.plate]
points = ["C"]
[joints.b]
type = "fixed"
between = ["block", "rod"]
at = "B"
[joints.c]
type = "fixed"
between = ["rod", "plate"]
at = "C"
"""


@pytest.mark.parametrize("pressure", FAULTS)
def test_invalid_pressure_is_refused(pressure):
    """Each fault of `pressures` gives one line with key, value and range."""
    text = BLOCK.replace("B = [", "C = [0.2, 0.0, 0.0], B = [", 1) + OTHER_BODIES
    with pytest.raises(InputError) as error:
        described(f'{text}[[loads]]\nname = "press"\npressures = [{{ {pressure} }}]')
    (fault,) = error.value.faults
    key = "loads[1].pressures[1]"
    assert fault.replace(f"{key}: ", "").replace(f"{key}.", "") == FAULTS[pressure]
    assert fault.startswith(key)


def test_pressure_on_missing_face_names_its_key(block):
    """A block has six faces; the seventh is refused in `check` and in statics."""
    on_seventh = replace(block.mechanism.loads[-1].pressures[0], faces=ByFaces((7,)))
    loads = (
        *block.mechanism.loads[:-1],
        replace(block.mechanism.loads[-1], pressures=(on_seventh,)),
    )
    for compute in (parts_text, lambda robot: displacements("beam", [reference_posture(robot)])):
        with pytest.raises(InputError) as error:
            compute(replace(block.mechanism, loads=loads))
        (fault,) = error.value.faults
        assert fault == ("loads[3].pressures[1]: face 7 does not exist; the part has faces 1 to 6")
