"""The adequacy of a robot's models as a piece of work of a run, scheduled like a case."""

from collections.abc import Callable
from dataclasses import dataclass

from validation.adequacy.matrix import Matrix
from validation.context import PRESETS, Context, Preset

# The two assessments of a run by id: against what is computed, and against what was measured.
ADEQUACY, MEASURED = "adequacy", "measured"


@dataclass(frozen=True)
class Assessment:
    """The matrix of a run's robot; fields as of `Case`. `compute` may raise Skip."""

    id: str
    title: str
    compute: Callable[[Context], Matrix]
    presets: tuple[Preset, ...] = PRESETS
    section: str = ""
    group: str = ""
    effort: float = 1.0
