"""A mechanism as files for other programs: its legs, itself as beams, and a deck of CalculiX.

What the files hold is written beside them, in README.txt.
"""

from pathlib import Path

import numpy as np

from fem.calculix.deck import deck_text
from fem.calculix.mechanism import mechanism_deck
from lumped.legs import ConstantLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.kinematics.postures import posture, shown_pose
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.system.solution import solved
from validation.context import Preset
from validation.export.models import (
    DIVISIONS,
    MATRIX_DIVISIONS,
    MODES,
    STATIONS,
    named_fields,
    vectors_of,
    write_leg,
)
from validation.export.vtk_files import polyline, save
from validation.models.mechanism import constant_legs
from validation.models.mechanism_modes import mechanism_modes
from validation.models.options import DEFAULT_OPTIONS
from validation.solids.bars import bar_solids, with_bars

_README = """\
Models of {name}, SI units (m, N, kg, s, rad). NAME is that of a body; of bodies that are alike the
first stands for all:
{alike}
Leg axes: x from root to tip. A leg given by a compliance alone is its equivalent leg of constant
section.{parts}

NAME_solid.vtu
    The mesh, {divisions} quadratic elements across the section; root clamped, end faces rigid.
    Point data "displacement Fx" to "displacement Mz" (m per N or N m): unit wrenches at the tip.
    "mode 1" and on: mass-normalised shapes; their frequencies (Hz) are field data.
NAME_beam.vtp, NAME_segments.vtp
    The centreline in beam elements (Timoshenko) and in rigid segments with springs between them:
    the same data, and "rotation Fx" and on (rad) for each.
NAME_MODEL_K.*, NAME_MODEL_M.*
    Stiffness and mass of the free leg, symmetric: .npz (scipy.sparse.load_npz), .mtx (Matrix
    Market). Unknowns: twist of the root [x y z phi_x phi_y phi_z], twist of the tip, then the
    model's own. The solid is meshed more coarsely, {matrix_divisions} element across, with three
    displacements per inner node.
mechanism_beam.vtp
    All legs in base axes, {pose}: unit wrenches at the loaded point, modes of the mechanism. Cell
    data "leg": their number in the order of the file ({legs}).
mechanism.inp
    A deck of CalculiX in the same pose, legs as solid bars of their outer size, one quadratic
    tetrahedron across, end faces rigid; joints as linear equations, drives as springs; six unit
    wrenches at the loaded point, then {modes} modes and what idles.
"""


def export_mechanism(mechanism: Mechanism, preset: Preset, folder: Path) -> None:
    """Write every different leg, the mechanism as beams and its deck into `folder`.

    In the middle pose of the path. Raises ComputationError where a model cannot be solved, OSError
    where the disk refuses.
    """
    at = posture(mechanism, mechanism.poses[len(mechanism.poses) // 2])
    alike = _alike(mechanism)
    names = list(legs_of(mechanism))
    parts = ", ".join(mechanism.parts)
    readme = _README.format(
        name=mechanism.name,
        alike="\n".join(f"    {', '.join(ones)}" for ones in alike.values()),
        parts=f"\nBodies from files ({parts}) are left out." if parts else "",
        divisions=DIVISIONS[preset],
        matrix_divisions=MATRIX_DIVISIONS,
        pose=shown_pose(mechanism, at.pose) or "reference posture",
        legs=", ".join(names),
        modes=MODES,
    )
    (folder / "README.txt").write_text(readme, encoding="utf-8")
    for leg, ones in alike.items():
        write_leg(leg, ones[0], DIVISIONS[preset], folder)
    if alike and not parts:
        _write_beams(at, folder / "mechanism_beam.vtp")
        bars = with_bars(at)
        deck = mechanism_deck(bars, bar_solids(bars.mechanism), MODES).deck
        (folder / "mechanism.inp").write_text(deck_text(deck), encoding="utf-8")


def _alike(mechanism: Mechanism) -> dict[ConstantLeg, list[str]]:
    """Every different leg with the bodies that have its shape."""
    found: dict[ConstantLeg, list[str]] = {}
    for name, leg, _ in constant_legs(mechanism, DEFAULT_OPTIONS):
        found.setdefault(leg, []).append(name)
    return found


def _write_beams(at: Posture, path: Path) -> None:
    (found,) = mechanism_modes("beam", [at], MODES)
    system = found.system
    deflections = solved(system).displacements(system.tool.T)
    lines, fields = [], []
    for name in legs_of(at.mechanism):
        frame, model = at.frames[name], system.models[name]
        if not isinstance(model, LegMatrices):
            raise TypeError(f"{name}: the beam model of a leg has a centreline")
        stations = np.linspace(0.0, model.length, STATIONS)
        lines.append(frame.position + np.outer(stations, frame.rotation[:, 0]))
        twists = model.centreline(stations)
        own = vectors_of(
            named_fields(
                twists @ system.own(name, deflections),
                twists @ system.own(name, found.modes.shapes),
            )
        )
        fields.append({key: field @ frame.rotation.T for key, field in own.items()})
    joined = {key: np.vstack([one[key] for one in fields]) for key in fields[0]}
    save(polyline(lines, joined, found.modes.frequencies), path)
