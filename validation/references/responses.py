"""Store of solved models: statics and modes of each model under each reading, solved when needed.

Input: a `Model` (one function for statics and one for modes) and a `Reading` of the robot file.
Output: `Statics` or `PathModes` in all poses, or `Unsolved` with the reason. Rule: the key of a
stored solution is the model and those fields of the reading on which it depends, so that readings
which differ in other fields share the solution. Statics and modes are independent: one may fail
while the other is solved. Readings with perturbed inputs or digits are solved for the perturbed
robot, but a reference of solids is not solved again for changed inputs. Beams with computed section
constants and the same end conditions are solved with and without the changes, and the reference
changes in the same way: compliances by a congruence C = T C_beams Tᵀ, where T = L L_beams⁻¹ and L,
L_beams are the Cholesky factors of the compliances without changes; each frequency by the ratio of
the beam frequencies. This is accurate for changes of a few per cent.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, TypeAlias, TypeVar

import numpy as np

from lumped.acceptance.quantities import Quantity
from lumped.errors import ComputationError, InputError
from lumped.mechanism.mechanism import Posture
from validation.case import failure_reason
from validation.kinematics.poses import postures_of
from validation.models.loads.statics import LoadForces
from validation.models.reduced_parts import unknowns_of, with_unknowns
from validation.references.robot_on_path import Reading, RobotOnPath, robot_at
from validation.responses.mode_partners import partners
from validation.responses.statics_and_modes import PathModes, Statics, Unsolved
from validation.run.executor import Executor, in_order

# Fields of a reading that change the robot itself, and therefore affect all models.
PERTURBATIONS = ("factors", "rounding")
# Errors that a robot may cause: walls too thin to mesh, a stiffness below round-off.
UNSOLVED = (InputError, ComputationError)

H = TypeVar("H")
Solve: TypeAlias = Callable[[RobotOnPath, Reading], H]
# Forces in joints and legs in each pose (outer sequence) under each load (inner sequence). None if
# the mechanism cannot move as the load requires.
PathForces: TypeAlias = Sequence[Sequence[LoadForces | None]]


def perturbed_robot(robot: RobotOnPath, reading: Reading) -> RobotOnPath:
    """Robot with the changed inputs and printed number of `reading`, in the same poses.

    Raises InputError if the changed values make an invalid robot.
    """
    if reading.factors:
        mechanism = robot.context.robot_file.with_factors(dict(reading.factors))
        # Meshes of CAD parts keep their size.
        unknowns = {name: unknowns_of(body) for name, body in robot.mechanism.parts.items()}
        mechanism = with_unknowns(mechanism, unknowns)
        poses = [posture.pose for posture in robot.postures]
        robot = robot_at(robot.context, postures_of(mechanism, poses))
    if reading.rounding is not None:
        robot = replace(robot, postures=tuple(robot.roundings[reading.rounding].postures))
    return robot


def congruent(reference: Statics, nominal: Statics, perturbed: Statics) -> Statics:
    """Statics of a reference under perturbed inputs, from those of a cheaper beam model.

    `nominal` and `perturbed` are statics of the beam model (the stand-in) without and with the
    change of inputs. The change of displacements under loads is T = L L_beams⁻¹ times
    that of the beam model.
    """
    change = perturbed - nominal
    try:
        lower = np.linalg.cholesky(reference.compliances)
        lower = lower @ np.linalg.inv(np.linalg.cholesky(nominal.compliances))
    except np.linalg.LinAlgError:
        # There is no Cholesky factor if the robot is rigid in a direction: the change of the beam
        # model is added.
        return Statics(
            reference.compliances + change.compliances,
            reference.load_displacements + change.load_displacements,
        )
    upper = np.swapaxes(lower, 1, 2)
    return Statics(
        lower @ perturbed.compliances @ upper,
        reference.load_displacements + change.load_displacements @ upper,
    )


def scaled(reference: PathModes, nominal: PathModes, perturbed: PathModes) -> PathModes:
    """Modes of a reference under perturbed inputs, from those of a cheaper beam model.

    `nominal` and `perturbed` are modes of the beam model (the stand-in) without and with the change
    of inputs. Each frequency is multiplied by the ratio of the frequencies of the beam mode with
    the same shape, and each peak of a harmonic response by the ratio of the beam model's peaks.
    """
    count = min(modes.frequencies.shape[1] for modes in (reference, nominal, perturbed))
    partner_indices = partners(reference, nominal, count).partner_indices
    partner_indices = np.where(partner_indices >= 0, partner_indices, np.arange(count))
    changes = perturbed.frequencies[:, :count] / nominal.frequencies[:, :count]
    ratio = np.take_along_axis(changes, partner_indices, 1)
    with np.errstate(invalid="ignore"):
        peaks = reference.peaks * (perturbed.peaks / nominal.peaks)
    first = reference.first(count)
    return replace(first, frequencies=first.frequencies * ratio, peaks=peaks)


@dataclass(frozen=True, eq=False)
class Model:
    """Model of a robot: a function each for its statics, its modes and the forces in its bodies.

    `statics` is None if the model does not define statics. `modes` is None if it does not define
    modes; the function returns None if nothing has mass. `forces` is None unless a study needs
    forces. `static_fields` are the fields of a reading on which statics and forces depend,
    `modal_fields` those on which modes depend. `undefined_reason`: reason why statics or
    modes are not defined. `rigid`: reason for zeros in the compliance. `computed_by`: names of the
    functions that compute the model. `stand_in`: a cheaper model for uncertain inputs. If the robot
    has solids, the relative changes of the stand-in's results are applied to this model. If
    `stand_in` is None, this model is solved for each change of inputs.
    """

    name: str
    title: str = ""
    statics: Solve[Statics] | None = None
    modes: Solve[PathModes | None] | None = None
    static_fields: tuple[str, ...] = ()
    modal_fields: tuple[str, ...] = ()
    undefined_reason: str = ""
    rigid: str = ""
    computed_by: tuple[str, ...] = ()
    stand_in: "Model | None" = None
    forces: Solve[PathForces] | None = None


@dataclass(frozen=True, eq=False)
class Responses:
    """Solutions of all models of one robot, stored by model and reading.

    `perturb` builds the robot with the changed inputs and printed number of a reading. If
    `strict`, errors are raised instead of recorded, for studies of a single model.
    """

    robot: RobotOnPath
    perturb: Callable[[RobotOnPath, Reading], RobotOnPath] = perturbed_robot
    strict: bool = False
    _statics: dict[tuple[Model, Reading], Statics | Unsolved] = field(
        default_factory=dict, repr=False
    )
    _modes: dict[tuple[Model, Reading], PathModes | Unsolved | None] = field(
        default_factory=dict, repr=False
    )
    _forces: dict[tuple[Model, Reading], PathForces] = field(default_factory=dict, repr=False)
    _robots: dict[Reading, RobotOnPath] = field(default_factory=dict, repr=False)

    def at(self, postures: Sequence[Posture]) -> "Responses":
        """Responses of the robot in other postures, of which none is solved yet.

        Bodies are reduced for the same frequencies as before, so that postures can be solved one by
        one with the results that they have together.
        """
        return Responses(self.robot.at(postures), self.perturb, self.strict)

    def perturbed(self, reading: Reading) -> RobotOnPath:
        """Robot with the changed inputs and the changed printed number of `reading`.

        Raises InputError if the changes make an invalid robot.
        """
        if not reading.factors and reading.rounding is None:
            return self.robot
        key = reading.restricted(PERTURBATIONS)
        if key not in self._robots:
            self._robots[key] = self.perturb(self.robot, key)
        return self._robots[key]

    def statics(self, model: Model, reading: Reading) -> Statics | Unsolved | None:
        """Statics of a model under one `reading` of the robot file, or why they are unsolved.

        None if the model does not define statics.
        """
        if model.statics is None:
            return None
        key = model, reading.restricted((*model.static_fields, *PERTURBATIONS))
        if key not in self._statics:
            self._statics[key] = self._solved(model.statics, self.required_statics, congruent, *key)
        return self._statics[key]

    def modes(self, model: Model, reading: Reading) -> PathModes | Unsolved | None:
        """Modes of a model under one `reading` of the robot file, or why they are unsolved.

        None if the model does not define modes or nothing has mass.
        """
        if model.modes is None:
            return None
        key = model, reading.restricted((*model.modal_fields, *PERTURBATIONS))
        if key not in self._modes:
            self._modes[key] = self._solved(model.modes, self.required_modes, scaled, *key)
        return self._modes[key]

    def solution(
        self, model: Model, reading: Reading, quantity: Quantity
    ) -> Statics | PathModes | Unsolved | None:
        """Statics or modes of a model: those from which the quantity is computed."""
        return (self.statics if quantity.static else self.modes)(model, reading)

    def solve_ahead(self, requests: Sequence[tuple[Model, Reading]], executor: Executor) -> None:
        """Solve and store statics and modes of models under readings, by an executor.

        The readings must not be perturbed. Errors are raised.
        """
        solved_by = Responses(self.robot, self.perturb, strict=True)
        calls = [partial(_both, solved_by, *request) for request in requests]
        for (model, reading), (statics, modes) in zip(
            requests, in_order(executor, calls), strict=True
        ):
            self._statics[model, reading.restricted((*model.static_fields, *PERTURBATIONS))] = (
                statics
            )
            self._modes[model, reading.restricted((*model.modal_fields, *PERTURBATIONS))] = modes

    def known_statics(self, model: Model, reading: Reading) -> Statics | None:
        """Statics of a model. None if the model does not define them or they are unsolved."""
        solution = self.statics(model, reading)
        return solution if isinstance(solution, Statics) else None

    def known_modes(self, model: Model, reading: Reading) -> PathModes | None:
        """Modes of a model. None if the model does not define them or they are unsolved."""
        solution = self.modes(model, reading)
        return solution if isinstance(solution, PathModes) else None

    def required_statics(self, model: Model, reading: Reading) -> Statics:
        """Statics of a model.

        Raises ComputationError if the model does not define statics or they are unsolved.
        """
        return _required(model, self.statics(model, reading))

    def required_modes(self, model: Model, reading: Reading) -> PathModes:
        """Modes of a model.

        Raises ComputationError if the model does not define modes or they are unsolved.
        """
        return _required(model, self.modes(model, reading))

    def required_forces(self, model: Model, reading: Reading) -> PathForces:
        """Forces in the joints and legs of a model under a reading.

        Raises ComputationError if the model defines no forces, and the errors of its computation.
        """
        if model.forces is None:
            return _required(model, None)
        key = model, reading.restricted((*model.static_fields, *PERTURBATIONS))
        if key not in self._forces:
            self._forces[key] = model.forces(self.perturbed(reading), key[1])
        return self._forces[key]

    def unsolved(self, model: Model, reading: Reading, quantity: Quantity) -> str:
        """Reason why a quantity of a model cannot be computed. "" if it can be computed."""
        solution = self.solution(model, reading, quantity)
        return solution.reason if isinstance(solution, Unsolved) else ""

    def _solved(
        self,
        solve: Solve[H],
        required: Callable[[Model, Reading], Any],
        transfer: Callable[[Any, Any, Any], H],
        model: Model,
        reading: Reading,
    ) -> H | Unsolved:
        """Statics or modes of a model under `reading`, or the reason why they are unsolved.

        `solve` computes the solution for a robot. There is another way if inputs are perturbed, the
        model has a stand-in and the robot has solids: `transfer` applies the changes of the
        stand-in's solution to the unperturbed solution, and `required` returns the solutions that
        `transfer` needs. Any exception is recorded as the failure of this solution alone, so that
        other models are still judged; it is raised if `strict`.
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
            if self.strict:
                raise
            return Unsolved(str(error))
        except Exception as error:
            if self.strict:
                raise
            return Unsolved(failure_reason(f"response of {model.name}", error), fault=True)

    @property
    def faults(self) -> tuple[str, ...]:
        """Names of the models whose statics or modes ended with an error of the program."""
        solutions = (*self._statics.items(), *self._modes.items())
        return tuple(
            dict.fromkeys(
                model.name
                for (model, _), solution in solutions
                if isinstance(solution, Unsolved) and solution.fault
            )
        )


def _both(responses: Responses, model: Model, reading: Reading) -> tuple[Statics, PathModes]:
    return responses.required_statics(model, reading), responses.required_modes(model, reading)


def _required(model: Model, solution: H | Unsolved | None) -> H:
    if isinstance(solution, Unsolved):
        raise ComputationError(solution.reason)
    if solution is None:
        raise ComputationError(
            f"the model {model.name} does not define the requested statics or modes"
        )
    return solution
