"""Best of several varied robots: smallest or largest value of one quantity, under conditions.

Input: texts such as "mass" and "f1>=60", and the answers of one model for each robot. Output: the
quantities of each robot, the robots that meet all conditions, and the best of these robots. Rule:
of the poses of a robot the worst one counts, that is the largest deflection and the lowest
frequency.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lumped.acceptance.quantities import AXES, ROTATIONS
from lumped.arrays import Array
from lumped.errors import InputError, collect_faults
from lumped.mechanism.body import Body, Part
from lumped.mechanism.mechanism import GROUND, Mechanism
from lumped.robot_file import RobotFile
from lumped.text import counted, did_you_mean
from validation.models.loads.statics import interface_mass
from validation.models.reduced_parts import condensed
from validation.solve.answer import Answer

# Loads of deflections: force (N) for displacements, moment (N m) for rotations.
_FORCE, _MOMENT = 1000.0, 100.0
_CONDITION = re.compile(r"(?P<name>[^<>=]+)(?P<sense><=|>=|<|>)(?P<bound>[^<>=]+)")
# Relative difference from the best value below which robots count as equal: round-off.
_EQUAL = 1e-9


class DesignKind(Enum):
    """Kind of a quantity by which robots are chosen: mass, frequency, deflection or load."""

    MASS = "mass"
    DEFLECTION = "deflection under a unit load"
    LOAD = "displacement under a load of the robot file"
    FREQUENCY = "natural frequency"


@dataclass(frozen=True)
class DesignQuantity:
    """Quantity of a robot that can be minimised, maximised or bounded, by its typed `name`.

    `unit`: unit of the typed bound, for a deflection with its load, "m at 1000 N". `column`: index
    of the axis of a deflection, or of the frequency. `load`: name of a load.
    """

    name: str
    kind: DesignKind
    unit: str
    column: int = 0
    load: str = ""

    def value(self, mechanism: Mechanism, answers: Sequence[Answer]) -> float:
        """Value (SI) of the quantity in the pose in which it is worst.

        NaN if any pose has no value.
        """
        if self.kind is DesignKind.MASS:
            return total_mass(mechanism)
        return _worst([self._in_pose(answer) for answer in answers], self.kind)

    def _in_pose(self, answer: Answer) -> float:
        k = self.column
        if self.kind is DesignKind.LOAD:
            return float(np.linalg.norm(answer.loads[self.load][:3]))
        if self.kind is DesignKind.DEFLECTION:
            unit_load = _MOMENT if AXES[k] in ROTATIONS else _FORCE
            is_in_compliance = k < len(answer.compliance)
            return unit_load * float(answer.compliance[k, k]) if is_in_compliance else np.nan
        return float(answer.frequencies[k]) if k < len(answer.frequencies) else np.nan


def _worst(values: Sequence[float], kind: DesignKind) -> float:
    return float(np.min(values) if kind is DesignKind.FREQUENCY else np.max(values))


@dataclass(frozen=True)
class Condition:
    """Upper or lower bound (SI) on a quantity. `text`: the condition as typed by the user."""

    text: str
    quantity: DesignQuantity
    at_most: bool
    bound: float

    def excess(self, values: Array) -> Array:
        """Relative distances by which values miss the bound. Negative for values that meet it."""
        difference = values - self.bound if self.at_most else self.bound - values
        return np.asarray(difference / (abs(self.bound) or 1.0))


@dataclass(frozen=True)
class Purpose:
    """Quantity to be minimised or maximised (`objective`), and conditions to be met.

    `objective` is None if only the conditions count.
    """

    objective: DesignQuantity | None
    maximised: bool
    conditions: tuple[Condition, ...]

    @property
    def quantities(self) -> tuple[DesignQuantity, ...]:
        """All quantities, the objective first."""
        listed = [self.objective] if self.objective else []
        return tuple(
            dict.fromkeys([*listed, *(condition.quantity for condition in self.conditions)])
        )


@dataclass(frozen=True, eq=False)
class DesignChoice:
    """Choice between n robots by the `values` (n each, SI) of the quantities in a purpose."""

    purpose: Purpose
    values: Mapping[DesignQuantity, Array]

    @cached_property
    def meets(self) -> NDArray[np.bool_]:
        """True (n) for robots that meet all conditions. False if a quantity has no value."""
        return np.asarray((self._worst_excess <= 0.0) & self._known)

    @property
    def best(self) -> int | None:
        """Index of the best robot that meets all conditions, the first one if several are equal.

        None if there is no such robot or no objective.
        """
        if self.purpose.objective is None or not self.meets.any():
            return None
        values = self.values[self.purpose.objective]
        cost = np.where(self.meets, -values if self.purpose.maximised else values, np.inf)
        return int(np.flatnonzero(cost <= cost.min() + _EQUAL * abs(cost.min()))[0])

    @property
    def nearest(self) -> tuple[int, Condition, float] | None:
        """Robot closest to meeting all conditions: index, worst condition and its `excess`.

        None if no robot has all quantities of the purpose, or if there are no conditions.
        """
        if not self.purpose.conditions or not self._known.any():
            return None
        robot = int(np.argmin(np.where(self._known, self._worst_excess, np.inf)))
        row = int(np.argmax(self._excess[:, robot]))
        return robot, self.purpose.conditions[row], float(self._excess[row, robot])

    @cached_property
    def _excess(self) -> Array:
        """Relative distances (c×n) by which n robots miss c conditions; negative if met."""
        rows = [
            condition.excess(self.values[condition.quantity])
            for condition in self.purpose.conditions
        ]
        return np.array(rows).reshape(len(rows), -1)

    @property
    def _worst_excess(self) -> Array:
        if not self.purpose.conditions:
            return np.zeros(len(self._known))
        return np.asarray(self._excess.max(axis=0))

    @cached_property
    def _known(self) -> NDArray[np.bool_]:
        return np.asarray(np.isfinite(list(self.values.values())).all(axis=0))


def purpose_of(
    robot_file: RobotFile,
    minimise: str | None,
    maximise: str | None,
    where: Sequence[str],
    modes: int,
) -> Purpose | None:
    """Purpose from the options --minimise or --maximise and --where. None if none is used.

    `modes` is the number of frequencies that are computed. Raises InputError with a line for each
    fault.
    """
    if minimise is not None and maximise is not None:
        raise InputError("--maximise: cannot be combined with --minimise; leave one of them out")
    allowed = _quantities(robot_file, modes)
    conditions, faults = collect_faults(lambda text: _condition(text, allowed), where)
    option, name = ("--maximise", maximise) if minimise is None else ("--minimise", minimise)
    if name is not None and name not in allowed:
        faults.append(f"{option} {name}: {_unknown(name, allowed)}")
    if faults:
        raise InputError(faults)
    if name is None and not conditions:
        return None
    objective = None if name is None else allowed[name]
    return Purpose(objective, maximise is not None, tuple(conditions))


def design_choice(
    purpose: Purpose, mechanisms: Sequence[Mechanism], answers: Sequence[Sequence[Answer]]
) -> DesignChoice:
    """Choice between robots by their mechanisms, and by their answers in all poses."""
    robots = list(zip(mechanisms, answers, strict=True))
    values = {
        quantity: np.array([quantity.value(*robot) for robot in robots])
        for quantity in purpose.quantities
    }
    return DesignChoice(purpose, values)


def total_mass(mechanism: Mechanism) -> float:
    """Mass (kg) of all bodies and of the tool. CAD parts count with the mass of their meshes."""
    return mechanism.tool.mass + sum(
        _part_mass(body) if isinstance(body.shape, Part) else body.shape.mass
        for body in mechanism.bodies.values()
        if body.name != GROUND
    )


def _part_mass(body: Body) -> float:
    """Mass (kg) of a CAD part: twice the kinetic energy of a unit translation along x."""
    mass = interface_mass(condensed(body))
    return float(mass[::6, ::6].sum())


def _quantities(robot_file: RobotFile, modes: int) -> dict[str, DesignQuantity]:
    """Quantities that can be minimised, maximised or bounded, by the name to be typed."""
    deflections = [
        DesignQuantity(
            f"deflection.{axis}",
            DesignKind.DEFLECTION,
            f"rad at {_MOMENT:g} N m" if axis in ROTATIONS else f"m at {_FORCE:g} N",
            column,
        )
        for column, axis in enumerate(AXES)
    ]
    frequencies = [
        DesignQuantity(f"f{mode + 1}", DesignKind.FREQUENCY, "Hz", mode) for mode in range(modes)
    ]
    loads = [
        DesignQuantity(f"load:{load.name}", DesignKind.LOAD, "m", load=load.name)
        for load in robot_file.mechanism.loads
    ]
    mass = DesignQuantity("mass", DesignKind.MASS, "kg")
    return {quantity.name: quantity for quantity in (mass, *deflections, *frequencies, *loads)}


def _unknown(name: str, allowed: Mapping[str, DesignQuantity]) -> str:
    return f"must be one of {', '.join(allowed)}{did_you_mean(name, allowed)}"


def _condition(text: str, allowed: Mapping[str, DesignQuantity]) -> Condition:
    match = _CONDITION.fullmatch(text.replace(" ", ""))
    if match is None:
        raise InputError(f"--where {text}: must be QUANTITY>=NUMBER or QUANTITY<=NUMBER")
    name, sense = match["name"], match["sense"]
    if name not in allowed:
        raise InputError(f"--where {text}: {_unknown(name, allowed)}")
    try:
        bound = float(match["bound"])
    except ValueError:
        bound = np.nan
    if not np.isfinite(bound):
        unit = allowed[name].unit
        raise InputError(f"--where {text}: {match['bound']} must be a finite number ({unit})")
    typed = f"{name}{sense}{match['bound']}"
    return Condition(typed, allowed[name], sense in ("<", "<="), bound)


def choice_text(choice: DesignChoice, names: Sequence[str]) -> str:
    """Text with the chosen robot, or with the reason why there is none.

    `names` (n): text for each robot with the keys and values of its varied parameters.
    """
    purpose, count = choice.purpose, len(names)

    def values(robot: int) -> str:
        return ", ".join(
            f"{quantity.name} {numbers[robot]:.5g} {quantity.unit}"
            for quantity, numbers in choice.values.items()
        )

    met = int(choice.meets.sum())
    lines = []
    if purpose.conditions:
        condition_text = " and ".join(condition.text for condition in purpose.conditions)
        verb = "meets" if met == 1 else "meet"
        lines.append(f"{met} of {counted(count, 'robot')} {verb} {condition_text}")
    if choice.best is not None and purpose.objective:
        aim = "greatest" if purpose.maximised else "least"
        lines.append(
            f"{aim} {purpose.objective.name}: {names[choice.best]} ({values(choice.best)})"
        )
    elif not met and (near := choice.nearest):
        robot, condition, miss = near
        lines.append(
            f"nearest: {names[robot]} misses {condition.text} by {100.0 * miss:.3g} % "
            f"({values(robot)})"
        )
    return "\n".join(lines)


def choice_record(choice: DesignChoice, values: Sequence[Mapping[str, float]]) -> dict[str, Any]:
    """Plain data of the choice, for JSON. `values` (n): varied parameters of each robot by key."""
    purpose, best = choice.purpose, choice.best
    robots = [
        {
            "vary": dict(numbers),
            "values": {
                quantity.name: float(of_robots[row])
                for quantity, of_robots in choice.values.items()
            },
            "meets": bool(choice.meets[row]),
        }
        for row, numbers in enumerate(values)
    ]
    aim = "maximise" if purpose.maximised else "minimise"
    return {
        aim: purpose.objective and purpose.objective.name,
        "where": [condition.text for condition in purpose.conditions],
        "units": {quantity.name: quantity.unit for quantity in choice.values},
        "robots": robots,
        "best": None if best is None else robots[best],
    }
