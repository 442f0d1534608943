"""Each leg as a 3-D solid against beam theory, every difference with its named cause."""

from functools import partial

import numpy as np

from fem.bodies.beam_theory import CantileverFrequency, cantilever_frequencies
from fem.bodies.solid import Ends
from fem.sections import nonuniform_torsion
from fem.sections.section_constants import SectionConstants, beam_properties, section_constants
from fem.sections.waveguide import torsion_wave
from lumped.arrays import Array
from lumped.legs import BeamProperties, ConstantLeg, tip_compliance
from meshes.section.section_mesh import section_mesh
from validation.case import Absolute, Allowance, Case, Measurement, Relative, Skip
from validation.cases.legs import (
    ENTRIES,
    HUANG,
    MODES,
    TIMOSHENKO,
    UNITS,
    constant_leg_of,
    exact_compliance,
    exact_modes,
)
from validation.context import Context, Preset
from validation.exhibits import Study
from validation.leg_solids import (
    FORMAL_ORDER,
    GRIDS_FOR_ORDER,
    Refinement,
    SolidModes,
    dynamic_ladder,
    section_counts,
    solid_compliances,
    solid_frequencies,
    static_ladder,
)

# Unknowns of the largest section mesh for statics by doubling, and of the largest solid for modes.
STATICS: dict[Preset, int] = {"quick": 1000, "standard": 2000, "fine": 4000}
DYNAMICS: dict[Preset, int] = {"quick": 9_000, "standard": 30_000, "fine": 100_000}
# Section constants are to be exact beside the solids' meshes, the waves need dense matrices.
SECTION_DIVISIONS, WAVE_DIVISIONS = 16, 4
# Relative tolerances of compliances: what the meshes leave.
_TORSION, _BENDING = 1e-3, 2e-4
# Wave length of the shortest mode, in section heights, that beam theory is held to.
SHORTEST_WAVE = 3.0


def cases() -> tuple[Case, ...]:
    """Compliances, frequencies and orders of convergence of both legs as solids."""
    return tuple(
        case
        for number in (1, 2)
        for case in (*_compliances(number), *_frequencies(number), *_orders(number))
    )


def _compliances(number: int) -> list[Case]:
    return [
        Case(
            id=f"leg{number}.compliance.solid[{name}]",
            title=f"Leg {number}: {name} of the solid is the Timoshenko cantilever's",
            quantity=f"compliance {name}, {meaning}",
            unit=UNITS[(i > 2, j > 2)],
            reference_kind="closed-form",
            citation=TIMOSHENKO,
            tolerance=Relative(_TORSION if name == "c44" else _BENDING),
            tolerance_reason="beam theory is exact for ends free to warp, rigid end faces are "
            "allowed for by their own effect; what is left is the mesh: "
            + ("0.1 % in torsion, order 3.4" if name == "c44" else "0.02 %"),
            compute=partial(_entry, number=number, entry=(i, j)),
            model="solid",
            row=f"leg {number}",
            section=f"Leg {number}",
            group=f"leg{number}.solid",
            effort=0.5,
        )
        for name, (i, j, meaning) in ENTRIES.items()
    ]


def _frequencies(number: int) -> list[Case]:
    return [
        Case(
            id=f"leg{number}.frequency.solid[{index + 1}]",
            title=f"Leg {number}: frequency {index + 1} of the solid is the Timoshenko beam's",
            quantity=f"natural frequency {index + 1}, clamped-free",
            unit="Hz",
            reference_kind="closed-form",
            citation=HUANG,
            tolerance=Relative(0.01),
            tolerance_reason="Timoshenko's theory is approximate in dynamics: below 1 % while "
            "the wave is longer than three section heights",
            compute=partial(_mode, number=number, index=index),
            model="solid",
            row=f"leg {number}",
            section=f"Leg {number}",
            group=f"leg{number}.modes",
            effort=2.0,
        )
        for index in range(MODES)
    ]


def _orders(number: int) -> list[Case]:
    return [
        Case(
            id=f"refinement.leg{number}.solid.order[{name}]",
            title=f"Leg {number}, quadratic solid: {name} converges with the order of energies",
            quantity="fitted order in the divisions of the section",
            unit="1",
            reference_kind="closed-form",
            citation="twice the order of the gradients: h⁴ for smooth solutions. For ν > 0 ends "
            "are free: held against contraction the edges of a rigid face have singular stresses "
            "(M. L. Williams, J. Appl. Mech. 19 (1952) 526), which leave order 1.5 to 2",
            tolerance=Absolute(1.0),
            tolerance_reason="edges of rigid end faces lower the order locally, coarse meshes "
            "raise it: between 3 and 5 the extrapolation holds within the safety factor",
            compute=partial(_order, number=number, name=name),
            model="solid",
            row=f"leg {number}, {name}",
            section="Refinement",
            group=f"leg{number}.solid",
            effort=0.5,
        )
        for name in ("c22", "c44")
    ]


