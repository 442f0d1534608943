"""Robots at random for the tests of false alarms, and what does not agree on one of them."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from like_ifw import IFW, file_of

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, GivenLeg, Leg, Material
from lumped.mechanism.biglide import Stroke, biglide
from lumped.mechanism.mechanism import Mechanism
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Section, Tube
from validation.case import Case, Skip
from validation.catalogue import catalogue
from validation.context import Context, Preset
from validation.results.outcome import judge

# 12°: where the legs come near to one line the robot is near to a type 2 singularity, its
# compliance grows without bound and rounding with it, beyond what comparisons to 1e-9 can bear.
SMALLEST_ANGLE = 0.2
# Undecided is no alarm of third and fourth frequencies, of which the reference's polynomials leave
# more than the tolerance on a quarter of robots at random, nor of solids on the meshes of quick.
LEFT_OPEN = ("mechanism.anchor.frequencies", "mechanism.solid")
# No case depends on the robot but the paper's own.
CASES = [
    task
    for task in catalogue(replace(IFW, built_in=False, source="random.toml"))
    if isinstance(task, Case)
]
SHAPES = ("rectangle", "hollow-rectangle", "circle", "tube", "i-section")


def between(rng: np.random.Generator, low: float, high: float) -> float:
    """A number from low to high, each fifth of them one of these two."""
    inside = rng.uniform(low, high)
    return float(rng.choice([low, high, inside], p=[0.1, 0.1, 0.8]))


def compliance_of(rng: np.random.Generator, length: float) -> Array:
    """A positive definite 6×6 of the size of a leg's, all its terms coupled."""
    bending = 10.0 ** rng.uniform(-8.0, -6.3)
    sizes = np.sqrt([bending / 50.0, bending, bending, *[3.0 * bending / length**2] * 3])
    shape = rng.standard_normal((6, 6)) * 0.25 + np.eye(6)
    own = shape @ shape.T
    unit = 1.0 / np.sqrt(np.diag(own))
    matrix = own * np.outer(unit * sizes, unit * sizes)
    return 0.5 * (matrix + matrix.T)


def section_of(rng: np.random.Generator, size: float, shape: str) -> Section:
    """A section whose larger side is about `size`."""
    ratio, wall = between(rng, 0.4, 1.0), between(rng, 0.05, 0.2)
    width, height = rng.permutation([size, ratio * size]).tolist()
    thickness = wall * ratio * size
    sections: dict[str, Section] = {
        "rectangle": Rectangle(width, height),
        "hollow-rectangle": HollowRectangle(width, height, thickness),
        "circle": Circle(size),
        "tube": Tube(size, wall * size),
        "i-section": ISection(width, height, thickness, 0.7 * thickness),
    }
    return sections[shape]


def material_of(rng: np.random.Generator) -> Material:
    """Steels to plastics; isotropic, or with a shear modulus of its own."""
    E, nu = 10.0 ** between(rng, 9.5, 11.5), between(rng, 0.0, 0.45)
    material = Material.isotropic(E, nu, between(rng, 1000.0, 8000.0))
    return replace(material, G=float(rng.choice([1.0, 0.6, 1.5])) * material.G)


def leg_of(rng: np.random.Generator, length: float, shape: str | None = None) -> Leg:
    """A matrix and a mass, or a section (of any shape or the one asked for) and a material.

    Slenderness 4 to 15.
    """
    if shape is None and rng.random() < 0.5:
        return GivenLeg(length, between(rng, 5.0, 100.0), compliance_of(rng, length))
    size = length / between(rng, 4.0, 15.0)
    section = section_of(rng, size, shape or str(rng.choice(SHAPES)))
    return ConstantLeg(length, section, material_of(rng))


def stroke_of(rng: np.random.Generator) -> Stroke:
    """Legs that meet and become horizontal at both ends of the stroke, never near to one line."""
    while True:
        first = between(rng, 0.3, 2.0)
        second = first * between(rng, 0.6, 1.6)
        # The slides lie apart between |L1 − L2| and L1 + L2, with a margin on both sides.
        least = abs(first - second)
        a = least + between(rng, 0.15, 0.85) * (first + second - least)
        stroke = Stroke(a, first, second)
        if stroke.faults():
            continue
        legs = (stroke.legs_at(x) for x in np.linspace(*stroke.ends, 41))
        sines = [np.cross(one.rotation[:, 0], two.rotation[:, 0])[2] for one, two in legs]
        if np.abs(sines).min() > SMALLEST_ANGLE:
            return stroke


def robots(count: int, chunk: int, shape: str | None = None) -> list[Mechanism]:
    """As many robots, always the same ones in a chunk, leg 1 of the `shape` asked for."""
    found = []
    for number in range(count):
        rng = np.random.default_rng([chunk, number, SHAPES.index(shape) + 1 if shape else 0])
        stroke = stroke_of(rng)
        foot = compliance_of(rng, 1.0) / 30.0 if rng.random() < 0.5 else None
        tool = compliance_of(rng, 1.0) / 100.0 if rng.random() < 0.5 else None
        robot = biglide(
            name=f"random {chunk}.{number}",
            a=stroke.a,
            platform_mass=between(rng, 5.0, 100.0),
            drive_stiffness=10.0 ** between(rng, 7.0, 9.5),
            leg1=leg_of(rng, stroke.length1, shape),
            leg2=leg_of(rng, stroke.length2),
            tool_offset=np.array([between(rng, -0.2, 0.2) for _ in range(3)]),
            foot_compliance=foot,
            tool_compliance=tool,
        )
        found.append(robot)
    return found


def alarms(robot: Mechanism, groups: Iterable[str], preset: Preset = "quick") -> list[str]:
    """Those of the cases of the groups that do not agree, with what they say."""
    # A name that no case has is a mistake of whoever asks.
    assert set(groups) <= {case.group for case in CASES}
    context = Context(file_of(robot, text="", sha256="", corrections=()), preset)
    found = []
    for case in CASES:
        # Robots of prisms have one kind of virtual joints.
        of_both = "vjm-equivalent" in case.id
        if case.group not in groups or preset not in case.presets or of_both:
            continue
        try:
            outcome = judge(case, case.measure(context), 0.0)
        except Skip:
            continue
        except ComputationError as error:
            found.append(f"{case.id}: {error}")
            continue
        if outcome.verdict == "undecided" and case.id.startswith(LEFT_OPEN):
            continue
        if outcome.verdict != "agree":
            measured = outcome.measurement
            found.append(f"{case.id}: {measured.value} for {measured.reference} {outcome.message}")
    return found
