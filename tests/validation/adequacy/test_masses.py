"""Where the mass of a leg known by its 6×6 may lie: rigid motions by hand, and a prism's own."""

from dataclasses import replace

import numpy as np
import pytest
from like_ifw import LEG1, LEG2, file_of, like_ifw

from fem.beams.beam import beam_leg
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.arrays import Array, dense
from lumped.legs import ConstantLeg, GivenLeg, Material, equivalent_leg, tip_compliance
from lumped.mechanism.mechanism import Mechanism
from lumped.screws import shift
from lumped.sections import Rectangle
from validation.adequacy.mechanism.dynamics import mass_notes
from validation.adequacy.mechanism.path import RobotOnPath, robot_on_path
from validation.adequacy.mechanism.vibration import modes_by_model, modes_of_solids
from validation.adequacy.response import Alternative, Reference, Response
from validation.context import Context
from validation.models.loads.leg_masses import (
    MASSES,
    Masses,
    leg_with_masses,
    plausible_masses,
)
from validation.models.options import DEFAULT_OPTIONS

WIDTH, HEIGHT = 0.06, 0.04
PRISM = ConstantLeg(0.8, Rectangle(WIDTH, HEIGHT), Material.isotropic(2.1e11, 0.3, 7850.0))
# Without shear deformation a 6×6 is that of its equivalent leg.
GIVEN = GivenLeg(
    PRISM.length, PRISM.mass, tip_compliance(PRISM.properties("euler-bernoulli"), PRISM.length)
)
HIGHEST = 2000.0
# Of mass m over a length L without thickness: centre in L, and inertia about it in m L².
SLENDER: dict[Masses, tuple[float, float]] = {
    "mass along the legs": (1 / 2, 1 / 12),
    "mass near the roots": (1 / 3, 1 / 18),
    "mass near the tips": (2 / 3, 1 / 18),
    "mass half at the ends": (1 / 2, 1 / 24 + 1 / 8),
    "mass in lumps": (1 / 2, 0.0),
}


def rigid_inertia(leg: GivenLeg, masses: Masses) -> tuple[float, float, Array]:
    """Mass (kg), centre (m from the root), and inertia (3×3, kg m²) about it, of rigid motions."""
    matrices = leg_with_masses(leg, masses, HIGHEST)
    motions = np.zeros((matrices.size, 6))
    motions[:6], motions[6:12] = np.eye(6), shift(np.array([leg.length, 0.0, 0.0]))
    forces = dense(matrices.stiffness) @ motions
    assert np.abs(forces).max() < 1e-9 * np.abs(dense(matrices.stiffness)).max()
    spatial = motions.T @ (matrices.mass @ motions)
    mass, centre = spatial[0, 0], spatial[1, 5] / spatial[1, 1]
    arm = np.array([centre, 0.0, 0.0])
    about_centre = np.linalg.inv(shift(arm)).T @ spatial @ np.linalg.inv(shift(arm))
    return mass, centre, about_centre[3:, 3:]


@pytest.mark.parametrize("masses", MASSES)
def test_mass_centre_and_inertia_are_those_of_the_drawing(masses: Masses) -> None:
    mass, centre, inertia = rigid_inertia(GIVEN, masses)
    expected, squared = SLENDER[masses]
    assert mass == pytest.approx(PRISM.mass, rel=1e-9)
    assert centre == pytest.approx(expected * PRISM.length, rel=1e-9)
    # Sections have rotary inertia of their own, ρ(I_y + I_z), ρI_y and ρI_z per length.
    own = np.zeros(3)
    if masses != "mass in lumps":
        own = PRISM.mass * np.array([HEIGHT**2 + WIDTH**2, HEIGHT**2, WIDTH**2]) / 12.0
    bar = squared * PRISM.mass * PRISM.length**2 * np.array([0.0, 1.0, 1.0])
    assert inertia == pytest.approx(np.diag(own + bar), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("centre", [0.05, 0.3, 0.41, 0.7])
@pytest.mark.parametrize("masses", MASSES)
def test_a_centre_that_is_given_is_that_of_every_distribution(
    masses: Masses, centre: float
) -> None:
    inertia = np.diag([0.1, 0.2, 0.3]) + 0.01
    mass, found, about = rigid_inertia(replace(GIVEN, mass_centre=centre, inertia=inertia), masses)
    assert mass == pytest.approx(PRISM.mass, rel=1e-9)
    # Quadrature of a power of the distance from the lighter end.
    assert found == pytest.approx(centre, rel=1e-3)
    if masses == "mass in lumps":
        assert about == pytest.approx(inertia, abs=1e-9)


def test_mass_along_a_leg_is_that_of_a_prism() -> None:
    prism = equivalent_leg(GIVEN)
    own = craig_bampton(held_leg(beam_leg(prism.timoshenko, prism.length, 20)), HIGHEST)
    mass, expected = (
        dense(one.mass)
        for one in (leg_with_masses(GIVEN, "mass along the legs", HIGHEST), own.matrices)
    )
    np.testing.assert_allclose(np.abs(mass), np.abs(expected), rtol=0, atol=1e-9 * expected.max())


def test_wedges_are_looked_at_where_a_centre_is_not_known() -> None:
    known = replace(GIVEN, mass_centre=0.4)
    assert plausible_masses([known, known]) == (MASSES[0], *MASSES[3:])
    assert plausible_masses([known, GIVEN]) == MASSES


def at_the_centre(robot: Mechanism) -> RobotOnPath:
    at_one_pose = replace(robot, poses=robot.poses[4:5])
    return robot_on_path(Context(file_of(at_one_pose, text=""), "quick"))


@pytest.mark.parametrize("mixed", [False, True])
def test_legs_without_mass_bound_robots_whose_legs_are_all_given(*, mixed: bool) -> None:
    """Frequencies of any distribution lie below; held ends of a solid are stiffer than its 6×6."""
    legs = {"leg2": equivalent_leg(LEG2)} if mixed else {}
    light = {"leg1": replace(LEG1, mass=1e-6), "leg2": replace(LEG2, mass=1e-6)}
    robot, massless = (at_the_centre(like_ifw(**one)) for one in (legs, light))
    known = Response(vibration=modes_by_model(robot, "beam", DEFAULT_OPTIONS))
    (note,) = mass_notes(robot, Reference("", [Alternative("", known)], supposed="plausible"))
    assert note.startswith("Plausible distributions of the legs' mass give f1 ")
    assert ("than massless legs" in note) is not mixed
    if not mixed:
        own, above = (
            modes_of_solids(one, one.holding.first, MASSES[0]) for one in (robot, massless)
        )
        assert (own.frequencies[0, :3] < above.frequencies[0, :3]).all()
        bounds = [f"f{k + 1} {one:.4g} Hz" for k, one in enumerate(above.frequencies[0, :3])]
        assert note.endswith(", ".join(bounds))
