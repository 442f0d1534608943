"""Independent implementation of the rules for verdicts, pose by pose, from the responses.

It shares no code with the program, except the search for the worst direction of force, which
test_displacement compares with a search of the sphere. It computes errors of the whole
displacement, partners of modes by the largest MAC, the interval over all uncertainties, the
verdict, the deciding pose, the share of each cause, and the remedy.
"""

from functools import cache
from itertools import combinations
from math import inf, isfinite, isnan, nan
from typing import NamedTuple

import numpy as np

from validation.responses.displacement import worst_force

AXES = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
# Sources of uncertainty.
SOURCES = ("meshes", "digits of the file")


class Plain(NamedTuple):
    """Error of a quantity at one pose, with its interval from `low` to `high`; or `missing`.

    `errors` and their half-widths `halves` belong to the interpretations of the reference; `error`
    is the largest one. `alone` contains the result for the order of modes under each
    interpretation.
    """

    low: float
    high: float
    missing: bool = False
    errors: tuple = ()
    halves: tuple = ()
    alone: tuple = ()

    @property
    def bound(self):
        return 0.0 if self.missing else max(abs(self.low), abs(self.high))

    @property
    def worst_index(self):
        return max(range(len(self.errors)), key=lambda k: abs(self.errors[k]))

    @property
    def error(self):
        return None if self.missing else self.errors[self.worst_index]

    def verdict(self, limit):
        if self.missing:
            return "inadequate"
        if self.alone:
            verdicts = {result.verdict(limit) for result in self.alone}
            return verdicts.pop() if len(verdicts) == 1 else "undecided"
        if self.high <= limit and self.low >= -limit:
            return "adequate"
        return "inadequate" if self.low > limit or self.high < -limit else "undecided"


@cache
def worst(*matrices):
    """Worst direction of force for `matrices` (difference, reference; bytes of 3×3)."""
    difference, due = (np.frombuffer(matrix).reshape(1, 3, 3) for matrix in matrices)
    return worst_force(difference, due).force[0]


def deflection(compliance, reference, quantity):
    """Error of the displacement at one pose: magnitude, vector, and component along the load."""
    part = slice(3, 6) if quantity.startswith("phi") else slice(3)
    load, floor = np.zeros(6), 0.0
    if quantity == "any_force":
        load[:3] = worst((compliance - reference)[:3, :3].tobytes(), reference[:3, :3].tobytes())
        floor = np.linalg.norm(reference[:3, :3], ord=2) / 20.0
    else:
        load[AXES.index(quantity)] = 1.0
    displacement, expected_displacement = compliance[part] @ load, reference[part] @ load
    size = max(np.linalg.norm(expected_displacement), floor)
    error = np.linalg.norm(displacement - expected_displacement) / size
    value, expected = load[part] @ displacement, load[part] @ expected_displacement
    return {
        "error": error,
        "off": (displacement - expected_displacement) / size,
        "length": size,
        "load": load,
        "part": part,
        "value": value,
        "along": (value - expected) / max(expected, floor),
        "grown": 1.0 + error if floor else np.linalg.norm(displacement) / size,
    }


def nearest(compliance, pair, result):
    """Smallest error of a model against all references between two readings.

    `compliance` is that of the model, `pair` has those of the reference under both readings. The
    load is that of `result`, which is returned by `deflection`.
    """
    part, load = result["part"], result["load"]
    displacement = compliance[part] @ load
    first, second = (due[part] @ load for due in pair)
    change = second - first
    share = min(max(float((displacement - first) @ change / (change @ change)), 0.0), 1.0)
    lengths = [np.linalg.norm(expected) for expected in (first, second)]
    if np.count_nonzero(load) > 1:
        floors = [np.linalg.norm(due[:3, :3], ord=2) / 20.0 for due in pair]
        lengths = [max(length_and_floor) for length_and_floor in zip(lengths, floors, strict=True)]
    distance = np.linalg.norm(displacement - first - share * change)
    return float(distance / (lengths[0] + share * (lengths[1] - lengths[0])))


def partner(truth, model, mode, pose):
    """Index of the model's mode with the largest MAC with a mode of the reference.

    None if that MAC is below one half.
    """
    a = truth.samples[pose, :, mode]
    likeness = [float(a @ b) ** 2 / float(a @ a) / float(b @ b) for b in model.samples[pose].T]
    best = int(np.argmax(likeness))
    return best if likeness[best] >= 0.5 else None


def frequency(truth, model, mode, pose):
    partner_mode = partner(truth, model, mode, pose)
    value = nan if partner_mode is None else float(model.frequencies[pose, partner_mode])
    due = float(truth.frequencies[pose, mode])
    return {"error": value / due - 1.0, "value": value, "mode": mode, "grown": value / due}


