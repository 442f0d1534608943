"""Distortion of tapered rectangular tubes in torsion, against solids and closed forms."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from fem.beams import box_distortion
from fem.beams.box_distortion import distortion_work
from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from fem.sections.wall_frame import mesh_frame_stiffness
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import LineLeg, Material
from lumped.sections import HollowRectangle
from meshes.loft import mesh_section
from meshes.section.section_mesh import section_mesh
from meshes.stepped import stretched
from validation.solids.line_beams import computed_tip

ALLOY = Material.isotropic(E=7.0e10, nu=0.3, rho=2700.0)


def line_leg(*stations):
    tip = (stations[-1][0], 0.0, 0.0)
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), tip),), (0.0, 0.0, 1.0))
    return LineLeg(line, stations, ALLOY)


def tube(first, last, length=0.4):
    return line_leg((0.0, first), (length, last))


def mesh_frames(leg, divisions):
    """Function that returns the frame stiffness of a prism on the section mesh of the solid."""
    reference = mesh_section(leg)
    face = section_mesh(reference, divisions)

    def stiffness(prism):
        nodes = stretched(face.nodes, reference, prism.section)
        return mesh_frame_stiffness(replace(face, nodes=nodes), prism.material)

    return stiffness


def added_by_solid(leg):
    """Torsional tip compliance of the solid with free ends, minus that of the beam (rad/(N m))."""
    solid = clamped_leg(solid_leg(leg, solid_mesh(leg, 1)), "free").compliance[3, 3]
    return solid - computed_tip(leg, 1)[3, 3]


def test_unequal_taper_twists_like_solid():
    """The solid is 1.705 times as flexible as the beam, with the frame stiffness of its mesh.

    That mesh, with one element across the walls, has frames 5 to 6 % too stiff.
    """
    leg = tube(HollowRectangle(0.1, 0.08, 0.002), HollowRectangle(0.1, 0.056, 0.002))
    work = added_by_solid(leg)
    assert work == pytest.approx(0.705 * computed_tip(leg, 1)[3, 3], rel=0.01)
    assert distortion_work(leg, np.ones_like, mesh_frames(leg, 1)) == pytest.approx(work, rel=0.005)
    assert distortion_work(leg, np.ones_like) == pytest.approx(work, rel=0.08)


def test_taper_between_prisms_twists_like_solid():
    """Kinks: polynomials of γ(x) with continuous slopes overestimate the distortion by 14 %."""
    first, last = HollowRectangle(0.1, 0.08, 0.002), HollowRectangle(0.1, 0.056, 0.002)
    leg = line_leg((0.0, first), (0.2, first), (0.4, last), (0.6, last))
    work = distortion_work(leg, np.ones_like, mesh_frames(leg, 1))
    assert work == pytest.approx(added_by_solid(leg), rel=0.02)


def test_short_taper_in_long_prism_equals_point_load():
    """Limit of a short taper in thin walls: a beam on an elastic foundation under one force P.

    Its stiffness is EI = E t (b + h) b² h²/96, that of its foundation k = 24 D/(b* + h*), the force
    P = ½ ln (h1/h2). With β⁴ = k/4EI and free ends the deflection at the force is Pβ/2k (cosh βL +
    cos βL + 2)/(sinh βL + sin βL) (Hetényi, Beams on Elastic Foundation, 1946). The shear of the
    walls is of relative order (βb)², 0.5 %.
    """
    t = 1e-4
    first, last = HollowRectangle(0.1 + t, 0.081 + t, t), HollowRectangle(0.1 + t, 0.079 + t, t)
    leg = line_leg((0.0, first), (1.995, first), (2.005, last), (4.0, last))
    frame = 24.0 * 7.0e10 * t**3 / 12.0 / (1.0 - 0.3**2) / (0.18 - 2.0 * t)
    bending = 7.0e10 * t * 0.18 * (0.1 * 0.08) ** 2 / 96.0
    decay = (frame / (4.0 * bending)) ** 0.25
    x = decay * leg.length
    ends = (np.cosh(x) + np.cos(x) + 2.0) / (np.sinh(x) + np.sin(x))
    expected = (0.5 * np.log(0.081 / 0.079)) ** 2 * decay / (2.0 * frame) * ends
    assert distortion_work(leg, np.ones_like) == pytest.approx(expected, rel=5e-3)


def test_distortion_converges_with_degree_of_elements(monkeypatch):
    first, last = HollowRectangle(0.1, 0.08, 0.002), HollowRectangle(0.1, 0.04, 0.002)
    leg = line_leg((0.0, first), (0.2, first), (0.3, last), (0.5, last))
    work = distortion_work(leg, np.ones_like)
    monkeypatch.setattr(box_distortion, "_DEGREE", 8)
    monkeypatch.setattr(box_distortion, "_POINTS", 12)
    assert work == pytest.approx(distortion_work(leg, np.ones_like), rel=3e-6)


def test_slender_tube_needs_memory_of_band():
    """100 elements have 1203 unknowns, whose square matrix would have 11.6 MB."""
    leg = tube(HollowRectangle(0.011, 0.011, 0.001), HollowRectangle(0.011, 0.0109, 0.001), 0.99)
    tracemalloc.start()
    distortion_work(leg, np.ones_like)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 6e6


def test_stepped_prisms_do_not_distort():
    """In prisms between steps no walls converge."""
    first, last = HollowRectangle(0.1, 0.08, 0.002), HollowRectangle(0.1, 0.056, 0.003)
    leg = line_leg((0.0, first), (0.2, first), (0.2, last), (0.5, last))
    assert distortion_work(leg, np.ones_like) == 0.0


def test_equal_taper_does_not_distort():
    """A tube whose width and height fall in one ratio: no work of distortion."""
    first, last = HollowRectangle(0.1, 0.08, 0.004), HollowRectangle(0.07, 0.056, 0.0028)
    reference = distortion_work(tube(first, replace(first, height=0.056)), np.ones_like)
    assert distortion_work(tube(first, last), np.ones_like) < 1e-12 * reference


@pytest.mark.parametrize("length", [0.4, 0.8])
def test_slight_taper_distorts_by_closed_form(length):
    """Work ∫ (T Δ/2)² (b* + h*)/24D dx with the symbols of `fem.beams.box_distortion`.

    Strains of the edges change it by (t/b)².
    """
    first, last = HollowRectangle(0.1, 0.08, 0.002), HollowRectangle(0.1, 0.079, 0.002)
    plate = 7.0e10 * 0.002**3 / 12.0 / (1.0 - 0.3**2)
    rate = 0.001 / length / 0.0775
    expected = length * (0.5 * rate) ** 2 * (0.096 + 0.0755) / (24.0 * plate)
    # Second order in the relative change of the height, 1/80.
    work = distortion_work(tube(first, last, length), np.ones_like)
    assert work == pytest.approx(expected, rel=1e-3)
