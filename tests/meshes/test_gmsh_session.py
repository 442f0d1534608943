"""The one way into gmsh: fresh, silent, closed whatever happens, from any thread."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256

import gmsh
import pytest

from lumped.errors import ComputationError, InputError
from lumped.sections import Circle, Tube
from meshes.gmsh_session import gmsh_model
from meshes.prism.tetrahedra import tetrahedra
from meshes.solid_mesh import SolidMesh


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
    tetrahedra(Circle(0.1), 0.2, 2)
    assert capfd.readouterr() == ("", "")


HASHED = """
from hashlib import sha256
from lumped.sections import Tube
from meshes.prism.tetrahedra import tetrahedra
mesh = tetrahedra(Tube(0.1, 0.02), 0.2, 1)
print(sha256(mesh.nodes.tobytes() + mesh.cells.tobytes()).hexdigest())
"""


def hashed(mesh: SolidMesh) -> str:
    return sha256(mesh.nodes.tobytes() + mesh.cells.tobytes()).hexdigest()


def test_threads_and_another_process_give_the_same_meshes_as_the_main_thread() -> None:
    section = Tube(0.1, 0.02)
    here = hashed(tetrahedra(section, 0.2, 1))
    with ThreadPoolExecutor(3) as pool:
        meshes = list(pool.map(lambda _: tetrahedra(section, 0.2, 1), range(3)))
    there = subprocess.check_output([sys.executable, "-c", HASHED], text=True)
    assert {*map(hashed, meshes), there.strip()} == {here}


# gmsh sets both signals back to their defaults: a run would end with the first worker that dies, a
# run under nohup with its first mesh.
SIGNALS = """
import os, signal
from threading import Thread, enumerate
from meshes.gmsh_session import gmsh_model

def use():
    with gmsh_model("part"):
        pass

{call}
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


@pytest.mark.parametrize("call", ["use()", "Thread(target=use).start()"])
def test_a_broken_pipe_is_an_error_and_an_ignored_hang_up_stays_ignored(call: str) -> None:
    done = subprocess.run(
        ["nohup", sys.executable, "-c", SIGNALS.format(call=call)],  # noqa: S607  whichever nohup
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (0, "an error\nstill here\n"), done.stderr
