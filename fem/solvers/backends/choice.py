"""Choice of the library for a matrix: by request, number of unknowns, graphics card, installation.

The request is made by the user, see `lumped.solver_request`.
"""

import warnings

from fem.solvers.backends import cudss, rslab, superlu
from fem.solvers.backends.cudss import CudssOrdering, Device
from fem.solvers.backends.petsc import client as petsc
from fem.solvers.backends.petsc.client import PetscOrdering
from fem.solvers.backends.protocol import DeviceError, Ordering
from fem.solvers.backends.request import REINSTALL, require_usable
from fem.solvers.backends.rslab import RslabOrdering
from fem.solvers.backends.superlu import SuperluOrdering
from lumped.arrays import SparseMatrix
from lumped.errors import ComputationError, Remark
from lumped.solver_request import Solver, requested_solver

# Number of unknowns from which a graphics card (H200) is faster than rslab on 16 cores. The start
# of the card takes 0.7 to 1.0 s. Statics with modes are faster from 20 000 to 30 000 unknowns
# (rslab 1.3 and 2.4 s, cuDSS 0.65 and 0.9 s), statics alone from about 50 000: ordering, factor and
# loads of 134 000 unknowns take 3.9 s by rslab, 1.9 s by cuDSS.
GAIN_FROM = 50_000
# Smallest memory (bytes) per unknown on a card. Legs of tetrahedra need 9000 to 22 000, of which
# the matrix takes 500.
LEAST_BYTES = 1_000
# Description of the systems that GAMG solves, by requested library.
_GAMG_USES = {
    Solver.PETSC: "statics of solids beyond the memory",
    Solver.GAMG: "statics of solids",
}


class SolverFallbackWarning(Remark):
    """Warning to the user that another library replaces the chosen one."""


def choose(request: Solver, unknowns: int, card: Device | None) -> Solver:
    """Library for a matrix with `unknowns` unknowns.

    It is PETSc if PETSc or its multigrid GAMG is requested. It is cuDSS if there is a `card` and
    cuDSS is requested, or if cuDSS is faster and the matrix may fit the card. Otherwise it is
    rslab. `card` is the graphics card. None if the machine has no card.
    """
    if request.is_petsc:
        return Solver.PETSC
    if card is None or request is Solver.RSLAB:
        return Solver.RSLAB
    gains = unknowns >= GAIN_FROM and LEAST_BYTES * unknowns <= card.memory
    return Solver.CUDSS if gains or request is Solver.CUDSS else Solver.RSLAB


def order(lower: SparseMatrix) -> Ordering:
    """Order of elimination for a lower triangle (csc n×n), by the library chosen for the matrix.

    Raises InputError if a requested library cannot be used, ComputationError if no library can be
    used.
    """
    request, unknowns = requested_solver(), int(lower.shape[0])
    require_usable(request)
    if not unknowns:
        # MUMPS and cuDSS do not accept a matrix without unknowns.
        return order_on_host(lower)
    # A process that solves only small matrices does not search for a graphics card.
    small = request is Solver.AUTO and unknowns < GAIN_FROM
    card = None if small or request not in {Solver.AUTO, Solver.CUDSS} else cudss.device()
    library = choose(request, unknowns, card)
    if library is Solver.PETSC:
        return PetscOrdering(lower)
    if library is Solver.CUDSS:
        try:
            return CudssOrdering(lower)
        except DeviceError as error:
            announce_fallback(error)
    return order_on_host(lower)


def order_on_host(lower: SparseMatrix) -> Ordering:
    """Order of elimination for a lower triangle (csc n×n), computed on the processor.

    The library is rslab. If rslab cannot be loaded, the library is SciPy for a small matrix and
    PETSc for a large one, with a warning. Raises ComputationError for a large matrix if neither
    rslab nor PETSc can be used.
    """
    if not (reason := rslab.load_error()):
        return RslabOrdering(lower)
    unknowns = int(lower.shape[0])
    if unknowns <= superlu.LARGEST:
        warnings.warn(_without_rslab(reason), SolverFallbackWarning, stacklevel=2)
        return SuperluOrdering(lower)
    if petsc.installed():
        warnings.warn(_without_rslab(reason), SolverFallbackWarning, stacklevel=2)
        return PetscOrdering(lower)
    raise ComputationError(
        f"{unknowns} unknowns need rslab, which cannot be loaded ({reason}), or PETSc, which is "
        f"not installed; {REINSTALL}, or install the Debian packages {petsc.PACKAGES}"
    )


def _without_rslab(reason: str) -> str:
    return (
        f"rslab cannot be loaded ({reason}): SciPy computes systems up to {superlu.LARGEST} "
        "unknowns, PETSc larger ones if it is installed"
    )


def announce_fallback(error: DeviceError) -> None:
    """Warn once, with the reason, that the processor computes instead of the graphics card."""
    if not error.announced:
        error.announced = True
        message = f"graphics card: {error}; the processor computes instead"
        warnings.warn(message, SolverFallbackWarning, stacklevel=2)


def solver_name() -> str:
    """Names and versions of the libraries that may compute under the current request."""
    request = requested_solver()
    if request.is_petsc:
        return petsc.title(_GAMG_USES[request])
    if request is Solver.RSLAB or cudss.device() is None:
        return _host_name()
    if request is Solver.CUDSS:
        return cudss.title()
    return f"{_host_name()}; from {GAIN_FROM} unknowns {cudss.title()}"


def _host_name() -> str:
    if not rslab.load_error():
        return rslab.title()
    beyond = f"; beyond them {petsc.title()}" if petsc.installed() else ""
    return f"{superlu.title()}{beyond}"
