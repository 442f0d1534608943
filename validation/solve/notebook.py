"""Tables as a notebook shows them."""

from collections.abc import Sequence
from html import escape

_COLOURS = {"adequate": "#d3f0e4", "inadequate": "#fbdcc8", "undecided": "#eceef1"}


def table(
    headings: Sequence[str],
    rows: Sequence[Sequence[str]],
    verdicts: Sequence[Sequence[str | None]] | None = None,
) -> str:
    """Rows of text under headings as HTML; `verdicts` colour the cells they stand for."""
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    lines = []
    for number, row in enumerate(rows):
        kinds = verdicts[number] if verdicts else [None] * len(row)
        lines.append(
            "".join(_cell(text, kind) for text, kind in zip(row, kinds, strict=True)),
        )
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def paragraph(text: str) -> str:
    """A paragraph of text as HTML."""
    return f"<p>{escape(text)}</p>"


def _cell(text: str, verdict: str | None) -> str:
    colour = _COLOURS.get(verdict or "")
    style = f' style="background:{colour};color:#1b1f24"' if colour else ""
    return f"<td{style}>{escape(text)}</td>"
