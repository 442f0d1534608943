"""Cases declared next to the function that computes them, with common fields specified once.

Input: a function that computes a measurement, texts, and values of parameters. Output: one `Case`
for each combination of the parameters. Example:

    cases = CaseGroup(section="The mechanism over its path", group="mine", unit="Hz")

    @cases.case(
        "mine.{model}[{theory}]",
        "First frequency by {model} of {theory} theory above 100 Hz",
        over={"model": ("beam", "segments"), "theory": ("euler-bernoulli", "timoshenko")},
        quantity="lowest over the path",
        ...
    )
    def _lowest(context: Context, model: ModelName, theory: Theory) -> Measurement: ...

`cases()` returns all cases in the order of their declaration. One declaration makes a case for each
combination of the parameters in `over`. The rules are:

- Texts, and tuples of texts, are templates, into which the values of the parameters are inserted
  ("{kind}", "{entry.unit}", "{alpha:g}").
- A field can be given as a function. It is called with the values of those parameters that have the
  names of its arguments. The values of a key of `over` can be given as a function of parameters
  that come earlier.
- If a parameter has the name of a field, such as `model`, its value is the default of this field.
  The default of the field `quantity` is the title.
- The function that computes a case is called with the context and the values of those parameters
  that have the names of its arguments.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from inspect import signature
from typing import Any, Self, TypeAlias, TypedDict, TypeVar, Unpack

from validation.case import Case, CaseKind, Measurement, ReferenceKind, Relation, Tolerance
from validation.context import About, Preset

T = TypeVar("T")
Field: TypeAlias = T | Callable[..., T]
# Values of each parameter by its name. For several names in one key, "name, limit", tuples of
# values.
Over: TypeAlias = Mapping[str, Field[Iterable[Any]]]
Compute = TypeVar("Compute", bound=Callable[..., Measurement])


def numbered(modes: int) -> tuple[tuple[int, int], ...]:
    """Pairs of index (from 0) and number (from 1), for `over={"index, mode": numbered(6)}`."""
    return tuple((index, index + 1) for index in range(modes))


class CaseFields(TypedDict, total=False):
    """Fields of a `Case`, or functions of parameters that return them. Texts are templates."""

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
    """Cases that have `common` fields. Each case is repeated for each parameter value in `over`.

    The parameters of the group vary slowest: first come all cases of the group for the first value,
    then all for the next value.
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
        """Decorator of a function that computes a case; it declares the case in this group.

        With `over`, it declares one case for each combination of the parameters.
        """

        def declare(compute: Compute) -> Compute:
            declared_fields = {"id": identifier, "title": title, **fields}
            self._declared.append(
                partial(_cases, compute, over or {}, self._common, declared_fields)
            )
            return compute

        return declare

    def family(self, *, over: Over | None = None, **fields: Unpack[CaseFields]) -> Self:
        """Group within this group, whose cases have these `fields` in common as well."""
        common: CaseFields = {**self._common, **fields}
        group = type(self)(over=over, **common)
        self._declared.append(group)
        return group

    def __call__(self, **parameters: Any) -> tuple[Case, ...]:
        """All cases of the group, for `parameters` whose values depend on the robot file.

        Raises KeyError if a template contains a name that is not a parameter, and TypeError if a
        function has an argument that is not a parameter.
        """
        return tuple(
            case
            for row in _combinations(parameters, self._over)
            for declared in self._declared
            for case in declared(**row)
        )


def _cases(
    compute: Callable[..., Measurement],
    over: Over,
    common: CaseFields,
    declared_fields: Mapping[str, Any],
    /,
    **parameters: Any,
) -> tuple[Case, ...]:
    cases = []
    for row in _combinations(parameters, over):
        arguments = _arguments(compute, row)
        signature(compute).bind("context", **arguments)
        from_row = {name: row[name] for name in CaseFields.__annotations__ if name in row}
        fields = {"quantity": declared_fields["title"], **common, **from_row, **declared_fields}
        values = {name: _filled(row, field) for name, field in fields.items()}
        cases.append(
            Case(compute=partial(compute, **arguments) if arguments else compute, **values)
        )
    return tuple(cases)


def _combinations(parameters: Mapping[str, Any], over: Over) -> list[dict[str, Any]]:
    """All combinations of parameter values, as dictionaries by name of the parameter.

    `parameters` have the same values in all combinations. The last parameter of `over` varies
    fastest.
    """
    combinations = [dict(parameters)]
    for key, values in over.items():
        names = key.split(", ")
        combinations = [
            row | dict(zip(names, value if len(names) > 1 else (value,), strict=True))
            for row in combinations
            for value in (values(**_arguments(values, row)) if callable(values) else values)
        ]
    return combinations


def _filled(row: Mapping[str, Any], field: Any) -> Any:
    """Field with the parameter values of `row` filled in."""
    if isinstance(field, tuple):
        return tuple(_filled(row, text) for text in field)
    if isinstance(field, str):
        return field.format(**row) if row else field
    return field(**_arguments(field, row)) if callable(field) else field


def _arguments(function: Callable[..., Any], row: Mapping[str, Any]) -> dict[str, Any]:
    return {name: row[name] for name in signature(function).parameters if name in row}
