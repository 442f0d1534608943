"""What a model answers, and how that is shown to people and to programs."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError, InputError
from lumped.system.joint_motion import Portion
from lumped.system.response import ToolResponse
from lumped.system.stability import Stability
from validation.agreement.accuracy import Accuracy
from validation.models.options import ModelName, ReductionBy
from validation.tables import Cell, ResultTable, html_paragraph, html_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Diagonal of a compliance by axis, with its unit.
_AXES = (
    *(("x", "m/N"), ("y", "m/N"), ("z", "m/N")),
    *(("phi_x", "rad/(N m)"), ("phi_y", "rad/(N m)"), ("phi_z", "rad/(N m)")),
)
Place: TypeAlias = dict[str, float | int | str | list[float]]
# Parts that are named of those that carry a mode: how many, and from which share on.
_MOST_PARTS, _TOLD = 3, 0.005
# Share of a stiffness from which on it is told that a load takes it.
_WORTH_TELLING = 5e-5


@dataclass(frozen=True)
class LeftOpen:
    """Half-widths, of the diagonal of a 6×6 (SI) and of frequencies (Hz); infinite if unknown.

    `loads`: of the six components of displacements under the file's loads, by name.
    """

    compliance: Array
    frequencies: Array
    loads: Mapping[str, Array] = field(default_factory=dict, kw_only=True)

    @property
    def known(self) -> bool:
        """Whether anything is known of them."""
        return bool(np.isfinite(self.compliance).all())

    @property
    def record(self) -> dict[str, Any]:
        """Its entry in the results."""
        found: dict[str, Any] = {
            "compliance": self.compliance.tolist(),
            "frequencies": self.frequencies.tolist(),
        }
        if self.loads:
            found["loads"] = {name: _numbers(left) for name, left in self.loads.items()}
        return found

    def shares_of_loads(self, loads: Mapping[str, Array]) -> dict[str, float]:
        """What is open of displacements under `loads`, of the length of each; of none nothing."""
        lengths = {name: float(np.linalg.norm(loads[name][:3])) for name in self.loads}
        return {
            name: float(np.linalg.norm(self.loads[name][:3])) / length
            for name, length in lengths.items()
            if length > 0.0
        }


@dataclass(frozen=True)
class MeshUncertainty(LeftOpen):
    """Of 95 % intervals, from the step to a mesh of other `divisions`.

    Infinite where that one is too large to be had. `meshes`: the divisions of all from which
    numbers are extrapolated, where these show an order.
    """

    divisions: int
    meshes: tuple[int, ...] = ()

    @property
    def record(self) -> dict[str, Any]:
        """Its entry in the results."""
        shown = {"extrapolated_from": list(self.meshes)} if self.meshes else {}
        return {"divisions": self.divisions} | super().record | shown


@dataclass(frozen=True)
class PartUncertainty(LeftOpen):
    """What the CAD parts of a mechanism leave open: of 95 % intervals by three meshes of each part.

    Infinite for a part that is a mesh; `bracket`: averaged minus rigid interfaces, where the robot
    file leaves open how they are held. `reduction`: most by which frequencies are too high for the
    modes that were dropped; `counted`: by part, how many lie below which frequency
    (Hz) with its interfaces as `by` says, all of them kept.
    """

    bracket: LeftOpen
    reduction: Array
    counted: Mapping[str, tuple[int, float]]
    by: ReductionBy


@dataclass(frozen=True)
class Answer:
    """Compliance (6×6 or 2×2, SI) and frequencies (Hz, ascending) at one posture or of one leg.

    `place` is {"x": m}, {"pose": [m or rad]}, {"leg": 1 or 2} or {"body": name}; `idle` counts the
    mobilities of a mechanism that do not move its tool; `loads` are displacements of the tool (6, m
    and rad, base axes) under loads of the file by name, NaN where there is none, `stability` how
    near to buckling these bring it, None where it cannot; `responses` are its answers to forces
    that swing, `damped` the complex modes (frequencies, Hz, and loss factors) where anything damps;
    `strain` maps
    its drives, joints and bodies to their shares of each mode's strain energy, `pairs` is the
    record of the modes' partners in another model; `uncertainty` is that of the mesh of prisms
    where one is known, None else, `of_parts` that of CAD parts, and `of_digits` what the printed
    digits of the 6×6 in the robot file leave open at most, to first order.
    """

    place: Place
    compliance: Array
    frequencies: Array
    idle: int | None = None
    loads: Mapping[str, Array] = field(default_factory=dict)
    responses: Sequence[ToolResponse] = ()
    damped: tuple[Array, Array] | None = None
    stability: Mapping[str, Stability | None] = field(default_factory=dict)
    uncertainty: MeshUncertainty | None = None
    of_parts: PartUncertainty | None = None
    of_digits: LeftOpen | None = None
    strain: Mapping[Portion, Array] = field(default_factory=dict)
    pairs: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Solution:
    """Answers of one model: an `Answer` for each pose, with the options of the model.

    `accuracy` is the one that was asked for and reached, None if none was asked for. `moves` are
    the coordinates of a pose with their units, such as "x (m)".

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
        """Diagonal compliances and frequencies, a row for each pose.

        Returns
        -------
        ResultTable
            Compliances along and about the axes (SI), frequencies (Hz).

        Examples
        --------
        >>> solution.table().headings[:3]
        ('at', 'x (m/N)', 'y (m/N)')
        """
        axes = _AXES[: len(self.answers[0].compliance)]
        count = max(len(answer.frequencies) for answer in self.answers)
        modes = [f"f{mode} (Hz)" for mode in range(1, count + 1)]
        return ResultTable(
            ("at", *(f"{axis} ({unit})" for axis, unit in axes), *modes),
            tuple(
                (
                    _head(answer.place)[0],
                    *np.diag(answer.compliance).tolist(),
                    *_numbers_or_none(answer.frequencies, count),
                )
                for answer in self.answers
            ),
        )

    def plot(self) -> "Figure":
        """Deflections along a force of 1000 N, and frequencies.

        Returns
        -------
        matplotlib.figure.Figure
            Bars for a single pose. Curves for several, over the coordinate that differs between
            them, or over the number of the pose if more than one differs.

        Examples
        --------
        >>> solution.plot().savefig("bar.png")
        """
        # Only a picture needs the library that draws it.
        from validation.solve.solution_plot import solution_plot  # noqa: PLC0415

        places = [_head(answer.place)[0] for answer in self.answers]
        deflections = np.array([np.diag(one.compliance)[:3] * 1e9 for one in self.answers])
        count = max(len(answer.frequencies) for answer in self.answers)
        frequencies = [_numbers_or_none(answer.frequencies, count) for answer in self.answers]
        return solution_plot(
            places, self._abscissa(), deflections, np.array(frequencies, dtype=float)
        )

    def load_table(self) -> ResultTable:
        """Displacement of the tool and buckling factor, a row for each pose and load.

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
            for name, moved in answer.loads.items():
                stable = answer.stability.get(name)
                factor = stable.factor if stable else None
                rows.append((_head(answer.place)[0], name, *_numbers_or_none(moved, 6), factor))
        if not rows:
            raise InputError("load_table: the robot file has no [[loads]]")
        axes = [f"{axis} ({unit.split('/')[0]})" for axis, unit in _AXES]
        return ResultTable(("at", "load", *axes, "buckling factor"), tuple(rows))

    def plot_loads(self) -> "Figure":
        """Displacements of the tool under the loads of the file, and buckling factors.

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

        if not (names := list(dict.fromkeys(name for one in self.answers for name in one.loads))):
            raise InputError("plot_loads: the robot file has no [[loads]]")
        moved = {
            name: np.array([1e6 * np.linalg.norm(one.loads[name][:3]) for one in self.answers])
            for name in names
        }
        factors = {
            name: np.array([_factor(one.stability.get(name)) for one in self.answers])
            for name in names
        }
        return loads_plot(self._abscissa(), moved, factors)

    def _abscissa(self) -> tuple[Array, str]:
        """The only coordinate that differs between the poses, or their number, with its label."""
        poses = [
            np.atleast_1d(one.place.get("pose", one.place.get("x", []))) for one in self.answers
        ]
        alike = len({len(pose) for pose in poses}) == 1
        changing = np.flatnonzero(np.ptp(poses, axis=0) > 0.0) if alike else np.zeros(0)
        if len(changing) == 1 and len(self.moves) == len(poses[0]):
            column = int(changing[0])
            return np.array([float(pose[column]) for pose in poses]), self.moves[column]
        return np.arange(1.0, len(poses) + 1.0), "pose"

    def plot_responses(self) -> "Figure":
        """Magnitude and phase of the tool's responses to the harmonic forces of the file.

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
            f"{one.excitation.name}{f', {_head(answer.place)[0]}' if several else ''}": (
                one.excitation.frequencies,
                one.receptance,
            )
            for answer in self.answers
            for one in answer.responses
        }
        if not curves:
            raise InputError("plot_responses: the robot file has no [[responses]]")
        return responses_plot(curves)

    def __repr__(self) -> str:
        places = [_head(answer.place)[0] for answer in self.answers]
        where = places[0] if len(places) == 1 else f"{len(places)} poses"
        return f"Solution({self.robot}, {self.model}: {where})"

    def _repr_html_(self) -> str:
        """Deflections under their own load of 1000 N, and frequencies, as a notebook shows them."""
        rows = [
            [
                _head(answer.place)[0],
                *_deflections(answer),
                ", ".join(f"{frequency:.5g}" for frequency in answer.frequencies),
            ]
            for answer in self.answers
        ]
        axes = "xyz"[: len(rows[0]) - 2]
        headings = ["at", *(f"{axis} (µm at 1000 N)" for axis in axes), "frequencies (Hz)"]
        return html_paragraph(f"{self.robot}, {self.model}") + html_table(headings, rows)


def _factor(stable: Stability | None) -> float:
    """Buckling factor; NaN if there is none."""
    return np.nan if stable is None or stable.factor is None else stable.factor


def _numbers_or_none(values: Array, count: int) -> list[float | None]:
    """Finite numbers, None for others and for those that are missing."""
    finite = [value if np.isfinite(value) else None for value in values.tolist()]
    return finite + [None] * (count - len(finite))


def as_json(solution: Solution) -> str:
    """The answers as JSON (schema 1); an infinite frequency is null."""
    document: dict[str, Any] = {
        "schema": 1,
        "robot": solution.robot,
        "model": solution.model,
        "options": solution.options,
        "results": [record_of(answer) for answer in solution.answers],
    }
    if solution.accuracy:
        document["accuracy"] = asdict(solution.accuracy)
    return finite_json(document)


def finite_json(document: Any) -> str:
    """The document as JSON, which has no infinite numbers; raises ComputationError for one."""
    try:
        return json.dumps(document, allow_nan=False)
    except ValueError as error:
        raise ComputationError(
            "a result is no finite number: a mass or a stiffness of the robot is extremely small "
            "or large"
        ) from error


def record_of(answer: Answer) -> dict[str, Any]:
    """An answer's entry in the results; an infinite frequency is null."""
    found: dict[str, Any] = {
        **answer.place,
        "compliance": answer.compliance.tolist(),
        "frequencies": [f if np.isfinite(f) else None for f in answer.frequencies.tolist()],
    }
    if answer.idle is not None:
        found["idle"] = answer.idle
    if answer.loads:
        found["loads"] = {
            name: {"displacement": _numbers(moved)} | _stability_record(answer.stability.get(name))
            for name, moved in answer.loads.items()
        }
    if answer.damped:
        frequencies, losses = (one.tolist() for one in answer.damped)
        found["damped"] = {"frequencies": frequencies, "losses": losses}
    if answer.responses:
        found["responses"] = {
            one.excitation.name: _response_record(one) for one in answer.responses
        }
    if (mesh := answer.uncertainty) is not None:
        found["uncertainty"] = mesh.record if mesh.known else None
    if (parts := answer.of_parts) is not None:
        found["parts"] = {
            "uncertainty": parts.record if parts.known else None,
            "averaged_less_rigid": parts.bracket.record,
            "reduction": parts.reduction.tolist(),
            "modes_counted": {
                name: {"count": count, "below": below}
                for name, (count, below) in parts.counted.items()
            },
        }
    if (digits := answer.of_digits) is not None:
        found["digits"] = digits.record
    if answer.strain:
        found["strain"] = {str(part): share.tolist() for part, share in answer.strain.items()}
    if answer.pairs:
        found["partners"] = dict(answer.pairs)
    return found


