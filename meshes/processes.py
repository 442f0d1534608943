"""Computing in another process: a fresh interpreter that answers one question after the other.

Questions are functions and their arguments; their values, or the errors that they raise, come
back. Libraries that crash or run out of memory end that process alone, and nothing of the script
that asks is run again in it. Ctrl-C and hang-ups do not reach it: whoever asks decides what is to
be done, and takes it along when it ends itself, however that comes about.
"""

import faulthandler
import os
import pickle
import signal
import subprocess
import sys
import traceback
import warnings
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from math import ceil, inf
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from time import monotonic, process_time
from types import ModuleType
from typing import Any, NamedTuple, TypeVar

from lumped.errors import ComputationError, InputError, Remark, remarks_to
from lumped.posix import resource

T = TypeVar("T")
# How long (s) a wait may last: a Ctrl-C that comes just before it begins does not end it.
_HEARTBEAT = 0.5
# Address space (bytes) that computing within limits may take: some three million unknowns are
# meshed in it.
_MEMORY = 8_000_000_000
# What a signal tells that ends a process which did nothing forbidden.
_WHY = {"SIGKILL": ", probably for want of memory", "SIGXCPU": ", its time was up"}
# The other process inherits one end of a pipe, which Windows does in another way.
_POSIX = os.name == "posix"


class Crashed(ComputationError):  # noqa: N818  says what happened to the process
    """Raised where the process ended without an answer."""


@dataclass(frozen=True)
class _Raised:
    """The error that comes in place of a value."""

    error: Exception


class _Answer(NamedTuple):
    """A value, or the error in its place, and the remarks made on the way."""

    value: object
    remarks: list[Remark]


class _Question(NamedTuple):
    """A call for the other process; if it `stays`, its value is kept there."""

    function: Callable[..., object]
    arguments: tuple[object, ...]
    stays: bool = False


class Process:
    """An interpreter that computes for this one, with the same search path for modules.

    What its libraries print is added to the file `output`; `environment` is what differs in it.
    """

    def __init__(
        self, output: Path = Path(os.devnull), environment: Mapping[str, str] | None = None
    ) -> None:
        if not _POSIX:
            raise ComputationError(
                "computing in processes of its own works on Linux and macOS alone; on Windows run "
                "flexproof in the Windows Subsystem for Linux"
            )
        self.connection, theirs = Pipe()
        serving = f"from meshes.processes import serve; serve({theirs.fileno()})"
        paths = os.pathsep.join(path or str(Path.cwd()) for path in sys.path)
        with theirs, output.open("ab") as sink:
            self._process = subprocess.Popen(  # noqa: S603  this interpreter
                [sys.executable, "-P", "-c", serving],
                env={**os.environ, **(environment or {}), "PYTHONPATH": paths},
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=sink,
                stderr=sink,
                start_new_session=True,
            )

    def ask(self, function: Callable[..., object], *arguments: object) -> None:
        """Have `function(*arguments)` computed, a function at the top of a module."""
        self._send(_Question(function, arguments))

    def begin(self, function: Callable[..., object], *arguments: object) -> None:
        """Have a value computed that stays there: the first argument of all later functions.

        The answer is None.
        """
        self._send(_Question(function, arguments, stays=True))

    def _send(self, question: "_Question") -> None:
        content = pickle.dumps(question)
        try:
            self.connection.send_bytes(content)
        except ConnectionError:
            # Its end is noticed when the answer is read.
            return

    def answer(self, patience: float = inf) -> Any:
        """The value for the first question that is not answered yet; waits `patience` (s) for it.

        Its remarks are made here. Raises its InputError and ComputationError, which every other
        error becomes, and Crashed.
        """
        begun = monotonic()
        try:
            while not self.connection.poll(_HEARTBEAT):
                if monotonic() - begun > patience:
                    raise Crashed(f"the computing process gave no answer in {patience:g} s")
            answer: _Answer = self.connection.recv()
        except (EOFError, ConnectionError):
            raise Crashed(f"the computing process {self._how_it_ended()}") from None
        for remark in answer.remarks:
            warnings.warn(remark, stacklevel=2)
        if isinstance(answer.value, _Raised):
            raise answer.value.error
        return answer.value

    def end(self) -> None:
        """End it, whatever it is doing."""
        self._process.kill()
        self._process.wait()
        self.connection.close()

    def _how_it_ended(self) -> str:
        code = self._process.wait()
        if code >= 0:
            return f"ended with code {code}"
        name = signal.Signals(-code).name
        return f"was ended by {name}{_WHY.get(name, '')}"


