"""Time of any mechanism over its workspace: bodies reduced once, then any number of postures.

    python tests/benchmarks/bench_mechanism.py [POSTURES]

The hexapod with twelve tubular bodies, by 20 beam elements each and by solids: reductions, then
statics and ten frequencies per posture, and the kinematics beside. Times of one core; postures are
its path's, over and over, 200 unless told.
"""

# ruff: noqa: T201  a script that prints its figures

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
from itertools import cycle, islice
from time import process_time

from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot
from lumped.system.assembly import assembly
from lumped.system.sweep import swept
from validation.models.mechanism import dynamic_bodies, highest_frequency

FREQUENCIES = 10


def main() -> None:
    mechanism = load_robot("hexapod").mechanism
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    start = process_time()
    poses = [posture(mechanism, pose) for pose in mechanism.poses]
    print(f"kinematics {1e3 * (process_time() - start) / len(poses):.1f} ms a posture")
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
