"""Where a run stands: the sentence on its comparisons and its exit code, both of one count."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from lumped.text import counted
from validation.adequacy.matrix import Matrix
from validation.case import Case
from validation.exhibits import PlannedFigure
from validation.results.outcome import AnyResult, Task, Verdict

_TROUBLED: tuple[Verdict, ...] = ("disagree", "undecided", "failed", "skipped")


@dataclass(frozen=True)
class Standing:
    """What became of the tasks of a run.

    `comparisons`: how many have each verdict. `figures` and `assessments`: how many of them failed.
    `faults`: models, and other computations within an assessment, that ended with an error of the
    program.
    `refused`: models relied on that are not adequate. If `strict`, undecided is not enough.
    """

    comparisons: Mapping[Verdict, int]
    figures: int = 0
    assessments: int = 0
    unfinished: int = 0
    faults: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()
    strict: bool = False

    @property
    def exit_code(self) -> int:
        """0 nothing against it, 1 a case disagrees or a model relied on is inadequate, 3 a failure.

        A failure is anything that failed or was not computed. If strict, undecided is 1 too.
        """
        if self.failures:
            return 3
        wrong: tuple[Verdict, ...] = ("disagree", "undecided") if self.strict else ("disagree",)
        return 1 if self.refused or any(self.comparisons.get(one) for one in wrong) else 0

    @property
    def failures(self) -> int:
        """How many tasks, or models within one, failed or were not computed."""
        failed = self.comparisons.get("failed", 0) + len(self.faults)
        return failed + self.figures + self.assessments + self.unfinished

    @property
    def sentence(self) -> str:
        """The verdict on all comparisons, and what else failed."""
        agree = self.comparisons.get("agree", 0)
        judged = sum(self.comparisons.values()) - self.comparisons.get("skipped", 0)
        if judged == 0:
            sentence = "No comparison was made"
        elif agree == judged:
            sentence = f"All {judged} comparisons agree" if judged > 1 else "The comparison agrees"
        else:
            sentence = f"{agree} of {counted(judged, 'comparison')} agree"
        parts = [f"{count} {one}" for one in _TROUBLED if (count := self.comparisons.get(one))]
        assessments = ("assessment of the models", "assessments of the models")
        parts += [f"{counted(self.figures, 'figure')} failed"] if self.figures else []
        parts += [f"{counted(self.assessments, *assessments)} failed"] if self.assessments else []
        named = ", ".join(self.faults)
        parts += [f"failed by an error of the program: {named}"] if named else []
        parts += [f"{self.unfinished} not computed"] if self.unfinished else []
        return ", ".join([sentence, *parts]) + "."


def standing_of(
    tasks: Sequence[Task],
    done: Mapping[str, AnyResult],
    refused: tuple[str, ...] = (),
    *,
    strict: bool = False,
) -> Standing:
    """Where the tasks stand of which these are `done`, by id."""
    failed = [one for one in tasks if one.id in done and done[one.id].verdict == "failed"]
    matrices = [one.found for one in done.values() if isinstance(one.found, Matrix)]
    figures = sum(isinstance(one, PlannedFigure) for one in failed)
    cases = sum(isinstance(one, Case) for one in failed)
    return Standing(
        comparisons=Counter(
            done[one.id].verdict for one in tasks if isinstance(one, Case) and one.id in done
        ),
        figures=figures,
        assessments=len(failed) - figures - cases,
        unfinished=len(tasks) - len(done),
        faults=tuple(dict.fromkeys(fault for one in matrices for fault in one.all_faults)),
        refused=refused,
        strict=strict,
    )
