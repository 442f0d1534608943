"""Natural frequencies of a part without supports, with their uncertainty.

Input: a part file, a material and the number of unknowns. Output: `FreePart`, with the elastic
frequencies on the finest of three meshes. Rule: the six rigid-body motions are omitted. Half-widths
are those due to the meshes; there are no interfaces that could add to them.
"""

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.bodies.part import free_part, meshed_part, require_memory
from fem.reduction.free_modes import free_modes
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import Material
from lumped.models.bodies import RIGID_MOTIONS
from meshes.part.reading.read import PartFile
from validation.parts.meshes import FINEST, LEVELS, mesh_entries, part_key, part_mesh
from validation.parts.refinement import refinement_uncertainty
from validation.run.cache import CacheEntry, require_shape
from validation.tables import ResultTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class FreePart:
    """Part without supports: mass and elastic frequencies, with uncertainties (SI, file axes).

    `density` (kg/m³) of the material; `total` mass (kg), `centre` of mass (3, m) and `inertia`
    about it (3×3, kg m²) of the finest mesh. `frequencies` (Hz): elastic modes; `rigid`: number of
    rigid-body motions below them. `frequency_refinement` (Hz): half-widths due to the mesh, NaN if
    the file of the part is a mesh. `counted`: number of elastic modes below `counted_below` (Hz),
    by Sylvester's law of inertia; it proves that no mode is missing. `unknowns`: number of unknowns
    of each mesh, from coarse to fine. `elements`: number of elements of the finest mesh.
    `straightened`: number of those whose edges were made straight, because they were folded.

    Examples
    --------
    >>> part = identify_free(
    ...     "examples/tapered-biglide/leg1.step",
    ...     material={"E": 2.1e11, "nu": 0.3, "rho": 7850.0},
    ...     unknowns=5000,
    ...     modes=1,
    ... )
    >>> part.rigid
    6
    """

    part: PartFile
    density: float
    total: float
    centre: Array
    inertia: Array
    frequencies: Array
    frequency_refinement: Array
    counted: int
    counted_below: float
    unknowns: tuple[int, ...]
    elements: int
    straightened: int
    rigid: int = RIGID_MOTIONS

    def table(self) -> ResultTable:
        """Table of frequencies with their half-widths, one row each.

        Returns
        -------
        ResultTable
            Frequencies (Hz), and their half-widths due to meshes in per cent.

        Examples
        --------
        >>> len(part.table().rows)
        1
        """
        shares = 100.0 * self.frequency_refinement / self.frequencies
        rows = zip(self.frequencies.tolist(), shares.tolist(), strict=True)
        return ResultTable(
            ("quantity", "unit", "value", "± meshes (%)"),
            tuple((f"f{mode}", "Hz", *row) for mode, row in enumerate(rows, start=1)),
        )

    def plot(self) -> "Figure":
        """Bars of the frequencies with half-widths due to the mesh.

        Returns
        -------
        matplotlib.figure.Figure
            A bar for each frequency.

        Examples
        --------
        >>> part.plot().savefig("part.png")
        """
        # Only a plot needs matplotlib, which is slow to import.
        from validation.parts.identified_plot import free_plot  # noqa: PLC0415

        return free_plot(self.frequencies, np.nan_to_num(self.frequency_refinement))

    def __repr__(self) -> str:
        return f"FreePart({self.total:.4g} kg, {len(self.frequencies)} frequencies)"

    def _repr_html_(self) -> str:
        return self.table().html()


def free_entry(
    part: PartFile, material: Material, unknowns: int, modes: int
) -> CacheEntry[FreePart]:
    """Cache entry for a `FreePart`. Its computation raises the exceptions of `identify_free`."""
    key = part_key(part, (), material, "free", unknowns, modes)

    def read(arrays: dict[str, Array]) -> FreePart:
        require_shape(arrays, frequencies=(None,), frequency_refinement=(None,), inertia=(3, 3))
        return FreePart(part=part, **stored_values(FreePart, arrays))

    needs = mesh_entries(part, (), unknowns, LEVELS)
    return CacheEntry(key, lambda: _free_modes(part, material, unknowns, modes), read, needs)


def stored_values(record: type, arrays: dict[str, Array]) -> dict[str, Any]:
    """Values of the fields of a `record` that are stored as `arrays`, by name of the field."""
    names = [entry.name for entry in fields(record) if entry.name in arrays]
    # numpy stores scalars as arrays without axes.
    values = {name: arrays[name] if arrays[name].ndim else arrays[name].item() for name in names}
    return values | {"unknowns": tuple(int(count) for count in arrays["unknowns"])}


def _free_modes(part: PartFile, material: Material, unknowns: int, modes: int) -> dict[str, Any]:
    """Values of all fields of `FreePart` except for `part`, by name of the field."""
    if modes < 1:
        raise InputError(
            "--modes 0: a part without supports has no results but frequencies; must be 1 or more"
        )
    name, is_mesh = part.path.name, part.mesh is not None
    if not is_mesh:
        require_memory(unknowns, name)
    frequencies, counts = [], []
    for level in (FINEST,) if is_mesh else LEVELS:
        mesh = part_mesh(part, (), unknowns, level)
        meshed = meshed_part(name, mesh, material)
        certified = free_modes(free_part(meshed), modes)
        frequencies.append(certified.frequencies)
        counts.append(mesh.unknowns)
    properties = meshed.properties()
    return {
        "density": material.rho,
        "total": properties.mass,
        "centre": properties.centre,
        "inertia": properties.inertia,
        "frequencies": certified.frequencies,
        "frequency_refinement": refinement_uncertainty(frequencies),
        "counted": certified.count,
        "counted_below": float(np.sqrt(certified.shift) / (2.0 * np.pi)),
        "unknowns": tuple(counts),
        "elements": len(mesh.cells),
        "straightened": mesh.straightened,
    }
