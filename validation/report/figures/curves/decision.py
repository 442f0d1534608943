"""All models with solid legs beside them: over the stroke and the family, and what they choose."""

from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np
from matplotlib.axes import Axes

from lumped.arrays import Array
from validation.context import Context
from validation.drawing.style import (
    MODELS,
    PURPLE,
    Look,
    canvas,
    csv_of,
    marked,
    plot_style,
    svg_of,
)
from validation.exhibits import LENGTHS, Drawing, Figure
from validation.report.figures.curves.lines import (
    ALPHA_LABEL,
    PLACES,
    as_in_paper,
    from_zero,
    legend_above,
    plain_log,
)
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

# From the bottom of the stack to its top: colour, marker and width (pt) of each model.
LOOKS: Mapping[str, tuple[Look, float]] = {
    "simplified": (MODELS["simplified"], 1.6),
    "VJM": (MODELS["vjm"], 4.4),
    "segments": (MODELS["segments"], 3.2),
    "beam": (MODELS["beam"], 2.2),
    FREE: (Look(PURPLE, "P", ":"), 1.4),
    RIGID: (MODELS["solid"], 1.0),
}
_LOADS = {
    "planar_x": "planar, force along x",
    "planar_y": "planar, force along y",
    "along_z": "along z",
}
_FAMILY_TITLE = f"Robots with longer legs, solid legs beside the lumped models {as_in_paper(6, 13)}"
_STROKE_TITLE = "Deflections and frequencies over the stroke, all models with solid legs"
_DECISION_TITLE = "What each model chooses: objective against leg length, optima marked"


def drawings() -> tuple[Drawing, ...]:
    """Decision, family and stroke; they share the sweeps of the cases."""
    return (
        Drawing(
            "decision.objectives",
            _DECISION_TITLE,
            objectives,
            section=LENGTHS,
            group=GROUP,
            presets=DECIDED,
        ),
        Drawing("decision.family", _FAMILY_TITLE, longer_legs, section=LENGTHS, group=GROUP),
        Drawing("decision.stroke", _STROKE_TITLE, over_the_stroke, section=LENGTHS, group=GROUP),
    )


def objectives(context: Context) -> Figure:
    """One panel per objective: all models over α, a large mark at what each of them chooses."""
    decision = decision_of(context)
    columns: dict[str, Sequence[float]] = {"α": decision.alphas}
    with plot_style():
        picture, panels = canvas(columns=2, height=4.0)
        for axes, objective in zip(panels, OBJECTIVES, strict=True):
            labels = [label for label in LOOKS if (label, objective) in decision.choices]
            curves = {label: np.array(decision.curve(label, objective)) for label in labels}
            for rank, label in enumerate(labels):
                _looked_at(axes, decision, label, objective, rank / len(labels))
            for label, curve in curves.items():
                choice = decision.choices[label, objective]
                axes.plot(
                    choice.best,
                    choice.value,
                    marker="*",
                    markersize=13.0,
                    color=LOOKS[label][0].colour,
                    markerfacecolor=LOOKS[label][0].colour,
                    markeredgecolor="black",
                    linestyle="none",
                )
                columns[f"{label}: {objective} ({UNITS[objective]})"] = curve.tolist()
            finite = np.concatenate([curve[np.isfinite(curve)] for curve in curves.values()])
            plain_log(axes, 0.7 * float(finite.min()), 1.4 * float(finite.max()))
            axes.set(xlabel=ALPHA_LABEL, ylabel=f"{objective} ({UNITS[objective]})")
        panels[0].set_title("(a) largest deflection")
        panels[1].set_title("(b) smallest first frequency")
        legend_above(picture)
        svg = svg_of(picture)
    verdicts = (_verdict(decision, objective) for objective in OBJECTIVES)
    return Figure(
        id="decision.objectives",
        title=_DECISION_TITLE,
        caption=" ".join((*verdicts, *(f"Impossible: {f}." for f in decision.impossible))),
        section=LENGTHS,
        svg=svg,
        data=csv_of(columns),
    )


