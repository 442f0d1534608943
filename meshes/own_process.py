"""A function in a fresh process of its own: libraries that crash end that one alone.

    python -m meshes.own_process DESCRIPTOR

Through that connection arrive the function and its arguments; its value, or the error that it
raises, goes back. What the libraries print is lost with the process.
"""

import os
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import TypeVar, cast

from lumped.errors import ComputationError, InputError

T = TypeVar("T")


class Crashed(ComputationError):  # noqa: N818  says what happened to the process
    """Raised where the process ended without an answer."""


def in_own_process(function: Callable[..., T], *arguments: object) -> T:
    """`function(*arguments)`, a function at the top of a module, in a fresh interpreter.

    Raises its InputError and ComputationError, which every other error becomes, and Crashed.
    """
    ours, theirs = Pipe()
    interpreter = [sys.executable, "-m", "meshes.own_process", str(theirs.fileno())]
    paths = os.pathsep.join(filter(None, sys.path))
    with ours, theirs:
        process = subprocess.Popen(  # noqa: S603  this interpreter
            interpreter,
            env={**os.environ, "PYTHONPATH": paths},
            pass_fds=[theirs.fileno()],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        theirs.close()
        try:
            ours.send((function, arguments))
            answer = ours.recv()
        except (EOFError, ConnectionError):
            process.wait()
            raise Crashed(f"the process ended with code {process.returncode}, no answer") from None
        finally:
            process.kill()
            process.wait()
    if isinstance(answer, Exception):
        raise answer
    return cast("T", answer)


def _answer(descriptor: int) -> None:
    """Answer one question; end as soon as whoever asked is gone."""
    connection = Connection(descriptor)
    function, arguments = connection.recv()
    threading.Thread(target=_wait_and_leave, args=(connection,), daemon=True).start()
    try:
        answer = function(*arguments)
    except (InputError, ComputationError) as error:
        answer = error
    except Exception as error:  # noqa: BLE001  carried to who asked, whatever it is
        answer = ComputationError(f"{type(error).__name__}: {error}")
    connection.send(answer)


def _wait_and_leave(connection: Connection) -> None:
    with suppress(OSError, EOFError):
        connection.recv_bytes()
    os._exit(1)


if __name__ == "__main__":
    _answer(int(sys.argv[1]))
