"""Tables and curves of the modes of solid robots beside those of segments or beams."""

from math import nan

import numpy as np

from validation.exhibits import Study
from validation.studies.paired_robot_modes import PAIRED, PairedModes


def mac_table(found: PairedModes, reference: str) -> dict[str, tuple[float | str, ...]]:
    """Every mode at every posture with its partner, NaN where that was not reached."""
    partner, solid, mac, shared = (
        np.where(found.reached, values, nan)
        for values in (found.partner + 1, found.found, found.mac, found.shared)
    )
    pairs = [(p, k) for p in range(len(found.x)) for k in range(PAIRED)]
    return {
        "x (m)": tuple(float(found.x[p]) for p, _ in pairs),
        "mode": tuple(float(k + 1) for _, k in pairs),
        f"{reference} (Hz)": tuple(float(found.reference[pair]) for pair in pairs),
        "partner": tuple(float(partner[pair]) for pair in pairs),
        "solid (Hz)": tuple(float(solid[pair]) for pair in pairs),
        "MAC": tuple(float(mac[pair]) for pair in pairs),
        "crossing": tuple("yes" if found.close[pair] else "" for pair in pairs),
        "MAC as a space": tuple(float(shared[pair]) for pair in pairs),
    }


def frequency_study(found: PairedModes, count: int) -> Study:
    """The first `count` frequencies over the stroke."""
    return Study(
        id="robot.solid.frequencies",
        kind="sweep",
        title="First frequencies of the solid robot and of segments, paired by shape",
        x_label="x (m)",
        y_label="natural frequency",
        unit="Hz",
        x=tuple(found.x.tolist()),
        series={
            f"{model}, mode {k + 1}": tuple(values[:, k].tolist())
            for k in range(count)
            for model, values in (
                ("segments", found.reference),
                ("solid", np.where(found.reached, found.found, nan)),
            )
        },
        modes={
            f"{model}, mode {k + 1}": (model, k + 1)
            for k in range(count)
            for model in ("segments", "solid")
        },
    )
