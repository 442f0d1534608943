"""Modes of a mechanism of solids: of legs against beams and waves, of CAD parts reduced twice.

What Timoshenko's theory is worth in dynamics, waves along legs with ends free to warp say from
their sections alone; with that, beams of the solids' own constants are one with them to a
thousandth. Parts are reduced by their modes with interfaces held (Craig, Bampton), and free
(MacNeal, Rubin), which span different spaces; what each has dropped is bounded by itself.
"""

from dataclasses import dataclass

import numpy as np

from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Ends
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.system.assembly import assembly
from meshes.section.section_blocks import WALL_ASPECT
from validation.adequacy.mechanism.parts import bounded_frequencies
from validation.adequacy.mechanism.path import (
    RobotReading,
    known_legs,
    offered,
    path_postures,
    robot_on_path,
)
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.vibration import (
    LegMesh,
    SolidMeshes,
    solid_meshes,
    solid_vibration,
    vibration_of,
)
from validation.adequacy.partners import partners
from validation.agreement.convergence import step_factor
from validation.case import Allowance, Measurement, Relative, Skip
from validation.case_group import CaseGroup, numbered
from validation.cases.leg_waves import NO_WAVES, WAVES, WAVES_SOURCE, wave_changes, waves_of
from validation.context import Context
from validation.exhibits import PATH
from validation.models.legs import filled
from validation.models.mechanism import (
    CUTOFF,
    JUDGED_MODES,
    highest_frequency,
    modes_along,
)
from validation.parts.meshes import COARSE
from validation.solids.legs import (
    ELEMENTS,
    FORMAL_ORDER,
    SHARED_SOLIDS,
    decay_of_warping,
    own_beam,
)
from validation.solids.size import too_large

MODES = 6
# Of a leg's length: what reaches no farther is an effect of its ends.
_SHORT = 0.1


@dataclass(frozen=True, eq=False)
class FreeModes:
    """The first modes (k) of beams of their own constants in one posture, and of solids.

    Frequencies (Hz) `beams`, `solids` of the same shapes, relative `changes` of those of beams by
    the waves in the legs, and `likeness` of the shapes, of close modes as a space.
    """

    beams: Array
    solids: Array
    changes: Array
    likeness: Array


cases = CaseGroup(
    reference_kind="independent-solver", model="solid", section=PATH, unit="Hz", effort=5.0
)


def free_modes(postures: tuple[Posture, ...], mesh: LegMesh, count: int) -> FreeModes:
    """Beams and solids of one section mesh in the only one of `postures`."""
    mechanism = postures[0].mechanism
    legs = {
        name: leg for name, leg in known_legs(mechanism).items() if isinstance(leg, ConstantLeg)
    }
    numbers = {name: mesh.divisions(leg) for name, leg in legs.items()}
    samples = samples_of(mechanism)
    highest = highest_frequency(postures, count)
    alike = {leg: own_beam(leg, numbers[name]) for name, leg in legs.items()}
    reduced = {
        leg: craig_bampton(held_leg(beam), highest, CUTOFF["beam"] * highest)
        for leg, beam in alike.items()
    }
    beams = {name: filled(reduced[leg].matrices) for name, leg in legs.items()}
    own = vibration_of(samples, modes_along(assembly(mechanism, beams), postures, count), count)
    free: dict[str, Ends] = dict.fromkeys(legs, "free")
    solids = solid_vibration(postures, RobotReading(free), mesh, count)
    found = partners(own, solids, MODES)
    changes = wave_changes(
        postures,
        {name: reduced[leg] for name, leg in legs.items()},
        {name: alike[leg] for name, leg in legs.items()},
        waves_of(legs, numbers),
        elements=ELEMENTS,
        offered=count,
        count=MODES,
    )
    return FreeModes(own.frequencies[0, :MODES], found.frequency[0], changes[0], found.likeness[0])


