"""CAD parts of a run before anything else: meshed, identified and reduced side by side.

Parts do not know of each other, and neither do the meshes of one: each is work of its own for a
core of this machine or a worker of a cluster. What comes out lies where the comparisons look for
it (validation.run.cache), so that these compute nothing of it again.
"""

import tempfile
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

from lumped.errors import ComputationError, InputError
from lumped.mechanism.body import Body
from lumped.robot_file.included import part_content
from validation.context import Context
from validation.models import reduced_parts
from validation.models.stepped_parts import stepped_entry
from validation.parts.meshes import COARSE, FINEST, MIDDLE, part_key
from validation.references.reference_parts import highest_of_parts, hold_of
from validation.references.robot_on_path import RobotOnPath, robot_on_path
from validation.run.cache import Arrays, CacheEntry, find, keep
from validation.run.executor import Executor

# Entries of the cache that are asked for of a part.
Question = Callable[[Body], Sequence[CacheEntry[Any]]]


@dataclass(frozen=True)
class PartWork:
    """What is asked of a part, with the `content` of its file for who does not have that.

    `carried`: whether what was computed comes back with the answer: from another machine.
    """

    body: Body
    content: bytes
    ask: Question
    carried: bool

    def __call__(self) -> dict[str, Arrays]:
        """Compute the entries; their arrays by key, and of those that they need, if `carried`.

        An entry that cannot be computed is left to the comparison that asks for it again.
        """
        with self._at_hand() as body:
            entries = _entries(self.ask, body)
            for entry in entries:
                with suppress(InputError, ComputationError):
                    entry.value()
            if not self.carried:
                return {}
            return {key: arrays for entry in entries for key, arrays in entry.stored_arrays.items()}

    @contextmanager
    def _at_hand(self) -> Iterator[Body]:
        """The body with its file on this machine."""
        shape = reduced_parts.shape_of(self.body)
        if not self.carried:
            yield self.body
            return
        with tempfile.TemporaryDirectory(prefix="flexproof-part-") as folder:
            here = Path(folder) / shape.file.name
            here.write_bytes(self.content)
            yield replace(self.body, shape=replace(shape, file=here))


def prepare_parts(context: Context, executor: Executor, *, carried: bool) -> None:
    """Compute what a run asks of the mechanism's parts: first what they are, then as solids.

    Raises what the executor raises where a process or the cluster is lost.
    """
    mechanism = context.robot_file.mechanism
    bodies = {
        part_key(*reduced_parts.found_in(body), reduced_parts.shape_of(body).material): body
        for body in mechanism.parts.values()
    }
    _finish([(body, _as_it_is) for body in bodies.values()], executor, carried=carried)
    asked = list(_reductions(robot_on_path(context), bodies.values()))
    _finish(asked, executor, carried=carried)


def _as_it_is(body: Body) -> list[CacheEntry[Any]]:
    stepped = [stepped_entry(body)] if reduced_parts.is_leg(body) else []
    return [reduced_parts.identified_entry(body), *stepped]


def _reduction(body: Body, **options: Any) -> list[CacheEntry[Any]]:
    return [reduced_parts.reduced_entry(body, **options)]


def _reductions(robot: RobotOnPath, bodies: Collection[Body]) -> Iterator[tuple[Body, Question]]:
    """The finest meshes first: they take longest."""
    alternatives = tuple(robot.holding.alternatives.values())
    first = alternatives[:1]
    highest, cutoff = highest_of_parts(robot.postures, robot.offered)
    ask = partial(_reduction, highest=highest, cutoff=cutoff)
    # Coarser meshes are those of the uncertainty, and the coarsest that of the other reduction: of
    # the first way of holding.
    for question, several in (
        (partial(ask, level=FINEST), alternatives),
        (partial(ask, level=MIDDLE), first),
        (partial(ask, level=COARSE), first),
        (partial(ask, level=COARSE, by="free"), first),
    ):
        for ends, body in product(several, bodies):
            yield body, partial(question, hold=hold_of(ends[body.name]))


def _entries(ask: Question, body: Body) -> Sequence[CacheEntry[Any]]:
    """Entries of a part; none if its file cannot be read or does not fit the robot."""
    try:
        return ask(body)
    except (InputError, ComputationError):
        return ()


def _finish(asked: Sequence[tuple[Body, Question]], executor: Executor, *, carried: bool) -> None:
    """Have computed what is not kept already, and keep it."""
    work = [
        PartWork(
            body, part_content(reduced_parts.shape_of(body).file) if carried else b"", ask, carried
        )
        for body, ask in asked
        if not all(entry.is_stored for entry in _entries(ask, body))
    ]
    if work:
        for _, entries in executor(work):
            for key, arrays in entries.items():
                if find(key) is None:
                    keep(key, arrays)
