"""Charts of the first modes: partners in the reference by shape, and strain energy.

Input: the context of a run. Output: MAC matrices and frequency differences of beams and segments
against the reference, and shares of strain energy by kind of deformation and by body, all in the
middle of the path.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from lumped.arrays import Array
from lumped.dense.modes import Modes
from lumped.legs import GivenLeg
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.system.assembly import assembly
from lumped.system.joint_motion import Portion
from validation.case import Skip
from validation.context import Context
from validation.drawing.chart import Bars, Chart, Column, Panel, Series
from validation.drawing.figures import FigureGroup
from validation.drawing.text import number
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.models.robot_bodies import dynamic_bodies
from validation.models.robot_models import (
    PostureModes,
    highest_frequency,
    mechanism_modes,
    modes_along,
)
from validation.references.modal_reference import dynamic_reference
from validation.references.modes_on_path import modes_by_model
from validation.references.reference_parts import solid_parts
from validation.references.responses import Responses
from validation.references.robot_on_path import (
    computed_count,
    holding,
    known_legs,
    path_postures,
    robot_on_path,
)
from validation.report.figures.mode_names import DRIVES, JOINTS, shares_by_kind, sum_shares
from validation.responses.mode_pairing import mac_matrix
from validation.responses.mode_partners import partners
from validation.responses.statics_and_modes import PathModes
from validation.solids.solid_legs import SHARED_SOLIDS
from validation.studies_and_figures import MODES

Portions = Mapping[Portion, Array]
Shares = Mapping[str, Array]
ENERGY_MODES = 60
_MODELS: tuple[ModelName, ...] = ("beam", "segments")
_CONDENSED = ModelOptions(parts="condensed")
figures = FigureGroup(MODES, SHARED_SOLIDS)


def finite_elements(context: Context, count: int) -> PostureModes:
    """First `count` modes in the middle of the path, with prisms as beams and CAD parts as solids.

    Reduced models of CAD parts are accurate up to a certain frequency. Modes above it are omitted.
    This frequency lies above the first 2n modes if n modes are judged, and always above the first
    eight.
    """
    postures = path_postures(context)
    if postures[0].mechanism.parts:
        modes_of_run = computed_count(context.robot_file.requirement.modes)
        return context.get(_modes_with_solid_parts, postures, modes_of_run, count)
    (posture_modes,) = context.get(mechanism_modes, "beam", (_middle_posture(postures),), count)
    return posture_modes


def segments(context: Context, count: int) -> PostureModes:
    """First `count` modes in the middle of the path by segments, with condensed CAD parts."""
    middle = _middle_posture(path_postures(context))
    if middle.mechanism.parts:
        return context.get(_modes_with_condensed_parts, middle, count)
    (posture_modes,) = context.get(mechanism_modes, "segments", (middle,), count)
    return posture_modes


def _middle_posture(postures: Sequence[Posture]) -> Posture:
    return postures[len(postures) // 2]


def _modes_with_solid_parts(
    postures: tuple[Posture, ...], modes_of_run: int, count: int
) -> PostureModes:
    """First `count` modes in the middle one of `postures`, with CAD parts as solids.

    The end conditions are those of the robot file, otherwise rigid interfaces. `modes_of_run`:
    number of modes that the run computes. It determines the frequency up to which reduced parts are
    accurate; modes above it are omitted.
    """
    middle, mechanism = _middle_posture(postures), postures[0].mechanism
    parts = solid_parts(postures, modes_of_run, holding(mechanism).first)
    highest = min(part.highest for part in parts.values())
    bodies = dynamic_bodies("beam", mechanism, highest, _CONDENSED)
    (posture_modes,) = modes_along(assembly(mechanism, {**bodies, **parts}), [middle], count)
    kept_modes = posture_modes.modes.frequencies <= highest
    return replace(
        posture_modes,
        modes=Modes(
            posture_modes.modes.frequencies[kept_modes], posture_modes.modes.shapes[:, kept_modes]
        ),
    )


def _modes_with_condensed_parts(middle: Posture, count: int) -> PostureModes:
    highest = highest_frequency((middle,), count)
    bodies = dynamic_bodies("segments", middle.mechanism, highest, _CONDENSED)
    (posture_modes,) = modes_along(assembly(middle.mechanism, bodies), [middle], count)
    return posture_modes


@figures.figure("mechanism.pairs", "Modes paired by shape with those of the reference", effort=2.0)
def pairs(context: Context) -> Chart:
    """Chart comparing modes of beams and of segments with those of the reference.

    It has a panel with the MAC for each model, and one with the differences of frequency.
    """
    robot = robot_on_path(context)
    responses = Responses(robot)
    reference = dynamic_reference(responses)
    if reference.model is None:
        raise Skip(f"no reference for the frequencies: {reference.decides}")
    interpretation = reference.interpretations[0]
    reference_modes = responses.required_modes(reference.model, interpretation.reading)
    middle_modes = _middle_pose_modes(reference_modes)
    count = middle_modes.frequencies.shape[1]
    models = {
        name: _middle_pose_modes(modes)
        for name in _MODELS
        if (modes := modes_by_model(robot, name, DEFAULT_OPTIONS))
    }
    numbers = np.arange(1.0, count + 1.0)
    columns: dict[str, Column] = {
        "mode": numbers.tolist(),
        "reference (Hz)": middle_modes.frequencies[0].tolist(),
    }
    panels: list[Panel] = []
    changes: list[Series] = []
    for name, model in models.items():
        mac = mac_matrix(*(path_modes.at(0) for path_modes in (middle_modes, model)))
        label = "" if panels else "mode of the reference"
        panels.append(Panel((), f"MAC with {name}", label, x_label=f"mode of {name}", matrix=mac))
        pairing = partners(middle_modes, model, count)
        change = 100.0 * (pairing.frequency[0] / middle_modes.frequencies[0] - 1.0)
        changes.append(Series(name, numbers, change))
        columns |= {
            f"{name}: partner": [float(k) + 1.0 for k in pairing.partner_indices[0]],
            f"{name} (Hz)": pairing.frequency[0].tolist(),
            f"{name}: MAC": pairing.mac[0].tolist(),
        }
    panels.append(Panel(changes, "difference (%)", levels=(0.0,), staggered=False))
    return Chart(panels, "mode of the reference", len(panels), 2.0, columns).captioned(
        f"Modes at the middle pose of the path. Reference: {reference.title} "
        f"({interpretation.name or 'solid'}). MAC panels: energy-weighted modal assurance "
        "criterion of each mode of the reference (row) with each mode of the model "
        "(column); black: 1, equal shapes; white: 0. A black diagonal means that the "
        "model has the same modes in the same order. A dark block of several cells means "
        "modes of nearly equal frequency, whose shapes may mix. Last panel: frequency "
        "difference, model − reference, of paired modes in percent; modes without a "
        "partner are not shown.",
    )


def _middle_pose_modes(modes: PathModes) -> PathModes:
    """Modes in the middle pose only. Missing modes (NaN) are removed."""
    middle = len(modes.frequencies) // 2
    finite = np.isfinite(modes.frequencies[middle])
    return PathModes(
        modes.frequencies[middle : middle + 1, finite],
        modes.samples[middle : middle + 1][:, :, finite],
        modes.weights,
        modes.energy_shares[middle : middle + 1, finite],
    )


@figures.figure(
    "mechanism.strain-energy", "Distribution of the strain energy of the first modes", effort=2.0
)
def energies(context: Context) -> Chart:
    """Chart of strain energy: a stacked bar for each mode, by kind of deformation and by body."""
    mechanism = context.robot_file.mechanism
    if not (known_legs(mechanism) or mechanism.parts):
        raise Skip("every body is rigid, so that only drives and joints store strain energy")
    posture_modes = finite_elements(context, ENERGY_MODES)
    frequencies = posture_modes.modes.frequencies
    model = "model of parts as solids" if mechanism.parts else "beam model"
    kinds = (
        (
            "Bending y: about the y axis of the leg, with deflection along its z axis. Bending z: "
            "about its z axis, with deflection along y. Both include shear."
        )
        if known_legs(mechanism)
        else ("The strain energy of a CAD part is not divided into bending, torsion and tension.")
    )
    shares = {
        "(a) by kind of deformation": shares_by_kind(posture_modes.strain, mechanism),
        "(b) by body": _shares_by_body(posture_modes.strain, mechanism),
    }
    names = [f"{number}: {frequency:.1f} Hz" for number, frequency in enumerate(frequencies, 1)]
    panels = [
        Panel(
            title=title,
            y_label="strain energy (%)",
            bars=[Bars(name, 100.0 * share) for name, share in shares_by_name.items()],
            names=names,
        )
        for title, shares_by_name in shares.items()
    ]
    table: dict[str, Column] = {
        "mode": [float(number) for number in range(1, len(frequencies) + 1)],
        "frequency (Hz)": frequencies.tolist(),
    }
    table |= {
        f"{part} (%)": (100.0 * share).tolist() for part, share in posture_modes.strain.items()
    }
    count = len(frequencies)
    first = f"The first {count} modes" if count > 1 else "The first mode"
    return Chart(panels, "mode", 1, 2.4, table).captioned(
        "Share of each kind of deformation and of each body in the strain energy (%). "
        f"{first} of the {model} at the middle pose of the path, {number(frequencies[0], 4)} to "
        f"{number(frequencies[-1], 4)} Hz. A mode is governed by the stiffness of the component "
        "with the largest share.",
        kinds,
        "Bodies of equal shape are summed; the CSV file lists each body.",
    )


def _shares_by_body(strain: Portions, mechanism: Mechanism) -> Shares:
    """Shares of strain energy of drives, joints, CAD parts and legs.

    The shares of legs of equal shape are summed.
    """
    groups: dict[object, list[str]] = {name: [name] for name in mechanism.parts}
    for name, leg in known_legs(mechanism).items():
        groups.setdefault(name if isinstance(leg, GivenLeg) else leg, []).append(name)
    label = {name: _listed(names) for names in groups.values() for name in names}
    return sum_shares(
        strain, lambda part: label.get(part.of) or (DRIVES if part.kind == "drive" else JOINTS)
    )


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) <= 3 else f"{names[0]} to {names[-1]} ({len(names)})"