def in_own_process(function: Callable[..., T], *arguments: object, patience: float = inf) -> T:
    """`function(*arguments)`, a function at the top of a module, in a fresh interpreter.

    Raises what `Process.answer` does. What the libraries print is lost with the process.
    """
    process = Process()
    try:
        process.ask(function, *arguments)
        answer: T = process.answer(patience)
    finally:
        process.end()
    return answer


def within_limits(seconds: float, function: Callable[..., T], *arguments: object) -> T:
    """As `in_own_process`, for what others made: with so many `seconds` of computing, and 8 GB.

    Raises Crashed also where that is not enough.
    """
    value: T = in_own_process(_limited, seconds, function, *arguments)
    return value


def _limited(seconds: float, function: Callable[..., T], *arguments: object) -> T:
    if resource is not None:
        _limit_resources(resource, seconds)
    try:
        return function(*arguments)
    except MemoryError:
        raise Crashed(f"more than {_MEMORY / 1e9:g} GB of memory would be needed") from None


def _limit_resources(resource: ModuleType, seconds: float) -> None:
    # The libraries have taken theirs before: it grows with the cores.
    statm = Path("/proc/self/statm")
    taken = int(statm.read_text().split()[0]) * resource.getpagesize() if statm.exists() else 0
    _limit(resource, resource.RLIMIT_AS, taken + _MEMORY)
    _limit(resource, resource.RLIMIT_CPU, ceil(process_time() + seconds))
    # What a crash leaves is of no use to who sent the file.
    _limit(resource, resource.RLIMIT_CORE, 0)


def _limit(resource: ModuleType, kind: int, most: int) -> None:
    soft, hard = resource.getrlimit(kind)
    if soft == resource.RLIM_INFINITY or soft > most:
        # Not every system has every limit.
        with suppress(ValueError, OSError):
            resource.setrlimit(kind, (most, hard))


def serve(descriptor: int) -> None:
    """Answer the questions that come through a connection, until it ends."""
    faulthandler.enable()
    connection = Connection(descriptor)
    questions: SimpleQueue[bytes] = SimpleQueue()
    Thread(target=_receive, args=(connection, questions), daemon=True).start()
    staying: list[object] = []
    while True:
        connection.send_bytes(_answered(questions.get(), staying))


def _answered(content: bytes, staying: list[object]) -> bytes:
    """The pickled answer to a question; a value that stays is added to those `staying`."""
    remarks: list[Remark] = []
    try:
        question: _Question = pickle.loads(content)  # noqa: S301  from who started this process
        with remarks_to(remarks.append):
            value = question.function(*staying, *question.arguments)
        if question.stays:
            staying.append(value)
            value = None
        return pickle.dumps(_Answer(value, remarks))
    except (InputError, ComputationError) as error:
        raised = _Raised(error)
    except MemoryError:
        raised = _Raised(ComputationError("memory ran out"))
    except Exception as error:  # noqa: BLE001  carried to who asked, whatever it is
        traceback.print_exc()
        raised = _Raised(ComputationError(f"{type(error).__name__}: {error}"))
    return pickle.dumps(_Answer(raised, remarks))


def _receive(connection: Connection, questions: SimpleQueue[bytes]) -> None:
    """Take in questions; end the process as soon as whoever asks is gone."""
    try:
        while True:
            questions.put(connection.recv_bytes())
    except (EOFError, OSError):
        os._exit(1)
