"""Coverage of the stated uncertainties of solids, over legs and robots at random.

    python tests/benchmarks/calibrate_uncertainty.py [LEGS]

LEGS (default 200) rectangular legs, each with a robot of two more, every eighth with frequencies,
and for every fortieth a round or walled one. A quarter of an hour of computing.
"""

# ruff: noqa: T201  a script that prints its figures

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "helpers" / "at_random"))

import numpy as np
from calibration import (
    Stated,
    coverage,
    of_frequencies,
    of_robots,
    of_statics,
    random_leg,
)

# Legs are drawn one by one, so that any of them can be looked at by itself.
_SEED, _FIRST_WALLED = 1, 1000


def sample(legs: int) -> dict[str, list[Stated]]:
    """Numbers of so many random legs by quantity."""
    found: dict[str, list[Stated]] = defaultdict(list)
    for one in _numbers(legs):
        found[one.quantity].append(one)
    return found


def _numbers(legs: int) -> Iterator[Stated]:
    for count in range(legs):
        rng = np.random.default_rng([_SEED, count])
        leg = random_leg(rng)
        yield from of_statics(leg)
        if count % 8 == 0:
            yield from of_frequencies(leg)
        yield from of_robots(rng)
    for count in range(_FIRST_WALLED, _FIRST_WALLED + legs // 40):
        yield from of_statics(random_leg(np.random.default_rng([_SEED, count]), walls=0.25))


def main() -> None:
    """Sample and print: the share of the numbers that their half-width holds, and its size."""
    legs = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    for quantity, numbers in sorted(sample(legs).items()):
        held, width = coverage(numbers)
        print(f"{quantity:32} {len(numbers):5} numbers: {100 * held:5.1f} %, width {width:.3g}")


if __name__ == "__main__":
    main()
