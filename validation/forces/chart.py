"""Chart of the forces under one load: along the legs in one pose, or over the poses of a path.

Input: `PoseForces` of one or several poses, and the name of a load. Output: a `Chart`. Rule: over
several poses, only the joints, drives and legs with the largest values are drawn.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from lumped.arrays import Array
from validation.drawing.chart import Chart, Panel, Scale, Series, few_ticks, from_zero, with_zero
from validation.forces.results import ForcesUnderLoad, PoseForces, largest_of

# Number of curves in a panel: more cannot be told apart.
_MOST_CURVES = 6
# Share of the largest curve below which a curve is round-off and is not drawn.
_NEGLIGIBLE = 1e-9
# Panels over the poses, with the scales of their y axes.
_DRIVES = {"N": "force of the drive (N)", "N m": "torque of the drive (N m)"}
_FORCE, _MOMENT = "force in the joint (N)", "moment in the joint (N m)"
_AXIAL, _STRESS = "axial force in the leg (N)", "largest von Mises stress (MPa)"
_OVER_POSES: Mapping[str, Scale] = {
    **dict.fromkeys(_DRIVES.values(), with_zero),
    **dict.fromkeys((_FORCE, _MOMENT), from_zero),
    _AXIAL: with_zero,
    _STRESS: from_zero,
}


def forces_chart(poses: Sequence[PoseForces], model: str, moves: Sequence[str], load: str) -> Chart:
    """Chart of the forces by `model` in `poses` under the load with the name `load`.

    `moves`: coordinates of a pose with their units. Raises KeyError for an unknown load.
    """
    result = [pose.loads[load] for pose in poses]
    if len(result) == 1:
        return _along_legs(result[0], load)
    return _over_poses(poses, model, moves, load)


def _along_legs(result: ForcesUnderLoad | None, load: str) -> Chart:
    """Chart of section forces and stress along the legs, over the distance from each root."""
    members = [] if result is None else result.members
    columns: tuple[tuple[str, str, Callable[[Array], Array]], ...] = (
        ("axial force N (N)", "N (N)", lambda forces: forces[:, 0]),
        ("shear force (N)", "Q (N)", lambda forces: np.linalg.norm(forces[:, 1:3], axis=1)),
        ("torque T (N m)", "T (N m)", lambda forces: forces[:, 3]),
        ("bending moment (N m)", "M (N m)", lambda forces: np.linalg.norm(forces[:, 4:], axis=1)),
    )
    panels = [
        Panel(
            [
                Series(
                    member.leg, member.stations / member.stations[-1], values(member.forces), name
                )
                for member in members
            ],
            title,
            staggered=False,
        )
        for title, name, values in columns
    ]
    stresses = {} if result is None else result.stresses
    panels.append(
        Panel(
            [
                Series(
                    leg,
                    stress.stations / stress.stations[-1],
                    1e-6 * stress.along,
                    "von Mises (MPa)",
                )
                for leg, stress in stresses.items()
            ],
            _STRESS,
            scale=from_zero,
            staggered=False,
        )
    )
    *of_forces, of_stresses = panels
    scale = 0.0 if result is None else largest_of(result)
    drawn = [*(_largest_curves(panel, scale) for panel in of_forces), _largest_curves(of_stresses)]
    return Chart(
        [panel for panel in drawn if panel.series],
        "distance from the root over the length",
        columns=2,
        high=2.1,
    ).captioned(
        f"Section forces and stresses in one pose under the load {load}, along each leg from its "
        "root (0) to its tip (1). N, the axial force, is positive in tension. Shear force and "
        "bending moment are magnitudes over both directions; the stress is the largest in each "
        "section."
    )


def _over_poses(poses: Sequence[PoseForces], model: str, moves: Sequence[str], load: str) -> Chart:
    """Chart of drive forces, joint forces and moments, axial forces and stresses over the poses."""
    result = [pose.loads[load] for pose in poses]
    x, label, ticks = _abscissa(poses, moves)
    curves: dict[str, dict[str, Array]] = {title: {} for title in _OVER_POSES}
    half_widths: dict[str, Array] = {}
    for number, under in enumerate(result):
        if under is None:
            continue
        for title, name, value in _numbers(under):
            curves[title].setdefault(name, np.full(len(result), np.nan))[number] = value
        for leg, stress in under.stresses.items():
            widths = half_widths.setdefault(leg, np.full(len(result), np.nan))
            widths[number] = 1e-6 * stress.half_width
    panels = [
        Panel(
            [
                Series(name, x, y, title, bars=half_widths[name] if title == _STRESS else None)
                for name, y in by_name.items()
            ],
            title,
            scale=_OVER_POSES[title],
            staggered=False,
        )
        for title, by_name in curves.items()
    ]
    *of_forces, of_stresses = panels
    scale = max((largest_of(under) for under in result if under is not None), default=0.0)
    drawn = [*(_largest_curves(panel, scale) for panel in of_forces), _largest_curves(of_stresses)]
    drawn = [panel for panel in drawn if panel.series]
    return Chart(
        drawn,
        label,
        columns=2,
        high=2.1,
        table={label: x.tolist()},
        x_scale=ticks,
    ).captioned(
        f"Forces and stresses over the poses, by the {model} model under the load {load}. Drives: "
        "force or torque. Joints: magnitudes of force and moment. Legs: largest axial force along "
        "the leg (positive in tension) and largest von Mises stress. "
        f"At most the {_MOST_CURVES} largest curves of each kind are drawn. "
        "Bars: half-widths of the numerical uncertainty of the stresses.",
    )


def _numbers(under: ForcesUnderLoad) -> Iterator[tuple[str, str, float]]:
    """Yield each number of a chart over the poses, with its panel and the name of its curve."""
    for reaction in under.reactions:
        if reaction.drive is not None:
            yield _DRIVES[reaction.drive_unit], reaction.joint, reaction.drive
        force, moment = np.linalg.norm(reaction.wrench.reshape(2, 3), axis=1).tolist()
        yield _FORCE, reaction.joint, force
        yield _MOMENT, reaction.joint, moment
    for member in under.members:
        extreme = member.forces[np.argmax(np.abs(member.forces[:, 0])), 0]
        yield _AXIAL, member.leg, float(extreme)
    for leg, stress in under.stresses.items():
        yield _STRESS, leg, 1e-6 * stress.largest


def _largest_curves(panel: Panel, scale: float = 0.0) -> Panel:
    """Copy of a panel with at most `_MOST_CURVES` curves, those with the largest values.

    A curve is omitted as round-off if it is negligible compared with the largest curve or with
    `scale`.
    """
    sizes = [
        np.nanmax(np.abs(curve.y)) if np.isfinite(curve.y).any() else 0.0 for curve in panel.series
    ]
    ranked = sorted(range(len(sizes)), key=lambda number: -sizes[number])[:_MOST_CURVES]
    smallest = _NEGLIGIBLE * max([*sizes, scale])
    drawn = [curve for n, curve in enumerate(panel.series) if n in ranked and sizes[n] > smallest]
    return Panel(drawn, panel.title, scale=panel.scale, staggered=False)


def _abscissa(poses: Sequence[PoseForces], moves: Sequence[str]) -> tuple[Array, str, Scale]:
    """Abscissa with label and ticks: the only coordinate that varies, or the pose number."""
    coordinates = np.array([pose.pose for pose in poses])
    changing = np.flatnonzero(np.ptp(coordinates, axis=0) > 0.0)
    if len(changing) == 1:
        column = int(changing[0])
        return coordinates[:, column], moves[column], partial(few_ticks, count=6)
    return np.arange(1.0, len(poses) + 1.0), "pose", partial(few_ticks, count=6, whole=True)
