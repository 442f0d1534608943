"""Natural modes of a mechanism over its path: models, ladders of causes, and the reference.

Shapes of all models are sampled alike: displacements of the tool, twists of rigid bodies about
their centre, and four points in each of some sections of every leg, placed so that they have the
section's mass and rotary inertia.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fem.beams.beam import beam_leg
from fem.beams.warping_beam import warping_beam_leg
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from fem.sections.section_constants import beam_properties
from lumped.arrays import Array
from lumped.caches import lru_cache
from lumped.legs import ConstantLeg, Ends, GivenLeg, Leg, equivalent_leg
from lumped.mechanism.body_model import BodyModel, LegMatrices
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import assembly
from lumped.system.solution import mode_count, modes, solved
from validation.adequacy.common.given_masses import MASSES, Masses, leg_with_masses
from validation.adequacy.common.ladders import Refined, dynamic_rungs, dynamic_upper_rungs
from validation.adequacy.common.references import (
    dynamic_reference_of,
    finer_preset,
    largest_change,
    meshed_alternative,
    why_unmeshed,
)
from validation.adequacy.legs import SECTION_DIVISIONS, own_constants
from validation.adequacy.mechanism.part_ladders import part_rungs
from validation.adequacy.mechanism.part_solids import (
    FINER_PARTS,
    Bodies,
    condensed_parts,
    refinement_share,
    solid_parts,
)
from validation.adequacy.mechanism.path import has_given, holds, known_legs, left_open, offered
from validation.adequacy.mechanism.samples import Samples, samples_of
from validation.adequacy.partners import partners
from validation.adequacy.response import (
    UNSOLVED,
    Reference,
    Response,
    Rung,
    Vibration,
    modes_of,
)
from validation.context import Context
from validation.models.legs import filled
from validation.models.mechanism import (
    CUTOFF,
    dynamic_bodies,
    highest_frequency,
    on_drives_alone,
)
from validation.models.options import ModelName, ModelOptions
from validation.parts.meshes import FINEST, MIDDLE
from validation.solids.legs import COARSEST_WALLS, divisions_across
from validation.solids.robots import held_solid, renewed_where_needed
from validation.studies.paired_robot_modes import DIVISIONS, ELEMENTS, WALL_DIVISIONS

Build = Callable[[Leg, Ends, float], LegMatrices]
_FINER_SEGMENTS = 2 * ELEMENTS


def vibration(
    samples: Samples, postures: Sequence[Posture], bodies: Mapping[str, BodyModel], count: int
) -> Vibration:
    """The first `count` modes in every posture with these models of the legs.

    Of legs whose mass is one lump, and of parts condensed on their interfaces, as many as have
    mass in every posture.
    """
    prepared = assembly(postures[0].mechanism, {name: filled(one) for name, one in bodies.items()})
    if has_given(postures[0].mechanism) or postures[0].mechanism.parts:
        known = [mode_count(solved(prepared.at(posture))) for posture in postures]
        count = min(count, *known)
    frequencies, shapes = [], []
    of_bodies = samples.of_models(bodies)
    for posture in postures:
        system = prepared.at(posture)
        found = modes(solved(system), count)
        frequencies.append(found.frequencies)
        shapes.append(samples.at(system, found.shapes, of_bodies))
    return Vibration(np.array(frequencies), np.array(shapes))


def simplified_vibration(
    samples: Samples, postures: Sequence[Posture], count: int
) -> Vibration | None:
    """Rigid bodies on elastic drives, NaN beyond the modes that they have; None without mass."""
    rigid = on_drives_alone(postures[0].mechanism)
    prepared = assembly(rigid, {})
    frequencies, shapes = [], []
    for posture in postures:
        system = prepared.at(replace(posture, mechanism=rigid))
        solution = solved(system)
        known = min(count, mode_count(solution)) if system.size else 0
        if not known:
            return None
        found = modes(solution, known)
        own = samples.at(system, found.shapes, {})
        frequencies.append(np.append(found.frequencies, np.full(count - known, np.nan)))
        shapes.append(np.hstack([own, np.zeros((len(own), count - known))]))
    return Vibration(np.array(frequencies), np.array(shapes))


def model_vibration(
    postures: tuple[Posture, ...], model: ModelName, options: ModelOptions, count: int
) -> Vibration:
    """Modes by segments or beam elements of textbook constants."""
    mechanism = postures[0].mechanism
    samples = samples_of(mechanism)

    def solve(highest: float) -> Vibration:
        return vibration(
            samples, postures, dynamic_bodies(model, mechanism, highest, options), count
        )

    return _renewed(postures, count, solve)


def built_vibration(
    postures: tuple[Posture, ...],
    build: Build,
    parts: Bodies,
    ends: Mapping[str, Ends],
    count: int,
) -> Vibration:
    """Modes with every leg as `build` makes it of leg, ends and highest frequency (Hz).

    `parts`: models of the CAD parts.
    """
    mechanism = postures[0].mechanism
    samples, legs = samples_of(mechanism), known_legs(mechanism)

    def solve(highest: float) -> Vibration:
        made: dict[tuple[object, Ends], LegMatrices] = {}
        for name, leg in legs.items():
            key = leg if isinstance(leg, ConstantLeg) else name, ends[name]
            if key not in made:
                made[key] = build(leg, ends[name], highest)
        bodies: dict[str, BodyModel] = {
            name: made[leg if isinstance(leg, ConstantLeg) else name, ends[name]]
            for name, leg in legs.items()
        }
        return vibration(samples, postures, {**bodies, **parts}, count)

    return _renewed(postures, count, solve)


def _renewed(
    postures: Sequence[Posture], count: int, solve: Callable[[float], Vibration]
) -> Vibration:
    return renewed_where_needed(
        highest_frequency(postures, count), solve, frequencies=lambda found: found.frequencies
    )


def solid_vibration(
    postures: tuple[Posture, ...],
    divisions: int,
    walls: int,
    ends: Mapping[str, Ends],
    masses: Masses | None,
    count: int,
    rung: int = FINEST,
) -> Vibration:
    """Modes with prisms as solids reduced to their ends, and given legs with plausible masses.

    `divisions` across rectangles, `walls` across the sections that have walls; CAD parts on the
    mesh of that `rung`.
    """
    build = partial(_reference_leg, divisions=divisions, walls=walls, masses=masses)
    parts = solid_parts(postures, count, ends, rung)
    return built_vibration(postures, build, parts, ends, count)


def _reference_leg(
    leg: Leg, ends: Ends, highest: float, *, divisions: int, walls: int, masses: Masses | None
) -> LegMatrices:
    if isinstance(leg, GivenLeg):
        return leg_with_masses(leg, masses or MASSES[0], highest)
    return _reduced_solid(leg, divisions_across(leg, divisions, walls), ends, highest)


# Robots that differ in one number share most of their legs.
@lru_cache(maxsize=16)
def _reduced_solid(leg: ConstantLeg, number: int, ends: Ends, highest: float) -> LegMatrices:
    return craig_bampton(held_solid(leg, number, ends), highest).matrices


def own_vibration(
    postures: tuple[Posture, ...], divisions: int, ends: Mapping[str, Ends] | None, count: int
) -> Vibration:
    """Modes by beams of the sections' own constants; with warping, held as `ends` say."""
    mechanism = postures[0].mechanism
    build = partial(_own_leg, divisions=divisions, warping=ends is not None)
    hold: Mapping[str, Ends] = ends or dict.fromkeys(known_legs(mechanism), "rigid")
    return built_vibration(postures, build, condensed_parts(mechanism), hold, count)


