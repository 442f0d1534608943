"""Distributed loads on bent, stepped and tapered legs: closed forms for all models, equilibrium."""

import numpy as np
import pytest
from support.robots.robot_from_text import described

from fem.beams.line_beam import line_beam
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.load import InterfaceLoads
from lumped.models import serial_chains
from lumped.models.bodies import legs_of, links, tip_compliances
from lumped.models.segments import line_segment_chain, segment_leg
from lumped.sections import Rectangle
from lumped.system.assembly import assemble
from lumped.system.loads import loading, tool_displacements
from lumped.system.solution import solved
from validation.models.loads.statics import load_forces
from validation.models.options import ModelOptions

E, NU, WIDTH, HEIGHT = 2.1e11, 0.3, 0.03, 0.05
PRISM = ConstantLeg(1.0, Rectangle(WIDTH, HEIGHT), Material.isotropic(E, NU, 7850.0)).timoshenko
RADIUS, FIRST, SECOND = 0.6, 0.7, 0.4
TEXT = f"""
schema = 2
name = "arm"
materials.steel = {{ E = {E}, nu = {NU}, rho = 7850.0 }}
tool = {{ body = "arm", point = "P", moves = [] }}
joints.clamp = {{ type = "fixed", between = ["ground", "arm"], at = "A" }}
"""
BODY = """
[bodies.arm]
from = "A"
to = "P"
material = "steel"
"""


def station(at, width=WIDTH):
    return f'{{ at = {at}, shape = "rectangle", width = {width}, height = {HEIGHT} }}'


EQUAL = f"sections = [{station(0.0)}, {station(1.0)}]"
DIAGONAL = RADIUS * np.sqrt(0.5)
# Quarter of a circle about the origin, clamped on the y axis, with its free end on the x axis.
ARC = (
    f"{TEXT}points = {{ A = [0.0, {RADIUS}, 0.0], M = [{DIAGONAL}, {DIAGONAL}, 0.0], "
    f'P = [{RADIUS}, 0.0, 0.0] }}{BODY}through = [{{ arc = "M" }}]\n{EQUAL}'
)
# From A along x to the corner K, then along y to P.
FRAME = (
    f"{TEXT}points = {{ A = [0.0, 0.0, 0.0], K = [{FIRST}, 0.0, 0.0], "
    f'P = [{FIRST}, {SECOND}, 0.0] }}{BODY}through = ["K"]\n{EQUAL}'
)
# Half the width from 0.4 m on.
STEP = (
    f"{TEXT}points = {{ A = [0.0, 0.0, 0.0], P = [1.0, 0.0, 0.0] }}{BODY}sections = [{station(0.0)}"
    f", {station(0.4)}, {station(0.4, WIDTH / 2)}, {station(1.0, WIDTH / 2)}]"
)
MODELS = ("beam, 1", "beam, 5", "segments, 1", "segments, 6", "link", "chains")


def displacement(text, model, lines):
    """Return the displacement (6, base axes) of the free end under loads along the leg."""
    mechanism = described(f'{text}\n[[loads]]\nname = "line"\nlines = [{lines}]')
    posture = reference_posture(mechanism)
    load = loading(posture, mechanism.loads[0], InterfaceLoads())
    compliances = tip_compliances(mechanism)
    if model == "chains":
        return serial_chains.tool_displacements(posture, compliances, [load])[0]
    sections = legs_of(mechanism)["arm"].sections("timoshenko")
    kind, _, count = model.partition(", ")
    match kind:
        case "beam":
            bodies = {"arm": line_beam(sections, int(count))}
        case "segments":
            bodies = {"arm": segment_leg(line_segment_chain(sections, int(count)))}
        case _:
            bodies = links(mechanism, compliances)
    return tool_displacements(solved(assemble(posture, bodies)), [load])[0]


def along(wrench, limits=""):
    return f"{{ leg = 'arm', wrench = {wrench}{limits} }}"


@pytest.mark.parametrize("model", MODELS)
def test_quarter_arc_under_uniform_load_is_exact(model):
    """Castigliano with Winkler's bar; the angle θ runs from the free end to the clamp.

    Load w along z: bending moment wR²(1 − cos θ), torque wR²(θ − sin θ), shear force wRθ. Load q
    along y: M = qR²(sin θ − θ cos θ), which straightens the arc, N − M/R = −qR sin θ, and the shear
    force qRθ sin θ.
    """
    p, w, q, R = PRISM, -300.0, 500.0, RADIUS
    # ∫z²(1 + y²/R²) dA and ∫y²(1 + y²/R²) dA, y is radial.
    out_of_plane = p.EIy + E * WIDTH**3 * HEIGHT**3 / (144.0 * R**2)
    in_plane = p.EIz + E * HEIGHT * WIDTH**5 / (80.0 * R**2)
    torsion = np.pi**2 / 8.0 - np.pi / 2.0 + 0.5
    expected_z = w * R**4 * (0.5 / out_of_plane + torsion / p.GJ)
    expected_z += w * R**2 * np.pi**2 / 8.0 / p.GAz
    expected_y = q * R**4 * (1.25 - np.pi / 2.0 + np.pi**2 / 16.0) / in_plane
    expected_y += q * R**2 * (1.0 / p.EA + (np.pi**2 / 16.0 + 0.25) / p.GAy)
    motion = displacement(ARC, model, along([0.0, q, w, 0.0, 0.0, 0.0]))
    assert motion[1:3] == pytest.approx([expected_y, expected_z], rel=1e-10)


