"""Responses of models of one robot, under readings of its file, each solved once when needed.

A response is a model under a reading, in all poses, in two halves: statics and modes. The halves
are solved independently of each other, one may be unsolved while the other stands. Readings with
perturbed inputs or digits are solved for the perturbed robot.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias, TypeVar

from lumped.acceptance.quantities import Quantity
from lumped.errors import ComputationError, InputError
from validation.case import failure_reason
from validation.references.perturbations import congruent, perturbed_robot, scaled
from validation.references.robot_on_path import Reading, RobotOnPath
from validation.responses.statics_and_modes import PathModes, Statics, Unsolved

# Fields of a reading that change the robot, and with it all models.
PERTURBATIONS = ("factors", "rounding")
# Errors that a robot may cause: walls too thin to mesh, a stiffness below round-off.
UNSOLVED = (InputError, ComputationError)

H = TypeVar("H")
Solve: TypeAlias = Callable[[RobotOnPath, Reading], H]


@dataclass(frozen=True, eq=False)
class Model:
    """Model of a robot: functions that solve both halves of its response.

    `statics` is None if the model does not define them; `modes` is None if it is static, and
    returns None if nothing has mass. `static_fields` and `modal_fields` are the fields of a
    reading that each half depends on. `silent`: reason why a half is not defined. `rigid`: reason
    for zeros in the compliance. `stand_in`: model whose changes by uncertain inputs are applied to
    this model if the robot has solids. None if it is always solved anew.
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
    stand_in: "Model | None" = None


@dataclass(frozen=True, eq=False)
class Responses:
    """Responses of models of a robot, by model and reading.

    A half is kept by the model and those fields of the reading that it depends on. `perturb`
    returns the robot with the perturbed inputs and digit of a reading.
    """

    robot: RobotOnPath
    perturb: Callable[[RobotOnPath, Reading], RobotOnPath] = perturbed_robot
    _statics: dict[tuple[Model, Reading], Statics | Unsolved] = field(
        default_factory=dict, repr=False
    )
    _modes: dict[tuple[Model, Reading], PathModes | Unsolved | None] = field(
        default_factory=dict, repr=False
    )
    _robots: dict[Reading, RobotOnPath] = field(default_factory=dict, repr=False)

    def perturbed(self, reading: Reading) -> RobotOnPath:
        """The robot under a reading. Raises InputError if there is no such robot."""
        key = reading.restricted(PERTURBATIONS)
        if not key.is_perturbed:
            return self.robot
        if key not in self._robots:
            self._robots[key] = self.perturb(self.robot, key)
        return self._robots[key]

    def statics(self, model: Model, reading: Reading) -> Statics | Unsolved | None:
        """Statics of a model. None if it does not define them."""
        if model.statics is None:
            return None
        key = model, reading.restricted((*model.static_fields, *PERTURBATIONS))
        if key not in self._statics:
            self._statics[key] = self._solved(model.statics, self.required_statics, congruent, *key)
        return self._statics[key]

    def modes(self, model: Model, reading: Reading) -> PathModes | Unsolved | None:
        """Modes of a model. None if it does not define them or nothing has mass."""
        if model.modes is None:
            return None
        key = model, reading.restricted((*model.modal_fields, *PERTURBATIONS))
        if key not in self._modes:
            self._modes[key] = self._solved(model.modes, self.required_modes, scaled, *key)
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

    def _solved(
        self,
        solve: Solve[H],
        required: Callable[[Model, Reading], Any],
        transfer: Callable[[Any, Any, Any], H],
        model: Model,
        reading: Reading,
    ) -> H | Unsolved:
        """Half of a response, or the reason why it cannot be computed.

        With perturbed inputs by the `transfer` of the changes of a stand-in, if the model has one.
        Any exception is the failure of this half alone: other models are judged.
        """
        nominal = replace(reading, factors=())
        stand_in = model.stand_in
        try:
            if stand_in is None or not reading.factors or not self.robot.has_solids:
                return solve(self.perturbed(reading), reading.unperturbed)
            return transfer(
                required(model, nominal), required(stand_in, nominal), required(stand_in, reading)
            )
        except UNSOLVED as error:
            return Unsolved(str(error))
        except Exception as error:  # noqa: BLE001  one model's failure is its own result
            return Unsolved(failure_reason(f"response of {model.name}", error), fault=True)

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


def _required(model: Model, half: H | Unsolved | None) -> H:
    if isinstance(half, Unsolved):
        raise ComputationError(half.reason)
    if half is None:
        raise ComputationError(f"{model.name} defines no such response")
    return half
