"""Every fault of a robot file of schema 2 that shows without closing a loop."""

from collections.abc import Iterator, Mapping
from typing import Any

from lumped.mechanism.mechanism import GROUND
from lumped.robot_file.mechanism.draft import Draft, draft
from lumped.robot_file.rules.relations import body_faults, joint_faults, path_faults, tool_faults
from lumped.robot_file.rules.rule import Either, Named, Rule, Several, TableRule, Text
from lumped.robot_file.rules.tables import MECHANISM
from lumped.text import did_you_mean, shown


def description_faults(tables: Mapping[str, Any]) -> list[str]:
    """Faults of keys, of what they say together, and of names; without any, those of the whole."""
    given = draft(tables)
    faults = MECHANISM.faults_within(tables)
    for relations, entries in (
        (body_faults, given.bodies.values()),
        (joint_faults, given.joints.values()),
        (tool_faults, [given.tool] if given.tool else []),
        (path_faults, [given.path] if given.path else []),
    ):
        faults += [fault for entry in entries for fault in relations(entry)]
    faults += [*_unknown_names(given), *_not_held(given)]
    # Who is connected to whom is known once every joint says what it joins.
    return faults or [*_loose_bodies(given), *_idle_interfaces(given), *_idle_points(given)]


def _unknown_names(given: Draft) -> Iterator[str]:
    """Names of entries that no entry of the table has that they must be of."""
    entries_of = {"bodies": given.bodies, "joints": given.joints, "tool": given.tool or {}}
    for table, entries in entries_of.items():
        for key, name, among in _references(MECHANISM.keys[table].kind, entries, table):
            known = given.names[among] + ((GROUND,) if among == "bodies" else ())
            yield from _wrong_name(key, name, known, f"the name of one of [{among}]")


def _references(rule: Rule, value: Any, key: str) -> Iterator[tuple[str, str, str]]:
    """Key, name and table of each name of another entry in a value as it is read."""
    match rule, value:
        case Text(among=among), str() if among:
            yield key, value, among
        case Either(first=first, second=second), _:
            yield from _references(first, value, key)
            yield from _references(second, value, key)
        case Several(kind=kind), tuple():
            for i, one in enumerate(value, start=1):
                yield from _references(kind, one, f"{key}[{i}]")
        case Named(name=name, kind=kind), dict():
            for own, one in value.items():
                yield from _references(name, own, f"{key}.{own}")
                yield from _references(kind, one, f"{key}.{own}")
        case TableRule(keys=keys), dict():
            for own, one in keys.items():
                yield from _references(one.kind, value.get(own), f"{key}.{own}")


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
            yield f"bodies.{name}: no way of joints leads to ground; must be connected to it"


def _idle_interfaces(given: Draft) -> Iterator[str]:
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
            if name in joined and (name, point) not in used:
                yield (
                    f'bodies.{name}: nothing takes hold of it at "{point}"; must be joined there, '
                    "or hold the tool, or end elsewhere"
                )


def _idle_points(given: Draft) -> Iterator[str]:
    used = {
        name
        for table, entries in (("bodies", given.bodies), ("joints", given.joints))
        for _, name, _ in _references(MECHANISM.keys[table].kind, entries, table)
    }
    for point in given.points:
        if point not in used:
            yield f"points.{point}: used by no body and no joint; must be used or left out"
