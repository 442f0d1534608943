"""Responses of models of one robot, under readings of its file, each solved once when needed.

A response is a model under a reading, in all poses, in two halves: statics and modes. The halves
are solved independently of each other, one may be unsolved while the other stands.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias, TypeVar

from lumped.acceptance.quantities import Quantity
from lumped.errors import ComputationError, InputError
from validation.adequacy.mechanism.path import Reading, RobotOnPath
from validation.agreement.responses import PathModes, Statics, Unsolved
from validation.case import failure_reason

# Errors that a robot may cause: walls too thin to mesh, a material that is lost in rounding.
UNSOLVED = (InputError, ComputationError)

H = TypeVar("H")
Solve: TypeAlias = Callable[[RobotOnPath, Reading], H]


@dataclass(frozen=True, eq=False)
class Model:
    """Model of a robot: functions that solve both halves of its response.

    `statics` is None if the model does not define them; `modes` is None if it is static, and
    returns None if nothing has mass. `static_fields` and `modal_fields` are the fields of a
    reading that each half depends on. `silent`: reason why a half is not defined. `rigid`: reason
    for zeros in the compliance.
    """

    name: str
    title: str = ""
    statics: Solve[Statics] | None = None
    modes: Solve[PathModes | None] | None = None
    static_fields: tuple[str, ...] = ()
    modal_fields: tuple[str, ...] = ()
    silent: str = ""
    rigid: str = ""
    computed_by: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Responses:
    """Responses of models of a robot, by model and reading.

    A half is kept by the model and those fields of the reading that it depends on.
    """

    robot: RobotOnPath
    _statics: dict[tuple[Model, Reading], Statics | Unsolved] = field(
        default_factory=dict, repr=False
    )
    _modes: dict[tuple[Model, Reading], PathModes | Unsolved | None] = field(
        default_factory=dict, repr=False
    )

    def statics(self, model: Model, reading: Reading) -> Statics | Unsolved | None:
        """Statics of a model. None if it does not define them."""
        if model.statics is None:
            return None
        key = model, reading.restricted(model.static_fields)
        if key not in self._statics:
            self._statics[key] = _solved(model.statics, self.robot, *key)
        return self._statics[key]

    def modes(self, model: Model, reading: Reading) -> PathModes | Unsolved | None:
        """Modes of a model. None if it does not define them or nothing has mass."""
        if model.modes is None:
            return None
        key = model, reading.restricted(model.modal_fields)
        if key not in self._modes:
            self._modes[key] = _solved(model.modes, self.robot, *key)
        return self._modes[key]

    def half(
        self, model: Model, reading: Reading, quantity: Quantity
    ) -> Statics | PathModes | Unsolved | None:
        """Half of a response that a quantity belongs to."""
        return (self.statics if quantity.static else self.modes)(model, reading)

    def known_statics(self, model: Model, reading: Reading) -> Statics | None:
        """Statics of a model. None if they are not defined or not solved."""
        half = self.statics(model, reading)
        return half if isinstance(half, Statics) else None

    def known_modes(self, model: Model, reading: Reading) -> PathModes | None:
        """Modes of a model. None if they are not defined or not solved."""
        half = self.modes(model, reading)
        return half if isinstance(half, PathModes) else None

    def required_statics(self, model: Model, reading: Reading) -> Statics:
        """Statics of a model. Raises ComputationError if there are none."""
        return _required(model, self.statics(model, reading))

    def required_modes(self, model: Model, reading: Reading) -> PathModes:
        """Modes of a model. Raises ComputationError if there are none."""
        return _required(model, self.modes(model, reading))

    def unsolved(self, model: Model, reading: Reading, quantity: Quantity) -> str:
        """Reason why a quantity of a model cannot be computed. "" if there is none."""
        half = self.half(model, reading, quantity)
        return half.reason if isinstance(half, Unsolved) else ""

    @property
    def faults(self) -> tuple[str, ...]:
        """Names of the models with a half that ended with an error of the program."""
        halves = (*self._statics.items(), *self._modes.items())
        return tuple(
            dict.fromkeys(
                model.name
                for (model, _), half in halves
                if isinstance(half, Unsolved) and half.fault
            )
        )


def _solved(solve: Solve[H], robot: RobotOnPath, model: Model, reading: Reading) -> H | Unsolved:
    """Half of a response, or the reason why it cannot be computed.

    Any exception is the failure of this half alone: other models are judged.
    """
    try:
        return solve(robot, reading)
    except UNSOLVED as error:
        return Unsolved(str(error))
    except Exception as error:  # noqa: BLE001  one model's failure is its own result
        return Unsolved(failure_reason(f"response of {model.name}", error), fault=True)


def _required(model: Model, half: H | Unsolved | None) -> H:
    if isinstance(half, Unsolved):
        raise ComputationError(half.reason)
    if half is None:
        raise ComputationError(f"{model.name} defines no such response")
    return half
