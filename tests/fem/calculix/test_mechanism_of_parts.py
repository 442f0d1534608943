"""A whole robot of two CAD parts held against CalculiX on the same meshes, rigid bores."""

import shutil

import pytest
from compliances import scaled_difference
from prismatic_legs import STEEL

from fem.bodies.part import grips_of, meshed_part
from fem.bodies.rooted import rooted_body
from fem.calculix import run as calculix_run
from fem.calculix.leg import mass_at_stiffness_points
from fem.calculix.mechanism import HeldMesh, compliance_and_frequencies
from fem.couplings.coupled_solid import coupled_solid
from fem.reduction.craig_bampton import reduction
from fem.reduction.held import HeldBody
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot
from lumped.system.assembly import assemble
from lumped.system.solution import compliance, modes, solved
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.part.volume import Grading, volume_mesh

ROBOT = """
schema = 2
name = "two arms"

[points]
A = [0.0, 0.0, 0.0]
B = [0.13, 0.0, 0.0]
C = [0.13, 0.13, 0.0]

[materials.steel]
E = 2.1e11
nu = 0.3
rho = 7850.0

[bodies.upper]
step = "bar.step"
material = "steel"
interfaces = { A = { cylinder = { radius = 0.008 } }, B = { cylinder = { radius = 0.006 } } }

[bodies.fore]
step = "bar.step"
material = "steel"
place = { at = "B", x = [0.0, 1.0, 0.0], y = [-1.0, 0.0, 0.0] }
interfaces = { B = { cylinder = { radius = 0.008 } }, C = { cylinder = { radius = 0.006 } } }

[joints.A]
type = "revolute"
between = ["ground", "upper"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = 4.0e4 }

[joints.B]
type = "revolute"
between = ["upper", "fore"]
at = "B"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = 2.0e4 }

[tool]
body = "fore"
point = "C"
moves = ["x", "y"]
mass = 1.5

[path]
from = [0.13, 0.13]
to = [0.11, 0.15]
count = 2
"""


@pytest.fixture(scope="module")
def two_arms(bar_step):
    """The robot, and the mesh of its parts: a bar of two bores, the first at the origin."""
    folder = bar_step.parent
    (folder / "robot.toml").write_text(ROBOT, "utf-8")
    mechanism = load_robot(folder / "robot.toml").mechanism
    upper = mechanism.bodies["upper"]
    part = read_part(bar_step)
    points = {name: frame.position for name, frame in upper.interfaces.items()}
    found = find_interfaces(part, upper.shape.interfaces, points)
    return mechanism, volume_mesh(part, found, Grading(0.02)), found


@pytest.mark.exhaustive
@pytest.mark.skipif(
    not any(map(shutil.which, calculix_run.PROGRAMS)), reason="CalculiX (ccx) is not installed"
)
def test_compliance_and_ten_frequencies_of_a_robot_of_two_parts(two_arms):
    mechanism, mesh, interfaces = two_arms
    at = posture(mechanism, mechanism.poses[1])
    grips = grips_of(mesh, interfaces)
    # CalculiX sums the mass over the stiffness' points; so do we here.
    mass = mass_at_stiffness_points(mesh, STEEL.rho)
    solid = coupled_solid(meshed_part(mesh, STEEL).stiffness, mass, mesh.nodes, grips)
    # Cut off at more than twice the tenth frequency: the error of the reduction is below 1e-5.
    found = reduction(HeldBody(rooted_body(solid, "bar")), 9000.0, 22_000.0)
    models = {
        name: BodyModel(
            "solid", tuple(body.interfaces), found.stiffness, found.mass, lambda points: points
        )
        for name, body in mechanism.bodies.items()
        if name in ("upper", "fore")
    }
    solution = solved(assemble(at, models))
    held = HeldMesh(mesh, STEEL, tuple(grip.nodes for grip in grips))
    theirs, frequencies = compliance_and_frequencies(at, dict.fromkeys(models, held), 10)
    assert scaled_difference(theirs, compliance(solution)) < 1e-5
    assert frequencies == pytest.approx(modes(solution, 10).frequencies, rel=1e-4)
    # The reduction was asked for what it gives.
    assert frequencies[-1] < 9000.0
