"""Coverage of the uncertainty that identification states, over parts at random.

    python tests/benchmarks/calibrate_parts.py [PARTS [UNKNOWNS]]

So many tapered boxes and tubes (200 unless told), solid or hollow, ends held or averaged, as
STEP files: the six compliances on the diagonal with what is stated of them, against graded
hexahedra. On finest meshes of about so many unknowns, of 6000 to 15 000 at random unless told. A
quarter of an hour of computing.
"""

# ruff: noqa: T201  a script that prints its figures

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ["FLEXPROOF_CACHE"] = "off"

import sys
import tempfile
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "helpers" / "at_random"))

import numpy as np
from random_parts import random_part, stated

_SEED = 1


def main() -> None:
    """Share held, width and error, by shape and coupling, in torsion and else, and of all."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    unknowns = int(sys.argv[2]) if len(sys.argv) > 2 else None
    found: dict[str, list[tuple[float, float]]] = defaultdict(list)
    with tempfile.TemporaryDirectory() as folder:
        for number in range(count):
            # Drawn one by one, so that any of them can be looked at by itself.
            part = random_part(np.random.default_rng([_SEED, number]))
            part = replace(part, unknowns=unknowns or part.unknowns)
            for kind, uncertainty, error in stated(part, Path(folder)):
                found[kind].append((uncertainty, abs(error)))
    found["all"] = [one for numbers in list(found.values()) for one in numbers]
    for kind, numbers in sorted(found.items()):
        u, e = np.array(numbers).T
        print(
            f"{kind:34} {len(u):5} numbers: {100 * np.mean(e <= u):5.1f} % held, in the median "
            f"± {100 * np.median(u):.3f} %, off by {100 * np.median(e):.3f} %, at most by "
            f"{100 * e.max():.3f} %"
        )


if __name__ == "__main__":
    main()