def compliances(context: Context, number: int, ends: Ends) -> Refinement:
    """Tip compliances of leg 1 or 2 on the preset's meshes."""
    leg = constant_leg_of(context, number)
    divisions = context.get(static_ladder, leg, STATICS[context.preset])
    _require(divisions, STATICS, context.preset, "section meshes")
    return context.get(solid_compliances, leg, divisions)[ends]


def frequencies(context: Context, number: int, ends: Ends) -> SolidModes:
    """Frequencies of leg 1 or 2 on the preset's meshes."""
    leg = constant_leg_of(context, number)
    divisions = context.get(dynamic_ladder, leg, DYNAMICS[context.preset])
    _require(divisions, DYNAMICS, context.preset, "solid meshes")
    return context.get(solid_frequencies, leg, divisions, ends, MODES)


def _require(
    divisions: tuple[int, ...], limits: dict[Preset, int], preset: Preset, what: str
) -> None:
    if not divisions:
        raise Skip(
            f"two {what} of this section have more than {limits[preset]} unknowns, too many for "
            f"preset {preset}; a larger preset may compute it"
        )


def own_constants(leg: ConstantLeg, divisions: int = SECTION_DIVISIONS) -> SectionConstants:
    """Section constants of a leg by finite elements, free of thin-wall assumptions."""
    mesh = section_mesh(leg.section, section_counts(leg, divisions))
    return section_constants(mesh, leg.material.nu, leg.material.G / leg.material.E)


def own_beam(leg: ConstantLeg, divisions: int = SECTION_DIVISIONS) -> BeamProperties:
    """Timoshenko beam of the section's own constants."""
    return beam_properties(own_constants(leg, divisions), leg.material)


def _own_compliances(leg: ConstantLeg, divisions: tuple[int, ...]) -> Array:
    """Tip compliances (m×6×6) of the beam, section constants on each of the solids' meshes."""
    return np.array([tip_compliance(own_beam(leg, number), leg.length) for number in divisions])


def _own_frequencies(leg: ConstantLeg, divisions: tuple[int, ...], part: str, order: int) -> Array:
    """One frequency (Hz, m values) of the beam, section constants on each of the solids' meshes."""
    beams = (own_beam(leg, number) for number in divisions)
    modes = (cantilever_frequencies(beam, leg.length, 2 * MODES) for beam in beams)
    return np.array([_frequency_of(found, part, order) for found in modes])


def _frequency_of(modes: tuple[CantileverFrequency, ...], part: str, order: int) -> float:
    return next(float(m.frequency) for m in modes if (m.part, m.order) == (part, order))


def _entry(context: Context, number: int, entry: tuple[int, int]) -> Measurement:
    leg = constant_leg_of(context, number)
    rigid, free = (compliances(context, number, ends) for ends in ("rigid", "free"))
    textbook = float(context.get(exact_compliance, leg)[entry])
    own = context.get(_own_compliances, leg, rigid.divisions)
    value = float(rigid.values[-1][entry])
    # Causes are measured on one mesh, so that its errors cancel: what is left, and what the
    # numerical uncertainty is about, is the free solid less the beam of the same section mesh.
    left = Refinement(rigid.divisions, free.values - own)
    _require_decided(left, entry, textbook, context.preset)
    return Measurement(
        value,
        textbook,
        value_uncertainty=left.uncertainty(*entry),
        allowances=(
            _textbook(float(own[-1][entry]) - textbook),
            _restraint(value - float(free.values[-1][entry])),
        ),
        notes=(
            f"rigid end faces change it by {_percent(value, float(free.values[-1][entry]))}; "
            f"mesh uncertainty with them {_percent(rigid.uncertainty(*entry) + value, value)}",
        ),
    )


def _require_decided(
    left: Refinement, entry: tuple[int, int], reference: float, preset: Preset
) -> None:
    """Raise Skip where too few meshes for an order, three times their step, cannot decide."""
    tolerance = (_TORSION if entry == (3, 3) else _BENDING) * abs(reference)
    uncertainty = left.uncertainty(*entry)
    undecided = abs(left.values[-1][entry]) <= tolerance < uncertainty
    if undecided and len(left.divisions) < GRIDS_FOR_ORDER:
        raise Skip(
            f"{len(left.divisions)} meshes of this section are affordable in preset {preset}: they "
            f"show no order, and their uncertainty of {100.0 * uncertainty / abs(reference):.2g} % "
            "exceeds the tolerance; a larger preset may decide"
        )


def _percent(changed: float, base: float) -> str:
    return f"{100.0 * (changed / base - 1.0):+.3g} %"