def _meshes(context: Context) -> tuple[tuple[Posture, ...], SolidMeshes, float]:
    """The middle posture, two meshes of its legs and their ratio; raises Skip without waves."""
    postures = path_postures(context)
    middle = (postures[len(postures) // 2],)
    mechanism = middle[0].mechanism
    legs = list(known_legs(mechanism).values())
    prisms = [leg for leg in legs if isinstance(leg, ConstantLeg)]
    if mechanism.parts or not prisms or len(prisms) < len(legs):
        raise Skip("not all of its legs are prisms, whose waves are known")
    meshes = solid_meshes(context.preset)
    numbers = [meshes.fine.divisions(leg) for leg in prisms]
    if reason := too_large(prisms, numbers, context.preset):
        raise Skip(reason)
    for leg, number in zip(prisms, numbers, strict=True):
        if decay_of_warping(leg, number) > _SHORT * leg.length:
            raise Skip(
                f"{leg.name}: warping of its open section reaches over more than a tenth of its "
                "length, where the theory of beams without warping does not hold"
            )
        smaller, larger = sorted(leg.section.extent)
        if larger > max(WALL_ASPECT * smaller, _SHORT * leg.length):
            raise Skip(
                f"{leg.name}: a strip, wider than a tenth of its length, bends as a plate near its "
                "ends, which the waves of beams leave out (1 % of two leaves a third as wide as "
                "long)"
            )
    return middle, meshes, meshes.ratio(prisms)


@cases.case(
    "mechanism.solid.frequency[{mode}]",
    "Frequency {mode} of solids with free ends is that of beams and of the waves in them",
    over={"index, mode": numbered(MODES)},
    quantity="natural frequency {mode}, middle of the path, paired by shape",
    citation="20 Timoshenko beam elements per leg, constants of the solids' own section meshes",
    group=SHARED_SOLIDS,
    figure="mechanism.mode-shapes",
    tolerance=Relative(1e-3),
    tolerance_reason="what waves of 3-D elasticity say of beam theory is allowed for: what is left "
    "has no name",
)
def _frequency(context: Context, index: int) -> Measurement:
    middle, meshes, ratio = _meshes(context)
    count = offered(MODES)
    rougher, found = (context.get(free_modes, middle, mesh, count) for mesh in meshes)
    factor = step_factor(ratio, FORMAL_ORDER)
    change = float(found.changes[index])
    if not np.isfinite(change):
        raise Skip(NO_WAVES)
    value, reference = float(found.solids[index]), float(found.beams[index])
    left, rougher_left = (
        one.solids[index] - one.beams[index] * (1.0 + one.changes[index])
        for one in (found, rougher)
    )
    return Measurement(
        value,
        reference,
        value_uncertainty=float(factor * abs(value - rougher.solids[index])),
        reference_uncertainty=float(factor * abs(reference - rougher.beams[index])),
        # Constants, waves and solids have the errors of one section mesh in common.
        judged_uncertainty=float(factor * abs(left - rougher_left)),
        allowances=(Allowance(WAVES, change * reference, WAVES_SOURCE),),
        table=_table(found),
    )


def _table(found: FreeModes) -> dict[str, tuple[float | str, ...]]:
    apart = found.solids / found.beams - 1.0
    columns = {
        "mode": np.arange(1.0, MODES + 1.0),
        "beams (Hz)": found.beams,
        "solids (Hz)": found.solids,
        "solids off beams (%)": 100.0 * apart,
        "by waves in the legs (%)": 100.0 * found.changes,
        "left (%)": 100.0 * (apart - found.changes),
        "MAC": found.likeness,
    }
    return {heading: tuple(column.tolist()) for heading, column in columns.items()}


def _of_parts(mechanism: Mechanism) -> tuple[tuple[int, int], ...]:
    return numbered(JUDGED_MODES) if mechanism.parts else ()


@cases.case(
    "mechanism.parts.frequency[{mode}]",
    "Frequency {mode} with parts by their free modes is that with their held ones",
    over={"index, mode": _of_parts},
    quantity="natural frequency {mode}, middle of the path, coarsest mesh of the parts",
    citation="the same meshes reduced by Craig and Bampton",
    group="mechanism.parts",
    tolerance=Relative(1e-5),
    tolerance_reason="what each reduction may be too high by its own bound says, 3e-7 and less",
)
def _part_frequency(context: Context, index: int) -> Measurement:
    robot = robot_on_path(context)
    at = robot.postures, robot.offered, robot.holding.first
    free, held = (
        context.get(bounded_frequencies, *at, JUDGED_MODES, COARSE, by) for by in ("free", "fixed")
    )
    return Measurement(
        float(free.upper[index]),
        float(held.upper[index]),
        value_uncertainty=float(free.upper[index] - free.lower[index]),
        reference_uncertainty=float(held.upper[index] - held.lower[index]),
    )
