"""The two ways in which a computation can go wrong; the user answers them differently."""

from collections.abc import Iterable


class InputError(Exception):
    """The input is wrong: one line per fault, each naming place, value and what is allowed."""

    def __init__(self, faults: str | Iterable[str]) -> None:
        self.faults: tuple[str, ...] = (faults,) if isinstance(faults, str) else tuple(faults)
        super().__init__("\n".join(self.faults))


class ComputationError(Exception):
    """A computation failed: the message names the part of the model and the likely cause."""
