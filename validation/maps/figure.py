"""Maps over the workspace: contours of each quantity, three directions in slices, worst marked."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import prod
from textwrap import fill
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import shown_pose
from validation.adequacy.mechanism.path import coordinates
from validation.case import Skip
from validation.context import Context, Preset
from validation.drawing.chart import Chart, Column, Contours, Panel, few_ticks
from validation.drawing.style import plot_style
from validation.drawing.text import number
from validation.exhibits import PATH
from validation.maps.quantities import Mapped, mapped
from validation.maps.workspace import (
    Place,
    Workspace,
    WorstPosture,
    evenly,
    values_on,
    workspace,
    worst_posture,
)
from validation.report.declared import FigureGroup, Shown
from validation.report.words import capital
from validation.solids.legs import SHARED_SOLIDS
from validation.tables import ResultTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Postures of a large grid that are looked at.
_MOST: Mapping[Preset, int] = {"quick": 81, "standard": 400, "fine": 2500}
_SLICES, _FEWEST, _HIGH = 4, 4, 2.1
# Letters that fit above one of three columns.
_LETTERS = 26
# A quantity with its values over the grid and its worst posture.
Map: TypeAlias = tuple[Mapped, Array, WorstPosture]
figures = FigureGroup(PATH, SHARED_SOLIDS)


@dataclass(frozen=True, eq=False)
class WorkspaceMaps:
    """Maps over the workspace of a robot: quantities with their values and worst postures.

    Examples
    --------
    >>> grid = {"from": [-0.2, 0.4], "to": [0.2, 0.5], "counts": [3, 2]}
    >>> maps = workspace({**load("five-bar").tables, "path": grid}, preset="quick")
    """

    space: Workspace
    maps: tuple[Map, ...]

    def chart(self) -> Chart:
        """The figure declared: a column for each quantity, a row for each slice."""
        space, found = self.space, self.maps
        names = [str(coordinates(space.mechanism)[move]) for move in space.moves]
        return Chart(
            _panels(space, names, found),
            names[0],
            len(found),
            _HIGH,
            _table(space, names, found),
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
        for one, values, _ in self.maps:
            if one.title == quantity:
                return values
        titles = ", ".join(one.title for one, *_ in self.maps)
        raise InputError(f'quantity "{quantity}": is not mapped; must be one of {titles}')

    def table(self) -> ResultTable:
        """Quantities, a row for each: its model, its worst value and the posture of that.

        Returns
        -------
        ResultTable
            The worst posture is searched between the poses of the grid, too.

        Examples
        --------
        >>> [row[0] for row in maps.table().rows][:2]
        ['lowest stiffness', 'first frequency']
        """
        names = [str(one) for one in coordinates(self.space.mechanism)]
        return ResultTable(
            ("quantity", "unit", "model", "worst value", *names),
            tuple(
                (one.title, one.unit, one.model, worst.value, *worst.pose.tolist())
                for one, _, worst in self.maps
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
        # Only a picture needs the library that draws it.
        from validation.drawing.plot import drawn_chart  # noqa: PLC0415

        with plot_style():
            return drawn_chart(self.chart())

    def __repr__(self) -> str:
        titles = ", ".join(one.title for one, *_ in self.maps)
        return f"WorkspaceMaps({self.space.mechanism.name}: {titles})"

    def _repr_html_(self) -> str:
        return self.table().html()


def workspace_maps(context: Context) -> WorkspaceMaps:
    """The maps of the run's robot; raises Skip if too few postures can be reached or solved."""
    mechanism = replace(context.robot_file.mechanism, loads=())
    space = workspace(mechanism, _MOST[context.preset])
    if len(space.postures) < _FEWEST:
        raise Skip("fewer than four postures of the grid can be reached")
    found: list[Map] = []
    for one in mapped(context, mechanism):
        values = values_on(space, one.solve)
        if worst := worst_posture(space, values, one.solve, largest=one.largest):
            found.append((one, values, worst))
    if not found:
        raise Skip("no posture of the grid can be solved")
    return WorkspaceMaps(space, tuple(found))


