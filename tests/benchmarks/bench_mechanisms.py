"""Times of mechanisms on one core: postures of each, and statics with modes over a workspace.

    python tests/benchmarks/bench_mechanisms.py [POSTURES]

A hundred random poses of each built-in mechanism, from its reference posture; then the hexapod with
twelve tubular bodies, by 20 beam elements each and by solids, reduced once, with ten frequencies in
each of 200 postures unless told.
"""

# ruff: noqa: T201  a script that prints its figures and sets its threads first

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
from itertools import cycle, islice
from pathlib import Path
from time import process_time

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import numpy as np

from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot
from lumped.system.assembly import assembly
from lumped.system.sweep import swept
from validation.models.mechanism import dynamic_bodies, highest_frequency

ROBOTS = ("biglide", "five-bar", "3-rrr", "delta", "orthoglide", "hexapod")
POSES, TARGET = 100, 20.0  # ms
FREQUENCIES = 10


def kinematics(robot: str) -> None:
    mechanism = load_robot(robot).mechanism
    low, high = mechanism.poses.min(axis=0), mechanism.poses.max(axis=0)
    margin = 0.01 * (high - low)
    times = []
    for pose in np.random.default_rng(0).uniform(low + margin, high - margin, (POSES, len(low))):
        start = process_time()
        posture(mechanism, pose)
        times.append(1e3 * (process_time() - start))
    print(f"{robot:12} median {np.median(times):5.1f} ms a pose, largest {max(times):5.1f} ms")


def main() -> None:
    print(f"postures (target: medians below {TARGET:g} ms)")
    for robot in ROBOTS:
        kinematics(robot)
    mechanism = load_robot("hexapod").mechanism
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    poses = [posture(mechanism, pose) for pose in mechanism.poses]
    highest = highest_frequency(poses, FREQUENCIES)
    for model in ("beam", "solid"):
        start = process_time()
        prepared = assembly(mechanism, dynamic_bodies(model, mechanism, highest))
        reduction = process_time() - start
        start = process_time()
        swept(prepared, list(islice(cycle(poses), count)), FREQUENCIES)
        each = 1e3 * (process_time() - start) / count
        size = prepared.at(poses[0]).size
        print(
            f"{model}: reduced in {reduction:.1f} s to {size} unknowns; "
            f"statics and {FREQUENCIES} frequencies {each:.1f} ms a posture"
        )


if __name__ == "__main__":
    main()
