"""The responses that a robot file asks for, table [[responses]], and what damps them."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from lumped.mechanism.load import Excitation
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file.rules.relations import NO_DIRECTION, named_twice


def excitations_of(read: Sequence[Mapping[str, Any]]) -> tuple[Excitation, ...]:
    """The excitations that tables without faults describe."""
    return tuple(
        Excitation(
            one["name"],
            np.array(one["direction"]) / np.linalg.norm(one["direction"]),
            *(one[key] for key in ("from", "to", "count", "at")),
        )
        for one in read
    )


def response_faults(read: Sequence[Mapping[str, Any]], robot: Mechanism) -> Iterator[str]:
    """What is wrong with responses of a robot whose keys are sound, one line each."""
    for fault in named_twice([one["name"] for one in read], "responses[{}].name"):
        yield f"{fault}; must be named once"
    for number, one in enumerate(read, start=1):
        key = f"responses[{number}]"
        if np.linalg.norm(one["direction"]) < NO_DIRECTION:
            yield f"{key}.direction = {list(one['direction'])}: must not be zero"
        if one["to"] <= one["from"]:
            yield f"{key}.to = {one['to']!r}: must be above {key}.from, {one['from']!r} Hz"
        elif one["at"] is not None and not one["from"] <= one["at"] <= one["to"]:
            yield f"{key}.at = {one['at']!r}: must be between {key}.from and {key}.to"
    if read and not robot.loses_energy:
        yield (
            "responses: nothing damps them, their peaks have no bound; must have [damping] ratio, "
            "or loss of a material, a joint or a drive"
        )
