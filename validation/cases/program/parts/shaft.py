"""A conical shaft, oblique in its file: every way to a part beside its own integrals.

Rod theory of a cone leaves out the square of its slope, 2e-4 here. One end's point lies beside the
axis, so that every transport of a twist or a wrench has a number to be wrong in.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType

import numpy as np

from lumped.arrays import Array
from lumped.legs import Material
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.part import ByPlane, PartInterface
from lumped.robot_file import load_robot
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from validation.agreement.differences import farthest_off, refined, scaled_difference
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.parts.drawing import SECTION, meshed
from validation.context import PRESETS, Context
from validation.models.mechanism import answers
from validation.models.options import ModelName, ModelOptions, PartLegs
from validation.parts.identify import Identified, identify

_STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
_LENGTH, _ROOT, _TIP = 0.4, 0.030, 0.024
_START = np.array([0.05, -0.02, 0.03])
_ALONG = np.array([0.8, 0.48, 0.36])
# The second point, beside the axis.
_END = _START + _LENGTH * _ALONG + np.array([0.0, 0.03, -0.04])
_POINTS = {"A": _START, "B": _END}
# Meshes given as files: size (mm) and sides of a circle; numbers change with the square of the size
# and faster.
_RATIO, _ORDER = np.sqrt(2.0), 2.0
# Arcs through three points leave the fourth power of their length.
_OF_ARCS = 4.0
_SIZE = 30.0
_SIDES = (8.0, 8.0 * _RATIO)
# Stiffness (N m/rad) of the crank's drive and mass (kg) at its tip, a thousand times the shaft's.
_DRIVE, _TIP_MASS = 4e5, 5000.0
_ANGLE = 0.7
# (r/L)² = 4.6e-3.
_ROD = 1.5e-3
_RODS = (
    "ends take up shear evenly, as Saint-Venant's solution does not: a third of (r/L)²; rod "
    "theory leaves out the square of the slope, 2e-4"
)
_INTEGRAL = "∫Lᵀ diag(1/EA, 1/κGA, 1/κGA, 1/GJ, 1/EI, 1/EI) L ds over the drawing, κ by Cowper 1966"

cases = CaseGroup(
    section=SECTION,
    group="program.parts.shaft",
    quantity="largest relative difference",
    unit="1",
    reference_kind="closed-form",
    presets=("standard", "fine"),
    effort=2.0,
    subject="program",
)
_MODELS: tuple[tuple[ModelName, PartLegs], ...] = (
    ("links", "condensed"),
    ("vjm", "equivalent"),
    ("segments", "condensed"),
    ("solid", "condensed"),
)


def identified(sides: float) -> Identified:
    """By its averaged ends, from a mesh in mm with so many sides of a circle."""
    with TemporaryDirectory(prefix="shaft-") as folder:
        # What is identified is kept by the content of its file.
        part = read_part(meshed(Path(folder) / "shaft.msh", _drawn, _SIZE, sides), "mm")
        return identify(part, find_interfaces(part, _ends(), _POINTS), _STEEL, modes=0)


def _drawn(kernel: ModuleType) -> None:
    start, along = 1e3 * _START, 1e3 * _LENGTH * _ALONG
    kernel.addCone(*start, *along, 1e3 * _ROOT, 1e3 * _TIP)


def _plane(way: float, place: Array) -> PartInterface:
    x, y, z = (way * _ALONG).tolist()
    px, py, pz = place.tolist()
    return PartInterface(ByPlane((x, y, z), (px, py, pz)), "average")


def _ends() -> dict[str, PartInterface]:
    return {"A": _plane(-1.0, _START), "B": _plane(1.0, _START + _LENGTH * _ALONG)}


@dataclass(frozen=True, eq=False)
class _Disc:
    """A section of the drawing: where its centre is (3, m), radius, and its share of the length."""

    place: Array
    radius: float
    length: float

    @property
    def area(self) -> float:
        return float(np.pi * self.radius**2)

    @property
    def moment(self) -> float:
        return float(np.pi / 4.0 * self.radius**4)

    def gives(self) -> Array:
        """Strains (6×6) for a force and a moment at its centre, file axes."""
        E, G, nu = _STEEL.E, _STEEL.G, _STEEL.nu
        kappa = 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu)
        along = np.outer(_ALONG, _ALONG)
        across = np.eye(3) - along
        stretch = along / (E * self.area) + across / (kappa * G * self.area)
        turn = along / (2.0 * G * self.moment) + across / (E * self.moment)
        return np.block([[stretch, np.zeros((3, 3))], [np.zeros((3, 3)), turn]])


def _discs(places: Array, lengths: Array) -> list[_Disc]:
    """Sections at `places` of the length, each for so much of it (m)."""
    return [
        _Disc(_START + s * _LENGTH * _ALONG, _ROOT + s * (_TIP - _ROOT), length)
        for s, length in zip(places, lengths, strict=True)
    ]


def _all() -> list[_Disc]:
    """Gauss points: the integrands are smooth, twelve leave rounding."""
    points, weights = np.polynomial.legendre.leggauss(12)
    return _discs((points + 1.0) / 2.0, weights * _LENGTH / 2.0)


def _cross(r: Array) -> Array:
    return np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])


def _carried(r: Array) -> Array:
    """A wrench at a point, seen from another from which that point is at `r`."""
    return np.block([[np.eye(3), np.zeros((3, 3))], [_cross(r), np.eye(3)]])


def _sum(discs: Sequence[_Disc]) -> Array:
    """Compliance (6×6, file axes) at the second point with the first end held."""
    found = np.zeros((6, 6))
    for disc in discs:
        lever = _carried(_END - disc.place)
        found += disc.length * lever.T @ disc.gives() @ lever
    return found


def _weight() -> tuple[float, Array, Array]:
    """Mass (kg), centre (3) and inertia (3×3, kg m²) about it, of the drawing."""
    discs = _all()
    masses = np.array([_STEEL.rho * disc.area * disc.length for disc in discs])
    places = np.array([disc.place for disc in discs])
    total = float(masses.sum())
    centre = masses @ places / total
    # A disc's inertia about a diameter is half of that about its axis.
    inertia = np.zeros((3, 3))
    for disc, mass in zip(discs, masses, strict=True):
        away = disc.place - centre
        inertia += mass * disc.radius**2 / 4.0 * (np.eye(3) + np.outer(_ALONG, _ALONG))
        inertia -= mass * _cross(away) @ _cross(away)
    return total, centre, inertia


@cases.case(
    "program.parts.shaft.compliance",
    "A conical shaft has the compliance of its sections",
    citation=_INTEGRAL,
    tolerance=Absolute(_ROD),
    tolerance_reason=_RODS,
)
def _compliance(context: Context) -> Measurement:
    expected = _sum(_all())
    apart = (
        scaled_difference(context.get(identified, sides).compliance, expected) for sides in _SIDES
    )
    return refined(*apart, order=_ORDER, ratio=_RATIO)


@cases.case(
    "program.parts.shaft.mass",
    "Read as a mesh in millimetres it has the drawing's mass, centre and inertia",
    citation="integrals over its discs",
    tolerance=Absolute(5e-4),
    tolerance_reason="circles of a dozen curved sides",
)
def _mass(context: Context) -> Measurement:
    total, centre, inertia = _weight()
    off = []
    for sides in _SIDES:
        found = context.get(identified, sides)
        apart = [
            abs(found.total / total - 1.0),
            np.abs(found.centre - centre).max() / _LENGTH,
            np.abs(found.inertia - inertia).max() / np.abs(inertia).max(),
        ]
        off.append(float(max(apart)))
    return refined(*off, order=_OF_ARCS, ratio=_RATIO)


# What holds on every mesh: in every preset, on the coarse one.
_on_any_mesh = cases.family(
    tolerance=Absolute(1e-9),
    tolerance_reason="rounding, grown by the condition of a slender part",
    presets=PRESETS,
    effort=0.5,
)


@_on_any_mesh.case(
    "program.parts.shaft.swing",
    "Condensed on its ends it has the momentum of its own mass, centre and inertia",
    citation="seen from the first end, by the parallel axes",
)
def _swing(context: Context) -> Measurement:
    found, rigid = context.get(identified, _SIDES[0]), _moved_rigidly()
    total = found.total * np.eye(3)
    own = np.block([[total, np.zeros((3, 3))], [np.zeros((3, 3)), found.inertia]])
    arm = _carried(found.centre - _START)
    return farthest_off(scaled_difference(rigid.T @ found.mass @ rigid, arm @ own @ arm.T))


@_on_any_mesh.case(
    "program.parts.shaft.rest",
    "Condensed on its ends it resists no rigid motion",
    quantity="largest force of a rigid motion in units of those of one end's",
    citation="no strain, no forces between the ends",
)
def _rest(context: Context) -> Measurement:
    stiffness = context.get(identified, _SIDES[0]).stiffness
    left = np.abs(stiffness @ _moved_rigidly()).max() / np.abs(stiffness).max()
    return Measurement(float(left), 0.0, exact=True)


@_on_any_mesh.case(
    "program.parts.shaft.bracket",
    "Held in more ways by rigid ends than by averaged ones it gives no more in any direction",
    quantity="most by which a direction gives more, in units of √(c_ii c_jj)",
    citation="constraints take from what gives (Rayleigh)",
)
def _bracket(context: Context) -> Measurement:
    found = context.get(identified, _SIDES[0])
    scale = np.sqrt(np.diag(found.compliance))
    least = np.linalg.eigvalsh(found.compliance_bracket / np.outer(scale, scale))[0]
    return Measurement(max(-float(least), 0.0), 0.0, exact=True)


def _moved_rigidly() -> Array:
    """Twists (12×6) of both ends by the six rigid motions about the first."""
    return np.vstack([np.eye(6), _carried(_END - _START).T])


@dataclass(frozen=True, eq=False)
class Crank:
    """The shaft as a crank on a drive, turned from its reference, on one mesh.

    `compliance` (6×6, SI, base axes) by model, `frequencies` (Hz) condensed.
    """

    compliance: dict[ModelName, Array]
    frequencies: Array


def crank(sides: float) -> Crank:
    """The shaft's mesh, read in mm, in a robot file."""
    with TemporaryDirectory(prefix="shaft-") as folder:
        meshed(Path(folder) / "shaft.msh", _drawn, _SIZE, sides)
        file = Path(folder) / "crank.toml"
        file.write_text(_robot(), encoding="utf-8")
        mechanism = load_robot(file).mechanism
        at = posture(mechanism, mechanism.poses[0])
        found = {
            model: answers(model, [at], 0, ModelOptions(parts=parts))[0].compliance
            for model, parts in _MODELS
        }
        (moving,) = answers("segments", [at], 3, ModelOptions(parts="condensed"))
    return Crank(found, moving.frequencies)


