"""What only closing the loops shows: drives that do not hold the tool, poses out of reach."""

from collections.abc import Iterator

import numpy as np

from lumped.errors import InputError
from lumped.mechanism.kinematics.mobility import (
    Mobility,
    mobility,
    mobility_nearby,
    undetermined,
)
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.mechanism import Mechanism

# Poses of a path that are tried before anything is computed; the others are when they come up.
_TRIED = 32


def motion_faults(mechanism: Mechanism) -> list[str]:
    """Faults of the mobility in the reference posture, else of the poses of the path."""
    found = mobility(reference_posture(mechanism))
    return list(_mobility_faults(mechanism, found)) or list(_path_faults(mechanism))


def _mobility_faults(mechanism: Mechanism, found: Mobility) -> Iterator[str]:
    moves = f"tool.moves = {list(mechanism.tool.moves)}"
    left = undetermined(found, mechanism.size, singular=True)
    if len(found.loose):
        yield f"joints: {left}"
    if found.at_limit and not mobility_nearby(mechanism).at_limit:
        yield (
            f"points: the reference posture is singular, drives {', '.join(found.stirring)} move "
            f"while the tool cannot move along {', '.join(found.barred)}; must be a posture inside "
            "the workspace"
        )
        return
    if found.barred:
        allowed = (
            f"{found.almost_redundant} constraints almost repeat others; are parallel axes given "
            "with all their digits?"
            if found.almost_redundant
            else "must name motions that they allow, each by itself"
        )
        yield (
            f"{moves}: the joints do not let the tool move along {', '.join(found.barred)}; "
            f"{allowed}"
        )
    if left and not len(found.loose):
        yield f"{moves}: {left}"


def _path_faults(mechanism: Mechanism) -> Iterator[str]:
    count = len(mechanism.poses)
    for i in np.unique(np.linspace(0, count - 1, min(count, _TRIED)).round().astype(int)):
        try:
            posture(mechanism, mechanism.poses[i])
        except InputError as error:
            said = (fault.removeprefix(f"{mechanism.name}, pose ") for fault in error.faults)
            yield from (f"path, pose {i + 1}, {fault}" for fault in said)
