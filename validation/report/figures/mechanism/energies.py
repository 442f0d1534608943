"""What carries the strain energy of a mechanism's first modes: which bodies, which deformation."""

from collections.abc import Mapping, Sequence

from lumped.arrays import Array
from lumped.legs import ConstantLeg
from lumped.mechanism.mechanism import Mechanism
from lumped.system.joint_motion import Portion
from validation.adequacy.mechanism.path import known_legs
from validation.case import Skip
from validation.context import Context
from validation.drawing.charts.chart import Bars, Chart, Column, Panel
from validation.exhibits import MODES
from validation.report.figures.declared import FigureGroup, Shown, curves
from validation.report.figures.mechanism.drawn_modes import finite_elements
from validation.report.figures.mechanism.mode_names import DRIVES, JOINTS, by_kind, summed
from validation.solids.legs import SHARED_SOLIDS

Portions = Mapping[Portion, Array]
Shares = Mapping[str, Array]
SIXTY = 60
figures = FigureGroup(MODES, SHARED_SOLIDS)


@figures.figure(
    "mechanism.strain-energy", "Where the strain energy of the first modes sits", effort=2.0
)
def energies(context: Context) -> Shown:
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
    return curves(
        Chart(panels, "mode", 1, 2.4, table),
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
