"""A hexapod and a drawn part in closed form, a leg by CalculiX and a five-bar by EXUDYN."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.spatial.transform import Rotation

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.bodies.solid import clamped_leg, solid_leg
from fem.calculix.leg import compliance_and_frequencies
from fem.multibody import frequencies
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.body import ByPlane, PartInterface
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from meshes.gmsh_session import gmsh_model
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.part.volume import Grading, volume_mesh
from meshes.prism.tetrahedra import tetrahedra
from validation.models.mechanism import answers
from validation.models.options import ModelOptions
from validation.selftest.benchmark import Benchmark, KnownNumber

_STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
_BLOCK = ConstantLeg(0.4, Rectangle(0.08, 0.12), _STEEL)
_MODES = 3
# Beams a leg: EXUDYN's are of second order, so that extrapolated ones are of fourth.
_ELEMENTS = (4, 8)
# Along x, y and z (m), and elements' size (m).
_BAR, _SIZE = (0.12, 0.04, 0.024), 0.02


def benchmarks() -> tuple[Benchmark, ...]:
    """A mechanism, a part, and two other programs."""
    return (
        Benchmark(
            "A hexapod as bars between ball joints",
            "Deflection of the platform of the built-in hexapod under unit forces, "
            "off its reference pose, legs as beams: whatever they do in bending, only their "
            "stretching and the drives count.",
            "K = Σ k j jᵀ, j = (d, p × d), 1/k = L₁/EA₁ + L₂/EA₂ + 1/k_drive, d along a leg",
            "exact: rounding, grown by the slenderness of the legs",
            hexapod,
        ),
        Benchmark(
            "A bar drawn and meshed by gmsh, held on average at its ends",
            "Stretching under a unit force, deflection and rotation under a unit moment of a steel "
            "bar of 120 × 40 × 24 mm. Even and linear tractions have quadratic displacements, "
            "which second-order tetrahedra hold on any mesh.",
            "L/EA; L²/2EI; L/EI",
            "exact: rounding",
            bar,
        ),
        Benchmark(
            "A steel block, clamped, by CalculiX on the same tetrahedra",
            "Compliance of the tip and first frequencies of a block of 0.4 × 0.08 × 0.12 m between "
            "rigid faces. CalculiX integrates its elements' mass more coarsely.",
            "CalculiX CrunchiX, G. Dhondt, C3D10 elements, rigid faces by *EQUATION",
            "CalculiX prints seven digits; its mass rule changes frequencies by up to 0.02 %",
            by_calculix,
        ),
        Benchmark(
            "A five-bar of beams by EXUDYN",
            "First frequencies of the built-in five-bar in its reference posture; EXUDYN's "
            f"frequencies are extrapolated from {_ELEMENTS[0]} and {_ELEMENTS[1]} beams a leg.",
            "EXUDYN, J. Gerstmayr, Multibody System Dynamics 60 (2024) 617, "
            "geometrically exact beams, linearised",
            "what the extrapolation leaves open is a tenth of it",
            by_exudyn,
        ),
    )


def hexapod() -> list[KnownNumber]:
    """Deflections of the platform's point, beside a stiffness summed over the legs."""
    mechanism = load_robot("hexapod").mechanism
    at = posture(mechanism, mechanism.poses[0])
    (own,) = answers("beam", [at], 0, ModelOptions(elements=1))
    known = np.linalg.inv(hexapod_stiffness(mechanism, at.pose))
    return _deflections(np.diag(known), np.diag(own.compliance), 1e-8)


