"""Cases and studies on the convergence of a solid leg with its mesh, for free and rigid ends.

Input: a leg of constant section with its root clamped. Output: verdicts on observed orders, on
half-widths, and on the agreement of hexahedra with tetrahedra. Rule: tip compliances by the
doubling method (`fem.bodies.doubling`) have many cheap meshes and show orders. Frequencies have few
meshes; their half-width must be at most 1 %, and tetrahedra must give the same f1 within the
half-widths. CPU times are shown and affect no verdict.
"""

from collections.abc import Sequence
from math import inf
from time import process_time

import numpy as np

from fem.bodies.solid import clamped_leg, solid_leg
from lumped.arrays import Array
from lumped.legs import ConstantLeg
from lumped.model_choices import Ends
from lumped.sections import Rectangle
from lumped.text import counted
from meshes.prism import tetrahedra
from validation.case import Absolute, Measurement, Relation, Skip
from validation.case_group import CaseGroup
from validation.cases.leg_theory import ENTRIES, beam_mode_count, compliances, frequencies
from validation.context import Context
from validation.models.leg_models import constant_leg_of
from validation.solids.leg_meshes import doubled_unknowns, formal_order
from validation.solids.solid_legs import GRIDS_FOR_ORDER, ROUND_OFF, Refinement, SolidModes
from validation.studies_and_figures import MESHES, Study
from validation.uncertainty.grid_convergence import Convergence, richardson

END_NAMES: dict[Ends, str] = {"free": "free", "rigid": "held"}
# Tetrahedra across the smaller side of a rectangular section, on two meshes.
TETRAHEDRA = (1, 2)
_CPU = "CPU time"

cases = CaseGroup(
    over={"body": lambda legs: legs},
    kind="convergence",
    reference_kind="finer-model",
    section=MESHES,
    subject="leg",
    model="solid",
    unit="1",
    effort=0.2,
)


@cases.case(
    "refinement.{body}.solid.order[{name}]",
    "{body} as a solid with free ends: {name} converges with the order of strain energies",
    over={"name, ends, tolerance": [(name, "free", Absolute(1.0)) for name in ("c22", "c44")]},
    quantity="fitted order in the divisions of the section",
    citation=(
        "strain energies converge with twice the order of the gradients: h⁴ for smooth solutions"
    ),
    tolerance_reason=(
        "coarse meshes have a lower order in torsion, 3.4; from 3 to 5 the extrapolation "
        "holds within the safety factor"
    ),
    group="{body}.solid",
)
@cases.case(
    "refinement.{body}.solid-held.order[{name}]",
    "{body} as a solid with held ends: {name} converges with the order of the edge singularity",
    over={"name, ends, tolerance": [("c22", "rigid", Absolute(0.5))]},
    quantity="fitted order in the divisions of the section",
    citation=(
        "singular stresses r^(λ − 1) at the edges of a rigid face reduce the order to 2λ (M. "
        "L. Williams, J. Appl. Mech. 19 (1952) 526)"
    ),
    tolerance_reason=(
        "on coarse meshes smooth fourth-order errors mix with those of the singularity: 1.1 "
        "to 1.7 times 1.42 for ν = 0.3"
    ),
    group="{body}.solid",
)
def _order(context: Context, body: str, name: str, ends: Ends) -> Measurement:
    leg = constant_leg_of(context, body)
    refinement = compliances(context, body, ends)
    divisions = refinement.divisions
    if len(divisions) < GRIDS_FOR_ORDER:
        meshes = counted(len(divisions), "mesh", "meshes")
        raise Skip(
            f"preset {context.preset} allows {meshes} of the section of {body}; an "
            f"order of convergence needs {GRIDS_FOR_ORDER} meshes"
        )
    entry, meaning, unit = ENTRIES[name]
    convergence = refinement.at(*entry)
    notes = (convergence.refusal,) if convergence.refusal else ()
    study = _study(
        body,
        f"{name}.hexahedra.{END_NAMES[ends]}",
        (meaning, f"{name} ({unit})", unit),
        f"hexahedra, {END_NAMES[ends]} ends",
        [doubled_unknowns(leg, number) for number in divisions],
        convergence.values,
        refinement.formal_order,
        convergence,
        notes,
    )
    order = convergence.observed_order
    if order is None:
        # The order of the last three meshes (NaN if values do not converge) gets an infinite
        # uncertainty, so that the verdict is undecided.
        last = float(convergence.orders[-1])
        return Measurement(
            last, refinement.formal_order, value_uncertainty=inf, notes=notes, studies=(study,)
        )
    return Measurement(
        order,
        refinement.formal_order,
        # Change of the order due to the finest mesh, plus round-off of the last difference.
        value_uncertainty=float(
            abs(convergence.orders[-1] - convergence.orders[-2])
            + ROUND_OFF * abs(convergence.values[-1] / np.diff(convergence.values)[-1])
        ),
        notes=notes,
        studies=(study,),
    )


