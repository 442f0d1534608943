"""Arrays that an executor computes and the cache keeps, so that no task is computed twice.

Input: tasks and an executor. Output: their arrays. Rule: the cache of this machine is searched
before a process or a worker of a cluster computes a task. Each result is stored before the next one
is processed, so that an interrupted computation continues after the last one.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from typing import Any, Generic, TypeVar

from lumped.files import digest
from lumped.mechanism.body import Part
from lumped.mechanism.mechanism import Mechanism
from lumped.memo import comparison_fingerprint
from lumped.robot_file.included import part_content
from validation.run.cache import Arrays, find, keep, program
from validation.run.executor import Executor, Finished

T = TypeVar("T")


def stored_arrays(
    tasks: Mapping[str, Callable[[], Mapping[str, Any]]],
    names: Collection[str],
    executor: Executor,
) -> dict[str, Arrays]:
    """Arrays of the tasks, by key. The executor computes those that the cache lacks.

    `tasks`: function that computes the arrays of a task, by key of the cache. It returns arrays
    with these `names`. A stored entry with other names counts as absent. Raises the exception of
    the first task that fails.
    """
    wanted = set(names)
    stored = {key: arrays for key in tasks if (arrays := find(key)) and set(arrays) == wanted}
    missing = [key for key in tasks if key not in stored]
    if missing:
        with closing(executor([tasks[key] for key in missing])) as finished:
            for number, arrays in finished:
                stored[missing[number]] = keep(missing[number], arrays)
    return stored


@dataclass(frozen=True)
class StoringExecutor(Generic[T]):
    """Executor of calls whose results are made of arrays. Stored results are not computed again.

    Each call is a `partial` of a module-level function and plain data. The key of its result covers
    function, data, `inputs`, sources and libraries. `executor` computes results that the cache
    lacks. `arrays_of` converts a result to arrays with these `names`. `read` converts the arrays to
    the result.
    """

    executor: Executor
    inputs: tuple[str, ...]
    names: tuple[str, ...]
    arrays_of: Callable[[T], Mapping[str, Any]]
    read: Callable[[Arrays], T]

    def __call__(self, calls: Sequence[Callable[[], Any]]) -> Finished:
        """Yield number and result of each call, in the order of the calls."""
        keys = [comparison_fingerprint((program(), self.inputs, call)) for call in calls]
        tasks = {
            key: partial(_arrays, self.arrays_of, call)
            for key, call in zip(keys, calls, strict=True)
        }
        arrays = stored_arrays(tasks, self.names, self.executor)
        for number, key in enumerate(keys):
            yield number, self.read(arrays[key])


def _arrays(
    arrays_of: Callable[[T], Mapping[str, Any]], call: Callable[[], T]
) -> Mapping[str, Any]:
    return arrays_of(call())


def part_digests(mechanism: Mechanism) -> tuple[str, ...]:
    """Digests of the contents of a mechanism's part files, as inputs of keys."""
    shapes = (body.shape for body in mechanism.parts.values())
    return tuple(digest(part_content(shape.file)) for shape in shapes if isinstance(shape, Part))