def _response_record(one: ToolResponse) -> dict[str, Any]:
    """Receptance (m/N) over frequencies (Hz), its peak, None where it has no bound or is none."""
    height, frequency, *at = one.judged
    found: dict[str, Any] = {
        "frequencies": one.excitation.frequencies.tolist(),
        "real": one.receptance.real.tolist(),
        "imaginary": one.receptance.imag.tolist(),
        "peak": {
            name: number if np.isfinite(number) else None
            for name, number in (("size", height), ("frequency", frequency))
        },
    }
    return found | ({"at": {"size": at[0], "frequency": one.excitation.at}} if at else {})


def _stability_record(found: Stability | None) -> dict[str, Any]:
    """What goes beside a displacement; a mechanism that has buckled has no stiffness."""
    if found is None:
        return {}
    stands = bool(np.isfinite(found.stiffness_losses).all())
    record: dict[str, Any] = {
        "buckling": {
            "factor": found.factor,
            "reversed": found.reversed,
            "body": next(iter(found.shares), None),
            "shares": found.shares,
        },
        "stiffness_lost": found.stiffness_losses.tolist() if stands else None,
        "farther": found.extra_displacement if stands else None,
    }
    if len(found.frequencies):
        record["frequencies"] = found.frequencies.tolist()
    return record


