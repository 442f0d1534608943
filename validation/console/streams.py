"""The standard streams as they are found: closed, full, in ASCII, or a pipe whose reader has left.

Results go to stdout, everything else to stderr. Where results cannot be written the command fails;
a message that cannot be written is lost; a reader that has had enough changes nothing.
"""

import codecs
import os
import re
import sys
import unicodedata
from collections.abc import Iterable
from contextlib import suppress
from io import TextIOWrapper
from typing import TextIO

from lumped.errors import ComputationError
from lumped.text import visible

_HANDLER = "flexproof.plain"
# What is meant where a terminal has no such sign; Greek letters get their names, others lose
# their accents.
_PLAIN = {
    **dict.fromkeys("µμ", "u"),
    **dict.fromkeys("−–—", "-"),
    **dict.fromkeys("′‘’", "'"),
    **dict.fromkeys("“”", '"'),
    **dict(zip("×·±≤≥→ø", ("x", "*", "+-", "<=", ">=", "->", "o"), strict=True)),
    **dict(zip("§√∫°", ("section ", "sqrt ", "integral ", " deg"), strict=True)),
}
_GREEK = re.compile("GREEK (SMALL|CAPITAL) LETTER (\\w+)")


class ResultsLostError(ComputationError):
    """What was found could not be written to stdout."""

    def __init__(self, error: OSError) -> None:
        super().__init__(f"the results cannot be written to stdout: {error.strerror}")


def prepare() -> None:
    """Give each standard stream something to write to, and signs that whoever reads it can show.

    Of a stream that was closed from outside the next file to be opened would take the number, and
    what libraries print would go into that file.
    """
    # A terminal that says it is no column wide would have help wrapped for ever.
    if os.environ.get("COLUMNS", "").strip() == "0":
        del os.environ["COLUMNS"]
    for number, mode in enumerate((os.O_RDONLY, os.O_RDONLY, os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            # Opened in the order of the numbers, each gets its own. stdout for reading alone:
            # results then fail to be written, as they should.
            os.open(os.devnull, mode)
    if sys.stdout is None:
        sys.stdout = os.fdopen(1, "w", encoding="utf-8", closefd=False)
    if sys.stderr is None:
        sys.stderr = os.fdopen(2, "w", encoding="utf-8", closefd=False)
    codecs.register_error(_HANDLER, _in_plain_signs)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(encoding=_ascii_by_locale(), errors=_HANDLER)


def say(text: str) -> None:
    """Write results and a line end to stdout. Raises ResultsLostError."""
    try:
        sys.stdout.write(visible(text, keep="\n") + "\n")
        # Now, so that a command which goes on knows at once.
        sys.stdout.flush()
    except OSError as error:
        lost(error)


def complain(lines: Iterable[str], code: int) -> int:
    """Write messages to stderr, one line each, and return the exit code."""
    try:
        for line in lines:
            sys.stderr.write(f"flexproof: {visible(line)}\n")
        sys.stderr.flush()
    except OSError:
        _to_nowhere(sys.stderr)
    return code


def mention(line: str) -> None:
    """Write a message that changes no exit code to stderr."""
    complain([line], 0)


def flush() -> None:
    """See to it that everything has been written. Raises ResultsLostError."""
    try:
        sys.stdout.flush()
    except OSError as error:
        lost(error)


def lost(error: OSError) -> None:
    """Raise ResultsLostError for an error of stdout, unless its reader has left by choice."""
    # Python would try once more on leaving, and end with a code of its own.
    _to_nowhere(sys.stdout)
    if not isinstance(error, BrokenPipeError):
        raise ResultsLostError(error) from error


def _to_nowhere(stream: TextIO) -> None:
    with suppress(OSError, ValueError):
        number = stream.fileno()
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, number)
        os.close(nowhere)
        stream.flush()


def _ascii_by_locale() -> str | None:
    """ASCII where LC_ALL asks for it, which Python overrides by UTF-8; else the stream's own."""
    told = {"PYTHONIOENCODING", "PYTHONUTF8"} & os.environ.keys()
    return "ascii" if os.environ.get("LC_ALL") in {"C", "POSIX"} and not told else None


def _in_plain_signs(error: UnicodeError) -> tuple[str, int]:
    """Error handler of codecs: what the encoding does not have in signs that all have."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    unencodable = error.object[error.start : error.end]
    return "".join(_plain(one) for one in unencodable), error.end


def _plain(character: str) -> str:
    if character in _PLAIN:
        return _PLAIN[character]
    if greek := _GREEK.fullmatch(unicodedata.name(character, "")):
        return greek[2].lower() if greek[1] == "SMALL" else greek[2].capitalize()
    spelled = "".join(
        _PLAIN.get(one, one)
        for one in unicodedata.normalize("NFKD", character)
        if not unicodedata.combining(one)
    )
    return spelled if spelled.isascii() else f"\\u{ord(character):04x}"
