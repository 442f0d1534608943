"""Rank correlations of designs by two models."""

from collections.abc import Sequence

from lumped.arrays import Array

# scipy.stats takes half a second to import, in every process of a run: it waits for its use.


def spearman(one: Sequence[float] | Array, other: Sequence[float] | Array) -> float:
    """Spearman's ρ, −1 to 1; NaN where one of them is constant."""
    from scipy.stats import spearmanr  # noqa: PLC0415

    return float(spearmanr(one, other).statistic)


def kendall(one: Sequence[float] | Array, other: Sequence[float] | Array) -> float:
    """Kendall's τ-b, −1 to 1; NaN where one of them is constant."""
    from scipy.stats import kendalltau  # noqa: PLC0415

    return float(kendalltau(one, other).statistic)
