"""Choice of the library for a matrix: by request, by the number of unknowns, by the card.

`lumped.solver_request` has the request.
"""

import warnings

from fem.solvers.backends import cudss, rslab
from fem.solvers.backends.cudss import CudssOrdering, Device
from fem.solvers.backends.protocol import DeviceError, Ordering
from fem.solvers.backends.request import require_usable
from fem.solvers.backends.rslab import RslabOrdering
from lumped.arrays import SparseMatrix
from lumped.errors import Remark
from lumped.solver_request import Solver, requested_solver

# Unknowns from which the card gains: its start takes 0.65 s (H200). By rslab on 16 cores, ordering,
# two factors and 14 solutions of 134k unknowns take 4.3 s, about one second of 50k.
GAIN_FROM = 50_000
# Bytes per unknown that every solid takes on a card: legs of tetrahedra take 9 to 22 thousand, and
# their triangle alone 500.
LEAST_BYTES = 1_000


class SolverFallbackWarning(Remark):
    """The processor computes what a graphics card was chosen for."""


def choose(request: Solver, unknowns: int, card: Device | None) -> Solver:
    """Library for a matrix of so many unknowns: cuDSS if requested, or if it gains and may fit."""
    if card is None or request is Solver.RSLAB:
        return Solver.RSLAB
    gains = unknowns >= GAIN_FROM and LEAST_BYTES * unknowns <= card.memory
    return Solver.CUDSS if gains or request is Solver.CUDSS else Solver.RSLAB


def order(lower: SparseMatrix) -> Ordering:
    """Order of elimination of a lower triangle (csc n×n) by the library chosen for it.

    Raises InputError if cuDSS is requested and cannot be used.
    """
    request, unknowns = requested_solver(), int(lower.shape[0])
    require_usable(request)
    # A process that solves small matrices alone does not look for a card.
    small = request is Solver.AUTO and unknowns < GAIN_FROM
    card = None if small or request is Solver.RSLAB else cudss.device()
    if choose(request, unknowns, card) is Solver.CUDSS:
        try:
            return CudssOrdering(lower)
        except DeviceError as error:
            announce_fallback(error)
    return RslabOrdering(lower)


def announce_fallback(error: DeviceError) -> None:
    """Warn once that the processor replaces the graphics card, with the reason."""
    if not error.announced:
        error.announced = True
        message = f"graphics card: {error}; the processor computes instead"
        warnings.warn(message, SolverFallbackWarning, stacklevel=2)


def solver_name() -> str:
    """Names and versions of the libraries that a request admits here."""
    request = requested_solver()
    if request is Solver.RSLAB or cudss.device() is None:
        return rslab.title()
    if request is Solver.CUDSS:
        return cudss.title()
    return f"{rslab.title()}; from {GAIN_FROM} unknowns {cudss.title()}"
