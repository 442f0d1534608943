"""Time of the main job: `flexproof run` of the built-in robot, preset by preset.

    python tests/benchmarks/bench_run.py [PRESET ...]

Prints wall and processor seconds per preset beside the limits the project sets itself on two
cores: 30 s for quick, 120 s for standard. The set-up is not part of it.
"""

# ruff: noqa: T201  a script that prints its figures

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).resolve().parents[2]
LIMITS = {"quick": 30.0, "standard": 120.0, "fine": float("inf")}


def measure(preset: str, out: Path) -> tuple[float, float, int]:
    """Wall seconds, processor seconds of all processes, and the exit code of one run."""
    before, start = os.times(), perf_counter()
    command = [sys.executable, "-m", "validation.cli", "run", "--preset", preset, "--out", str(out)]
    code = subprocess.run(command, cwd=ROOT, check=False, stdout=subprocess.DEVNULL).returncode
    after = os.times()
    processor = (after.children_user - before.children_user) + (
        after.children_system - before.children_system
    )
    return perf_counter() - start, processor, code


def main() -> None:
    """Measure the presets named on the command line, quick and standard if none is."""
    print(f"load before: {os.getloadavg()[0]:.2f}, cores: {os.cpu_count()}")
    print(f"{'preset':10} {'wall s':>8} {'processor s':>12} {'limit s':>8} {'exit':>5}")
    for preset in sys.argv[1:] or ["quick", "standard"]:
        with tempfile.TemporaryDirectory() as folder:
            wall, processor, code = measure(preset, Path(folder) / "report")
        print(f"{preset:10} {wall:8.1f} {processor:12.1f} {LIMITS[preset]:8.0f} {code:5d}")


if __name__ == "__main__":
    main()
