"""Half-widths of references due to meshes, for errors that are known beforehand."""

from functools import partial

import numpy as np
import pytest
from support.fakes.toy_responses import NO_ROBOT
from support.robots.paper_legs import STEEL

from fem.beams.beam_theory import cantilever_frequencies
from fem.sections.inertial_distortion import distortion_flexibility
from lumped.centre_line import CentreLine, LinePiece
from lumped.errors import InputError
from lumped.legs import ConstantLeg, LineLeg
from lumped.robot_file import load_robot
from lumped.robot_file.load import robot_of
from lumped.sections import HollowRectangle
from meshes.section.section_mesh import section_mesh
from validation.context import Context
from validation.references import mesh_uncertainty, uncertainty_sources
from validation.references.model_ladder import COMPUTED_BEAMS
from validation.references.modes_on_path import LegMesh, solid_vibration
from validation.references.reference_legs import (
    SECTION_DIVISIONS,
    SLOWEST_ORDER,
    line_divisions,
    solid_leg,
)
from validation.references.responses import Responses
from validation.references.robot_on_path import robot_on_path
from validation.responses.mode_partners import frequency_changes, shares_by_shape
from validation.solids.leg_meshes import COARSEST_WALLS, section_of
from validation.uncertainty.half_widths import UNPROVEN, half_widths_on

BOX = {"shape": "hollow-rectangle", "width": 0.1, "height": 0.16, "thickness": 0.003}


@pytest.mark.parametrize("row", ["_STATIC_SECTIONS", "_MODAL_SECTIONS"])
def test_section_half_width_uses_mesh_of_solid(row, monkeypatch):
    """Solids have the coarse section mesh of n divisions, of error n^-p: the half-width is 3 n^-p.

    The formula of the fine mesh gave 1.19 times the error (2^p = 2.52, p = 4/3).
    """
    monkeypatch.setattr(mesh_uncertainty, "shares_section", lambda *_: True)
    policy = getattr(mesh_uncertainty, row).policy(robot_on_path(Context(load_robot("five-bar"))))
    errors = [float(n) ** -SLOWEST_ORDER for n in (COARSEST_WALLS, SECTION_DIVISIONS)]
    half_width = half_widths_on(
        (0, 1), policy, lambda level: np.array(1.0 + errors[level]), lambda a, b, _: abs(a - b)
    )
    assert half_width == pytest.approx(UNPROVEN * errors[0], rel=1e-12)


@pytest.mark.parametrize(
    ("thickness", "expected"),
    [(0.01, (2, 4)), (0.004, (2, 4)), (0.002, (3, 5)), (0.001, (3, 5))],
)
def test_taper_meshes_have_different_sections(thickness, expected):
    """Walls of 2 mm and less have one section mesh for one to four divisions."""
    leg = tapered_box(thickness, 0.2)
    for preset in ("quick", "standard"):
        assert line_divisions(preset, leg) == expected
    # Thin walls have elements twice as long with up to four divisions as with eight.
    assert line_divisions("fine", leg) == ((4, 8) if thickness < 0.004 else (2, 8))
    coarse, fine = (len(section_mesh(section_of(leg), n).cells) for n in expected)
    # Elements of half the size across the walls, or a third shorter along them, and less.
    assert fine / coarse > 1.3


def test_taper_too_thin_for_preset_is_refused():
    """Walls of 2 mm need more divisions than preset quick allows."""
    leg = tapered_box(0.002, 0.8)
    with pytest.raises(InputError, match=r"5 divisions .*; --preset standard allows this solid"):
        solid_leg(Context(NO_ROBOT, "quick"), leg)


def test_distortion_half_width_follows_kinds_of_motion():
    """Box with walls of 3 mm, one section mesh in both solids: modes in both planes and torsion.

    The change of each frequency to a section mesh of half the element size is ½ ω² Δβ of the mode's
    kind of motion. For f1 it is 0.11 %, which the change between the solids does not show.
    """
    section = HollowRectangle(0.1, 0.16, 0.003)
    leg = ConstantLeg(0.9, section, STEEL)
    on_path = cantilever(BOX)
    modes = Responses(on_path).required_modes(COMPUTED_BEAMS, on_path.first_reading)
    half_widths = mesh_uncertainty.distortion_half_widths(on_path, modes)[0]
    change = np.diag(
        distortion_flexibility(section_mesh(section, SECTION_DIVISIONS), STEEL)
        - distortion_flexibility(section_mesh(section, COARSEST_WALLS), STEEL)
    )
    kinds = cantilever_frequencies(leg.timoshenko, leg.length, 4)
    for axis, name in enumerate(("bending z", "bending y", "torsion")):
        index = [mode.kind for mode in kinds].index(name)
        expected = 0.5 * (2.0 * np.pi * modes.frequencies[0, index]) ** 2 * change[axis]
        factor = UNPROVEN / (1.0 - (COARSEST_WALLS / SECTION_DIVISIONS) ** SLOWEST_ORDER)
        # Rotary inertia has up to 2 % of the kinetic energy.
        assert half_widths[index] == pytest.approx(factor * expected, rel=0.025)
    assert half_widths[0] > 1.1e-3


