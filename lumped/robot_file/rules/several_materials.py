"""Sections with their own materials, as described in a robot file, before they are built."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, TypeAlias

from lumped.sections import Composite, CompositePart, Laminate, LaminateBox, LaminateTube, Layer
from lumped.text import shown


@dataclass(frozen=True)
class CompositeTable:
    """Parts of a composite section, each with `section`, `at`, and `material`.

    A material is a table, or a name in [materials] that is not yet resolved.
    """

    parts: tuple[Mapping[str, Any], ...]

    def resolved(self, materials: Mapping[str, Any]) -> "CompositeTable":
        """Copy of the parts with tables in place of the names of their materials."""

        def with_table(part: Mapping[str, Any]) -> Mapping[str, Any]:
            material = part["material"]
            is_named = isinstance(material, str) and material in materials
            return {**part, "material": materials[material]} if is_named else part

        return replace(self, parts=tuple(map(with_table, self.parts)))

    def faults(self, unit: str = "m") -> list[str]:
        """Faults of the shapes and their positions, regardless of materials."""
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
                    f"{name} = {shown(material)}: must be the name of one of [materials], or a "
                    "table"
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
        """Composite section of the parts, whose materials must be tables without faults."""
        return Composite(tuple(map(_part, self.parts)))


def _part(part: Mapping[str, Any]) -> CompositePart:
    E, nu, rho = (float(part["material"][name]) for name in ("E", "nu", "rho"))
    return CompositePart(part["section"], E, nu, rho, part["at"])


@dataclass(frozen=True)
class LaminateTable:
    """Wall of a laminate tube or box.

    `layers` (from the inside) are angles, or tables with an `angle` and keys that replace those of
    `ply`.
    """

    shape: type[LaminateTube] | type[LaminateBox]
    ply: Mapping[str, Any]
    layers: tuple[Any, ...]
    sizes: Mapping[str, float]

    def resolved(self, materials: Mapping[str, Any]) -> "LaminateTable":  # noqa: ARG002
        """The wall itself, unchanged, because it contains no names of materials."""
        return self

    def faults(self, unit: str = "m") -> list[str]:
        """Faults of the layers and of the shape."""
        missing = [
            f"layers[{number}].{name}: missing; must be given there or in ply"
            for number, layer in enumerate(self._layers, start=1)
            for name, value in layer.items()
            if value is None
        ]
        return missing[:1] or self.section.faults(unit)

    def material_faults(self, key: str) -> Iterator[str]:  # noqa: ARG002
        """Empty: faults of layers are among those of the section."""
        yield from ()

    @property
    def _layers(self) -> list[dict[str, Any]]:
        """Value of each key of each layer. None if neither the layer nor `ply` defines the key."""
        tables = [x if isinstance(x, Mapping) else {"angle": x} for x in self.layers]
        names = [field.name for field in fields(Layer)]
        return [
            {name: self.ply.get(name) if table.get(name) is None else table[name] for name in names}
            for table in tables
        ]

    @property
    def section(self) -> Laminate:
        """Laminate section of the wall, whose layers must have all keys."""
        return self.shape(tuple(Layer(**layer) for layer in self._layers), **self.sizes)


OwnMaterials: TypeAlias = CompositeTable | LaminateTable
