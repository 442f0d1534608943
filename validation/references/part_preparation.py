"""Meshing of CAD parts, identification of their stiffness matrices, and reduction.

Input: the robot file and an executor for processes or a cluster. Output: entries in the cache
(`validation.run.cache`), from which the comparisons of the run then read. This preparation precedes
all other work of a run. The parts, and the meshes of one part, are independent of each other, so
each is a separate piece of work. An entry that is already stored is not computed again.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import Any

from lumped.errors import ComputationError, InputError
from lumped.mechanism.body import Body
from lumped.robot_file.included import part_content
from validation.context import Context
from validation.models import reduced_parts
from validation.models.loads.pressures import pressed_faces
from validation.models.stepped_parts import stepped_entry
from validation.parts.meshes import COARSE, FINEST, MIDDLE, part_key
from validation.references.reference_parts import highest_of_parts, interface_coupling
from validation.references.robot_on_path import RobotOnPath, robot_on_path
from validation.run.cache import Arrays, CacheEntry, find, keep
from validation.run.executor import Executor
from validation.run.provisions import sent_file

# Function that lists the cache entries to compute for a part.
Question = Callable[[Body], Sequence[CacheEntry[Any]]]


@dataclass(frozen=True)
class PartWork:
    """Computation of cache entries for one CAD part, on this machine or on another one.

    `content`: content of the part's file, for machines that cannot read it. `entries_of`: function
    that lists the entries. `remote`: true if another machine computes them and returns the arrays.
    """

    body: Body
    content: bytes
    entries_of: Question
    remote: bool

    def __call__(self) -> dict[str, Arrays]:
        """Compute the entries. If `remote`, return their arrays and those of their inputs, by key.

        An entry whose computation fails is skipped; the comparison that needs it reports the
        reason.
        """
        with self._local_body() as body:
            entries = _entries(self.entries_of, body)
            for entry in entries:
                with suppress(InputError, ComputationError):
                    entry.value()
            if not self.remote:
                return {}
            return {key: arrays for entry in entries for key, arrays in entry.stored_arrays.items()}

    @contextmanager
    def _local_body(self) -> Iterator[Body]:
        """Context manager that yields the part as a body whose file exists on this machine.

        If `remote`, the file is a temporary copy with the same `content`.
        """
        shape = reduced_parts.shape_of(self.body)
        if not self.remote:
            yield self.body
            return
        with sent_file(shape.file.name, self.content) as copy:
            yield replace(self.body, shape=replace(shape, file=copy))


def prepare_parts(context: Context, executor: Executor, *, remote: bool) -> None:
    """Compute and store the cache entries of all CAD parts: identifications first, then reductions.

    Raises the executor's error if a process or the cluster is lost, and InputError for interfaces
    or pressures without faces.
    """
    mechanism = context.robot_file.mechanism
    pressed_faces(mechanism)
    bodies = {
        part_key(*reduced_parts.found_in(body), reduced_parts.shape_of(body).material): body
        for body in mechanism.parts.values()
    }
    _compute_missing([(body, _identification) for body in bodies.values()], executor, remote=remote)
    requests = list(_reductions(robot_on_path(context), bodies.values()))
    _compute_missing(requests, executor, remote=remote)


def prepared_entries(context: Context) -> dict[str, Arrays]:
    """Stored arrays, by key, of all cache entries that `prepare_parts` computes."""
    parts = context.robot_file.mechanism.parts.values()
    requests = [
        *((body, _identification) for body in parts),
        *_reductions(robot_on_path(context), parts),
    ]
    entries = [entry for body, entries_of in requests for entry in _entries(entries_of, body)]
    return {key: arrays for entry in entries for key, arrays in entry.stored_arrays.items()}


def _identification(body: Body) -> list[CacheEntry[Any]]:
    stepped = [stepped_entry(body)] if reduced_parts.is_leg(body) else []
    return [reduced_parts.identified_entry(body), *stepped]


def _reduction(body: Body, **options: Any) -> list[CacheEntry[Any]]:
    return [reduced_parts.reduced_entry(body, **options)]


def _reductions(robot: RobotOnPath, bodies: Collection[Body]) -> Iterator[tuple[Body, Question]]:
    """Pairs of a body and a function that lists the cache entries of one of its reductions.

    There is a pair for each reduction that the run needs. The finest meshes, which take longest,
    are first.
    """
    alternatives = tuple(robot.holding.alternatives.values())
    first = alternatives[:1]
    highest, cutoff = highest_of_parts(robot.postures, robot.computed_count)
    entries_of = partial(_reduction, highest=highest, cutoff=cutoff)
    # Coarser meshes give the discretisation uncertainty; on the coarsest one, the reduction is also
    # checked by modes with free interfaces. Both are needed for the first end conditions only.
    for question, several in (
        (partial(entries_of, level=FINEST), alternatives),
        (partial(entries_of, level=MIDDLE), first),
        (partial(entries_of, level=COARSE), first),
        (partial(entries_of, level=COARSE, by="free"), first),
    ):
        for ends, body in product(several, bodies):
            yield body, partial(question, hold=interface_coupling(ends[body.name]))


def _entries(entries_of: Question, body: Body) -> Sequence[CacheEntry[Any]]:
    """Cache entries of a part. Empty if its file cannot be read or does not fit the robot."""
    try:
        return entries_of(body)
    except (InputError, ComputationError):
        return ()


def _compute_missing(
    requests: Sequence[tuple[Body, Question]], executor: Executor, *, remote: bool
) -> None:
    """Compute those requested entries that are not in the cache, and store them."""
    missing_work = [
        PartWork(
            body,
            part_content(reduced_parts.shape_of(body).file) if remote else b"",
            entries_of,
            remote,
        )
        for body, entries_of in requests
        if not all(entry.is_stored for entry in _entries(entries_of, body))
    ]
    if missing_work:
        for _, entries in executor(missing_work):
            for key, arrays in entries.items():
                if find(key) is None:
                    keep(key, arrays)
