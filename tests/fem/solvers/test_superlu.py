"""Linear solvers where rslab cannot be loaded: SciPy for small systems, PETSc for large ones."""

import re
import sys

import numpy as np
import pytest
from scipy.sparse import diags_array
from support.fakes.petsc_installation import require_petsc

from fem.solvers.backends import rslab
from fem.solvers.backends.choice import SolverFallbackWarning, solver_name
from fem.solvers.backends.petsc.client import PetscOrdering
from fem.solvers.backends.request import request_solver
from fem.solvers.backends.superlu import SuperluOrdering
from fem.solvers.factor import Inertia, analyse
from lumped.errors import ComputationError, InputError
from lumped.solver_request import PYTHON_VARIABLE, VARIABLE

CHAIN = diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(300, 300), format="csr")
REASON = "libgomp.so.1: cannot open shared object file"


@pytest.fixture
def damaged(monkeypatch, tmp_path):
    """Provide an installation of rslab whose library cannot be loaded."""
    (tmp_path / "rslab.py").write_text(f'raise OSError("{REASON}")\n')
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "rslab", raising=False)
    monkeypatch.delenv(VARIABLE, raising=False)
    rslab.load_error.cache_clear()
    yield
    rslab.load_error.cache_clear()


@pytest.mark.usefixtures("damaged")
def test_small_systems_fall_back_to_scipy():
    """With a warning that names the reason. Deflections of a chain are n(301 − n)/2."""
    with pytest.warns(SolverFallbackWarning, match=re.escape(f"cannot be loaded ({REASON}): Sc")):
        symbolic = analyse(CHAIN)
    assert type(symbolic.analysis.ordering) is SuperluOrdering
    # Displacements of the chain under unit forces: a parabola.
    node = np.arange(1, 301)
    deflections = symbolic.factorise().solve(np.ones(300))
    np.testing.assert_allclose(deflections, node * (301 - node) / 2.0, rtol=1e-10)


@pytest.mark.usefixtures("damaged")
@pytest.mark.filterwarnings("ignore::fem.solvers.backends.choice.SolverFallbackWarning")
def test_superlu_off_diagonal_pivot_is_refused():
    """Pairs with zero diagonals have eigenvalues ±1, which diagonal pivots cannot count."""
    pairs = diags_array([np.tile([1.0, 0.0], 5)[:9]], offsets=[1], shape=(10, 10), format="csr")
    assert analyse(pairs).indefinite("pairs").inertia.zero >= 1
    signs = diags_array([np.repeat([-1.0, 2.0], [3, 7])], offsets=[0], format="csr")
    assert analyse(signs).indefinite("signs").inertia == Inertia(3, 0, 7)


@pytest.mark.usefixtures("damaged")
def test_large_system_without_petsc_is_refused(monkeypatch):
    """The message has the number of unknowns and how to install rslab or PETSc."""
    monkeypatch.setattr("fem.solvers.backends.superlu.LARGEST", 299)
    monkeypatch.setenv(PYTHON_VARIABLE, "/nowhere/python")
    with pytest.raises(ComputationError) as refused:
        analyse(CHAIN)
    assert str(refused.value) == (
        f"300 unknowns need rslab, which cannot be loaded ({REASON}), or PETSc, which is not "
        "installed; install rslab again (pip install --force-reinstall rslab), or install "
        "the Debian packages python3-petsc4py, mpi-default-bin and libopenblas0-serial"
    )


@pytest.mark.usefixtures("damaged")
def test_large_systems_fall_back_to_petsc(monkeypatch):
    """With a warning; the name in results has both SuperLU and MUMPS."""
    require_petsc()
    monkeypatch.setattr("fem.solvers.backends.superlu.LARGEST", 299)
    with pytest.warns(SolverFallbackWarning, match="PETSc larger ones"):
        symbolic = analyse(CHAIN)
    assert type(symbolic.analysis.ordering) is PetscOrdering
    assert "SuperLU" in solver_name()
    assert "MUMPS" in solver_name()


@pytest.mark.usefixtures("damaged")
def test_missing_requested_rslab_is_reported(monkeypatch):
    """FLEXPROOF_SOLVER=rslab excludes a fallback: the reason is an error."""
    monkeypatch.setenv(VARIABLE, "rslab")
    message = re.escape(f"solver rslab: cannot be loaded ({REASON}); install rslab again")
    for use in (lambda: analyse(CHAIN), lambda: request_solver(None)):
        with pytest.raises(InputError, match=message):
            use()
