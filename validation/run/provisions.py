"""Files and cache entries that the processes of a run need on other machines.

Input: a robot, and arrays from the cache of this machine. Output: `Provisions`, which
travel to each worker of a cluster once. Rule: files are compared by content. If a worker has
another file at the path, or none, it writes a copy.
"""

import tempfile
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from lumped.errors import InputError
from lumped.mechanism.body import Body, Part
from lumped.robot_file import RobotFile
from lumped.robot_file.included import part_content
from validation.run.cache import Arrays, find, keep


@dataclass(frozen=True)
class Provisions:
    """Contents of the files of CAD parts, and arrays of cache entries by key."""

    files: Mapping[Path, bytes]
    entries: Mapping[str, Arrays]

    def unpack(self, robot_file: RobotFile) -> RobotFile:
        """Store the entries in the cache of this machine. Copy part files that it lacks.

        Returns the robot with paths of part files on this machine.
        """
        for key, arrays in self.entries.items():
            if find(key) is None:
                keep(key, arrays)
        bodies = {name: self._local(body) for name, body in robot_file.mechanism.bodies.items()}
        if bodies == robot_file.mechanism.bodies:
            return robot_file
        return replace(robot_file, mechanism=replace(robot_file.mechanism, bodies=bodies))

    def _local(self, body: Body) -> Body:
        """The body, with a copy of its file if this machine lacks it or has a different one."""
        if not isinstance(body.shape, Part):
            return body
        file, content = body.shape.file, self.files[body.shape.file]
        with suppress(OSError, InputError):
            if part_content(file) == content:
                return body
        copy = Path(tempfile.mkdtemp(prefix="flexproof-part-")) / file.name
        copy.write_bytes(content)
        return replace(body, shape=replace(body.shape, file=copy))


def provisions(robot_file: RobotFile, entries: Mapping[str, Arrays] | None = None) -> Provisions:
    """Provisions of a robot: the files of all its parts, and the cache `entries`."""
    shapes = [body.shape for body in robot_file.mechanism.bodies.values()]
    files = {shape.file for shape in shapes if isinstance(shape, Part)}
    return Provisions({file: part_content(file) for file in files}, entries or {})
