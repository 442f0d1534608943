"""What the sentence says of deflections that are off: by how much, over which range of the path.

The whole displacement is judged. Where it is off along its own force, a model is told to be too
stiff or too soft there, with the range over the poses; where that changes its sign on the way, from
where to where; where it is off across the force, that.
"""

from collections.abc import Collection, Sequence

from lumped.acceptance.requirement import ANY_FORCE, AXES
from validation.adequacy.matrix import Entry, Matrix
from validation.drawing.text import number
from validation.report.first_screen.table import pose_text
from validation.report.first_screen.words import amount, is_rotation, place_of, times

OFF = ("stiff", "soft", "changing", "across", "worst", "loose", "absent")
# Nothing at all where the reference yields: the model's number is zero up to rounding.
ABSENT = 1e-9
# Errors beyond this are told as factors.
_FACTOR = 0.5
# Beside a factor a smaller error is told as one, too, from here on.
_TOLD_AS_FACTOR = 1.5
# Below this part of the limit an error along the load has no sign worth telling.
_SIGNLESS = 0.1
# An error of which less is along the load is off across it.
_ALONG = 0.8
# The worst direction is told apart where it is so much worse than the worst axis.
_WORSE = 1.2
# Poses that show an extreme to this part of it, and how many are listed.
_AT_EXTREME, _LISTED = 0.01, 3


def kind_of_deflection(entry: Entry) -> str:
    """In which way an inadequate deflection is off: one of `OFF`."""
    if entry.error is None:
        return "loose"
    if entry.quantity == ANY_FORCE:
        return "worst"
    alongs = [along for _, along in _path([entry])]
    if all(along <= -1.0 + ABSENT for along in alongs):
        return "absent"
    if max(map(abs, alongs)) < _ALONG * entry.error:
        return "across"
    least, most = min(alongs), max(alongs)
    if least < -_SIGNLESS * entry.limit and most > _SIGNLESS * entry.limit:
        return "changing"
    return "stiff" if -least > most else "soft"


def said_of_deflections(
    matrix: Matrix, off: Sequence[Entry], known: Sequence[str], *, singular: bool
) -> list[str]:
    """Predicates of models of which the same is to be said.

    `off` are their inadequate entries, `known` the quantities in which they move at all.
    """
    verb = "is" if singular else "are"
    kinds = {kind: [entry for entry in off if kind_of_deflection(entry) == kind] for kind in OFF}
    said = [
        f"{verb} {how}"
        for kind in ("stiff", "soft")
        for how in _of_one_sign(kinds[kind], kind, known)
    ]
    said += _stuck(matrix, kinds["stiff"], singular=singular)
    for quantity in _quantities(kinds["changing"]):
        found = [entry for entry in kinds["changing"] if entry.quantity == quantity]
        said.append(f"{verb} {_from_to(matrix, found)} {place_of([quantity])}")
    for rotation in (False, True):
        across = [entry for entry in kinds["across"] if is_rotation(entry.quantity) == rotation]
        said += [f"{verb} {_across(across, rotation=rotation)}"] if across else []
    axes = [entry.error or 0.0 for entry in off if entry.quantity in AXES[:3]]
    worst = [entry.error or 0.0 for entry in kinds["worst"]]
    if worst and max(worst) > _WORSE * max(axes, default=0.0):
        said.append(f"{verb} {how_much(worst, whole=True)} off under the worst direction of force")
    if kinds["loose"]:
        move = "moves" if singular else "move"
        said.append(f"{move} {place_of(_quantities(kinds['loose']))} where the robot is rigid")
    return said + _absent(kinds["absent"], known, singular=singular)


def how_much(errors: Sequence[float], *, whole: bool = False) -> str:
    """The range of errors of one sign, in percent, large ones as factors; of whole ones never."""
    ordered = sorted(errors, key=abs)
    first, last = ordered[0], ordered[-1]
    if whole or not _is_factor(last):
        return amount(abs(first), abs(last))
    if _is_factor(first) or _factor(first) > _TOLD_AS_FACTOR:
        return times(_factor(first), _factor(last))
    return f"{amount(abs(first), abs(first))} to {times(_factor(last), _factor(last))}"


def _is_factor(error: float) -> bool:
    return error > 1.0 or -1.0 + ABSENT < error < -_FACTOR


def _factor(error: float) -> float:
    return 1.0 + error if error > 0.0 else 1.0 / (1.0 + error)


def _path(entries: Sequence[Entry]) -> list[tuple[int, float]]:
    """Signed errors along the load by the number of the pose; measured errors are nothing else."""
    return [
        (place, along)
        for entry in entries
        for place, along in enumerate(entry.alongs or entry.errors)
        if along is not None
    ]


