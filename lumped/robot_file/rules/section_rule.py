"""The `section` of a leg: from a shape's name and sizes to a section of lumped.sections."""

from dataclasses import dataclass, fields
from typing import Any

from lumped.robot_file.rules.rule import Number, OneOf, Rule, TableRule, needed
from lumped.sections import SHAPES, Section
from lumped.text import did_you_mean, shown

# 1 µm: thinner than any wall that carries a load.
_SIZE = Number("m", least=1e-6)


@dataclass(frozen=True)
class SectionRule(Rule):
    """A shape of lumped.sections with its sizes (m), which also says what is wrong with them."""

    written = (dict,)
    allowed = "a table with a shape and its sizes in m"

    @property
    def schema(self) -> dict[str, Any]:
        return {"oneOf": [_table(shape).schema for shape in SHAPES]}

    def faults(self, value: object, key: str) -> list[str]:
        if not isinstance(value, dict):
            return [self.refused(value, key)]
        shape, shapes = value.get("shape"), f"must be one of {', '.join(SHAPES)}"
        if shape is None:
            return [f"{key}.shape: missing; {shapes}"]
        if not isinstance(shape, str) or shape not in SHAPES:
            advice = did_you_mean(str(shape), SHAPES)
            return [f"{key}.shape = {shown(shape)}: {shapes}{advice}"]
        faults = _table(shape).faults(value, key)
        return faults or [f"{key}.{fault}" for fault in self.read(value).faults()]

    def read(self, value: Any) -> Section:
        sizes = {name: float(size) for name, size in value.items() if name != "shape"}
        return SHAPES[value["shape"]](**sizes)


def _table(shape: str) -> TableRule:
    """Rules of a shape with its sizes, in their usual order."""
    kind: Any = SHAPES[shape]
    sizes = (needed(field.name, _SIZE, "outer size or wall") for field in fields(kind))
    return TableRule(needed("shape", OneOf((shape,)), "which it is"), *sizes)
