"""Rules for the values of a robot file: allowed values, faults, conversion, and JSON schema."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, replace
from keyword import iskeyword
from math import isfinite
from operator import ge, gt, le, lt
from re import fullmatch
from typing import Any, ClassVar, Self, TypeGuard, get_type_hints

from lumped.mechanism.length_unit import COORDINATES, METRE, POWERS, UnitOfLength
from lumped.mechanism.mechanism import LENGTHS
from lumped.text import cut, did_you_mean, shown

# Number of unknown keys in a table for which a similar key is suggested. The search takes time.
_LARGEST_SUGGESTION_COUNT = 50
_LONGEST_KEY = 40
# Length of a direction vector below which it counts as zero: its square would be round-off.
NO_DIRECTION = 1e-9


def is_finite_number(entry: object) -> TypeGuard[float]:
    """True for a finite number of a TOML file in the range of a float. Booleans are not numbers."""
    if isinstance(entry, bool) or not isinstance(entry, int | float):
        return False
    try:
        return isfinite(entry)
    except OverflowError:
        return False


def too_many(key: str, count: int, most: int) -> str:
    """Error message for a list or table with `count` entries, if only `most` are allowed."""
    return f"{key}: {count} entries; must be at most {most}"


class Rule(ABC):
    """Base class of rules for one value of a robot file.

    `written` are the Python types of allowed values, both as parsed from TOML and as converted by
    `read`.
    """

    written: ClassVar[tuple[type, ...]] = ()

    @property
    def many(self) -> str:
        """Plural noun for the values that the rule allows, to complete "must be a list of …"."""
        return "entries"

    @property
    @abstractmethod
    def allowed(self) -> str:
        """Description of allowed values, to complete "must be …"."""

    @property
    @abstractmethod
    def schema(self) -> dict[str, Any]:
        """JSON schema of the values that the rule allows."""

    def faults(self, value: object, key: str) -> list[str]:
        """Faults of a value, each line beginning with the key. Empty if the value is allowed."""
        return [] if isinstance(value, self.written) else [self.refused(value, key)]

    def read(self, value: Any) -> Any:
        """Value without faults, converted to the form that computations need."""
        return value

    def checked(self, value: object, key: str) -> tuple[list[str], Any]:
        """Faults of a value, and the converted value. The latter is None if there are faults."""
        faults = self.faults(value, key)
        return faults, None if faults else self.read(value)

    def within(self, value: Any, key: str) -> Iterator[tuple[str, "Rule", Any]]:
        """Yield key, rule and value for a value without faults, and for all values within it.

        The value may be as parsed from TOML, or converted by `read`.
        """
        yield key, self, value

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:  # noqa: ARG002
        """The same rule for a file with lengths in `unit`.

        Values are converted to metres when they are read. `moves` are the moves of the tool, which
        determine the units of the coordinates of a pose.
        """
        return self

    def refused(self, value: object, key: str) -> str:
        """Error message for a value that violates the rule."""
        return f"{key} = {shown(value)}: must be {self.allowed}"


@dataclass(frozen=True)
class Number(Rule):
    """Rule for a number in `unit`, with limits `above` or `least`, and `below` or `most`.

    `above` and `below` are excluded from the allowed range, `least` and `most` are included. `low`
    and `high` are questions to the user about the unit, appended to messages about too small and
    too large numbers. A number above 0 but below `slip` is refused as mistyped. `example` follows
    the unit in messages. `whole` is True for integers. Values are divided by `divisor` when they
    are read.
    """

    written = (int, float)
    unit: str = ""
    above: float | None = None
    least: float | None = None
    below: float | None = None
    most: float | None = None
    low: str = ""
    high: str = ""
    slip: float | None = None
    example: str = ""
    whole: bool = False
    divisor: float = 1.0

    @property
    def allowed(self) -> str:
        kind = "a whole number" if self.whole else "a number"
        if self.least is not None and self.most is not None:
            return f"{kind} from {self.least:g} to {self.most:g}{self._unit}"
        limits = {"above": self.above, "below": self.below, "at most": self.most}
        bounds = [f"{word} {x:g}{self._unit}" for word, x in limits.items() if x is not None]
        return f"{kind} {' and '.join(bounds)}".strip()

    @property
    def many(self) -> str:
        return f"numbers in {self.unit}" if self.unit else "numbers"

    @property
    def schema(self) -> dict[str, Any]:
        limits = {
            "exclusiveMinimum": self.above,
            "minimum": self.slip or self.least,
            "exclusiveMaximum": self.below,
            "maximum": self.most,
        }
        kind = {"type": "integer" if self.whole else "number"}
        return kind | {name: limit for name, limit in limits.items() if limit is not None}

    def faults(self, value: object, key: str) -> list[str]:
        fault = self._fault(value)
        return [f"{key} = {shown(value)}: {fault}"] if fault else []

    def read(self, value: Any) -> int | float:
        return int(value) if self.whole else float(value) / self.divisor

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:  # noqa: ARG002
        if self.unit not in POWERS or unit == METRE:
            return self
        factor = unit.per_metre ** POWERS[self.unit]
        limits = {name: getattr(self, name) for name in ("above", "least", "below", "most", "slip")}
        scaled = {name: limit and limit * factor for name, limit in limits.items()}
        # The questions suspect millimetres in a file in metres, so they do not apply here.
        scaled_rule = replace(
            self, unit=self.unit.replace("m", unit.name), low="", high="", **scaled
        )
        return scaled_rule if self.unit == COORDINATES else replace(scaled_rule, divisor=factor)

    @property
    def _unit(self) -> str:
        return "".join(f" {part}" for part in (self.unit, self.example) if part)

    def _fault(self, value: object) -> str:
        must_be = f"must be {self.allowed}"
        if isinstance(value, bool) or not isinstance(value, int if self.whole else int | float):
            return must_be
        if isinstance(value, float) and not isfinite(value):
            return f"not finite; {must_be}"
        # A wrong sign is not due to a wrong unit, so the question about the unit is omitted.
        positive = value > 0.0
        low = self.low if self.least is not None and positive == (self.least > 0.0) else ""
        bounds = (
            ("above", self.above, le, ""),
            ("at least", self.least, lt, low),
            ("at least", self.slip if positive else None, lt, ""),
            ("below", self.below, ge, self.high),
            ("at most", self.most, gt, self.high),
        )
        for word, limit, beyond, question in bounds:
            if limit is not None and beyond(value, limit):
                fault = f"must be {word} {limit:g}{self._unit}"
                return f"{fault}; {question}" if question else fault
        return "" if is_finite_number(value) else must_be


@dataclass(frozen=True)
class Text(Rule):
    """Rule for a text that matches the regular expression `pattern`.

    `allowed` describes the pattern in messages. If `among` is not "", the text is the name of an
    entry in the table `among` of the file.
    """

    written = (str,)
    many = "texts"
    pattern: str = r"[\s\S]{1,1000}"
    allowed: str = "a text of 1 to 1000 characters"
    among: str = ""

    @property
    def schema(self) -> dict[str, Any]:
        return {"type": "string", "pattern": f"^{self.pattern}$"}

    def faults(self, value: object, key: str) -> list[str]:
        sound = isinstance(value, str) and fullmatch(self.pattern, value)
        return [] if sound else [self.refused(value, key)]


@dataclass(frozen=True)
class OneOf(Rule):
    """Rule for a value that is one of several texts, integers or truth values."""

    written = (str,)
    values: Sequence[str | int]

    @property
    def allowed(self) -> str:
        return " or ".join(map(shown, self.values))

    @property
    def many(self) -> str:
        return self.allowed

    @property
    def schema(self) -> dict[str, Any]:
        return {"enum": list(self.values)}

    def faults(self, value: object, key: str) -> list[str]:
        # Types are compared, because True == 1 in Python.
        matches = (
            type(allowed_value) is type(value) and allowed_value == value
            for allowed_value in self.values
        )
        return [] if any(matches) else [self.refused(value, key)]


@dataclass(frozen=True)
class Several(Rule):
    """Rule for a list of values, each of which satisfies the rule `kind`.

    The list has exactly `count` values, or from `least` to `most` if `count` is None.
    """

    written = (list, tuple)
    kind: Rule
    count: int | None = None
    most: int = 1000
    least: int = 0

    @property
    def allowed(self) -> str:
        several = f"a list of {self.least} or more" if self.least else "a list of"
        return f"{self.count or several} {self.kind.many}"

    @property
    def many(self) -> str:
        return f"lists of {self.allowed}" if self.count else "entries"

    @property
    def schema(self) -> dict[str, Any]:
        fewest = self.count or self.least
        least = {"minItems": fewest} if fewest else {}
        return {"type": "array", "items": self.kind.schema, "maxItems": self.count or self.most} | (
            least
        )

    def faults(self, value: object, key: str) -> list[str]:
        if not isinstance(value, list) and isinstance(self.kind, TableRule):
            return [f"{key} = {shown(value)}: must be an array of tables, [[{key}]]"]
        if not isinstance(value, list) or self.count not in {None, len(value)}:
            return [self.refused(value, key)]
        if len(value) < self.least:
            return [self.refused(value, key)]
        if len(value) > self.most:
            return [too_many(key, len(value), self.most)]
        entries = enumerate(value, start=1)
        return [fault for i, entry in entries for fault in self.kind.faults(entry, f"{key}[{i}]")]

    def read(self, value: Any) -> tuple[Any, ...]:
        return tuple(map(self.kind.read, value))

    def within(self, value: Any, key: str) -> Iterator[tuple[str, Rule, Any]]:
        yield key, self, value
        for i, entry in enumerate(value, start=1):
            yield from self.kind.within(entry, f"{key}[{i}]")

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:
        return replace(self, kind=self.kind.in_unit(unit, moves))


@dataclass(frozen=True)
class Pose(Several):
    """Rule for the coordinates of a pose, given as a list.

    They are divided by `divisors`, one for each coordinate, to obtain m and rad.
    """

    divisors: tuple[float, ...] = ()

    def read(self, value: Any) -> tuple[Any, ...]:
        coordinates = super().read(value)
        if len(coordinates) != len(self.divisors):
            return coordinates
        return tuple(
            coordinate / divisor
            for coordinate, divisor in zip(coordinates, self.divisors, strict=True)
        )

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:
        divisors = tuple(unit.per_metre if move in LENGTHS else 1.0 for move in moves)
        return replace(super().in_unit(unit, moves), divisors=divisors)


@dataclass(frozen=True)
class Either(Rule):
    """Rule for a value that satisfies one of two rules, such as those for a text or for a list.

    The two rules must be for different TOML types.
    """

    first: Rule
    second: Rule

    @property
    def written(self) -> tuple[type, ...]:  # type: ignore[override]
        """Python types of the values that either of the two rules allows."""
        return self.first.written + self.second.written

    @property
    def allowed(self) -> str:
        return f"{self.first.allowed} or {self.second.allowed}"

    @property
    def schema(self) -> dict[str, Any]:
        return {"anyOf": [self.first.schema, self.second.schema]}

    def faults(self, value: object, key: str) -> list[str]:
        meant = self._meant(value)
        if meant is None:
            return [self.refused(value, key)]
        faults = meant.faults(value, key)
        # A text that is none of the choices may have been meant as the other type.
        return [self.refused(value, key)] if faults and isinstance(meant, OneOf) else faults

    def read(self, value: Any) -> Any:
        meant = self._meant(value)
        return value if meant is None else meant.read(value)

    def within(self, value: Any, key: str) -> Iterator[tuple[str, Rule, Any]]:
        if (meant := self._meant(value)) is not None:
            yield from meant.within(value, key)

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:
        first, second = (kind.in_unit(unit, moves) for kind in (self.first, self.second))
        return replace(self, first=first, second=second)

    def _meant(self, value: object) -> Rule | None:
        kinds = (self.first, self.second)
        fitting = (kind for kind in kinds if isinstance(value, kind.written))
        return None if isinstance(value, bool) else next(fitting, None)


@dataclass(frozen=True)
class Named(Rule):
    """Rule for a table of at most `most` named entries, such as [points] or [bodies].

    The author of the file chooses the names, which satisfy the rule `name`. Each entry satisfies
    the rule `kind`.
    """

    written = (dict,)
    allowed = "a table of named entries"
    name: Text
    kind: Rule
    most: int = 1000

    @property
    def schema(self) -> dict[str, Any]:
        return {
            "type": "object",
            "propertyNames": self.name.schema,
            "additionalProperties": self.kind.schema,
            "maxProperties": self.most,
        }

    def faults(self, value: object, key: str) -> list[str]:
        return self.checked(value, key)[0]

    def checked(self, value: object, key: str) -> tuple[list[str], dict[str, Any]]:
        """Faults of all entries, and the converted entries without faults, by name."""
        if not isinstance(value, dict):
            return [self.refused(value, key)], {}
        if len(value) > self.most:
            return [too_many(key, len(value), self.most)], {}
        faults, entries = [], {}
        for entry_name, entry in value.items():
            if self.name.faults(entry_name, ""):
                faults.append(f"{key}.{entry_name}: a name must be {self.name.allowed}")
            entry_faults, entry_read = self.kind.checked(entry, f"{key}.{entry_name}")
            faults += entry_faults
            if not entry_faults:
                entries[entry_name] = entry_read
        return faults, entries

    def read(self, value: Any) -> dict[str, Any]:
        return {name: self.kind.read(entry) for name, entry in value.items()}

    def within(self, value: Any, key: str) -> Iterator[tuple[str, Rule, Any]]:
        for name, entry in value.items():
            yield from self.name.within(name, f"{key}.{name}")
            yield from self.kind.within(entry, f"{key}.{name}")

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:
        return replace(self, kind=self.kind.in_unit(unit, moves))


@dataclass(frozen=True)
class Key:
    """A key of a table with the rule `kind` for its value, and its `meaning` as a help text.

    `default` is the value if the key is omitted. `owners` are the kinds of entries that can have
    the key, such as "leg". It is empty if all kinds can. `required` is True if the key must not be
    omitted.
    """

    name: str
    kind: Rule
    meaning: str
    default: Any = None
    owners: tuple[str, ...] = ()
    required: bool = False


def needed(name: str, kind: Rule, meaning: str) -> Key:
    """A key that must not be omitted from its table."""
    return Key(name, kind, meaning, required=True)


@dataclass(frozen=True)
class Value:
    """Annotation of a dataclass field that declares a key of a table.

    `kind`, `meaning` and `owners` are those of the `Key`.
    """

    kind: Rule
    meaning: str
    owners: tuple[str, ...] = ()


def field_of(name: str) -> str:
    """Name of the dataclass field that contains the value of the key `name`.

    It is the name of the key, followed by an underscore if it is a keyword of Python.
    """
    return f"{name}_" if iskeyword(name) else name


def table_of(entry: type) -> "TableRule":
    """Rule for a table that is read into the dataclass `entry`.

    Each field is annotated with a `Value` and declares a key. The key is required if the field has
    no default.
    """
    hints, keys = get_type_hints(entry, include_extras=True), []
    for field in fields(entry):
        (value,) = hints[field.name].__metadata__
        default = field.default if field.default_factory is MISSING else field.default_factory()
        required = default is MISSING
        name = field.name.removesuffix("_")
        keys.append(
            Key(
                name,
                value.kind,
                value.meaning,
                None if required else default,
                value.owners,
                required,
            )
        )
    return TableRule(entry, *keys)


class TableRule(Rule):
    """Rule for a table: its keys, and the rule for the value of each key.

    `record` is a function or class that makes a record of the values of all keys. It gets them as
    keyword arguments, whose names are those of the keys (see `field_of`).
    """

    allowed = "a table"
    many = "tables"

    def __init__(self, record: Callable[..., Any], *keys: Key) -> None:
        self.record = record
        self.keys = {key.name: key for key in keys}

    @property
    def written(self) -> tuple[type, ...]:  # type: ignore[override]
        """Python types of a table as parsed from TOML, and of the record made of it."""
        return (dict, self.record) if isinstance(self.record, type) else (dict,)

    @property
    def schema(self) -> dict[str, Any]:
        described = {
            name: key.kind.schema
            | {"description": key.meaning}
            | ({} if key.default is None else {"default": key.default})
            for name, key in self.keys.items()
        }
        required = [name for name, key in self.keys.items() if key.required]
        return {
            "type": "object",
            "properties": described,
            "required": required,
            "additionalProperties": False,
        }

    def faults(self, value: object, key: str) -> list[str]:
        if not isinstance(value, dict):
            return [self.refused(value, key)]
        return self.faults_within(value, f"{key}.")

    def faults_within(self, table: Mapping[str, object], path: str = "") -> list[str]:
        """Faults of the entries of a table. `path` (such as "leg1.") precedes each key."""
        return self.checked_within(table, path)[0]

    def checked_within(
        self, table: Mapping[str, object], path: str = ""
    ) -> tuple[list[str], dict[str, Any]]:
        """Faults of the entries of a table, and the converted values of its keys, by key.

        `path` precedes each key in messages. The value of a key with faults is None, except that a
        table of named entries contains all entries without faults. Keys that are omitted from the
        table are omitted from the result.
        """
        unknown = [name for name in table if name not in self.keys]
        faults = []
        for i, name in enumerate(unknown):
            known_keys = f"; known here: {', '.join(self.keys)}"
            advice = (
                did_you_mean(name, self.keys, otherwise=known_keys)
                if i < _LARGEST_SUGGESTION_COUNT
                else ""
            )
            faults.append(f"{path}{cut(name, _LONGEST_KEY)}: unknown key{advice}")
        values = {}
        for name, key in self.keys.items():
            if name in table:
                value_faults, values[name] = key.kind.checked(table[name], path + name)
                faults += value_faults
            elif key.required:
                faults.append(f"{path + name}: missing; must be {key.kind.allowed}")
        return faults, values

    def checked(self, value: object, key: str) -> tuple[list[str], Any]:
        if not isinstance(value, dict):
            return [self.refused(value, key)], None
        faults, values = self.checked_within(value, f"{key}.")
        return faults, None if faults else self.entry(values)

    def read(self, value: Any) -> Any:
        return self.entry(
            {name: key.kind.read(value[name]) for name, key in self.keys.items() if name in value}
        )

    def entry(self, values: Mapping[str, Any]) -> Any:
        """Record of a table from the converted values of its keys, or their defaults if omitted."""
        return self.record(
            **{field_of(name): values.get(name, key.default) for name, key in self.keys.items()}
        )

    def within(self, value: Any, key: str) -> Iterator[tuple[str, Rule, Any]]:
        for name, rule in self.keys.items():
            inner = value.get(name) if isinstance(value, dict) else getattr(value, field_of(name))
            if inner is not None:
                yield from rule.kind.within(inner, f"{key}.{name}" if key else name)

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:
        keys = (replace(key, kind=key.kind.in_unit(unit, moves)) for key in self.keys.values())
        return type(self)(self.record, *keys)