@figures.figure("mechanism.maps", "Maps over the workspace", effort=3.0)
def maps(context: Context) -> Shown:
    """A column for each quantity, a row for each slice."""
    found = workspace_maps(context)
    studies = [_study(found.space, *one) for one in found.maps]
    return Shown(_caption(found.space, found.maps), found.chart(), studies=studies)


def _panels(space: Workspace, names: Sequence[str], found: Sequence[Map]) -> list[Panel]:
    """Row by row: one in two directions, slices of the grid across the third."""
    x, y, *across = space.axes
    slices: list[Place] = [()]
    if across:
        slices = [(int(k),) for k in evenly(len(across[0]), _SLICES)]
    panels = []
    for place in slices:
        level = [names[2].replace(" (", f" = {across[0][k]:.4g} ")[:-1] + "\n" for k in place]
        for one, values, worst in found:
            star = worst.pose[list(space.moves)]
            nearest = min(slices, key=lambda own: [abs(across[0][k] - star[2]) for k in own])
            contours = Contours(
                x,
                y,
                values[:, :, place[0]] if place else values,
                (float(np.nanmin(values)), float(np.nanmax(values))),
                (float(star[0]), float(star[1])) if place == nearest else None,
            )
            panels.append(
                Panel(
                    title=_title(one) if place == slices[0] else "",
                    y_label="".join((*level, names[1])) if one is found[0][0] else "",
                    contours=contours,
                )
            )
    return panels


def _title(one: Mapped) -> str:
    """Title of a column; long names of models take a second line."""
    return fill(f"{one.title} ({one.unit})", _LETTERS, break_on_hyphens=False)


def _caption(space: Workspace, found: Sequence[Map]) -> str:
    mechanism, poses = space.mechanism, prod(space.shape)
    said = [
        f"{capital(one.title)}: {one.said}; at its worst "
        f"{number(worst.value, 4)} {one.unit} at {shown_pose(mechanism, worst.pose)}."
        for one, _, worst in found
    ]
    said.append(
        "Dots: poses of the grid. Stars: the worst postures, searched between the dots, with loops "
        "closed and models solved in every posture that the search looks at"
        + ("; each in the slice that is nearest to it." if len(space.axes) > 2 else ".")
    )
    if poses < len(mechanism.poses):
        said.append(f"{poses} of the {len(mechanism.poses)} poses of the grid were looked at.")
    if blank := poses - int(np.isfinite(found[0][1]).sum()):
        said.append(f"Blank: {blank} of {poses} poses, out of reach or singular.")
    return " ".join(said)


def _table(space: Workspace, names: Sequence[str], found: Sequence[Map]) -> dict[str, Column]:
    """Every pose of the grid with its values, then the worst postures."""
    poses = [space.pose(place) for place in np.ndindex(*space.shape)]
    poses += [worst.pose for *_, worst in found]
    kinds = ["grid"] * (len(poses) - len(found)) + [f"worst {one.title}" for one, *_ in found]
    table: dict[str, Column] = {"posture": kinds}
    for name, move in zip(names, space.moves, strict=True):
        table[name] = [float(pose[move]) for pose in poses]
    for k, (one, values, worst) in enumerate(found):
        column = [*_optional(values).ravel(), *[None] * len(found)]
        column[k - len(found)] = worst.value
        table[f"{one.title} ({one.unit})"] = column
    return table


def _study(space: Workspace, one: Mapped, values: Array, worst: WorstPosture) -> dict[str, Any]:
    """The map's entry among the studies of results.json."""
    return {
        "id": one.id,
        "kind": "map",
        "title": one.title,
        "unit": one.unit,
        "model": one.model,
        "moves": [space.mechanism.tool.moves[move] for move in space.moves],
        "x": [axis.tolist() for axis in space.axes],
        "values": _optional(values).tolist(),
        "worst": {"pose": worst.pose.tolist(), "value": worst.value},
    }


def _optional(values: Array) -> Any:
    found = values.astype(object)
    found[np.isnan(values)] = None
    return found
