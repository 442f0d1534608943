"""Studies that belong together, in the same axes: refinement with its order, sweeps of models."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from os.path import commonprefix

from validation.case import Outcome
from validation.exhibits import Study
from validation.report.text import function_name

# Parts of a sweep's id that name a model or a variant of it, not what is swept.
_NAMING = {
    *("simplified", "vjm", "segments", "beam", "solid"),
    *("euler-bernoulli", "timoshenko"),
}


@dataclass(frozen=True)
class Curve:
    """One series of a study under the name it has beside its fellows."""

    label: str
    name: str
    study: Study

    @property
    def values(self) -> tuple[float, ...]:
        """The values of the curve, in the unit of its study."""
        return self.study.series[self.name]

    @property
    def limit(self) -> float | None:
        """What the values tend to, where it is known."""
        return self.study.limits.get(self.name)

    @property
    def order(self) -> float | None:
        """Observed order, where there is one."""
        return self.study.orders.get(self.name)

    @property
    def uncertainty(self) -> float | None:
        """Numerical uncertainty of the finest value."""
        return self.study.uncertainties.get(self.name)


@dataclass(frozen=True)
class Family:
    """Studies with the same abscissa, drawn together; `computed_by` names their functions."""

    id: str
    title: str
    curves: tuple[Curve, ...]
    computed_by: tuple[str, ...] = ()

    @property
    def first(self) -> Study:
        """The study that names the axes."""
        return self.curves[0].study

    @property
    def kind(self) -> str:
        """Convergence or sweep."""
        return self.first.kind

    @property
    def studies(self) -> tuple[Study, ...]:
        """The studies of the family."""
        return tuple({curve.study.id: curve.study for curve in self.curves}.values())

    @property
    def notes(self) -> tuple[str, ...]:
        """What the studies remark, each remark once, with the curves it is about if not all."""
        remarks: dict[str, list[str]] = {}
        for curve in self.curves:
            for note in curve.study.notes:
                remarks.setdefault(note.rstrip("."), []).append(curve.label)
        return tuple(
            f"{note}."
            if len(labels) == len(self.curves)
            else f"{note} ({', '.join(dict.fromkeys(labels))})."
            for note, labels in remarks.items()
        )


def families(outcomes: Sequence[Outcome]) -> tuple[Family, ...]:
    """The studies that came with the outcomes by family, in the order of their first member.

    Refinements belong together if their ids differ in the last part alone, sweeps if they differ
    in the names of models; all must have the same kind and abscissa.
    """
    gathered: dict[tuple[str, ...], dict[str, Study]] = {}
    titles: dict[str, list[str]] = {}
    makers: dict[str, list[str]] = {}
    for outcome in outcomes:
        for study in outcome.measurement.studies if outcome.measurement else ():
            stem = _stem(study)
            key = (stem, study.kind, study.x_label, repr(study.x))
            gathered.setdefault(key, {})[study.id] = study
            titles.setdefault(stem, []).append(outcome.case.title)
            makers.setdefault(study.id, []).append(function_name(outcome.case.compute))
    stems = [key[0] for key in gathered]
    return tuple(
        replace(
            _family(
                stem if len(members) > 1 and stems.count(stem) == 1 else next(iter(members)),
                tuple(members.values()),
                titles[stem],
            ),
            computed_by=tuple(dict.fromkeys(name for one in members for name in makers[one])),
        )
        for (stem, *_), members in gathered.items()
    )


def alone(study: Study) -> Family:
    """A family of one study."""
    curves = tuple(Curve(_spoken(name), name, study) for name in study.series)
    return Family(study.id, _capitalised(study.title), curves)


def _stem(study: Study) -> str:
    parts = study.id.split(".")
    if study.kind == "convergence":
        return ".".join(parts[:-1]) if len(parts) > 2 else study.id
    kept = [part for part in parts if part not in _NAMING]
    return ".".join(kept) or study.id


def _family(identifier: str, members: Sequence[Study], case_titles: Sequence[str]) -> Family:
    if len(members) == 1:
        return alone(members[0])
    curves: dict[str, Curve] = {}
    for study in members:
        for name in study.series:
            curve = Curve(_label(name, study, members), name, study)
            # Equal curves (the reference of several comparisons) are drawn once.
            curves.setdefault(f"{curve.label} {curve.values!r}", curve)
    title = _common([study.title for study in members]) or _common(case_titles) or identifier
    measured = members[0].y_label.partition(" (")[0]
    if members[0].kind == "sweep" and measured not in title:
        title = f"{title}: {measured}"
    return Family(identifier, _capitalised(title), tuple(curves.values()))


def _capitalised(title: str) -> str:
    return title[0].upper() + title[1:]


def _spoken(name: str) -> str:
    return re.sub(r"^vjm\b", "VJM", name)


def _common(titles: Sequence[str]) -> str:
    """What the titles begin with, cut at a word, and what all of them end with after a colon."""
    shared = commonprefix(list(titles))  # noqa: RUF071  titles, no paths
    words = (shared if shared.endswith((" ", ":")) else shared.rpartition(" ")[0]).rstrip(" :,")
    start = words.removesuffix(" in")
    endings = {title.rpartition(": ")[2] for title in titles}
    return f"{start}: {endings.pop()}" if start and len(endings) == 1 else start


def _label(name: str, study: Study, members: Sequence[Study]) -> str:
    if sum(name in other.series for other in members) == 1:
        return _spoken(name)
    if study.kind == "convergence":
        return study.title.rpartition(": ")[2] or name
    variants = {part for other in members for part in other.id.split(".") if part in _THEORIES}
    own = next((part for part in study.id.split(".") if part in variants), "")
    said = _spoken(name)
    return f"{said}, {_THEORIES[own]}" if len(variants) > 1 and own else said


_THEORIES = {"euler-bernoulli": "Euler–Bernoulli", "timoshenko": "Timoshenko"}
