"""Result record of `forces`: forces and stresses with tables, plots, text, CSV and JSON.

Input: `PoseForces` of each pose. Output: `Forces`, and its text for the terminal.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from lumped.arrays import Array
from lumped.text import aligned
from validation.drawing.chart import Chart
from validation.drawing.style import csv_of
from validation.forces.chart import forces_chart
from validation.forces.results import (
    LAYER_STRESSES,
    REACTION_UNITS,
    REACTIONS,
    SECTION_FORCES,
    ForcesUnderLoad,
    PoseForces,
    largest_of,
    shown,
)
from validation.forces.stresses import LaminateStress
from validation.models.options import ModelName
from validation.record_fields import finite, finite_items
from validation.tables import Cell, ResultTable, html_paragraph

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# Keys of the stresses of a layer in JSON, in the order of `LAYER_STRESSES`.
_LAYER_KEYS = ("along_fibres", "across_fibres", "shear")


@dataclass(frozen=True)
class Forces:
    """Reactions, drive forces, member forces and stresses under the loads of a robot file.

    A reaction is the wrench (N, N m) that a joint exerts on its second body. It refers to the
    joint's point on its first body and to joint axes: x along the joint's axis. Member forces act
    in a section of a leg, on the part between the section and the root, in the axes of the section:
    x along the leg's line. At a corner both sides have a row, with one station. All forces have
    half-widths of their numerical uncertainty.

    Examples
    --------
    >>> push = {"name": "push", "wrench": [0.0, 0.0, -100.0, 0.0, 0.0, 0.0]}
    >>> pushed = forces({**bar, "loads": [push]})
    """

    robot: str
    model: ModelName
    options: Mapping[str, Any]
    moves: tuple[str, ...]
    poses: tuple[PoseForces, ...]

    @property
    def first_load(self) -> str:
        """Name of the first load.

        Examples
        --------
        >>> pushed.first_load
        'push'
        """
        return next(iter(self.poses[0].loads))

    def table(self) -> ResultTable:
        """Reactions of joints and forces of drives, a row for each pose, load and joint.

        Returns
        -------
        ResultTable
            Forces (N) and moments (N m) in joint axes, the force of the drive (N or N m), and the
            half-width of the forces. Statically indeterminate numbers are missing.

        Examples
        --------
        >>> _, load, joint, *wrench, drive, half_width = pushed.table().rows[0]
        >>> print(f"{joint}: Fz = {wrench[2]:.3f} N, My = {wrench[4]:.3f} N m")
        clamp: Fz = 100.000 N, My = -30.000 N m
        """
        rows: list[tuple[Cell, ...]] = []
        for pose_text, load, result in self._results():
            scale = largest_of(result)
            rows += [
                (
                    pose_text,
                    load,
                    reaction.joint,
                    *shown(reaction.wrench, scale),
                    None if reaction.drive is None else finite(reaction.drive),
                    float(reaction.half_width[:3].max()),
                )
                for reaction in result.reactions
            ]
        headings = [
            f"{name} ({unit})" for name, unit in zip(REACTIONS, REACTION_UNITS, strict=True)
        ]
        return ResultTable(
            ("at", "load", "joint", *headings, "drive (N, N m)", "half-width (N)"), tuple(rows)
        )

    def member_table(self) -> ResultTable:
        """Largest section forces and stress of legs, a row for each pose, load and leg.

        Returns
        -------
        ResultTable
            Largest magnitudes along the leg of N, Qy, Qz (N), T, My, Mz (N m), the largest von
            Mises stress (MPa) with its half-width and its distance from the root (m). Stresses of
            legs without a known section are missing.

        Examples
        --------
        >>> row = pushed.member_table().rows[0]
        >>> print(f"{row[2]}: My = {row[7]:.3f} N m, von Mises {row[9]:.3f} MPa")
        bar: My = 30.000 N m, von Mises 22.500 MPa
        """
        rows: list[tuple[Cell, ...]] = []
        for pose_text, load, result in self._results():
            scale = largest_of(result)
            for member in result.members:
                stress = result.stresses.get(member.leg)
                of_stress: tuple[Cell, ...] = (None, None, None)
                if stress is not None:
                    of_stress = (1e-6 * stress.largest, 1e-6 * stress.half_width, stress.station)
                largest = np.abs(member.forces).max(axis=0)
                rows.append((pose_text, load, member.leg, *shown(largest, scale), *of_stress))
        headings = [
            f"{name} ({unit})" for name, unit in zip(SECTION_FORCES, REACTION_UNITS, strict=True)
        ]
        stress_headings = ("von Mises (MPa)", "half-width (MPa)", "at (m)")
        return ResultTable(("at", "load", "leg", *headings, *stress_headings), tuple(rows))

    def layer_table(self) -> ResultTable:
        """Stresses of the fibre layers of legs, a row for each pose, load, leg and layer.

        Returns
        -------
        ResultTable
            Layer from the inside with its angle (degrees), and the smallest and largest stresses
            (MPa) over the leg along the fibres, across them, and in shear, each followed by its
            half-width. Without rows if no leg has layers.

        Examples
        --------
        >>> len(pushed.layer_table().rows)
        0
        """
        rows: list[tuple[Cell, ...]] = [
            (
                pose_text,
                load,
                laminate.leg,
                layer,
                angle,
                *(1e-6 * number for stress in stresses for number in stress),
            )
            for pose_text, load, result in self._results()
            for laminate in result.laminates.values()
            for layer, (angle, stresses) in enumerate(_layers(laminate), start=1)
        ]
        headings = [
            f"{name} {extreme} (MPa)"
            for name in LAYER_STRESSES
            for extreme in ("min", "max", "half-width")
        ]
        return ResultTable(("at", "load", "leg", "layer", "angle (°)", *headings), tuple(rows))

    def plot(self) -> "Figure":
        """Plot of forces along the legs in one pose, or of joints, drives and legs over all poses.

        Returns
        -------
        matplotlib.figure.Figure
            Forces under the first load. `plot_load` draws those under another.

        Examples
        --------
        >>> pushed.plot().savefig("forces.png")
        """
        return self.plot_load(self.first_load)

    def plot_load(self, load: str) -> "Figure":
        """Plot like that of `plot`, for the load with the name `load`.

        Parameters
        ----------
        load
            Name of the load in the robot file.

        Returns
        -------
        matplotlib.figure.Figure
            Forces under this load.

        Examples
        --------
        >>> pushed.plot_load("push").savefig("push.png")
        """
        # Only a picture needs the library that draws it.
        from validation.drawing.plot import drawn_chart  # noqa: PLC0415

        return drawn_chart(self.chart(load))

    def chart(self, load: str) -> Chart:
        """Chart of the forces under the load with the name `load`."""
        return forces_chart(self.poses, self.model, self.moves, load)

    def csv(self) -> str:
        """Convert to comma-separated values.

        Returns
        -------
        str
            A row for each number: pose, load, joint or leg, quantity, distance from the leg's root
            (m), value, unit and half-width.

        Examples
        --------
        >>> pushed.csv().splitlines()[0]
        'pose,load,of,quantity,station (m),value,unit,half-width'
        """
        headings = ("pose", "load", "of", "quantity", "station (m)", "value", "unit", "half-width")
        rows = list(self._rows())
        return csv_of(dict(zip(headings, zip(*rows, strict=True), strict=True)))

    def json(self) -> str:
        """Convert to JSON, as ``flexproof forces --json`` prints it.

        Returns
        -------
        str
            Numbers in SI units. A statically indeterminate force is null.

        Examples
        --------
        >>> pushed.json()[:12]
        '{"schema": 1'
        """
        results = [
            {
                "pose": list(pose.pose),
                "loads": {
                    load: None if result is None else _record(result)
                    for load, result in pose.loads.items()
                },
            }
            for pose in self.poses
        ]
        document = {
            "schema": 1,
            "robot": self.robot,
            "model": self.model,
            "options": dict(self.options),
            "results": results,
        }
        return json.dumps(document, allow_nan=False)

    def _results(self) -> Iterator[tuple[str, str, ForcesUnderLoad]]:
        for pose in self.poses:
            for load, result in pose.loads.items():
                if result is not None:
                    yield pose.place, load, result

    def _rows(self) -> Iterator[tuple[Cell, ...]]:
        for pose_text, load, result in self._results():
            for reaction in result.reactions:
                numbers = zip(
                    REACTIONS, reaction.wrench, REACTION_UNITS, reaction.half_width, strict=True
                )
                for name, value, unit, width in numbers:
                    number = (name, None, finite(value), unit, finite(width))
                    yield (pose_text, load, reaction.joint, *number)
                if reaction.drive is not None:
                    width = float(reaction.half_width[0 if reaction.drive_unit == "N" else 3])
                    drive = ("drive", None, finite(reaction.drive), reaction.drive_unit)
                    yield (pose_text, load, reaction.joint, *drive, finite(width))
            for member in result.members:
                for station, values in zip(member.stations, member.forces, strict=True):
                    numbers = zip(
                        SECTION_FORCES, values, REACTION_UNITS, member.half_width, strict=True
                    )
                    for name, value, unit, width in numbers:
                        force = (name, float(station), finite(value), unit, finite(width))
                        yield (pose_text, load, member.leg, *force)
            for leg, stress in result.stresses.items():
                largest = ("von Mises", stress.station, stress.largest, "Pa", stress.half_width)
                yield (pose_text, load, leg, *largest)
            for leg, laminate in result.laminates.items():
                for layer, (_, stresses) in enumerate(_layers(laminate), start=1):
                    for name, (*extremes, width) in zip(LAYER_STRESSES, stresses, strict=True):
                        for extreme, value in zip(("min", "max"), extremes, strict=True):
                            quantity = f"{extreme} {name} of layer {layer}"
                            yield (pose_text, load, leg, quantity, None, value, "Pa", width)

    def __repr__(self) -> str:
        places = self.poses[0].place if len(self.poses) == 1 else f"{len(self.poses)} poses"
        return f"Forces({self.robot}, {self.model}: {places})"

    def _repr_html_(self) -> str:
        heading = html_paragraph(f"{self.robot}, {self.model}")
        return heading + self.table().html() + self.member_table().html()


def _layers(
    laminate: LaminateStress,
) -> Iterator[tuple[float, list[tuple[float, float, float]]]]:
    """Yield the angle (degrees) of each layer and its stresses along and across fibres, in shear.

    A stress is the smallest and the largest value over the leg, and the half-width (Pa).
    """
    for row, angle in enumerate(laminate.angles):
        columns = (laminate.smallest[row], laminate.largest[row], laminate.half_widths[row])
        yield angle, list(zip(*(column.tolist() for column in columns), strict=True))


def _record(result: ForcesUnderLoad) -> dict[str, Any]:
    """Plain data of the forces under one load, for JSON."""
    return {
        "reactions": {
            reaction.joint: finite_items(reaction.wrench) for reaction in result.reactions
        },
        "drives": {
            reaction.joint: finite(reaction.drive)
            for reaction in result.reactions
            if reaction.drive is not None
        },
        "members": {
            member.leg: {
                "stations": member.stations.tolist(),
                "forces": finite_items(member.forces),
            }
            for member in result.members
        },
        "stresses": {
            leg: {
                "von_mises": stress.largest,
                "station": stress.station,
                "point": list(stress.point),
                "normal": stress.normal,
                "shear": stress.shear,
                "along": stress.along.tolist(),
                **({"parts": list(stress.parts)} if stress.parts else {}),
            }
            for leg, stress in result.stresses.items()
        },
        "layers": {
            leg: [
                {
                    "angle": angle,
                    **{
                        name: {"min": low, "max": high, "half_width": finite(width)}
                        for name, (low, high, width) in zip(_LAYER_KEYS, stresses, strict=True)
                    },
                }
                for angle, stresses in _layers(laminate)
            ]
            for leg, laminate in result.laminates.items()
        },
        "without_stress": dict(result.without_stress),
        "solids": {
            body: {
                "von_mises": solid.largest,
                "half_width": finite(solid.half_width),
                "place": list(solid.place),
                "distance": solid.distance,
            }
            for body, solid in result.solids.items()
        },
        "uncertainty": {
            "reactions": {
                reaction.joint: finite_items(reaction.half_width) for reaction in result.reactions
            },
            "members": {member.leg: finite_items(member.half_width) for member in result.members},
            "stresses": {leg: finite(stress.half_width) for leg, stress in result.stresses.items()},
        },
    }


_INDENT = "    "
_NONE = (
    "  none: the mechanism cannot move as the load requires, or no wrench is given for this pose"
)


def as_text(forces: Forces) -> str:
    """Text with reactions, section forces and stresses, for each pose and load."""
    options = ", ".join(f"{name} {value}" for name, value in forces.options.items())
    lines = [f"{forces.robot}, {forces.model}" + (f" ({options})" if options else "")]
    for pose in forces.poses:
        for load, result in pose.loads.items():
            lines += ["", f"{pose.place}, load {load}"]
            lines += [_NONE] if result is None else _lines(result)
    return "\n".join(lines)


def _lines(result: ForcesUnderLoad) -> list[str]:
    scale = largest_of(result)
    lines = ["  joints on their second bodies, joint axes (x along the joint):"]
    headings = ["joint", *_with_units(REACTIONS), "drive"]
    rows = [
        [
            reaction.joint,
            *_texts(reaction.wrench, scale),
            "" if reaction.drive is None else _texts(np.array([reaction.drive]), scale)[0],
        ]
        for reaction in result.reactions
    ]
    lines.append(aligned(headings, rows, _INDENT))
    if result.members:
        lines.append("  legs, largest magnitudes along them, section axes (x along the leg):")
        headings = ["leg", *_with_units(SECTION_FORCES)]
        rows = [
            [member.leg, *_texts(np.abs(member.forces).max(axis=0), scale)]
            for member in result.members
        ]
        lines.append(aligned(headings, rows, _INDENT))
    if result.stresses:
        lines.append("  largest von Mises stresses in their sections (beam theory):")
        for leg, stress in result.stresses.items():
            # Nanometres are round-off of a point in a section.
            y, z = (f"{round(1e3 * value, 6) + 0.0:.4g}" for value in stress.point)
            lines.append(
                f"{_INDENT}{leg}: {1e-6 * stress.largest:.4g} ± {1e-6 * stress.half_width:.2g} MPa "
                f"at {stress.station:.4g} m, in y = {y} mm, z = {z} mm "
                f"(σ {1e-6 * stress.normal:.4g} MPa, τ {1e-6 * stress.shear:.4g} MPa)"
            )
            if stress.parts:
                parts = ", ".join(f"{1e-6 * largest:.4g}" for largest in stress.parts)
                lines.append(f"{_INDENT}{leg}: in that section, largest in each part: {parts} MPa")
    if result.laminates:
        lines.append(
            "  smallest to largest stresses (MPa) of layers from the inside, along and across "
            "fibres, in shear (laminate theory):"
        )
        headings = ["leg", "layer", "angle (°)", *LAYER_STRESSES]
        rows = [
            [leg, str(layer), f"{angle:g}", *map(_range_text, stresses)]
            for leg, laminate in result.laminates.items()
            for layer, (angle, stresses) in enumerate(_layers(laminate), start=1)
        ]
        lines.append(aligned(headings, rows, _INDENT))
    for body, solid in result.solids.items():
        point = ", ".join(f"{value:.4g}" for value in solid.place)
        lines.append(
            f"{_INDENT}{body} as a solid: {1e-6 * solid.largest:.4g} ± "
            f"{1e-6 * solid.half_width:.2g} MPa at ({point}) m, farther than "
            f"{1e3 * solid.distance:.3g} mm from singular edges"
        )
    for leg, reason in result.without_stress.items():
        lines.append(f"{_INDENT}{leg}: no stress, {reason}")
    half_width = max(
        (float(reaction.half_width[:3].max()) for reaction in result.reactions), default=0.0
    )
    along = max((float(member.half_width[:3].max()) for member in result.members), default=0.0)
    lines.append(f"  half-width of the forces: joints {half_width:.2g} N, legs {along:.2g} N")
    if any(np.isnan(reaction.wrench).any() for reaction in result.reactions):
        lines.append(
            "  –: statically indeterminate; loops of rigid bodies carry any self-balanced forces"
        )
    return lines


def _range_text(stress: tuple[float, float, float]) -> str:
    low, high, width = (1e-6 * number for number in stress)
    return f"{low:.4g} to {high:.4g} ± {width:.2g}"


def _with_units(names: Sequence[str]) -> list[str]:
    return [f"{name} ({unit})" for name, unit in zip(names, REACTION_UNITS, strict=True)]


def _texts(values: Array, scale: float) -> list[str]:
    return ["–" if value is None else f"{value:.5g}" for value in shown(values, scale)]
