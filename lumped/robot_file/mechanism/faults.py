"""Every fault of a robot file of schema 2: those of what is said, then those of how it moves.

Only closing the loops shows drives that do not hold the tool and poses out of reach.
"""

from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np

from lumped.errors import InputError
from lumped.mechanism.kinematics.mobility import (
    Mobility,
    generic_mobility,
    indeterminacy,
    mobility,
)
from lumped.mechanism.kinematics.postures import PoseError, posture, reference_posture
from lumped.mechanism.mechanism import GROUND, Mechanism
from lumped.robot_file.mechanism.draft import Draft
from lumped.robot_file.rules.relations import body_faults, joint_faults, path_faults, tool_faults
from lumped.robot_file.rules.rule import Text
from lumped.robot_file.rules.tables import MECHANISM, rules_of
from lumped.text import counted, did_you_mean, shown

# Poses of a path that are tried before anything is computed; the others are when they come up.
_TRIED = 32


def description_faults(tables: Mapping[str, Any], given: Draft) -> list[str]:
    """Faults of keys, of what they say together, and of names; without any, those of the whole.

    `given` is the draft of the tables.
    """
    faults = rules_of(tables).faults_within(tables)
    for relations, entries in (
        (body_faults, given.bodies.values()),
        (joint_faults, given.joints.values()),
        (tool_faults, [given.tool] if given.tool else []),
        (path_faults, [given.path] if given.path else []),
    ):
        faults += [fault for entry in entries for fault in relations(entry)]
    faults += [*_unknown_names(given), *_not_held(given)]
    if faults:
        return faults
    # Who is connected to whom is known once every joint says what it joins.
    loaded = {one.get("at") for one in tables.get("loads", ())}
    return [*_loose_bodies(given), *_idle_interfaces(given, loaded), *_idle_points(given, loaded)]


def _unknown_names(given: Draft) -> Iterator[str]:
    """Names of entries that no entry of the table has that they must be of."""
    entries_of = {"bodies": given.bodies, "joints": given.joints, "tool": given.tool or {}}
    for table, entries in entries_of.items():
        for key, name, among in _references(table, entries):
            known = given.names[among] + ((GROUND,) if among == "bodies" else ())
            yield from _wrong_name(key, name, known, f"the name of one of [{among}]")


def _references(table: str, entries: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Key, name and table of each name of another entry in the entries of a table."""
    for key, rule, value in MECHANISM.keys[table].kind.within(entries, table):
        if isinstance(rule, Text) and rule.among:
            yield key, value, rule.among


def _wrong_name(key: str, name: str, known: tuple[str, ...], allowed: str) -> Iterator[str]:
    """The fault of a name that is not among the known ones, with the closest that is."""
    if name not in known:
        advice = did_you_mean(name, known, otherwise=f": {', '.join(known) or 'none'}")
        yield f"{key} = {shown(name)}: must be {allowed}{advice}"


def _not_held(given: Draft) -> Iterator[str]:
    """Points of joints and the tool that their bodies do not have."""
    held_at = [
        (f"{joint['key']}.at" + (f"[{i}]" if joint["at"] == joint["points"] else ""), body, point)
        for joint in given.joints.values()
        if not joint["one_twice"]
        for i, (body, point) in enumerate(zip(joint["between"], joint["points"], strict=True), 1)
    ]
    if given.tool is not None:
        held_at.append(("tool.point", given.tool["body"], given.tool["point"]))
    for key, body, point in held_at:
        held = given.bodies[body]["held"] if body in given.bodies and body != GROUND else None
        if held is not None and point in given.names["points"]:
            yield from _wrong_name(key, point, held, f"a point of {body}")


def _loose_bodies(given: Draft) -> Iterator[str]:
    """Bodies from which no way of joints leads to ground."""
    pairs = [joint["between"] for joint in given.joints.values()]
    reached: set[str] = set()
    new = {GROUND}
    while new:
        reached |= new
        new = {body for pair in pairs if reached & set(pair) for body in pair} - reached
    for name in given.bodies:
        if name not in reached:
            yield f"bodies.{name}: no chain of joints leads to ground; must be connected to it"


def _idle_interfaces(given: Draft, loaded: Collection[str | None]) -> Iterator[str]:
    used = {
        held
        for joint in given.joints.values()
        for held in zip(joint["between"], joint["points"], strict=True)
    }
    if given.tool is not None:
        used.add((given.tool["body"], given.tool["point"]))
    joined = {body for body, _ in used}
    for name, body in given.bodies.items():
        for point in body["held"] or ():
            if name in joined and (name, point) not in used and point not in loaded:
                yield (
                    f'bodies.{name}: no joint holds it at "{point}"; must be joined there, '
                    "or hold the tool, or end elsewhere"
                )


def _idle_points(given: Draft, loaded: Collection[str | None]) -> Iterator[str]:
    used = {
        name
        for table, entries in (("bodies", given.bodies), ("joints", given.joints))
        for _, name, _ in _references(table, entries)
    }
    for point in given.points:
        if point not in used and point not in loaded:
            yield f"points.{point}: used by no body and no joint; must be used or left out"


def motion_faults(mechanism: Mechanism) -> list[str]:
    """Faults of the mobility in the reference posture, else of the poses of the path."""
    found = mobility(reference_posture(mechanism))
    return list(_mobility_faults(mechanism, found)) or list(_path_faults(mechanism))


def _mobility_faults(mechanism: Mechanism, found: Mobility) -> Iterator[str]:
    moves = f"tool.moves = {list(mechanism.tool.moves)}"
    left = indeterminacy(found, mechanism.size, singular=True)
    if len(found.uncontrolled_twists):
        yield f"joints: {left}"
    if found.at_limit and not generic_mobility(mechanism).at_limit:
        yield (
            f"points: the reference posture is singular, drives {', '.join(found.stirring)} move "
            f"while the tool cannot move along {', '.join(found.barred)}; must be a posture inside "
            "the workspace"
        )
        return
    if found.barred:
        allowed = (
            f"{counted(found.almost_redundant, 'constraint repeats', 'constraints repeat')} others "
            "almost; are parallel axes given with all their digits?"
            if found.almost_redundant
            else "must name motions that they allow, each by itself"
        )
        yield (
            f"{moves}: the joints do not let the tool move along {', '.join(found.barred)}; "
            f"{allowed}"
        )
    if left and not len(found.uncontrolled_twists):
        yield f"{moves}: {left}"


def _path_faults(mechanism: Mechanism) -> Iterator[str]:
    count = len(mechanism.poses)
    tried = np.unique(np.linspace(0, count - 1, min(count, _TRIED)).round().astype(int))
    faults: dict[int, list[str]] = {}
    for i in tried:
        try:
            posture(mechanism, mechanism.poses[i])
        except PoseError as error:
            faults[i] = [f"path, pose {i + 1}, {error.pose}: {error.reason}"]
        except InputError as error:
            faults[i] = [f"path, pose {i + 1}, {fault}" for fault in error.faults]
    # Of a grid what is out of reach is left out, as long as something is not.
    if len(faults) == len(tried) or not mechanism.grid:
        yield from (fault for own in faults.values() for fault in own)