def _own_leg(leg: Leg, ends: Ends, highest: float, *, divisions: int, warping: bool) -> LegMatrices:
    constant = equivalent_leg(leg)
    constants = own_constants(constant, divisions)
    if warping:
        whole = warping_beam_leg(constants, constant.material, constant.length, ELEMENTS, ends)
    else:
        whole = beam_leg(beam_properties(constants, constant.material), constant.length, ELEMENTS)
    return craig_bampton(held_leg(whole), highest, CUTOFF["beam"] * highest).matrices


def dynamic_reference(context: Context, postures: tuple[Posture, ...], judged: int) -> Reference:
    """Solid legs reduced to their ends or, where legs are given, a bracket of plausible masses."""
    mechanism = postures[0].mechanism
    count, weights = offered(judged), samples_of(mechanism).weights
    given, parts = has_given(mechanism), bool(mechanism.parts)
    is_open = left_open(mechanism)
    ends = dict(is_open.holds)
    masses: tuple[Masses | None, ...] = MASSES if given else (None,)
    fine = DIVISIONS[context.preset], WALL_DIVISIONS[context.preset]
    coarse = fine[0] - 1, fine[1] // 2
    meshed = [leg for leg in known_legs(mechanism).values() if isinstance(leg, ConstantLeg)]
    if reason := why_unmeshed(meshed, context.preset):
        return Reference("none", (), decides=reason)
    ratio = min(fine[0] / coarse[0], fine[1] / coarse[1])
    solid = bool(meshed)
    if not solid:
        # No section is meshed: one solution serves for both.
        coarse = fine
        ends = ends if parts else dict(list(ends.items())[:1])
    section = _section_uncertainty(context, postures, judged) if solid else 0.0
    section = section + _part_uncertainty(
        context, postures, (*fine, next(iter(ends.values())), masses[0], count), judged
    )
    alternatives = []
    for (name, hold), mass in product(ends.items(), masses):
        one, other = (
            context.get(solid_vibration, postures, *number, hold, mass, count)
            for number in (coarse, fine)
        )
        said = (name if solid or parts or not given else "", mass)
        alternatives.append(
            meshed_alternative(
                ", ".join(filter(None, said)), one, other, weights, judged, ratio, section
            )
        )
    several = len(ends) > 1
    return dynamic_reference_of(
        _title(given=given, parts=parts, solid=solid),
        alternatives,
        "validation.adequacy.mechanism.dynamics.solid_vibration",
        left_open=is_open.what if several else "",
        says=is_open.says if several else "",
        finer=FINER_PARTS if parts else finer_preset(meshed, context.preset),
        given=given,
    )