def _numbers(values: Array) -> list[float] | None:
    return values.tolist() if np.isfinite(values).all() else None


def as_text(solution: Solution) -> str:
    """The answers for people: deflections at 1000 N, the compliance, the frequencies."""
    heard = ", ".join(f"{name} {value}" for name, value in solution.options.items())
    lines = [f"{solution.robot}, {solution.model}" + (f" ({heard})" if heard else "")]
    lines += [solution.accuracy.text] if solution.accuracy else []
    for answer in solution.answers:
        lines += ["", *_answer_lines(answer, solution.model)]
    return "\n".join(lines)


def _answer_lines(answer: Answer, model: ModelName) -> list[str]:
    size = len(answer.compliance)
    deflections = zip("xyz", _deflections(answer), strict=False)
    lines = [
        ", ".join(_head(answer.place)),
        "  deflection (µm) along a force of 1000 N:",
        "    " + ", ".join(f"{axis} {text}" for axis, text in deflections),
        f"  compliance {size}×{size} (m/N, rad/N, rad/(N m)):",
    ]
    lines += ["    " + " ".join(f"{value: .4e}" for value in row) for row in answer.compliance]
    if answer.loads:
        lines.append("  displacement (µm, µrad) under the loads of the robot file:")
        lines += [f"    {name}: {_moved_text(moved)}" for name, moved in answer.loads.items()]
        bending = "rigid legs" if model == "simplified" else "legs bending as beams"
        lines.append(f"  stability under them, {bending} between their ends:")
        lines += [f"    {name}: {_stability_text(one)}" for name, one in answer.stability.items()]
    if len(answer.frequencies):
        listed = ", ".join(f"{value:.5g}" for value in answer.frequencies)
        lines.append(f"  natural frequencies (Hz): {listed}")
        lines += _mode_lines(answer)
    if answer.damped:
        listed = ", ".join(f"{100.0 * loss:.3g}" for loss in answer.damped[1])
        lines.append(f"  loss factors of the modes (%): {listed}")
    if answer.responses:
        lines.append("  responses of the tool (µm/N) to the harmonic forces of the robot file:")
        lines += [f"    {_response_text(one)}" for one in answer.responses]
    if answer.idle:
        lines.append(f"  idle mobilities, which do not move the tool: {answer.idle}")
    if (mesh := answer.uncertainty) is not None:
        if mesh.known:
            lines.append(
                f"  uncertainty of the mesh (95 %, from the one of --divisions {mesh.divisions}):"
            )
            if mesh.meshes:
                lines.append(
                    "    numbers are extrapolated where the meshes of "
                    f"{', '.join(map(str, mesh.meshes))} divisions show an order of convergence"
                )
            lines += _share_lines(answer, mesh)
        else:
            lines.append(
                "  uncertainty of the mesh: not known; the mesh that would show it, --divisions "
                f"{mesh.divisions}, is too large"
            )
    if answer.of_parts is not None:
        lines += _part_lines(answer, answer.of_parts)
    if (digits := answer.of_digits) is not None:
        lines.append("  uncertainty from the last digits of the 6×6 in the robot file (at most):")
        lines += _share_lines(answer, digits)
    return lines


