"""Robots that are sound and far from what is usual, always the same for one seed."""

import random
from collections.abc import Iterator

MATERIALS = (
    "E = 2.1e11, nu = 0.3, rho = 7850.0",
    "E = 1.0e6, nu = 0.49, rho = 1100.0",
    "E = 2.0e12, nu = 0.07, rho = 3500.0",
    "E = 2.1e11, nu = -0.9, rho = 7850.0",
    "E = 2.1e11, nu = 0.4999999, rho = 7850.0",
    "E = 2.1e11, nu = -0.999999999, rho = 7850.0",
    "E = 7.0e10, nu = 0.0, rho = 25.0",
    "E = 1.2e11, nu = 0.3, rho = 22500.0, G = 3.0e5",
    "E = 1.0e6, nu = 0.3, rho = 25000.0, G = 1.0e12",
)


def _section(rng: random.Random, length: float) -> str:
    """A section from a tenth of a hundredth of the leg's length to nearly all of it."""
    size = length * 10.0 ** rng.uniform(-3.0, -0.01)
    other = size * 10.0 ** rng.uniform(-1.5, 0.0)
    wall = 0.49 * other * 10.0 ** rng.uniform(-2.0, 0.0)
    small = 1.001e-6
    width, height = max(size, 10.0 * small), max(other, 10.0 * small)
    wall = max(min(wall, 0.49 * height), small)
    return rng.choice(
        (
            f'shape = "rectangle", width = {width!r}, height = {height!r}',
            f'shape = "hollow-rectangle", width = {width!r}, height = {height!r}, '
            f"thickness = {wall!r}",
            f'shape = "circle", diameter = {width!r}',
            f'shape = "tube", diameter = {height!r}, thickness = {wall!r}',
            f'shape = "i-section", width = {width!r}, height = {height!r}, flange = {wall!r}, '
            f"web = {wall!r}",
        )
    )


def _leg(rng: random.Random, length: float) -> str:
    if rng.random() < 0.25:
        # A beam's own 6×6 of any softness, hardly or fully coupled.
        deflection = 10.0 ** rng.uniform(-10.0, -5.0) * length**2
        rotation = 3.0 * deflection / length**2
        along = max(deflection * 10.0 ** rng.uniform(-4.0, 0.0), 2e-15)
        coupling = 0.5 * length * rotation * rng.choice((0.01, 1.0, 1.15))
        rows = [[0.0] * 6 for _ in range(6)]
        for i, value in enumerate((along, deflection, deflection, rotation, rotation, rotation)):
            rows[i][i] = value
        rows[1][5] = rows[5][1] = coupling
        rows[2][4] = rows[4][2] = -coupling
        return f"mass = {10.0 ** rng.uniform(-3.0, 4.0)!r}\ncompliance = {rows!r}\n"
    return f"section = {{ {_section(rng, length)} }}\nmaterial = {{ {rng.choice(MATERIALS)} }}\n"


def extreme_robots(count: int, seed: int) -> Iterator[str]:
    """`count` robot files: two centimetres to eighty metres, foam to diamond, paper to blocks."""
    rng = random.Random(seed)  # noqa: S311  any choice will do
    for number in range(count):
        first = 10.0 ** rng.uniform(-1.7, 1.7)
        second = first * rng.choice((1.0, 0.55, 1.7, 0.999999))
        shortest, longest = abs(first - second), first + second
        # From nearly no stroke to legs that nearly align.
        share = rng.choice((0.02, 0.1, 0.5, 0.9, 0.999))
        a = shortest + share * (min(longest, 100.0) - shortest)
        yield (
            f'schema = 1\nname = "extreme {number}"\ntype = "biglide"\n'
            f"geometry = {{ a = {a!r} }}\n"
            f"platform = {{ mass = {10.0 ** rng.uniform(-6.0, 5.0)!r} }}\n"
            f"actuators = {{ stiffness = {10.0 ** rng.uniform(4.0, 15.0)!r} }}\n\n"
            f"[leg1]\nlength = {first!r}\n{_leg(rng, first)}\n"
            f"[leg2]\nlength = {second!r}\n{_leg(rng, second)}"
        )
