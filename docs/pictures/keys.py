"""Writes the list of keys in docs/guide/mechanisms.md from the table of rules.

python docs/pictures/keys.py
"""

from pathlib import Path

from lumped.robot_file.rules.published import key_table

PAGE = Path(__file__).resolve().parents[1] / "guide" / "mechanisms.md"
FIRST, NEXT = "| key | must be |", "\n\n"


def renewed(text: str) -> str:
    """The page with the list as the rules are now."""
    begin = text.index(FIRST)
    return text[:begin] + key_table() + text[text.index(NEXT, begin) :]


if __name__ == "__main__":
    PAGE.write_text(renewed(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