def _deflections(answer: Answer) -> list[str]:
    """µm along x, y and, where it is known, z, each under its own load of 1000 N."""
    return [f"{_shown(value * 1e9):.4g}" for value in np.diag(answer.compliance)[:3]]


def _moved_text(moved: Array) -> str:
    """Displacement, its whole length and rotation."""
    if not np.isfinite(moved).all():
        return (
            "none: the mechanism cannot move that way here, or the load has no wrench for this pose"
        )
    names = ("x", "y", "z", "φx", "φy", "φz")
    told = [f"{name} {_shown(1e6 * value):.4g}" for name, value in zip(names, moved, strict=True)]
    told.insert(3, f"{1e6 * np.linalg.norm(moved[:3]):.4g} in all")
    return ", ".join(told)


def _response_text(one: ToolResponse) -> str:
    """The peak, and the size at the frequency that is asked for."""
    height, frequency, *at = one.judged
    if not height:
        return f"{one.excitation.name}: none, the tool is rigid there"
    peak = f"{1e6 * height:.4g}" if np.isfinite(height) else "without bound"
    there = f", {1e6 * at[0]:.4g} at {one.excitation.at:.5g} Hz" if at else ""
    return f"{one.excitation.name}: peak {peak} at {frequency:.5g} Hz{there}"


