"""Models and references with prescribed responses."""

from types import SimpleNamespace

from lumped.acceptance.requirement import DEFAULT_LIMITS
from validation.references.reference import Interpretation, Reference, Source, SourceHalfWidths
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import Reading
from validation.responses.statics_and_modes import Statics

# Responses of models that do not depend on a robot, such as those of a leg alone.
_FILE = SimpleNamespace(agreement=DEFAULT_LIMITS)
NO_ROBOT = Responses(
    SimpleNamespace(mechanism=SimpleNamespace(name=""), context=SimpleNamespace(robot_file=_FILE)),
    strict=True,
)


def reading(name):
    """Reading of a robot file with the name `name`."""
    return Reading({"toy": name})


def model(name, statics=None, modes=None, **fields):
    """Model with the same statics and modes under any reading.

    None if the model does not define them.
    """
    solve = [half and (lambda *_, half=half: half) for half in (statics, modes)]
    return Model(name, f"{name} of a toy", *solve, **fields)


def model_by_reading(name, statics=None, modes=None):
    """Model whose statics and modes depend on the name of the reading."""
    solve = [
        half and (lambda _, reading, half=half: half[reading.ends["toy"]])
        for half in (statics, modes)
    ]
    return Model(name, name, *solve, ("ends",), ("ends",))


def meshes(**half_widths):
    """Uncertainty budget with half-widths due to meshes only."""
    return {Source.MESHES: SourceHalfWidths(**half_widths)}


def reference(title, halves, budgets=None, insides=(), **keywords):
    """Reference whose `halves` are statics or modes by the name of the interpretation.

    `budgets` is one uncertainty budget for all interpretations, or a list with one for each.
    Interpretations differ in the stiffness inside the legs if `insides` names it, otherwise in the
    end conditions.
    """
    names = list(halves)
    readings = [Reading({}, interior=interior) for interior in insides] or [
        reading(name) for name in names
    ]
    each = budgets if isinstance(budgets, list) else [budgets or {}] * len(names)
    half_by_reading = dict(zip(readings, halves.values(), strict=True))
    static = all(isinstance(half, Statics) for half in half_by_reading.values())
    solve = [
        (lambda _, reading: half_by_reading[reading]) if is_defined else None
        for is_defined in (static, not static)
    ]
    fields = "ends", "interior"
    return Reference(
        title,
        Model("solid", "", *solve, fields, fields),
        [Interpretation(*arguments) for arguments in zip(names, readings, each, strict=True)],
        **keywords,
    )
