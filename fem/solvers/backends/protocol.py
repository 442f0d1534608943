"""Interface of a library of sparse factorisations, and of the memory that its arrays are in."""

from contextlib import AbstractContextManager, nullcontext
from typing import Any, Protocol

import numpy as np

from lumped.arrays import Array, SparseMatrix


class DeviceError(Exception):
    """A device that has too little memory, fails or is lost; `announced` to the user or not yet."""

    announced = False


class Space(Protocol):
    """Memory in which blocks of vectors are multiplied: the host's, or that of a device."""

    def errors(self) -> AbstractContextManager[None]:
        """Context in which every error of a device is a DeviceError."""

    def put(self, array: Any) -> Any:
        """Copy of a host array in this memory."""

    def get(self, array: Any) -> Array:
        """Host copy of an array in this memory."""

    def matrix(self, matrix: SparseMatrix) -> Any:
        """Copy of a sparse matrix, to be multiplied with blocks in this memory."""

    def columns(self, size: int, count: int, filled: Any) -> Any:
        """Array (size × at least one column) that begins with `filled` (size×k).

        It has `count` columns if unused ones take no memory, else some more than k.
        """


class HostSpace:
    """Memory of the host."""

    def errors(self) -> AbstractContextManager[None]:
        """Context without any effect."""
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
        """All columns at once: pages that are never reached take no memory."""
        columns = np.empty((size, count), order="F")
        columns[:, : filled.shape[1]] = filled
        return columns


HOST: Space = HostSpace()


class Numeric(Protocol):
    """Factor L D Lᵀ of a symmetric matrix (n×n).

    `negative`: number of negative entries of D. `zero`: number of entries without a sign.
    """

    negative: int
    zero: int

    def solve(self, columns: Any) -> Any:
        """Solutions (n×k) for right-hand sides (n×k), in the memory that these are in.

        Raises DeviceError.
        """


class Ordering(Protocol):
    """Order of elimination for all matrices of one pattern.

    `peak_bytes`: predicted peak of the host's memory during a factorisation.
    """

    peak_bytes: int

    @property
    def space(self) -> Space:
        """The memory in which right-hand sides need no transfer."""

    def factorise(self, values: Array, part: str) -> Numeric:
        """Factor of the matrix with `values` in its triangle; `part` names it in errors.

        Raises ComputationError if the host's memory does not suffice, and DeviceError.
        """
