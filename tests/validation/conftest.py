import pytest
from like_ifw import IFW

from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Matrix
from validation.adequacy.response import Subject
from validation.adequacy.robot import robot_subject
from validation.context import Context
from validation.export import models as exports
from validation.models import parts


@pytest.fixture(scope="session")
def paper_subject() -> Subject:
    """The paper's robot, of which several modules look at the one or the other part."""
    return robot_subject(Context(IFW, "quick"))


@pytest.fixture(scope="session")
def paper(paper_subject: Subject) -> Matrix:
    return judged(paper_subject, IFW.requirement)


@pytest.fixture(scope="module")
def coarse_parts():
    """Meshes of some thousand unknowns in the place of those of a run."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (parts, exports):
            patch.setattr(module, "UNKNOWNS", 6_000)
        yield patch
