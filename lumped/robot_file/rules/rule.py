"""What a value of a robot file may be: its faults, how it is read, and how it is told to others."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from operator import ge, gt, le, lt
from re import fullmatch
from typing import Any, ClassVar, Self, TypeGuard

from lumped.mechanism.length_unit import COORDINATES, METRE, POWERS, UnitOfLength
from lumped.mechanism.mechanism import LENGTHS
from lumped.text import cut, did_you_mean, shown

# Further unknown keys of one table are only named: to look for what was meant takes its time.
_ADVISED = 50
_LONGEST_KEY = 40


def is_finite_number(entry: object) -> TypeGuard[float]:
    """Whether a value of a TOML file is a number that a float can hold; true and false are not."""
    if isinstance(entry, bool) or not isinstance(entry, int | float):
        return False
    try:
        return isfinite(entry)
    except OverflowError:
        return False


def too_many(key: str, count: int, most: int) -> str:
    """The fault of a list or table that is longer than any robot's."""
    return f"{key}: {count} entries; must be at most {most}"


class Rule(ABC):
    """What a value may be. `written`: what TOML reads such a value as."""

    written: ClassVar[tuple[type, ...]] = ()

    @property
    def many(self) -> str:
        """Several such values, for "must be a list of …"."""
        return "entries"

    @property
    @abstractmethod
    def allowed(self) -> str:
        """What the value may be, for "must be …"."""

    @property
    @abstractmethod
    def schema(self) -> dict[str, Any]:
        """The same as a JSON schema."""

    def faults(self, value: object, key: str) -> list[str]:
        """Faults of a value, each line starting with its key; empty if it is sound."""
        return [] if isinstance(value, self.written) else [self.refused(value, key)]

    def read(self, value: Any) -> Any:
        """A sound value as it is computed with."""
        return value

    def within(self, value: Any, key: str) -> Iterator[tuple[str, "Rule", Any]]:
        """A sound value, or one as it is read, and all that stands in it: key, rule and value."""
        yield key, self, value

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:  # noqa: ARG002
        """The rule for a file with lengths in `unit` whose poses are of such `moves`.

        Values are read in metres.
        """
        return self

    def refused(self, value: object, key: str) -> str:
        """The fault of a value that is something else."""
        return f"{key} = {shown(value)}: must be {self.allowed}"


@dataclass(frozen=True)
class Number(Rule):
    """A number in `unit`: `above` or at `least`, `below` or at `most`.

    `low` and `high` ask whose number is out of bounds; above 0 but below `slip` is a slip of the
    exponent. `example` stands behind the unit. A value is divided by `divisor` when it is read.
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
        told = [f"{word} {x:g}{self._unit}" for word, x in limits.items() if x is not None]
        return f"{kind} {' and '.join(told)}".strip()

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
        # Questions after a millimetre are for files in metres.
        own = replace(self, unit=self.unit.replace("m", unit.name), low="", high="", **scaled)
        return own if self.unit == COORDINATES else replace(own, divisor=factor)

    @property
    def _unit(self) -> str:
        return "".join(f" {part}" for part in (self.unit, self.example) if part)

    def _fault(self, value: object) -> str:
        must_be = f"must be {self.allowed}"
        if isinstance(value, bool) or not isinstance(value, int if self.whole else int | float):
            return must_be
        if isinstance(value, float) and not isfinite(value):
            return f"not finite; {must_be}"
        # A negative modulus is no question of units.
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
    """A text that matches `pattern`, in words what is `allowed`.

    `among`: the table of the file, one of whose names it must be.
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
    """One of several texts, or of several numbers."""

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
        # True is 1 to Python.
        same = (type(one) is type(value) and one == value for one in self.values)
        return [] if any(same) else [self.refused(value, key)]


