"""
10 A hammer test
================

Models compared with a modal test in the terms of ASME V&V 20. The test is synthetic: frequency
response functions of a clamped steel bar in closed form (Euler and Bernoulli), with a damping ratio
of 1 % in each mode, written in the Universal File Format as a modal test system would. Reading
them needs the extra ``hammer``.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyuff

import flexproof as fp

length, width, height = 0.8, 0.020, 0.012
E, rho, ratio = 2.1e11, 7850.0, 0.01
robot = {
    "schema": 2,
    "name": "clamped bar",
    "points": {"A": [0.0, 0.0, 0.0], "M": [0.4, 0.0, 0.0], "P": [length, 0.0, 0.0]},
    "bodies": {
        name: {
            "from": start,
            "to": end,
            "section": {"shape": "rectangle", "width": width, "height": height},
            "material": {"E": E, "nu": 0.3, "rho": rho},
        }
        for name, start, end in (("inner", "A", "M"), ("outer", "M", "P"))
    },
    "joints": {
        "clamp": {"type": "fixed", "between": ["ground", "inner"], "at": "A"},
        "middle": {"type": "fixed", "between": ["inner", "outer"], "at": "M"},
    },
    "tool": {"body": "outer", "point": "P", "moves": []},
    "hammer": {
        "uncertainty": 0.002,
        "nodes": {"1": {"body": "inner", "at": "M"}, "2": {"body": "outer", "at": "P"}},
    },
}

# %%
# The measured functions: acceleration at the middle and at the tip by a force at the tip, along z.

factors = np.array([1.875104069, 4.694091133, 7.854757438, 10.99554073])
omega = factors**2 * height * np.sqrt(E / rho / 12.0) / length**2
mass = rho * width * height * length


def shape(x):
    """Modes of a cantilever at x, of unit mean square (Blevins, table 8-1)."""
    z, sigma = x / length * factors, (np.cosh(factors) + np.cos(factors))
    sigma = sigma / (np.sinh(factors) + np.sin(factors))
    return np.cosh(z) - np.cos(z) - sigma * (np.sinh(z) - np.sin(z))


frequencies = np.arange(0.0, 500.0, 0.5)
s = 2j * np.pi * frequencies[:, None]
swing = s**2 / (s**2 + 2.0 * ratio * omega * s + omega**2)
sets = [
    {
        "type": 58,
        "func_type": 4,
        "binary": 0,
        "x": frequencies,
        "abscissa_spacing": 1,
        "data": swing @ (shape(x) * shape(length)) / mass,
        "rsp_node": node,
        "rsp_dir": 3,
        "ref_node": 2,
        "ref_dir": 3,
        "ordinate_spec_data_type": 12,
        "orddenom_spec_data_type": 13,
    }
    for node, x in ((1, 0.5 * length), (2, length))
]

with TemporaryDirectory() as folder:
    file = Path(folder) / "hammer.uff"
    pyuff.UFF(str(file)).write_sets(sets, mode="add")
    compared = fp.compare_measured(robot, file)
compared.plot()

# %%
# The bar was struck along z, so only modes of bending in that plane were excited: f1, f3 and f5 of
# the model. All models lie within the interval of the measurement. Beams of Timoshenko's theory
# are lower than the test, which is of Euler's and Bernoulli's.

for mode in ("f1", "f3", "f5"):
    if any(one.name == mode for one in compared.matrix.quantities):
        entry = compared.entry("beam", mode)
        error, half = 100.0 * entry.error, 100.0 * entry.uncertainty
        print(f"beam {mode}: E = {error:+.2f} % ± {half:.2f} %, {entry.verdict}")