def _shown(micro: float) -> float:
    """Without what rounding leaves of nothing: less than 1e-12 µm or µrad."""
    return round(float(micro), 12) + 0.0


def _stability_text(found: Stability | None) -> str:
    """When it buckles, where most, and the stiffness of the tool that the load takes."""
    if found is None:
        return "none, the mechanism cannot move that way here"
    said = "does not buckle"
    if found.factor is not None:
        where = list(found.shares.items())[:_MOST_PARTS]
        told = ", ".join(f"{name} {100.0 * share:.0f} %" for name, share in where if share >= _TOLD)
        said = f"buckles at {found.factor:.4g} times the load ({told})"
    if not np.isfinite(found.stiffness_losses).all():
        return f"{said}; no stiffness is left"
    names = ("x", "y", "z", "φx", "φy", "φz")
    worth = [
        f"{name} {100.0 * share:.2g} %"
        for name, share in zip(names, found.stiffness_losses, strict=True)
        if abs(share) >= _WORTH_TELLING
    ]
    lost = f"takes {', '.join(worth)} of the stiffness" if worth else "takes no stiffness"
    more = ", ".join(f"{value:.5g}" for value in found.frequencies)
    return f"{said}; {lost}" + (f"; then {more} Hz" if more else "")


def _mode_lines(answer: Answer) -> list[str]:
    """What carries most of each mode's strain energy, and which mode of another model it is."""
    lines = []
    if answer.strain:
        names, shares = list(answer.strain), np.array(list(answer.strain.values()))
        lines.append("  most of their strain energy in:")
        for mode, column in enumerate(shares.T, start=1):
            # Shares that are equal but for rounding stand in the order of the file.
            largest = np.argsort(-column.round(6), kind="stable")[:_MOST_PARTS]
            told = [i for i in largest if column[i] >= _TOLD]
            said = ", ".join(f"{names[i]} {100.0 * column[i]:.0f} %" for i in told)
            lines.append(f"    {mode}: {said}")
    if answer.pairs:
        lines.append(f"  the same modes by the {answer.pairs['against']} model:")
        lines += [
            f"    {pair['mode']}: {_partner(pair)}, MAC {pair['mac']:.4f}"
            for pair in answer.pairs["pairs"]
        ]
    return lines


