"""Bending frequencies of a leg with more and more elements, and those that they tend to."""

from typing import TYPE_CHECKING

import numpy as np

from fem.beams.beam_theory import bending_frequencies
from lumped.arrays import Array
from lumped.legs import ConstantLeg
from validation.context import Preset
from validation.models.legs import kind_frequencies
from validation.models.options import ModelName, ModelOptions

if TYPE_CHECKING:
    from lumped.models.segments import Layout

COUNTS: dict[Preset, tuple[int, ...]] = {
    "quick": (5, 10, 20, 40, 80),
    "standard": (5, 10, 20, 40, 80, 160),
    "fine": (5, 10, 20, 40, 80, 160),
}
MODES = 3


def element_frequencies(leg: ConstantLeg, name: str, counts: tuple[int, ...]) -> Array:
    """First bending frequencies along z (len(counts) × 3, Hz) for each number of elements."""
    model: ModelName = "beam" if name == "beam" else "segments"
    layout: Layout = "literal" if name == "literal" else "half"
    return np.array(
        [
            kind_frequencies(
                leg, model, "bending y", MODES, ModelOptions(elements=elements, layout=layout)
            )
            for elements in counts
        ]
    )


def exact_frequencies(leg: ConstantLeg) -> Array:
    """The same frequencies (3, Hz) of the exact Timoshenko cantilever."""
    return bending_frequencies(leg.timoshenko, leg.length, "y", MODES)
