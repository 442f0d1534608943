"""Published benchmarks by solids: MacNeal–Harder's straight cantilever and NAFEMS FV5.

Solids are held and loaded as Saint-Venant's theory has it, by means over their end faces, so that
beam theory's own approximation is all that keeps the two apart. Statics have none; a simply
supported mode is made of half waves, and there it is the prism's exact wave less the beam's.
"""

from dataclasses import dataclass, replace
from math import log2, pi

import numpy as np

from fem.bodies import leg_modes, solid
from fem.couplings.end_coupling import free_ends
from fem.solvers.cholesky import analyse as analyse_pattern
from fem.solvers.factor import upper_triangle
from fem.solvers.renewable_factor import RenewableFactor
from lumped.arrays import Array
from lumped.legs import ConstantLeg
from meshes.prism.extrude import extrude, stations
from meshes.section.section_mesh import section_mesh
from validation.agreement.convergence import analyse, uncertainty_of
from validation.case import Allowance, Case, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.benchmarks.beams import (
    DEEP,
    FV5,
    FV5_CLUSTERS,
    SECTION,
    STRAIGHT,
    TOLERANCE,
    TWIST_NOTE,
    Cluster,
    cluster_study,
    refinement_study,
    straight_cantilevers,
)
from validation.context import Context, Preset
from validation.solids.legs import FORMAL_ORDER
from validation.solids.waves import WaveKind, beam_wave_frequency, prism_wave_frequency

_CANTILEVER = "MacNeal–Harder cantilever as a solid"
_BEAM = "NAFEMS FV5 as a solid"
FV5_DIVISIONS = (2, 3, 4, 6)
STRAIGHT_DIVISIONS = (2, 3, 4, 5)
# Slices along the whole beam per division of the section: errors of both directions alike.
_DEEP_SLICES, _STRAIGHT_SLICES = 3, 5
_SOLID_PRESETS: tuple[Preset, ...] = ("standard", "fine")
_SOLID_REASON = (
    "0.1 % of the theory column, which has four digits; the mesh's own uncertainty is stated and "
    "must stay below it"
)


@dataclass(frozen=True)
class Wave:
    """Wave of a kind with the wavenumber `halves`·π/L: so many half waves along the beam."""

    kind: WaveKind
    halves: float


FV5_WAVES = dict(
    zip(
        FV5_CLUSTERS,
        (
            Wave("bending", 1.0),
            Wave("torsion", 0.5),
            Wave("tension", 0.5),
            Wave("bending", 2.0),
            Wave("torsion", 1.5),
            Wave("bending", 3.0),
        ),
        strict=True,
    )
)


def cases() -> tuple[Case, ...]:
    """Both solids, from the standard preset on."""
    return (*_straight(), *_deep())


_straight = straight_cantilevers.like(
    tolerance_reason=_SOLID_REASON,
    presets=_SOLID_PRESETS,
    model="solid",
    group="benchmark.macneal-harder.solid",
    effort=1.2,
)
_deep = CaseGroup(
    over={"cluster": FV5_CLUSTERS},
    reference_kind="published",
    citation=FV5,
    tolerance=TOLERANCE,
    tolerance_reason=_SOLID_REASON,
    presets=_SOLID_PRESETS,
    model="solid",
    row="fv5",
    section=SECTION,
    group="benchmark.fv5.solid",
    effort=0.5,
)


@_straight.case("benchmark.macneal-harder.solid[{name}]", f"{_CANTILEVER}: {{name}}")
def _macneal(
    context: Context, name: str, component: int, target: float, quantity: str
) -> Measurement:
    found = context.get(straight_solid_compliances, STRAIGHT_DIVISIONS)[:, component]
    sizes = 1.0 / np.array(STRAIGHT_DIVISIONS, dtype=float)
    convergence = analyse(sizes, found, FORMAL_ORDER, round_off=1e-9)
    return Measurement(
        float(found[-1]),
        target,
        value_uncertainty=uncertainty_of(convergence),
        notes=("ends free to warp and contract", *((TWIST_NOTE,) if name == "twist" else ())),
        studies=(
            refinement_study(
                "macneal-harder.solid",
                _CANTILEVER,
                name,
                name,
                quantity,
                "rad" if name == "twist" else "m",
                convergence,
                "divisions of the section",
            ),
        ),
    )


