"""What the keys of a leg must say together, and the leg that they describe.

A leg's table is as it is read, of either schema: a value for every key, None where left out.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, Leg, Material

# A leg of length L whose tip turns by c66 under 1 N m deflects by about c66 L²/3 under 1 N. With
# metres written as millimetres the ratio falls by 1e-6; a leg that shears or gives way at its root
# a thousand times more than it bends is none.
_SMALLEST_BENDING_SHARE = 1e-3


def leg_faults(
    table: Mapping[str, Any], length: float | None, key: str, material_key: str = ""
) -> list[str]:
    """Keys of a leg that contradict each other or leave it undescribed, each line with its key.

    `length` (m), None where it is not known. `material_key`: where the material stands if not in
    the leg's own table.
    """
    faults = [
        *_description_faults(table, key),
        *_mass_faults(table, key, material_key or f"{key}.material"),
    ]
    if length is not None:
        faults += [
            *_slenderness_faults(table, length, key),
            *_compliance_unit_faults(table, length, key),
        ]
    return faults


def leg_of(table: Mapping[str, Any], length: float, name: str) -> Leg:
    """The leg of a table without faults, its `length` in m."""
    section, given, mass = table["section"], table["material"], table["mass"]
    if table["compliance"] is not None:
        about = table["inertia"], table["mass_centre"]
        return GivenLeg(length, mass, table["compliance"], *about, name)
    density = given["rho"] if mass is None else mass / (section.area * length)
    if density is None:
        raise InputError("a leg of a section must have a mass or a density")
    material = Material.isotropic(given["E"], given["nu"], density)
    if given["G"] is not None:
        material = replace(material, G=given["G"])
    return ConstantLeg(length, section, material, table["ends"], name)


def _description_faults(table: Mapping[str, Any], key: str) -> Iterator[str]:
    given = [name for name in ("compliance", "section", "material") if table[name] is not None]
    if given not in (["compliance"], ["section", "material"]):
        said = f"has {' and '.join(given)}" if given else "neither compliance nor section"
        yield f"{key}: {said}; must have either compliance and mass, or section and material"
    elif table["ends"] is not None and given == ["compliance"]:
        yield (
            f"{key}.ends: must be left out beside {key}.compliance, whose ends are in its numbers"
        )


def _mass_faults(table: Mapping[str, Any], key: str, material_key: str) -> Iterator[str]:
    mass, material = table["mass"], table["material"]
    if mass == 0.0:
        yield f"{key}.mass = 0.0: must be above 0 kg for a leg"
    elif table["compliance"] is not None:
        if mass is None:
            yield f"{key}.mass: missing; must be given with {key}.compliance, a number above 0 kg"
    elif not isinstance(material, Mapping):
        return
    elif material["rho"] is not None and mass is not None:
        yield (
            f"{key}.mass and {material_key}.rho: both given; must be only one, the mass (kg) "
            "follows from the density (kg/m³)"
        )
    elif material["rho"] is None and mass is None:
        yield (
            f"{material_key}.rho: missing; must be a density in kg/m³, unless {key}.mass in kg "
            "is given"
        )


def _slenderness_faults(table: Mapping[str, Any], length: float, key: str) -> Iterator[str]:
    for name in ("width", "height", "diameter"):
        size = getattr(table["section"], name, 0.0)
        if size >= length:
            yield (
                f"{key}.section.{name} = {size!r}: must be below the leg's length, {length:g} m; "
                "is this in mm?"
            )


def _compliance_unit_faults(table: Mapping[str, Any], length: float, key: str) -> Iterator[str]:
    if table["compliance"] is None:
        return
    for along, about in ((2, 6), (3, 5)):
        deflection = float(table["compliance"][along - 1, along - 1])
        rotation = float(table["compliance"][about - 1, about - 1])
        if rotation * length**2 < _SMALLEST_BENDING_SHARE * deflection:
            yield (
                f"{key}.compliance[{along},{along}] = {deflection!r}: must be at most "
                f"{rotation * length**2 / _SMALLEST_BENDING_SHARE:.3g} m/N beside [{about},{about}]"
                f" = {rotation!r} rad/(N m) and a length of {length:g} m; "
                "is this in mm/N and rad/(N mm)?"
            )
