"""The `section` of a leg: from a shape's name and sizes to a section of lumped.sections."""

from dataclasses import dataclass, fields
from typing import Any

from lumped.robot_file.rules.rule import Number, OneOf, Rule, TableRule, is_finite_number, needed
from lumped.sections import SHAPES, Section
from lumped.text import cut, did_you_mean, shown

# 1 µm: thinner than any wall that carries a load.
_SMALLEST_SIZE = 1e-6


@dataclass(frozen=True)
class SectionRule(Rule):
    """A shape of lumped.sections with its sizes (m), which also says what is wrong with them."""

    written = (dict,)

    @property
    def allowed(self) -> str:
        return "a table with a shape and its sizes in m"

    @property
    def schema(self) -> dict[str, Any]:
        size = Number("m", least=_SMALLEST_SIZE)
        tables = (
            TableRule(
                needed("shape", OneOf((shape,)), "which it is"),
                *(needed(name, size, "outer size or wall") for name in _size_names(shape)),
            )
            for shape in SHAPES
        )
        return {"oneOf": [table.schema for table in tables]}

    def faults(self, value: object, key: str) -> list[str]:
        if not isinstance(value, dict):
            return [self.refused(value, key)]
        shapes = ", ".join(SHAPES)
        if "shape" not in value:
            return [f"{key}.shape: missing; must be one of {shapes}"]
        shape = value["shape"]
        if not isinstance(shape, str) or shape not in SHAPES:
            advice = did_you_mean(str(shape), SHAPES)
            return [f"{key}.shape = {shown(shape)}: must be one of {shapes}{advice}"]
        sizes = _size_names(shape)
        faults = [
            f"{key}.{cut(name, 40)}: unknown key of a {shape}; its sizes are {', '.join(sizes)}"
            for name in value
            if name != "shape" and name not in sizes
        ]
        for name in sizes:
            size, own = value.get(name), f"{key}.{name}"
            if name not in value:
                faults.append(f"{own}: missing; a {shape} needs it, in m")
            elif not is_finite_number(size):
                faults.append(f"{own} = {shown(size)}: must be a finite number above 0 m")
            elif 0.0 < size < _SMALLEST_SIZE:
                faults.append(f"{own} = {size!r}: must be at least {_SMALLEST_SIZE:g} m")
        return faults or [f"{key}.{fault}" for fault in self.read(value).faults()]

    def read(self, value: Any) -> Section:
        shape = value["shape"]
        return SHAPES[shape](**{name: float(value[name]) for name in _size_names(shape)})


def _size_names(shape: str) -> tuple[str, ...]:
    """Keys of a shape's sizes, in their usual order."""
    kind: Any = SHAPES[shape]
    return tuple(field.name for field in fields(kind))
