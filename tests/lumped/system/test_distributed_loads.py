"""Distributed loads on legs: closed forms for every model, section forces, and faults."""

import numpy as np
import pytest
from support.robots.robot_from_text import described

from fem.beams.beam import beam_leg
from lumped.beam_properties import prism_sections
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.load import InterfaceLoads, LineLoad
from lumped.models import serial_chains
from lumped.models.bodies import legs_of, links, tip_compliances
from lumped.models.segments import segment_chain, segment_leg
from lumped.sections import Rectangle
from lumped.system.assembly import assemble
from lumped.system.line_loads import end_wrenches
from lumped.system.loads import loading, tool_displacements
from lumped.system.solution import solved

LENGTH, WIDTH, HEIGHT, E, NU = 0.8, 0.03, 0.05, 2.1e11, 0.3
LEG = ConstantLeg(LENGTH, Rectangle(WIDTH, HEIGHT), Material.isotropic(E, NU, 7850.0)).timoshenko
ARM = f"""
schema = 2
name = "arm"
points = {{ A = [0.0, 0.0, 0.0], P = [{LENGTH}, 0.0, 0.0] }}
materials.steel = {{ E = {E}, nu = {NU}, rho = 7850.0 }}
tool = {{ body = "arm", point = "P", moves = [] }}
joints.clamp = {{ type = "fixed", between = ["ground", "arm"], at = "A" }}
[bodies.arm]
from = "A"
to = "P"
section = {{ shape = "rectangle", width = {WIDTH}, height = {HEIGHT} }}
material = "steel"
[[loads]]
name = "line"
"""
MODELS = {
    "beam, 1 element": lambda leg: beam_leg(leg.timoshenko, leg.length, 1),
    "beam, 7 elements": lambda leg: beam_leg(leg.timoshenko, leg.length, 7),
    "segments, 1": lambda leg: segment_leg(segment_chain(leg.timoshenko, leg.length, 1)),
    "segments, 6": lambda leg: segment_leg(segment_chain(leg.timoshenko, leg.length, 6)),
    "link": None,
    "chains": None,
}


def displacement(text, model, pose=None, number=0):
    """Return the displacement (6) of the tool under load `number` of the robot file `text`.

    The posture is that of the pose `pose`, or the reference posture if None."""
    mechanism = described(text)
    loaded_posture = (
        reference_posture(mechanism) if pose is None else posture(mechanism, np.array(pose))
    )
    load = loading(loaded_posture, mechanism.loads[number], InterfaceLoads())
    compliances = tip_compliances(mechanism)
    if model == "chains":
        return serial_chains.tool_displacements(loaded_posture, compliances, [load])[0]
    build = MODELS[model]
    bodies = (
        links(mechanism, compliances)
        if build is None
        else {name: build(leg) for name, leg in legs_of(mechanism).items()}
    )
    return tool_displacements(solved(assemble(loaded_posture, bodies)), [load])[0]


def closed_form(start, first, last):
    """Return the tip displacement of a cantilever under a linear load from `start` (m) to the tip.

    The load has six components, `first` at `start` and `last` at the tip; x is the distance from
    the root. With loads q (N/m) and moments m (N m/m): u = ∫ q x/EA dx; v = ∫ q (x³/3EI +
    x²(L − x)/2EI + x/κGA) dx, φ = ∫ q x²/2EI dx; m rotates by ∫ m x/EI dx and moves by
    ∫ m (x²/2 + x(L − x))/EI dx; torsion is ∫ m x/GJ dx.
    """
    x = np.polynomial.Polynomial([0.0, 1.0])

    def over_length(component, weight):
        slope = (last[component] - first[component]) / (LENGTH - start)
        integral = ((first[component] + slope * (x - start)) * weight).integ()
        return integral(LENGTH) - integral(start)

    p = LEG
    motion = np.zeros(6)
    motion[0] = over_length(0, x) / p.EA
    motion[3] = over_length(3, x) / p.GJ
    bend, turn_weight = x**3 / 3.0 + x**2 * (LENGTH - x) / 2.0, x**2 / 2.0 + x * (LENGTH - x)
    motion[1] = over_length(1, bend / p.EIz + x / p.GAy) + over_length(5, turn_weight) / p.EIz
    motion[5] = over_length(1, x**2 / 2.0) / p.EIz + over_length(5, x) / p.EIz
    # A positive φy moves the tip down along z.
    motion[2] = over_length(2, bend / p.EIy + x / p.GAz) - over_length(4, turn_weight) / p.EIy
    motion[4] = -over_length(2, x**2 / 2.0) / p.EIy + over_length(4, x) / p.EIy
    return motion


@pytest.mark.parametrize("model", MODELS)
def test_uniform_load_is_exact(model):
    """qL⁴/8EI + qL²/2κGA with the slope qL³/6EI; twist mL²/2GJ; elongation nL²/2EA."""
    n, q, m = 900.0, -400.0, 70.0
    tip_displacement = displacement(
        ARM + f"lines = [{{ leg = 'arm', wrench = [{n}, 0, {q}, {m}, 0, 0] }}]", model
    )
    p = LEG
    expected = [
        n * LENGTH**2 / (2.0 * p.EA),
        0.0,
        q * LENGTH**4 / (8.0 * p.EIy) + q * LENGTH**2 / (2.0 * p.GAz),
        m * LENGTH**2 / (2.0 * p.GJ),
        -q * LENGTH**3 / (6.0 * p.EIy),
        0.0,
    ]
    # Round-off of seven elements is 1e-12 of the largest component.
    assert np.abs(tip_displacement - expected).max() <= 1e-10 * np.abs(expected).max()


