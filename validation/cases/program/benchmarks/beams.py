"""Published benchmarks by beams: NAFEMS FV5 and Test 71, MacNeal–Harder's straight cantilever.

Targets are the theory column of the publication and do not depend on the robot.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from fem.beams.frame import Frame, Member, Support, assemble, displacements, modes
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle
from validation.agreement.convergence import Convergence, analyse, uncertainty_of
from validation.case import Allowance, Case, Measurement, Relative
from validation.case_group import CaseGroup
from validation.context import Context
from validation.exhibits import Study

SECTION = "Published benchmarks"
COUNTS = (8, 16, 24, 32)
BEAM_ORDER = 4.0
FV5 = "NAFEMS, The Standard NAFEMS Benchmarks, TNSB rev. 3 (1990), Test FV5"
TEST_71 = (
    "F. Abbassian, D. J. Dawswell, N. C. Knowles, Selected Benchmarks for Natural Frequency "
    "Analysis, NAFEMS (1987), Test 71"
)
MACNEAL_HARDER = (
    "R. H. MacNeal, R. L. Harder, Finite Elem. Anal. Des. 1 (1985) 3, straight cantilever beam"
)
TOLERANCE = Relative(1e-3)
SLENDER = ConstantLeg(10.0, Rectangle(0.125, 0.125), Material.isotropic(2e11, 0.3, 8000.0))
DEEP = ConstantLeg(10.0, Rectangle(2.0, 2.0), Material.isotropic(2e11, 0.3, 8000.0))
# Statics: any density.
STRAIGHT = ConstantLeg(6.0, Rectangle(0.2, 0.1), Material.isotropic(1e7, 0.3, 1.0))


@dataclass(frozen=True)
class Cluster:
    """Modes `first` to `last` (from 1) of one frequency `target` (Hz)."""

    first: int
    last: int
    target: float
    meaning: str

    @property
    def label(self) -> str:
        """Such as "3" or "1-2"."""
        return str(self.first) if self.first == self.last else f"{self.first}-{self.last}"

    def of(self, frequencies: Array) -> Array:
        """The cluster's own (m × modes) of all frequencies (m × number), in Hz."""
        return frequencies[:, self.first - 1 : self.last]

    def worst(self, own: Array) -> int:
        """Which of the cluster's frequencies (Hz) is farthest from the target, from 0."""
        return int(np.argmax(np.abs(own - self.target)))

    def table(self, own: Array) -> dict[str, tuple[float | str, ...]]:
        """Every mode of the cluster (Hz) beside its target."""
        numbers = range(self.first, self.last + 1)
        return {
            "mode": tuple(float(number) for number in numbers),
            "found (Hz)": tuple(own.tolist()),
            "target (Hz)": (self.target,) * len(numbers),
        }


FV5_CLUSTERS = (
    Cluster(1, 2, 42.650, "bending 1"),
    Cluster(3, 3, 71.20, "torsion 1"),
    Cluster(4, 4, 125.00, "tension 1"),
    Cluster(5, 6, 148.15, "bending 2"),
    Cluster(7, 7, 213.61, "torsion 2"),
    Cluster(8, 9, 283.47, "bending 3"),
)
TEST_71_CLUSTERS = tuple(
    Cluster(k, k, target, f"bending {k}")
    for k, target in enumerate((1.010, 6.327, 17.716, 34.717, 57.390, 85.730), start=1)
)
# Component of the tip, reference (m or rad per N or N m), what it is.
MACNEAL_TARGETS = (
    ("extension", 0, 3.0e-5, "extension under a unit force"),
    ("in-plane", 1, 0.1081, "deflection in the plane of the larger side under a unit force"),
    ("out-of-plane", 2, 0.4321, "deflection out of that plane under a unit force"),
    ("twist", 3, 0.034109, "twist under a unit torque"),
)
TWIST_NOTE = (
    "the published twist, 0.03208, is 6 % below Saint-Venant's T L/GJ = 0.034109, which is the "
    "reference here"
)


def cases() -> tuple[Case, ...]:
    """The single members."""
    return (
        *family(
            "fv5.beam",
            "NAFEMS FV5 by Timoshenko beams",
            deep_beam,
            FV5_CLUSTERS,
            FV5,
            COUNTS,
            row="fv5",
        ),
        *family("test71", "NAFEMS Test 71", slender_cantilever, TEST_71_CLUSTERS, TEST_71, COUNTS),
        *straight_cantilevers(),
    )


def deep_beam(elements: int) -> Frame:
    """FV5: simply supported, held along and about its axis at the first end alone."""
    return Frame(
        "NAFEMS FV5",
        np.array([[0.0, 0.0, 0.0], [DEEP.length, 0.0, 0.0]]),
        (Member(0, 1, DEEP.timoshenko, (0.0, 0.0, 1.0), elements),),
        (Support(0, ("x", "y", "z", "φx")), Support(1, ("y", "z"))),
    )


def slender_cantilever(elements: int) -> Frame:
    """Test 71: Euler–Bernoulli bending in one plane."""
    beam = SLENDER.properties("euler-bernoulli")
    return Frame(
        "NAFEMS Test 71",
        np.array([[0.0, 0.0, 0.0], [SLENDER.length, 0.0, 0.0]]),
        (Member(0, 1, beam, (0.0, 0.0, 1.0), elements, kinds=("bending z",)),),
        (Support(0), Support(1, ("x", "z", "φx", "φy"))),
    )