def order(truth, model, modes, pose):
    """Error of the mode order: largest frequency error of a mode with a wrong number."""
    worst = {"error": 0.0, "mode": None, "grown": 1.0, "value": None}
    for mode in range(modes):
        value = float(model.frequencies[pose, mode])
        ratio = value / float(truth.frequencies[pose, mode])
        further = worst["mode"] is None or abs(ratio - 1.0) > abs(worst["error"])
        if partner(truth, model, mode, pose) != mode and further:
            worst = {"error": ratio - 1.0, "mode": mode, "grown": ratio, "value": value}
    return worst


class Rule:
    """Verdict on one quantity of one model of a subject, pose by pose."""

    def __init__(self, subject, model, quantity, modes):
        self.quantity, self.modes, self.poses = quantity, modes, subject.poses
        self.static = quantity in (*AXES, "any_force")
        self.reference = subject.statics if self.static else subject.dynamics
        responses = subject.responses
        self.solve = responses.statics if self.static else responses.modes
        self.truths, self.model = self.halves(self.reference.model), self.halves(model)
        ladder = (subject.static_steps if self.static else subject.modal_steps)[model.name]
        self.steps = [(step, self.halves(step.model)) for step in ladder]

    def halves(self, model):
        """Statics or modes of a model, one for each interpretation of the reference."""
        return [
            self.solve(model, interpretation.reading)
            for interpretation in self.reference.interpretations
        ]

    def numbers(self, half, index, pose):
        truth = self.truths[index]
        if self.static:
            return deflection(half.compliances[pose], truth.compliances[pose], self.quantity)
        if self.quantity == "order":
            return order(truth, half, self.modes, pose)
        return frequency(truth, half, int(self.quantity[1:]) - 1, pose)

    def each(self, responses, pose):
        return [self.numbers(half, number, pose) for number, half in enumerate(responses)]

    def spread(self, result, index, pose, *kinds):
        """Half-width of the error in `result` by sources `kinds`, in interpretation `index`."""
        budget = self.reference.interpretations[index].budget
        column = (*AXES, "any_force").index(self.quantity) if self.static else result["mode"]
        if column is None:
            return 0.0
        half = "displacements" if self.static else "frequencies"
        widths = (getattr(budget[kind], half)[pose, column] for kind in kinds or SOURCES)
        return float(sum(widths) * result["grown"])

    def at_pose(self, responses, pose):
        alone, errors, halves = [], [], []
        for number, result in enumerate(self.each(responses, pose)):
            spread, error = self.spread(result, number, pose), result["error"]
            if isfinite(error):
                alone.append(Plain(error - spread, error + spread))
                errors.append(error)
                halves.append(spread)
        if len(alone) < len(responses):
            return Plain(nan, nan, missing=True)
        fields = {"errors": tuple(errors), "halves": tuple(halves)}
        if self.quantity == "order":
            worst = alone[max(range(len(alone)), key=lambda k: abs(errors[k]))]
            return Plain(worst.low, worst.high, alone=tuple(alone), **fields)
        low, high = min(plain.low for plain in alone), max(plain.high for plain in alone)
        if self.static and len(alone) > 1:
            low = min(low, self.between(responses, pose) - max(halves))
        return Plain(max(low, 0.0) if self.static else low, high, **fields)

    def between(self, responses, pose):
        """Smallest error against all references between two interpretations.

        For the quantity any_force, the worst force of each interpretation is tried, and the largest
        result is used.
        """
        references = [truth.compliances[pose] for truth in self.truths]
        return max(
            min(
                nearest(half.compliances[pose], pair, result)
                for pair in combinations(references, 2)
            )
            for half, result in zip(responses, self.each(responses, pose), strict=True)
        )

    def along(self, responses):
        return [self.at_pose(responses, pose) for pose in range(len(self.poses))]

    def entry(self, limit):
        """Fields of the entry at the deciding pose: worst verdict, then largest error."""
        path = self.along(self.model)
        verdicts = [plain_error.verdict(limit) for plain_error in path]
        worst = min(verdicts, key=("inadequate", "undecided", "adequate").index)
        worst_poses = [p for p, verdict in enumerate(verdicts) if verdict == worst]
        candidates = [p for p in worst_poses if not path[p].missing] or worst_poses
        pose = max(candidates, key=lambda p: path[p].bound)
        fields = {"verdict": worst, "pose": tuple(self.poses[pose])}
        if path[pose].missing:
            return fields
        alone, plain = self.each(self.model, pose), path[pose]
        k = plain.worst_index
        # The same alternative at every pose, of the order the worst.
        places = [
            plain_error.worst_index if self.quantity == "order" else k
            for plain_error in path
            if plain_error.errors
        ]
        kinds = SOURCES
        if self.quantity == "order" and not any(any(plain_error.halves) for plain_error in path):
            kinds = ("meshes",)
        half_widths = {kind: self.spread(alone[k], k, pose, kind) for kind in kinds}
        if self.quantity != "order" and self.reference.open:
            half_widths[self.reference.open] = 0.5 * (max(plain.errors) - min(plain.errors))
        fields |= {
            "error": plain.errors[k],
            "uncertainty": plain.halves[k],
            "uncertainties": half_widths,
        }
        fields |= {"low": plain.low, "high": plain.high, "readings": self.readings(plain)}
        fields |= self.series(path, iter(places))
        if self.static and self.quantity != "any_force":
            fields["along"] = alone[k]["along"]
        if self.static:
            fields["value"] = alone[k]["value"]
        if self.quantity not in ("any_force", "order"):
            fields["values"] = [
                self.numbers(self.model[0], 0, p)["value"] for p in range(len(path))
            ]
        advice = self.remedy(limit, pose) if worst == "inadequate" else ("", None)
        causes = {} if worst == "adequate" else self.causes(pose)
        return fields | {"causes": causes, "remedy": advice[0], "error_with_remedy": advice[1]}

    def readings(self, plain_error):
        """Errors by interpretation. Empty if there is only one or for the mode order."""
        names = [interpretation.name for interpretation in self.reference.interpretations]
        several = len(names) > 1 and self.quantity != "order"
        return dict(zip(names, plain_error.errors, strict=True)) if several else {}

    def series(self, path, places):
        """Errors and bounds over the poses. None at poses without an error."""
        rows = []
        for error in path:
            number = None if error.missing else next(places)
            exists = not error.missing
            rows.append((error.errors[number], error.low, error.high) if exists else [None] * 3)
        names = ("errors", "lows", "highs")
        return dict(zip(names, zip(*rows, strict=True), strict=True))

    def causes(self, pose):
        """Shares of the causes in the largest error, and the remainder without a cause."""
        k = self.at_pose(self.model, pose).worst_index
        result = self.each(self.model, pose)[k]
        total = result["error"]
        amounts, before = {}, self.model
        for step, after in self.steps:
            if self.static:
                change = (before[k] - after[k]).compliances[pose]
                along = (change[result["part"]] @ result["load"]) @ result["off"]
                change_of_error = along / result["length"] / result["error"]
            else:
                change_of_error = self.numbers(before[k], k, pose)["error"]
                change_of_error -= self.numbers(after[k], k, pose)["error"]
                if any(isnan(numbers["error"]) for numbers in self.each(after, pose)):
                    change_of_error = nan
            if isnan(change_of_error):
                break
            amounts[step.cause] = amounts.get(step.cause, 0.0) + change_of_error
            before = after
        amounts["rest"] = total - sum(amounts.values())
        return {name: amount / total for name, amount in amounts.items()}

    def remedy(self, limit, pose):
        """First step that meets the limit, else the model of the reference, else the best step.

        The model of the reference is the remedy only if the model stays inadequate with all steps.
        A step that does not reduce the error is no remedy.
        """
        start, before = self.at_pose(self.model, pose), self.along(self.model)
        words, tried = {}, []
        for step, responses in self.steps:
            after = self.along(responses)
            pairs = list(zip(before, after, strict=True))
            lost = any(first.missing or second.missing for first, second in pairs)
            if step.remedy:
                if lost or any(abs(b.error - a.error) >= 0.1 * limit for a, b in pairs):
                    words = {} if step.remedy.model else words
                    words[step.remedy.option or step.remedy.text] = step.remedy.text
                if words and not any(plain_error.missing for plain_error in after):
                    worst = max((plain_error.error for plain_error in after), key=abs)
                    beyond = any(
                        plain_error.verdict(limit) == "inadequate" for plain_error in after
                    )
                    tried.append((abs(worst), worst, ", ".join(words.values()), beyond))
                before = after
        enough = [attempt for attempt in tried if attempt[0] <= limit]
        if self.reference.remedy and not enough and all(attempt[3] for attempt in tried):
            return self.reference.remedy.text, 0.0
        size, error, text, _ = (enough or [min(tried, default=(inf, 0.0, "", True))])[0]
        better = size < (inf if start.missing else abs(start.error))
        return (text, error) if better else ("", None)