def longer_legs(context: Context) -> Figure:
    """Upper row the three deflections, lower row two frequencies, a column per point."""
    alphas, curves = family_of(context)
    x = np.array(alphas)
    columns: dict[str, Sequence[float]] = {"α": alphas}
    with plot_style():
        picture, panels = canvas(rows=2, columns=len(POINTS), height=6.4)
        upper, lower = panels[: len(POINTS)], panels[len(POINTS) :]
        for deflection, frequency, point in zip(upper, lower, POINTS, strict=True):
            here = {label: curves[label, point] for label in LOOKS if (label, point) in curves}
            _deflections(deflection, x, here)
            for mode in range(2):
                _lines(frequency, x, _frequencies(here, mode))
            plain_log(frequency, *_frequency_range(here))
            deflection.set_title(PLACES[point])
            frequency.set_xlabel(ALPHA_LABEL)
            columns |= _table(here, f"{point}, ")
        upper[0].set_ylabel("deflection under 1000 N (µm)")
        lower[0].set_ylabel("first two frequencies (Hz)")
        legend_above(picture)
        svg = svg_of(picture)
    solid = curves[RIGID, "centre"]
    falls, rises = solid.frequencies[:, 0], solid.deflections.along_z
    return Figure(
        id="decision.family",
        title=_FAMILY_TITLE,
        caption=(
            "Upper row: planar deflections under a force along x and y, and that along z, by the "
            f"letters at the right. At the centre, from α = {alphas[0]:g} to {alphas[-1]:g}, the "
            f"robot with solid legs goes from {rises[0]:.1f} to {rises[-1]:.1f} µm along z and its "
            f"first frequency from {falls[0]:.1f} to {falls[-1]:.1f} Hz."
        ),
        section=LENGTHS,
        svg=svg,
        data=csv_of(columns),
    )


def over_the_stroke(context: Context) -> Figure:
    """Three panels of deflections and one of the first four frequencies."""
    curves = stroke_of(context)
    x = np.array(stroke_stations(context.robot, PLANS[context.preset].stations))
    here = {label: curves[label] for label in LOOKS if label in curves}
    with plot_style():
        picture, panels = canvas(rows=2, columns=2, height=6.4)
        for axes, (attribute, title) in zip(panels, _LOADS.items(), strict=False):
            _lines(axes, x, {label: getattr(c.deflections, attribute) for label, c in here.items()})
            from_zero(axes)
            axes.set(title=title, ylabel="deflection under 1000 N (µm)")
        for mode in range(STROKE_FREQUENCIES):
            refined = {label: c for label, c in here.items() if label != "simplified"}
            _lines(panels[3], x, _frequencies(refined, mode))
        from_zero(panels[3])
        panels[3].set(title="first four frequencies", ylabel="natural frequency (Hz)")
        for axes in panels[2:]:
            axes.set_xlabel("x of B (m)")
        legend_above(picture, columns=3)
        svg = svg_of(picture)
    return Figure(
        id="decision.stroke",
        title=_STROKE_TITLE,
        caption=(
            "All models of one robot with the same equivalent legs. Planar deflections coincide; "
            "along z rigid end faces, which restrain warping, make the solid up to "
            f"{100.0 * _stiffer(here):.2g} % stiffer than the virtual joints."
        ),
        section=LENGTHS,
        svg=svg,
        data=csv_of({"x (m)": x.tolist()} | _table(here, "")),
    )


def _looked_at(
    axes: Axes, decision: Decision, label: str, objective: Objective, shift: float
) -> None:
    """A model's objective at every α that it looked at, those of its search among them."""
    look, width = LOOKS[label]
    values = decision.values[label]
    alphas = sorted(values)
    found = [values[alpha].of(objective) for alpha in alphas]
    # Markers by distance along the curve: the search has many α close together.
    axes.plot(
        alphas,
        found,
        label=label,
        linewidth=width,
        markevery=(0.3 * shift, 0.3),
        **look.options(),
    )