def _of_one_sign(found: Sequence[Entry], kind: str, known: Sequence[str]) -> list[str]:
    """How much too stiff along z, say, and in rotation, the range being over the path."""
    how = f"too {kind}"
    moved = [entry for entry in found if not is_rotation(entry.quantity)]
    turned = [entry for entry in found if is_rotation(entry.quantity)]
    if not moved:
        return [f"{_range(turned, kind)} {how} in rotation"] if turned else []
    size = _range(moved, kind)
    of_turns = _range(turned, kind) if turned else size
    turns = f" ({of_turns} in rotation)" if of_turns != size else ""
    everywhere = set(_quantities(moved)) == {one for one in known if one in AXES[:3]}
    where = "" if everywhere else f" {place_of(_quantities(moved))}"
    return [f"{size} {how}{where}{turns}"]


def _range(found: Sequence[Entry], kind: str) -> str:
    """The range over the path of what is too stiff, or too soft; where all is rigid, left out."""
    sign = -1.0 if kind == "stiff" else 1.0
    sizes = [along for _, along in _path(found) if along > -1.0 + ABSENT]
    of_sign = [along for along in sizes if sign * along > _SIGNLESS * found[0].limit]
    return f"{'up to ' * (len(of_sign) < len(sizes))}{how_much(of_sign)}"


def _stuck(matrix: Matrix, stiff: Sequence[Entry], *, singular: bool) -> list[str]:
    """Where on the path models do not move at all that move elsewhere."""
    rigid = [entry for entry in stiff if any(a <= -1.0 + ABSENT for _, a in _path([entry]))]
    if not rigid:
        return []
    at = _poses(matrix, {place for place, along in _path(rigid) if along <= -1.0 + ABSENT})
    return [f"{'does' if singular else 'do'} not move {place_of(_quantities(rigid))} at {at}"]


def _from_to(matrix: Matrix, found: Sequence[Entry]) -> str:
    """From how much too stiff to how much too soft, each with its poses."""
    path = _path(found)
    ends = []
    for extreme, how in ((min(a for _, a in path), "stiff"), (max(a for _, a in path), "soft")):
        at = {place for place, a in path if abs(a - extreme) <= _AT_EXTREME * abs(extreme)}
        ends.append(f"{how_much([extreme])} too {how} ({_poses(matrix, at)})")
    return f"from {ends[0]} to {ends[1]}"


def _across(found: Sequence[Entry], *, rotation: bool) -> str:
    """How far the whole is off under forces along y, say, and how much of that lies along them."""
    quantities = _quantities(found)
    load = "moment" if rotation else "force"
    loads, it = (f"{load}s", "them") if len(quantities) > 1 else (f"a {load}", "it")
    alongs = [along for _, along in _path(found)]
    least, most, nothing = min(alongs), max(alongs), _SIGNLESS * found[0].limit
    too = []
    if least < -nothing:
        too.append(f"{how_much([least])} too stiff")
    if most > nothing:
        too.append(f"{how_much([most])} too soft")
    up_to = "up to " if too else ""
    own = f"{up_to}{' and '.join(too) or 'next to nothing'} {'about' if rotation else 'along'} {it}"
    whole = how_much([entry.error or 0.0 for entry in found], whole=True)
    return f"{whole} off under {loads} {place_of(quantities)} ({own})"


def _absent(found: Sequence[Entry], known: Sequence[str], *, singular: bool) -> list[str]:
    """What a model does not know at all; rotation without axes where it knows none."""
    moved = [entry.quantity for entry in found if not is_rotation(entry.quantity)]
    lacks = [f"motion {place_of(dict.fromkeys(moved))}"] if moved else []
    turned = dict.fromkeys(entry.quantity for entry in found if is_rotation(entry.quantity))
    if turned:
        about = f" {place_of(turned)}" if any(map(is_rotation, known)) else ""
        lacks.append(f"rotation{about}")
    if not lacks:
        return []
    lacking = f"neither {' nor '.join(lacks)}" if len(lacks) > 1 else f"no {lacks[0]}"
    return [f"{'knows' if singular else 'know'} {lacking}"]


def _quantities(entries: Sequence[Entry]) -> list[str]:
    return list(dict.fromkeys(entry.quantity for entry in entries))


def _poses(matrix: Matrix, places: Collection[int]) -> str:
    """Poses by their numbers along the path: "x = 0.145, 0.85 m", or how many there are."""
    if len(places) > _LISTED:
        return f"{len(places)} of {len(matrix.poses)} poses"
    poses = [matrix.poses[place] for place in sorted(places)]
    if len(matrix.coordinates) != 1:
        return "; ".join(pose_text(matrix, pose) for pose in poses)
    (coordinate,) = matrix.coordinates
    values = ", ".join(number(value, 4) for (value,) in poses)
    return f"{coordinate.name} = {values} {coordinate.unit}"
