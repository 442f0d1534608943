"""Benchmarks with known results, computed on this machine.

Input: none. Output: known and computed numbers of each benchmark. Rule: a number agrees if its
relative difference, less the part due to different theories, is within the tolerance.
MacNeal–Harder's cantilever and NAFEMS FV5 are solved as solids, torsion of rectangles by finite
elements, a hexapod and a CAD part in closed form, a leg by CalculiX and a five-bar by EXUDYN.
Constraints and loads of solids are those of Saint-Venant's theory, averages over the end faces, so
that solid and beam theory differ only by the approximation of beam theory.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from fem.bodies import solid
from fem.bodies.part import grips_of, held_part, meshed_part
from fem.bodies.rooted import RootedBody, rooted_body
from fem.calculix.leg import compliance_and_frequencies
from fem.calculix.run import CalculixMissing
from fem.multibody import ExudynMissing, frequencies
from fem.sections.section_constants import section_constants
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
from meshes.prism import extrude, stations, tetrahedra
from meshes.section.section_mesh import section_mesh
from validation.models.options import ModelOptions
from validation.models.robot_models import answers

TOLERANCE = 1e-3


@dataclass(frozen=True)
class KnownNumber:
    """Known and computed value of one quantity, to be equal within `tolerance` (relative).

    `explained`: part of the relative difference that is due to different theories, such as those of
    beams and solids.
    """

    quantity: str
    unit: str
    known: float
    computed: float
    tolerance: float
    explained: float = 0.0

    @property
    def difference(self) -> float:
        """Computed value minus known value, relative to the known value."""
        return self.computed / self.known - 1.0

    @property
    def agrees(self) -> bool:
        """True if the unexplained difference is within the tolerance. False for NaN."""
        return abs(self.difference - self.explained) <= self.tolerance


@dataclass(frozen=True)
class Benchmark:
    """Problem with a known solution: source, reason of the tolerances, and computation."""

    title: str
    problem: str
    source: str
    tolerance_reason: str
    compare: Callable[[], Sequence[KnownNumber]]


@dataclass(frozen=True)
class BenchmarkOutcome:
    """Result of a benchmark. `message` is the reason if it has no numbers."""

    benchmark: Benchmark
    verdict: Literal["agrees", "differs", "failed", "skipped"]
    numbers: tuple[KnownNumber, ...] = ()
    message: str = ""


def outcome(benchmark: Benchmark) -> BenchmarkOutcome:
    """Outcome of a benchmark. If an exception is raised, it is the `message` of the outcome."""
    try:
        numbers = tuple(benchmark.compare())
    except (CalculixMissing, ExudynMissing) as missing:
        return BenchmarkOutcome(benchmark, "skipped", message=str(missing))
    except Exception as error:  # noqa: BLE001  the libraries of this machine are tested
        return BenchmarkOutcome(benchmark, "failed", message=f"{type(error).__name__}: {error}")
    # A benchmark without numbers proves nothing and does not agree.
    agrees = bool(numbers) and all(number.agrees for number in numbers)
    return BenchmarkOutcome(benchmark, "agrees" if agrees else "differs", numbers)


@dataclass(frozen=True)
class ModeCluster:
    """Modes from number `first` to `last` (from 1) with a common frequency, `target` (Hz)."""

    first: int
    last: int
    target: float
    meaning: str

    def known_number(self, frequencies: Array, explained: float = 0.0) -> KnownNumber:
        """Target frequency, and the frequency of the cluster that is farthest from it.

        `frequencies`: frequencies (Hz) of all modes, ascending. `explained` as in `KnownNumber`.
        """
        cluster = frequencies[self.first - 1 : self.last]
        farthest = float(cluster[np.argmax(np.abs(cluster - self.target))])
        names = f"f{self.first}" + (f" to f{self.last}" if self.last > self.first else "")
        quantity = f"{names}, {self.meaning}"
        return KnownNumber(quantity, "Hz", self.target, farthest, TOLERANCE, explained)


# The density has no effect on statics.
STRAIGHT = ConstantLeg(6.0, Rectangle(0.2, 0.1), Material.isotropic(1e7, 0.3, 1.0))
# Diagonal entry of the tip compliance: index, name, unit and target (m or rad per N or N m).
MACNEAL_TARGETS = (
    (0, "extension under a unit force", "m", 3.0e-5),
    (1, "deflection in the plane of the larger side under a unit force", "m", 0.1081),
    (2, "deflection out of that plane under a unit force", "m", 0.4321),
    (3, "twist under a unit torque", "rad", 0.034109),
)
MACNEAL_HARDER = (
    "R. H. MacNeal, R. L. Harder, Finite Elem. Anal. Des. 1 (1985) 3, straight cantilever beam; "
    "the twist published there, 0.03208, is 6 % below Saint-Venant's T L/GJ = 0.034109, taken here"
)
FV5 = "NAFEMS, The Standard NAFEMS Benchmarks, TNSB rev. 3 (1990), Test FV5"
DEEP = ConstantLeg(10.0, Rectangle(2.0, 2.0), Material.isotropic(2e11, 0.3, 8000.0))
# Modes with target frequencies, and the relative error of beam theory at their wavelength. A test
# computes these errors from the exact waves of the prism.
FV5_MODES = (
    (ModeCluster(1, 2, 42.650, "bending 1"), 1.1453e-3),
    (ModeCluster(3, 3, 71.20, "torsion 1"), -9.4e-6),
    (ModeCluster(4, 4, 125.00, "tension 1"), -7.444e-4),
    (ModeCluster(5, 6, 148.15, "bending 2"), 3.4304e-3),
    (ModeCluster(7, 7, 213.61, "torsion 2"), -8.827e-5),
    (ModeCluster(8, 9, 283.47, "bending 3"), 5.5726e-3),
)
# J/(b h³) of rectangles b × h.
TORSION_CONSTANTS = {
    1.0: 0.140577,
    2.0: 0.228682,
    10.0: 0.312325,
}
TIMOSHENKO = "S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, §109, table of k1, six digits"
# Elements across the smaller side, and slices along the beam per such element, so that the errors
# in both directions are similar.
_STRAIGHT_DIVISIONS, _STRAIGHT_SLICES = 4, 5
_DEEP_DIVISIONS, _DEEP_SLICES = 5, 3
_TORSION_DIVISIONS = 16
_STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
_BLOCK = ConstantLeg(0.4, Rectangle(0.08, 0.12), _STEEL)
_MODES = 3
# Beams per leg. EXUDYN's beams converge with second order, the extrapolation with fourth order.
_ELEMENTS = (4, 8)
# Extents along x, y and z (m), and element size (m).
_BAR, _SIZE = (0.12, 0.04, 0.024), 0.02


def benchmarks() -> tuple[Benchmark, ...]:
    """All benchmarks: solids and sections, a mechanism, a CAD part, and two other programs."""
    return (
        Benchmark(
            "MacNeal–Harder's straight cantilever as a solid",
            "Displacement of the tip of a cantilever of 6 × 0.2 × 0.1 under unit loads. "
            "E = 10⁷, ν = 0.3. The clamped end is free to warp and contract. Quadratic hexahedra, "
            f"{_STRAIGHT_DIVISIONS} across the smaller side.",
            MACNEAL_HARDER,
            "0.1 % of the theory column, which has four digits; the mesh error is up to 0.04 %",
            straight_cantilever,
        ),
        Benchmark(
            "NAFEMS FV5, deep simply supported beam, as a solid",
            "Natural frequencies of a beam of 10 m with a square section of 2 m. E = 200 GPa, "
            "ν = 0.3, ρ = 8000 kg/m³. Deflections are zero at both ends, displacement along and "
            "rotation about the axis at one end, on average over the faces. The number of modes "
            f"is Sturm's count. Quadratic hexahedra, {_DEEP_DIVISIONS} across the side. The "
            "explained part is the error of beam theory for such short waves: the frequency of the "
            "exact 3-D wave of the prism minus that of the wave of the beam.",
            FV5,
            "0.1 % of the theory column, which has four digits; the mesh error is up to 0.04 %",
            deep_beam,
        ),
        Benchmark(
            "Torsion constants of rectangles by finite elements",
            "J/(b h³) of rectangles b × h. Saint-Venant's torsion on meshes of biquadratic "
            f"elements, {_TORSION_DIVISIONS} across the smaller side.",
            TIMOSHENKO,
            "the last of six published digits, and as much again for the mesh",
            lambda: [torsion_constant(ratio) for ratio in TORSION_CONSTANTS],
        ),
        Benchmark(
            "A hexapod as bars between ball joints",
            "Deflection of the platform of the built-in hexapod under unit forces, away from its "
            "reference pose. The legs are beams. Between ball joints their bending has no effect: "
            "only their stretching and the drives matter.",
            "K = Σ k j jᵀ, j = (d, p × d), 1/k = L₁/EA₁ + L₂/EA₂ + 1/k_drive, d along a leg",
            "the values are exact; round-off is amplified by the slenderness of the legs",
            hexapod,
        ),
        Benchmark(
            "A bar drawn and meshed by gmsh, held on average at its ends",
            "Stretching under a unit force, deflection and rotation under a unit moment of a steel "
            "bar of 120 × 40 × 24 mm. Constant and linear tractions cause quadratic displacements. "
            "Second-order tetrahedra represent these exactly on any mesh.",
            "L/EA; L²/2EI; L/EI",
            "the values are exact up to round-off",
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
            "First frequencies of the built-in five-bar in its reference posture. EXUDYN's "
            f"frequencies are extrapolated from {_ELEMENTS[0]} and {_ELEMENTS[1]} beams per leg.",
            "EXUDYN, J. Gerstmayr, Multibody System Dynamics 60 (2024) 617, "
            "geometrically exact beams, linearised",
            "ten times the error of the extrapolation",
            by_exudyn,
        ),
    )


def straight_cantilever() -> list[KnownNumber]:
    """Diagonal of the tip compliance of MacNeal–Harder's cantilever: published, and by a solid."""
    beam = extruded(STRAIGHT, _STRAIGHT_DIVISIONS, _STRAIGHT_SLICES * _STRAIGHT_DIVISIONS)
    compliances = np.diag(solid.clamped_leg(beam, "free").compliance)
    return [
        KnownNumber(quantity, unit, target, float(compliances[component]), TOLERANCE)
        for component, quantity, unit, target in MACNEAL_TARGETS
    ]