def _lines(axes: Axes, x: Array, curves: Mapping[str, Array]) -> None:
    for rank, (label, values) in enumerate(curves.items()):
        look, width = LOOKS[label]
        if np.any(np.isfinite(values)):
            axes.plot(
                x,
                values,
                label=label,
                linewidth=width,
                markevery=marked(len(x), rank, len(curves)),
                **look.options(),
            )


def _deflections(axes: Axes, x: Array, curves: Mapping[str, Curves]) -> None:
    found = []
    last = curves[RIGID].deflections
    for attribute, name in _LOADS.items():
        axes.annotate(
            name.rpartition(" ")[2],
            (x[-1], getattr(last, attribute)[-1]),
            xytext=(5.0, -3.0),
            textcoords="offset points",
            annotation_clip=False,
            fontsize=8.0,
        )
        values = {label: getattr(c.deflections, attribute) for label, c in curves.items()}
        # At the ends of the stroke the simplified model is rigid along x: no place on the axis.
        shown = {label: np.where(v > 1e-3, v, np.nan) for label, v in values.items()}
        _lines(axes, x, shown)
        found += [v[np.isfinite(v)] for v in shown.values()]
    largest = max(float(v.max()) for v in found if v.size)
    plain_log(axes, 0.1, 1.4 * largest)


def _frequencies(curves: Mapping[str, Curves], mode: int) -> dict[str, Array]:
    return {
        label: c.frequencies[:, mode]
        for label, c in curves.items()
        if c.frequencies.shape[1] > mode
    }


def _frequency_range(curves: Mapping[str, Curves]) -> tuple[float, float]:
    """Limits for the first two frequencies; those of a rigid direction are infinite."""
    found = np.concatenate([c.frequencies[:, :2].ravel() for c in curves.values()])
    finite = found[np.isfinite(found)]
    return 0.8 * float(finite.min()), 1.3 * float(finite.max())


def _stiffer(curves: Mapping[str, Curves]) -> float:
    ratio = curves[RIGID].deflections.along_z / curves["VJM"].deflections.along_z
    return float(np.max(1.0 - ratio))


def _table(curves: Mapping[str, Curves], prefix: str) -> dict[str, Sequence[float]]:
    columns: dict[str, Sequence[float]] = {}
    for (label, c), attribute in product(curves.items(), _LOADS):
        columns[f"{prefix}{label}: {_LOADS[attribute]} (µm)"] = getattr(
            c.deflections, attribute
        ).tolist()
    for label, c in curves.items():
        for mode in range(c.frequencies.shape[1]):
            columns[f"{prefix}{label}: frequency {mode + 1} (Hz)"] = c.frequencies[:, mode].tolist()
    return columns


def _verdict(decision: Decision, objective: Objective) -> str:
    simple, solid = (decision.choices[label, objective] for label in ("simplified", RIGID))
    shortest, longest = simple.indifferent
    losses = [100.0 * decision.cost_at(a, objective, RIGID) for a in (shortest, longest)]
    own = ("simplified", RIGID)
    labels = [label for label, of in decision.choices if of == objective and label in LOOKS]
    followed = [label for label in labels if label not in own]
    worst = max(100.0 * decision.cost(label, objective, RIGID) for label in followed)
    meaning = MEANING[objective][0].upper() + MEANING[objective][1:]
    return (
        f"{meaning}: the solid chooses α = {solid.best:.4g} ({solid.value:.3g} "
        f"{UNITS[objective]}). To the simplified model α = {shortest:.4g} to {longest:.4g} are "
        f"equally good, which costs {losses[0]:.3g} to {losses[1]:.3g} % in the solid's terms; "
        f"following {', '.join(followed)} costs at most {worst:.2g} %."
    )
