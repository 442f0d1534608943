"""Subjects of an assessment at random: what models and references answer, with nothing computed.

Modes are orthogonal shapes of which a model has most, in another order and a little turned, and
lacks one or the other; ladders of causes lead from the model to the reference.
"""

import numpy as np

from lumped.arrays import Array
from validation.adequacy.matrix import Coordinate
from validation.adequacy.response import (
    Alternative,
    Candidate,
    Reference,
    Response,
    Step,
    Subject,
    Vibration,
)

POSES, MODES, SAMPLES = 3, 4, 12
UNITS = np.array([1e-4] * 3 + [1e-2] * 3)


def compliance(rng: np.random.Generator) -> Array:
    """Of a robot: m/N, rad/N, rad/(N m), all coupled, axes up to a thousand times apart; p×6×6."""
    root = rng.normal(size=(POSES, 6, 6)) + 2.0 * np.eye(6)
    softness = UNITS * 10.0 ** rng.uniform(-0.75, 0.75, 6)
    return np.asarray(root @ root.transpose(0, 2, 1) * np.outer(softness, softness))


def near(rng: np.random.Generator, own: Array, size: float) -> Array:
    """Another one, about so far off."""
    change = rng.normal(size=(POSES, 6, 6)) * np.sqrt(np.einsum("pii,pjj->pij", own, own))
    return np.asarray(own + size * (change + change.transpose(0, 2, 1)))


def shapes(rng: np.random.Generator) -> Array:
    """Orthonormal columns, p×SAMPLES×SAMPLES."""
    return np.asarray(np.linalg.qr(rng.normal(size=(POSES, SAMPLES, SAMPLES)))[0])


def vibration(rng: np.random.Generator, truth: Vibration, size: float) -> Vibration:
    """A model's: some modes exchanged, all a little turned and off, one or none lacking."""
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
    return Vibration(frequencies, samples)


def subject(seed: int) -> Subject:
    """One reference of one or two alternatives, two models with two or three causes each."""
    rng = np.random.default_rng([24, seed])
    names = ("ends rigid", "ends free")[: int(rng.integers(1, 3))]
    basis = shapes(rng)[:, :, : MODES + 2]
    steps = np.cumprod(rng.uniform(1.3, 1.8, size=(POSES, MODES + 2)), axis=1)
    truth = Response(compliance(rng), Vibration(40.0 * steps, basis))
    alternatives = []
    for number, name in enumerate(names):
        own = truth
        if number:
            assert truth.compliance is not None
            own = Response(
                near(rng, truth.compliance, 0.01),
                Vibration(40.0 * steps * rng.uniform(0.99, 1.01, steps.shape), basis),
            )
        unsure = (0.02 * rng.random((POSES, 7)), 0.01 * rng.random(steps.shape))
        alternatives.append(Alternative(name, own, *unsure))

    def answer(size: float, *, still: bool = False) -> Response:
        assert truth.compliance is not None
        assert truth.vibration is not None
        modes = None if still else vibration(rng, truth.vibration, size)
        return Response(near(rng, truth.compliance, size), modes)

    def ladder(start: float) -> tuple[Step, ...]:
        sizes = start * np.array([0.6, 0.2, 0.05])
        remedies = [
            ("take the beam", "", "use the shell"),
            ("", "a", "b"),
            ("a: --p one", "b", "c: --p two"),
        ]
        words = remedies[int(rng.integers(3))]
        return tuple(
            Step(cause, f"from {cause}", {name: answer(size) for name in names}, word)
            for cause, size, word in zip(("shear", "warping", "shear"), sizes, words, strict=True)
        )

    off = [10.0 ** rng.uniform(-2.5, -0.5) for _ in range(3)]
    candidates = [
        Candidate("segments", "segments", answer(off[0]), ladder(off[0]), ladder(off[0])),
        Candidate("beam", "beams", answer(off[1]), ladder(off[1]), ladder(off[1])),
        Candidate("vjm", "joints", answer(off[2], still=True), ladder(off[2]), silent="static"),
    ]
    what = "ends" if len(names) > 1 else ""
    decides = "say how ends are held" if what else ""
    remedy = "use the solid" if seed % 2 else ""
    return Subject(
        robot="random",
        coordinates=(Coordinate("x", "m"), Coordinate("phi_z", "rad")),
        poses=rng.uniform(-1.0, 1.0, size=(POSES, 2)),
        weights=np.full(SAMPLES, 1.0 / SAMPLES),
        candidates=candidates,
        statics=Reference("solids", alternatives, what, decides),
        dynamics=Reference("solid modes", alternatives, what, decides, remedy=remedy),
    )
