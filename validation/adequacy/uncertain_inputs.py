"""Errors of a robot's models for changed inputs, as functions of all uncertain inputs.

Input: errors of a model for the robot of the file, for robots in which one input is one standard
uncertainty lower or higher, and for some robots with all inputs changed. Output: `ErrorOfInputs`.
Rule: the curves fitted to the first robots are compared with the last; their root mean square
deviation widens the interval of the error.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lumped.acceptance.quantities import Quantity
from lumped.arrays import Array
from validation.adequacy.errors import Errors
from validation.adequacy.model_errors import ModelErrors
from validation.adequacy.probability import ErrorOfInputs, Slope
from validation.references.reference import InputUncertainties
from validation.references.responses import Model
from validation.responses.displacement import FLOOR
from validation.responses.statics_and_modes import Statics

# Number of fixed directions of force under which the error of "any force" is evaluated.
_FORCES = 8


@dataclass(frozen=True, eq=False)
class UncertainInputs:
    """Errors of a robot's models as functions of its uncertain `inputs`.

    `nominal`: errors with the inputs of the robot file.
    """

    nominal: ModelErrors
    inputs: InputUncertainties

    def error(
        self, model: Model, quantity: Quantity, nominal_errors: Errors
    ) -> ErrorOfInputs | None:
        """Dependence of a model's error of a quantity on the inputs.

        None if `nominal_errors` has missing errors, and for the order of modes, because its error
        jumps.
        """
        if nominal_errors.numbers is not None or nominal_errors.missing.any():
            return None
        below, above, together = (
            [_robot_errors(robot, model, quantity) for robot in all_errors]
            for all_errors in self._model_errors
        )
        forces = None
        if quantity.any_direction:
            forces = _worst_forces([nominal_errors, *(robot.errors for robot in (*below, *above))])
        slopes = [
            Slope(
                key,
                relative,
                low.components(nominal_errors, forces),
                high.components(nominal_errors, forces),
                np.stack([low.value(nominal_errors), high.value(nominal_errors)]),
            )
            for (key, relative), low, high in zip(
                self.inputs.relative.items(), below, above, strict=True
            )
        ]
        nominal_robot = replace(_robot_errors(self.nominal, model, quantity), errors=nominal_errors)
        error = ErrorOfInputs(
            nominal_robot.components(nominal_errors, forces),
            slopes,
            nominal_errors.displacement is None,
        )
        expected = error.intervals(self.inputs.draws)
        deviations = np.array([robot.interval(nominal_errors) for robot in together]) - expected
        lost = np.isnan(deviations) & ~np.isnan(expected)
        squared = np.ma.masked_invalid(deviations**2).mean(axis=0).filled(0.0)
        return replace(
            error,
            misfit=float(np.sqrt(squared.max())),
            lost=float(lost.any(axis=(1, 2)).mean()),
        )

    @cached_property
    def _model_errors(self) -> tuple[list[ModelErrors], ...]:
        kinds = self.inputs.alone(-1), self.inputs.alone(1), self.inputs.together
        nominal = self.nominal
        return tuple(
            [ModelErrors(nominal.subject, nominal.modes, factors) for factors in kind]
            for kind in kinds
        )


@dataclass(frozen=True, eq=False)
class _RobotErrors:
    """Errors of a quantity of a model for one robot. `errors` is None if the model has no solution.

    `statics`: statics of the reference and of the model for each interpretation, from which the
    errors are computed.
    """

    quantity: Quantity
    errors: Errors | None
    statics: Sequence[tuple[Statics, Statics]] = ()

    def components(self, nominal: Errors, forces: Array | None) -> Array:
        """Components of the errors, in the shape of `ErrorOfInputs.nominal`.

        `forces` (P×f×6): wrenches for which the errors are computed. If it is None, the errors are
        those under the load of the quantity (f = 1). NaN for missing errors. `nominal`: errors with
        the inputs of the robot file, which determine the shape. Shapes: P poses, f forces.
        """
        errors, vectorial = self.errors, nominal.displacement is not None
        count = 1 if forces is None else forces.shape[1]
        shape = (*nominal.error.shape, count, 8 if vectorial else 2)
        if errors is None:
            return np.full(shape, np.nan)
        components = np.empty(shape)
        components[..., -1] = errors.farthest[..., None]
        if errors.displacement is None:
            components[..., 0] = errors.error[..., None]
            return components
        for k, (reference, model) in enumerate(self.statics):
            wrenches = errors.displacement.wrench[k, :, None] if forces is None else forces
            components[k, ..., :3] = model.displacements(self.quantity, wrenches)
            components[k, ..., 3:6] = reference.displacements(self.quantity, wrenches)
            least = FLOOR * np.linalg.norm(reference.compliances[:, :3, :3], 2, axis=(1, 2))
            components[k, ..., 6] = least[:, None] if forces is not None else 0.0
        return np.where(errors.missing[..., None, None], np.nan, components)

    def interval(self, nominal: Errors) -> Array:
        """Lowest and highest error in each pose (2×P).

        NaN if the errors are missing. `nominal`: errors with the inputs of the robot file, in the
        same P poses.
        """
        if self.errors is None:
            return np.full((2, nominal.error.shape[1]), np.nan)
        return np.stack(self.errors.interval)

    def value(self, nominal: Errors) -> Array:
        """Value (P) that the model gives for the quantity.

        NaN if the errors are missing. `nominal`: errors with the inputs of the robot file, in the
        same P poses.
        """
        if self.errors is None:
            return np.full(nominal.error.shape[1], np.nan)
        return np.asarray(self.errors.value[0])


def _robot_errors(model_errors: ModelErrors, model: Model, quantity: Quantity) -> _RobotErrors:
    errors = model_errors.errors(model, quantity)
    return _RobotErrors(quantity, errors, model_errors.statics(model) if quantity.static else ())


def _worst_forces(errors: Sequence[Errors | None]) -> Array:
    """At most `_FORCES` unit wrenches (P×f×6), each the force of largest error of some robot.

    The first force is that of the first robot. Each further one is the force that is least parallel
    to all forces chosen before. Shapes: P poses, f forces.
    """
    first = errors[0]
    loads = [
        robot_errors.displacement.wrench
        for robot_errors in errors
        if robot_errors is not None and robot_errors.displacement
    ]
    all_forces = np.concatenate(loads).transpose(1, 0, 2)
    selected = []
    for pose, forces in enumerate(all_forces):
        start = 0 if first is None else int(first.largest[pose])
        order, alignments = [start], np.abs(forces @ forces[start])
        while len(order) < min(_FORCES, len(forces)):
            order.append(int(np.argmin(alignments)))
            alignments = np.maximum(alignments, np.abs(forces @ forces[order[-1]]))
        selected.append(forces[order])
    return np.array(selected)
