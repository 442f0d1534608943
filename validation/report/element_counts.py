"""Elements per leg that an error takes, from the studies of convergence with element count."""

from collections.abc import Mapping, Sequence
from typing import Any

from validation.drawing.text import percent
from validation.exhibits import Figure

_TARGET = "0.01"


def element_count_sentence(figures: Sequence[Figure]) -> str:
    """Elements that 1 % takes and the error with the stated count; "" without such a study.

    Of each formulation by Timoshenko's theory, for the worst of all frequencies and deflections of
    legs and robot.
    """
    studies = [study for figure in figures for study in figure.studies if "needed" in study]
    labels = dict.fromkeys(
        label
        for study in studies
        for label, theory in study["theory"].items()
        if theory == "timoshenko"
    )
    parts = [
        _formulation(label, [study for study in studies if label in study["series"]])
        for label in labels
    ]
    if not parts:
        return ""
    return (
        "Elements per leg that an error of 1 % takes, for f1 to f4 and the deflections of legs and "
        f"robot: {'; '.join(parts)}."
    )


def _formulation(label: str, studies: Sequence[Mapping[str, Any]]) -> str:
    needed = [study["needed"][label][_TARGET] for study in studies]
    finest = max(max(study["x"]) for study in studies)
    count = f"more than {finest}" if None in needed else str(max(needed))
    errors = [abs(error) for study in studies if (error := _stated_error(label, study)) is not None]
    if not errors:
        return f"{count} by {label}"
    stated = studies[0]["stated"]
    return f"{count} by {label} (with {stated}: {percent(max(errors), signed=False)})"


def _stated_error(label: str, study: Mapping[str, Any]) -> float | None:
    """Relative error with the stated count of elements; None if it was not computed."""
    count = study["stated"]
    if count not in study["x"]:
        return None
    value = study["series"][label][study["x"].index(count)]
    return None if value is None else float(value / study["limit"][label] - 1.0)
