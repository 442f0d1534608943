"""Writes the numbers of docs/guide/parts.md: how models take the legs of the tapered biglide.

    python docs/pictures/parts_models.py

Each model beside the parts as solids, all by `flexproof solve`: in the middle of the path, and the
most by which it is off over the path. Of a force |u − u*| / |u*| with the whole displacement of
the loaded point, of a moment the same with its rotation.
"""

from pathlib import Path
from typing import Any

import numpy as np

from validation import api
from validation.models.options import ModelName

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "guide" / "parts.md"
ROBOT = ROOT / "examples" / "tapered-biglide" / "robot.toml"
BEGIN, END = "<!-- by docs/pictures/parts_models.py -->\n", "<!-- end -->\n"
MODELS: dict[str, tuple[ModelName, dict[str, Any]]] = {
    "solid": ("solid", {}),
    "segments --parts condensed": ("segments", {"parts": "condensed"}),
    "segments --parts stepped": ("segments", {"parts": "stepped"}),
    "segments": ("segments", {}),
}
MODES = 4


def numbers() -> str:
    """The table of the page and what it says in words."""
    robot = api.load(ROBOT)
    poses = [pose.tolist() for pose in robot.mechanism.poses]
    answers = {
        name: api.solve(robot, model, poses=poses, modes=MODES, **options).answers
        for name, (model, options) in MODELS.items()
    }
    compliances = {
        name: np.array([one.compliance for one in found]) for name, found in answers.items()
    }
    frequencies = {
        name: np.array([one.frequencies for one in found]) for name, found in answers.items()
    }
    middle = len(poses) // 2
    lines = [
        "| model | z (µm) | f1 to f4 (Hz) | a force | a moment | f1 to f3 | f4 |",
        "|---|---|---|---|---|---|---|",
    ]
    off = {}
    for name, own in compliances.items():
        truth, known = compliances["solid"], frequencies["solid"]
        errors = np.abs(frequencies[name] / known - 1.0).max(axis=0)
        off[name] = [
            _largest(own, truth, slice(0, 3)),
            _largest(own, truth, slice(3, 6)),
            float(errors[:3].max()),
            float(errors[3]),
        ]
        middles = ", ".join(f"{value:.1f}" for value in frequencies[name][middle])
        shares = [""] * 4 if name == "solid" else [_percent(one) for one in off[name]]
        lines.append(
            " | ".join([f"| `{name}`", f"{1e9 * own[middle, 2, 2]:.2f}", middles, *shares]) + " |"
        )
    condensed, stepped, plain = (off[name] for name in list(MODELS)[1:])
    lines += [
        "",
        f"The equivalent leg misses the displacement under a force by {_percent(plain[0])} and f1 "
        f"to f3 by {_percent(plain[2])}. The lumped formulation is not the cause: the condensed "
        f"leg has the part's own statics ({_percent(max(condensed[:2]))}) and f1 to f3 to "
        f"{_percent(condensed[2])}, but with its mass on its interfaces alone f4 is "
        f"{_percent(condensed[3])} off. Stepped legs miss forces by {_percent(stepped[0])} and "
        f"moments by {_percent(stepped[1])}, and have all four frequencies to "
        f"{_percent(max(stepped[2:]))}.",
    ]
    return "\n".join(lines) + "\n"


def _largest(own: np.ndarray, truth: np.ndarray, rows: slice) -> float:
    """Largest |u − u*| / |u*| over poses and axes, of the loads and motions in `rows`."""
    apart = np.linalg.norm((own - truth)[:, rows, rows], axis=1)
    return float((apart / np.linalg.norm(truth[:, rows, rows], axis=1)).max())


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %" if share >= 5e-5 else "less than 0.01 %"


def written(page: str, block: str) -> str:
    """The page with the block in its place."""
    begin, end = page.index(BEGIN) + len(BEGIN), page.index(END)
    return f"{page[:begin]}{block}{page[end:]}"


if __name__ == "__main__":
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8"), numbers()), encoding="utf-8")
