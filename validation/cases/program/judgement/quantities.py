"""The very numbers that tables show, once more from forces, displacements and energies.

Physical units enter here alone: 1000 N, µm, Hz. A posture's deflections are solved for again as
displacements under that load, whose work must be twice the energy that the parts of the robot hold.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.linalg import eigh

from fem.sections.section_constants import section_constants
from lumped.arrays import Array
from lumped.biglide import Biglide, scaled
from lumped.dense.modes import dense
from lumped.legs import Theory
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Section, Tube
from meshes.section.section_mesh import section_mesh
from validation.agreement.differences import scaled_difference
from validation.cases.program.judgement.claims import claims, same
from validation.context import Context
from validation.models.biglide import robot_system
from validation.models.legs import constant_leg_of
from validation.models.options import ModelName, ModelOptions
from validation.solids.legs import section_counts
from validation.studies.quantities import (
    Deflections,
    deflections_of,
    family_deflections,
    farthest,
    robot_modes,
    stroke_compliances,
    stroke_deflections,
    stroke_frequencies,
)

_FORCE = 1000.0  # N, what tables and figures state
_MICROMETRE = 1e-6
_COUNT = 5
_THEORIES: tuple[Theory, ...] = ("euler-bernoulli", "timoshenko")
# Statics solved twice, by condition of slender legs.
_SAME = 1e-7
_LAW = "Clapeyron's theorem: the work ½ F·u of the load is the strain energy"


@claims("deflections", "Deflections are in µm at 1000 N", "by hand")
def _by_hand(_context: Context) -> Mapping[str, bool]:
    matrix = np.diag([0.0, 0.0, 3e-8, 0.0, 0.0, 0.0])
    matrix[:2, :2] = [[3e-9, 4e-9], [4e-9, 12e-9]]
    found = deflections_of(np.array([matrix, 2.0 * matrix]))
    flat = deflections_of(matrix[None, :2, :2])
    shown = Deflections(np.array([1.0, 5.0]), np.array([2.0, 3.0]), np.array([9.0, 4.0]))
    return {
        "√(3² + 4²) nm/N under fx is 5 µm at 1000 N": same(found.planar_x[0], 5.0),
        "√(4² + 12²) nm/N under fy": same(found.planar_y[0], np.sqrt(160.0)),
        "30 nm/N along z is 30 µm": same(found.along_z[0], 30.0),
        "twice as soft": same(found.planar_x[1], 10.0) and same(found.along_z[1], 60.0),
        "no z in the plane": same(flat.planar_x[0], 5.0) and bool(np.isnan(flat.along_z[0])),
        "largest planar": same(shown.largest_planar, 5.0),
        # 4 nm/N beside √(1 · 4) nm/N.
        "largest entry of a difference": same(
            scaled_difference(np.array([[1.0, 4.0], [4.0, 4.0]]), np.diag([1.0, 4.0])), 2.0
        ),
        "largest of both loads": same(found.largest_planar, 2.0 * np.sqrt(160.0)),
    }


@claims("farthest", "The posture shown is the one that is farthest off", "by hand")
def _farthest(_context: Context) -> Mapping[str, bool]:
    even = np.array([2.0, 4.0, 8.0, 16.0])
    return {
        f"{off:+} % at {place + 1} of 4": farthest(even * (1.0 + 0.01 * off * at), even) == place
        for off in (1.0, -1.0)
        for place in range(4)
        for at in [np.where(np.arange(4) == place, 1.0, 0.5)]
    }


@claims(
    "farthest-stroke",
    "So it is of deflections over the stroke with and without shear",
    "all postures, one after the other",
)
def _farthest_over_stroke(context: Context) -> Mapping[str, bool]:
    stiff, soft = (
        stroke_deflections("vjm", context.robot, _COUNT, ModelOptions("equivalent", theory))
        for theory in _THEORIES
    )
    claims = {}
    for curve in ("planar_x", "planar_y", "along_z"):
        for end, step in (("left", 1), ("right", -1)):
            one, other = getattr(stiff, curve)[::step], getattr(soft, curve)[::step]
            off = [abs(a - b) / b for a, b in zip(one.tolist(), other.tolist(), strict=True)]
            claims[f"{curve} from the {end}"] = off[farthest(one, other)] >= max(off) - _SAME
    return claims


@claims(
    "deflections-work",
    "The deflections shown are displacements, and their work is the energy of the parts",
    _LAW,
)
def _work(context: Context) -> Mapping[str, bool]:
    robot = context.robot
    shown = stroke_deflections("beam", robot, _COUNT)
    tables = deflections_of(stroke_compliances("beam", robot, _COUNT))
    planar = [*shown.planar_x.tolist(), *shown.planar_y.tolist()]
    rng = np.random.default_rng(17)
    matrix = rng.standard_normal((6, 6))
    unit = np.diag(rng.uniform(1.0, 2.0, 6))
    entries = [
        abs(matrix[i, j]) / np.sqrt(unit[i, i] * unit[j, j]) for i in range(6) for j in range(6)
    ]
    claims = {
        "the largest planar": _close(shown.largest_planar, sorted(planar)[-1]),
        "the largest planar, loads exchanged": _close(
            replace(shown, planar_x=shown.planar_y, planar_y=shown.planar_x).largest_planar,
            sorted(planar)[-1],
        ),
        "the largest entry": _close(scaled_difference(unit + matrix, unit), sorted(entries)[-1]),
    }
    for number, x in enumerate(_stations(robot)):
        whole = robot_system("beam", robot, x)
        stiffness, loaded = dense(whole.stiffness), whole.tool
        for axis, curve in enumerate(("planar_x", "planar_y", "along_z")):
            force = np.zeros(6)
            force[axis] = _FORCE
            motion = np.linalg.solve(stiffness, loaded.T @ force)
            moved = (loaded @ motion) / _MICROMETRE
            size = float(abs(moved[2]) if axis == 2 else np.hypot(moved[0], moved[1]))
            energy = float(motion @ (stiffness @ motion))
            work = float(_FORCE * moved[axis] * _MICROMETRE)
            place = f"{curve} at x = {x:.4g} m"
            claims[place] = _close(getattr(shown, curve)[number], float(size))
            claims[f"{place}, of compliances"] = _close(getattr(tables, curve)[number], size)
            claims[f"{place}, work"] = _close(work, energy)
    return claims


@claims(
    "simplified",
    "The simplified model's deflections over the stroke follow from geometry and K",
    "eqs (1), (2): virtual power of the drives, solved posture by posture",
)
def _simplified(context: Context) -> Mapping[str, bool]:
    robot = context.robot
    shown = stroke_deflections("simplified", robot, _COUNT)
    claims = {
        f"x = {x:.4g} m": _close(shown.planar_x[number], np.hypot(*moved[:, 0]), 1e-5)
        and _close(shown.planar_y[number], np.hypot(*moved[:, 1]), 1e-5)
        for number, x in enumerate(_stations(robot))
        for moved in [_on_drives(robot, x)]
    }
    alphas = (1.0, 1.3)
    family = family_deflections("simplified", robot, alphas, 0.25)
    for place, alpha in enumerate(alphas):
        member = scaled(robot, alpha)
        first, last = member.stroke
        moved = _on_drives(member, first + 0.25 * (last - first))
        claims[f"α = {alpha}"] = _close(family.planar_x[place], np.hypot(*moved[:, 0]), 1e-5)
        claims[f"α = {alpha}, y"] = _close(family.planar_y[place], np.hypot(*moved[:, 1]), 1e-5)
    return claims


def _on_drives(robot: Biglide, x: float) -> Array:
    """Displacements (µm, 2×2) of B under 1000 N along x and along y: legs rigid, drives elastic.

    A slide at (p, y_A) with |B − A| = L: (x − p) δx + s (δy − δy_A) = 0, s the leg's height.
    """
    heights = np.array(
        [
            np.sqrt(max(robot.leg1.length**2 - x**2, 0.0)),
            np.sqrt(max(robot.leg2.length**2 - (robot.a - x) ** 2, 0.0)),
        ]
    )
    of_b = np.column_stack([[x, x - robot.a], heights])
    from_slides = np.linalg.solve(of_b, np.diag(heights))
    return from_slides @ from_slides.T / robot.actuator_stiffness * _FORCE / _MICROMETRE


@claims(
    "family",
    "Members of the family are looked at where they say",
    "the same with other lengths, at other fractions of the stroke",
)
def _family(context: Context) -> Mapping[str, bool]:
    robot = context.robot
    member = scaled(robot, 1.4)
    feet = (member.foot_compliance, robot.foot_compliance)
    claims = {
        "feet stay as they are": bool(np.array_equal(np.asarray(feet[0]), np.asarray(feet[1]))),
        "the stroke stays as long": same(member.stroke_length, robot.stroke_length),
        "both legs are longer": same(member.leg1.length, 1.4 * robot.leg1.length)
        and same(member.leg2.length, 1.4 * robot.leg2.length),
    }
    for fraction in (0.1, 0.8):
        found = family_deflections("simplified", robot, (1.1, 1.25), fraction)
        for place, alpha in enumerate((1.1, 1.25)):
            member = scaled(robot, alpha)
            first, last = member.stroke
            moved = _on_drives(member, first + fraction * (last - first))
            claims[f"α = {alpha} at {fraction} of the stroke"] = _close(
                found.planar_x[place], np.hypot(*moved[:, 0]), 1e-5
            ) and _close(found.planar_y[place], np.hypot(*moved[:, 1]), 1e-5)
    return claims


@claims("modes-segments", "So are those of segments", "f = √(uᵀKu / uᵀMu) / 2π")
def _modes_of_segments(context: Context) -> Mapping[str, bool]:
    return _modes(context, "segments")


@claims(
    "modes",
    "Frequencies shown are Rayleigh's quotients in Hz, shares of energy sum to one",
    "f = √(uᵀKu / uᵀMu) / 2π",
)
def _modes_of_beam(context: Context) -> Mapping[str, bool]:
    return _modes(context, "beam")


def _modes(context: Context, model: ModelName) -> Mapping[str, bool]:
    robot = context.robot
    shown = stroke_frequencies(model, robot, _COUNT, 4)
    claims = {}
    for number, x in enumerate(_stations(robot)):
        whole = robot_system(model, robot, x)
        stiffness, mass = dense(whole.stiffness), dense(whole.mass)
        # 1/ω² of M against K: bodies without mass have none.
        squares = eigh(mass, stiffness, eigvals_only=True)[::-1][:4]
        wanted = 1.0 / (2.0 * np.pi * np.sqrt(squares))
        claims[f"four frequencies at x = {x:.4g} m"] = bool(
            np.allclose(shown[number], wanted, rtol=1e-5)
        )
    found = robot_modes(model, robot, robot.centre, 4)
    strain, kinetic = sum(found.strain.values()), sum(found.kinetic.values())
    shapes, whole = found.modes.shapes, found.system
    quotients = np.sum(shapes * (dense(whole.stiffness) @ shapes), axis=0) / np.sum(
        shapes * (dense(whole.mass) @ shapes), axis=0
    )
    moved = np.square((whole.tool @ shapes)[:3]) * robot.platform_mass
    return claims | {
        "strain shares sum to one": bool(np.allclose(strain, 1.0)),
        "kinetic shares sum to one": bool(np.allclose(kinetic, 1.0)),
        "Rayleigh's quotients": bool(
            np.allclose(np.sqrt(quotients) / (2.0 * np.pi), found.modes.frequencies, rtol=1e-6)
        ),
        "no mode moves the platform with more energy than all": bool(
            np.all(moved.sum(axis=0) <= 1.0 + 1e-6)
        ),
        "shares are of energies": bool(
            np.all(np.array(list(found.strain.values())) >= -1e-9)
            and np.all(np.array(list(found.kinetic.values())) >= 0.0)
        ),
    }


@claims(
    "section-meshes",
    "Meshes of the run's own sections have the area and moments of their outlines",
    "closed forms of rectangles and circles, added and taken off",
)
def _own_sections(context: Context) -> Mapping[str, bool]:
    claims: dict[str, bool] = {}
    for number in (1, 2):
        leg = constant_leg_of(context, number)
        mesh = section_mesh(leg.section, section_counts(leg, 4))
        found = section_constants(mesh, leg.material.nu)
        area, about_y, about_z = outline_moments(leg.section)
        round_section = isinstance(leg.section, Circle | Tube)
        # Curved elements follow an arc to a ten-thousandth.
        share = 1e-3 if round_section else 1e-9
        claims |= {
            f"leg {number}: area": _close(found.area, area, share),
            f"leg {number}: about y": _close(found.second_moment_y, about_y, share),
            f"leg {number}: about z": _close(found.second_moment_z, about_z, share),
            f"leg {number}: beam's EA": _close(leg.timoshenko.EA, leg.material.E * area),
            f"leg {number}: beam's EIy": _close(leg.timoshenko.EIy, leg.material.E * about_y),
            f"leg {number}: beam's EIz": _close(leg.timoshenko.EIz, leg.material.E * about_z),
            f"leg {number}: mass": _close(leg.mass, leg.material.rho * area * leg.length),
        }
    return claims


def outline_moments(section: Section) -> tuple[float, float, float]:
    """Area, ∫z² dA and ∫y² dA (SI) from the outline: rectangles and circles added and taken off."""
    match section:
        case Rectangle(width=b, height=h):
            parts = [(1, b, h)]
        case HollowRectangle(width=b, height=h, thickness=t):
            parts = [(1, b, h), (-1, b - 2 * t, h - 2 * t)]
        case ISection(width=b, height=h, flange=f, web=w):
            # The whole block less what is open on both sides of the web.
            area = 2.0 * b * f + w * (h - 2.0 * f)
            about_y = (b * h**3 - (b - w) * (h - 2.0 * f) ** 3) / 12.0
            about_z = (2.0 * f * b**3 + (h - 2.0 * f) * w**3) / 12.0
            return area, about_y, about_z
        case Circle(diameter=d):
            return np.pi * d**2 / 4.0, np.pi * d**4 / 64.0, np.pi * d**4 / 64.0
        case Tube(diameter=d, thickness=t):
            inner = d - 2.0 * t
            moment = np.pi * (d**4 - inner**4) / 64.0
            return np.pi * (d**2 - inner**2) / 4.0, moment, moment
    return (
        sum(sign * b * h for sign, b, h in parts),
        sum(sign * b * h**3 / 12.0 for sign, b, h in parts),
        sum(sign * h * b**3 / 12.0 for sign, b, h in parts),
    )


def _stations(robot: Biglide) -> list[float]:
    first, last = robot.stroke
    return [first + (last - first) * k / (_COUNT - 1) for k in range(_COUNT)]


def _close(found: float, wanted: float, share: float = _SAME) -> bool:
    return bool(abs(found - wanted) <= share * abs(wanted) + 1e-12 * share)
