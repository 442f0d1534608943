"""Time and memory of identification, and of a robot of two parts after their reduction.

    python tests/benchmarks/bench_identify.py [UNKNOWNS]

The tapered biglide's first leg on three meshes, the finest of 150 000 unknowns unless told, both
couplings and six frequencies; then its robot with both legs reduced (from the cache where they are
kept): a thousand postures with ten frequencies. Times of the processor, on all its cores.
"""

# ruff: noqa: T201  a script that prints its figures

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import resource
import sys
from itertools import cycle, islice
from pathlib import Path
from time import perf_counter, process_time

from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot
from lumped.system.assembly import assembly
from lumped.system.sweep import swept
from validation.models.mechanism import dynamic_bodies, highest_frequency
from validation.models.parts import found_in, shape_of
from validation.parts.identify import identify

ROBOT = Path(__file__).resolve().parents[2] / "examples" / "tapered-biglide" / "robot.toml"
POSTURES, FREQUENCIES = 1000, 10


def main() -> None:
    mechanism = load_robot(ROBOT).mechanism
    poses = [posture(mechanism, pose) for pose in mechanism.poses]
    start, wall = process_time(), perf_counter()
    highest = highest_frequency(poses, FREQUENCIES)
    bodies = dynamic_bodies("solid", mechanism, highest)
    print(f"two parts reduced: {process_time() - start:.1f} s of processor")
    prepared = assembly(mechanism, bodies)
    many = list(islice(cycle(poses), POSTURES))
    start, wall = process_time(), perf_counter()
    swept(prepared, many, FREQUENCIES)
    print(
        f"{POSTURES} postures of {prepared.at(poses[0]).size} unknowns, {FREQUENCIES} frequencies: "
        f"{process_time() - start:.2f} s of processor, {perf_counter() - wall:.2f} s"
    )
    unknowns = int(sys.argv[1]) if len(sys.argv) > 1 else 150_000
    body = mechanism.bodies["leg1"]
    os.environ["FLEXPROOF_CACHE"] = "off"
    start, wall = process_time(), perf_counter()
    found = identify(*found_in(body), shape_of(body).material, unknowns)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(
        f"identified on {found.unknowns}: {process_time() - start:.1f} s of processor, "
        f"{perf_counter() - wall:.1f} s, peak {peak:.2f} GiB"
    )


if __name__ == "__main__":
    main()
