"""`flexproof solve`: one model of a leg or of the robot, printed or as JSON."""

import json
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.robot_file import RobotFile
from validation.models import (
    ModelName,
    ModelOptions,
    leg_compliance,
    leg_frequencies,
    robot_compliance,
    robot_frequencies,
)

# What each model listens to; anything else given on the command line is a fault.
_OPTIONS: dict[ModelName, tuple[str, ...]] = {
    "simplified": (),
    "vjm": ("legs", "theory", "equivalent"),
    "segments": ("theory", "elements", "release", "layout", "equivalent"),
    "beam": ("theory", "elements", "equivalent"),
    "solid": ("ends", "divisions", "equivalent"),
}
# Models that have no mass, so no frequencies.
_STATIC: tuple[ModelName, ...] = ("vjm",)
_DEFAULT_MODES = 6


@dataclass(frozen=True)
class Answer:
    """Compliance (6×6 or 2×2, SI) and frequencies (Hz, ascending) at one posture or of one leg."""

    place: dict[str, float | int]
    compliance: Array
    frequencies: Array


def option_faults(model: ModelName, given: dict[str, Any], leg: int | None) -> list[str]:
    """Options that this model does not listen to, or values outside what is allowed."""
    faults = []
    allowed = ", ".join(f"--{option}" for option in _OPTIONS[model]) or "none"
    faults += [
        f"--{name}: not an option of the {model} model; it takes {allowed}"
        for name in given
        if name not in _OPTIONS[model]
    ]
    for name in ("elements", "divisions"):
        if given.get(name, 1) < 1:
            faults.append(f"--{name} = {given[name]}: must be 1 or more")
    if leg is not None and leg not in (1, 2):
        faults.append(f"--leg = {leg}: must be 1 or 2")
    if leg is not None and model == "simplified":
        faults.append("--leg: the legs of the simplified model are rigid")
    return faults


def solve(
    robot_file: RobotFile,
    model: ModelName,
    positions: tuple[float, ...],
    leg: int | None,
    modes: int | None,
    given: dict[str, Any],
) -> tuple[ModelOptions, list[Answer]]:
    """The model's answers at the positions x (m) of B, or for one leg.

    Raises InputError, all faults at once.
    """
    faults = option_faults(model, given, leg)
    if modes is not None and modes < 0:
        faults.append(f"--modes = {modes}: must be 0 or more")
    if modes and (model in _STATIC):
        faults.append(f"--modes: the {model} model is static and has no frequencies")
    if leg is not None and positions:
        faults.append("--x: a leg alone has no position; leave out --x or --leg")
    robot = robot_file.robot
    faults += _position_faults(robot_file, positions)
    if faults:
        raise InputError(faults)
    options = ModelOptions(**given)
    count = 0 if model in _STATIC else _DEFAULT_MODES if modes is None else modes
    if leg is not None:
        chosen = robot.leg1 if leg == 1 else robot.leg2
        frequencies = leg_frequencies(model, chosen, count, options) if count else np.zeros(0)
        answer = Answer({"leg": leg}, leg_compliance(model, chosen, options), frequencies)
        return options, [answer]
    answers = []
    for x in positions or (robot.centre,):
        frequencies = robot_frequencies(model, robot, x, count, options) if count else np.zeros(0)
        answers.append(Answer({"x": x}, robot_compliance(model, robot, x, options), frequencies))
    return options, answers


def _position_faults(robot_file: RobotFile, positions: tuple[float, ...]) -> list[str]:
    faults: list[str] = []
    for x in positions:
        try:
            robot_file.robot.posture(x)
        except InputError as error:
            faults += [f"--x: {fault}" for fault in error.faults]
    return faults


def as_json(
    robot_file: RobotFile, model: ModelName, options: ModelOptions, answers: list[Answer]
) -> str:
    """The answers as JSON (schema 1); an infinite frequency is null."""
    heard = {name: value for name, value in asdict(options).items() if name in _OPTIONS[model]}
    document = {
        "schema": 1,
        "robot": robot_file.robot.name,
        "model": model,
        "options": heard,
        "results": [
            {
                **answer.place,
                "compliance": answer.compliance.tolist(),
                "frequencies": [f if np.isfinite(f) else None for f in answer.frequencies.tolist()],
            }
            for answer in answers
        ],
    }
    return json.dumps(document, ensure_ascii=False, allow_nan=False)


def as_text(
    robot_file: RobotFile, model: ModelName, options: ModelOptions, answers: list[Answer]
) -> str:
    """The answers for people: deflections at 1000 N, the compliance, the frequencies."""
    heard = [
        f"{entry.name} {getattr(options, entry.name)}"
        for entry in fields(options)
        if entry.name in _OPTIONS[model]
    ]
    lines = [f"{robot_file.robot.name}, {model}" + (f" ({', '.join(heard)})" if heard else "")]
    for answer in answers:
        lines += ["", *_answer_lines(answer)]
    return "\n".join(lines)


def _answer_lines(answer: Answer) -> list[str]:
    size = len(answer.compliance)
    if "leg" in answer.place:
        head = f"leg {answer.place['leg']}, root clamped, leg axes"
    else:
        head = f"x = {answer.place['x']:.6g} m, at the loaded point, robot axes"
    under = ["x", "y"] if size == 2 else ["x", "y", "z"]
    lines = [head, "  deflection (µm) along its own load of 1000 N:"]
    lines.append(
        "    "
        + ", ".join(f"{axis} {answer.compliance[i, i] * 1e9:.4g}" for i, axis in enumerate(under))
    )
    lines.append(f"  compliance {size}×{size} (m/N, rad/N, rad/(N m)):")
    lines += ["    " + " ".join(f"{value: .4e}" for value in row) for row in answer.compliance]
    if len(answer.frequencies):
        listed = ", ".join(f"{value:.5g}" for value in answer.frequencies)
        lines.append(f"  natural frequencies (Hz): {listed}")
    return lines
