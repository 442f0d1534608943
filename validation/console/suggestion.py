"""Did you mean that? Suggestions for names that nobody knows."""

from collections.abc import Sequence
from difflib import get_close_matches


def did_you_mean(given: str, known: Sequence[str]) -> str:
    """A question naming the closest known name, empty where none is close."""
    close = get_close_matches(given.strip("*?"), known, n=1, cutoff=0.5)
    return f'did you mean "{close[0]}"?' if close else ""
