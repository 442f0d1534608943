"""Half units of printed digits, from texts whose digits can be counted by hand."""

import numpy as np

from lumped.robot_file.reading import printed_compliances


def rows(**entries: str) -> str:
    """A 6×6 of whole zeros with some entries as text, `c23="1.2e-3"` in row 2, column 3."""
    texts = [[entries.get(f"c{i}{j}", "0") for j in range(1, 7)] for i in range(1, 7)]
    return f"[{', '.join('[' + ', '.join(row) + ']' for row in texts)}]"


def test_half_a_unit_of_the_last_digit_zeros_exact_and_mirror_images_one_rounding() -> None:
    entries = {"c11": "1.67e-10", "c22": "5.870E-9", "c33": "0.0025", "c44": "2e-7"}
    mirrored = {"c12": "0.0", "c21": "-0.0", "c23": "-1.5e-9", "c32": "-1.50e-9"}
    (printed,) = printed_compliances(f"[bodies.rod]\ncompliance = {rows(**entries, **mirrored)}")
    expected = np.diag([0.5e-12, 0.5e-12, 0.5e-4, 0.5e-7, 0.0, 0.0])
    expected[1, 2] = expected[2, 1] = 0.05e-9
    assert np.array_equal(printed.half, expected)
    assert np.diag(printed.compliance).tolist() == [1.67e-10, 5.87e-9, 0.0025, 2e-7, 0.0, 0.0]


def test_every_6x6_of_either_schema_is_seen_and_nothing_else() -> None:
    own = f"compliance = {rows(c11='1.50e-9')}\n"
    tables = ("[leg1]", "[bodies.a]\nmass = 1.5", "[joints.'b.c']")
    text = "[path]\nfrom = [0.20, 0.50]\n" + "".join(f"{one}\n{own}" for one in tables)
    assert [one.half[0, 0] for one in printed_compliances(text)] == [0.005e-9] * 3


def test_round_figures_of_a_designer_are_exact() -> None:
    """A bearing of 5e-10 m/N is no number between 4.5e-10 and 5.5e-10 that was rounded."""
    (chosen,) = printed_compliances(f"[foot]\ncompliance = {rows(c11='5e-10', c66='1.2e-7')}")
    assert not chosen.half.any()
