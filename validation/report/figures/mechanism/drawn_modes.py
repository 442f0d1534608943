"""The models whose shapes are drawn: beams with CAD parts as their solids, and segments beside."""

from collections.abc import Sequence
from dataclasses import replace

from lumped.dense.modes import Modes
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import assembly
from validation.adequacy.mechanism.parts import solid_parts
from validation.adequacy.mechanism.path import holding, offered, path_postures
from validation.context import Context
from validation.models.mechanism import (
    PostureModes,
    dynamic_bodies,
    highest_frequency,
    mechanism_modes,
    modes_along,
)
from validation.models.options import ModelOptions

_CONDENSED = ModelOptions(parts="condensed")


def finite_elements(context: Context, count: int) -> PostureModes:
    """The first modes in the middle of the path, prisms as beams, parts as solids.

    At most `count`; with parts none beyond what these are reduced for, those that are judged and as
    many again.
    """
    postures = path_postures(context)
    if postures[0].mechanism.parts:
        offers = offered(context.robot_file.requirement.modes)
        return context.get(_with_solid_parts, postures, offers, count)
    (found,) = context.get(mechanism_modes, "beam", (_middle(postures),), count)
    return found


def segments(context: Context, count: int) -> PostureModes:
    """The same by segments, parts condensed on their interfaces."""
    at = _middle(path_postures(context))
    if at.mechanism.parts:
        return context.get(_with_condensed_parts, at, count)
    (found,) = context.get(mechanism_modes, "segments", (at,), count)
    return found


def _middle(postures: Sequence[Posture]) -> Posture:
    return postures[len(postures) // 2]


def _with_solid_parts(postures: tuple[Posture, ...], offers: int, count: int) -> PostureModes:
    """Parts as the run has them: held in the first of the ways that it looks at."""
    at, mechanism = _middle(postures), postures[0].mechanism
    parts = solid_parts(postures, offers, holding(mechanism).first)
    highest = min(part.highest for part in parts.values())
    bodies = dynamic_bodies("beam", mechanism, highest, _CONDENSED)
    (found,) = modes_along(assembly(mechanism, {**bodies, **parts}), [at], count)
    known = found.modes.frequencies <= highest
    return replace(found, modes=Modes(found.modes.frequencies[known], found.modes.shapes[:, known]))


def _with_condensed_parts(at: Posture, count: int) -> PostureModes:
    highest = highest_frequency((at,), count)
    bodies = dynamic_bodies("segments", at.mechanism, highest, _CONDENSED)
    (found,) = modes_along(assembly(at.mechanism, bodies), [at], count)
    return found
