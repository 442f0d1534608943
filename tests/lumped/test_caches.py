"""What is kept, and forgotten."""

import gc
from dataclasses import dataclass

from lumped.caches import cached_property, forget, lru_cache

COUNTS = {"function": 0, "property": 0}


@lru_cache(maxsize=2)
def doubled(value: int) -> int:
    COUNTS["function"] += 1
    return 2 * value


@dataclass(frozen=True)
class Square:
    side: float

    @cached_property
    def area(self) -> float:
        COUNTS["property"] += 1
        return self.side**2


def test_values_are_kept_until_they_are_forgotten():
    COUNTS.update(function=0, property=0)
    square, other = Square(3.0), Square(3.0)
    for expected in (1, 2):
        assert [doubled(4), doubled(4), square.area, square.area] == [8, 8, 9.0, 9.0]
        # Equal objects each keep their own.
        assert other.area == 9.0
        assert {"function": expected, "property": 2 * expected} == COUNTS
        forget()


def test_what_keeps_a_value_is_not_kept_alive_by_it():
    COUNTS.update(property=0)
    assert Square(2.0).area == 4.0
    gc.collect()
    forget()
    assert Square(2.0).area == 4.0
    assert COUNTS["property"] == 2