def hexapod_stiffness(mechanism: Mechanism, pose: Array) -> Array:
    """Σ k j jᵀ (6×6, SI, base axes) of the built-in hexapod at its platform's point."""
    centre = mechanism.reference_pose[:3]
    turn = Rotation.from_rotvec(pose[3:]).as_matrix()
    drives = {joint.name: joint.drive for joint in mechanism.joints}
    stiffness = np.zeros((6, 6))
    for number in range(1, 7):
        base = mechanism.reference[f"strut{number}"].position
        rod, drive = f"rod{number}", drives[f"drive{number}"]
        tip = mechanism.bodies[rod].interfaces[f"Q{number}"]
        joint = (mechanism.reference[rod] @ tip).position
        end = pose[:3] + turn @ (joint - centre)
        shapes = [mechanism.bodies[name].shape for name in (f"strut{number}", rod)]
        give = sum(
            shape.length / (shape.material.E * shape.section.area)
            for shape in shapes
            if isinstance(shape, ConstantLeg)
        )
        give += 1.0 / (drive.stiffness or np.inf) if drive else 0.0
        along = (end - base) / np.linalg.norm(end - base)
        screw = np.concatenate([along, np.cross(end - pose[:3], along)])
        stiffness += np.outer(screw, screw) / give
    return stiffness


def bar() -> list[KnownNumber]:
    """Columns of pull and bending of one end of a bar from the other, by gmsh and back."""
    length, width, height = _BAR
    ends = {
        name: PartInterface(ByPlane((way, 0.0, 0.0), (x, 0.0, 0.0)), "average")
        for name, way, x in (("A", -1.0, 0.0), ("B", 1.0, length))
    }
    with TemporaryDirectory(prefix="flexproof-bar-") as folder:
        path = Path(folder) / "bar.brep"
        with gmsh_model("bar") as gmsh:
            gmsh.model.occ.addBox(0.0, -width / 2.0, -height / 2.0, length, width, height)
            gmsh.model.occ.synchronize()
            gmsh.write(str(path))
        part = read_part(path, "m")
        interfaces = find_interfaces(part, ends)
        mesh = volume_mesh(part, interfaces, Grading(_SIZE))
    held = held_part(meshed_part(mesh, _STEEL), grips_of(mesh, interfaces), "bar")
    E, I = _STEEL.E, height * width**3 / 12.0
    found = held.compliance
    return [
        KnownNumber(quantity, unit, known, float(found[row, column]), 1e-8)
        for quantity, unit, row, column, known in (
            ("stretching under a unit force", "m", 0, 0, length / (E * width * height)),
            ("deflection under a unit moment", "m", 1, 5, length**2 / (2.0 * E * I)),
            ("rotation under a unit moment", "rad", 5, 5, length / (E * I)),
        )
    ]


def by_calculix() -> list[KnownNumber]:
    """Deflections and frequencies of one mesh by both programs."""
    mesh = tetrahedra(_BLOCK.section, _BLOCK.length, 1)
    theirs, their_frequencies = compliance_and_frequencies(mesh, _STEEL, _MODES)
    clamped = clamped_leg(solid_leg(_BLOCK, mesh))
    own, own_frequencies = clamped.compliance, clamped.modes(_MODES).frequencies
    return [
        *_deflections(np.diag(theirs), np.diag(own), 1e-6),
        *_frequencies(their_frequencies, own_frequencies, 5e-4),
    ]


def by_exudyn() -> list[KnownNumber]:
    """Frequencies of a mechanism in a multibody code."""
    at = reference_posture(load_robot("five-bar").mechanism)
    coarse, fine = (frequencies(at, number, _MODES) for number in _ELEMENTS)
    (own,) = answers("beam", [at], _MODES)
    return _frequencies(fine + (fine - coarse) / 3.0, own.frequencies, 1e-5)


def _deflections(known: Array, found: Array, tolerance: float) -> list[KnownNumber]:
    return [
        KnownNumber(f"{name} under a unit force", "m", known[i], found[i], tolerance)
        for i, name in enumerate("xyz")
    ]


def _frequencies(known: Array, found: Array, tolerance: float) -> list[KnownNumber]:
    return [
        KnownNumber(f"f{number}", "Hz", *pair, tolerance)
        for number, pair in enumerate(zip(known, found, strict=True), start=1)
    ]