def straight_cantilever() -> Frame:
    """MacNeal–Harder, clamped at node 0; one Timoshenko element is exact."""
    return Frame(
        "MacNeal–Harder cantilever",
        np.array([[0.0, 0.0, 0.0], [STRAIGHT.length, 0.0, 0.0]]),
        (Member(0, 1, STRAIGHT.timoshenko, (0.0, 0.0, 1.0), 1),),
        (Support(0),),
    )


def refined_frequencies(
    build: Callable[[int], Frame], counts: tuple[int, ...], number: int
) -> Array:
    """The lowest `number` frequencies (len(counts) × number, Hz) for elements per member."""
    return np.array([modes(assemble(build(count)), number).frequencies for count in counts])


def same_theory(_cluster: Cluster) -> tuple[Allowance, ...]:
    """No allowance: the beam is what the theory of the target describes."""
    return ()


def family(
    name: str,
    title: str,
    build: Callable[[int], Frame],
    clusters: tuple[Cluster, ...],
    citation: str,
    counts: tuple[int, ...],
    explain: Callable[[Cluster], tuple[Allowance, ...]] = same_theory,
    row: str = "",
) -> list[Case]:
    """One case per cluster of the frame that `build` makes for a number of elements per member.

    `explain` names what a cluster has that the theory of its target has not; `row` is
    that of the cases, `name` if left out.
    """
    return [
        Case(
            id=f"benchmark.{name}[{cluster.label}]",
            title=f"{title}: {cluster.meaning}",
            quantity=f"natural frequency {cluster.label}, worst of the cluster",
            label=f"frequency {cluster.label}",
            unit="Hz",
            reference_kind="published",
            citation=citation,
            tolerance=TOLERANCE,
            tolerance_reason="0.1 % of the theory column: it has four digits, and the finest "
            "beam's own error is below 0.01 %",
            compute=partial(
                _frequency,
                name=name,
                title=title,
                build=build,
                cluster=cluster,
                counts=counts,
                number=clusters[-1].last,
                explain=explain,
            ),
            model="beam",
            row=row or name,
            section=SECTION,
            group=f"benchmark.{name}",
            effort=1.0 / len(clusters),
        )
        for cluster in clusters
    ]


def _frequency(
    context: Context,
    name: str,
    title: str,
    build: Callable[[int], Frame],
    cluster: Cluster,
    counts: tuple[int, ...],
    number: int,
    explain: Callable[[Cluster], tuple[Allowance, ...]],
) -> Measurement:
    found = context.get(refined_frequencies, build, counts, number)
    own = cluster.of(found)
    values = own[:, cluster.worst(own[-1])]
    convergence = analyse(1.0 / np.array(counts, dtype=float), values, BEAM_ORDER, round_off=1e-9)
    return Measurement(
        float(values[-1]),
        cluster.target,
        value_uncertainty=uncertainty_of(convergence),
        allowances=explain(cluster),
        table=cluster.table(own[-1]),
        studies=(cluster_study(name, title, cluster, convergence, "elements per member"),),
    )


def refinement_study(
    benchmark: str,
    title: str,
    label: str,
    curve: str,
    quantity: str,
    unit: str,
    convergence: Convergence,
    x_label: str,
) -> Study:
    """One refined number of a benchmark (by id and title), its sizes inverse numbers of elements.

    `label` and `curve` name the number in the study's id and in its plot.
    """
    order, limit = convergence.observed_order, convergence.extrapolated
    return Study(
        id=f"benchmark.{benchmark}.{label}",
        kind="convergence",
        title=f"{title}: {curve}",
        x_label=x_label,
        y_label=quantity,
        unit=unit,
        x=tuple((1.0 / convergence.sizes).tolist()),
        series={curve: tuple(convergence.values.tolist())},
        formal_order=convergence.formal_order,
        orders={} if order is None else {curve: order},
        uncertainties={curve: uncertainty_of(convergence)},
        limits={} if limit is None else {curve: limit},
        notes=(convergence.refusal,) if convergence.refusal else (),
        family=f"benchmark.{benchmark}",
        family_title=title,
    )


def cluster_study(
    name: str, title: str, cluster: Cluster, convergence: Convergence, x_label: str
) -> Study:
    """The refinement of a cluster's worst mode (Hz)."""
    return refinement_study(
        name,
        title,
        cluster.label,
        cluster.meaning,
        "natural frequency",
        "Hz",
        convergence,
        x_label,
    )


straight_cantilevers = CaseGroup(
    over={"name, component, target, quantity": MACNEAL_TARGETS},
    unit=lambda name: "rad" if name == "twist" else "m",
    reference_kind=lambda name: "closed-form" if name == "twist" else "published",
    citation=MACNEAL_HARDER,
    tolerance=TOLERANCE,
    model="beam",
    row="{name}",
    section=SECTION,
    group="benchmark.macneal-harder",
)


@straight_cantilevers.case(
    "benchmark.macneal-harder.beam[{name}]",
    "MacNeal–Harder cantilever by a Timoshenko beam: {name}",
    tolerance_reason="0.1 % of the theory column, which has four digits; the beam is exact",
)
def _macneal(_context: Context, name: str, component: int, target: float) -> Measurement:
    wrench = np.zeros((12, 1))
    wrench[6 + component] = 1.0
    found = displacements(assemble(straight_cantilever()), wrench)
    notes = (TWIST_NOTE,) if name == "twist" else ()
    return Measurement(float(found[6 + component, 0]), target, exact=True, notes=notes)
