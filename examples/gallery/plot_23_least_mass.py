"""
23 Least mass of an arm
=======================

Width and height of an arm on an elastic drive: every combination is solved, and the lightest arm is
chosen that is stiff enough. The command draws maps over both numbers.
"""

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

ROBOT = """
schema = 2
name = "arm"
units = "mm"
points = { A = [0.0, 0.0, 0.0], P = [300.0, 0.0, 0.0] }
tool = { body = "arm", point = "P", moves = ["y"], mass = 1.0 }

[bodies.arm]
from = "A"
to = "P"
section = { shape = "rectangle", width = 30.0, height = 40.0 }
material = { E = 7.0e10, nu = 0.33, rho = 2700.0 }

[joints.motor]
type = "revolute"
between = ["ground", "arm"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = 2.0e4 }
"""

# %%
# The deflections have a limit of 7 mm and of 1 mm under 1000 N:

with TemporaryDirectory() as folder:
    Path(folder, "arm.toml").write_text(ROBOT, encoding="utf-8")
    options = ["--model", "beam", "--modes", "1", "--picture", "map.png"]
    options += ["--vary", "bodies.arm.section.width=20:50:4"]
    options += ["--vary", "bodies.arm.section.height=20:50:4"]
    options += ["--minimise", "mass"]
    options += ["--where", "deflection.y<=7e-3", "--where", "deflection.z<=1e-3"]
    start = "from validation.entry.start import main; raise SystemExit(main())"
    line = [sys.executable, "-c", start, "solve", "arm.toml", *options]
    done = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=True)
    maps = plt.imread(Path(folder, "map.png"))

choice = done.stdout.splitlines()[-2:]
print("\n".join(choice))

# %%

figure, axes = plt.subplots(figsize=(7.4, 7.4 * maps.shape[0] / maps.shape[1]), dpi=150)
axes.imshow(maps)
axes.set_axis_off()
figure.subplots_adjust(0.0, 0.0, 1.0, 1.0)
plt.show()
