"""MacNeal–Harder's cantilever and NAFEMS FV5 as solids, torsion of rectangles by finite elements.

Solids are held and loaded as Saint-Venant's theory has it, by means over their end faces, so that
beam theory's own approximation is all that keeps the two apart. Statics have none; a simply
supported mode is made of half waves, and there it is the prism's exact wave less the beam's.
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from fem.bodies import solid
from fem.bodies.rooted import RootedBody, rooted_body
from fem.sections.section_constants import section_constants
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle
from meshes.prism.hexahedra import extrude, stations
from meshes.section.section_mesh import section_mesh
from validation.selftest.benchmark import Benchmark, KnownNumber
from validation.solids.waves import WaveKind, beam_wave_frequency, prism_wave_frequency

TOLERANCE = 1e-3


@dataclass(frozen=True)
class Cluster:
    """Modes `first` to `last` (from 1) of one frequency `target` (Hz)."""

    first: int
    last: int
    target: float
    meaning: str

    def compared(self, frequencies: Array, explained: float = 0.0) -> KnownNumber:
        """Of all `frequencies` (Hz) the one of the cluster that is farthest from its target."""
        own = frequencies[self.first - 1 : self.last]
        ours = float(own[np.argmax(np.abs(own - self.target))])
        numbers = f"f{self.first}" + (f" to f{self.last}" if self.last > self.first else "")
        quantity = f"{numbers}, {self.meaning}"
        return KnownNumber(quantity, "Hz", self.target, ours, TOLERANCE, explained)


# Statics: any density.
STRAIGHT = ConstantLeg(6.0, Rectangle(0.2, 0.1), Material.isotropic(1e7, 0.3, 1.0))
# Component of the tip, what it is, unit, target (m or rad per N or N m).
MACNEAL_TARGETS = (
    (0, "extension under a unit force", "m", 3.0e-5),
    (1, "deflection in the plane of the larger side under a unit force", "m", 0.1081),
    (2, "deflection out of that plane under a unit force", "m", 0.4321),
    (3, "twist under a unit torque", "rad", 0.034109),
)
MACNEAL_HARDER = (
    "R. H. MacNeal, R. L. Harder, Finite Elem. Anal. Des. 1 (1985) 3, straight cantilever beam; "
    "the twist published there, 0.03208, is 6 % below Saint-Venant's T L/GJ = 0.034109, taken here"
)
FV5 = "NAFEMS, The Standard NAFEMS Benchmarks, TNSB rev. 3 (1990), Test FV5"
DEEP = ConstantLeg(10.0, Rectangle(2.0, 2.0), Material.isotropic(2e11, 0.3, 8000.0))
# Modes, their kind of wave, and how many half waves they have along the beam.
FV5_MODES: tuple[tuple[Cluster, WaveKind, float], ...] = (
    (Cluster(1, 2, 42.650, "bending 1"), "bending", 1.0),
    (Cluster(3, 3, 71.20, "torsion 1"), "torsion", 0.5),
    (Cluster(4, 4, 125.00, "tension 1"), "tension", 0.5),
    (Cluster(5, 6, 148.15, "bending 2"), "bending", 2.0),
    (Cluster(7, 7, 213.61, "torsion 2"), "torsion", 1.5),
    (Cluster(8, 9, 283.47, "bending 3"), "bending", 3.0),
)
# J/(b h³) of rectangles b × h.
TORSION_CONSTANTS = {
    1.0: 0.140577,
    2.0: 0.228682,
    10.0: 0.312325,
}
TIMOSHENKO = "S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, §109, table of k1, six digits"
# Elements across the section, and slices along the whole beam per element: errors alike.
_STRAIGHT_DIVISIONS, _STRAIGHT_SLICES = 4, 5
_DEEP_DIVISIONS, _DEEP_SLICES = 5, 3
_TORSION_DIVISIONS = 16


def benchmarks() -> tuple[Benchmark, ...]:
    """Statics, modes and their count, and sections."""
    return (
        Benchmark(
            "MacNeal–Harder's straight cantilever as a solid",
            "Displacement of the tip of a cantilever of 6 × 0.2 × 0.1 under unit loads: "
            "E = 10⁷, ν = 0.3, the clamped end free to warp and contract. Quadratic hexahedra, "
            f"{_STRAIGHT_DIVISIONS} across the smaller side.",
            MACNEAL_HARDER,
            "0.1 % of the theory column, which has four digits; the mesh leaves up to 0.04 %",
            straight_cantilever,
        ),
        Benchmark(
            "NAFEMS FV5, deep simply supported beam, as a solid",
            "Natural frequencies of a beam of 10 m with a square section of 2 m: E = 200 GPa, "
            "ν = 0.3, ρ = 8000 kg/m³, deflections held at both ends, displacement along and "
            "rotation about the axis at one, on average over the faces; number of the modes by "
            f"Sturm's count. Quadratic hexahedra, {_DEEP_DIVISIONS} across the side. "
            "Explained is what beam theory neglects in such short waves: the exact wave of the "
            "prism less the beam's.",
            FV5,
            "0.1 % of the theory column, which has four digits; the mesh leaves up to 0.04 %",
            deep_beam,
        ),
        Benchmark(
            "Torsion constants of rectangles by finite elements",
            "J/(b h³) of rectangles b × h, Saint-Venant's torsion on meshes of biquadratic "
            f"elements, {_TORSION_DIVISIONS} across the smaller side.",
            TIMOSHENKO,
            "the last of six published digits, and as much again for the mesh",
            lambda: [torsion_constant(ratio) for ratio in TORSION_CONSTANTS],
        ),
    )


def straight_cantilever() -> list[KnownNumber]:
    """The diagonal of the tip's compliance."""
    beam = extruded(STRAIGHT, _STRAIGHT_DIVISIONS, _STRAIGHT_SLICES * _STRAIGHT_DIVISIONS)
    found = np.diag(solid.clamped_leg(beam, "free").compliance)
    return [
        KnownNumber(quantity, unit, target, float(found[component]), TOLERANCE)
        for component, quantity, unit, target in MACNEAL_TARGETS
    ]