def extruded(leg: ConstantLeg, divisions: int, slices: int) -> solid.SolidLeg:
    """Leg as a solid with `divisions` elements across its smaller side and `slices` along it."""
    section = section_mesh(leg.section, divisions)
    return solid.solid_leg(leg, extrude(section, stations(leg.length, slices)))


def deep_beam() -> list[KnownNumber]:
    """Nine frequencies of NAFEMS FV5, and the number of its modes: published, and by a solid.

    The solid's modes are counted by Sylvester's law of inertia.
    """
    beam = extruded(DEEP, _DEEP_DIVISIONS, _DEEP_SLICES * _DEEP_DIVISIONS)
    count = FV5_MODES[-1][0].last
    modes = simply_supported(beam).modes(count)
    counted = KnownNumber("modes up to bending 3", "1", count, modes.count, TOLERANCE)
    return [
        counted,
        *(cluster.known_number(modes.frequencies, explained) for cluster, explained in FV5_MODES),
    ]


def simply_supported(beam: solid.SolidLeg) -> RootedBody:
    """Beam fixed in x, y, z, φx at its root and in y, z at its tip, on average over the faces.

    The averages C are work-conjugate to Saint-Venant's tractions, so that warping, contraction and
    both bending rotations are free. The six constraints are statically determinate. They are scaled
    to L = C (RᵀC)⁻¹, so that LᵀR = I for the rigid motions R.
    """
    free = solid.coupled_leg(beam, "free")
    averages = free.twists[:, [0, 1, 2, 3, 7, 8]]
    constraints = averages @ np.linalg.inv(free.motions.T @ averages)
    return rooted_body(replace(free, twists=constraints), "NAFEMS FV5 as a solid")


