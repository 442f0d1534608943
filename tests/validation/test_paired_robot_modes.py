"""Solids and beams of one robot: their meshes, and modes that are close."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.robot_file import load_robot
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle
from validation.case import Skip
from validation.cases.robot import modes as robot_modes
from validation.cases.robot import solid as robot_solid
from validation.cases.robot.mode_tables import mac_table
from validation.context import Context
from validation.solids.robots import two_meshes
from validation.studies.paired_robot_modes import (
    ELEMENTS,
    divisions_of,
    model_modes,
    paired,
)

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
IFW = load_robot("ifw")


def leg(section, length=0.85):
    return ConstantLeg(length, section, STEEL)


def test_walls_have_finer_meshes_than_rectangles_and_half_of_them_to_compare():
    legs = [leg(Rectangle(0.1, 0.16)), leg(HollowRectangle(0.1, 0.16, 0.01))]
    assert divisions_of(legs, "standard") == ((2, 2), (3, 4))


def test_close_modes_are_in_the_order_of_frequencies():
    """At the right end of the stroke modes 6 and 7 are 2.8 % apart (segments)."""
    segments = model_modes(IFW.robot, "segments", "timoshenko", ELEMENTS, 3)
    swapped = replace(
        segments,
        frequencies=segments.frequencies[:, [0, 1, 2, 3, 4, 6, 5, *range(7, 12)]],
    )
    found = paired(IFW.robot, segments, swapped)
    # Partners by shape, so that the wrong frequencies are seen where modes are alone …
    assert found.found[0, 5] == pytest.approx(segments.frequencies[0, 6])
    # … and put in order where they are close, whichever shape is whose.
    assert found.close[-1, 5]
    assert found.found[-1, 5] == pytest.approx(segments.frequencies[-1, 5])


@pytest.mark.parametrize(
    "section", [Circle(0.1), HollowRectangle(0.1, 0.16, 0.01), ISection(0.12, 0.2, 0.01, 0.008)]
)
def test_two_meshes_of_any_shape_with_free_ends_are_the_beam_of_their_constants(section):
    found = two_meshes(leg(section), 900)
    assert found.ratio == 2.0
    assert_allclose(np.diag(found.fine.free), np.diag(found.fine.own), rtol=3e-4)
    # Held faces take from torsion and bending, never add.
    assert np.all(np.diag(found.fine.rigid) <= np.diag(found.fine.free) * (1.0 + 1e-9))


def test_one_mesh_of_walls_is_refined_along_the_leg():
    """A hollow rectangle of four divisions has 432 unknowns, of eight 1440."""
    hollow = leg(HollowRectangle(0.1, 0.16, 0.01))
    found = two_meshes(hollow, 900)
    assert_allclose(found.coarse.own, found.fine.own, rtol=1e-12)
    assert not np.array_equal(found.coarse.free, found.fine.free)
    with pytest.raises(InputError, match="432 unknowns, more than 400"):
        two_meshes(hollow, 400)


def test_statics_of_walls_too_thin_for_the_preset_are_skipped_with_the_reason():
    """2 mm walls of a 0.3 m side: elements of eight times their thickness at most."""
    thin = leg(HollowRectangle(0.2, 0.3, 0.002))
    robot_file = replace(IFW, described=replace(IFW.robot, leg1=thin))
    case = next(case for case in robot_solid.cases() if case.id.endswith("free.planar-x"))
    with pytest.raises(Skip, match=r"leg: the coarsest section mesh of its hollow-rect"):
        case.compute(Context(robot_file, "quick"))


def test_where_no_modes_are_close_nothing_is_said_to_agree():
    segments = model_modes(IFW.robot, "segments", "timoshenko", ELEMENTS, 3)
    apart = replace(paired(IFW.robot, segments, segments), close=np.zeros((3, 6), dtype=bool))
    with pytest.raises(Skip, match="no two modes are close at any posture"):
        robot_modes.smallest_shared(apart, np.ones((3, 6), dtype=bool), np.zeros((3, 6)))


def test_what_lies_above_all_modes_of_the_other_model_has_no_partner_there():
    """Twelve modes of walls below the fourth of beams: what is paired with that is none of it."""
    segments = model_modes(IFW.robot, "segments", "timoshenko", ELEMENTS, 3)
    # Others' modes end between the third and the fourth.
    ends = segments.frequencies[:, 2:3] + np.linspace(-1.0, 0.5, 12)
    walls = replace(
        segments, frequencies=np.sort(ends, axis=1), samples=segments.samples[:, :, ::-1]
    )
    found = paired(IFW.robot, segments, walls)
    assert not found.reached[:, 3:].any()
    assert found.reached[:, :2].all()
    everywhere = np.ones((3, 6), dtype=bool)
    apart = replace(found, close=everywhere)
    few = robot_modes.smallest_shared(apart, everywhere, np.zeros((3, 6)))
    assert any("modes left out, above the first 12 modes of the solids" in n for n in few.notes)
    assert np.isnan(mac_table(found, "beams")["solid (Hz)"][3])
    with pytest.raises(Skip, match="above the first 12 modes"):
        robot_modes.smallest_shared(apart, ~found.reached, np.zeros((3, 6)))
