import fcntl
import json
import os
import pickle
from pathlib import Path
from typing import Any

import pytest
from support.pages.messages import only_message
from support.robots.paper_robot_variants import IFW

from meshes.part import slices, volume
from meshes.part.reading import read
from validation import cli
from validation.adequacy.judgement import verdict_matrix
from validation.adequacy.robot_verdicts import robot_subject
from validation.context import Context
from validation.models import reduced_parts
from validation.references import reference_legs
from validation.references.reference import Subject
from validation.verdicts import Matrix


class CommandLine:
    """The command line, run in this process."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def output(self, *words: object, code: int = 0) -> str:
        """Output on stdout of a command that must end with the exit code `code`."""
        assert cli.main([str(word) for word in words]) == code
        return self._capsys.readouterr().out

    def json(self, *words: object) -> Any:
        """JSON output of a command."""
        return json.loads(self.output(*words, "--json"))

    def error_line(self, *words: object) -> str:
        """The single line on stderr of a command that is refused and prints no results."""
        assert cli.main([str(word) for word in words]) == 2
        printed = self._capsys.readouterr()
        assert printed.out == ""
        line = only_message(printed.err)
        assert line.startswith("flexproof: ")
        return line


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> CommandLine:
    return CommandLine(capsys)


@pytest.fixture(scope="module")
def blank_charts():
    """Replace charts by blank ones, which saves most of the time of making a page."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("validation.drawing.plot.chart_svg", lambda _: "<svg ></svg>")
        yield patch


@pytest.fixture(scope="session")
def paper_subject() -> Subject:
    """Models and references of the paper's robot, for tests in several modules.

    The first worker that needs it computes it, and the others wait.
    """
    with Path(os.environ["XDG_CACHE_HOME"], "paper").open("a+b") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.seek(0)
        if not (pickled := file.read()):
            subject = robot_subject(Context(IFW, "quick"))
            # Responses are solved when they are needed: with them the others are spared that.
            verdict_matrix(subject, IFW.requirement)
            pickled = pickle.dumps(subject)
            file.write(pickled)
    unpickled: Subject = pickle.loads(pickled)  # noqa: S301  our own
    return unpickled


@pytest.fixture(scope="session")
def paper(paper_subject: Subject) -> Matrix:
    return verdict_matrix(paper_subject, IFW.requirement)


@pytest.fixture(scope="module")
def coarse_parts():
    """Replace the meshes of parts by coarse ones of some thousand unknowns (in this process)."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reduced_parts, "UNKNOWNS", 6_000)
        for module in (read, volume, slices):
            patch.setattr(
                module, "within_limits", lambda _, function, *arguments: function(*arguments)
            )
        yield patch


@pytest.fixture(scope="module")
def coarse_legs():
    """Replace the solids of legs by coarse ones, with section meshes of a hundred nodes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(reference_legs.UNKNOWNS, "quick", (300, 2500))
        yield
