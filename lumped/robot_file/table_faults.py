"""Every fault of a robot file's tables, one line each: key, value, unit, what is allowed."""

import math
import types
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import msgspec
from msgspec import Meta

from lumped.robot_file.matrix_faults import matrix_faults
from lumped.robot_file.section_table import section_faults
from lumped.robot_file.tables import Bounds, SquareMatrix, Table
from lumped.text import cut, did_you_mean, shown

# Further unknown keys of one table are only named: to look for what was meant takes its time.
_ADVISED = 50
_LONGEST_KEY = 40


def unknown_key(path: str, key: str, known: Iterable[str]) -> str:
    """The fault of a key that means nothing, with the closest one that does."""
    names = tuple(known)
    advice = did_you_mean(key, names, otherwise=f"; known here: {', '.join(names)}")
    return f"{path}{cut(key, _LONGEST_KEY)}: unknown key{advice}"


def table_faults(kind: type[Table], table: Mapping[str, object], path: str = "") -> list[str]:
    """Faults of `table` against the fields of `kind`; `path` ("leg1.") goes before each key."""
    hints = get_type_hints(kind, include_extras=True)
    # A key may be a word that Python keeps for itself ("from"); the field is then named otherwise.
    fields = {field.encode_name: field for field in msgspec.structs.fields(kind)}
    unknown = [key for key in table if key not in fields]
    faults = [unknown_key(path, key, fields) for key in unknown[:_ADVISED]]
    faults += [f"{path}{cut(key, _LONGEST_KEY)}: unknown key" for key in unknown[_ADVISED:]]
    for key, field in fields.items():
        hint = _without_none(hints[field.name])
        if key in table:
            faults += value_faults(hint, table[key], path + key)
        elif field.required:
            faults.append(f"{path + key}: missing; must be {_described(hint)}")
    return faults


def _without_none(hint: Any) -> Any:
    kinds = tuple(kind for kind in _alternatives(hint) if kind is not type(None))
    return Union[kinds]  # noqa: UP007  made of as many kinds as are left


def _alternatives(hint: Any) -> tuple[Any, ...]:
    return get_args(hint) if get_origin(hint) in {Union, types.UnionType} else (hint,)


def _meta(hint: Any) -> Meta:
    return get_args(hint)[1] if get_origin(hint) is Annotated else Meta()


def _extra(hint: Any) -> Mapping[str, Any]:
    return _meta(hint).extra or {}


def _is_table(hint: Any) -> bool:
    return isinstance(hint, type) and issubclass(hint, Table)


def _is_number(hint: Any) -> bool:
    return _bare(hint) in {float, int}


def _bare(hint: Any) -> Any:
    return get_args(hint)[0] if get_origin(hint) is Annotated else hint


def value_faults(hint: Any, value: object, key: str) -> list[str]:  # noqa: PLR0911
    """Faults of a `value` against a field's type, each line starting with `key`."""
    extra = _extra(hint)
    if len(_alternatives(hint)) > 1:
        return _one_of_faults(hint, value, key)
    if _is_table(hint):
        if not isinstance(value, dict):
            return [f"{key} = {shown(value)}: must be a table"]
        return table_faults(hint, value, f"{key}.")
    if "matrix" in extra:
        return [f"{key}{fault}" for fault in matrix_faults(value, extra["matrix"])]
    if "section" in extra:
        return section_faults(value, key)
    if get_origin(hint) is tuple:
        return _tuple_faults(hint, value, key)
    if get_origin(hint) is dict:
        return _named_faults(hint, value, key)
    if get_origin(hint) is list:
        return _list_faults(hint, value, key)
    fault = _leaf_fault(hint, value)
    return [f"{key} = {shown(value)}: {fault}"] if fault else []


def _tuple_faults(hint: Any, value: object, key: str) -> list[str]:
    entries = get_args(hint)
    if not isinstance(value, list) or len(value) != len(entries):
        return [f"{key} = {shown(value)}: must be {_described(hint)}"]
    faults = ((i, _leaf_fault(entries[i], entry)) for i, entry in enumerate(value))
    return [f"{key}[{i + 1}] = {shown(value[i])}: {fault}" for i, fault in faults if fault]


def _list_faults(hint: Any, value: object, key: str) -> list[str]:
    (kind,) = get_args(hint)
    if not isinstance(value, list):
        wanted = f"an array of tables, [[{key}]]" if _is_table(kind) else _described(hint)
        return [f"{key} = {shown(value)}: must be {wanted}"]
    entries = enumerate(value, start=1)
    return [fault for i, entry in entries for fault in value_faults(kind, entry, f"{key}[{i}]")]