@pytest.mark.parametrize("model", MODELS)
def test_partial_linear_load_is_exact(model):
    """All six components act from x = 0.3 m to the tip, growing or falling linearly."""
    first, last = [300.0, -200.0, 500.0, 40.0, 20.0, -30.0], [100.0, 600.0, -100.0, 0.0, 50.0, 10.0]
    line = f"{{ leg = 'arm', wrench = {first}, end_wrench = {last}, from = 0.3, axes = 'leg' }}"
    tip_displacement = displacement(ARM + f"lines = [{line}]", model)
    expected = closed_form(0.3, first, last)
    assert np.abs(tip_displacement - expected).max() <= 1e-10 * np.abs(expected).max()


def test_line_loads_superpose():
    """Loads on both halves equal the load on the whole leg; a wrench adds its displacement."""
    lines = "{ leg = 'arm', wrench = [0, 100, 0, 0, 0, 0], to = 0.3 }, "
    lines += "{ leg = 'arm', wrench = [0, 100, 0, 0, 0, 0], from = 0.3 }"
    push = "wrench = [0.0, 50.0, 0.0, 0.0, 0.0, 0.0]"
    tip_displacement = displacement(f"{ARM}lines = [{lines}]\n{push}", "link")
    p = LEG
    v = 100.0 * (LENGTH**4 / (8.0 * p.EIz) + LENGTH**2 / (2.0 * p.GAy))
    v += 50.0 * (LENGTH**3 / (3.0 * p.EIz) + LENGTH / p.GAy)
    assert tip_displacement[1] == pytest.approx(v, rel=1e-11)


def test_uniform_load_has_fixed_end_wrenches():
    """qL/2 and ±qL²/12 at clamped ends, with or without shear deformation.

    Clamped beam under q on its first half (Timoshenko, Strength of Materials): reactions 13qL/32
    and 3qL/32, moments 11qL²/192 and 5qL²/192, without shear deformation.
    """
    load = LineLoad(0.0, LENGTH, np.array([0, 0, 6.0, 0, 0, 0]), np.array([0, 0, 6.0, 0, 0, 0]))
    q = 6.0
    fixed_end_wrenches = [[0, 0, q * LENGTH / 2, 0, -q * LENGTH**2 / 12, 0]]
    fixed_end_wrenches.append([0, 0, q * LENGTH / 2, 0, q * LENGTH**2 / 12, 0])
    for properties in (LEG, LEG.as_euler_bernoulli()):
        np.testing.assert_allclose(
            end_wrenches(prism_sections(properties, LENGTH), load), fixed_end_wrenches, atol=1e-11
        )
    half = LineLoad(0.0, LENGTH / 2.0, load.first, load.last)
    wrenches = end_wrenches(prism_sections(LEG.as_euler_bernoulli(), LENGTH), half)
    forces = np.array([13.0, 3.0]) * q * LENGTH / 32.0
    moments = np.array([-11.0, 5.0]) * q * LENGTH**2 / 192.0
    np.testing.assert_allclose(wrenches[:, 2], forces, rtol=1e-11)
    np.testing.assert_allclose(wrenches[:, 4], moments, rtol=1e-11)


def test_base_axes_load_keeps_direction():
    """An arm on a locked pivot rotated by 90°: a load along base −y then acts along the arm."""
    text = ARM.replace("moves = []", 'moves = ["phi_z"]').replace(
        'joints.clamp = { type = "fixed", between = ["ground", "arm"], at = "A" }',
        'joints.clamp = { type = "revolute", between = ["ground", "arm"], at = "A", '
        'axis = [0.0, 0.0, 1.0], drive = { stiffness = "rigid" } }',
    )
    line = "lines = [{{ leg = 'arm', wrench = [0, -300.0, 0, 0, 0, 0]{} }}]"
    turned = [0.5 * np.pi]
    tip_displacement = displacement(text + line.format(""), "link", turned)
    extension = 300.0 * LENGTH**2 / (2.0 * LEG.EA)
    assert tip_displacement[:3] == pytest.approx([0.0, -extension, 0.0], abs=1e-9 * extension)
    tip_displacement = displacement(text + line.format(", axes = 'leg'"), "link", turned)
    p = LEG
    v = 300.0 * (LENGTH**4 / (8.0 * p.EIz) + LENGTH**2 / (2.0 * p.GAy))
    # The leg's −y points along +x.
    assert tip_displacement[0] == pytest.approx(v, rel=1e-9)


FAULTS = {
    "leg = 'arms', wrench = [0, 1, 0, 0, 0, 0]": (
        'loads[1].lines[1].leg = "arms": must be a leg with a section, or with a 6×6 '
        'compliance; did you mean "arm"?'
    ),
    "leg = 'arm', wrench = [0, 1, 0]": (
        "loads[1].lines[1].wrench = [0, 1, 0]: must be 6 numbers in N/m or N m/m"
    ),
    "leg = 'arm', wrench = [0, 1, 0, 0, 0, 0], to = 0.9": (
        "loads[1].lines[1].to = 0.9: must be at most the leg's length, 0.8 m"
    ),
    "leg = 'arm', wrench = [0, 1, 0, 0, 0, 0], from = 0.5, to = 0.4": (
        "loads[1].lines[1].from = 0.5: must be below 0.4 m, its end"
    ),
}


@pytest.mark.parametrize("line", FAULTS)
def test_invalid_line_load_is_refused(line):
    """Each fault of `lines` of a load gives one line with key, value and range."""
    with pytest.raises(InputError) as error:
        described(f"{ARM}lines = [{{ {line} }}]")
    assert error.value.faults == (FAULTS[line],)
