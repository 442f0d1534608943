"""README.txt of an export: every file that was written by name, and what it holds."""

from collections.abc import Mapping
from fnmatch import fnmatchcase
from pathlib import Path
from textwrap import fill

_WIDTH = 96
_VECTORS = (
    '"displacement Fx" to "displacement Mz" (m per N or N m): unit wrenches at {where}. "mode 1" '
    "and on: mass-normalised shapes; their frequencies (Hz) are field data."
)
_LINE = 'The same data along the centreline, and "rotation Fx" and on (rad) for each.'
# Of legs of constant section, whatever the robot: what files of these names hold.
OF_LEGS: Mapping[str, str] = {
    "*_solid.vtu": (
        "The leg as a solid, {divisions} quadratic elements across the section; root clamped, end "
        f"faces rigid. Point data {_VECTORS.format(where='the tip')}"
    ),
    "*_beam.vtp": f"The leg in beam elements (Timoshenko). {_LINE}",
    "*_segments.vtp": f"The leg in rigid segments with springs between them. {_LINE}",
    "*_[KM].*": (
        "Stiffness (K) and mass (M) of the free leg, symmetric: .npz (scipy.sparse.load_npz), .mtx "
        "(Matrix Market). Unknowns: twist of the root [x y z phi_x phi_y phi_z], twist of the "
        "tip, then the model's own. The solid is meshed more coarsely, {matrix_divisions} element "
        "across, with three displacements per inner node."
    ),
}
OF_PARTS: Mapping[str, str] = {
    "*_part.vtu": (
        "The part on its finest mesh, in the axes of its file (m), held as the robot file says, "
        "the first interface clamped. For every other interface NAME, point data "
        '"displacement NAME Fx" to "displacement NAME Mz" (m per N or N m): unit wrenches there. '
        '"mode 1" and on: mass-normalised shapes; their frequencies (Hz) are field data.'
    ),
    "*_reduced_[KM].*": (
        "Stiffness (K) and mass (M) of the free part on the same mesh, reduced by Craig and "
        "Bampton, symmetric: .npz (scipy.sparse.load_npz), .mtx (Matrix Market). Unknowns: twist "
        "[x y z phi_x phi_y phi_z] of every interface in the order of the robot file, then "
        "amplitudes of modes with all interfaces held. Without the first six rows and columns "
        "they have the frequencies of the part with its first interface clamped."
    ),
}


def write_readme(folder: Path, head: str, about: Mapping[str, str]) -> None:
    """Write README.txt for all files in `folder`, each under the first pattern that it matches.

    `about` maps shell-style patterns to what such files hold.
    """
    files = sorted(path.name for path in folder.iterdir())
    blocks = [head]
    for pattern, text in about.items():
        described = [name for name in files if fnmatchcase(name, pattern)]
        files = [name for name in files if name not in described]
        if described:
            blocks.append(f"{_wrapped(', '.join(described))}\n{_wrapped(text, ' ' * 4)}")
    (folder / "README.txt").write_text("\n\n".join(blocks) + "\n", encoding="utf-8")


def _wrapped(text: str, indent: str = "") -> str:
    return fill(
        text, _WIDTH, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False
    )
