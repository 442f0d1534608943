"""Cases declared where they are computed, and said once what many of them have in common.

    cases = CaseGroup(section="The mechanism over its path", group="mine", unit="Hz")

    @cases.case(
        "mine.{model}[{theory}]",
        "First frequency by {model} of {theory} theory above 100 Hz",
        over={"model": ("beam", "segments"), "theory": ("euler-bernoulli", "timoshenko")},
        quantity="lowest over the path",
        ...
    )
    def _lowest(context: Context, model: ModelName, theory: Theory) -> Measurement: ...

`cases()` has them in the order of their declaration. One declaration is as many cases as there are
parameters to take it over: texts, and tuples of texts, are templates of them ("{kind}",
"{entry.unit}", "{alpha:g}"), and any field, the parameters of a later key of `over` too, may be a
function of those it names. A parameter with the name of a field, such as `model`, is that field
where the declaration says nothing else of it; the quantity is the title where nothing else is said
of it. What computes a case is given the parameters that it names.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from inspect import signature
from typing import Any, Self, TypeAlias, TypedDict, TypeVar, Unpack

from validation.case import Case, CaseKind, Measurement, ReferenceKind, Relation, Tolerance
from validation.context import About, Preset

T = TypeVar("T")
Field: TypeAlias = T | Callable[..., T]
# Values by the parameter's name; by several names, "name, limit", tuples of values.
Over: TypeAlias = Mapping[str, Field[Iterable[Any]]]
Compute = TypeVar("Compute", bound=Callable[..., Measurement])


def numbered(modes: int) -> tuple[tuple[int, int], ...]:
    """Indices from 0 with numbers from 1, as in `over={"index, mode": numbered(6)}`."""
    return tuple((index, index + 1) for index in range(modes))


class CaseFields(TypedDict, total=False):
    """Fields of a `Case`, or functions of parameters that make them; texts are templates."""

    quantity: Field[str]
    unit: Field[str]
    reference_kind: Field[ReferenceKind]
    citation: Field[str]
    tolerance: Field[Tolerance]
    tolerance_reason: Field[str]
    relation: Field[Relation]
    presets: Field[tuple[Preset, ...]]
    section: Field[str]
    group: Field[str]
    effort: Field[float]
    model: Field[str]
    subject: Field[About]
    figure: Field[str]
    label: Field[str]
    kind: Field[CaseKind]
    body: Field[str]
    elements: Field[int]


class CaseGroup:
    """Cases with fields in `common`, all of them taken `over` the same parameters.

    The parameters of the group are the outermost: all its cases for the first value, then all for
    the next.
    """

    def __init__(self, *, over: Over | None = None, **common: Unpack[CaseFields]) -> None:
        self._over = over or {}
        self._common = common
        self._declared: list[Callable[..., tuple[Case, ...]]] = []

    def case(
        self,
        identifier: Field[str],
        title: Field[str],
        *,
        over: Over | None = None,
        **fields: Unpack[CaseFields],
    ) -> Callable[[Compute], Compute]:
        """Declare a case, or one for each combination of the parameters, by what computes it."""

        def declare(compute: Compute) -> Compute:
            own = {"id": identifier, "title": title, **fields}
            self._declared.append(partial(_cases, compute, over or {}, self._common, own))
            return compute

        return declare

    def family(self, *, over: Over | None = None, **fields: Unpack[CaseFields]) -> Self:
        """A group within this one, in its place; it has these `fields` in common as well."""
        common: CaseFields = {**self._common, **fields}
        within = type(self)(over=over, **common)
        self._declared.append(within)
        return within

    def __call__(self, **given: Any) -> tuple[Case, ...]:
        """All cases; `given` parameters are those that a robot's file decides.

        Raises KeyError for a template, TypeError for a function with a parameter that is not there.
        """
        return tuple(
            case
            for row in _rows(given, self._over)
            for declared in self._declared
            for case in declared(**row)
        )


def _cases(
    compute: Callable[..., Measurement],
    over: Over,
    common: CaseFields,
    own: Mapping[str, Any],
    /,
    **given: Any,
) -> tuple[Case, ...]:
    found = []
    for row in _rows(given, over):
        named = _named(compute, row)
        signature(compute).bind("context", **named)
        from_row = {name: row[name] for name in CaseFields.__annotations__ if name in row}
        fields = {"quantity": own["title"], **common, **from_row, **own}
        filled = {name: _of(row, field) for name, field in fields.items()}
        found.append(Case(compute=partial(compute, **named) if named else compute, **filled))
    return tuple(found)


def _rows(given: Mapping[str, Any], over: Over) -> list[dict[str, Any]]:
    """Every combination of parameters, the last one of `over` changing fastest."""
    rows = [dict(given)]
    for key, values in over.items():
        names = key.split(", ")
        rows = [
            row | dict(zip(names, value if len(names) > 1 else (value,), strict=True))
            for row in rows
            for value in (values(**_named(values, row)) if callable(values) else values)
        ]
    return rows


def _of(row: Mapping[str, Any], field: Any) -> Any:
    """A field with the parameters filled in."""
    if isinstance(field, tuple):
        return tuple(_of(row, one) for one in field)
    if isinstance(field, str):
        return field.format(**row) if row else field
    return field(**_named(field, row)) if callable(field) else field


def _named(function: Callable[..., Any], row: Mapping[str, Any]) -> dict[str, Any]:
    return {name: row[name] for name in signature(function).parameters if name in row}
