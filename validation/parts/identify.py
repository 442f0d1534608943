"""Identification of a CAD part on its interfaces, with uncertainties.

Input: a part file, its interfaces, a material and the number of unknowns. Output: `Identified`,
with stiffness and mass between the interfaces on the finest of three meshes and the first
frequencies with the first interface clamped. Rule: there are two uncertainties. The half-width due
to the mesh follows from three meshes. The uncertainty of the end condition is the difference
between averaged interfaces, which bound the stiffness from below, and rigid interfaces, which bound
it from above.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.bodies.part import (
    MeshedPart,
    as_columns,
    grips_of,
    held_part,
    meshed_part,
    require_memory,
    wrenches_of_faces,
)
from fem.couplings.grips import Kind
from lumped.acceptance.quantities import DIAGONAL_UNITS
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import Material
from meshes.part.interfaces import Interface
from meshes.part.reading.read import PartFile
from meshes.part.spread import spread_over
from validation.parts.free_modes import FreePart, stored_values
from validation.parts.meshes import FINEST, LEVELS, gradings, mesh_entries, part_key, part_mesh
from validation.parts.refinement import compliance_uncertainty, refinement_uncertainty
from validation.run.cache import CacheEntry, require_shape
from validation.tables import Cell, ResultTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DEFAULT_UNKNOWNS = 100_000
DEFAULT_MODES = 6
# Largest number of unknowns to which --accuracy refines a part. One factorisation then takes about
# ten minutes and 30 GB.
MOST_REFINED = 800_000
_BOUNDS: tuple[Kind, Kind] = ("rigid", "average")


@dataclass(frozen=True, eq=False)
class MeshAnswer:
    """Results on one mesh with one coupling of the interfaces (SI, axes of the file).

    Fields with the names of fields of `Identified` have the same meaning. `shapes` contains the
    displacements of all nodes. `unit_pressures`: wrenches on the m interfaces (6m) for 1 Pa on
    a face, by face number. `counted` and `counted_below` are None if modes are not counted.
    """

    stiffness: Array
    mass: Array
    compliance: Array
    frequencies: Array
    shapes: Array
    unit_pressures: Mapping[int, Array]
    counted: int | None
    counted_below: float | None


@dataclass(frozen=True, eq=False)
class Identified:
    """Part with m interfaces: stiffness, mass and frequencies, with uncertainties.

    SI units, axes of the file, twists at the points of the interfaces.

    `density` (kg/m³) of the material; `total` mass (kg), `centre` of mass (3, m) and `inertia`
    about it (3×3, kg m²) of the finest mesh.

    `stiffness` and `mass` (6m×6m) are condensed to the interfaces. `compliance` (of the other
    interfaces, 6(m−1) rows and columns) and `frequencies` (Hz) are those with the first interface
    clamped. `counted`: number of modes below `counted_below` (Hz), by Sylvester's law of inertia;
    it proves that no mode is missing. Both are None if the memory is too small for this proof.
    `compliance_refinement` and `frequency_refinement`: half-widths due to the mesh in the units of
    the values. NaN if the file of the part is a mesh, which cannot be refined. `compliance_bracket`
    and `frequency_bracket` are the values with averaged interfaces less those with rigid ones.
    `unknowns`: number of unknowns of each mesh, from coarse to fine. `elements`: number of elements
    of the finest mesh. `straightened`: number of those whose edges were made straight, because they
    were folded. `by_curvature`: False if gmsh failed with element sizes from curvature.

    `places` (s×3, m): sample points over the part; `shares` (s, kg): their shares of its mass;
    `shapes` (3s×6m): their displacements for unit twists of the interfaces. `pressures` (F×6m):
    wrenches on the interfaces for 1 Pa on each of the faces with the numbers `pressed` (F).

    Examples
    --------
    >>> part = identify(
    ...     "examples/tapered-biglide/leg1.step",
    ...     interfaces={"A": {"cylinder": {"radius": 0.040}}, "B": {"cylinder": {"radius": 0.028}}},
    ...     material={"E": 2.1e11, "nu": 0.3, "rho": 7850.0},
    ...     unknowns=5000,
    ...     modes=1,
    ... )
    """

    part: PartFile
    interfaces: tuple[Interface, ...]
    density: float
    total: float
    centre: Array
    inertia: Array
    stiffness: Array
    mass: Array
    compliance: Array
    frequencies: Array
    compliance_refinement: Array
    frequency_refinement: Array
    compliance_bracket: Array
    frequency_bracket: Array
    unknowns: tuple[int, ...]
    elements: int
    straightened: int
    by_curvature: bool
    places: Array
    shares: Array
    shapes: Array
    pressed: Array
    pressures: Array
    counted: int | None = None
    counted_below: float | None = None

    @property
    def deviation(self) -> float | None:
        """Relative difference between the mesh's volume and the CAD kernel's. None for a mesh file.

        Examples
        --------
        >>> abs(part.deviation) < 0.01
        True
        """
        exact = self.part.exact
        return None if exact is None else self.total / self.density / exact.volume - 1.0

    def table(self) -> ResultTable:
        """Table of diagonal compliances and frequencies with their uncertainties, one row each.

        Returns
        -------
        ResultTable
            Values in SI units; half-widths due to the mesh, and differences between averaged and
            rigid interfaces, in per cent.

        Examples
        --------
        >>> [row[0] for row in part.table().rows]
        ['x', 'y', 'z', 'phi_x', 'phi_y', 'phi_z', 'f1']
        """
        rows: list[tuple[Cell, ...]] = [
            (name, unit, value, *parts)
            for (name, unit), value, parts in zip(
                self._components,
                np.diag(self.compliance).tolist(),
                self._compliance_parts.tolist(),
                strict=True,
            )
        ]
        rows += [
            (f"f{mode}", "Hz", value, *parts)
            for mode, (value, parts) in enumerate(
                zip(self.frequencies.tolist(), self._frequency_parts.tolist(), strict=True), 1
            )
        ]
        headings = "quantity", "unit", "value", "± meshes (%)", "averaged less rigid (%)"
        return ResultTable(headings, tuple(rows))

    def plot(self) -> "Figure":
        """Uncertainty of each compliance and frequency due to the mesh and to the interfaces.

        Returns
        -------
        matplotlib.figure.Figure
            Bars in per cent of the value.

        Examples
        --------
        >>> part.plot().savefig("part.png")
        """
        # Only a plot needs matplotlib, which is slow to import.
        from validation.parts.identified_plot import identified_plot  # noqa: PLC0415

        modes = [f"f{mode}" for mode in range(1, len(self.frequencies) + 1)]
        names = [name for name, _ in self._components]
        return identified_plot(names, self._compliance_parts, modes, self._frequency_parts)

    @property
    def _components(self) -> list[tuple[str, str]]:
        """Names of the diagonal compliances with their units."""
        several = len(self.interfaces) > 2
        return [
            (f"{interface.name} {axis}" if several else axis, unit)
            for interface in self.interfaces[1:]
            for axis, unit in DIAGONAL_UNITS.items()
        ]

    @property
    def _compliance_parts(self) -> Array:
        return _in_percent(
            np.diag(self.compliance),
            np.diag(self.compliance_refinement),
            np.diag(self.compliance_bracket),
        )

    @property
    def _frequency_parts(self) -> Array:
        return _in_percent(self.frequencies, self.frequency_refinement, self.frequency_bracket)

    def __repr__(self) -> str:
        names = ", ".join(interface.name for interface in self.interfaces)
        return (
            f"Identified({self.total:.4g} kg between {names}, {len(self.frequencies)} frequencies)"
        )

    def _repr_html_(self) -> str:
        return self.table().html()


def _in_percent(values: Array, *parts: Array) -> Array:
    """Uncertainties (n×k) of k kinds in per cent of n `values`.

    `parts`: for each kind, the n uncertainties in the units of the values.
    """
    return 100.0 * np.column_stack([part / values for part in parts])


def identify(
    part: PartFile,
    interfaces: Sequence[Interface],
    material: Material,
    unknowns: int = DEFAULT_UNKNOWNS,
    modes: int = DEFAULT_MODES,
) -> Identified:
    """Identify a part on three meshes, the finest with about `unknowns` unknowns.

    Raises InputError if no mesh can be made, and ComputationError if memory or a solver fails.
    """
    return identified_entry(part, interfaces, material, unknowns, modes).value()


def identified_entry(
    part: PartFile,
    interfaces: Sequence[Interface],
    material: Material,
    unknowns: int,
    modes: int,
) -> CacheEntry[Identified]:
    """Cache entry for the result of `identify`."""
    key = part_key(part, interfaces, material, "identify", unknowns, modes)
    meshes = mesh_entries(part, interfaces, unknowns, LEVELS)
    m = 6 * len(interfaces)

    def read(arrays: dict[str, Array]) -> Identified:
        square = {"stiffness": (m, m), "mass": (m, m), "compliance": (m - 6, m - 6)}
        require_shape(arrays, **square, places=(None, 3), shares=(None,), shapes=(None, m))
        require_shape(arrays, pressed=(None,), pressures=(len(arrays["pressed"]), m))
        values = stored_values(Identified, arrays)
        return Identified(part=part, interfaces=tuple(interfaces), **values)

    return CacheEntry(
        key,
        lambda: _identification(part, interfaces, material, unknowns, modes),
        read,
        meshes,
    )


def largest_half_width(part: Identified | FreePart) -> float:
    """Largest relative half-width, due to meshes, of diagonal compliances and frequencies.

    Infinite if the file of the part is a mesh.
    """
    half_widths = part.frequency_refinement / part.frequencies
    if isinstance(part, Identified):
        compliances = np.diag(part.compliance_refinement) / np.diag(part.compliance)
        half_widths = np.concatenate([compliances, half_widths])
    return float(np.max(np.nan_to_num(np.abs(half_widths), nan=np.inf), initial=0.0))


def more_unknowns(unknowns: int, factor: float) -> int:
    """Number of unknowns of the finest mesh that divides half-widths by `factor`.

    Parts converge with orders from one to two in the mesh size, which varies as the cube root of
    the number of unknowns. The result is two to eight times `unknowns`. Raises InputError if the
    factor is infinite, as for a part whose file is a mesh, or if the mesh would have more than
    `MOST_REFINED` unknowns.
    """
    if not np.isfinite(factor):
        raise InputError("a mesh from a file cannot be refined")
    finer = int(min(unknowns * min(max(factor**2, 2.0), 8.0), max(MOST_REFINED, unknowns)))
    if finer <= unknowns:
        raise InputError(
            f"a finer mesh would have more than {MOST_REFINED} unknowns; to use one, specify "
            "its size with --unknowns"
        )
    return finer


def _identification(
    part: PartFile,
    interfaces: Sequence[Interface],
    material: Material,
    unknowns: int,
    modes: int,
) -> dict[str, Any]:
    """Values of all fields of `Identified` except for part and interfaces, by name of the field."""
    name, is_mesh = part.path.name, part.mesh is not None
    coarse_to_fine = (FINEST,) if is_mesh else LEVELS
    by_curvature = True
    if not is_mesh:
        require_memory(unknowns, name)
        # Gradings are computed here, before two threads need them at once.
        by_curvature = all(step.sides for step in gradings(part, interfaces, unknowns))
    # Meshes are made while coarser ones are solved. The finest takes longest and starts first.
    with ThreadPoolExecutor(2) as pool:
        meshes = {
            level: pool.submit(part_mesh, part, interfaces, unknowns, level)
            for level in (FINEST, *coarse_to_fine[:-1])
        }
        coarser = []
        for level in coarse_to_fine[:-1]:
            mesh = meshes.pop(level).result()
            answer = _answer(meshed_part(name, mesh, material), interfaces, None, modes)
            coarser.append((mesh.unknowns, answer))
        finest = meshes.pop(FINEST).result()
    meshed = meshed_part(name, finest, material)
    properties = meshed.properties()
    couplings = {interface.coupling for interface in interfaces}
    common_coupling = couplings.pop() if len(couplings) == 1 else None
    fine = _answer(meshed, interfaces, None, modes, certified=True)
    bounds = {
        kind: fine if kind == common_coupling else _answer(meshed, interfaces, kind, modes)
        for kind in _BOUNDS
    }
    # Frees memory before the samples are computed.
    del meshed
    rows, volumes = spread_over(finest)
    on_meshes = [*(answer for _, answer in coarser), fine]
    pressed, pressures = as_columns(fine.unit_pressures)
    return {
        "density": material.rho,
        "total": properties.mass,
        "centre": properties.centre,
        "inertia": properties.inertia,
        "stiffness": fine.stiffness,
        "mass": fine.mass,
        "compliance": fine.compliance,
        "frequencies": fine.frequencies,
        "compliance_refinement": compliance_uncertainty([part.compliance for part in on_meshes]),
        "frequency_refinement": refinement_uncertainty([part.frequencies for part in on_meshes]),
        "compliance_bracket": bounds["average"].compliance - bounds["rigid"].compliance,
        "frequency_bracket": bounds["average"].frequencies - bounds["rigid"].frequencies,
        **_count(fine),
        "unknowns": (*(count for count, _ in coarser), finest.unknowns),
        "elements": len(finest.cells),
        "straightened": finest.straightened,
        "by_curvature": by_curvature,
        "places": finest.nodes[rows],
        "shares": material.rho * volumes,
        "shapes": fine.shapes.reshape(len(finest.nodes), 3, -1)[rows].reshape(3 * len(rows), -1),
        "pressed": pressed,
        "pressures": pressures,
    }


def _answer(
    part: MeshedPart,
    interfaces: Sequence[Interface],
    coupling: Kind | None,
    modes: int,
    *,
    certified: bool = False,
) -> MeshAnswer:
    """Results on one mesh with one `coupling` of all interfaces.

    If `coupling` is None, each interface has the coupling of the robot file. If `certified`, modes
    are counted, which proves that none is missing. This is done for the reported frequencies only.
    Other frequencies are used in differences, in which a missing mode would appear as a large
    uncertainty.
    """
    grips = grips_of(part.mesh, interfaces, coupling)
    body = held_part(part, grips)
    # Before the modes, because counting them replaces the factorisation of the stiffness.
    matrices = body.stiffness, body.condensed_mass, body.compliance
    shapes = body.solid.transformation @ body.constraint_modes
    unit_pressures = wrenches_of_faces(part.mesh, shapes)
    if not modes:
        return MeshAnswer(*matrices, np.zeros(0), shapes, unit_pressures, 0, 0.0)
    if not certified or not body.countable:
        frequencies = body.uncounted_frequencies(modes)
        return MeshAnswer(*matrices, frequencies, shapes, unit_pressures, None, None)
    counted = body.modes(modes)
    below = float(np.sqrt(counted.shift) / (2.0 * np.pi))
    return MeshAnswer(*matrices, counted.frequencies, shapes, unit_pressures, counted.count, below)


def _count(answer: MeshAnswer) -> dict[str, Any]:
    """Fields `counted` and `counted_below` of `Identified`. {} if modes were not counted."""
    if answer.counted is None:
        return {}
    return {"counted": answer.counted, "counted_below": answer.counted_below}
