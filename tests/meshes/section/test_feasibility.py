"""Impossible requests end in one clear message per fault, before anything is meshed."""

import pytest

from lumped.errors import InputError
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
from meshes.section.section_mesh import require_leg, require_section


@pytest.mark.parametrize(
    ("section", "divisions", "reason"),
    [
        (Rectangle(0.1, -0.2), 4, "height = -0.2: must be above 0 m"),
        (HollowRectangle(0.1, 0.2, 0.05), 4, "closes the hollow"),
        (Tube(0.1, 0.05), 4, "closes the bore"),
        (ISection(0.1, 0.2, 0.1, 0.01), 4, "leaves no web"),
        (ISection(0.1, 0.2, 0.01, 0.1), 4, "web = 0.1"),
        (Circle(0.1), 0, "divisions = 0: must be at least 1"),
        (Rectangle(0.1, 0.2), (4, 0), "both must be at least 1"),
        (Circle(0.1), (4, 4), "two numbers suit a solid rectangle alone"),
    ],
)
def test_impossible_sections_are_refused(section, divisions, reason) -> None:
    with pytest.raises(InputError, match=reason):
        require_section(section, divisions)


def test_all_faults_are_named_at_once() -> None:
    with pytest.raises(InputError) as caught:
        require_section(Rectangle(0.0, -1.0), 0)
    assert len(caught.value.faults) == 3


@pytest.mark.parametrize(
    ("length", "reason"),
    [
        *((length, "must be above 0 m") for length in (0.0, float("nan"))),
        (0.19, r"length = 0\.19: shorter .* 0\.2 m"),
    ],
)
def test_impossible_lengths_are_refused(length, reason) -> None:
    with pytest.raises(InputError, match=reason):
        require_leg(Rectangle(0.1, 0.2), length, 4)
    require_leg(Rectangle(0.1, 0.2), 0.2, 4)
