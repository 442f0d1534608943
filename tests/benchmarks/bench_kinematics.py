"""Processor time of a hundred random poses of each built-in mechanism, from its reference posture.

python tests/benchmarks/bench_kinematics.py
"""

# ruff: noqa: T201  a script that prints its figures

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
from pathlib import Path
from time import process_time

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import numpy as np

from lumped.mechanism.kinematics.closure import Closure
from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot

ROBOTS = ("biglide", "five-bar", "3-rrr", "delta", "orthoglide", "hexapod")
COUNT, TARGET = 100, 20.0  # poses, ms


def main() -> None:
    print(f"{'':12}{'bodies':>7}{'median ms':>11}{'largest ms':>12}{'residual of the size':>22}")
    missed = []
    for robot in ROBOTS:
        mechanism = load_robot(robot).mechanism
        closure = Closure(mechanism)
        low, high = mechanism.poses.min(axis=0), mechanism.poses.max(axis=0)
        poses = np.random.default_rng(0).uniform(0.98 * low, 0.98 * high, (COUNT, len(low)))
        times, open_by = [], []
        for pose in np.clip(poses, low + 0.01 * (high - low), high - 0.01 * (high - low)):
            start = process_time()
            found = posture(mechanism, pose)
            times.append(1e3 * (process_time() - start))
            residual = closure.residual(closure.placement(found))
            open_by.append(float(np.abs(residual).max()) / closure.size)
        median = float(np.median(times))
        bodies = len(mechanism.bodies) - 1
        print(f"{robot:12}{bodies:7d}{median:11.1f}{max(times):12.1f}{max(open_by):22.1e}")
        missed += [robot] if median > TARGET else []
    print(f"all medians below {TARGET:g} ms" if not missed else f"slower: {', '.join(missed)}")


if __name__ == "__main__":
    main()