def _partner(pair: Mapping[str, Any]) -> str:
    """The partner of a mode, or why it has none."""
    if pair["undecided"]:
        return "several modes have the shape of one, which of them it is is open"
    if pair["local"]:
        whole = f"{100.0 * pair['seen']:.2g} % of its kinetic energy"
        return f"none, a local mode ({whole} in whole cross-sections and bodies)"
    if not pair["partner"]:
        return "none of this shape"
    partner = f"mode {pair['partner']}, {pair['frequency']:.5g} Hz"
    if pair["open"]:
        low, high = pair["open"]
        return f"{partner} (shapes mix: {low:.5g} to {high:.5g} Hz)"
    return partner


def _part_lines(answer: Answer, found: PartUncertainty) -> list[str]:
    """What meshes, holding and reduction of CAD parts leave open."""
    if found.known:
        lines = ["  uncertainty of the parts' meshes (95 %, from three of each):"]
        lines += _share_lines(answer, found)
    else:
        lines = ["  uncertainty of the parts' meshes: not known: a given mesh cannot be refined"]
    if found.bracket.compliance.any():
        lines.append("  averaged minus rigid interfaces, where the robot file leaves it open:")
        lines += _share_lines(answer, found.bracket, "+.2g")
    if found.counted and len(answer.frequencies):
        counts = ", ".join(
            f"{name} {count} below {below:.4g} Hz" for name, (count, below) in found.counted.items()
        )
        most = 100.0 * float(np.max(found.reduction / answer.frequencies))
        lines.append(
            f"  modes of the parts with interfaces {found.by}, counted and all kept: {counts};"
        )
        lines.append(f"    those dropped lower no frequency by more than {most:.1g} %")
    return lines


def _share_lines(answer: Answer, left_open: LeftOpen, digits: str = ".2g") -> list[str]:
    """Shares of the diagonal of the compliance and of the frequencies, in percent."""
    shares = 100.0 * left_open.compliance / np.abs(np.diag(answer.compliance))
    names = ("x", "y", "z", "φx", "φy", "φz")
    lines = ["    " + ", ".join(f"{n} {s:{digits}} %" for n, s in zip(names, shares, strict=True))]
    if len(answer.frequencies):
        shares = 100.0 * left_open.frequencies / answer.frequencies
        lines.append("    frequencies " + ", ".join(f"{share:{digits}} %" for share in shares))
    if shares_of_loads := left_open.shares_of_loads(answer.loads):
        told = (f"{name} {100.0 * share:.2g} %" for name, share in shares_of_loads.items())
        lines.append("    under loads " + ", ".join(told))
    return lines


def _head(place: Place) -> tuple[str, str]:
    """What is looked at and how it is held, and where and in which axes the answer is given."""
    match place:
        case {"leg": number}:
            return f"leg {number}, root clamped", "leg axes"
        case {"body": name}:
            return f"{name}, clamped at its first point", "at its second, body axes"
        case {"pose": list(pose)}:
            where = ", ".join(f"{value:.6g}" for value in pose)
            return (
                f"pose ({where})" if pose else "reference posture",
                "at the loaded point, base axes",
            )
        case _:
            return f"x = {place['x']:.6g} m", "at the loaded point, robot axes"
