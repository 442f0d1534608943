"""Frequencies of single legs by modes of their sections, for sections without two axes of symmetry.

Input: a leg of constant section and a mode of its beam. Output: the frequency of the corresponding
mode of the prism (`fem.couplings.section_modes`), on the section mesh of the leg's solid. Rule: a
mode of the beam corresponds to the mode of the prism of the same number among the modes of the
same symmetry, since the frequencies of one symmetry do not cross if warping and distortion are
gradually allowed. Shapes cannot decide: restrained warping of an open section mixes the beam's
torsion and bending.
"""

from collections.abc import Sequence
from functools import partial
from itertools import count as naturals
from itertools import takewhile

import numpy as np

from fem.beams.beam_theory import (
    TOGETHER,
    CantileverFrequency,
    Kind,
    cantilever_frequencies,
    frequency_of_kind,
    kinds_of,
)
from fem.couplings.section_fields import SectionFields, section_fields
from fem.couplings.section_modes import (
    LEVELS,
    PrismModes,
    lowest_section_frequency,
    prism_modes,
    saint_venant_frequencies,
)
from fem.sections.moduli import leg_moduli
from lumped.arrays import Array, IntArray
from lumped.legs import ConstantLeg
from lumped.memo import memo
from lumped.model_choices import Ends
from lumped.sections import Composite, Laminate
from validation.responses.mode_pairing import centreline_samples
from validation.solids.leg_meshes import COARSEST_WALLS, face_mesh

# Largest divisions of the section mesh, whose matrices are dense.
MOST_DIVISIONS = 8
# Number of sections at which modes are sampled, and of modes of each symmetry.
STATIONS = 24
_COUNT = 10


def has_waves(leg: ConstantLeg) -> bool:
    """True if tension, torsion and bending in both planes of a leg are independent waves."""
    return leg.section.is_doubly_symmetric and not any(leg.section.couplings)


def prism_frequency(
    leg: ConstantLeg,
    divisions: int,
    ends: Ends,
    mode: CantileverFrequency,
) -> float:
    """Frequency (Hz) of the mode of a prism that corresponds to a `mode` of the leg's beam.

    `divisions` are those of the section mesh, of which at most `MOST_DIVISIONS` are used.
    """
    group, index = _place(leg, mode)
    modes = _modes(leg, min(divisions, MOST_DIVISIONS), ends, _levels(leg))[group]
    return float(modes.frequencies[index])


def last_level_change(leg: ConstantLeg, divisions: int, mode: CantileverFrequency) -> float:
    """Relative change of `prism_frequency` with free ends without the last level of modes."""
    group, index = _place(leg, mode)
    before, last = (
        _modes(leg, divisions, "free", levels)[group].frequencies[index]
        for levels in (_levels(leg) - 1, _levels(leg))
    )
    return float(before / last - 1.0)


def _levels(leg: ConstantLeg) -> int:
    """Number of levels of a section's modes.

    Inclined fibres triple the number of modes with each level, and materials make them expensive.
    """
    return LEVELS - 1 if isinstance(leg.section, Composite | Laminate) else LEVELS


def prism_change(leg: ConstantLeg, divisions: int, mode: CantileverFrequency) -> float:
    """Relative change of a `mode` of a leg from Timoshenko's beam to a prism with free ends.

    Both have the same section mesh. The beam has the Saint-Venant states of the section and no
    constants in common with other beams, so that an error of those is not explained.
    """
    group, index = _place(leg, mode)
    fields = _fields(leg, min(divisions, MOST_DIVISIONS))[group]
    beam = saint_venant_frequencies(fields, leg.length, index + 1)[index]
    return prism_frequency(leg, divisions, "free", mode) / float(beam) - 1.0


def cut_off(leg: ConstantLeg, divisions: int, mode: CantileverFrequency) -> float:
    """Lowest frequency (Hz) of a section that vibrates with the symmetry of a `mode` of a leg."""
    return lowest_section_frequency(_fields(leg, divisions)[_place(leg, mode)[0]])


def sampled_prism_modes(
    leg: ConstantLeg, divisions: int, ends: Ends, count: int
) -> tuple[Array, Array, IntArray]:
    """Frequencies (k, Hz), twists (6s×k) and places (`count`) of the lowest modes of a prism.

    The places are the indices of the modes that correspond to the first `count` modes of the beam.
    The k modes have all symmetries and ascending frequencies, up to the highest of these.
    """
    groups = _modes(leg, min(divisions, MOST_DIVISIONS), ends, _levels(leg))
    frequencies = np.concatenate([modes.frequencies for modes in groups.values()])
    twists = np.hstack([modes.twists for modes in groups.values()])
    starts = dict(zip(groups, _COUNT * np.arange(len(groups)), strict=True))
    wanted = [
        starts[group] + index
        for group, index in (
            _place(leg, mode) for mode in cantilever_frequencies(leg.timoshenko, leg.length, count)
        )
    ]
    order = np.argsort(frequencies, kind="stable")
    places: IntArray = np.argsort(order)[wanted]
    order = order[: places.max() + 1]
    return frequencies[order], twists[:, order], places


def _place(leg: ConstantLeg, mode: CantileverFrequency) -> tuple[str, int]:
    """Symmetry of a mode of a leg's beam, and its number (from 0) among the modes of this symmetry.

    A symmetry has the name of `SectionFields`.
    """
    names = list(_fields(leg, COARSEST_WALLS))
    group = _symmetry(names, mode.kind)
    others = set(kinds_of(leg.timoshenko)) - {mode.kind}
    lower = mode.order - 1
    for kind in (other for other in others if _symmetry(names, other) == group):
        frequencies = (
            frequency_of_kind(leg.timoshenko, leg.length, kind, order) for order in naturals(1)
        )
        lower += sum(1 for _ in takewhile(mode.frequency.__gt__, frequencies))
    return group, lower


def _symmetry(names: Sequence[str], kind: Kind) -> str:
    """Name of the symmetry that contains all deformations of `kind`."""
    parts = set(kind.split(TOGETHER))
    return next(name for name in names if parts <= set(name.split(TOGETHER)))


@memo(16)
def _fields(leg: ConstantLeg, divisions: int) -> dict[str, SectionFields]:
    mesh = face_mesh(leg, divisions)
    fields = section_fields(mesh, leg_moduli(leg, mesh) or leg.material)
    return {group.name: group for group in fields}


@memo(32)
def _modes(leg: ConstantLeg, divisions: int, ends: Ends, levels: int) -> dict[str, PrismModes]:
    stations, _ = centreline_samples(leg.length, STATIONS)
    solved = partial(
        prism_modes, length=leg.length, ends=ends, stations=stations, count=_COUNT, levels=levels
    )
    return {name: solved(group) for name, group in _fields(leg, divisions).items()}