def torsion_constant(ratio: float) -> KnownNumber:
    """Torsion constant J/(b h³) of a rectangle with b/h = `ratio`.

    The known number is published, the computed one is by finite elements.
    """
    mesh = section_mesh(Rectangle(ratio, 1.0), _TORSION_DIVISIONS)
    computed = section_constants(mesh, nu=0.0).torsion_constant / ratio
    published = TORSION_CONSTANTS[ratio]
    return KnownNumber(f"J/(b h³), b/h = {ratio:g}", "1", published, computed, 2e-6 / published)


def hexapod() -> list[KnownNumber]:
    """Deflections of the hexapod's platform by beams.

    The known deflections follow from the axial stiffnesses of its legs.
    """
    mechanism = load_robot("hexapod").mechanism
    first_posture = posture(mechanism, mechanism.poses[0])
    computed = answers("beam", [first_posture], 0, ModelOptions(elements=1))
    exact = np.linalg.inv(hexapod_stiffness(mechanism, first_posture.pose))
    return _deflections(np.diag(exact), np.diag(computed.compliances[0]), 1e-8)


def hexapod_stiffness(mechanism: Mechanism, pose: Array) -> Array:
    """Stiffness Σ k j jᵀ (6×6, SI, base axes) of the built-in hexapod at its platform's point.

    Sum over the legs: k is the axial stiffness of a leg, j (6) the wrench of a unit axial force.
    """
    centre = mechanism.reference_pose[:3]
    rotation = Rotation.from_rotvec(pose[3:]).as_matrix()
    drives = {joint.name: joint.drive for joint in mechanism.joints}
    stiffness = np.zeros((6, 6))
    for number in range(1, 7):
        base = mechanism.reference[f"strut{number}"].position
        rod, drive = f"rod{number}", drives[f"drive{number}"]
        tip = mechanism.bodies[rod].interfaces[f"Q{number}"]
        joint = (mechanism.reference[rod] @ tip).position
        end = pose[:3] + rotation @ (joint - centre)
        shapes = [mechanism.bodies[name].shape for name in (f"strut{number}", rod)]
        compliance = sum(
            shape.length / (shape.material.E * shape.section.area)
            for shape in shapes
            if isinstance(shape, ConstantLeg)
        )
        compliance += 1.0 / (drive.stiffness or np.inf) if drive else 0.0
        direction = (end - base) / np.linalg.norm(end - base)
        screw = np.concatenate([direction, np.cross(end - pose[:3], direction)])
        stiffness += np.outer(screw, screw) / compliance
    return stiffness


