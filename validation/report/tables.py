"""Comparisons as compact tables: one row for each quantity, one column for each model."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isclose, isnan

from validation.case import Measurement, Relation, Relative
from validation.results.outcome import Outcome

# Models as cases name them, and the headings of their columns.
VARIANTS = {
    "simplified": "simplified",
    "vjm": "virtual joints",
    "segments": "segments",
    "beam": "beam FE",
    "solid": "solid FE",
}
# Explained differences below this share of the reference are not told apart in a table.
_WORTH_SAYING = 1e-6


@dataclass(frozen=True)
class Row:
    """One quantity by several models; `cells` follow the grid's models, None where none asked."""

    quantity: str
    cells: tuple[Outcome | None, ...]

    @property
    def known(self) -> tuple[Outcome, ...]:
        """The cells that hold a comparison."""
        return tuple(cell for cell in self.cells if cell is not None)

    @property
    def unit(self) -> str:
        """Unit of the row."""
        return self.known[0].case.unit

    @property
    def reference(self) -> float | None:
        """The reference where all cells have the same one."""
        measured = [cell.measurement for cell in self.known if cell.measurement]
        if not measured:
            return None
        first = measured[0].reference
        same = all(isclose(m.reference, first, rel_tol=1e-9) for m in measured)
        return first if same else None


@dataclass(frozen=True)
class Grid:
    """Rows over the same models (keys of `VARIANTS`)."""

    models: tuple[str, ...]
    rows: tuple[Row, ...]

    @property
    def headings(self) -> tuple[str, ...]:
        """Headings of the model columns."""
        return tuple(VARIANTS[model] for model in self.models)

    @property
    def references(self) -> bool:
        """Whether any row has one reference for all its cells."""
        return any(row.reference is not None for row in self.rows)


def grids(outcomes: Sequence[Outcome]) -> tuple[tuple[Grid, ...], tuple[Outcome, ...]]:
    """Tables of the quantities that several models compute, and the outcomes left over.

    Cases of one quantity and row by several models share a row; rows that share a model share a
    table. Order of appearance throughout.
    """
    by_key: dict[tuple[str, str, str], dict[str, Outcome]] = {}
    for outcome in outcomes:
        case = outcome.case
        if case.model in VARIANTS:
            key = case.section, case.quantity, case.row
            by_key.setdefault(key, {}).setdefault(case.model, outcome)
    shared = {key: cells for key, cells in by_key.items() if len(cells) > 1}
    placed = {outcome.case.id for cells in shared.values() for outcome in cells.values()}
    tables: list[dict[tuple[str, str, str], dict[str, Outcome]]] = []
    for key, cells in shared.items():
        table = next((t for t in tables if any(cells.keys() & c.keys() for c in t.values())), None)
        if table is None:
            tables.append({key: cells})
        else:
            table[key] = cells
    rest = tuple(outcome for outcome in outcomes if outcome.case.id not in placed)
    return tuple(_grid(table) for table in tables), rest


def unexplained_share(outcome: Outcome) -> float | None:
    """|unexplained difference| over |reference|, None where that has no meaning.

    It has one where the case claims equality of two numbers of a kind, within a relative
    tolerance: orders, ranks, counts and bounds have amounts instead.
    """
    case, measurement = outcome.case, outcome.measurement
    if measurement is None or not measurement.reference:
        return None
    if case.relation is not Relation.EQUAL or not isinstance(case.tolerance, Relative):
        return None
    share = abs(measurement.unexplained / measurement.reference)
    return None if isnan(share) else share


def explained(measurement: Measurement) -> bool:
    """Whether named causes account for a part of the difference that is worth saying."""
    if not (measurement.allowances and measurement.reference):
        return False
    part = abs(measurement.difference - measurement.unexplained)
    return part > _WORTH_SAYING * abs(measurement.reference)


def largest_unexplained(outcomes: Sequence[Outcome]) -> Outcome | None:
    """The comparison with the largest unexplained difference in % of its reference."""
    relative = [o for o in outcomes if unexplained_share(o) is not None]
    return max(relative, key=lambda o: unexplained_share(o) or 0.0, default=None)


def _grid(table: dict[tuple[str, str, str], dict[str, Outcome]]) -> Grid:
    models = tuple(name for name in VARIANTS if any(name in cells for cells in table.values()))
    quantities = [quantity for _, quantity, _ in table]
    rows = tuple(
        Row(
            f"{quantity} ({row})" if row and quantities.count(quantity) > 1 else quantity,
            tuple(cells.get(model) for model in models),
        )
        for (_, quantity, row), cells in table.items()
    )
    return Grid(models, rows)
