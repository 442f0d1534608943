"""Skip of tests that need PETSc."""

import pytest

from fem.solvers.backends.petsc import client
from fem.solvers.backends.petsc.client import MissingPetscError


def require_petsc():
    """Skip the test if there is no Python with petsc4py, with the reason."""
    try:
        client.server()
    except MissingPetscError as error:
        pytest.skip(str(error))
