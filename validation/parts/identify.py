"""Identification: what a part is to those who know it by its interfaces alone, and how surely.

Stiffness and mass between the interfaces on the finest of three meshes, the first frequencies with
the first interface clamped. Two uncertainties: of the meshes, and of how the interfaces are held,
between rigid, the bound from above, and averaged, the bound from below.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.bodies.part import (
    MeshedPart,
    grips_of,
    held_part,
    meshed_part,
    require_memory,
)
from fem.couplings.grips import Kind
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import Material
from meshes.part.interfaces import Interface
from meshes.part.reading.read import PartFile
from meshes.part.spread import spread_over
from validation.parts.meshes import FINEST, LEVELS, gradings, mesh_entries, part_key, part_mesh
from validation.parts.refinement import compliance_uncertainty, refinement_uncertainty
from validation.run.cache import CacheEntry, require_shape
from validation.tables import Cell, ResultTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DEFAULT_UNKNOWNS = 100_000
DEFAULT_MODES = 6
# Unknowns up to which --accuracy refines a part: some ten minutes and 30 GB of one factorisation.
MOST_REFINED = 800_000
_AXES = (
    *(("x", "m/N"), ("y", "m/N"), ("z", "m/N")),
    *(("phi_x", "rad/(N m)"), ("phi_y", "rad/(N m)"), ("phi_z", "rad/(N m)")),
)
_BOUNDS: tuple[Kind, Kind] = ("rigid", "average")


@dataclass(frozen=True, eq=False)
class MeshAnswer:
    """What one mesh and one coupling say (SI, file axes): see `Identified`; `shapes` everywhere.

    `counted` is 0 where nobody counts.
    """

    stiffness: Array
    mass: Array
    compliance: Array
    frequencies: Array
    shapes: Array
    counted: int
    counted_below: float


@dataclass(frozen=True, eq=False)
class Identified:
    """A part by its m interfaces, SI, the file's axes, twists at the interfaces' points.

    `density` (kg/m³), `total` (kg), `centre` (3, m) and `inertia` (3×3, kg m²) about it, of the
    finest mesh.

    `stiffness`, `mass` (6m×6m, condensed); `compliance` (6(m−1))² of the others with the first
    clamped, and `frequencies` (Hz) then: `counted` below `counted_below` (Hz) by inertia, none of
    them missing. `refinement` of each compliance and of each frequency
    (their units; NaN for a given mesh, which cannot be refined); `bracket`: averaged less rigid.
    `unknowns` of the meshes, coarse to fine; `straightened` elements of the finest; `by_curvature`:
    False if gmsh makes them without sizes from curvature alone.

    `places` (s×3, m) all over the part, `shares` (s, kg) of its mass there, and `shapes` (3s×6m):
    how they move for unit twists of the interfaces.

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
    counted: int
    counted_below: float
    unknowns: tuple[int, ...]
    elements: int
    straightened: int
    by_curvature: bool
    places: Array
    shares: Array
    shapes: Array

    @property
    def deviation(self) -> float | None:
        """Relative difference of the mesh's volume from the CAD kernel's. None for a given mesh.

        Examples
        --------
        >>> abs(part.deviation) < 0.01
        True
        """
        exact = self.part.exact
        return None if exact is None else self.total / self.density / exact.volume - 1.0

    def table(self) -> ResultTable:
        """Diagonal compliances and frequencies, a row for each, with uncertainties.

        Returns
        -------
        ResultTable
            Values in SI units; half-widths of the meshes and differences of averaged from rigid
            interfaces in per cent.

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
        """Uncertainty of each compliance and frequency, from meshes and from interfaces.

        Returns
        -------
        matplotlib.figure.Figure
            Bars in per cent of the value.

        Examples
        --------
        >>> part.plot().savefig("part.png")
        """
        # Only a picture needs the library that draws it.
        from validation.parts.identified_plot import identified_plot  # noqa: PLC0415

        modes = [f"f{mode}" for mode in range(1, len(self.frequencies) + 1)]
        names = [name for name, _ in self._components]
        return identified_plot(names, self._compliance_parts, modes, self._frequency_parts)

    @property
    def _components(self) -> list[tuple[str, str]]:
        """Names of the diagonal compliances with their units."""
        several = len(self.interfaces) > 2
        return [
            (f"{one.name} {axis}" if several else axis, unit)
            for one in self.interfaces[1:]
            for axis, unit in _AXES
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
    """Parts of values, relative, a column for each (n×k)."""
    return 100.0 * np.column_stack([part / values for part in parts])


def identify(
    part: PartFile,
    interfaces: Sequence[Interface],
    material: Material,
    unknowns: int = DEFAULT_UNKNOWNS,
    modes: int = DEFAULT_MODES,
) -> Identified:
    """Identify a part on three meshes, the finest of about so many `unknowns`.

    Raises InputError where no mesh can be made, ComputationError where memory or a solver fails.
    """
    return identified_entry(part, interfaces, material, unknowns, modes).value()


def identified_entry(
    part: PartFile,
    interfaces: Sequence[Interface],
    material: Material,
    unknowns: int,
    modes: int,
) -> CacheEntry[Identified]:
    """Cache entry of what `identify` returns."""
    key = part_key(part, interfaces, material, "identify", unknowns, modes)
    m = 6 * len(interfaces)

    def read(found: dict[str, Array]) -> Identified:
        square = {"stiffness": (m, m), "mass": (m, m), "compliance": (m - 6, m - 6)}
        require_shape(found, **square, places=(None, 3), shares=(None,), shapes=(None, m))
        # numpy keeps scalars as arrays without axes.
        values: dict[str, Any] = {
            entry.name: found[entry.name] if found[entry.name].ndim else found[entry.name].item()
            for entry in fields(Identified)
            if entry.name in found
        }
        values["unknowns"] = tuple(int(count) for count in found["unknowns"])
        return Identified(part=part, interfaces=tuple(interfaces), **values)

    return CacheEntry(
        key,
        lambda: _computed(part, interfaces, material, unknowns, modes),
        read,
        mesh_entries(part, interfaces, unknowns, LEVELS),
    )


def left_open(found: Identified) -> float:
    """The largest relative half-width by meshes of the diagonal compliances and the frequencies."""
    compliances = np.diag(found.compliance_refinement) / np.diag(found.compliance)
    shares = np.concatenate([compliances, found.frequency_refinement / found.frequencies])
    return float(np.max(np.nan_to_num(np.abs(shares), nan=np.inf), initial=0.0))


def more_unknowns(unknowns: int, factor: float) -> int:
    """Unknowns of a finest mesh with half-widths smaller by `factor`, at most eight times as many.

    Parts converge with orders from one to two of the mesh size, which is the cube root of them.
    Raises InputError if the factor is unknown, since the mesh is given, and for more unknowns than
    `MOST_REFINED`.
    """
    if not np.isfinite(factor):
        raise InputError("a mesh that is given has no finer one")
    more = int(min(unknowns * min(max(factor**2, 2.0), 8.0), max(MOST_REFINED, unknowns)))
    if more <= unknowns:
        raise InputError(f"a finer mesh has more than {MOST_REFINED} unknowns: ask with --unknowns")
    return more


def _computed(
    part: PartFile,
    interfaces: Sequence[Interface],
    material: Material,
    unknowns: int,
    modes: int,
) -> dict[str, Any]:
    """The fields of `Identified` beside the part and its interfaces."""
    name, given = part.path.name, part.mesh is not None
    coarse_to_fine = (FINEST,) if given else LEVELS
    by_curvature = True
    if not given:
        require_memory(unknowns, name)
        # Once, before two ask for them.
        by_curvature = all(step.sides for step in gradings(part, interfaces, unknowns))
    # Meshes are made while coarser ones are used; the finest takes longest.
    with ThreadPoolExecutor(2) as pool:
        began = {
            level: pool.submit(part_mesh, part, interfaces, unknowns, level)
            for level in (FINEST, *coarse_to_fine[:-1])
        }
        coarser = []
        for level in coarse_to_fine[:-1]:
            mesh = began.pop(level).result()
            found = _answer(meshed_part(mesh, material), interfaces, None, modes, name)
            coarser.append((mesh.unknowns, found))
        finest = began.pop(FINEST).result()
    meshed = meshed_part(finest, material)
    properties = meshed.properties()
    chosen = {interface.coupling for interface in interfaces}
    one = chosen.pop() if len(chosen) == 1 else None
    fine = _answer(meshed, interfaces, None, modes, name, certified=True)
    bounds = {
        kind: fine if kind == one else _answer(meshed, interfaces, kind, modes, name)
        for kind in _BOUNDS
    }
    del meshed
    rows, volumes = spread_over(finest)
    refinement = _refinement([*(answer for _, answer in coarser), fine])
    return {
        "density": material.rho,
        "total": properties.mass,
        "centre": properties.centre,
        "inertia": properties.inertia,
        "stiffness": fine.stiffness,
        "mass": fine.mass,
        "compliance": fine.compliance,
        "frequencies": fine.frequencies,
        "compliance_refinement": refinement[0],
        "frequency_refinement": refinement[1],
        **_bracket(**bounds),
        "counted": fine.counted,
        "counted_below": fine.counted_below,
        "unknowns": (*(count for count, _ in coarser), finest.unknowns),
        "elements": len(finest.cells),
        "straightened": finest.straightened,
        "by_curvature": by_curvature,
        "places": finest.nodes[rows],
        "shares": material.rho * volumes,
        "shapes": fine.shapes.reshape(len(finest.nodes), 3, -1)[rows].reshape(3 * len(rows), -1),
    }


def _answer(
    part: MeshedPart,
    interfaces: Sequence[Interface],
    coupling: Kind | None,
    modes: int,
    name: str,
    *,
    certified: bool = False,
) -> MeshAnswer:
    """Modes are counted where they are what is stated: `certified`.

    One that were missed where they are only taken off these would be seen in what is left open.
    """
    body = held_part(part, grips_of(part.mesh, interfaces, coupling), name)
    # Before the modes, whose count takes the place of the factor.
    matrices = body.stiffness, body.condensed_mass, body.compliance
    shapes = body.solid.transformation @ body.constraint_modes
    frequencies, counted, below = np.zeros(0), 0, 0.0
    if modes and certified:
        found = body.modes(modes)
        frequencies, counted = found.frequencies, found.count
        below = float(np.sqrt(found.shift) / (2.0 * np.pi))
    elif modes:
        frequencies = body.uncounted_frequencies(modes)
    return MeshAnswer(*matrices, frequencies, shapes, counted, below)


def _bracket(rigid: MeshAnswer, average: MeshAnswer) -> dict[str, Array]:
    return {
        "compliance_bracket": average.compliance - rigid.compliance,
        "frequency_bracket": average.frequencies - rigid.frequencies,
    }


def _refinement(answers: Sequence[MeshAnswer]) -> tuple[Array, Array]:
    """Of compliance and of frequencies; `answers` are coarse to fine."""
    if len(answers) < 3:
        (only,) = answers
        return np.full_like(only.compliance, np.nan), np.full_like(only.frequencies, np.nan)
    coarse, middle, fine = answers
    return (
        compliance_uncertainty(coarse.compliance, middle.compliance, fine.compliance),
        refinement_uncertainty(coarse.frequencies, middle.frequencies, fine.frequencies),
    )
