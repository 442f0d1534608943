"""Functions in processes of their own: values, errors, and processes that end without an answer."""

import os
import resource

import numpy as np
import pytest

from lumped.errors import ComputationError, InputError
from meshes.processes import Crashed, in_own_process, within_limits


def test_a_value_comes_back_from_another_process():
    assert in_own_process(divmod, 7, 2) == (3, 1)
    assert in_own_process(os.getpid) != os.getpid()
    # In a session of its own, where Ctrl-C and hang-ups of a terminal do not reach it.
    assert in_own_process(os.getsid, 0) != os.getsid(0)


def test_errors_come_back_as_they_are_or_with_their_kind():
    with pytest.raises(InputError, match="one") as raised:
        in_own_process(refused, "one", "two")
    assert raised.value.faults == ("one", "two")
    with pytest.raises(ComputationError, match="ZeroDivisionError"):
        in_own_process(divmod, 1, 0)


def refused(*faults):
    raise InputError(faults)


def test_a_crash_ends_the_other_process_alone():
    with pytest.raises(Crashed, match="was ended by SIGABRT"):
        in_own_process(os.abort)


def busy():
    while True:
        pass


def hungry():
    """Ten gigabytes, of which none is touched."""
    return np.zeros(10**10, np.uint8).size


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (busy, "was ended by SIGXCPU, its time was up"),
        (hungry, "more than 8 GB of memory would be needed"),
    ],
)
def test_limits_of_time_and_memory_end_it_and_say_which(function, said):
    with pytest.raises(Crashed, match=said):
        within_limits(0.5, function)
    assert within_limits(0.5, resource.getrlimit, resource.RLIMIT_CORE)[0] == 0
    assert resource.getrlimit(resource.RLIMIT_CPU)[0] == resource.RLIM_INFINITY
