"""Child processes and gmsh models in them: values, errors, limits and equal results."""

import os
import resource
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256

import gmsh
import pytest

from lumped.errors import ComputationError, InputError, ProgramError, naming
from lumped.sections import Rectangle
from meshes.gmsh_session import gmsh_model
from meshes.prism import tetrahedra
from meshes.processes import Crashed, Process, in_own_process, within_limits

REFUSED = "from lumped.errors import InputError; raise InputError(('one', 'two'))"


def test_process_returns_values_and_errors():
    """Values, InputError with its faults, and a program error with its traceback."""
    process = Process()
    # The process has its own session, so that Ctrl-C or the end of a terminal does not reach it.
    questions = (divmod, 7, 2), (os.getsid, 0), (exec, REFUSED), (lookup_of_robot, 3)
    for question in questions:
        process.request(*question)
    assert process.answer() == (3, 1)
    assert process.answer() != os.getsid(0)
    with pytest.raises(InputError, match="one") as raised:
        process.answer()
    assert raised.value.faults == ("one", "two")
    # An error of the program has its case, its message, and a traceback for a report.
    with pytest.raises(ProgramError) as failed, naming("run"):
        process.answer()
    process.end()
    assert str(failed.value) == "run: --vary tool.mass=1: leg 2: KeyError: 3"
    assert "in lookup_of_robot" in "".join(failed.value.traceback)


def lookup_of_robot(leg):
    with naming("--vary tool.mass=1"), naming("leg 2"):
        return {}[leg]


def test_process_keeps_value_for_later_calls():
    """A call may use the results of earlier calls of its process."""
    process = Process()
    process.begin(list, "ab")
    process.request(len)
    process.begin(sorted)
    process.request(zip_lists)
    assert [process.answer() for _ in range(4)] == [None, 2, None, [("a", "a"), ("b", "b")]]
    process.end()


def zip_lists(*lists):
    return list(zip(*lists, strict=True))


def test_crash_ends_only_child_process():
    """SIGABRT, a CPU limit of 0.5 s and a memory limit of 8 GB: named in the error."""
    with pytest.raises(Crashed, match="was ended by SIGABRT"):
        in_own_process(os.abort)
    with pytest.raises(Crashed, match="was ended by SIGXCPU, because it exceeded the time limit"):
        within_limits(0.5, all, range(1, 10**15))
    with pytest.raises(Crashed, match="more than 8 GB of memory would be needed"):
        within_limits(0.5, bytes, 10**10)
    assert within_limits(0.5, resource.getrlimit, resource.RLIMIT_CORE)[0] == 0
    assert resource.getrlimit(resource.RLIMIT_CPU)[0] == resource.RLIM_INFINITY


def test_gmsh_failure_names_part():
    """gmsh is closed after its own errors and after those of the program."""
    reported = pytest.raises(ComputationError, match=r"leg 2: gmsh failed: .*NoSuchOption")
    with reported, gmsh_model("leg 2") as session:
        session.option.getNumber("Mesh.NoSuchOption")
    assert not gmsh.isInitialized()
    with pytest.raises(InputError, match="mine"), gmsh_model("part"):
        raise InputError("mine")
    assert not gmsh.isInitialized()


def test_inner_gmsh_model_restores_outer_one():
    """A model opened within another is empty; the outer one is current afterwards."""
    with gmsh_model("outer") as session:
        session.model.geo.addPoint(0.0, 0.0, 0.0, tag=5)
        session.model.geo.synchronize()
        with gmsh_model("inner"):
            assert session.model.getEntities(0) == []
        assert session.model.getCurrent() == "outer"
        assert session.model.getEntities(0) == [(0, 5)]


def hashed():
    mesh = tetrahedra(Rectangle(0.1, 0.1), 0.2, 1)
    return sha256(mesh.nodes.tobytes() + mesh.cells.tobytes()).hexdigest()


def test_threads_and_process_give_equal_meshes(capfd):
    """One part meshed in two threads, a child process and here: equal hashes."""
    with ThreadPoolExecutor(2) as pool:
        in_threads = list(pool.map(lambda _: hashed(), range(2)))
    assert {*in_threads, in_own_process(hashed)} == {hashed()}
    assert capfd.readouterr() == ("", "")


# gmsh resets the handlers of SIGPIPE and SIGHUP: a run would end with the first worker process that
# dies, and a run under nohup with its first mesh.
SIGNALS = """
import os, signal
from threading import Thread, enumerate
from meshes.gmsh_session import gmsh_model

def use():
    with gmsh_model("part"):
        pass

use()
Thread(target=use).start()
for thread in enumerate()[1:]:
    thread.join()
reading, writing = os.pipe()
os.close(reading)
try:
    os.write(writing, b"x")
except BrokenPipeError:
    print("an error")
os.kill(os.getpid(), signal.SIGHUP)
print("still here")
"""


def test_gmsh_keeps_signal_handlers():
    """After use of gmsh under nohup, SIGHUP stays ignored and a broken pipe raises an error."""
    command = ["nohup", sys.executable, "-c", SIGNALS]
    completed = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (completed.returncode, completed.stdout) == (0, "an error\nstill here\n"), (
        completed.stderr
    )
