"""
14 Arms of several materials
============================

Three arms of one length: a steel box, the same box filled with polymer concrete under a rail of
steel, and a tube of carbon fibre layers. Beams give the deflection of each under a force along z at
its tip, and its first frequency.
"""

from pathlib import Path

from matplotlib.figure import Figure

import flexproof as fp

examples = Path(fp.__file__).parent / "examples"
filled = fp.load(examples / "composite-arm" / "robot.toml").tables
carbon = fp.load(examples / "laminate-arm" / "robot.toml").tables
box = {"shape": "hollow-rectangle", "width": 0.06, "height": 0.08, "thickness": 0.004}
arm = {"from": "A", "to": "P", "section": box, "material": "steel"}
arms = {
    "steel box": {**filled, "bodies": {"arm": arm}},
    "filled box": filled,
    "carbon tube": carbon,
}

# Tip compliance (m/N) along z and first frequency (Hz) of each arm alone, clamped at its root.
answers = {
    name: fp.solve(robot, "beam", body="arm", modes=1).answers[0] for name, robot in arms.items()
}
compliances = {name: answer.compliance[2, 2] for name, answer in answers.items()}
frequencies = {name: answer.frequencies[0] for name, answer in answers.items()}

figure = Figure(figsize=(6.4, 2.6), layout="constrained")
left, right = figure.subplots(1, 2)
left.barh(list(arms), [1e6 * value for value in compliances.values()])
left.set_title("compliance along z (µm/N)")
right.barh(list(arms), list(frequencies.values()))
right.set_title("first frequency (Hz)")
right.set_yticks([])
figure  # noqa: B018  shown by the gallery
