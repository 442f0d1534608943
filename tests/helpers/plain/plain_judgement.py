"""The rules of the first screen once more, one number after the other, from the raw responses.

Written from the interface's words, with loops in place of arrays; of the product's code there is
the search for the worst direction of force alone:
errors of the whole displacement, partners by the largest likeness, an interval over what is left
open, the verdict, the pose that decides, what each cause takes off, and the remedy.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import hypot, inf, isinf, isnan, nan, sqrt
from typing import Any

import numpy as np

from validation.agreement.displacement import worst_force

AXES = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
Numbers = Mapping[str, Any]


@dataclass(frozen=True)
class Plain:
    """Error of a quantity at a pose: `low` to `high` over all that is open; None: not there.

    `alone`: what each alternative says of the order by itself.
    """

    low: float
    high: float
    missing: bool
    alone: tuple["Plain", ...] = ()

    @property
    def middle(self) -> float:
        return (self.low + self.high) / 2.0

    @property
    def half(self) -> float:
        return (self.high - self.low) / 2.0

    def verdict(self, limit: float) -> str:
        if self.missing:
            return "inadequate"
        if self.alone:
            said = {one.verdict(limit) for one in self.alone}
            return said.pop() if len(said) == 1 else "undecided"
        if self.high <= limit and self.low >= -limit:
            return "adequate"
        return "inadequate" if self.low > limit or self.high < -limit else "undecided"


def column(matrix: Any, load: Sequence[float], *, turning: bool) -> list[float]:
    """Displacement under a wrench, rotation under a moment."""
    rows = (3, 4, 5) if turning else (0, 1, 2)
    return [sum(float(matrix[i, j]) * load[j] for j in range(6)) for i in rows]


def length(vector: Sequence[float]) -> float:
    return hypot(*vector)


def unit(quantity: str) -> list[float]:
    return [1.0 if name == quantity else 0.0 for name in AXES]


def deflection(own: Any, due: Any, quantity: str, force: Sequence[float] | None) -> Numbers:
    """Whole error, the vector of it, and what is along the load, at one pose."""
    turning = quantity.startswith("phi")
    load = unit(quantity) if force is None else [*force, 0.0, 0.0, 0.0]
    moved, meant = (column(one, load, turning=turning) for one in (own, due))
    off = [a - b for a, b in zip(moved, meant, strict=True)]
    floor = 0.0
    if force is not None:
        floor = sqrt(max(np.linalg.eigvalsh(due[:3, :3].T @ due[:3, :3]))) / 20.0
    of = max(length(meant), floor)
    direction = load[3:] if turning else load[:3]
    value, expected = (float(np.dot(direction, u)) for u in (moved, meant))
    return {
        "error": length(off) / of,
        "off": [one / of for one in off],
        "length": of,
        "load": load,
        "turning": turning,
        "value": value,
        "expected": expected,
        "along": (value - expected) / max(expected, floor),
        "grown": 1.0 + length(off) / of if force is not None else length(moved) / of,
    }


def worst_of(own: Any, due: Any) -> Sequence[float]:
    """The force that is off most; test_displacement holds it against a search of the sphere."""
    blocks = (own - due)[None, :3, :3], due[None, :3, :3]
    return [float(one) for one in worst_force(*blocks).force[0]]


def partner(truth: Any, model: Any, mode: int, pose: int) -> int | None:
    """The model's mode whose shape has most, and at least half, in common with the truth's."""
    likeness = []
    for k in range(model.samples.shape[2]):
        a, b = truth.samples[pose, :, mode], model.samples[pose, :, k]
        likeness.append(float(a @ b) ** 2 / float(a @ a) / float(b @ b))
    best = int(np.argmax(likeness))
    return best if likeness[best] >= 0.5 else None


def frequency(truth: Any, model: Any, mode: int, pose: int) -> Numbers:
    found = partner(truth, model, mode, pose)
    own = nan if found is None else float(model.frequencies[pose, found])
    due = float(truth.frequencies[pose, mode])
    return {"error": own / due - 1.0, "value": own, "expected": due, "grown": own / due}


def order(truth: Any, model: Any, modes: int, pose: int) -> Numbers:
    """The mode that is elsewhere in the model and whose number misleads most."""
    worst = {"error": 0.0, "mode": None}
    for mode in range(modes):
        if partner(truth, model, mode, pose) != mode:
            own, due = (float(one.frequencies[pose, mode]) for one in (model, truth))
            if worst["mode"] is None or abs(own / due - 1.0) > abs(worst["error"]):
                worst = {"error": own / due - 1.0, "mode": mode, "grown": own / due}
    return worst


class Rule:
    """One quantity of one model of a subject, looked at pose by pose."""

    def __init__(self, subject: Any, candidate: Any, quantity: str, modes: int) -> None:
        self.quantity, self.modes = quantity, modes
        self.static = quantity in (*AXES, "any_force")
        self.reference = subject.statics if self.static else subject.dynamics
        self.poses = range(len(subject.poses))
        self.candidate = candidate

    def numbers(self, response: Any, place: int, pose: int) -> Numbers:
        truth = self.reference.alternatives[place].response
        if self.static:
            own, due = response.compliance[pose], truth.compliance[pose]
            worst = self.quantity == "any_force"
            return deflection(own, due, self.quantity, worst_of(own, due) if worst else None)
        if self.quantity == "order":
            return order(truth.vibration, response.vibration, self.modes, pose)
        return frequency(truth.vibration, response.vibration, int(self.quantity[1:]) - 1, pose)

    def stated(self, found: Numbers, place: int, pose: int) -> float:
        one = self.reference.alternatives[place]
        if self.static:
            return float(one.static[pose, (*AXES, "any_force").index(self.quantity)])
        mode = found["mode"] if self.quantity == "order" else int(self.quantity[1:]) - 1
        return 0.0 if mode is None else float(one.dynamic[pose, mode])

    def at(self, responses: Sequence[Any], pose: int) -> Plain:
        lows, highs, missing = [], [], False
        for place, response in enumerate(responses):
            found = self.numbers(response, place, pose)
            if isnan(found["error"]) or isinf(found["error"]):
                missing = True
                continue
            spread = self.stated(found, place, pose) * found.get("grown", 1.0)
            lows.append(found["error"] - spread)
            highs.append(found["error"] + spread)
        if self.quantity == "order" and not missing:
            alone = tuple(Plain(a, b, missing=False) for a, b in zip(lows, highs, strict=True))
            worst = max(alone, key=lambda one: abs(one.middle))
            return Plain(worst.low, worst.high, missing=False, alone=alone)
        low = min(lows, default=nan)
        return Plain(max(low, 0.0) if self.static else low, max(highs, default=nan), missing)

    def model(self) -> list[Any]:
        return [self.candidate.response] * len(self.reference.alternatives)

    def answer(self, limit: float) -> tuple[str, int, list[Plain]]:
        """Verdict, the pose that decides, and what is open at every pose."""
        found = [self.at(self.model(), pose) for pose in self.poses]
        verdicts = [one.verdict(limit) for one in found]
        worst = min(verdicts, key=("inadequate", "undecided", "adequate").index)
        size = [0.0 if one.missing else abs(one.middle) for one in found]
        alike = [p for p in self.poses if verdicts[p] == worst]
        known = [p for p in alike if not found[p].missing] or alike
        return worst, max(known, key=lambda p: size[p]), found

    def steps(self) -> list[Any]:
        ladder = self.candidate.static_steps if self.static else self.candidate.dynamic_steps
        names = [one.name for one in self.reference.alternatives]
        return [(step, [step.responses[name] for name in names]) for step in ladder]

    def causes(self, pose: int) -> dict[str, float]:
        """Shares by cause, with the rest that no cause accounts for."""
        places = range(len(self.reference.alternatives))
        first = [self.numbers(one, k, pose) for k, one in enumerate(self.model())]
        total = sum(one["error"] for one in first) / len(places)
        amounts: dict[str, float] = {}
        before = self.model()
        for step, after in self.steps():
            taken = 0.0
            for k in places:
                if self.static:
                    of = first[k]
                    change = before[k].compliance[pose] - after[k].compliance[pose]
                    moved = column(change, of["load"], turning=of["turning"])
                    along = sum(a * b for a, b in zip(moved, of["off"], strict=True))
                    taken += along / of["length"] / of["error"]
                else:
                    taken += (
                        self.numbers(before[k], k, pose)["error"]
                        - self.numbers(after[k], k, pose)["error"]
                    )
            if isnan(taken):
                break
            amounts[step.cause] = amounts.get(step.cause, 0.0) + taken / len(places)
            before = after
        amounts["rest"] = total - sum(amounts.values())
        return {name: one / total for name, one in amounts.items()}

    def remedy(self, limit: float, pose: int) -> tuple[str, float | None]:
        """The first step that is enough, else the best one; none that is no better than nothing."""
        start = self.at(self.model(), pose)
        before, words, tried = start, list[str](), []
        for step, responses in self.steps():
            after = [self.at(responses, p) for p in self.poses]
            lost = before.missing or after[pose].missing
            if step.remedy:
                if lost or abs(after[pose].middle - before.middle) >= 0.1 * limit:
                    words += [step.remedy] if step.remedy not in words else []
                if words and not any(one.missing for one in after):
                    worst = max((one.middle for one in after), key=abs)
                    tried.append((abs(worst), worst, ", ".join(words)))
                before = after[pose]
        enough = [one for one in tried if one[0] <= limit]
        if not tried:
            return "", None
        size, error, said = enough[0] if enough else min(tried)
        if size >= (inf if start.missing else abs(start.middle)):
            return "", None
        return said, error
