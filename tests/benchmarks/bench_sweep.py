"""Time of a workspace sweep with solid legs: condensation of both, then any number of postures.

    python tests/benchmarks/bench_sweep.py [PLOT]

Legs of about 40 000 unknowns each, statics and ten frequencies per posture, two processes with
one thread each. PLOT is the file for the plot of time over the number of postures, without it
`sweep.svg` in the system's folder for temporary files.
"""

# ruff: noqa: T201  a script that prints its figures

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import resource
import sys
import tempfile
from pathlib import Path
from time import perf_counter

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
# Spawned processes import this program by name too.
os.environ["PYTHONPATH"] = sys.path[0]

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from fem.bodies.solid import solid_mesh
from lumped.biglide import Biglide, with_equivalent_legs
from lumped.robot_file import load_robot
from validation.models.options import ModelOptions
from validation.sweeps.cores import on_cores
from validation.sweeps.journal import Journal
from validation.sweeps.plans import CHUNK, stroke_stations
from validation.sweeps.runner import Executor, sweep
from validation.sweeps.units import LegUnit, PostureUnit, chunks, expected_highest

JOBS = 2
FREQUENCIES = 10
# Elements across the smaller side of leg 1 and leg 2: more than 40 000 unknowns each.
DIVISIONS = (6, 4)
COUNTS = [125, 250, 500, 1000, 2000]
TARGET_COUNT, TARGET_POSTURES, TARGET_CONDENSATION = 1000, 10.0, 20.0


def main() -> None:
    plot = Path(sys.argv[1] if len(sys.argv) > 1 else Path(tempfile.gettempdir()) / "sweep.svg")
    robot = with_equivalent_legs(load_robot("ifw").robot)
    with on_cores(JOBS) as executor:
        warm_up(robot, executor)
        journal, legs = Journal(), leg_units(robot, DIVISIONS)
        condensation = condense(robot, legs, executor, journal)
        print(f"{'postures':>9} {'s':>7} {'ms each':>8}")
        times = []
        for count in COUNTS:
            times.append(seconds(robot, legs, count, executor, journal))
            print(f"{count:>9} {times[-1]:>7.2f} {1e3 * times[-1] / count:>8.2f}")
    slope, start = np.polyfit(COUNTS, times, 1)
    order = np.polyfit(np.log(COUNTS[1:]), np.log(times[1:]), 1)[0]
    print(f"{1e3 * slope:.2f} ms per posture and {start:.2f} s beside; order {order:.2f}")
    print(f"condensation of both legs {condensation:.1f} s (target {TARGET_CONDENSATION:g} s)")
    target = times[COUNTS.index(TARGET_COUNT)]
    print(f"{TARGET_COUNT} postures, {FREQUENCIES} frequencies: {target:.2f} s "
          f"(target {TARGET_POSTURES:g} s)")  # fmt: skip
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 2**20
    print(f"largest process {peak:.2f} GiB")

    figure, axes = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
    axes.plot(COUNTS, times, "o", label="measured")
    axes.plot(COUNTS, slope * np.array(COUNTS) + start, "-", label=f"{1e3 * slope:.2f} ms each")
    axes.set(xlabel="postures", ylabel="time (s)", ylim=(0.0, None))
    axes.set_title(f"Statics and {FREQUENCIES} frequencies with solid legs, {JOBS} processes")
    axes.legend()
    figure.savefig(plot)
    print(f"plot: {plot}")


def leg_units(robot: Biglide, divisions: tuple[int, int]) -> tuple[LegUnit, LegUnit]:
    """Both legs as solids with rigid end faces, right for the frequencies asked for."""
    highest = expected_highest(robot, FREQUENCIES)
    legs = zip((robot.leg1, robot.leg2), divisions, strict=True)
    unit1, unit2 = (LegUnit("solid", leg, ModelOptions(divisions=n), highest) for leg, n in legs)
    return unit1, unit2


def units_of(robot: Biglide, legs: tuple[LegUnit, LegUnit], count: int) -> tuple[PostureUnit, ...]:
    x = stroke_stations(robot, count)
    return chunks(PostureUnit("solid", robot, ModelOptions(), x, FREQUENCIES, legs), CHUNK)


def warm_up(robot: Biglide, executor: Executor) -> None:
    """Let both processes start and import what they need."""
    start = perf_counter()
    sweep(units_of(robot, leg_units(robot, (1, 1)), 4 * CHUNK), executor)
    print(f"start of {JOBS} processes {perf_counter() - start:.1f} s (not counted below)")


def condense(
    robot: Biglide, legs: tuple[LegUnit, LegUnit], executor: Executor, journal: Journal
) -> float:
    """Reduce both legs into the journal, and one posture; seconds."""
    for number, unit in enumerate(legs, start=1):
        size = 3 * len(solid_mesh(unit.leg, unit.options.divisions).nodes)
        print(f"leg {number}: {unit.options.divisions} divisions, {size} unknowns")
    start = perf_counter()
    sweep(units_of(robot, legs, 1), executor, journal)
    return perf_counter() - start


def seconds(
    robot: Biglide,
    legs: tuple[LegUnit, LegUnit],
    count: int,
    executor: Executor,
    journal: Journal,
) -> float:
    """Statics and frequencies at `count` postures, the legs being condensed."""
    start = perf_counter()
    sweep(units_of(robot, legs, count), executor, journal)
    return perf_counter() - start


if __name__ == "__main__":
    main()
