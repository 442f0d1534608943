"""Checks on the text of a STEP file (ISO 10303-21) before the CAD kernel reads it.

If the text is not valid, the kernel ignores a part of it without a message, or runs without end.
"""

import re

from lumped.errors import InputError

# Texts in quotes and comments, which may contain any characters.
_TEXT_OR_COMMENT = re.compile(rb"('(?:[^']|'')*')|/\*.*?\*/", re.DOTALL)
# Allowed outside of texts and comments: references, enumeration values, numbers, words before a
# bracket.
_VALID = re.compile(
    rb"(?:[\s(),;=$*]|''|\"[0-9A-F]*\"|#\d+|\.[A-Z]\w*\.|!?[A-Z]\w*(?=\s*\()"
    rb"|[+-]?\d+(?:\.\d*)?(?:E[+-]?\d+)?(?=[\s,)])|ENDSEC|DATA|END-ISO-10303-21)*+",
    re.IGNORECASE,
)
_WORD = re.compile(rb"[^\s,()]*")
_DEFINITION, _REFERENCE = re.compile(rb"#(\d+)\s*="), re.compile(rb"#(\d+)")
_ENTITY = re.compile(r"#(\d+)\s*=\s*([^;]*);")
_FACE = re.compile(rb"=\s*(?:ADVANCED_FACE|FACE_SURFACE)\s*\(", re.IGNORECASE)


def require_whole(content: bytes, source: str) -> None:
    """Raise InputError if a file is not a STEP file, is incomplete, or contains invalid text."""
    if not content.lstrip().startswith(b"ISO-10303-21"):
        raise InputError(f"{source}: is not a STEP file; it must begin with ISO-10303-21")
    if b"END-ISO-10303-21" not in content:
        raise InputError(f"{source}: the STEP file is cut off; its last line is missing")
    text = _without_texts(content)
    data = text[max(text.find(b"DATA"), 0) :]
    valid = _VALID.match(data)
    end = valid.end() if valid else 0
    if end < len(data):
        word = _WORD.match(data, end)
        word_text = (word.group() if word else b"").decode("latin-1")
        raise InputError(f"{source}: has {word_text} in place of a value; export it again")
    missing = set(map(int, _REFERENCE.findall(text))) - set(map(int, _DEFINITION.findall(text)))
    if missing:
        raise InputError(
            f"{source}: refers to #{min(missing)}, which does not exist in the file: the "
            "file is damaged; export it again from the CAD system"
        )


def entities(content: bytes) -> dict[str, str]:
    """Text of each entity of a STEP file, by its number.

    Character strings are empty and comments are removed in the returned texts.
    """
    text = _without_texts(content).decode("latin-1")
    return dict(_ENTITY.findall(text))


def count_faces(content: bytes) -> int:
    """Number of faces in a STEP file."""
    return len(_FACE.findall(_without_texts(content)))


def _without_texts(content: bytes) -> bytes:
    return _TEXT_OR_COMMENT.sub(lambda match: b"''" if match.group(1) else b" ", content)
