import fcntl
import os
import pickle
from pathlib import Path

import pytest
from like_ifw import IFW

from meshes.part import slices, volume
from meshes.part.reading import read
from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Matrix
from validation.adequacy.response import Subject
from validation.adequacy.robot import robot_subject
from validation.context import Context
from validation.export import files as exports
from validation.models import parts


@pytest.fixture(scope="session")
def paper_subject() -> Subject:
    """The paper's robot, of which several modules look at the one or the other part.

    The first worker that wants it computes it, the others wait.
    """
    with Path(os.environ["XDG_CACHE_HOME"], "paper").open("a+b") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.seek(0)
        if not (kept := file.read()):
            kept = pickle.dumps(robot_subject(Context(IFW, "quick")))
            file.write(kept)
    found: Subject = pickle.loads(kept)  # noqa: S301  our own
    return found


@pytest.fixture(scope="session")
def paper(paper_subject: Subject) -> Matrix:
    return judged(paper_subject, IFW.requirement)


@pytest.fixture(scope="module")
def coarse_parts():
    """Meshes of some thousand unknowns in the place of those of a run, made in this process."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (parts, exports):
            patch.setattr(module, "UNKNOWNS", 6_000)
        for module in (read, volume, slices):
            patch.setattr(module, "within_limits", lambda _, function, *given: function(*given))
        yield patch
