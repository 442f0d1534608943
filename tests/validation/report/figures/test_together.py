"""Plots drawn by several processes are those that one draws, whatever becomes of the others."""

import os
from functools import partial

import pytest

from validation.exhibits import Figure
from validation.report.figures.together import drawn_together


def a_figure(number):
    return Figure(id=f"plot.{number}", title="", caption="", section="", svg=f"<svg>{number}</svg>")


def refused(number):
    raise ValueError(f"no plot {number}")


def ends_elsewhere(here, number):
    if os.getpid() != here:
        os._exit(1)
    return a_figure(number)


@pytest.mark.parametrize("processes", [1, 2, 3, 20])
def test_figures_come_in_their_order_and_none_where_one_fails(processes):
    draws = [partial(refused if k == 3 else a_figure, k) for k in range(7)]
    expected = [None if k == 3 else a_figure(k) for k in range(7)]
    assert drawn_together(draws, processes) == expected


def test_a_process_that_ends_leaves_its_plots_to_this_one():
    draws = [partial(ends_elsewhere, os.getpid(), k) for k in range(5)]
    assert drawn_together(draws, 2) == [a_figure(k) for k in range(5)]


def test_others_do_draw():
    drawn = drawn_together([lambda: a_figure(os.getpid())] * 4, 2)
    assert len({figure.id for figure in drawn}) == 2


def test_nothing_is_drawn_of_nothing():
    assert drawn_together([], 2) == []
