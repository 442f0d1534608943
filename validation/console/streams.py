"""Writing to stdout and stderr, which may be closed, full, ASCII only, or broken pipes.

Input: results and messages. Output: results on stdout, messages on stderr. Rule: if results cannot
be written, the command fails; a message that cannot be written is lost; if the reader of a pipe
ends early, no error is raised.
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
# Replacements of characters that an encoding lacks. Greek letters become their names; other letters
# lose their accents.
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
    """Error if results could not be written to stdout."""

    def __init__(self, error: OSError) -> None:
        super().__init__(f"the results cannot be written to the standard output: {error.strerror}")


def prepare() -> None:
    """Open closed standard streams, and let streams replace characters that their encoding lacks.

    If a stream stayed closed, the next opened file would get its number, and output of libraries
    would be written to that file.
    """
    # With a width of 0 columns the wrapping of help texts would not end.
    if os.environ.get("COLUMNS", "").strip() == "0":
        del os.environ["COLUMNS"]
    for number, mode in enumerate((os.O_RDONLY, os.O_RDONLY, os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            # In ascending order, each stream gets its own number. stdout is opened for reading, so
            # that writing results fails, as it must.
            os.open(os.devnull, mode)
    if sys.stdout is None:
        sys.stdout = os.fdopen(1, "w", encoding="utf-8", closefd=False)
    if sys.stderr is None:
        sys.stderr = os.fdopen(2, "w", encoding="utf-8", closefd=False)
    codecs.register_error(_HANDLER, _replace_unencodable)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(encoding=_ascii_by_locale(), errors=_HANDLER)


def write_results(text: str) -> None:
    """Write results and a line end to stdout. Raises ResultsLostError."""
    try:
        sys.stdout.write(visible(text, keep="\n") + "\n")
        # Errors must be raised here, before the command continues.
        sys.stdout.flush()
    except OSError as error:
        raise_lost_results(error)


# Variable of the environment that switches progress off, in this process and those that it starts.
QUIET = "FLEXPROOF_QUIET"


def is_quiet() -> bool:
    """True if the environment variable FLEXPROOF_QUIET switches progress on stderr off."""
    return bool(os.environ.get(QUIET))


def write_messages(lines: Iterable[str], code: int) -> int:
    """Write messages to stderr, one line each, and return the exit code."""
    try:
        for line in lines:
            sys.stderr.write(f"flexproof: {visible(line)}\n")
        sys.stderr.flush()
    except OSError:
        _discard(sys.stderr)
    return code


def write_message(line: str) -> None:
    """Write a message to stderr. It has no effect on the exit code."""
    write_messages([line], 0)


def flush() -> None:
    """Flush stdout. Raises ResultsLostError."""
    try:
        sys.stdout.flush()
    except OSError as error:
        raise_lost_results(error)


def raise_lost_results(error: OSError) -> None:
    """Raise ResultsLostError for an error of stdout, unless the reader of a pipe has ended."""
    # Otherwise Python would write again at exit, and end with an exit code of its own.
    _discard(sys.stdout)
    if not isinstance(error, BrokenPipeError):
        raise ResultsLostError(error) from error


def _discard(stream: TextIO) -> None:
    """Redirect a stream, with the remainder of its buffer, to the null device."""
    with suppress(OSError, ValueError):
        number = stream.fileno()
        null_device = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null_device, number)
        os.close(null_device)
        stream.flush()


def _ascii_by_locale() -> str | None:
    """Encoding "ascii" if LC_ALL is C or POSIX, otherwise None.

    In these locales, Python writes UTF-8 to a stream unless an encoding is set on it. None also if
    PYTHONIOENCODING or PYTHONUTF8 is set, since they take precedence over LC_ALL.
    """
    python_settings = {"PYTHONIOENCODING", "PYTHONUTF8"} & os.environ.keys()
    ascii_locale = os.environ.get("LC_ALL") in {"C", "POSIX"}
    return "ascii" if ascii_locale and not python_settings else None


def _replace_unencodable(error: UnicodeError) -> tuple[str, int]:
    """Error handler of codecs that replaces characters which the encoding lacks."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    unencodable = error.object[error.start : error.end]
    return "".join(map(_plain, unencodable)), error.end


def _plain(character: str) -> str:
    """ASCII replacement of a character. Its escape sequence if there is no replacement."""
    if character in _PLAIN:
        return _PLAIN[character]
    if greek := _GREEK.fullmatch(unicodedata.name(character, "")):
        return greek[2].lower() if greek[1] == "SMALL" else greek[2].capitalize()
    without_accents = "".join(
        _PLAIN.get(part, part)
        for part in unicodedata.normalize("NFKD", character)
        if not unicodedata.combining(part)
    )
    return without_accents if without_accents.isascii() else f"\\u{ord(character):04x}"
