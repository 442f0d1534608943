"""What the paper says, in our words, and how it is measured."""

from collections.abc import Callable
from dataclasses import dataclass

from validation.case import Case, Measurement, Relation, Tolerance
from validation.context import Context

SECTION = "The paper's statements"
# Postures over the stroke at which curves are compared.
POSTURES = 81


@dataclass(frozen=True)
class Statement:
    """A sentence or figure of the paper (`where`) that a computation can check."""

    id: str
    where: str
    says: str
    quantity: str
    unit: str
    tolerance: Tolerance
    reason: str
    compute: Callable[[Context], Measurement]
    relation: Relation = Relation.EQUAL
    group: str = "paper"
    effort: float = 0.2

    def case(self) -> Case:
        """The statement as a case."""
        return Case(
            id=f"paper.{self.id}",
            title=self.says,
            quantity=self.quantity,
            unit=self.unit,
            reference_kind="paper-statement",
            citation=f"Briot, Pashkevich, Chablat, {self.where}",
            tolerance=self.tolerance,
            tolerance_reason=self.reason,
            compute=self.compute,
            relation=self.relation,
            section=SECTION,
            group=self.group,
            effort=self.effort,
        )
