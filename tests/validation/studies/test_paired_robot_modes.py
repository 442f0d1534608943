"""Solids and beams of one robot: their meshes, and modes that are close."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.robot_file import load_robot
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle
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
