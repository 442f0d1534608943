"""Text that others wrote, as it may be shown: nothing in it steers a terminal or turns lines."""

import unicodedata

# Control characters, marks that reorder what stands around them or take no room, and halves of
# characters (a file name that is not UTF-8).
_UNSHOWN = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"})


def visible(text: str, keep: str = "") -> str:
    r"""The text with each control and format character written out as \x1b or \u202e.

    Characters of `keep` (line ends, say) stay as they are.
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(
        one if one in keep or unicodedata.category(one) not in _UNSHOWN else _escape(one)
        for one in text
    )


def _escape(character: str) -> str:
    number = ord(character)
    if number < 0x100:
        return f"\\x{number:02x}"
    return f"\\u{number:04x}" if number < 0x10000 else f"\\U{number:08x}"