def _mode(context: Context, number: int, index: int) -> Measurement:
    leg = constant_leg_of(context, number)
    exact = context.get(exact_modes, leg)[index]
    width, height = leg.section.extent
    depth = {"bending y": height, "bending z": width}.get(exact.part, max(width, height))
    heights = 4.0 * leg.length / (2 * exact.order - 1) / depth
    if heights < SHORTEST_WAVE:
        raise Skip(
            f"{exact.part}, number {exact.order} of its kind: its wave is {heights:.1f} section "
            f"heights long, below {SHORTEST_WAVE:g} no beam theory is meant to hold"
        )
    rigid, free = (frequencies(context, number, ends) for ends in ("rigid", "free"))
    divisions = rigid.frequencies.divisions
    on_meshes = context.get(_own_frequencies, leg, divisions, exact.part, exact.order)
    own = float(on_meshes[-1])
    # As for compliances: free solid and beam have the errors of one section mesh in common.
    left = Refinement(divisions, free.frequencies.values[:, index] - on_meshes)
    value, textbook = float(rigid.frequencies.values[-1, index]), float(exact.frequency)
    allowances = [
        _textbook(own - textbook),
        _restraint(value - float(free.frequencies.values[-1, index])),
    ]
    if exact.part == "torsion":
        allowances += context.get(_warping_waves, leg, exact.order, own)
    return Measurement(
        value,
        textbook,
        value_uncertainty=left.uncertainty(),
        allowances=tuple(allowances),
        notes=(
            f"{exact.part}, number {exact.order} of its kind; MAC with the beam's mode "
            f"{rigid.mac[-1, index]:.4f}; mesh uncertainty with rigid end faces "
            f"{_percent(rigid.frequencies.uncertainty(index) + value, value)}",
        ),
    )


def _textbook(amount: float) -> Allowance:
    return Allowance(
        cause="textbook section constants (thin walls, Cowper's shear)",
        amount=amount,
        source="fem.sections.section_constants on the solid's section mesh",
    )


def _restraint(amount: float) -> Allowance:
    return Allowance(
        cause="end faces kept plane and rigid: warping and contraction restrained",
        amount=amount,
        source="same mesh with ends free to warp (Saint-Venant tractions)",
    )


def _warping_waves(leg: ConstantLeg, order: int, saint_venant: float) -> list[Allowance]:
    """What warping along the leg does to its torsional frequency `saint_venant` (Hz)."""
    wave_number = (2 * order - 1) * np.pi / (2.0 * leg.length)
    constants = own_constants(leg)
    section = section_mesh(leg.section, section_counts(leg, WAVE_DIVISIONS))
    endless = torsion_wave(section, leg.material, wave_number) / (2.0 * np.pi)
    relaxed = float(
        nonuniform_torsion.cantilever_frequencies(constants, leg.material, leg.length, order)[-1]
    )
    relaxation = relaxed / nonuniform_torsion.wave_frequency(constants, leg.material, wave_number)
    return [
        Allowance(
            cause="stiffness and inertia of warping along the torsional wave",
            amount=endless - saint_venant,
            source="3-D wave of the same length in an endless leg (fem.sections.waveguide)",
        ),
        Allowance(
            cause="tip face free of the wave's normal stress",
            amount=endless * (relaxation - 1.0),
            source="Reissner's torsion, cantilever over endless rod (nonuniform_torsion)",
        ),
    ]


def _order(context: Context, number: int, name: str) -> Measurement:
    contracts = constant_leg_of(context, number).material.nu > 0.0
    found = compliances(context, number, "free" if contracts else "rigid")
    if len(found.divisions) < GRIDS_FOR_ORDER:
        raise Skip(
            f"{len(found.divisions)} meshes of this section are affordable in preset "
            f"{context.preset}, an order takes {GRIDS_FOR_ORDER}"
        )
    i, j, meaning = ENTRIES[name]
    convergence = found.at(i, j)
    order = convergence.observed_order
    uncertainty, limit = convergence.uncertainty, convergence.extrapolated
    notes = (convergence.refusal,) if convergence.refusal else ()
    study = Study(
        id=f"refinement.leg{number}.solid.{name}",
        kind="convergence",
        title=f"Leg {number} as a solid: {name}, {meaning}",
        x_label="quadratic elements across the section",
        y_label=f"{name} ({UNITS[(i > 2, j > 2)]})",
        unit=UNITS[(i > 2, j > 2)],
        x=tuple(float(n) for n in found.divisions),
        series={name: tuple(found.values[:, i, j].tolist())},
        formal_order=FORMAL_ORDER,
        orders={} if order is None else {name: order},
        uncertainties={} if uncertainty is None else {name: uncertainty},
        limits={} if limit is None else {name: limit},
        notes=notes,
    )
    return Measurement(
        float("nan") if order is None else order, FORMAL_ORDER, notes=notes, studies=(study,)
    )