def extruded(leg: ConstantLeg, divisions: int, slices: int) -> solid.SolidLeg:
    """The beam as a solid, `divisions` elements across its smaller side, `slices` along it."""
    section = section_mesh(leg.section, divisions)
    return solid.solid_leg(leg, extrude(section, stations(leg.length, slices)))


def deep_beam() -> list[KnownNumber]:
    """FV5's nine modes, and that there are no more below the shift above them."""
    beam = extruded(DEEP, _DEEP_DIVISIONS, _DEEP_SLICES * _DEEP_DIVISIONS)
    count = FV5_MODES[-1][0].last
    found = simply_supported(beam).modes(count)
    compared = [KnownNumber("modes up to bending 3", "1", count, found.count, TOLERANCE)]
    for cluster, kind, halves in FV5_MODES:
        wavenumber = halves * pi / DEEP.length
        prism = prism_wave_frequency(DEEP.section, DEEP.material, kind, wavenumber)
        error = prism / beam_wave_frequency(DEEP.timoshenko, kind, wavenumber) - 1.0
        compared.append(cluster.compared(found.frequencies, error))
    return compared


def simply_supported(beam: solid.SolidLeg) -> RootedBody:
    """The beam held in x, y, z, φx at its root and in y, z at its tip, on average over the faces.

    The averages C are the conjugates of Saint-Venant's tractions, so warping, contraction and both
    bending rotations are free. The six are statically determinate: L = C (RᵀC)⁻¹ takes the place
    of the root's six loads, with LᵀR = I for the rigid motions R.
    """
    free = solid.coupled_leg(beam, "free")
    averages = free.twists[:, [0, 1, 2, 3, 7, 8]]
    held = averages @ np.linalg.inv(free.motions.T @ averages)
    return rooted_body(replace(free, twists=held), "NAFEMS FV5 as a solid")


def torsion_constant(ratio: float) -> KnownNumber:
    """J/(b h³) of a rectangle with b/h = `ratio`."""
    mesh = section_mesh(Rectangle(ratio, 1.0), _TORSION_DIVISIONS)
    found = section_constants(mesh, nu=0.0).torsion_constant / ratio
    known = TORSION_CONSTANTS[ratio]
    return KnownNumber(f"J/(b h³), b/h = {ratio:g}", "1", known, found, 2e-6 / known)
