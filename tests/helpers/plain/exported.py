"""What the README of an export names."""

import re


def names_in_readme(folder):
    """The files that stand at the margin of README.txt."""
    text = (folder / "README.txt").read_text(encoding="utf-8")
    margin = [line for line in text.splitlines() if re.match(r"\S+\.\w+(,|$)", line)]
    return {name for line in margin for name in re.findall(r"[^,\s]+", line)}
