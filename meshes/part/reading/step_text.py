"""The text of a STEP file (ISO 10303-21), looked at before the CAD kernel reads it, and its unit.

The kernel passes over what it does not understand, or never comes back from it.
"""

import re

from lumped.errors import InputError
from lumped.mechanism.part import METRES

# Texts and comments, in which anything may stand.
_ANYTHING = re.compile(rb"('(?:[^']|'')*')|/\*.*?\*/", re.DOTALL)
# References, enumerated values, numbers, and words before a bracket: all that there may be between.
_SOUND = re.compile(
    rb"(?:[\s(),;=$*]|''|\"[0-9A-F]*\"|#\d+|\.[A-Z]\w*\.|!?[A-Z]\w*(?=\s*\()"
    rb"|[+-]?\d+(?:\.\d*)?(?:E[+-]?\d+)?(?=[\s,)])|ENDSEC|DATA|END-ISO-10303-21)*+",
    re.IGNORECASE,
)
_WORD = re.compile(rb"[^\s,()]*")
_DEFINITION, _REFERENCE = re.compile(rb"#(\d+)\s*="), re.compile(rb"#(\d+)")
_FACE = re.compile(rb"=\s*(?:ADVANCED_FACE|FACE_SURFACE)\s*\(", re.IGNORECASE)
_ENTITY = r"#{}\s*=\s*\((.*?)\)\s*;"
_CONTEXT = re.compile(r"GLOBAL_UNIT_ASSIGNED_CONTEXT\s*\(\s*\((.*?)\)\s*\)", re.DOTALL)
_PREFIX = {"": "m", "MILLI": "mm", "CENTI": "cm"}


def require_whole(content: bytes, source: str) -> None:
    """Raise InputError where a file is no STEP file, cut off, or says what means nothing."""
    if not content.lstrip().startswith(b"ISO-10303-21"):
        raise InputError(f"{source}: is not a STEP file; it must begin with ISO-10303-21")
    if b"END-ISO-10303-21" not in content:
        raise InputError(f"{source}: the STEP file is cut off; its last line is missing")
    text = _without_texts(content)
    data = text[max(text.find(b"DATA"), 0) :]
    sound = _SOUND.match(data)
    end = sound.end() if sound else 0
    if end < len(data):
        word = _WORD.match(data, end)
        said = (word.group() if word else b"").decode("latin-1")
        raise InputError(f"{source}: says {said} where a value must be; export it anew")
    lost = set(map(int, _REFERENCE.findall(text))) - set(map(int, _DEFINITION.findall(text)))
    if lost:
        raise InputError(
            f"{source}: refers to #{min(lost)}, which it does not hold: the file is "
            "damaged; export it anew from the CAD system"
        )


def count_faces(content: bytes) -> int:
    """How many faces the file holds."""
    return len(_FACE.findall(_without_texts(content)))


def _without_texts(content: bytes) -> bytes:
    return _ANYTHING.sub(lambda found: b"''" if found.group(1) else b" ", content)


def step_unit(text: str, source: str) -> str:
    """Unit of length that a STEP file (ISO 10303-21) says for its shapes.

    Raises InputError where it says none, several, or one that is unknown here.
    """
    units = set()
    for context in _CONTEXT.findall(text):
        for reference in re.findall(r"#(\d+)", context):
            entity = re.search(_ENTITY.format(reference), text, re.DOTALL)
            if entity and "LENGTH_UNIT" in entity.group(1):
                units.add(_length_unit(entity.group(1), source))
    if not units:
        raise InputError(f"{source}: says no unit of length; export it anew from the CAD system")
    if len(units) > 1:
        named = " and ".join(sorted(units))
        raise InputError(f"{source}: its shapes are in {named}; export them in one unit of length")
    return units.pop()


def _length_unit(entity: str, source: str) -> str:
    conversion = re.search(r"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'", entity)
    if conversion:
        name = conversion.group(1).strip().lower()
        if name in ("inch", "in"):
            return "inch"
    else:
        si = re.search(r"SI_UNIT\s*\(\s*(?:\$|\.(\w+)\.)\s*,\s*\.METRE\.", entity)
        name = ((si.group(1) or "").upper() if si else "unknown").lower()
        if si and name.upper() in _PREFIX:
            return _PREFIX[name.upper()]
    allowed = ", ".join(METRES)
    raise InputError(f"{source}: its unit of length, {name!r}, is not known here; use {allowed}")
