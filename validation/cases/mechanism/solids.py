"""Modes of a mechanism with solid legs, ends free to warp, against beams of their own constants.

What Timoshenko's theory is worth in dynamics, waves along the legs say from their sections alone;
with that, both are one to a thousandth.
"""

from dataclasses import dataclass

import numpy as np

from fem.couplings.wave_stiffness import prism_waves
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Ends
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import assembly
from validation.adequacy.mechanism.path import known_legs, offered, path_postures
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.vibration import (
    SolidMeshes,
    solid_meshes,
    solid_vibration,
    vibration_of,
)
from validation.adequacy.partners import partners
from validation.agreement.convergence import step_factor
from validation.case import Absolute, Allowance, Measurement, Relative, Sides, Skip
from validation.case_group import CaseGroup, numbered
from validation.cases.mechanism.quantities import MODEL_CODE
from validation.context import Context
from validation.exhibits import PATH
from validation.models.legs import filled
from validation.models.mechanism import CUTOFF, highest_frequency, modes_along
from validation.solids.legs import (
    ELEMENTS,
    FORMAL_ORDER,
    SHARED_SOLIDS,
    decay_of_warping,
    divisions_across,
    held_solid,
    own_beam,
)
from validation.solids.size import too_large
from validation.studies.leg_waves import NO_WAVES, WAVES, WAVES_SOURCE, wave_changes, waves_of

MODES = 6
_OWN = "20 Timoshenko beam elements per leg, constants of the solids' own section meshes"
# Of a leg's length: what reaches no farther is an effect of its ends.
_SHORT = 0.1
# Absolute tolerance of MAC, and the share of its frequency from which on waves change a mode's
# shape, too: walls bend with it, which no beam's do.
_SHAPE, _WALLS_BEND = 0.01, 0.01


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
    reference_kind="independent-solver",
    citation=_OWN,
    model="solid",
    section=PATH,
    group=SHARED_SOLIDS,
    effort=5.0,
    sides=Sides((held_solid, craig_bampton), (*MODEL_CODE["beam"], prism_waves)),
)


def free_modes(postures: tuple[Posture, ...], divisions: int, walls: int, count: int) -> FreeModes:
    """Beams and solids of one section mesh in the only one of `postures`."""
    mechanism = postures[0].mechanism
    legs = {
        name: leg for name, leg in known_legs(mechanism).items() if isinstance(leg, ConstantLeg)
    }
    numbers = {name: divisions_across(leg, divisions, walls) for name, leg in legs.items()}
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
    solids = solid_vibration(postures, divisions, walls, free, None, count)
    found = partners(own, solids, samples.weights, MODES)
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


def _meshes(context: Context) -> tuple[tuple[Posture, ...], SolidMeshes]:
    """The middle posture, and the two meshes of its legs; raises Skip where waves are not known."""
    postures = path_postures(context)
    middle = (postures[len(postures) // 2],)
    mechanism = middle[0].mechanism
    legs = list(known_legs(mechanism).values())
    prisms = [leg for leg in legs if isinstance(leg, ConstantLeg)]
    if mechanism.parts or not prisms or len(prisms) < len(legs):
        raise Skip("not all of its legs are prisms, whose waves are known")
    meshes = solid_meshes(context.preset)
    numbers = [divisions_across(leg, *meshes.fine) for leg in prisms]
    if reason := too_large(prisms, numbers, context.preset):
        raise Skip(reason)
    for leg, number in zip(prisms, numbers, strict=True):
        if decay_of_warping(leg, number) > _SHORT * leg.length:
            raise Skip(
                f"{leg.name}: warping of its open section reaches over more than a tenth of its "
                "length, and beams without warping are none of its theory"
            )
    return middle, meshes


def _both(context: Context) -> tuple[FreeModes, FreeModes, float]:
    """Both meshes and what the finer one's step means (uncertainty over change)."""
    middle, meshes = _meshes(context)
    count = offered(MODES)
    rougher, found = (context.get(free_modes, middle, *mesh, count) for mesh in meshes)
    return found, rougher, step_factor(meshes.ratio, FORMAL_ORDER)


@cases.case(
    "mechanism.solid.frequency[{mode}]",
    "Frequency {mode} of solids with free ends is that of beams and of the waves in them",
    over={"index, mode": numbered(MODES)},
    quantity="natural frequency {mode}, middle of the path, paired by shape",
    unit="Hz",
    figure="mechanism.mode-shapes",
    tolerance=Relative(1e-3),
    tolerance_reason="what waves of 3-D elasticity say of beam theory is allowed for: what is left "
    "has no name",
)
def _frequency(context: Context, index: int) -> Measurement:
    found, rougher, factor = _both(context)
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


@cases.case(
    "mechanism.solid.likeness",
    f"Of the first {MODES} modes those that waves hardly change have the shapes of beams",
    quantity="smallest MAC, of close modes that of their space",
    unit="1",
    tolerance=Absolute(_SHAPE),
    tolerance_reason="0.99 is the project's measure of one and the same mode; seen: 2e-5 off, and "
    "2e-3 where waves in walls change the frequency by nearly 1 %",
)
def _likeness(context: Context) -> Measurement:
    found, rougher, factor = _both(context)
    alike = np.abs(np.nan_to_num(found.changes)) < _WALLS_BEND
    if not alike.any():
        raise Skip("the walls of its legs bend in every mode")
    mode = int(np.argmin(np.where(alike, found.likeness, np.inf)))
    return Measurement(
        float(found.likeness[mode]),
        1.0,
        value_uncertainty=float(factor * abs(found.likeness[mode] - rougher.likeness[mode])),
        notes=(f"mode {mode + 1}",),
        table=_table(found),
    )