def test_walls_widen_responses_near_resonance():
    """Box with walls of 3 mm: the peak moves by the half-width of f1, its height by twice that.

    Far below f1 walls hardly bend: the half-width falls with ω², to 1 % of that of the peak.
    """
    response = {"name": "mill", "direction": [0.0, 1.0, 0.0], "from": 11.0, "to": 250.0}
    damping = {"ratio": 0.01}
    on_path = cantilever(BOX, damping=damping, responses=[response])
    modes = Responses(on_path).required_modes(COMPUTED_BEAMS, on_path.first_reading)
    half_widths = partial(uncertainty_sources._distortion_half_widths, on_path, modes)
    peaks, (receptance,) = uncertainty_sources._by_frequencies(on_path, modes, half_widths)
    of_modes = mesh_uncertainty.distortion_half_widths(on_path, modes)[0]
    # A damping ratio of 1 % lowers the frequency of the peak by 1e-4 of f1.
    assert peaks[0] == pytest.approx(np.array([2.0, 1.0]) * of_modes[0], rel=1e-3)
    assert peaks[0, 1] > 1.1e-3
    static = 2.0 * (11.0 / modes.frequencies[0, 0]) ** 2 * of_modes[0]
    assert receptance[0, 0] == pytest.approx(static, rel=0.02)
    assert receptance[0].max() > 10.0 * of_modes[0]


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    "section",
    [
        BOX,
        {"shape": "i-section", "width": 0.1, "height": 0.1, "flange": 0.003, "web": 0.002},
        {"shape": "tube", "diameter": 0.12, "thickness": 0.003},
    ],
    ids=["box", "I", "tube"],
)
def test_half_widths_of_section_mesh_cover_thin_walls(section):
    """Only the section meshes of two solids differ: changes of f1 and f2 are in the half-widths."""
    on_path = cantilever(section)
    reading, responses = on_path.first_reading, Responses(on_path)
    coarse, fine = (
        solid_vibration(on_path.postures, reading, LegMesh(1, 1, divisions), 2)
        for divisions in (COARSEST_WALLS, 2 * COARSEST_WALLS)
    )
    changes = frequency_changes(fine, coarse, 2)
    beams = responses.required_modes(COMPUTED_BEAMS, reading)
    of_beams = mesh_uncertainty._MODAL_SECTIONS.half_widths(
        responses, reading, responses.required_modes, mesh_uncertainty._all_changes
    )
    constants = shares_by_shape(coarse, beams, of_beams, 2)
    distortion = mesh_uncertainty.distortion_half_widths(on_path, coarse)
    assert (changes <= constants + distortion).all()
    if section is BOX:
        # Without distortion the half-width was too small.
        assert (changes > constants).all()


def cantilever(section, **tables):
    """Robot of one steel leg, 0.9 m long, with free end faces, clamped at its root.

    `tables` are further tables of the robot file.
    """
    material = {"E": STEEL.E, "nu": STEEL.nu, "rho": STEEL.rho}
    body = {"from": "A", "to": "B", "section": section, "material": material, "ends": "free"}
    robot = robot_of(
        {
            "schema": 2,
            "name": "boom",
            "points": {"A": [0.0, 0.0, 0.0], "B": [0.9, 0.0, 0.0]},
            "bodies": {"boom": body},
            "joints": {"root": {"type": "fixed", "between": ["ground", "boom"], "at": "A"}},
            "tool": {"body": "boom", "point": "B", "moves": []},
            **tables,
        }
    )
    return robot_on_path(Context(robot, "quick"))


def tapered_box(thickness, length):
    """Straight steel box of 100 mm by 80 mm at the root and 100 mm by 56 mm at the tip."""
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (length, 0.0, 0.0)),), (0.0, 0.0, 1.0))
    root, tip = (HollowRectangle(0.1, height, thickness) for height in (0.08, 0.056))
    return LineLeg(line, ((0.0, root), (length, tip)), STEEL, "box")