def bar() -> list[KnownNumber]:
    """Stretching and bending of a bar as a CAD part: known in closed form, and by finite elements.

    gmsh draws the bar, writes it to a file and meshes the part that is read from this file.
    """
    length, width, height = _BAR
    ends = {
        name: PartInterface(ByPlane((sign, 0.0, 0.0), (x, 0.0, 0.0)), "average")
        for name, sign, x in (("A", -1.0, 0.0), ("B", 1.0, length))
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
    clamped = held_part(meshed_part("bar", mesh, _STEEL), grips_of(mesh, interfaces))
    E, I = _STEEL.E, height * width**3 / 12.0
    return [
        KnownNumber(quantity, unit, published, float(clamped.compliance[row, column]), 1e-8)
        for quantity, unit, row, column, published in (
            ("stretching under a unit force", "m", 0, 0, length / (E * width * height)),
            ("deflection under a unit moment", "m", 1, 5, length**2 / (2.0 * E * I)),
            ("rotation under a unit moment", "rad", 5, 5, length / (E * I)),
        )
    ]


def by_calculix() -> list[KnownNumber]:
    """Deflections and frequencies of a clamped leg, by this program and by CalculiX on one mesh."""
    mesh = tetrahedra(_BLOCK.section, _BLOCK.length, 1)
    calculix_compliance, calculix_frequencies = compliance_and_frequencies(mesh, _STEEL, _MODES)
    clamped = solid.clamped_leg(solid.solid_leg(_BLOCK, mesh))
    return [
        *_deflections(np.diag(calculix_compliance), np.diag(clamped.compliance), 1e-6),
        *_frequencies(calculix_frequencies, clamped.modes(_MODES).frequencies, 5e-4),
    ]


def by_exudyn() -> list[KnownNumber]:
    """Frequencies of the built-in five-bar, by this program and by EXUDYN."""
    reference = reference_posture(load_robot("five-bar").mechanism)
    coarse, fine = (frequencies(reference, elements, _MODES) for elements in _ELEMENTS)
    computed = answers("beam", [reference], _MODES)
    return _frequencies(fine + (fine - coarse) / 3.0, computed.frequencies[0], 1e-5)


def _deflections(published: Array, computed: Array, tolerance: float) -> list[KnownNumber]:
    return [
        KnownNumber(f"{name} under a unit force", "m", published[i], computed[i], tolerance)
        for i, name in enumerate("xyz")
    ]


def _frequencies(published: Array, computed: Array, tolerance: float) -> list[KnownNumber]:
    return [
        KnownNumber(f"f{number}", "Hz", *pair, tolerance)
        for number, pair in enumerate(zip(published, computed, strict=True), start=1)
    ]
