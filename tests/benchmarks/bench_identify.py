"""Time and memory of identification, and of a robot of two parts.

    python tests/benchmarks/bench_identify.py [UNKNOWNS]

The tapered biglide's first leg on three meshes, the finest of 150 000 unknowns unless told, both
couplings and six frequencies; then both of its legs on such a mesh, each meshed and reduced by a
process of its own. Times of the processor count all processes; nothing that an earlier run has
kept is used.
"""

# ruff: noqa: T201  a script that prints its figures

import os
import resource
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from time import perf_counter

from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot
from validation.models import parts
from validation.models.mechanism import CUTOFF, highest_frequency
from validation.parts.identify import identify

ROBOT = Path(__file__).resolve().parents[2] / "examples" / "tapered-biglide" / "robot.toml"
MECHANISM = load_robot(ROBOT).mechanism
FREQUENCIES = 10


def processor() -> float:
    """Seconds of this process and of those that it has waited for."""
    own = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in own)


def peak() -> float:
    """Most memory (GiB) that this process or one that it waited for has had."""
    own = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return max(one.ru_maxrss for one in own) / 2**20


def reduce_part(name: str, unknowns: int, highest: float) -> tuple[float, float]:
    """Mesh and reduce a part as the robot's models ask; seconds of the processor, GiB."""
    parts.UNKNOWNS, start = unknowns, processor()
    body = MECHANISM.bodies[name]
    parts.reduced(body, highest, CUTOFF["solid"] * highest)
    return processor() - start, peak()


def main() -> None:
    unknowns = int(sys.argv[1]) if len(sys.argv) > 1 else 150_000
    body = MECHANISM.bodies["leg1"]
    start, wall = processor(), perf_counter()
    found = identify(*parts.found_in(body), parts.shape_of(body).material, unknowns)
    print(
        f"identified on {found.unknowns}: {processor() - start:.1f} s of processor, "
        f"{perf_counter() - wall:.1f} s, peak {peak():.2f} GiB"
    )
    poses = [posture(MECHANISM, pose) for pose in MECHANISM.poses]
    # Estimated from equivalent legs, whose parts are identified on coarse meshes here.
    parts.UNKNOWNS = 10_000
    highest = highest_frequency(poses, FREQUENCIES)
    wall = perf_counter()
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        work = [pool.submit(reduce_part, name, unknowns, highest) for name in MECHANISM.parts]
        each = [one.result() for one in work]
    said = " and ".join(f"{seconds:.1f} s ({memory:.2f} GiB)" for seconds, memory in each)
    print(f"two parts reduced: {said} of processor, {perf_counter() - wall:.1f} s side by side")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = folder
        os.environ.pop("FLEXPROOF_CACHE", None)
        main()
