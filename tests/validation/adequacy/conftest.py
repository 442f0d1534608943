"""The paper's robot and its matrix, of which several modules look at the one or the other part."""

import pytest
from like_ifw import IFW

from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Matrix
from validation.adequacy.response import Subject
from validation.adequacy.robot import robot_subject
from validation.context import Context


@pytest.fixture(scope="session")
def paper_subject() -> Subject:
    return robot_subject(Context(IFW, "quick"))


@pytest.fixture(scope="session")
def paper(paper_subject: Subject) -> Matrix:
    return judged(paper_subject, IFW.requirement)
