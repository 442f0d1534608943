"""Natural modes of a robot: what models are held against, and the ladders of causes."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import product

import numpy as np

from lumped.arrays import Array
from lumped.legs import ConstantLeg
from validation.adequacy.legs import SECTION_RATIO, step_uncertainty
from validation.adequacy.partners import amounts_by_shape, frequency_changes
from validation.adequacy.response import (
    UNSOLVED,
    Alternative,
    Reference,
    Response,
    Rung,
    Vibration,
    finer_by,
    modes_of,
)
from validation.adequacy.subject.given_masses import MASSES, Masses
from validation.adequacy.subject.parts import FINER_PARTS, UNKNOWN, part_rungs, refinement_share
from validation.adequacy.subject.posed import Dynamics, Holds
from validation.context import Preset
from validation.models.options import ModelName, ModelOptions
from validation.parts.meshes import FINEST, MIDDLE
from validation.solids.legs import divisions_across
from validation.solids.size import larger_preset, too_large
from validation.studies.paired_robot_modes import DIVISIONS, ELEMENTS, WALL_DIVISIONS

_OPEN_MASS = "where the legs' mass lies"
_SAY_MASS = "the legs' mass distribution: a section and a material in place of the 6×6"


def dynamic_reference(robot: Dynamics) -> Reference:
    """Solid legs reduced to their ends or, where legs are given, a bracket of plausible masses."""
    preset, holds = robot.context.preset, robot.open.holds
    if reason := _why_unmeshed(robot.prisms, preset):
        return Reference("none", (), decides=reason)
    masses: tuple[Masses | None, ...] = MASSES if robot.given else (None,)
    if not (robot.prisms or robot.parts):
        holds = dict(list(holds.items())[:1])
    stiff = next(iter(holds.values()))
    parts = _part_uncertainty(robot, partial(robot.solid, "fine", stiff, masses[0]))
    alternatives = []
    for (name, hold), mass in product(holds.items(), masses):
        fine = robot.solid("fine", hold, mass, FINEST)
        uncertainty = np.zeros_like(fine.frequencies[:, : robot.judged]) + parts
        # Where no section is meshed there is one solution.
        if robot.prisms:
            coarse = robot.solid("coarse", hold, mass, FINEST)
            uncertainty += _mesh_uncertainty(robot, coarse, fine, hold)
        said = name if robot.prisms or robot.parts or not robot.given else ""
        both = ", ".join(filter(None, (said, mass)))
        dynamic = np.where(np.isnan(uncertainty), UNKNOWN, uncertainty)
        alternatives.append(Alternative(both, Response(vibration=fine), dynamic=dynamic))
    several = len(holds) > 1
    return Reference(
        title=robot.title,
        alternatives=alternatives,
        open=" and ".join(filter(None, (several * robot.open.what, robot.given * _OPEN_MASS))),
        decides="; ".join(filter(None, (several * robot.open.says, robot.given * _SAY_MASS))),
        finer=FINER_PARTS if robot.parts else _finer_preset(robot.prisms, preset),
        # Without the legs' mass, alternatives are no more than a bracket.
        bracket=robot.given,
        computed_by=(robot.computed_by,),
    )


def _why_unmeshed(prisms: Sequence[ConstantLeg], preset: Preset) -> str:
    """Why a preset does not mesh these legs; or ""."""
    numbers = DIVISIONS[preset], WALL_DIVISIONS[preset]
    return too_large(prisms, [divisions_across(leg, *numbers) for leg in prisms], preset)


def _finer_preset(prisms: Sequence[ConstantLeg], preset: Preset) -> str:
    """What would leave less of the meshes of these legs: a larger preset, if one meshes them."""
    return finer_by(larger_preset(preset, lambda one: not _why_unmeshed(prisms, one)))


def _mesh_uncertainty(robot: Dynamics, coarse: Vibration, fine: Vibration, hold: Holds) -> Array:
    """What the meshes of prisms leave open of the judged frequencies of `fine` (p×K, relative).

    From the step between two solids, whose elements become shorter while walls keep one mesh
    across, and from what such a mesh leaves open of the beams' modes of the same shape. NaN for a
    mode that the coarser solid does not have, or the beams: it is known to no digit.
    """
    weights, judged = robot.weights, robot.judged
    step = frequency_changes(fine, coarse, weights, judged)
    # Beams free to warp lean on Saint-Venant's constant less than such solids do.
    rough, beams = robot.sections(None if "free" in hold.values() else hold)
    count = beams.frequencies.shape[1]
    changes = frequency_changes(beams, rough, weights, count)
    of_beams = np.broadcast_to(changes[:, None, :], (*fine.frequencies.shape, count))
    section = amounts_by_shape(fine, beams, of_beams, weights, judged)
    return step_uncertainty(step, robot.ratio) + step_uncertainty(section, SECTION_RATIO)


def _part_uncertainty(robot: Dynamics, solid: Callable[[int], Vibration]) -> Array | float:
    """What the meshes of CAD parts leave open of frequencies (p×K, relative).

    NaN for a mode that a coarser mesh does not have. `solid` gives modes with the parts on a rung
    of their meshes.
    """

    def frequencies(rung: int) -> Array:
        finest = solid(FINEST)
        own = finest.frequencies[:, : robot.judged]
        if rung == FINEST:
            return own
        changes = frequency_changes(finest, solid(rung), robot.weights, robot.judged)
        return np.asarray(own * (1.0 + changes))

    return refinement_share(robot.parts, frequencies)


def bracketed_frequencies(reference: Reference, modes: int, where: str) -> str:
    """What plausible masses leave open of the frequencies in the middle of the path, in words.

    Empty where they are known.
    """
    if not reference.bracket:
        return ""
    answers = [one.response.vibration for one in reference.alternatives]
    found = np.array([one.frequencies[len(one.frequencies) // 2, :modes] for one in answers if one])
    spans = [
        f"f{k + 1} {low:.4g} to {high:.4g} Hz"
        for k, (low, high) in enumerate(zip(found.min(axis=0), found.max(axis=0), strict=True))
    ]
    return (
        "frequencies cannot be judged without the legs' mass distribution; plausible ones give "
        f"{', '.join(spans)} {where}"
    )


def dynamic_ladders(
    robot: Dynamics, found: Mapping[str, Response], reference: Reference
) -> dict[str, tuple[Rung, ...]]:
    """Rungs by name of the model, each ladder from the model upwards; `found` are their modes."""
    names = [one.name for one in reference.alternatives]
    if not names:
        return {}

    def same(modes: Response) -> dict[str, Response]:
        return dict.fromkeys(names, modes)

    def answered(model: ModelName, options: ModelOptions) -> Response:
        return modes_of(partial(robot.answer, model, options), UNSOLVED)

    # From beams of textbook constants upwards.
    upper: tuple[Rung, ...] = ()
    if robot.prisms and not reference.bracket:
        upper = _to_solids(robot, names)
    of_parts = part_rungs(
        robot.parts, names, lambda kind: answered("beam", ModelOptions(parts=kind))
    )
    above = (*of_parts, *upper)
    twice = 2 * ELEMENTS
    beams = same(found["beam"])
    segments = (
        Rung(
            f"discretisation (n = {ELEMENTS})",
            f"{twice} segments, then beam elements",
            # Second order in 1/n: a quarter of the error is left.
            same(answered("segments", ModelOptions(elements=twice))),
            f"n = {twice}",
        ),
        Rung(f"discretisation (n = {ELEMENTS})", "beam elements of the same constants", beams),
    )
    shear, remedy = "shear deformation and rotary inertia left out", "use Timoshenko"
    return {
        "simplified": (
            Rung(f"drives only: {robot.rigid}", "beam elements", beams, "use beam"),
            *above,
        ),
        "segments": (*segments, *above),
        "beam": above,
        "segments-euler-bernoulli": (
            Rung(shear, "Timoshenko segments", same(found["segments"]), remedy),
            *segments,
            *above,
        ),
        "beam-euler-bernoulli": (Rung(shear, "Timoshenko beams", beams, remedy), *above),
        "segments-stepped": (*of_parts[1:], *upper),
        "segments-condensed": (*(_inner_modes(robot, same) if of_parts else ()), *upper),
    }


def _to_solids(robot: Dynamics, names: Sequence[str]) -> tuple[Rung, ...]:
    """From textbook constants to the sections' own, and to warping by alternative."""

    def own(ends: Holds | None) -> Response:
        return modes_of(partial(robot.own, ends), UNSOLVED)

    return (
        Rung(
            "textbook section constants",
            "fem.sections.section_constants, beam elements",
            dict.fromkeys(names, own(None)),
            "take the section's constants from finite elements",
        ),
        Rung(
            "warping: held at the ends, and non-uniform torsion between them",
            "beams with Reissner's torsion, the section's own Γ",
            {name: own(ends) for name, ends in robot.open.holds.items()},
            "add the warping stiffness",
        ),
    )


def _inner_modes(
    robot: Dynamics, same: Callable[[Response], dict[str, Response]]
) -> tuple[Rung, ...]:
    """From Guyan's mass to modes of the parts' own, on a coarser mesh than the reference's."""
    stiff = next(iter(robot.open.holds.values()))
    found = modes_of(partial(robot.solid, "fine", stiff, None, MIDDLE), UNSOLVED)
    return (
        Rung(
            "inertia inside the parts (Guyan's mass)",
            "parts reduced by Craig and Bampton, the middle one of their meshes",
            same(found),
            "give the parts modes of their own: model solid",
        ),
    )