@cases.case(
    "{body}.converged[solid-{condition}-half-width]",
    "{body} as a solid with {condition} ends: each uncertainty interval contains the "
    "value on the next finer mesh",
    over={"ends, condition": list(END_NAMES.items())},
    quantity=(
        "largest change on the next finer mesh divided by the half-width, all displacements "
        "of the tip"
    ),
    label="solid, {condition} ends: change over half-width",
    citation="next finer mesh of the same leg",
    relation=Relation.AT_MOST,
    tolerance=Absolute(1e-9),
    tolerance_reason="the half-width includes round-off",
    group="{body}.solid",
)
def _half_width(context: Context, body: str, ends: Ends) -> Measurement:
    refinement = compliances(context, body, ends)
    shares = half_width_shares(refinement)
    if not len(shares):
        raise Skip(
            f"preset {context.preset} allows two meshes of this section, and a half-width is "
            "compared with the change to a third one; use a finer preset"
        )
    return Measurement(float(shares.max()), 1.0, exact=True)


def half_width_shares(refinement: Refinement) -> Array:
    """Changes of the diagonal tip compliances to the next finer mesh, divided by their half-widths.

    The result is (m−2)×6 for the m meshes of `refinement`: one row for each mesh except the first,
    which has no coarser mesh, and the last. The half-width of a mesh follows from this mesh and the
    coarser ones. A value above 1 shows that a half-width is too small.
    """
    rows = []
    for count in range(2, len(refinement.divisions)):
        coarse = _first(refinement, count)
        diagonal = range(refinement.values.shape[-1])
        widths = np.array([coarse.uncertainty(k, k) for k in diagonal])
        values, finer = (np.diag(refinement.values[mesh]) for mesh in (count - 1, count))
        rows.append(np.abs(finer - values) / (widths + ROUND_OFF * np.abs(values)))
    return np.array(rows)


def _first(refinement: Refinement, count: int) -> Refinement:
    free = None if refinement.free is None else _first(refinement.free, count)
    values = refinement.values[:count]
    return Refinement(refinement.divisions[:count], values, refinement.formal_order, free)


@cases.case(
    "{body}.converged[solid-{condition}-f1]",
    "{body} as a solid with {condition} ends: the half-width of f1 is at most 1 %",
    over={"ends, condition": list(END_NAMES.items())},
    quantity="relative half-width of f1 on the finest mesh",
    label="solid, {condition} ends: half-width of f1",
    citation="meshes of the preset",
    relation=Relation.AT_MOST,
    tolerance=Absolute(1e-4),
    tolerance_reason="a hundredth of the limit",
    group="{body}.modes",
)
def _first_frequency(context: Context, body: str, ends: Ends, condition: str) -> Measurement:
    leg = constant_leg_of(context, body)
    modes = frequencies(context, body, ends, beam_mode_count(context, leg))
    refinement = modes.frequencies
    order, convergence = refinement.formal_order, _convergence(refinement)
    width = refinement.uncertainty(0) / float(refinement.values[-1, 0])
    # A mesh that is too coarse is not a disagreement: the excess over the limit counts as
    # uncertainty.
    return Measurement(
        width,
        0.01,
        judged_uncertainty=max(width - 0.01, 0.0),
        studies=_f1_studies(body, "hexahedra", condition, modes, order, convergence),
        decides="use a finer preset",
    )


@cases.case(
    "{body}.converged[tetrahedra-{condition}-f1]",
    "{body} with {condition} ends: f1 by tetrahedra equals f1 by hexahedra within their "
    "half-widths",
    over={"ends, condition": list(END_NAMES.items())},
    quantity="difference over the sum of both half-widths",
    label="tetrahedra, {condition} ends: difference over half-widths",
    citation="quadratic hexahedra",
    relation=Relation.AT_MOST,
    tolerance=Absolute(1e-9),
    tolerance_reason="each uncertainty interval contains the common limit",
    group="{body}.modes",
)
def _tetrahedra(context: Context, body: str, ends: Ends, condition: str) -> Measurement:
    leg = constant_leg_of(context, body)
    if not isinstance(leg.section, Rectangle):
        raise Skip(f"{leg.section.shape}: only solid rectangles are meshed with tetrahedra")
    hexahedral = frequencies(context, body, ends, beam_mode_count(context, leg)).frequencies
    meshes = context.get(tetrahedral_modes, leg)[ends]
    tetrahedral = meshes.frequencies
    limit = _convergence(hexahedral).extrapolated
    width = tetrahedral.uncertainty(0)
    # Unstructured meshes are not geometrically similar and have no extrapolated limit: errors are
    # relative to the limit of the hexahedra.
    convergence = Convergence(tetrahedral.values[:, 0], np.array([]), None, limit, width)
    order = hexahedral.formal_order
    studies = _f1_studies(body, "tetrahedra", condition, meshes, order, convergence)
    difference = abs(float(tetrahedral.values[-1, 0]) - float(hexahedral.values[-1, 0]))
    both = width + hexahedral.uncertainty(0)
    return Measurement(difference / both, 1.0, exact=True, studies=studies)


