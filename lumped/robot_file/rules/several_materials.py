"""Sections of several materials as a robot file describes them, before they are built."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from lumped.sections import Composite, CompositePart
from lumped.text import shown


@dataclass(frozen=True)
class CompositeTable:
    """Parts of a composite section, each with `section`, `at`, and `material`.

    A material is a table, or a name in [materials] that is not yet resolved.
    """

    parts: tuple[Mapping[str, Any], ...]

    def resolved(self, materials: Mapping[str, Any]) -> "CompositeTable":
        """The same parts with the tables of the materials that they name."""

        def with_table(part: Mapping[str, Any]) -> Mapping[str, Any]:
            material = part["material"]
            named = isinstance(material, str) and material in materials
            return {**part, "material": materials[material]} if named else part

        return replace(self, parts=tuple(map(with_table, self.parts)))

    def faults(self, unit: str = "m") -> list[str]:
        """Faults of the shapes and their places, whatever their materials."""
        parts = tuple(
            CompositePart(part["section"], E=1.0, nu=0.0, rho=1.0, at=part["at"])
            for part in self.parts
        )
        return Composite(parts).faults(unit)

    def material_faults(self, key: str) -> Iterator[str]:
        """Faults of the materials of the section at `key`."""
        for number, part in enumerate(self.parts, start=1):
            name, material = f"{key}.parts[{number}].material", part["material"]
            if isinstance(material, str):
                yield (
                    f"{name} = {shown(material)}: must be the name of one of [materials], or a table"
                )
                continue
            if material["rho"] is None:
                yield f"{name}.rho: missing; the mass of the leg follows from the densities"
            if material["G"] is not None:
                yield f"{name}.G: does not belong to a composite; its materials are isotropic"
            if material["loss"]:
                yield f"{name}.loss: does not belong to a composite; give the loss of the leg"

    @property
    def section(self) -> Composite:
        """The section. Its materials are tables without faults."""
        return Composite(tuple(map(_part, self.parts)))


def _part(part: Mapping[str, Any]) -> CompositePart:
    E, nu, rho = (float(part["material"][name]) for name in ("E", "nu", "rho"))
    return CompositePart(part["section"], E, nu, rho, part["at"])
