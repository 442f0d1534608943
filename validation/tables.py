"""Tables of results in Python, as text, HTML, CSV or a pandas data frame.

Input: headings with units, and rows of cells. Output: `ResultTable`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from importlib.util import find_spec
from typing import TYPE_CHECKING, TypeAlias

from lumped.errors import InputError
from lumped.text import aligned
from validation.drawing.style import csv_of

if TYPE_CHECKING:
    from pandas import DataFrame

Cell: TypeAlias = str | float | None
# Background colour of a cell by its verdict.
_COLOURS: Mapping[str, str] = {
    "adequate": "#d3f0e4",
    "agree": "#d3f0e4",
    "inadequate": "#fbdcc8",
    "disagree": "#fbdcc8",
    "undecided": "#eceef1",
}


@dataclass(frozen=True)
class ResultTable:
    """Rows of cells under headings, which contain the units; a cell is None if it has no value.

    `str(table)` is plain text with numbers of five digits.

    Examples
    --------
    >>> table = ResultTable(("model", "f1 (Hz)"), (("vjm", None), ("beam", 186.16)))
    >>> print(table)
    model  f1 (Hz)
    vjm    –
    beam   186.16
    """

    headings: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def __str__(self) -> str:
        return aligned(self.headings, [[_text(cell) for cell in row] for row in self.rows], "")

    def to_pandas(self) -> "DataFrame":
        """Convert to a data frame of pandas.

        Returns
        -------
        pandas.DataFrame
            A column for each heading; cells without a value are missing.

        Raises
        ------
        InputError
            If pandas is not installed.

        Examples
        --------
        >>> frame = table.to_pandas()
        >>> list(frame.columns)
        ['model', 'f1 (Hz)']
        """
        if not find_spec("pandas"):
            raise InputError("to_pandas: needs pandas, not installed; pip install pandas")
        # Imported here: optional and slow.
        from pandas import DataFrame  # noqa: PLC0415

        return DataFrame(list(self.rows), columns=list(self.headings))

    def csv(self) -> str:
        """Convert to comma-separated values.

        Returns
        -------
        str
            Numbers with all their digits, nothing for a cell without a value.

        Examples
        --------
        >>> table.csv().splitlines()
        ['model,f1 (Hz)', 'vjm,', 'beam,186.16']
        """
        columns = zip(*self.rows, strict=True) if self.rows else [()] * len(self.headings)
        return csv_of(dict(zip(self.headings, columns, strict=True)))

    def html(self) -> str:
        """Convert to HTML with verdicts in colour.

        Returns
        -------
        str
            A ``<table>`` element, as notebooks display it.

        Examples
        --------
        >>> table.html()[:7]
        '<table>'
        """
        texts = [[_text(cell) for cell in row] for row in self.rows]
        verdicts = [[text if text in _COLOURS else None for text in row] for row in texts]
        return html_table(self.headings, texts, verdicts)

    def _repr_html_(self) -> str:
        return self.html()


def html_table(
    headings: Sequence[str],
    rows: Sequence[Sequence[str]],
    verdicts: Sequence[Sequence[str | None]] | None = None,
) -> str:
    """Table of text rows under headings as HTML. `verdicts` colour the cells."""
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    kinds = verdicts or [[None] * len(row) for row in rows]
    lines = ("".join(map(_html_cell, *row)) for row in zip(rows, kinds, strict=True))
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def html_paragraph(text: str) -> str:
    """Paragraph of text as HTML."""
    return f"<p>{escape(text)}</p>"


def _text(cell: Cell) -> str:
    if cell is None:
        return "–"
    return cell if isinstance(cell, str) else f"{cell:.5g}"


def _html_cell(text: str, verdict: str | None) -> str:
    colour = _COLOURS.get(verdict or "")
    style = f' style="background:{colour};color:#1b1f24"' if colour else ""
    return f"<td{style}>{escape(text)}</td>"