def tetrahedral_modes(leg: ConstantLeg) -> dict[Ends, SolidModes]:
    """First frequency of the leg on the meshes `TETRAHEDRA`, by end condition.

    The MAC with the beam's modes is not computed and is NaN.
    """
    rows_by_ends: dict[Ends, list[tuple[float, int, float]]] = {ends: [] for ends in END_NAMES}
    for number in TETRAHEDRA:
        start = process_time()
        solid = solid_leg(leg, tetrahedra(leg.section, leg.length, number))
        shared = process_time() - start
        for ends, rows in rows_by_ends.items():
            start = process_time()
            frequency = float(clamped_leg(solid, ends).modes(1).frequencies[0])
            rows.append((frequency, solid.mesh.nodes.size, shared + process_time() - start))
    return {
        ends: _solid_modes(rows, formal_order(leg, ends)) for ends, rows in rows_by_ends.items()
    }


def _solid_modes(rows: Sequence[tuple[float, int, float]], order: float) -> SolidModes:
    frequencies, unknowns, seconds = zip(*rows, strict=True)
    values = np.array(frequencies)[:, None]
    # Unstructured meshes are not similar: twice the divisions are not half the element size, which
    # is the cube root of the volume over the number of elements (Celik et al., J. Fluids Eng. 130
    # (2008) 078001).
    sizes = tuple(count ** (-1.0 / 3.0) for count in unknowns)
    refinement = Refinement(TETRAHEDRA, values, order, sizes=sizes)
    return SolidModes(refinement, np.full(values.shape, np.nan), unknowns, seconds)


def _convergence(refinement: Refinement) -> Convergence:
    """Convergence of the first quantity of a refinement.

    If there are too few meshes to observe an order, the limit is extrapolated with the formal one.
    """
    if len(refinement.divisions) >= GRIDS_FOR_ORDER:
        return refinement.at(0)
    values = refinement.values[:, 0]
    ratio = refinement.divisions[-1] / refinement.divisions[-2]
    limit = richardson(values[-2], values[-1], ratio, refinement.formal_order)
    return Convergence(values, np.array([]), None, limit, refinement.uncertainty(0))


def _study(
    body: str,
    name: str,
    panel: tuple[str, str, str],
    variant: str,
    unknowns: Sequence[int],
    values: Array,
    order: float,
    convergence: Convergence,
    notes: tuple[str, ...] = (),
) -> Study:
    """Study of `values` over the number of `unknowns` of the meshes, for the report.

    `body` is the name of the leg, `name` the last part of the study's id. `panel`: title of the
    panel, label of the y axis and unit. `variant`: text on the element type and end condition.
    `order`: formal order.
    """
    title, label, unit = panel
    observed = convergence.observed_order
    width, limit = convergence.uncertainty, convergence.extrapolated
    return Study(
        id=f"convergence.{body}.solid.{name}",
        title=f"{body} as a solid, {variant}: {title}",
        x_label="unknowns",
        y_label=label,
        unit=unit,
        x=tuple(map(float, unknowns)),
        series={variant: tuple(values.tolist())},
        formal_order=order,
        orders={} if observed is None else {variant: observed},
        uncertainties={} if width is None else {variant: width},
        limits={} if limit is None else {variant: limit},
        notes=notes,
        family=f"convergence.{body}.solid",
        family_title=f"{body}: convergence with mesh",
        variant=variant,
        panel=title,
    )


def _f1_studies(
    body: str,
    elements: str,
    condition: str,
    modes: SolidModes,
    order: float,
    convergence: Convergence,
) -> tuple[Study, Study]:
    """Studies of f1 and of the CPU time over the unknowns of the meshes."""
    variant, values = f"{elements}, {condition} ends", modes.frequencies.values[:, 0]
    name, panel = f"f1.{elements}.{condition}", ("f1", "f1 (Hz)", "Hz")
    cost = Study(
        id=f"convergence.{body}.solid.seconds.{elements}.{condition}",
        title=f"{body} as a solid, {variant}: {_CPU}",
        x_label="unknowns",
        y_label=f"{_CPU} (s)",
        unit="s",
        x=tuple(map(float, modes.unknowns)),
        series={variant: modes.seconds},
        family=f"convergence.{body}.solid",
        family_title=f"{body}: convergence with mesh",
        variant=variant,
        panel=_CPU,
    )
    return _study(body, name, panel, variant, modes.unknowns, values, order, convergence), cost
