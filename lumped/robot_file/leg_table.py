"""The [leg1] and [leg2] tables: what their keys must say together, and the leg they describe."""

from dataclasses import replace
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, Leg, Material
from lumped.robot_file.matrix_faults import is_finite_number, matrix_faults
from lumped.robot_file.section_table import section_faults, section_of
from lumped.robot_file.tables import LegTable, SquareMatrix

# A leg of length L whose tip turns by c66 under 1 N m deflects by about c66 L²/3 under 1 N. With
# metres written as millimetres the ratio falls by 1e-6; a leg that shears or gives way at its root
# a thousand times more than it bends is none.
_SMALLEST_BENDING_SHARE = 1e-3


def leg_faults(table: object, key: str, material_key: str = "") -> list[str]:
    """Keys of a leg that contradict each other or leave it undescribed, each line with its key.

    Silent about whatever is wrong with one key alone. `material_key`: where the material stands
    if not in the leg's own table.
    """
    if not isinstance(table, dict):
        return []
    faults = _description_faults(table, key)
    faults += _mass_faults(table, key, material_key or f"{key}.material")
    length = table.get("length")
    if is_finite_number(length) and 0.0 < length <= 100.0:
        faults += _slenderness_faults(table, float(length), key)
        faults += _compliance_unit_faults(table, float(length), key)
    return faults


def leg_of(table: LegTable, name: str) -> Leg:
    """The leg of a table without faults; its compliance is made exactly symmetric."""
    if table.compliance is not None and table.mass is not None:
        return GivenLeg(
            length=table.length,
            mass=table.mass,
            compliance=symmetric(table.compliance),
            inertia=None if table.inertia is None else symmetric(table.inertia),
            mass_centre=table.mass_centre,
            name=name,
        )
    if table.section is None or table.material is None:
        raise InputError("a leg must have either compliance and mass, or section and material")
    section, given = section_of(table.section), table.material
    isotropic = Material.isotropic(given.E, given.nu, rho=1.0)
    density = given.rho if table.mass is None else table.mass / (section.area * table.length)
    if density is None:
        raise InputError("a leg of a section must have a mass or a density")
    shear_modulus = isotropic.G if given.G is None else given.G
    material = replace(isotropic, G=shear_modulus, rho=density)
    return ConstantLeg(table.length, section, material, table.ends, name)


def symmetric(rows: list[list[float]]) -> Array:
    """The matrix with what rounding left of asymmetry averaged away."""
    matrix: Array = np.array(rows, dtype=float)
    mean: Array = 0.5 * (matrix + matrix.T)
    return mean


def _description_faults(table: dict[str, Any], key: str) -> list[str]:
    by_section = [name for name in ("section", "material") if name in table]
    if "compliance" in table and "ends" in table and not by_section:
        return [
            f"{key}.ends: must be left out beside {key}.compliance, whose ends are in its numbers"
        ]
    if "compliance" in table and by_section:
        return [
            (
                f"{key}.compliance and {key}.{by_section[0]}: both given; must be either "
                "compliance and mass, or section and material"
            )
        ]
    if "compliance" in table or len(by_section) == 2:
        return []
    if not by_section:
        return [
            (
                f"{key}: neither compliance nor section; must have either compliance and mass, "
                "or section and material"
            )
        ]
    (given,) = by_section
    missing = "material" if given == "section" else "section"
    return [f"{key}.{missing}: missing; must be given with {key}.{given}"]


def _mass_faults(table: dict[str, Any], key: str, material_key: str) -> list[str]:
    material = table.get("material")
    if "compliance" in table:
        if "mass" in table:
            return []
        return [f"{key}.mass: missing; must be given with {key}.compliance, a number above 0 kg"]
    if not isinstance(material, dict):
        return []
    if "rho" in material and "mass" in table:
        return [
            (
                f"{key}.mass and {material_key}.rho: both given; must be only one, the mass (kg) "
                "follows from the density (kg/m³)"
            )
        ]
    if "rho" not in material and "mass" not in table:
        return [
            (
                f"{material_key}.rho: missing; must be a density in kg/m³, unless {key}.mass in kg "
                "is given"
            )
        ]
    return []


def _slenderness_faults(table: dict[str, Any], length: float, key: str) -> list[str]:
    section = table.get("section")
    if section is None or section_faults(section, key):
        return []
    names = ("width", "height", "diameter")
    sizes = {name: section[name] for name in names if name in section}
    return [
        f"{key}.section.{name} = {size!r}: must be below the leg's length, {length:g} m; "
        "is this in mm?"
        for name, size in sizes.items()
        if size >= length
    ]


def _compliance_unit_faults(table: dict[str, Any], length: float, key: str) -> list[str]:
    compliance = table.get("compliance")
    kind = SquareMatrix(6, "", compliance=True)
    if compliance is None or matrix_faults(compliance, kind):
        return []
    faults = []
    for along, about in ((2, 6), (3, 5)):
        deflection = float(compliance[along - 1][along - 1])
        rotation = float(compliance[about - 1][about - 1])
        if rotation * length**2 < _SMALLEST_BENDING_SHARE * deflection:
            faults.append(
                f"{key}.compliance[{along},{along}] = {deflection!r}: must be at most "
                f"{rotation * length**2 / _SMALLEST_BENDING_SHARE:.3g} m/N beside [{about},{about}]"
                f" = {rotation!r} rad/(N m) and a length of {length:g} m; "
                "is this in mm/N and rad/(N mm)?"
            )
    return faults
