"""Maps of each quantity over the workspace as contours, values and a table.

Input: the run's robot, whose path is a grid. Output: `WorkspaceMaps`. Its chart has slices if the
grid has three directions, and a star at the worst posture of each quantity.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import prod
from textwrap import fill
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import Posture
from validation.case import Skip
from validation.context import Context, Preset
from validation.drawing.chart import Chart, Column, Contours, Panel, few_ticks
from validation.drawing.figures import FigureGroup
from validation.drawing.text import number
from validation.maps.quantities import MappedQuantity, mapped_quantities
from validation.maps.workspace import (
    Indices,
    Workspace,
    WorstPosture,
    evenly,
    grid_values,
    workspace,
    worst_posture,
)
from validation.record_fields import finite_items
from validation.references.responses import Responses
from validation.references.robot_on_path import coordinates, path_postures, robot_at
from validation.report.words import capital
from validation.solids.solid_legs import SHARED_SOLIDS
from validation.studies_and_figures import PATH, MapStudy, WorstValue
from validation.tables import ResultTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Largest number of poses of the grid that are evaluated.
_MAX_POSES: Mapping[Preset, int] = {"quick": 81, "standard": 400, "fine": 2500}
# Largest number of slices; fewest postures of a map; height of a row of panels (inches).
_SLICES, _FEWEST_POSTURES, _ROW_HEIGHT = 4, 4, 2.1
# Characters that fit above one of three columns.
_TITLE_WIDTH = 26
# Quantity, its values at the grid points, and its worst posture.
Map: TypeAlias = tuple[MappedQuantity, Array, WorstPosture]
figures = FigureGroup(PATH, SHARED_SOLIDS)


@dataclass(frozen=True, eq=False)
class WorkspaceMaps:
    """Maps over the workspace of a robot: quantities with their values and worst postures.

    `space`: postures on the grid. `maps`: for each map, its quantity, the values at the grid points
    and the worst posture.

    Examples
    --------
    >>> grid = {"from": [-0.2, 0.4], "to": [0.2, 0.5], "counts": [3, 2]}
    >>> maps = workspace({**load("five-bar").tables, "path": grid}, preset="quick")
    """

    space: Workspace
    maps: tuple[Map, ...]

    def chart(self) -> Chart:
        """Chart with a column for each quantity and a row for each slice."""
        space, maps = self.space, self.maps
        names = [str(coordinates(space.mechanism)[move]) for move in space.varied]
        return Chart(
            _panels(space, names, maps),
            names[0],
            len(maps),
            _ROW_HEIGHT,
            _table(space, names, maps),
            partial(few_ticks, count=2),
        )

    def values(self, quantity: str) -> Array:
        """Values of a quantity over the grid.

        Parameters
        ----------
        quantity
            A quantity of the table, such as ``"first frequency"``.

        Returns
        -------
        array
            In the unit of the table, an axis for each direction. NaN for poses that cannot be
            reached or solved.

        Raises
        ------
        InputError
            For a quantity that is not mapped.

        Examples
        --------
        >>> maps.values("lowest stiffness").shape
        (3, 2)
        """
        for mapped, values, _ in self.maps:
            if mapped.title == quantity:
                return values
        titles = ", ".join(mapped.title for mapped, *_ in self.maps)
        raise InputError(f'quantity "{quantity}": is not mapped; must be one of {titles}')

    def table(self) -> ResultTable:
        """Quantities, a row for each: its model, its worst value and the pose of that value.

        Returns
        -------
        ResultTable
            The worst posture is also searched between the poses of the grid.

        Examples
        --------
        >>> [row[0] for row in maps.table().rows][:2]
        ['lowest stiffness', 'first frequency']
        """
        names = [str(coordinate) for coordinate in coordinates(self.space.mechanism)]
        return ResultTable(
            ("quantity", "unit", "model", "worst value", *names),
            tuple(
                (mapped.title, mapped.unit, mapped.model, worst.value, *worst.pose.tolist())
                for mapped, _, worst in self.maps
            ),
        )

    def plot(self) -> "Figure":
        """Contours of each quantity over the workspace.

        Returns
        -------
        matplotlib.figure.Figure
            Dots are the poses of the grid, stars the worst postures. Three directions are drawn in
            slices.

        Examples
        --------
        >>> maps.plot().savefig("maps.png")
        """
        # Only a plot needs matplotlib, which is slow to import.
        from validation.drawing.plot import drawn_chart  # noqa: PLC0415

        return drawn_chart(self.chart())

    def __repr__(self) -> str:
        titles = ", ".join(mapped.title for mapped, *_ in self.maps)
        return f"WorkspaceMaps({self.space.mechanism.name}: {titles})"

    def _repr_html_(self) -> str:
        return self.table().html()


def workspace_maps(context: Context) -> WorkspaceMaps:
    """Maps of the run's robot. Raises Skip if too few postures can be reached or solved."""
    mechanism = replace(context.robot_file.mechanism, loads=())
    space = workspace(mechanism, _MAX_POSES[context.preset])
    if len(space.postures) < _FEWEST_POSTURES:
        raise Skip("fewer than four poses of the grid can be reached; a map needs at least four")
    on_path = [replace(posture, mechanism=mechanism) for posture in path_postures(context)]
    responses = Responses(robot_at(context, on_path), strict=True)
    maps: list[Map] = []
    for mapped in mapped_quantities(responses, context.robot_file.requirement):
        solve = partial(_values_at, responses, mapped)
        values = grid_values(space, solve)
        if worst := worst_posture(space, values, solve, largest=mapped.largest):
            maps.append((mapped, values, worst))
    if not maps:
        raise Skip("the models have no solution at any pose of the grid")
    return WorkspaceMaps(space, tuple(maps))


