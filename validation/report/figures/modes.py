"""The first modes: by which models they are drawn, whose modes they are, where their energy sits.

Drawn are beams with CAD parts as their solids, and segments beside. Modes are paired by shape with
those of the reference; strain energy is told by kind of deformation, and by body.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from lumped.arrays import Array
from lumped.dense.modes import Modes
from lumped.legs import ConstantLeg
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.system.assembly import assembly
from lumped.system.joint_motion import Portion
from validation.adequacy.mechanism.dynamics import dynamic_reference
from validation.adequacy.mechanism.parts import solid_parts
from validation.adequacy.mechanism.path import (
    holding,
    known_legs,
    offered,
    path_postures,
    robot_on_path,
)
from validation.adequacy.mechanism.vibration import modes_by_model
from validation.adequacy.partners import partners
from validation.adequacy.responses import Responses
from validation.agreement.mode_pairing import likeness_matrix
from validation.agreement.responses import PathModes
from validation.case import Skip
from validation.context import Context
from validation.drawing.chart import Bars, Chart, Column, Panel, Series
from validation.drawing.figures import FigureGroup
from validation.exhibits import MODES
from validation.models.mechanism import (
    PostureModes,
    dynamic_bodies,
    highest_frequency,
    mechanism_modes,
    modes_along,
)
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.report.figures.mode_names import DRIVES, JOINTS, by_kind, summed
from validation.solids.legs import SHARED_SOLIDS

Portions = Mapping[Portion, Array]
Shares = Mapping[str, Array]
SIXTY = 60
_MODELS: tuple[ModelName, ...] = ("beam", "segments")
_CONDENSED = ModelOptions(parts="condensed")
figures = FigureGroup(MODES, SHARED_SOLIDS)


def finite_elements(context: Context, count: int) -> PostureModes:
    """The first modes in the middle of the path, prisms as beams, parts as solids.

    At most `count`; with parts none beyond what these are reduced for, those that are judged and as
    many again.
    """
    postures = path_postures(context)
    if postures[0].mechanism.parts:
        offers = offered(context.robot_file.requirement.modes)
        return context.get(_with_solid_parts, postures, offers, count)
    (found,) = context.get(mechanism_modes, "beam", (_middle(postures),), count)
    return found


def segments(context: Context, count: int) -> PostureModes:
    """The same by segments, parts condensed on their interfaces."""
    at = _middle(path_postures(context))
    if at.mechanism.parts:
        return context.get(_with_condensed_parts, at, count)
    (found,) = context.get(mechanism_modes, "segments", (at,), count)
    return found


def _middle(postures: Sequence[Posture]) -> Posture:
    return postures[len(postures) // 2]


def _with_solid_parts(postures: tuple[Posture, ...], offers: int, count: int) -> PostureModes:
    """Parts as the run has them: held in the first of the ways that it looks at."""
    at, mechanism = _middle(postures), postures[0].mechanism
    parts = solid_parts(postures, offers, holding(mechanism).first)
    highest = min(part.highest for part in parts.values())
    bodies = dynamic_bodies("beam", mechanism, highest, _CONDENSED)
    (found,) = modes_along(assembly(mechanism, {**bodies, **parts}), [at], count)
    known = found.modes.frequencies <= highest
    return replace(found, modes=Modes(found.modes.frequencies[known], found.modes.shapes[:, known]))


def _with_condensed_parts(at: Posture, count: int) -> PostureModes:
    highest = highest_frequency((at,), count)
    bodies = dynamic_bodies("segments", at.mechanism, highest, _CONDENSED)
    (found,) = modes_along(assembly(at.mechanism, bodies), [at], count)
    return found


@figures.figure("mechanism.pairs", "Modes paired by shape with those of the reference", effort=2.0)
def pairs(context: Context) -> Chart:
    """MAC of beams and segments with the reference, and by how much paired frequencies differ."""
    robot = robot_on_path(context)
    responses = Responses(robot)
    reference = dynamic_reference(responses)
    if reference.model is None:
        raise Skip(f"there is no reference of the frequencies: {reference.decides}")
    held = reference.interpretations[0]
    truth = responses.required_modes(reference.model, held.reading)
    first = _in_the_middle(truth)
    shown = first.frequencies.shape[1]
    models = {
        name: _in_the_middle(modes)
        for name in _MODELS
        if (modes := modes_by_model(robot, name, DEFAULT_OPTIONS))
    }
    numbers = np.arange(1.0, shown + 1.0)
    columns: dict[str, Column] = {
        "mode": numbers.tolist(),
        "reference (Hz)": first.frequencies[0].tolist(),
    }
    panels: list[Panel] = []
    changes: list[Series] = []
    for name, model in models.items():
        mac = likeness_matrix(*(of.at(0) for of in (first, model)))
        label = "" if panels else "mode of the reference"
        panels.append(Panel((), f"MAC with {name}", label, x_label=f"mode of {name}", matrix=mac))
        found = partners(first, model, shown)
        change = 100.0 * (found.frequency[0] / first.frequencies[0] - 1.0)
        changes.append(Series(name, numbers, change))
        columns |= {
            f"{name}: partner": [float(k) + 1.0 for k in found.number[0]],
            f"{name} (Hz)": found.frequency[0].tolist(),
            f"{name}: MAC": found.likeness[0].tolist(),
        }
    panels.append(Panel(changes, "difference (%)", levels=(0.0,), staggered=False))
    return Chart(panels, "mode of the reference", len(panels), 2.0, columns).captioned(
        f"In the middle of the path; reference: {held.name or 'solid'}. Left: energy-weighed modal "
        "assurance criterion (MAC), black where two shapes are equal; blocks are modes of nearly "
        "equal frequency, which may mix. Right: frequencies of paired modes; those without a "
        "partner are left out.",
    )


def _in_the_middle(found: PathModes) -> PathModes:
    """The modes in the middle pose alone, those that there are."""
    place = len(found.frequencies) // 2
    known = np.isfinite(found.frequencies[place])
    return PathModes(
        found.frequencies[place : place + 1, known],
        found.samples[place : place + 1][:, :, known],
        found.weights,
        found.seen[place : place + 1, known],
    )


@figures.figure(
    "mechanism.strain-energy", "Where the strain energy of the first modes sits", effort=2.0
)
def energies(context: Context) -> Chart:
    """A stacked bar for each mode: by kind of deformation, and by drives, joints and bodies."""
    mechanism = context.robot_file.mechanism
    if not (known_legs(mechanism) or mechanism.parts):
        raise Skip("all bodies are rigid: their modes sit in the drives and joints alone")
    found = finite_elements(context, SIXTY)
    frequencies = found.modes.frequencies
    model = "model of parts as solids" if mechanism.parts else "beam model"
    kinds = (
        "Bending y is deflection along a leg's own z axis, bending z along its y axis, both with "
        "their shear."
        if known_legs(mechanism)
        else "Parts bend, twist and stretch at once."
    )
    shares = {
        "(a) by kind of deformation": by_kind(found.strain, mechanism),
        "(b) by body": _by_body(found.strain, mechanism),
    }
    names = [f"{number}: {one:.1f} Hz" for number, one in enumerate(frequencies, 1)]
    panels = [
        Panel(
            title=title,
            y_label="strain energy (%)",
            bars=[Bars(name, 100.0 * share) for name, share in own.items()],
            names=names,
        )
        for title, own in shares.items()
    ]
    table: dict[str, Column] = {
        "mode": [float(number) for number in range(1, len(frequencies) + 1)],
        "frequency (Hz)": frequencies.tolist(),
    }
    table |= {f"{part} (%)": (100.0 * share).tolist() for part, share in found.strain.items()}
    count = len(frequencies)
    first = f"The first {count} modes" if count > 1 else "The first mode"
    return Chart(panels, "mode", 1, 2.4, table).captioned(
        f"{first} of the {model} in the middle of the path, "
        f"{frequencies[0]:.4g} to {frequencies[-1]:.4g} Hz.",
        kinds,
        "Bodies of the same shape are summed; the CSV lists each.",
    )


def _by_body(strain: Portions, mechanism: Mechanism) -> Shares:
    """Shares of drives, of joints and of legs, those of one shape together."""
    groups: dict[object, list[str]] = {name: [name] for name in mechanism.parts}
    for name, leg in known_legs(mechanism).items():
        groups.setdefault(leg if isinstance(leg, ConstantLeg) else name, []).append(name)
    label = {name: _listed(names) for names in groups.values() for name in names}
    return summed(
        strain, lambda part: label.get(part.of) or (DRIVES if part.kind == "drive" else JOINTS)
    )


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) <= 3 else f"{names[0]} to {names[-1]} ({len(names)})"