def straight_solid_compliances(divisions: tuple[int, ...]) -> Array:
    """Diagonal of the tip compliance (m×6, SI) of MacNeal–Harder's beam, free ends."""
    found = []
    for number in divisions:
        beam = extruded(STRAIGHT, number, _STRAIGHT_SLICES * number)
        found.append(np.diag(solid.tip_compliance(solid.clamped_leg(beam, "free"))))
    return np.array(found)


def extruded(leg: ConstantLeg, divisions: int, slices: int) -> solid.SolidLeg:
    """The beam as a solid, `divisions` elements across its smaller side, `slices` along it."""
    section = section_mesh(leg.section, divisions)
    return solid.solid_leg(leg, extrude(section, stations(leg.length, slices)))


@_deep.case(
    "benchmark.fv5.solid[{cluster.label}]",
    f"{_BEAM}: {{cluster.meaning}}",
    quantity="natural frequency {cluster.label}, worst of the cluster",
    label="frequency {cluster.label}",
    unit="Hz",
)
def _fv5(context: Context, cluster: Cluster) -> Measurement:
    found = cluster.of(context.get(deep_solid_frequencies, FV5_DIVISIONS))
    values = found[:, cluster.worst(found[-1])]
    sizes = 1.0 / np.array(FV5_DIVISIONS, dtype=float)
    convergence = analyse(sizes, values, FORMAL_ORDER, round_off=1e-9)
    return Measurement(
        float(values[-1]),
        cluster.target,
        value_uncertainty=uncertainty_of(convergence),
        allowances=(_beam_theory_error(FV5_WAVES[cluster]),),
        table=cluster.table(found[-1]),
        studies=(
            cluster_study("fv5.solid", _BEAM, cluster, convergence, "divisions of the section"),
        ),
    )


def _beam_theory_error(wave: Wave) -> Allowance:
    wavenumber = wave.halves * pi / DEEP.length
    error, longer = (_wave_error(wave.kind, k) for k in (wavenumber, wavenumber / 2.0))
    return Allowance(
        cause=f"beam theory of {wave.kind} is approximate for short waves",
        amount=error * beam_wave_frequency(DEEP.timoshenko, wave.kind, wavenumber),
        source="exact wave of the prism (prism_wave_frequency) less the beam's: "
        f"{100.0 * error:+.3g} %, with exponent {-log2(error / longer):.2f} in the slenderness",
    )


def _wave_error(kind: WaveKind, wavenumber: float) -> float:
    prism = prism_wave_frequency(DEEP.section, DEEP.material, kind, wavenumber)
    return prism / beam_wave_frequency(DEEP.timoshenko, kind, wavenumber) - 1.0


def deep_solid_frequencies(divisions: tuple[int, ...]) -> Array:
    """The lowest nine frequencies (m×9, Hz) of FV5's beam as a solid."""
    return np.array(
        [
            leg_modes.modes(
                simply_supported(extruded(DEEP, number, _DEEP_SLICES * number)),
                FV5_CLUSTERS[-1].last,
            ).frequencies
            for number in divisions
        ]
    )


def simply_supported(beam: solid.SolidLeg) -> solid.ClampedLeg:
    """The beam held in x, y, z, φx at its root and in y, z at its tip, on average over the faces.

    The averages C are the conjugates of Saint-Venant's tractions, so warping, contraction and both
    bending rotations are free. The six are statically determinate: L = C (RᵀC)⁻¹ takes the place
    of the root's six loads in `end_coupling.FreeEnds`, with LᵀR = I for the rigid motions R.
    """
    ends = free_ends(beam.mesh, beam.leg.material)
    averages = np.hstack([ends.root_loads[:, :4], ends.free_tip_loads[:, 1:3]])
    held = replace(ends, root_loads=averages @ np.linalg.inv(ends.motions.T @ averages))
    stiffness = upper_triangle(held.clamped_stiffness(beam.stiffness))
    pattern = analyse_pattern(stiffness, held.leading_blocks)
    return solid.ClampedLeg(
        mesh=beam.mesh,
        ends=held,
        mass=held.clamped_mass(beam.mass),
        factor=RenewableFactor(pattern, stiffness, "NAFEMS FV5 as a solid"),
        solid=beam,
    )
