"""A long computation in a process of its own: Ctrl-C ends it at once, a crash ends it alone."""

from collections.abc import Callable
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import TypeVar

from lumped.errors import ComputationError, InputError
from validation.run.progress import stage
from validation.sweeps.processes import children_undisturbed, end_with_parent

Q = TypeVar("Q")
A = TypeVar("A")


def in_a_process(compute: Callable[[Q], A], question: Q, doing: str) -> A:
    """`compute(question)`, a function at the top of a module, while a terminal shows `doing`.

    Raises what it raises of InputError, ComputationError and KeyboardInterrupt, and
    ComputationError where the process ends without an answer: libraries that run out of memory
    end it.
    """
    spawn = get_context("spawn")
    receiver, sender = spawn.Pipe(duplex=False)
    process = spawn.Process(target=_answer, args=(sender, compute, question), daemon=True)
    with children_undisturbed():
        process.start()
    sender.close()
    try:
        with stage(doing):
            answer = receiver.recv()
    except EOFError:
        process.join()
        raise ComputationError(
            f"the computing process ended with code {process.exitcode} and no answer, probably for "
            "want of memory"
        ) from None
    finally:
        process.kill()
        process.join()
        receiver.close()
    if isinstance(answer, InputError | ComputationError):
        raise answer
    return answer  # type: ignore[no-any-return]


def _answer(sender: Connection, compute: Callable[[Q], A], question: Q) -> None:
    end_with_parent()
    try:
        answer: object = compute(question)
    except (InputError, ComputationError) as error:
        answer = error
    except MemoryError:
        answer = ComputationError("memory ran out")
    sender.send(answer)
