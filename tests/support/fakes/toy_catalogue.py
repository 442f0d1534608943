"""Artificial comparisons for tests of runner and command line. Workers import this module."""

import os
import resource
import signal
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from lumped.errors import ComputationError
from validation.case import Absolute, Case, Measurement, Skip
from validation.studies_and_figures import Figure, PlannedFigure, Study

STUDY = Study("toy.study", "Toy study", "x (m)", "y", "m", (1.0, 2.0), {"beam": (1.0, 2.0)})


def case(identifier, compute, **changes):
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


def agrees(_context):
    return Measurement(1.0 / 3.0, 0.34, exact=True, studies=(STUDY,))


def disagrees(_context):
    return Measurement(2.0, 1.0, exact=True)


def expensive(length):
    return 2.0 * length, time.perf_counter_ns()


def shares(context):
    position = context.robot_file.mechanism.reference["slide2"].position
    value, moment = context.get(expensive, float(position[0]))
    return Measurement(value, 1.84, exact=True, notes=(f"{os.getpid()} {moment}",))


def is_singular(_context):
    raise ComputationError("leg 2: the stiffness matrix is singular")


def has_a_bug(_context):
    print("this belongs into the log")  # noqa: T201
    return [].pop()


def crashes(_context):
    os.kill(os.getpid(), signal.SIGSEGV)


def starves(_context):
    matrix = np.eye(300)
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    used = 1024 * int(status.partition("VmSize:")[2].split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (used + 2**22, used + 2**22))
    return Measurement(np.linalg.solve(matrix, matrix)[0, 0], 1.0, exact=True)


def needs_a_program(_context):
    raise Skip("CalculiX is not installed")


def draws(_context):
    return Figure("toy.figure", "Toy", "A caption.", "Toys", svg="<svg ></svg>", data="x\n1\n")


def cannot_draw(_context):
    raise Skip("no OpenGL")


def sound(_robot_file):
    return (
        case("toy.agrees", agrees),
        case("toy.first[x=1]", shares, group="shared"),
        case("toy.second[x=2]", shares, group="shared"),
        case("toy.skipped", needs_a_program),
        PlannedFigure("toy.figure", "Toy figure", draws),
        PlannedFigure("toy.undrawn", "Toy figure that cannot be drawn", cannot_draw),
    )


def disagreeing(robot_file):
    return (*sound(robot_file), case("toy.disagrees", disagrees))


def troubled(robot_file):
    return (
        *disagreeing(robot_file),
        case("toy.singular", is_singular),
        case("toy.bug", has_a_bug),
        case("toy.crash", crashes, group="crash"),
        case("toy.after-the-crash", agrees, group="crash"),
        case("toy.starved", starves, group="crash"),
    )


def sleeps(_context):
    time.sleep(60.0)


def endless(_robot_file):
    return case("toy.agrees", agrees, group="one"), case("toy.sleeps", sleeps, group="one")


def unloadable(_robot_file):
    if os.environ["TOY_PARENT"] != str(os.getpid()):
        raise RuntimeError("only workers come here")
    return (case("toy.agrees", agrees),)


def slowly(context):
    time.sleep(0.03)
    return agrees(context)


def real(robot_file):
    """Some of the paper's cases, artificial cases that take 0.03 s each, and a figure."""
    from validation import paper  # noqa: PLC0415  the other catalogues do not need it

    steady = tuple(case(f"toy.steady[{k}]", slowly) for k in range(12))
    of_paper = (replace(case_of_paper, subject="robot") for case_of_paper in paper.cases()[::2])
    return (*steady[:6], *of_paper, *steady[6:], *sound(robot_file))


def tells_much(context):
    return replace(agrees(context), notes=("tell" * 5000,))


def verbose(_robot_file):
    """Cases with results so long that the first ones fill a small disk."""
    return tuple(case(f"toy.verbose[{k}]", tells_much) for k in range(12))