def _plane_of(way: float, place: Array) -> str:
    normal, point = (v.tolist() for v in (way * _ALONG, place))
    return f'{{ plane = {{ normal = {normal}, point = {point} }}, coupling = "average" }}'


def _robot() -> str:
    start, end = (v.tolist() for v in (_START, _END))
    return f"""
schema = 2
name = "crank"

[points]
A = {start}
B = {end}

[bodies.shaft]
mesh = "shaft.msh"
unit = "mm"
material = {{ E = {_STEEL.E}, nu = {_STEEL.nu}, rho = {_STEEL.rho} }}

[bodies.shaft.interfaces]
A = {_plane_of(-1.0, _START)}
B = {_plane_of(1.0, _START + _LENGTH * _ALONG)}

[joints.A]
type = "revolute"
between = ["ground", "shaft"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = {{ stiffness = {_DRIVE} }}

[tool]
body = "shaft"
point = "B"
moves = ["phi_z"]
mass = {_TIP_MASS}

[path]
from = [{_ANGLE}]
to = [{_ANGLE}]
count = 1
"""


def _crank_by_hand() -> Array:
    """Compliance (6×6, base axes) of tool's point: the shaft turned, and its drive."""
    c, s = np.cos(_ANGLE), np.sin(_ANGLE)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    D = np.kron(np.eye(2), R)
    upright = np.array([0.0, 0.0, 1.0])
    swing = np.concatenate([np.cross(upright, R @ (_END - _START)), upright])
    return np.asarray(D @ _sum(_all()) @ D.T + np.outer(swing, swing) / _DRIVE)


