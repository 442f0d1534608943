"""Interface of a library for sparse factorisation, and of the memory that contains its arrays."""

from contextlib import AbstractContextManager, nullcontext
from typing import Any, Protocol

import numpy as np

from lumped.arrays import Array, SparseMatrix


class DeviceError(Exception):
    """Error: a device has too little memory, fails or is lost.

    `announced` is True if the user has been warned.
    """

    announced = False


class Space(Protocol):
    """Memory in which blocks of vectors are multiplied: that of the host, or of a device.

    A device is a graphics card.
    """

    def errors(self) -> AbstractContextManager[None]:
        """Context in which each error of a device is raised as DeviceError."""

    def put(self, array: Any) -> Any:
        """Copy of an array of the host, in this memory."""

    def get(self, array: Any) -> Array:
        """Copy of an array in this memory, in the memory of the host."""

    def matrix(self, matrix: SparseMatrix) -> Any:
        """Copy of a sparse matrix, to be multiplied with blocks in this memory."""

    def columns(self, size: int, count: int, filled: Any) -> Any:
        """Array of `size` rows in this memory that begins with the columns `filled` (size×k).

        It has `count` columns if unused columns take no memory, otherwise a few more than k. It has
        at least one column.
        """


class HostSpace:
    """Memory of the host. `put`, `get` and `matrix` return their arguments without copies."""

    def errors(self) -> AbstractContextManager[None]:
        """Context without effect: no DeviceError occurs on the host."""
        return nullcontext()

    def put(self, array: Any) -> Any:
        """The array itself."""
        return array

    def get(self, array: Array) -> Array:
        """The array itself."""
        return array

    def matrix(self, matrix: SparseMatrix) -> SparseMatrix:
        """The matrix itself."""
        return matrix

    def columns(self, size: int, count: int, filled: Array) -> Array:
        """Array of `size` rows and `count` columns, which begins with the columns `filled`.

        Columns that have not been written take no memory.
        """
        columns = np.empty((size, count), order="F")
        columns[:, : filled.shape[1]] = filled
        return columns


HOST: Space = HostSpace()


class Numeric(Protocol):
    """Factor L D Lᵀ of a symmetric matrix (n×n).

    `negative` is the number of negative entries of D. `zero` is the number of entries whose sign is
    not known, because they are zero within round-off or the factor is not accurate.
    """

    negative: int
    zero: int

    def solve(self, columns: Any) -> Any:
        """Solutions (n×k) for the right-hand sides `columns` (n×k), in the same memory.

        Raises DeviceError if a graphics card fails.
        """


class Ordering(Protocol):
    """Order of elimination of the unknowns, for all matrices with one sparsity pattern.

    `peak_bytes` is the predicted peak of the host's memory during a factorisation.
    """

    peak_bytes: int

    @property
    def space(self) -> Space:
        """Memory (host or graphics card) in which right-hand sides are used without a copy."""

    def factorise(self, values: Array, part: str) -> Numeric:
        """Factor of the matrix whose lower triangle has the entries `values`.

        `part` is the name of the matrix in messages. Raises ComputationError if the memory of the
        host is insufficient, and DeviceError if a graphics card fails.
        """