def _title(*, given: bool, parts: bool, solid: bool) -> str:
    if given:
        return "mechanism of the legs' own 6×6 and plausible masses"
    if parts:
        return f"mechanism of its parts as solids{' and solid legs' if solid else ''}, reduced"
    return "mechanism of solid legs, reduced to their ends"


def _part_uncertainty(
    context: Context,
    postures: tuple[Posture, ...],
    solid: tuple[int, int, Mapping[str, Ends], Masses | None, int],
    judged: int,
) -> Array | float:
    """What the meshes of CAD parts leave open of frequencies (p×K, relative), held as in `solid`.

    A mode that a coarser mesh does not have is known to no digit.
    """
    weights = samples_of(postures[0].mechanism).weights
    finest = context.get(solid_vibration, postures, *solid)

    def frequencies(rung: int) -> Array:
        if rung == FINEST:
            return finest.frequencies[:, :judged]
        found = context.get(solid_vibration, postures, *solid, rung)
        return partners(finest, found, weights, judged).frequency

    share = refinement_share(postures[0].mechanism, frequencies)
    return np.where(np.isnan(share), 1.0, share)


def _section_uncertainty(context: Context, postures: tuple[Posture, ...], judged: int) -> Array:
    """What the section mesh of the solids leaves open of frequencies (p×1, relative).

    Walls keep one mesh across while elements become shorter. By beams of the constants of that
    mesh and of a finer one, the largest over the modes.
    """
    count, weights = offered(judged), samples_of(postures[0].mechanism).weights
    coarse, fine = (
        context.get(own_vibration, postures, number, None, count)
        for number in (COARSEST_WALLS, SECTION_DIVISIONS)
    )
    return largest_change(coarse, fine, weights, judged)


def dynamic_ladders(
    context: Context,
    postures: tuple[Posture, ...],
    found: Mapping[str, Response],
    reference: Reference,
    judged: int,
) -> dict[str, tuple[Rung, ...]]:
    """Rungs for frequencies by name of the model, each ladder from the model upwards."""
    mechanism = postures[0].mechanism
    names = [one.name for one in reference.alternatives]
    if not names:
        return {}

    def solved_by(model: ModelName, options: ModelOptions) -> Response:
        return modes_of(
            partial(context.get, model_vibration, postures, model, options, offered(judged)),
            UNSOLVED,
        )

    finer = solved_by("segments", ModelOptions(elements=_FINER_SEGMENTS))
    prisms = any(isinstance(leg, ConstantLeg) for leg in known_legs(mechanism).values())
    upper: tuple[Rung, ...] = ()
    if prisms and not reference.bracket:
        upper = _upper(context, postures, names, judged)
    of_parts = part_rungs(
        mechanism,
        names,
        lambda kind: solved_by("beam", ModelOptions(parts=kind)),
    )
    above = (*of_parts, *upper)
    inertia = _inner_modes(context, postures, names, judged) if of_parts else ()
    rungs = dynamic_rungs(
        names, found, Refined(ELEMENTS, finer), above, "legs rigid and without mass"
    )
    return rungs | {
        "segments-stepped": (*of_parts[1:], *upper),
        "segments-condensed": (*inertia, *upper),
    }


def _inner_modes(
    context: Context, postures: tuple[Posture, ...], names: Sequence[str], judged: int
) -> tuple[Rung, ...]:
    """From Guyan's mass to modes of the parts' own, on a coarser mesh than the reference's."""
    hold = next(iter(holds(postures[0].mechanism).values()))
    number = DIVISIONS[context.preset], WALL_DIVISIONS[context.preset]
    asked = postures, *number, hold, None, offered(judged), MIDDLE
    found = modes_of(partial(context.get, solid_vibration, *asked), UNSOLVED)
    return (
        Rung(
            "inertia inside the parts (Guyan's mass)",
            "parts reduced by Craig and Bampton, the middle one of their meshes",
            dict.fromkeys(names, found),
            "give the parts modes of their own: model solid",
        ),
    )


def _upper(
    context: Context, postures: tuple[Posture, ...], names: Sequence[str], judged: int
) -> tuple[Rung, ...]:
    count = offered(judged)

    def own(ends: Mapping[str, Ends] | None) -> Response:
        asked = postures, SECTION_DIVISIONS, ends, count
        return modes_of(partial(context.get, own_vibration, *asked), UNSOLVED)

    warping = {name: own(ends) for name, ends in holds(postures[0].mechanism).items()}
    return dynamic_upper_rungs(names, own(None), warping)
