"""Models with made-up responses, and references with made-up responses by interpretation."""

from validation.references.reference import Interpretation, Reference, Source, SourceHalfWidths
from validation.references.responses import Model
from validation.references.robot_on_path import Reading
from validation.responses.statics_and_modes import Statics


def reading(name):
    """Reading for each name."""
    return Reading({"toy": name})


def model(name, statics=None, modes=None, **more):
    """Model with these halves under any reading. None if it does not define one."""
    solve = [half and (lambda *_, half=half: half) for half in (statics, modes)]
    return Model(name, f"{name} of a toy", *solve, **more)


def model_by_reading(name, statics=None, modes=None):
    """Model with halves by the names of the readings."""
    solve = [half and (lambda _, at, half=half: half[at.ends["toy"]]) for half in (statics, modes)]
    return Model(name, name, *solve, ("ends",), ("ends",))


def meshes(**half_widths):
    """Budget of meshes alone."""
    return {Source.MESHES: SourceHalfWidths(**half_widths)}


def reference(title, halves, budgets=None, insides=(), **more):
    """Reference with statics or modes by the names of its interpretations.

    `budgets`: one for all, or one for each. `insides`: stiffness inside the legs, by which alone
    they differ; without it they differ in their ends.
    """
    names = list(halves)
    readings = [Reading({}, interior=one) for one in insides] or [reading(name) for name in names]
    each = budgets if isinstance(budgets, list) else [budgets or {}] * len(names)
    known = dict(zip(readings, halves.values(), strict=True))
    static = all(isinstance(half, Statics) for half in known.values())
    solve = [(lambda _, at: known[at]) if own else None for own in (static, not static)]
    fields = "ends", "interior"
    return Reference(
        title,
        Model("solid", "", *solve, fields, fields),
        [Interpretation(*one) for one in zip(names, readings, each, strict=True)],
        **more,
    )
