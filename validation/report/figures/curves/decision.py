"""All models with solid legs beside them: over the stroke and the family, and what they choose."""

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from lumped.arrays import Array
from validation.context import Context
from validation.drawing.chart import Chart, Note, Panel, Series, lettered
from validation.drawing.scales import from_zero, largest, plain_log
from validation.drawing.style import LOOKS, csv_of, known_as
from validation.exhibits import LENGTHS
from validation.report.figures.curves.computed import STROKE_LABEL
from validation.report.figures.curves.lines import ALPHA_LABEL, PLACES, as_in_paper
from validation.report.figures.declared import FigureGroup, Shown, curves
from validation.sweeps.decision import MEANING, OBJECTIVES, UNITS, Decision, Objective
from validation.sweeps.plans import FREE, RIGID, stroke_stations
from validation.sweeps.studies import (
    DECIDED,
    GROUP,
    PLANS,
    POINTS,
    STROKE_FREQUENCIES,
    Curves,
    decision_of,
    family_of,
    stroke_of,
)

# From the bottom of the stack to its top: width (pt) of each model.
_WIDTHS = {"simplified": 1.6, "VJM": 4.4, "segments": 3.2, "beam": 2.2, FREE: 1.4, RIGID: 1.0}
_LOADS = {
    "planar_x": "planar, force along x",
    "planar_y": "planar, force along y",
    "along_z": "along z",
}
_AXES = {"planar_x": "x", "planar_y": "y", "along_z": "z"}
_OPTIMUM = {"marker": "*", "markersize": 13.0, "markeredgecolor": "black", "linestyle": "none"}
figures = FigureGroup(LENGTHS, GROUP)


@figures.figure(
    "decision.objectives",
    "What each model chooses: objective against leg length, optima marked",
    presets=DECIDED,
)
def objectives(context: Context) -> Shown:
    """One panel per objective: all models over α, a large mark at what each of them chooses."""
    decision = decision_of(context)
    titles = ("largest deflection", "smallest first frequency")
    panels, columns = [], {"α": decision.alphas}
    for objective, title in zip(OBJECTIVES, titles, strict=True):
        name = f"{objective} ({UNITS[objective]})"
        labels = [label for label in _WIDTHS if (label, objective) in decision.choices]
        found = {label: np.array(decision.curve(label, objective)) for label in labels}
        series = [
            _looked_at(decision, label, objective, rank / len(labels))
            for rank, label in enumerate(labels)
        ]
        series += [_optimum(decision, label, objective) for label in labels]
        low = min(float(np.nanmin(curve)) for curve in found.values())
        scale = partial(plain_log, low=0.7 * low, high=1.4 * largest(found.values()))
        panels.append(Panel(series, title, name, scale))
        columns |= {f"{label}: {name}": tuple(curve.tolist()) for label, curve in found.items()}
    return curves(
        Chart(lettered(panels), ALPHA_LABEL, 2, 3.2),
        *(_verdict(decision, objective) for objective in OBJECTIVES),
        *(f"Impossible: {found}." for found in decision.impossible),
        data=csv_of(columns),
    )


@figures.figure(
    "decision.family",
    f"Robots with longer legs, solid legs beside the lumped models {as_in_paper(6, 13)}",
)
def longer_legs(context: Context) -> Shown:
    """Upper row the three deflections, lower row two frequencies, a column per point."""
    alphas, found = family_of(context)
    upper, lower = [], []
    for place, point in enumerate(POINTS):
        here = {label: found[label, point] for label in _WIDTHS if (label, point) in found}
        x = np.array(alphas)
        deflections = [one for name in _LOADS for one in _deflections(here, x, name)]
        letters = [
            Note(axis, x[-1], getattr(here[RIGID].deflections, name)[-1])
            for name, axis in _AXES.items()
        ]
        frequencies = [one for mode in range(2) for one in _frequencies(here, x, mode)]
        # Those of a rigid direction are infinite.
        finite = np.concatenate([one.y[np.isfinite(one.y)] for one in frequencies])
        hertz = partial(plain_log, low=0.8 * float(finite.min()), high=1.3 * float(finite.max()))
        microns = partial(plain_log, low=0.1, high=1.4 * largest(one.y for one in deflections))
        labels = (
            ("", "") if place else ("deflection under 1000 N (µm)", "first two frequencies (Hz)")
        )
        upper.append(
            Panel(deflections, PLACES[point], labels[0], microns, (), letters, place=point)
        )
        lower.append(Panel(frequencies, "", labels[1], hertz, place=point))
    solid = found[RIGID, "centre"]
    falls, rises = solid.frequencies[:, 0], solid.deflections.along_z
    return curves(
        Chart([*upper, *lower], ALPHA_LABEL, len(POINTS), 2.8, abscissa={"α": alphas}),
        "Upper row: planar deflections under a force along x and y, and that along z, by the "
        f"letters at the right. At the centre, from α = {alphas[0]:g} to {alphas[-1]:g}, the "
        f"robot with solid legs goes from {rises[0]:.1f} to {rises[-1]:.1f} µm along z and its "
        f"first frequency from {falls[0]:.1f} to {falls[-1]:.1f} Hz.",
    )


