"""An exported folder, read by other libraries."""

import re

import meshio
from pyvista import read as read_vtk
from scipy.io import mmread
from scipy.sparse import load_npz


def assert_read_back(folder):
    """Assert that README.txt names every file, that each is readable, and that matrices agree."""
    text = (folder / "README.txt").read_text(encoding="utf-8")
    margin = [line for line in text.splitlines() if re.match(r"\S+\.\w+(,|$)", line)]
    names = {path.name for path in folder.iterdir()} - {"README.txt"}
    assert {name for line in margin for name in re.findall(r"[^,\s]+", line)} == names
    for path in (folder / name for name in names):
        match path.suffix:
            case ".vtu":
                assert len(meshio.read(path).points) == read_vtk(path).n_points > 0
            case ".vtp":
                assert read_vtk(path).n_points > 0
            case ".npz":
                matrix, market = load_npz(path), mmread(path.with_suffix(".mtx"))
                # Matrix Market is text: all digits are there.
                assert abs(matrix - market).max() <= 1e-15 * abs(matrix).max()
                assert abs(matrix - matrix.T).max() == 0.0
            case other:
                assert other in {".mtx", ".inp"}
