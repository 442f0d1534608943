"""
12 A team's pytest file
=======================

A design team keeps its robot beside its tests. The plugin gives a fixture, and collects the robot
file itself: one item per model and quantity, per comparison of formulations, and per convergence.
"""

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

ROBOT = """
schema = 2
name = "arm"
points = { A = [0.0, 0.0, 0.0], P = [0.5, 0.0, 0.0] }
tool = { body = "arm", point = "P", moves = [] }

[bodies.arm]
from = "A"
to = "P"
section = { shape = "rectangle", width = 0.05, height = 0.04 }
material = { E = 2.1e11, nu = 0.3, rho = 7850.0 }

[joints]
clamp = { type = "fixed", between = ["ground", "arm"], at = "A" }
"""

TESTS = """
def test_beam_holds_along_z(flexproof):
    flexproof("arm.toml").assert_adequate("beam", "z", within=0.02)
"""

# %%
# Items are chosen with ``-k`` as always. Rigid legs (``simplified``) do not deflect at all: that
# item fails, with the error and its cause.

chosen = "test_arm or .z or beam.f1 or agrees[beam-solid-f1] or converged[beam-f1-20]"
with TemporaryDirectory() as folder:
    Path(folder, "arm.toml").write_text(ROBOT, encoding="utf-8")
    Path(folder, "test_arm.py").write_text(TESTS, encoding="utf-8")
    options = ["-v", "--tb=no", "--color=no", "-p", "no:cacheprovider", "-p", "no:xdist"]
    robot = ["--flexproof", "arm.toml", "--flexproof-preset", "quick"]
    line = [sys.executable, "-m", "pytest", *options, "test_arm.py", *robot, "-k", chosen]
    done = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)

rows = [row for row in done.stdout.splitlines() if "::" in row]
items = dict(tuple(row.split()[:2]) for row in rows if "%]" in row)
print("\n".join(rows))
print(done.stdout.splitlines()[-1])

# %%

figure, axes = plt.subplots(figsize=(7.4, 3.2), dpi=150, layout="constrained")
colours = {"PASSED": "#009E73", "FAILED": "#D55E00", "SKIPPED": "#999999"}
names = list(items)[::-1]
axes.barh(names, [1] * len(names), color=[colours[items[name]] for name in names])
for place, name in enumerate(names):
    axes.text(0.5, place, items[name].lower(), ha="center", va="center", color="white")
axes.set(xlim=(0, 1), xticks=[])
plt.show()
