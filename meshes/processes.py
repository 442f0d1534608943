"""Computation in another process: a fresh interpreter that evaluates one call after the other.

A call is a function with its arguments. The process answers it with the value of the function, or
with the error that the function raises. If a library crashes or runs out of memory, only this
process ends. It does not run the script of the user again. Ctrl-C and hang-ups do not reach it: the
calling process decides whether to continue. The process ends when the calling process ends, for
whatever reason.
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

from lumped.errors import ComputationError, InputError, Remark, program_error, remarks_to
from lumped.posix import resource

T = TypeVar("T")
# Longest time (s) of one wait, because a Ctrl-C just before a wait does not interrupt it.
_HEARTBEAT = 0.5
# Limit on the address space (bytes): sufficient for meshes of about three million unknowns.
_MEMORY = 8_000_000_000
# Likely reason why a process was ended by a signal.
_REASONS = {
    "SIGKILL": ", probably because of lack of memory",
    "SIGXCPU": ", because it exceeded the time limit",
}
# The child inherits one end of a pipe, which works differently on Windows.
_POSIX = os.name == "posix"


class Crashed(ComputationError):  # noqa: N818  names the event, as messages do
    """Error: the other process ended without an answer, or did not answer in time."""


@dataclass(frozen=True)
class _Raised:
    """Error that a call raised instead of returning a value."""

    error: Exception


class CallAnswer(NamedTuple):
    """Answer to a call: its `value` or error, and the `remarks` issued while it ran."""

    value: object
    remarks: list[Remark]

    def result(self) -> Any:
        """Value of the call. Raises the error that the call raised.

        The remarks of the call are issued again in this process.
        """
        for remark in self.remarks:
            warnings.warn(remark, stacklevel=2)
        if isinstance(self.value, _Raised):
            raise self.value.error
        return self.value


class _Question(NamedTuple):
    """A call to be evaluated in the other process.

    If it is `persistent`, its value is kept there as first argument of all later calls.
    """

    function: Callable[..., object]
    arguments: tuple[object, ...]
    persistent: bool = False


class Process:
    """An interpreter in another process, with the same search path for modules as this one.

    The output of libraries is appended to the file `output`. `environment` contains the environment
    variables that differ from those of this process, by name.
    """

    def __init__(
        self, output: Path = Path(os.devnull), environment: Mapping[str, str] | None = None
    ) -> None:
        if not _POSIX:
            raise ComputationError(
                "worker processes are available only on Linux and macOS; on Windows run "
                "flexproof in the Windows Subsystem for Linux"
            )
        self.connection, child_end = Pipe()
        serving = f"from meshes.processes import serve; serve({child_end.fileno()})"
        paths = os.pathsep.join(path or str(Path.cwd()) for path in sys.path)
        with child_end, output.open("ab") as sink:
            self._process = subprocess.Popen(  # noqa: S603  this interpreter
                [sys.executable, "-P", "-c", serving],
                env={**os.environ, **(environment or {}), "PYTHONPATH": paths},
                pass_fds=[child_end.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=sink,
                stderr=sink,
                start_new_session=True,
            )

    def request(self, function: Callable[..., object], *arguments: object) -> None:
        """Request the value of `function(*arguments)`.

        The function must be at the top level of a module.
        """
        self._send(_Question(function, arguments))

    def begin(self, function: Callable[..., object], *arguments: object) -> None:
        """Request a value that is kept in the process, as first argument of all later calls.

        The answer to this request is None.
        """
        self._send(_Question(function, arguments, persistent=True))

    def _send(self, question: "_Question") -> None:
        content = pickle.dumps(question)
        try:
            self.connection.send_bytes(content)
        except ConnectionError:
            # The end of the process is detected when the answer is read.
            return

    def answer(self, patience: float = inf) -> Any:
        """Value of the earliest call not yet answered, waiting at most `patience` (s) for it.

        Remarks of the call are issued again in this process. Raises an InputError or
        ComputationError of the call, ProgramError for any other error of the call, and Crashed if
        the process ends or does not answer in time.
        """
        begun = monotonic()
        while not self.has_answer():
            if monotonic() - begun > patience:
                raise Crashed(f"the computing process gave no answer in {patience:g} s")
        return self.receive().result()

    def has_answer(self) -> bool:
        """True if an answer or the end of the process arrives within half a second."""
        try:
            return self.connection.poll(_HEARTBEAT)
        except ConnectionError:
            # `receive` reports the end of the process.
            return True

    def receive(self) -> CallAnswer:
        """Answer to the earliest call not yet answered. Raises Crashed if the process ended."""
        try:
            answer: CallAnswer = self.connection.recv()
        except (EOFError, ConnectionError):
            raise Crashed(f"the computing process {self._cause_of_end()}") from None
        return answer

    def end(self) -> None:
        """Kill the other process."""
        self._process.kill()
        self._process.wait()
        self.connection.close()

    def _cause_of_end(self) -> str:
        code = self._process.wait()
        if code >= 0:
            return f"ended with code {code}"
        name = signal.Signals(-code).name
        return f"was ended by {name}{_REASONS.get(name, '')}"


def in_own_process(function: Callable[..., T], *arguments: object, patience: float = inf) -> T:
    """Value of `function(*arguments)`, evaluated in a fresh interpreter.

    The function must be at the top level of a module. Output of libraries is discarded. `patience`
    (s) is the longest time to wait for the value. Raises errors as `Process.answer` does.
    """
    process = Process()
    try:
        process.request(function, *arguments)
        answer: T = process.answer(patience)
    finally:
        process.end()
    return answer


def within_limits(seconds: float, function: Callable[..., T], *arguments: object) -> T:
    """Value of `function(*arguments)` in a fresh interpreter, with limits on CPU time and memory.

    The limits are `seconds` of CPU time and 8 GB of memory. They protect against damaged files of
    other programs and against libraries that run without end. Raises errors as `in_own_process`
    does, and Crashed if a limit is exceeded.
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
    # Address space that the libraries use already. It grows with the number of cores.
    statm = Path("/proc/self/statm")
    used = int(statm.read_text().split()[0]) * resource.getpagesize() if statm.exists() else 0
    _limit(resource, resource.RLIMIT_AS, used + _MEMORY)
    _limit(resource, resource.RLIMIT_CPU, ceil(process_time() + seconds))
    # A core dump is useless to a user.
    _limit(resource, resource.RLIMIT_CORE, 0)


