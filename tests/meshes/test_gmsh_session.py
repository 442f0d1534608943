"""The one way into gmsh: fresh, silent, closed whatever happens, from any thread."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256

import gmsh
import pytest

from lumped.errors import ComputationError, InputError
from lumped.sections import Rectangle
from meshes.gmsh_session import gmsh_model
from meshes.prism.tetrahedra import tetrahedra
from meshes.processes import in_own_process


def test_failures_of_gmsh_name_the_part_and_others_pass_unchanged_and_all_close_it() -> None:
    with (
        pytest.raises(ComputationError, match=r"leg 2: gmsh failed: .*NoSuchOption"),
        gmsh_model("leg 2") as session,
    ):
        session.option.getNumber("Mesh.NoSuchOption")
    assert not gmsh.isInitialized()
    with pytest.raises(InputError, match="mine"), gmsh_model("part"):
        raise InputError("mine")
    assert not gmsh.isInitialized()


def test_an_inner_model_leaves_the_outer_one_current() -> None:
    with gmsh_model("outer") as session:
        session.model.geo.addPoint(0.0, 0.0, 0.0, tag=5)
        session.model.geo.synchronize()
        with gmsh_model("inner"):
            assert session.model.getEntities(0) == []
        assert session.model.getCurrent() == "outer"
        assert session.model.getEntities(0) == [(0, 5)]


def test_it_is_silent(capfd: pytest.CaptureFixture[str]) -> None:
    tetrahedra(Rectangle(0.1, 0.1), 0.2, 1)
    assert capfd.readouterr() == ("", "")


def hashed() -> str:
    mesh = tetrahedra(Rectangle(0.1, 0.1), 0.2, 1)
    return sha256(mesh.nodes.tobytes() + mesh.cells.tobytes()).hexdigest()


def test_threads_and_another_process_give_the_same_meshes_as_the_main_thread() -> None:
    with ThreadPoolExecutor(2) as pool:
        in_threads = list(pool.map(lambda _: hashed(), range(2)))
    assert {*in_threads, in_own_process(hashed)} == {hashed()}


# gmsh sets both signals back to their defaults: a run would end with the first worker that dies, a
# run under nohup with its first mesh.
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


def test_a_broken_pipe_is_an_error_and_an_ignored_hang_up_stays_ignored() -> None:
    done = subprocess.run(
        ["nohup", sys.executable, "-c", SIGNALS],  # noqa: S607  whichever nohup
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (0, "an error\nstill here\n"), done.stderr
