"""
13 Export to EXUDYN
===================

The robot about one pose as a reduced model for the multibody program EXUDYN: a Python script that
runs alone, or from which a larger model imports matrices and ports. Its header states the
frequencies that EXUDYN must find, and by how much each is too high at most.
"""

import subprocess
import sys
from ast import literal_eval
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np

import flexproof as fp

pose = [0.05, 0.5]
with TemporaryDirectory() as folder:
    script = fp.export("five-bar", "exudyn", out=Path(folder) / "five_bar.py", pose=pose, modes=6)
    text = script.read_text(encoding="utf-8")
    line = [sys.executable, str(script)]
    printed = subprocess.run(line, capture_output=True, text=True, check=True).stdout

print("\n".join(text.splitlines()[2:10]))

# %%
# EXUDYN's eigenvalue solver on the exported matrices, and beam elements of the same robot here. The
# exported legs are solids whose end faces are held plane, which makes them stiffer:

exudyn = np.array(literal_eval(printed.splitlines()[-1]))[:6]
beam = fp.solve("five-bar", "beam", poses=[pose], modes=6).answers[0].frequencies
for mode, (one, other) in enumerate(zip(exudyn, beam, strict=True), start=1):
    print(f"f{mode}: EXUDYN {one:.3f} Hz, beam {other:.3f} Hz, {other / one - 1.0:+.3%}")

# %%

figure, axes = plt.subplots(figsize=(7.4, 2.8), dpi=150, layout="constrained")
modes = np.arange(1, 7)
axes.bar(modes - 0.2, exudyn, 0.38, label="EXUDYN, exported solids")
axes.bar(modes + 0.2, beam, 0.38, label="flexproof, beam elements")
label = {"textcoords": "offset points", "ha": "center"}
for mode, one, other in zip(modes, exudyn, beam, strict=True):
    axes.annotate(f"{100.0 * (other / one - 1.0):+.2f} %", (mode, max(one, other)), (0, 3), **label)
axes.set(xlabel="mode", ylabel="natural frequency (Hz)", ylim=(0.0, 1.1 * max(exudyn)))
axes.legend(frameon=False)
plt.show()