def _limit(resource: ModuleType, kind: int, limit: int) -> None:
    soft, hard = resource.getrlimit(kind)
    if soft == resource.RLIM_INFINITY or soft > limit:
        # Some systems lack some limits.
        with suppress(ValueError, OSError):
            resource.setrlimit(kind, (limit, hard))


def serve(descriptor: int) -> None:
    """Main function of the other process: answer calls until the calling process is gone.

    `descriptor` is the file descriptor of the connection to the calling process.
    """
    faulthandler.enable()
    connection = Connection(descriptor)
    questions: SimpleQueue[bytes] = SimpleQueue()
    Thread(target=_receive, args=(connection, questions), daemon=True).start()
    persistent: list[object] = []
    while True:
        connection.send_bytes(_answered(questions.get(), persistent))


def _answered(content: bytes, persistent: list[object]) -> bytes:
    """Pickled answer to a pickled call. `persistent` are the values kept so far.

    They are the first arguments of the call. The value of a persistent call is appended to them.
    """
    remarks: list[Remark] = []
    try:
        question: _Question = pickle.loads(content)  # noqa: S301  from the parent process
        with remarks_to(remarks.append):
            value = question.function(*persistent, *question.arguments)
        if question.persistent:
            persistent.append(value)
            value = None
        return pickle.dumps(CallAnswer(value, remarks))
    except (InputError, ComputationError) as error:
        raised = _Raised(error)
    except MemoryError:
        raised = _Raised(ComputationError("out of memory"))
    except Exception as error:  # noqa: BLE001  any error is passed to the caller
        traceback.print_exc()
        raised = _Raised(program_error(error))
    return pickle.dumps(CallAnswer(raised, remarks))


def _receive(connection: Connection, questions: SimpleQueue[bytes]) -> None:
    """Queue the calls from a connection. End this process when the calling process is gone."""
    try:
        while True:
            questions.put(connection.recv_bytes())
    except (EOFError, OSError):
        os._exit(1)
