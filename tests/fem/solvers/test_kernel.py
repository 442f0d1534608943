"""The kernel that OpenBLAS is told to take: of faked processors, and in processes of their own."""

import ctypes
import os
import subprocess
import sys
from collections.abc import Callable

import numpy as np
import pytest
from cvxopt import blas, cholmod

from fem.solvers.cholmod.kernel import VARIABLE, kernel, naming_the_kernel
from lumped.errors import ComputationError

ALL = dict.fromkeys(("AVX512_SKX", "AVX2", "FMA3"), True)
SAYS = "from fem.solvers.cholmod.kernel import kernel; print(kernel())"


@pytest.mark.parametrize(
    ("known", "expected"),
    [
        (ALL, "SkylakeX"),
        (ALL | {"AVX512_SKX": False}, "Haswell"),
        (ALL | {"AVX512_SKX": False, "FMA3": False}, None),
        ({}, None),
    ],
)
def test_openblas_is_told_the_fastest_kernel_whose_instructions_there_are(
    known: dict[str, bool], expected: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr(np._core._multiarray_umath, "__cpu_features__", known)
    with naming_the_kernel():
        assert os.environ.get(VARIABLE) == expected
    # Whoever is started later chooses by himself.
    assert VARIABLE not in os.environ


@pytest.mark.parametrize("named", ["Prescott", "Haswell"])
def test_the_users_choice_stays(named: str) -> None:
    own = {**os.environ, VARIABLE: named}
    found = subprocess.run(
        [sys.executable, "-c", SAYS], env=own, capture_output=True, text=True, check=True
    )
    assert found.stdout.split() == [named]


@pytest.mark.parametrize("library", [ctypes.CDLL, lambda _path: object()], ids=["named", "not"])
def test_a_kernel_that_computes_wrong_products_is_refused(
    library: Callable[[str], object], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where its library hides the kernel's name too."""
    right = blas.gemm

    def wrong(a: object, b: object, product: object, **options: object) -> None:
        right(a, b, product, **options)
        product[5, 7] *= 1.0 + 1e-6  # type: ignore[index]

    monkeypatch.setattr(ctypes, "CDLL", library)
    kernel.cache_clear()
    assert bool(kernel()) == hasattr(library(cholmod.__file__), "openblas_get_corename")
    kernel.cache_clear()
    monkeypatch.setattr(blas, "gemm", wrong)
    with pytest.raises(ComputationError, match="set the environment variable OPENBLAS_CORETYPE"):
        kernel()