def _named_faults(hint: Any, value: object, key: str) -> list[str]:
    name, kind = get_args(hint)
    if not isinstance(value, dict):
        return [f"{key} = {shown(value)}: must be {_described(hint)}"]
    faults = []
    for one, entry in value.items():
        if _leaf_fault(name, one):
            faults.append(f"{key}.{one}: a name must be {_described(name)}")
        faults += value_faults(kind, entry, f"{key}.{one}")
    return faults


def _one_of_faults(hint: Any, value: object, key: str) -> list[str]:
    """Faults of the alternative that the value resembles: text, list, table or number."""
    for kind in _alternatives(hint):
        if isinstance(value, _written_as(kind)) and not isinstance(value, bool):
            return value_faults(kind, value, key)
    return [f"{key} = {shown(value)}: must be {_described(hint)}"]


def _written_as(hint: Any) -> type | tuple[type, ...]:
    """What a TOML value of this kind is read as."""
    bare = _bare(hint)
    if get_origin(bare) in {tuple, list}:
        return list
    if get_origin(bare) is Literal or bare is str:
        return str
    return (int, float) if bare is float else dict


def _leaf_fault(hint: Any, value: object) -> str | None:
    """Why `value` is not what `hint` allows; None if it is."""
    if isinstance(value, float) and not math.isfinite(value):
        return f"not finite; must be {_described(hint)}"
    try:
        msgspec.convert(value, hint)
    except (msgspec.ValidationError, OverflowError):
        number = isinstance(value, int | float) and not isinstance(value, bool)
        return (_bound_fault(hint, value) if number else None) or f"must be {_described(hint)}"
    return _bound_fault(hint, value) if "bounds" in _extra(hint) else None


def _bound_fault(hint: Any, value: Any) -> str | None:
    meta, bounds = _meta(hint), _extra(hint).get("bounds", Bounds(""))
    unit = _unit(hint)
    low = (meta.gt is not None and value <= meta.gt) or (meta.ge is not None and value < meta.ge)
    high = (meta.lt is not None and value >= meta.lt) or (meta.le is not None and value > meta.le)
    if not low and 0.0 < value < bounds.least:
        return f"must be at least {bounds.least:g}{unit}"
    if low:
        limit = f"above {meta.gt:g}" if meta.gt is not None else f"at least {meta.ge:g}"
        # A negative modulus is no question of units.
        same_side = meta.ge is not None and (value > 0.0) == (meta.ge > 0.0)
        return _asked(f"must be {limit}{unit}", bounds.too_low if same_side else "")
    if high:
        limit = f"below {meta.lt:g}" if meta.lt is not None else f"at most {meta.le:g}"
        return _asked(f"must be {limit}{unit}", bounds.too_high)
    return None


def _asked(fault: str, question: str) -> str:
    return f"{fault}; {question}" if question else fault


def _unit(hint: Any) -> str:
    bounds = _extra(hint).get("bounds")
    return f" {bounds.unit}" if bounds and bounds.unit else ""


def _described(hint: Any) -> str:  # noqa: PLR0911
    """What a value may be, for "must be …"."""
    extra, meta = _extra(hint), _meta(hint)
    if "matrix" in extra:
        return described_matrix(extra["matrix"])
    if "section" in extra:
        return "a table with a shape and its sizes"
    if "allowed" in extra:
        return str(extra["allowed"])
    if _is_table(hint):
        return "a table"
    if get_origin(hint) is Literal:
        return " or ".join(shown(value) for value in get_args(hint))
    if len(_alternatives(hint)) > 1:
        return " or ".join(_described(kind) for kind in _alternatives(hint))
    if get_origin(hint) is tuple:
        first, count = get_args(hint)[0], len(get_args(hint))
        return f"{count} numbers{_unit(first)}" if _is_number(first) else f"{count} texts"
    if get_origin(hint) is list:
        kind = get_args(hint)[0]
        return f"a list of {'numbers' if _is_number(kind) else 'entries'}{_unit(kind)}"
    if get_origin(hint) is dict:
        return "a table of named entries"
    if hint is bool:
        return "true or false"
    unit = _unit(hint)
    if meta.ge is not None and meta.le is not None:
        return f"a number from {meta.ge:g} to {meta.le:g}{unit}"
    limits = [
        f"{word} {limit:g}{unit}"
        for word, limit in (
            ("above", meta.gt),
            ("below", meta.lt),
            ("at most", meta.le),
        )
        if limit is not None
    ]
    return " ".join(["a number", " and ".join(limits)]).strip()


def described_matrix(matrix: SquareMatrix) -> str:
    """What a matrix may be, for "must be …"."""
    return f"a symmetric {matrix.size}×{matrix.size} matrix in {matrix.unit}"