def _values_at(responses: Responses, mapped: MappedQuantity, postures: Sequence[Posture]) -> Array:
    """Values of a mapped quantity, one for each of `postures`, which need not be on the path."""
    return mapped.values(responses.at(postures))


@figures.figure("mechanism.maps", "Maps over the workspace", effort=3.0)
def maps(context: Context) -> Chart:
    """Chart of all maps with caption and data: a column for each quantity, a row for each slice."""
    robot_maps = workspace_maps(context)
    space = robot_maps.space
    studies = [_study(space, *one_map) for one_map in robot_maps.maps]
    return replace(robot_maps.chart(), caption=_caption(space, robot_maps.maps), studies=studies)


def _panels(space: Workspace, names: Sequence[str], maps: Sequence[Map]) -> list[Panel]:
    """Panels row by row. Each row has a panel for each map.

    If two coordinates vary, there is one row; if three vary, there is a row for each slice.
    `names`: names of the varied coordinates with their units.
    """
    x, y, *third = space.axes
    slices: list[Indices] = [()]
    if third:
        slices = [(int(k),) for k in evenly(len(third[0]), _SLICES)]
    panels = []
    for indices in slices:
        level = [names[2].replace(" (", f" = {third[0][k]:.4g} ")[:-1] + "\n" for k in indices]
        for mapped, values, worst in maps:
            star = worst.pose[list(space.varied)]
            nearest = min(slices, key=lambda index: [abs(third[0][k] - star[2]) for k in index])
            contours = Contours(
                x,
                y,
                values[:, :, indices[0]] if indices else values,
                (float(np.nanmin(values)), float(np.nanmax(values))),
                (float(star[0]), float(star[1])) if indices == nearest else None,
            )
            # Long names of models continue on a second line.
            title = f"{mapped.title} ({mapped.unit})" if indices == slices[0] else ""
            panels.append(
                Panel(
                    title=fill(title, _TITLE_WIDTH, break_on_hyphens=False),
                    y_label="".join((*level, names[1])) if mapped is maps[0][0] else "",
                    contours=contours,
                )
            )
    return panels


def _caption(space: Workspace, maps: Sequence[Map]) -> str:
    mechanism, poses = space.mechanism, prod(space.shape)
    sentences = [
        (
            f"{capital(mapped.title)}: {mapped.description}. Worst value: "
            f"{number(worst.value, 4)} {mapped.unit} at {shown_pose(mechanism, worst.pose)}."
        )
        for mapped, _, worst in maps
    ]
    sentences.append(
        (
            "Contours over the poses of the tool. Dots: computed poses of the grid. Stars: "
            "worst poses, found by a search that also solves poses between the dots"
        )
        + (". A star is drawn in the slice nearest to its pose." if len(space.axes) > 2 else ".")
    )
    if poses < len(mechanism.poses):
        sentences.append(f"{poses} of the {len(mechanism.poses)} poses of the grid are computed.")
    if blank := poses - int(np.isfinite(maps[0][1]).sum()):
        sentences.append(f"Blank areas: {blank} of {poses} poses are out of reach or singular.")
    return " ".join(sentences)


def _table(space: Workspace, names: Sequence[str], maps: Sequence[Map]) -> dict[str, Column]:
    """Columns of data: all poses of the grid with their values, followed by the worst postures.

    `names`: names of the varied coordinates with their units.
    """
    poses = [space.pose(indices) for indices in np.ndindex(*space.shape)]
    poses += [worst.pose for *_, worst in maps]
    kinds = ["grid"] * (len(poses) - len(maps)) + [f"worst {mapped.title}" for mapped, *_ in maps]
    table: dict[str, Column] = {"posture": kinds}
    for name, move in zip(names, space.varied, strict=True):
        table[name] = [float(pose[move]) for pose in poses]
    for k, (mapped, values, worst) in enumerate(maps):
        column = [*finite_items(values.ravel()), *[None] * len(maps)]
        column[k - len(maps)] = worst.value
        table[f"{mapped.title} ({mapped.unit})"] = column
    return table


def _study(
    space: Workspace, mapped: MappedQuantity, values: Array, worst: WorstPosture
) -> MapStudy:
    """Entry of "studies" in results.json for a map."""
    return MapStudy(
        id=mapped.id,
        title=mapped.title,
        unit=mapped.unit,
        model=mapped.model,
        moves=tuple(space.mechanism.tool.moves[move] for move in space.varied),
        x=tuple(tuple(axis.tolist()) for axis in space.axes),
        values=tuple(finite_items(values)),
        worst=WorstValue(tuple(worst.pose.tolist()), worst.value),
    )
