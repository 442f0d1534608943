"""The command `selftest`, as the command line takes it up."""

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from fem.machine import TO_COMPUTE, require_address_space
from lumped.errors import ComputationError
from validation.console.arguments import ProcessCount
from validation.console.streams import complain, say
from validation.console.written import shown

if TYPE_CHECKING:
    from validation.context import Preset
    from validation.run.gathered import Results


def selftest(
    *,
    preset: Literal["quick", "standard", "fine"] = "standard",
    jobs: ProcessCount = None,
    out: Path | None = None,
) -> int:
    """Check the program itself: published benchmarks, meshes, other solvers.

    What it finds is kept in the user's cache, where runs of this version and preset take it from.

    Parameters
    ----------
    preset
        How much to compute: quick takes seconds, standard a minute, fine longer.
    jobs
        Number of processes; as many as there are cores if left out.
    out
        Folder for report.html, results.json, junit.xml and figures/ of the checks; none if left
        out.
    """
    from validation.run import summary  # noqa: PLC0415
    from validation.run.session import default_jobs  # noqa: PLC0415
    from validation.store.tree import StoreError  # noqa: PLC0415

    require_address_space(TO_COMPUTE)
    try:
        gathered = checked(preset, jobs or default_jobs(), out)
    except StoreError as error:
        raise ComputationError(str(error)) from error
    complain([*gathered.remarks, *summary.left_out(gathered)], 0)
    say("\n".join([*summary.verdicts(gathered), summary.program(gathered)]))
    if out is not None:
        say(f"report: {shown(gathered.path / 'report.html')}")
    if gathered.unfinished:
        complain(["interrupted; runs take what was finished, and make the other checks"], 3)
    return gathered.exit_code()


def checked(preset: "Preset", jobs: int, out: Path | None) -> "Results":
    """All checks of the program, made again and kept; a report where `out` names a folder.

    Raises InputError where the folder cannot be used, StoreError where the disk refuses, and
    ComputationError where workers cannot start.
    """
    from tempfile import TemporaryDirectory  # noqa: PLC0415

    from lumped.robot_file import load_robot  # noqa: PLC0415
    from validation.catalogue import checks  # noqa: PLC0415
    from validation.context import BUILT_IN  # noqa: PLC0415
    from validation.run.session import Request, validate  # noqa: PLC0415

    with TemporaryDirectory(prefix="flexproof-selftest-") as aside:
        folder = out or Path(aside) / "run"
        request = Request(load_robot(BUILT_IN), preset, folder, jobs, selftest=True)
        return validate(request, checks)
