"""Table of the elements per leg that an error of 1 % requires, by formulation.

Input: convergence studies of the run's figures. Output: `ElementCounts`. Rule: the quantity with
the largest error among f1 to f4 and three deflections, over all legs and the robot, determines the
count.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from validation.drawing.text import percent
from validation.studies_and_figures import ElementStudy, Figure

_TARGET = "0.01"
# Relative errors below this are displayed as "below 0.001 %".
_SMALLEST = 1e-5


@dataclass(frozen=True)
class ElementCount:
    """Elements per leg of one formulation, for its worst frequency or deflection.

    `needed`: elements for an error of 1 %. `error`: the largest error with the element count of
    table [agree] of the robot file. `worst`: the quantity with this error. Both are "" if that
    count was not computed; `worst` is also "" if the error is negligible.
    """

    formulation: str
    needed: str
    error: str
    worst: str


@dataclass(frozen=True)
class ElementCounts:
    """Element counts of those formulations that use Timoshenko's beam theory.

    `stated`: element count of [agree], with which the errors in `rows` were computed.
    """

    rows: tuple[ElementCount, ...]
    stated: int


def element_counts(figures: Sequence[Figure]) -> ElementCounts | None:
    """Element counts of formulations. None if no study varies the element count."""
    studies = [
        study for figure in figures for study in figure.studies if isinstance(study, ElementStudy)
    ]
    labels = dict.fromkeys(
        label
        for study in studies
        for label, theory in study.theory.items()
        if theory == "timoshenko"
    )
    rows = [_row(label, [study for study in studies if label in study.series]) for label in labels]
    return ElementCounts(tuple(rows), studies[0].stated) if rows else None


def _row(label: str, studies: Sequence[ElementStudy]) -> ElementCount:
    errors = {
        f"{study.quantity} of {study.body or 'the robot'}": abs(error)
        for study in studies
        if (error := _stated_error(label, study)) is not None
    }
    needed = _needed(label, studies)
    if not errors:
        return ElementCount(label, needed, "", "")
    worst = max(errors, key=lambda label: errors[label])
    if errors[worst] < _SMALLEST:
        return ElementCount(label, needed, f"below {percent(_SMALLEST, signed=False)}", "")
    return ElementCount(label, needed, percent(errors[worst], signed=False), worst)


def _needed(label: str, studies: Sequence[ElementStudy]) -> str:
    """Elements per leg for an error of 1 % by the formulation with this label, as text.

    If the required number lies outside the computed counts, the text is a bound: "more than 80" or
    "at most 4".
    """
    counts = [study.needed[label][_TARGET] for study in studies]
    needed = [count for count in counts if count is not None]
    computed = [
        count
        for study in studies
        for count, value in zip(study.x, study.series[label], strict=True)
        if value is not None
    ]
    if len(needed) < len(counts):
        return f"more than {max(computed)}"
    largest = max(needed)
    return f"at most {largest}" if largest == min(computed) > 1 else str(largest)


def _stated_error(label: str, study: ElementStudy) -> float | None:
    """Relative error of the formulation `label` with the element count of table [agree].

    None if it was not computed.
    """
    count = study.stated
    if count not in study.x:
        return None
    value = study.series[label][study.x.index(count)]
    return None if value is None else float(value / study.limit[label] - 1.0)
