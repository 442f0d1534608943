"""Studies that belong together, in the same axes: refinement with its order, sweeps of models."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from validation.drawing.text import function_name
from validation.exhibits import Study
from validation.results.outcome import Outcome


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
    def model(self) -> str:
        """What the curve shares its look with: the model of a mode, else nothing but itself."""
        return self.study.modes[self.name][0] if self.name in self.study.modes else self.label

    @property
    def mode(self) -> int | None:
        """The number of the mode that it is of its model, if it is one."""
        return self.study.modes[self.name][1] if self.name in self.study.modes else None

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

    Members of a family that have another abscissa stand alone.
    """
    gathered: dict[tuple[str, ...], dict[str, Study]] = {}
    makers: dict[str, list[str]] = {}
    for outcome in outcomes:
        for study in outcome.measurement.studies if outcome.measurement else ():
            key = (study.family or study.id, study.kind, study.x_label, repr(study.x))
            gathered.setdefault(key, {})[study.id] = study
            makers.setdefault(study.id, []).append(function_name(outcome.case.compute))
    names = [key[0] for key in gathered]
    return tuple(
        replace(
            _together(tuple(members.values())) if names.count(name) == 1 else _apart(members),
            computed_by=tuple(dict.fromkeys(maker for one in members for maker in makers[one])),
        )
        for (name, *_), members in gathered.items()
    )


def alone(study: Study) -> Family:
    """A family of one study."""
    curves = tuple(Curve(_spoken(name), name, study) for name in study.series)
    return Family(study.id, _capitalised(study.title), curves)


def _apart(members: Mapping[str, Study]) -> Family:
    """Members with an abscissa of their own, under the id of the first: the family's is taken."""
    first = next(iter(members.values()))
    return replace(_together(tuple(members.values())), id=first.id)


def _together(members: Sequence[Study]) -> Family:
    if len(members) == 1:
        return alone(members[0])
    curves: dict[str, Curve] = {}
    for study in members:
        for name in study.series:
            curve = Curve(_label(name, study, members), name, study)
            # Equal curves (the reference of several comparisons) are drawn once.
            curves.setdefault(f"{curve.label} {curve.values!r}", curve)
    first = members[0]
    return Family(
        first.family, _capitalised(first.family_title or first.title), tuple(curves.values())
    )


def _capitalised(title: str) -> str:
    return title[0].upper() + title[1:]


def _spoken(name: str) -> str:
    return "VJM" if name == "vjm" else name


def _label(name: str, study: Study, members: Sequence[Study]) -> str:
    """The series' name, with or (refinements of one quantity each) as the study's variant."""
    variants = {other.variant for other in members if name in other.series}
    if len(variants) == 1 or not study.variant:
        return _spoken(name)
    if study.kind == "convergence":
        return study.variant
    return f"{_spoken(name)}, {study.variant}"
