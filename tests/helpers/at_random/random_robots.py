"""Robots at random for the tests of false alarms, and what does not agree on one of them."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import Phase, assume, given, seed, settings
from hypothesis import strategies as st
from hypothesis.internal.conjecture import providers
from like_ifw import IFW, file_of

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


def compliance_of(rng: np.random.Generator, length: float) -> np.ndarray:
    """A positive definite 6×6 of the size of a leg's, all its terms coupled."""
    bending = 10.0 ** rng.uniform(-8.0, -6.3)
    sizes = np.sqrt([bending / 50.0, bending, bending, *[3.0 * bending / length**2] * 3])
    shape = rng.standard_normal((6, 6)) * 0.25 + np.eye(6)
    own = shape @ shape.T
    unit = 1.0 / np.sqrt(np.diag(own))
    matrix = own * np.outer(unit * sizes, unit * sizes)
    return 0.5 * (matrix + matrix.T)


SHAPES = ("rectangle", "hollow-rectangle", "circle", "tube", "i-section")


@st.composite
def sections(draw: st.DrawFn, size: float, shape: str) -> Section:
    """A section whose larger side is about `size`."""
    ratio = draw(st.floats(0.4, 1.0))
    wall = draw(st.floats(0.05, 0.2))
    width, height = draw(st.permutations([size, ratio * size]))
    thickness = wall * ratio * size
    match shape:
        case "rectangle":
            return Rectangle(width, height)
        case "hollow-rectangle":
            return HollowRectangle(width, height, thickness)
        case "circle":
            return Circle(size)
        case "tube":
            return Tube(size, wall * size)
        case _:
            return ISection(width, height, thickness, 0.7 * thickness)


@st.composite
def materials(draw: st.DrawFn) -> Material:
    """Steel to plastics; isotropic, or with a shear modulus of its own."""
    E = 10.0 ** draw(st.floats(9.5, 11.5))
    nu = draw(st.floats(0.0, 0.45))
    material = Material.isotropic(E, nu, draw(st.floats(1000.0, 8000.0)))
    factor = draw(st.sampled_from([1.0, 0.6, 1.5]))
    return Material(E, factor * material.G, nu, material.rho)


@st.composite
def legs(draw: st.DrawFn, length: float, shape: str | None = None) -> Leg:
    """A matrix and a mass, or a section (of any shape or the one asked for) and a material.

    Slenderness 4 to 15.
    """
    if shape is None and draw(st.booleans()):
        rng = np.random.default_rng(draw(st.integers(0, 2**32)))
        return GivenLeg(length, draw(st.floats(5.0, 100.0)), compliance_of(rng, length))
    size = length / draw(st.floats(4.0, 15.0))
    shape = shape or draw(st.sampled_from(SHAPES))
    return ConstantLeg(length, draw(sections(size, shape)), draw(materials()))


def smallest_angle(stroke: Stroke) -> float:
    """Sine of the smallest angle between the legs over the stroke."""
    legs = (stroke.legs_at(x) for x in np.linspace(*stroke.ends, 41))
    return min(abs(np.cross(one.rotation[:, 0], two.rotation[:, 0])[2]) for one, two in legs)


@st.composite
def robots(draw: st.DrawFn, shape: str | None = None) -> Mechanism:
    """Robots whose legs meet and become horizontal at both ends of the stroke.

    Leg 1 of the `shape` asked for.
    """
    first = draw(st.floats(0.3, 2.0))
    second = first * draw(st.floats(0.6, 1.6))
    # The slides lie apart between |L1 − L2| and L1 + L2, with a margin on both sides.
    share = draw(st.floats(0.15, 0.85))
    a = abs(first - second) + share * (first + second - abs(first - second))
    stroke = Stroke(a, first, second)
    assume(not stroke.faults() and smallest_angle(stroke) > SMALLEST_ANGLE)
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    foot = compliance_of(rng, 1.0) / 30.0 if draw(st.booleans()) else None
    tool = compliance_of(rng, 1.0) / 100.0 if draw(st.booleans()) else None
    offset = draw(st.tuples(*[st.floats(-0.2, 0.2)] * 3))
    return biglide(
        name="random",
        a=a,
        platform_mass=draw(st.floats(5.0, 100.0)),
        drive_stiffness=10.0 ** draw(st.floats(7.0, 9.5)),
        leg1=draw(legs(first, shape)),
        leg2=draw(legs(second)),
        tool_offset=np.array(offset),
        foot_compliance=foot,
        tool_compliance=tool,
    )


def alarms(robot: Mechanism, chosen: Iterable[Case], preset: Preset = "quick") -> list[str]:
    """Those of the cases that do not agree, with what they say."""
    context = Context(file_of(robot, text="", sha256="", corrections=()), preset)
    found = []
    for case in chosen:
        if preset not in case.presets:
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


def of_groups(groups: tuple[str, ...]) -> list[Case]:
    """The cases of the groups; a name that no case has is a mistake in this file."""
    assert set(groups) <= {case.group for case in CASES}
    # Robots of prisms have one kind of virtual joints.
    return [case for case in CASES if case.group in groups and "vjm-equivalent" not in case.id]


def shown(strategy: st.SearchStrategy[Mechanism], number: int, chunk: int = 0) -> list[Mechanism]:
    """As many robots, always the same ones, whatever modules are loaded.

    Hypothesis mixes constants into what it draws that it reads off the sources of loaded modules.
    """
    found: list[Mechanism] = []

    @seed(chunk)
    @settings(max_examples=number, database=None, phases=(Phase.generate,), deadline=None)
    @given(strategy)
    def collect(chosen: Mechanism) -> None:
        found.append(chosen)

    none = property(lambda _: providers.Constants())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(providers, "CONSTANTS_CACHE", type(providers.CONSTANTS_CACHE)(1024))
        patch.setattr(providers.HypothesisProvider, "_local_constants", none)
        collect()
    return found
