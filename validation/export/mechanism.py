"""A mechanism as files for other programs: its legs, itself as beams, and a deck of CalculiX."""

from collections.abc import Mapping
from fnmatch import fnmatchcase
from pathlib import Path
from textwrap import fill

import numpy as np

from fem.calculix.deck import deck_text
from fem.calculix.mechanism import mechanism_deck
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
    polyline,
    save,
    vectors_of,
    write_leg,
    write_part,
)
from validation.models.mechanism import constant_legs, mechanism_modes
from validation.models.options import DEFAULT_OPTIONS
from validation.solids.bars import bar_solids, with_bars

_HEAD = """\
Models of {name}, SI units (m, N, kg, s, rad). Files begin with the name of their body{stands}"""
_OF_LEGS = """; of
bodies that are alike the first stands for all:
{alike}
Leg axes: x from root to tip. A leg given by a compliance alone is its equivalent leg of constant
section."""
_MECHANISM_FILES = {
    "mechanism_beam.vtp": (
        "All legs in base axes, {pose}: unit wrenches at the loaded point, modes of the mechanism. "
        'Cell data "leg": their number in the order of the file ({legs}).'
    ),
    "mechanism.inp": (
        "A deck of CalculiX in the same pose, legs as solid bars of their outer size, one "
        "quadratic tetrahedron across, end faces rigid; joints as linear equations, drives as "
        "springs; six unit wrenches at the loaded point, then {modes} modes and the idle motions."
    ),
}
_WIDTH = 96
_VECTORS = (
    '"displacement Fx" to "displacement Mz" (m per N or N m): unit wrenches at {where}. "mode 1" '
    "and on: mass-normalised shapes; their frequencies (Hz) are field data."
)
_LINE = 'The same data along the centreline, and "rotation Fx" and on (rad) for each.'
# Of legs of constant section, whatever the robot: what files of these names hold.
_LEG_FILES: Mapping[str, str] = {
    "*_solid.vtu": (
        "The leg as a solid, {divisions} quadratic elements across the section; root clamped, end "
        f"faces rigid. Point data {_VECTORS.format(where='the tip')}"
    ),
    "*_beam.vtp": f"The leg in beam elements (Timoshenko). {_LINE}",
    "*_segments.vtp": f"The leg in rigid segments with springs between them. {_LINE}",
    "*_[KM].*": (
        "Stiffness (K) and mass (M) of the free leg, symmetric: .npz (scipy.sparse.load_npz), .mtx "
        "(Matrix Market). Unknowns: twist of the root [x y z phi_x phi_y phi_z], twist of the "
        "tip, then the model's own. The solid is meshed more coarsely, {matrix_divisions} element "
        "across, with three displacements per inner node."
    ),
}
_PART_FILES: Mapping[str, str] = {
    "*_part.vtu": (
        "The part on its finest mesh, in the axes of its file (m), held as the robot file says, "
        "the first interface clamped. For every other interface NAME, point data "
        '"displacement NAME Fx" to "displacement NAME Mz" (m per N or N m): unit wrenches there. '
        '"mode 1" and on: mass-normalised shapes; their frequencies (Hz) are field data.'
    ),
    "*_reduced_[KM].*": (
        "Stiffness (K) and mass (M) of the free part on the same mesh, reduced by Craig and "
        "Bampton, symmetric: .npz (scipy.sparse.load_npz), .mtx (Matrix Market). Unknowns: twist "
        "[x y z phi_x phi_y phi_z] of every interface in the order of the robot file, then "
        "amplitudes of modes with all interfaces held. Without the first six rows and columns "
        "they have the frequencies of the part with its first interface clamped."
    ),
}


def export_mechanism(mechanism: Mechanism, preset: Preset, folder: Path) -> None:
    """Write every different leg and every CAD part, the mechanism as beams and its deck.

    In the middle pose of the path; a mechanism with parts has neither beams nor deck. Raises
    InputError where a part cannot be meshed, ComputationError where a model cannot be solved,
    OSError where the disk refuses.
    """
    at = posture(mechanism, mechanism.poses[len(mechanism.poses) // 2])
    # Every different leg with the bodies that have its shape.
    legs = [(leg, name) for name, leg, _ in constant_legs(mechanism, DEFAULT_OPTIONS)]
    alike = {leg: [name for other, name in legs if other == leg] for leg, _ in legs}
    parts = [write_part(body, folder) for body in mechanism.parts.values()]
    for leg, ones in alike.items():
        write_leg(leg, ones[0], DIVISIONS[preset], folder)
    if alike and not parts:
        _write_beams(at, folder / "mechanism_beam.vtp")
        bars = with_bars(at)
        deck = mechanism_deck(bars, bar_solids(bars.mechanism), MODES).deck
        (folder / "mechanism.inp").write_text(deck_text(deck), encoding="utf-8")
    names = "\n".join(f"    {', '.join(ones)}" for ones in alike.values())
    head = _HEAD.format(name=mechanism.name, stands=_OF_LEGS.format(alike=names) if alike else ".")
    said = {
        "pose": shown_pose(mechanism, at.pose) or "reference posture",
        "legs": ", ".join(legs_of(mechanism)),
        "modes": MODES,
        "divisions": DIVISIONS[preset],
        "matrix_divisions": MATRIX_DIVISIONS,
    }
    head = "\n".join([head, *(f"Part {part}." for part in parts)])
    about = {**_MECHANISM_FILES, **_PART_FILES, **_LEG_FILES}
    _write_readme(folder, head, {files: text.format(**said) for files, text in about.items()})


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
    save(polyline(lines), joined, found.modes.frequencies, path)


def _write_readme(folder: Path, head: str, about: Mapping[str, str]) -> None:
    """Write README.txt for all files in `folder`, each under the first pattern that it matches.

    `about` maps shell-style patterns to what such files hold.
    """
    files = sorted(path.name for path in folder.iterdir())
    blocks = [head]
    for pattern, text in about.items():
        described = [name for name in files if fnmatchcase(name, pattern)]
        files = [name for name in files if name not in described]
        if described:
            blocks.append(f"{_wrapped(', '.join(described))}\n{_wrapped(text, ' ' * 4)}")
    (folder / "README.txt").write_text("\n\n".join(blocks) + "\n", encoding="utf-8")


def _wrapped(text: str, indent: str = "") -> str:
    return fill(
        text, _WIDTH, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False
    )