@pytest.mark.parametrize("model", MODELS)
def test_frame_with_corner_under_uniform_load_is_exact(model):
    """The second piece loads the corner by the force qb and the torque qb²/2."""
    p, q, a, b = PRISM, -400.0, FIRST, SECOND
    motion = displacement(FRAME, model, along([0.0, 0.0, q, 0.0, 0.0, 0.0]))
    expected = sum(q * L**4 / (8.0 * p.EIy) + q * L**2 / (2.0 * p.GAz) for L in (a, b))
    expected += q * b * (a**3 / (3.0 * p.EIy) + a / p.GAz) + 0.5 * q * b**2 * a * b / p.GJ
    assert motion[2] == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("model", MODELS)
def test_load_on_second_piece_of_frame_is_exact(model):
    """Moments m along y on the second piece twist it, and bend the first piece by m(L − a)."""
    p, m, a, b, start = PRISM, 50.0, FIRST, SECOND, 0.1
    lines = along([0.0, 0.0, 0.0, 0.0, m, 0.0], f", from = {a + start}")
    motion = displacement(FRAME, model, lines)
    torque = m * (b - start)
    assert motion[4] == pytest.approx(
        torque * a / p.EIy + m * (b**2 - start**2) / 2.0 / p.GJ, rel=1e-10
    )


@pytest.mark.parametrize("model", MODELS)
def test_linear_load_across_step_is_exact(model):
    """n(x) along the axis from 0.3 m to the tip: ∫ N/EA dx with half the area from 0.4 m on."""
    lines = along(
        [100.0, 0.0, 0.0, 0.0, 0.0, 0.0], ", from = 0.3, end_wrench = [800, 0, 0, 0, 0, 0]"
    )
    load = (100.0 + 1000.0 * np.polynomial.Polynomial([-0.3, 1.0])).integ()
    force = load(1.0) - load
    extension = force.integ()
    N = force(0.3)
    elongation = 0.3 * N + extension(0.4) - extension(0.3) + 2.0 * (extension(1.0) - extension(0.4))
    motion = displacement(STEP, model, lines)
    assert motion[0] == pytest.approx(elongation / PRISM.EA, rel=1e-10)


@pytest.mark.parametrize("model", ["beam", "segments", "links", "vjm", "simplified"])
@pytest.mark.parametrize("text", [ARC, FRAME], ids=["arc", "frame"])
def test_clamp_balances_load_along_bent_leg(text, model):
    """The reaction of the clamp is the resultant of a load on the whole line, with its moment."""
    wrench = np.array([40.0, -300.0, 200.0, 5.0, 10.0, -20.0])
    loaded = f'{text}\n[[loads]]\nname = "line"\nlines = [{along(wrench.tolist())}]'
    mechanism = described(loaded)
    posture = reference_posture(mechanism)
    ((forces,),) = load_forces(model, [posture], ModelOptions(elements=3))
    (reaction,) = forces.reactions
    line = legs_of(mechanism)["arm"].line
    points, weights = np.polynomial.legendre.leggauss(20)
    resultant = np.zeros(6)
    for start, end in zip(line.ends[:-1], line.ends[1:], strict=True):
        half = 0.5 * (end - start)
        places, _ = line.frames(start + half * (1.0 + points))
        arms = places @ posture.frames["arm"].rotation.T
        moments = wrench[3:] + np.cross(arms, wrench[:3])
        resultant[:3] += 2.0 * half * wrench[:3]
        resultant[3:] += half * weights @ moments
    size = np.linalg.norm(wrench[:3]) * line.length
    assert np.abs(reaction.wrench + resultant).max() < 1e-9 * size


def test_load_beyond_end_of_line_is_refused():
    """Positions are counted along the line, which is longer than the distance of its ends."""
    displacement(FRAME, "link", along([0, 0, 1, 0, 0, 0], f", to = {FIRST + SECOND}"))
    with pytest.raises(InputError) as error:
        displacement(FRAME, "link", along([0, 0, 1, 0, 0, 0], ", to = 1.2"))
    assert error.value.faults == (
        "loads[1].lines[1].to = 1.2: must be at most the leg's length along its line, 1.1 m",
    )
