"""What is asked of a model: its options, how many modes, and what is wrong with either."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from validation.models.options import STATIC, ModelName

# What each model listens to; anything else given on the command line is a fault.
OPTIONS: dict[ModelName, tuple[str, ...]] = {
    "simplified": (),
    "vjm": ("legs", "theory", "equivalent"),
    "links": ("legs", "theory", "equivalent"),
    "segments": ("theory", "elements", "release", "layout", "equivalent", "parts"),
    "beam": ("theory", "elements", "equivalent", "parts"),
    "solid": ("ends", "divisions", "equivalent", "reduction"),
}
# Models of elements, solved dense.
OF_ELEMENTS: tuple[ModelName, ...] = ("segments", "beam")
DEFAULT_MODES = 6


@dataclass(frozen=True, eq=False)
class Question:
    """A `model` and how many `modes`, None for six; `given` are the options that were typed."""

    model: ModelName
    modes: int | None
    given: dict[str, Any]

    @property
    def count(self) -> int:
        """Number of frequencies."""
        asked = DEFAULT_MODES if self.modes is None else self.modes
        return 0 if self.model in STATIC else asked

    def option_faults(self, listens: Sequence[str], of: str = "") -> list[str]:
        """Options that are none of those the model `listens` to, values that are not allowed.

        `of` a mechanism, where that is the reason.
        """
        allowed = ", ".join(f"--{name}" for name in listens) or "none"
        faults = [
            f"--{name}: not an option of the {self.model} model{of}; it takes {allowed}"
            for name in self.given
            if name not in listens
        ]
        return faults + [
            f"--{name} = {self.given[name]}: must be 1 or more"
            for name in ("elements", "divisions")
            if self.given.get(name, 1) < 1
        ]

    def mode_faults(self) -> list[str]:
        """What is wrong with the number of modes."""
        if self.modes is not None and self.modes < 0:
            return [f"--modes = {self.modes}: must be 0 or more"]
        if self.modes and self.model in STATIC:
            return [f"--modes: the {self.model} model is static and has no frequencies"]
        return []
