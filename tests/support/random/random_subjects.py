"""Random subjects of an assessment: prescribed responses of models and references.

Modes are orthogonal shapes. A model has most of them, in another order and slightly rotated, and
lacks some. Sequences of steps lead from the model to the reference.
"""

import numpy as np
from support.fakes.toy_responses import model, model_by_reading, reading

from validation.references.reference import (
    Interpretation,
    Reference,
    Remedy,
    Source,
    SourceHalfWidths,
    Step,
    Subject,
)
from validation.references.responses import Responses
from validation.responses.statics_and_modes import PathModes, Statics
from validation.verdicts import Coordinate

POSES, MODES, SAMPLES = 3, 4, 12
WEIGHTS = np.full(SAMPLES, 1.0 / SAMPLES)
NO_LOADS = np.zeros((POSES, 0, 6))
UNITS = np.array([1e-4] * 3 + [1e-2] * 3)
REMEDIES = [
    (Remedy("take the beam"), None, Remedy("use the shell", model="shell")),
    (None, Remedy("a"), Remedy("b")),
    (Remedy("a: --p one", "--p"), Remedy("b"), Remedy("c: --p two", "--p")),
]


def statics(rng):
    """Statics with random compliances (6×6 per pose), fully coupled, of very unequal size."""
    root = rng.normal(size=(POSES, 6, 6)) + 2.0 * np.eye(6)
    softness = UNITS * 10.0 ** rng.uniform(-0.75, 0.75, 6)
    return Statics(root @ root.transpose(0, 2, 1) * np.outer(softness, softness), NO_LOADS)


def near(rng, statics, size):
    """Statics that differ from `statics` by about the relative amount `size`."""
    compliances = statics.compliances
    scale = np.sqrt(np.einsum("pii,pjj->pij", compliances, compliances))
    change = rng.normal(size=(POSES, 6, 6)) * scale
    return Statics(compliances + size * (change + change.transpose(0, 2, 1)), NO_LOADS)


def modes_near(rng, truth, size):
    """Modes of a model: some exchanged, all slightly rotated and shifted, at most one missing."""
    frequencies, samples = truth.frequencies.copy(), truth.samples.copy()
    for p in range(POSES):
        count = frequencies.shape[1]
        order = np.arange(count)
        if rng.random() < 0.5:
            first = rng.integers(count - 1)
            order[[first, first + 1]] = order[[first + 1, first]]
        # Numbers of the modes stay ascending, shapes go where their mode went.
        frequencies[p] = np.sort(truth.frequencies[p] * (1.0 + size * rng.uniform(-1, 1, count)))
        samples[p] = truth.samples[p][:, order]
        samples[p] += 0.1 * rng.normal(size=samples[p].shape) / np.sqrt(SAMPLES)
        if rng.random() < 0.2:
            samples[p, :, rng.integers(count)] = rng.normal(size=SAMPLES)
    return PathModes(frequencies, samples, WEIGHTS, np.ones_like(frequencies))


def subject(seed):
    """Subject of two models with two or three causes, and one or two interpretations."""
    rng = np.random.default_rng([24, seed])
    names = ("ends rigid", "ends free")[: int(rng.integers(1, 3))]
    basis = np.linalg.qr(rng.normal(size=(POSES, SAMPLES, SAMPLES)))[0][:, :, : MODES + 2]
    frequencies = 40.0 * np.cumprod(rng.uniform(1.3, 1.8, size=(POSES, MODES + 2)), axis=1)
    energy_shares = np.ones_like(frequencies)
    truth = statics(rng), PathModes(frequencies, basis, WEIGHTS, energy_shares)
    truths, interpretations = [], []
    for number, name in enumerate(names):
        responses = truth
        if number:
            factors = rng.uniform(0.99, 1.01, frequencies.shape)
            responses = (
                near(rng, truth[0], 0.01),
                PathModes(frequencies * factors, basis, WEIGHTS, energy_shares),
            )
        unsure = 0.02 * rng.random((POSES, 7)), 0.01 * rng.random(frequencies.shape)
        budget = {
            source: SourceHalfWidths(*(share * widths for widths in unsure))
            for source, share in ((Source.MESHES, 0.7), (Source.DIGITS, 0.3))
        }
        truths.append(responses)
        interpretations.append(Interpretation(name, reading(name), budget))

    def by_reading(title, halves):
        columns = (dict(zip(names, column, strict=True)) for column in zip(*halves, strict=True))
        return model_by_reading(title, *columns)

    def answer(size, *, still=False):
        modes = None if still else modes_near(rng, truth[1], size)
        return near(rng, truth[0], size), modes

    def ladder(start):
        steps = zip(
            ("shear", "warping", "shear"), (0.6, 0.2, 0.05), REMEDIES[rng.integers(3)], strict=True
        )
        return tuple(
            Step(
                cause,
                f"from {cause}",
                by_reading(cause, [answer(size * start) for _ in names]),
                remedy,
            )
            for cause, size, remedy in steps
        )

    models, static_steps, modal_steps = [], {}, {}
    for name, silent in (("segments", ""), ("beam", ""), ("vjm", "static")):
        size = 10.0 ** rng.uniform(-2.5, -0.5)
        static_steps[name] = ladder(size)
        modal_steps[name] = () if silent else ladder(size)
        models.append(model(name, *answer(size, still=bool(silent)), undefined_reason=silent))
    open_data = "ends" if len(names) > 1 else ""
    decides = "say how ends are held" if open_data else ""
    remedy = Remedy("use the solid", model="solid") if seed % 2 else None
    reference = by_reading("solid", truths), interpretations, open_data, decides
    return Subject(
        robot="random",
        coordinates=(Coordinate("x", "m"), Coordinate("phi_z", "rad")),
        poses=rng.uniform(-1.0, 1.0, size=(POSES, 2)),
        responses=Responses(None),
        models=models,
        statics=Reference("solids", *reference),
        dynamics=Reference("solid modes", *reference, remedy=remedy),
        static_steps=static_steps,
        modal_steps=modal_steps,
    )
