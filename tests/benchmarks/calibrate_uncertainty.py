"""Coverage of the stated uncertainties of solids, over legs and robots at random.

    python tests/benchmarks/calibrate_uncertainty.py [LEGS] [PLOT]

LEGS (default 200) legs of all five shapes, a robot for every fourth of them. PLOT is the file for
the figure, without it `calibration.svg` in the system's folder for temporary files. Half an hour.
"""

# ruff: noqa: T201  a script that prints its figures

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
import tempfile
from collections import defaultdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "validation"))

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from calibration import (
    ROUNDING,
    Stated,
    coverage,
    of_frequencies,
    of_robots,
    of_statics,
    random_leg,
)

from lumped.sections import Rectangle

NOMINAL = 0.95
# Every fifth leg may be round or thin-walled, whose meshes cost a hundred times more.
_WALLS_EVERY, _WALLS = 5, 0.025


def sample(legs: int) -> dict[str, list[Stated]]:
    """Numbers of so many random legs by quantity."""
    rng = np.random.default_rng(1)
    found: dict[str, list[Stated]] = defaultdict(list)
    for count in range(legs):
        leg = random_leg(rng, _WALLS if count % _WALLS_EVERY == 0 else 0.0)
        numbers = list(of_statics(leg))
        if count % 4 == 0 and isinstance(leg.section, Rectangle):
            numbers += of_frequencies(leg)
        if count % 4 == 1:
            numbers += of_robots(rng)
        for one in numbers:
            found[one.quantity].append(one)
    return found


def main() -> None:
    """Sample, print and plot: share held against the factor on the stated half-width."""
    legs = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    default = Path(tempfile.gettempdir()) / "calibration.svg"
    target = Path(sys.argv[2]) if len(sys.argv) > 2 else default
    figure, axes = plt.subplots(figsize=(7.0, 4.2), layout="constrained")
    factors = np.geomspace(0.02, 20.0, 121)
    for quantity, numbers in sorted(sample(legs).items()):
        held, width = coverage(numbers)
        print(f"{quantity:32} {len(numbers):5} numbers: {100 * held:5.1f} %, width {width:.3g}")
        ratios = np.array([one.error / one.uncertainty for one in numbers if one.error > ROUNDING])
        shares = [100.0 * np.mean(ratios <= factor) for factor in factors]
        axes.semilogx(factors, shares, label=f"{quantity}: {100 * held:.1f} %")
    axes.axhline(100.0 * NOMINAL, color="0.5", linestyle=":")
    axes.axvline(1.0, color="0.5", linestyle=":")
    axes.set_xlabel("half-width in units of the stated one")
    axes.set_ylabel("numbers held (%)")
    axes.legend(fontsize="small", title="held by the stated half-width")
    figure.savefig(target)
    print(target)


if __name__ == "__main__":
    main()