@figures.figure(
    "decision.stroke", "Deflections and frequencies over the stroke, all models with solid legs"
)
def over_the_stroke(context: Context) -> Shown:
    """Three panels of deflections and one of the first four frequencies."""
    found = stroke_of(context)
    x = np.array(stroke_stations(context.robot, PLANS[context.preset].stations))
    here = {label: found[label] for label in _WIDTHS if label in found}
    panels = [
        Panel(list(_deflections(here, x, name)), title, "deflection under 1000 N (µm)", from_zero)
        for name, title in _LOADS.items()
    ]
    refined = {label: one for label, one in here.items() if label != "simplified"}
    modes = [one for mode in range(STROKE_FREQUENCIES) for one in _frequencies(refined, x, mode)]
    panels.append(Panel(modes, "first four frequencies", "natural frequency (Hz)", from_zero))
    return curves(
        Chart(panels, STROKE_LABEL, 2, 2.8, 3, {"x (m)": x.tolist()}),
        "All models of one robot with the same equivalent legs. Planar deflections coincide; "
        "along z rigid end faces, which restrain warping, make the solid up to "
        f"{100.0 * _stiffer(here):.2g} % stiffer than the virtual joints.",
    )


def _looked_at(decision: Decision, label: str, objective: Objective, shift: float) -> Series:
    """A model's objective at every α that it looked at, those of its search among them."""
    look, width = LOOKS[known_as(label)], _WIDTHS[label]
    values = decision.values[label]
    alphas = sorted(values)
    found = np.array([values[alpha].of(objective) for alpha in alphas])
    # Markers by distance along the curve: the search has many α close together.
    every = {"markevery": (0.3 * shift, 0.3)}
    return Series(label, np.array(alphas), found, look, width, more=every)


def _optimum(decision: Decision, label: str, objective: Objective) -> Series:
    """What a model chooses; without an entry in the legend."""
    choice, look = decision.choices[label, objective], LOOKS[known_as(label)]
    at = (np.array([choice.best]), np.array([choice.value]))
    return Series(f"_{label}", *at, look, fill=look.colour, more={**_OPTIMUM, "markevery": 1})


def _deflections(found: Mapping[str, Curves], x: Array, name: str) -> Iterator[Series]:
    for label, one in found.items():
        look, width = LOOKS[known_as(label)], _WIDTHS[label]
        values = getattr(one.deflections, name)
        yield Series(label, x, values, look, width, f"{_LOADS[name]} (µm)")


def _frequencies(found: Mapping[str, Curves], x: Array, mode: int) -> Iterator[Series]:
    for label, one in found.items():
        look, width = LOOKS[known_as(label)], _WIDTHS[label]
        if one.frequencies.shape[1] > mode:
            quantity = f"frequency {mode + 1} (Hz)"
            yield Series(label, x, one.frequencies[:, mode], look, width, quantity)


def _stiffer(curves: Mapping[str, Curves]) -> float:
    ratio = curves[RIGID].deflections.along_z / curves["VJM"].deflections.along_z
    return float(np.max(1.0 - ratio))


def _verdict(decision: Decision, objective: Objective) -> str:
    simple, solid = (decision.choices[label, objective] for label in ("simplified", RIGID))
    shortest, longest = simple.indifferent
    losses = [100.0 * decision.cost_at(a, objective, RIGID) for a in (shortest, longest)]
    own = ("simplified", RIGID)
    labels = [label for label, of in decision.choices if of == objective and label in _WIDTHS]
    followed = [label for label in labels if label not in own]
    worst = max(100.0 * decision.cost(label, objective, RIGID) for label in followed)
    meaning = MEANING[objective][0].upper() + MEANING[objective][1:]
    return (
        f"{meaning}: the solid chooses α = {solid.best:.4g} ({solid.value:.3g} "
        f"{UNITS[objective]}). To the simplified model α = {shortest:.4g} to {longest:.4g} are "
        f"equally good, which costs {losses[0]:.3g} to {losses[1]:.3g} % in the solid's terms; "
        f"following {', '.join(followed)} costs at most {worst:.2g} %."
    )
