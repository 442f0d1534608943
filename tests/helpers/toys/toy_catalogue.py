"""Made-up cases for the tests of runner and command line; workers import this module by name."""

import os
import resource
import signal
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from lumped.errors import ComputationError
from lumped.robot_file import RobotFile
from validation.case import Absolute, Case, Measurement, Skip
from validation.context import Context
from validation.exhibits import Figure, PlannedFigure, Study
from validation.results.outcome import Task


def case(identifier: str, compute: Callable[[Context], Measurement], **changes: Any) -> Case:
    fields = {
        "title": f"Toy {identifier}",
        "quantity": "length",
        "unit": "m",
        "reference_kind": "closed-form",
        "citation": "made up",
        "tolerance": Absolute(0.1),
        "tolerance_reason": "made up",
        "section": "Toys",
    }
    return Case(id=identifier, compute=compute, **fields | changes)


def agrees(_context: Context) -> Measurement:
    study = Study(
        id="toy.study",
        title="Toy study",
        x_label="x (m)",
        y_label="y",
        unit="m",
        x=(1.0, 2.0),
        series={"beam": (1.0, 2.0)},
    )
    return Measurement(1.0 / 3.0, 0.34, exact=True, studies=(study,))


def disagrees(_context: Context) -> Measurement:
    return Measurement(2.0, 1.0, exact=True)


def expensive(length: float) -> tuple[float, int]:
    return 2.0 * length, time.perf_counter_ns()


def shares(context: Context) -> Measurement:
    value, moment = context.get(
        expensive, float(context.robot_file.mechanism.reference["slide2"].position[0])
    )
    return Measurement(value, 1.84, exact=True, notes=(f"{os.getpid()} {moment}",))


def is_singular(_context: Context) -> Measurement:
    raise ComputationError("leg 2: the stiffness matrix is singular")


def has_a_bug(_context: Context) -> Measurement:
    print("this belongs into the log")  # noqa: T201
    empty: list[float] = []
    return Measurement(empty.pop(), 1.0, exact=True)


def crashes(_context: Context) -> Measurement:
    os.kill(os.getpid(), signal.SIGSEGV)
    raise AssertionError


def starves(_context: Context) -> Measurement:
    matrix = np.eye(300)
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    used = 1024 * int(status.partition("VmSize:")[2].split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (used + 2**22, used + 2**22))
    return Measurement(np.linalg.solve(matrix, matrix)[0, 0], 1.0, exact=True)


def needs_a_program(_context: Context) -> Measurement:
    raise Skip("CalculiX is not installed")


def sleeps(_context: Context) -> Measurement:
    time.sleep(60.0)
    return Measurement(1.0, 1.0, exact=True)


def draws(_context: Context) -> Figure:
    return Figure("toy.figure", "Toy", "A caption.", "Toys", svg="<svg ></svg>", data="x\n1\n")


def cannot_draw(_context: Context) -> Figure:
    raise Skip("no OpenGL")


def sound(_robot_file: RobotFile) -> Sequence[Task]:
    return (
        case("toy.agrees", agrees),
        case("toy.first[x=1]", shares, group="shared"),
        case("toy.second[x=2]", shares, group="shared"),
        case("toy.skipped", needs_a_program),
        PlannedFigure("toy.figure", "Toy figure", draws),
        PlannedFigure("toy.undrawn", "Toy figure that cannot be drawn", cannot_draw),
    )


def disagreeing(robot_file: RobotFile) -> Sequence[Task]:
    return (*sound(robot_file), case("toy.disagrees", disagrees))


def troubled(robot_file: RobotFile) -> Sequence[Task]:
    return (
        *disagreeing(robot_file),
        case("toy.singular", is_singular),
        case("toy.bug", has_a_bug),
        case("toy.crash", crashes, group="crash"),
        case("toy.after-the-crash", agrees, group="crash"),
        case("toy.starved", starves, group="crash"),
    )


def endless(_robot_file: RobotFile) -> Sequence[Task]:
    return (
        case("toy.agrees", agrees, group="one"),
        case("toy.sleeps", sleeps, group="one"),
    )


def unloadable(_robot_file: RobotFile) -> Sequence[Task]:
    if os.environ["TOY_PARENT"] != str(os.getpid()):
        raise RuntimeError("only workers come here")
    return (case("toy.agrees", agrees),)


def slowly(_context: Context) -> Measurement:
    time.sleep(0.03)
    return Measurement(1.0 / 3.0, 0.34, exact=True)


def real(robot_file: RobotFile) -> Sequence[Task]:
    """Some of the paper's cases between others of a steady pace, and a figure."""
    from validation import paper  # noqa: PLC0415  the other catalogues do not need it

    steady = tuple(case(f"toy.steady[{k}]", slowly) for k in range(12))
    of_paper = (replace(one, subject="robot") for one in paper.cases()[::2])
    return (*steady[:6], *of_paper, *steady[6:], *sound(robot_file))


def chatty(_robot_file: RobotFile) -> Sequence[Task]:
    """Fills a small disk within its first cases."""
    return tuple(case(f"toy.chatty[{k}]", tells_much) for k in range(12))


def tells_much(_context: Context) -> Measurement:
    return Measurement(1.0 / 3.0, 0.34, exact=True, notes=("tell" * 5000,))
