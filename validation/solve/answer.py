"""Result records of `solve`: compliance and frequencies with uncertainties, tables and plots.

Input: numbers of a model in each pose. Output: `Answer` for each pose, and `Solution` with tables
and plots of all.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from lumped.acceptance.quantities import DIAGONAL_UNITS
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.load import PressureResultant
from lumped.model_choices import ReductionBy
from lumped.system.joint_motion import Portion
from lumped.system.response import HarmonicResponse
from lumped.system.stability import Stability
from validation.models.options import ModelName
from validation.tables import Cell, ResultTable, html_paragraph, html_table
from validation.uncertainty.refinement import Accuracy

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Place(msgspec.Struct, frozen=True, omit_defaults=True, kw_only=True):
    """Subject of an answer: the robot in a pose, or one of its bodies alone.

    One field has a value, the others are None.
    """

    # Position (m) of a robot of schema 1.
    x: float | None = None
    # Pose (m, rad) of a mechanism, () for a structure.
    pose: tuple[float, ...] | None = None
    # Number of a leg of a robot of schema 1.
    leg: int | None = None
    # Name of a body of a mechanism.
    body: str | None = None

    @property
    def coordinates(self) -> tuple[float, ...]:
        """Coordinates of the pose. () for a body alone."""
        return (self.x,) if self.x is not None else self.pose or ()

    @property
    def title(self) -> str:
        """Text with the pose, or with the name of the body and its clamped end."""
        if self.leg is not None:
            return f"leg {self.leg}, root clamped"
        if self.body is not None:
            return f"{self.body}, clamped at its first point"
        if self.x is not None:
            return f"x = {self.x:.6g} m"
        listed = ", ".join(f"{value:.6g}" for value in self.coordinates)
        return f"pose ({listed})" if listed else "reference posture"

    @property
    def free_title(self) -> str:
        """Text with the name of a body without supports."""
        return f"{self.body or f'leg {self.leg}'}, without supports"

    @property
    def axes(self) -> str:
        """Text with the axes of the compliance and, unless it is of a leg, its reference point."""
        if self.leg is not None:
            return "leg axes"
        if self.body is not None:
            return "compliance at the second point, body axes"
        return f"at the loaded point, {'base' if self.x is None else 'robot'} axes"


@dataclass(frozen=True)
class HalfWidths:
    """Half-widths of diagonal compliances (6, SI) and frequencies (Hz). Infinite if unknown.

    `loads`: half-widths of the six components of displacement under each load of the file, by name.
    """

    compliance: Array
    frequencies: Array
    loads: Mapping[str, Array] = field(default_factory=dict, kw_only=True)

    @property
    def known(self) -> bool:
        """True if the half-widths of the compliance are known.

        For a free body, which has no compliance, true if those of the frequencies are known.
        """
        decisive = self.compliance if self.compliance.size else self.frequencies
        return bool(np.isfinite(decisive).all())

    def shares_of_loads(self, loads: Mapping[str, Array]) -> dict[str, float]:
        """Half-widths of the translation under each load, relative to its length, by load.

        `loads`: displacements (6) by name of the load. Loads without translation are omitted.
        """
        lengths = {name: float(np.linalg.norm(loads[name][:3])) for name in self.loads}
        return {
            name: float(np.linalg.norm(self.loads[name][:3])) / length
            for name, length in lengths.items()
            if length > 0.0
        }


@dataclass(frozen=True)
class MeshUncertainty(HalfWidths):
    """Half-widths of 95 % intervals, from the change to a second mesh of the prisms.

    `divisions`: elements across the section in the second mesh. If that mesh is too large to be
    solved, the half-widths are infinite. `meshes`: divisions of all meshes from which numbers are
    extrapolated, () if no order was observed.
    """

    divisions: int
    meshes: tuple[int, ...] = ()


@dataclass(frozen=True)
class PartUncertainty(HalfWidths):
    """Half-widths of 95 % intervals due to CAD parts, from three meshes of each part.

    They are infinite if the file of a part is a mesh. `bracket`: change from rigid to averaged
    interfaces, zero if the robot file specifies the end conditions. `reduction`: bound on the
    increase of frequencies (Hz) due to omitted modes. `counted`: for each part, a number of modes
    and a frequency (Hz): the reduction basis contains all modes of the part below this frequency.
    `by`: condition of the interfaces in these modes, fixed or free.
    """

    bracket: HalfWidths
    reduction: Array
    counted: Mapping[str, tuple[int, float]]
    by: ReductionBy


class ModePair(msgspec.Struct, frozen=True, kw_only=True):
    """A mode and its partner in another model, an object of "partners" in the JSON.

    `mode`, `partner`: numbers of the two modes, from 1; `partner` is None if there is none.
    `frequency`: that of the partner (Hz). `mac`: energy-weighted MAC of the two modes, or the
    largest one with any mode if there is no partner. `seen`: share of the mode's kinetic energy in
    rigid motions of cross-sections and bodies. `local`: True for a local mode of a section, which
    the other model does not have. `open`: lowest and highest frequency (Hz) of the modes that can
    be the partner if shapes mix. `undecided`: True if the shapes do not show whether the other
    model has the mode.
    """

    mode: int
    partner: int | None
    frequency: float | None
    mac: float
    seen: float
    local: bool
    open: tuple[float, float] | None
    undecided: bool


class PairedModes(msgspec.Struct, frozen=True):
    """Modes of an answer with their partners in the model `against`."""

    against: ModelName
    pairs: tuple[ModePair, ...]


@dataclass(frozen=True)
class Answer:
    """Compliance (6×6 or 2×2, SI) and frequencies (Hz, ascending) in one posture or of one leg.

    `idle`: number of mobilities that do not move the tool. `loads`: displacements of the tool (6, m
    and rad, base axes) under each load of the file, NaN if not solved. `stability`: buckling
    under these loads, None if there is no solution. `bent`: names of the legs that are not
    straight. `reactions`: wrenches of joints (6, N and N m,
    joint axes) by load and joint, NaN if statically indeterminate. `pressures`: resultants of the
    pressures on faces of CAD parts, by load. `responses`: receptances of the tool. `damped`:
    frequencies (Hz) and loss factors of the complex modes, None if nothing damps the robot.
    `strain`: shares of drives, joints and bodies in each mode's strain energy. `paired`: partners
    of the modes in another model, None unless requested. `uncertainty`: half-widths due to the mesh
    of prisms, None if there is no such mesh. `of_parts`: half-widths due to CAD parts. `of_digits`:
    half-widths due to the printed digits of the 6×6 in the robot file. `rigid`: for a free body,
    the number of rigid-body motions, which are not among `frequencies`; its compliance is empty.
    """

    place: Place
    compliance: Array
    frequencies: Array
    idle: int | None = None
    loads: Mapping[str, Array] = field(default_factory=dict)
    responses: Sequence[HarmonicResponse] = ()
    damped: tuple[Array, Array] | None = None
    stability: Mapping[str, Stability | None] = field(default_factory=dict)
    bent: Sequence[str] = ()
    reactions: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)
    pressures: Mapping[str, Sequence[PressureResultant]] = field(default_factory=dict)
    uncertainty: MeshUncertainty | None = None
    of_parts: PartUncertainty | None = None
    of_digits: HalfWidths | None = None
    strain: Mapping[Portion, Array] = field(default_factory=dict)
    paired: PairedModes | None = None
    rigid: int | None = None


@dataclass(frozen=True)
class Solution:
    """Answers of one model: an `Answer` for each pose, with the options of the model.

    `accuracy`: requested and reached accuracy, None unless requested. `moves`: coordinates of a
    pose with their units, such as "x (m)".

    Examples
    --------
    >>> push = {"name": "push", "wrench": [0.0, 0.0, 100.0, 0.0, 0.0, 0.0]}
    >>> sweep = {"name": "sweep", "direction": [0.0, 0.0, 1.0], "from": 10.0, "to": 500.0}
    >>> damped = {"damping": {"ratio": 0.01}, "responses": [sweep]}
    >>> solution = solve({**bar, **damped, "loads": [push]}, "beam", modes=2)
    """

    robot: str
    model: ModelName
    options: dict[str, Any]
    answers: tuple[Answer, ...]
    accuracy: Accuracy | None = None
    moves: tuple[str, ...] = ()

    def table(self) -> ResultTable:
        """Table of diagonal compliances and frequencies, one row for each pose.

        Returns
        -------
        ResultTable
            Compliances along and about the axes (SI), frequencies (Hz).

        Examples
        --------
        >>> solution.table().headings[:3]
        ('at', 'x (m/N)', 'y (m/N)')
        """
        axes = list(DIAGONAL_UNITS.items())[: len(self.answers[0].compliance)]
        count = max(len(answer.frequencies) for answer in self.answers)
        modes = [f"f{mode} (Hz)" for mode in range(1, count + 1)]
        return ResultTable(
            ("at", *(f"{axis} ({unit})" for axis, unit in axes), *modes),
            tuple(
                (
                    answer.place.title,
                    *np.diag(answer.compliance).tolist(),
                    *_numbers_or_none(answer.frequencies, count),
                )
                for answer in self.answers
            ),
        )

    def plot(self) -> "Figure":
        """Plot of deflections along a force of 1000 N, and of frequencies.

        Returns
        -------
        matplotlib.figure.Figure
            Bars for a single pose. For several poses, curves over the only coordinate that differs
            between them, or over the number of the pose.

        Examples
        --------
        >>> solution.plot().savefig("bar.png")
        """
        # Only a picture needs the library that draws it.
        from validation.solve.solution_plot import solution_plot  # noqa: PLC0415

        places = [answer.place.title for answer in self.answers]
        deflections = np.array([np.diag(answer.compliance)[:3] * 1e9 for answer in self.answers])
        count = max(len(answer.frequencies) for answer in self.answers)
        frequencies = [_numbers_or_none(answer.frequencies, count) for answer in self.answers]
        return solution_plot(
            places, self._abscissa(), deflections, np.array(frequencies, dtype=float)
        )

    def load_table(self) -> ResultTable:
        """Table of tool displacements and buckling factors, one row for each pose and load.

        Returns
        -------
        ResultTable
            Displacements in m and rad. The buckling factor multiplies the load.

        Raises
        ------
        InputError
            If the robot file has no ``[[loads]]``.

        Examples
        --------
        >>> solution.load_table().rows[0][1]
        'push'
        """
        rows: list[tuple[Cell, ...]] = []
        for answer in self.answers:
            for name, displacement in answer.loads.items():
                stability = answer.stability.get(name)
                factor = stability.factor if stability else None
                rows.append((answer.place.title, name, *_numbers_or_none(displacement, 6), factor))
        if not rows:
            raise InputError("load_table: the robot file has no [[loads]]; add one")
        axes = [f"{axis} ({unit.split('/')[0]})" for axis, unit in DIAGONAL_UNITS.items()]
        return ResultTable(("at", "load", *axes, "buckling factor"), tuple(rows))

    def plot_loads(self) -> "Figure":
        """Plot of tool displacements under the loads of the file, and of buckling factors.

        Returns
        -------
        matplotlib.figure.Figure
            A mark for each load in a single pose, curves over the poses for several.

        Raises
        ------
        InputError
            If the robot file has no ``[[loads]]``.

        Examples
        --------
        >>> solution.plot_loads().savefig("loads.png")
        """
        # Only a picture needs the library that draws it.
        from validation.solve.solution_plot import loads_plot  # noqa: PLC0415

        if not (
            names := list(dict.fromkeys(name for answer in self.answers for name in answer.loads))
        ):
            raise InputError("plot_loads: the robot file has no [[loads]]; add one")
        displacements = {
            name: np.array(
                [1e6 * np.linalg.norm(answer.loads[name][:3]) for answer in self.answers]
            )
            for name in names
        }
        factors = {
            name: np.array([_factor(answer.stability.get(name)) for answer in self.answers])
            for name in names
        }
        return loads_plot(self._abscissa(), displacements, factors)

    def _abscissa(self) -> tuple[Array, str]:
        """Abscissa (p values for p poses) and its label.

        It is the coordinate that changes if only one does, otherwise the number of the pose.
        """
        poses = [np.array(answer.place.coordinates) for answer in self.answers]
        same_length = len({len(pose) for pose in poses}) == 1
        changing = np.flatnonzero(np.ptp(poses, axis=0) > 0.0) if same_length else np.zeros(0)
        if len(changing) == 1 and len(self.moves) == len(poses[0]):
            column = int(changing[0])
            return np.array([float(pose[column]) for pose in poses]), self.moves[column]
        return np.arange(1.0, len(poses) + 1.0), "pose"

    def plot_responses(self) -> "Figure":
        """Plot of magnitude and phase of the tool's responses to the file's harmonic forces.

        Returns
        -------
        matplotlib.figure.Figure
            Receptance over frequency, a curve for each force and pose.

        Raises
        ------
        InputError
            If the robot file has no ``[[responses]]``.

        Examples
        --------
        >>> solution.plot_responses().savefig("responses.png")
        """
        # Only a picture needs the library that draws it.
        from validation.solve.solution_plot import responses_plot  # noqa: PLC0415

        several = len(self.answers) > 1
        curves = {
            f"{response.excitation.name}{f', {answer.place.title}' if several else ''}": (
                response.excitation.frequencies,
                response.receptance,
            )
            for answer in self.answers
            for response in answer.responses
        }
        if not curves:
            raise InputError("plot_responses: the robot file has no [[responses]]; add one")
        return responses_plot(curves)

    def __repr__(self) -> str:
        places = [answer.place.title for answer in self.answers]
        where = places[0] if len(places) == 1 else f"{len(places)} poses"
        return f"Solution({self.robot}, {self.model}: {where})"

    def _repr_html_(self) -> str:
        """HTML table for a notebook: deflections along a force of 1000 N, and frequencies."""
        rows = [
            [
                answer.place.title,
                *deflection_texts(answer),
                ", ".join(f"{frequency:.5g}" for frequency in answer.frequencies),
            ]
            for answer in self.answers
        ]
        axes = "xyz"[: len(rows[0]) - 2]
        headings = ["at", *(f"{axis} (µm at 1000 N)" for axis in axes), "frequencies (Hz)"]
        return html_paragraph(f"{self.robot}, {self.model}") + html_table(headings, rows)


def _factor(stability: Stability | None) -> float:
    """Buckling factor. NaN if there is none."""
    return np.nan if stability is None or stability.factor is None else stability.factor


def _numbers_or_none(values: Array, count: int) -> list[float | None]:
    """List of `count` entries: the finite values, and None for infinite and missing ones."""
    finite = [value if np.isfinite(value) else None for value in values.tolist()]
    return finite + [None] * (count - len(finite))


def deflection_texts(answer: Answer) -> list[str]:
    """Deflections (µm) along x, y and, if known, z, each under a force of 1000 N along it."""
    return [f"{without_round_off(value * 1e9):.4g}" for value in np.diag(answer.compliance)[:3]]


def without_round_off(micro: float) -> float:
    """Number (µm or µrad) rounded to 1e-12, so that round-off of zero is displayed as zero."""
    return round(float(micro), 12) + 0.0