@cases.case(
    lambda model, parts: (
        f"program.parts.shaft.crank.{model}{'.condensed' * (parts == 'condensed')}"
    ),
    "As the crank of a robot it gives as much as its drive and its sections ({model})",
    over={"model, parts": _MODELS},
    model="",
    citation=f"{_INTEGRAL}, turned, and the drive's angle",
    tolerance=Absolute(_ROD),
    tolerance_reason=_RODS,
)
def _crank(context: Context, model: ModelName) -> Measurement:
    expected = _crank_by_hand()
    apart = (scaled_difference(context.get(crank, s).compliance[model], expected) for s in _SIDES)
    return refined(*apart, order=_ORDER, ratio=_RATIO)


@cases.case(
    "program.parts.shaft.crank.frequencies",
    "A heavy mass on the crank swings on the crank's own springs",
    citation="ω² = eigenvalues of C⁻¹/m, C the translations' compliance; the shaft's mass is left "
    "out, a thousandth",
    tolerance=Absolute(2e-3),
    tolerance_reason="the shaft's own mass, at most half of a thousandth in frequency, and rod "
    "theory",
)
def _frequencies(context: Context) -> Measurement:
    springs = np.linalg.eigvalsh(_crank_by_hand()[:3, :3])[::-1]
    expected = 1.0 / (2.0 * np.pi * np.sqrt(_TIP_MASS * springs))
    found = (context.get(crank, sides).frequencies for sides in _SIDES)
    off = (np.abs(one / expected - 1.0).max() for one in found)
    return refined(*off, order=_ORDER, ratio=_RATIO)
