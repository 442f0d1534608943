"""What a run says at its end on the terminal."""

from shlex import join

from validation.adequacy.matrix import in_a_line
from validation.report.listing import outcome_line, summary
from validation.results.comparison_text import sentence
from validation.session.gathered import Results
from validation.session.validate import Request


def verdicts(gathered: Results) -> list[str]:
    """Lines on what does not agree, and the verdict on the whole."""
    outcomes = gathered.in_order()
    worst = [o for o in outcomes if o.verdict in {"disagree", "undecided", "failed"}]
    # A run of models alone makes no comparison that could be summed up.
    nothing = not outcomes and gathered.matrices
    said = [] if nothing else [summary(outcomes, gathered.unfinished)]
    return [*(outcome_line(outcome) for outcome in worst), *said]


def adequacy(gathered: Results) -> list[str]:
    """Lines on the models relied on that are not adequate, and which models are, for what."""
    lines = [f"relied on, and not adequate: {', '.join(gathered.refused)}"]
    lines = lines if gathered.refused else []
    lines += [f"adequacy: {message}" for message in gathered.unjudged()]
    lines += [in_a_line(gathered.matrix)] if gathered.matrix else []
    measured = gathered.measured
    return [*lines, f"against measured values: {in_a_line(measured)}"] if measured else lines


def left_out(gathered: Results) -> list[str]:
    """Lines on the figures that could not be drawn."""
    missing = gathered.missing_figures()
    return [f"figure {planned.id} left out: {message}" for planned, message in missing]


def changes(gathered: Results) -> tuple[list[str], bool]:
    """Lines on what moved or is no longer compared since the baseline; whether that is worse."""
    if gathered.baseline is None:
        return [], False
    lost = [
        f"warning: {name} agreed in the baseline and is skipped now: {why}"
        for name, why in gathered.no_longer_compared.items()
    ]
    comparison = gathered.compared_with(gathered.baseline)
    worse = [
        f"worse     {change.id}: {change.before} in the baseline, now {change.after}"
        for change in comparison.verdicts
        if change.worse and change.id not in gathered.no_longer_compared
    ]
    return [*lost, *worse, f"against the baseline: {sentence(comparison)}"], comparison.worsened


def how_to_go_on(request: Request) -> str:
    """The command that goes on with an interrupted run."""
    command = ["flexproof", "run", request.robot_file.source, "--preset", request.preset]
    command += ["--only", request.only] if request.only else []
    command += ["--baseline", str(request.baseline)] if request.baseline else []
    command += ["--export"] if request.exports else []
    command += ["--cluster", request.cluster] if request.cluster else []
    for option, given in request.asked.items():
        # Of measured values the digest is kept there.
        words = given.split() if option != "measured" else ()
        command += [word for one in words for word in (f"--{option}", one)]
    command += ["--measured", str(request.measured)] if request.measured else []
    command += ["--strict"] if request.strict else []
    return f"go on with: {join([*command, '--out', str(request.out), '--resume'])}"