@dataclass(frozen=True)
class Several(Rule):
    """A list of values of one kind: `count` of them, or at `most` so many."""

    written = (list, tuple)
    kind: Rule
    count: int | None = None
    most: int = 1000

    @property
    def allowed(self) -> str:
        return f"{self.count or 'a list of'} {self.kind.many}"

    @property
    def many(self) -> str:
        return f"lists of {self.allowed}" if self.count else "entries"

    @property
    def schema(self) -> dict[str, Any]:
        least = {} if self.count is None else {"minItems": self.count}
        return {"type": "array", "items": self.kind.schema, "maxItems": self.count or self.most} | (
            least
        )

    def faults(self, value: object, key: str) -> list[str]:
        if not isinstance(value, list) and isinstance(self.kind, TableRule):
            return [f"{key} = {shown(value)}: must be an array of tables, [[{key}]]"]
        if not isinstance(value, list) or self.count not in {None, len(value)}:
            return [self.refused(value, key)]
        if len(value) > self.most:
            return [too_many(key, len(value), self.most)]
        entries = enumerate(value, start=1)
        return [fault for i, entry in entries for fault in self.kind.faults(entry, f"{key}[{i}]")]

    def read(self, value: Any) -> tuple[Any, ...]:
        return tuple(map(self.kind.read, value))

    def within(self, value: Any, key: str) -> Iterator[tuple[str, Rule, Any]]:
        yield key, self, value
        for i, one in enumerate(value, start=1):
            yield from self.kind.within(one, f"{key}[{i}]")

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:
        return replace(self, kind=self.kind.in_unit(unit, moves))


@dataclass(frozen=True)
class Pose(Several):
    """The coordinates of a pose, read as m and rad: each is divided by its one of `divisors`."""

    divisors: tuple[float, ...] = ()

    def read(self, value: Any) -> tuple[Any, ...]:
        found = super().read(value)
        if len(found) != len(self.divisors):
            return found
        return tuple(one / divisor for one, divisor in zip(found, self.divisors, strict=True))

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:
        divisors = tuple(unit.per_metre if move in LENGTHS else 1.0 for move in moves)
        return replace(super().in_unit(unit, moves), divisors=divisors)


@dataclass(frozen=True)
class Either(Rule):
    """A value of one of two kinds that are written differently: a text or a list, say."""

    first: Rule
    second: Rule

    @property
    def allowed(self) -> str:
        return f"{self.first.allowed} or {self.second.allowed}"

    @property
    def schema(self) -> dict[str, Any]:
        return {"anyOf": [self.first.schema, self.second.schema]}

    def faults(self, value: object, key: str) -> list[str]:
        meant = self._meant(value)
        return [self.refused(value, key)] if meant is None else meant.faults(value, key)

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
    """A table of at `most` so many entries of one kind, their names chosen by the author."""

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
        if not isinstance(value, dict):
            return [self.refused(value, key)]
        if len(value) > self.most:
            return [too_many(key, len(value), self.most)]
        faults = []
        for one, entry in value.items():
            if self.name.faults(one, ""):
                faults.append(f"{key}.{one}: a name must be {self.name.allowed}")
            faults += self.kind.faults(entry, f"{key}.{one}")
        return faults

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
    """A key of a table: what it may be, what it `says`, and its value where it is left out.

    `of`: which entries have it, where not all do.
    """

    name: str
    kind: Rule
    says: str
    default: Any = None
    of: tuple[str, ...] = ()
    required: bool = False


def needed(name: str, kind: Rule, says: str) -> Key:
    """A key that must not be left out."""
    return Key(name, kind, says, required=True)


class TableRule(Rule):
    """A table with the keys that it may have."""

    written = (dict,)
    allowed = "a table"
    many = "tables"

    def __init__(self, *keys: Key) -> None:
        self.keys = {key.name: key for key in keys}

    @property
    def schema(self) -> dict[str, Any]:
        described = {
            name: key.kind.schema
            | {"description": key.says}
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
        """Faults of what stands in a table; `path` ("leg1.") goes before each key."""
        unknown = [name for name in table if name not in self.keys]
        faults = []
        for i, name in enumerate(unknown):
            known = f"; known here: {', '.join(self.keys)}"
            advice = did_you_mean(name, self.keys, otherwise=known) if i < _ADVISED else ""
            faults.append(f"{path}{cut(name, _LONGEST_KEY)}: unknown key{advice}")
        for name, key in self.keys.items():
            if name in table:
                faults += key.kind.faults(table[name], path + name)
            elif key.required:
                faults.append(f"{path + name}: missing; must be {key.kind.allowed}")
        return faults

    def read(self, value: Any) -> dict[str, Any]:
        return {
            name: key.kind.read(value[name]) if name in value else key.default
            for name, key in self.keys.items()
        }

    def within(self, value: Any, key: str) -> Iterator[tuple[str, Rule, Any]]:
        for name, one in self.keys.items():
            if value.get(name) is not None:
                yield from one.kind.within(value[name], f"{key}.{name}" if key else name)

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:
        keys = (replace(key, kind=key.kind.in_unit(unit, moves)) for key in self.keys.values())
        return type(self)(*keys)
