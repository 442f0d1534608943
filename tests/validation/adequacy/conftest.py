"""The matrix of the paper's robot, of which several modules look at the one or the other part."""

import pytest

from lumped.robot_file import load_robot
from validation.adequacy.matrix import Matrix
from validation.adequacy.robot import robot_adequacy
from validation.context import Context


@pytest.fixture(scope="session")
def paper() -> Matrix:
    return robot_adequacy(Context(load_robot("ifw"), "quick"))
