"""Robot files of valid random biglides, equal for equal seeds.

Some are extreme, others ordinary. Values are drawn from lists, or as powers of ten between a
lowest and a highest value.
"""

import random
from types import SimpleNamespace

# Two centimetres to eighty metres, foam to diamond, paper to blocks.
EXTREME = SimpleNamespace(
    materials=(
        "E = 2.1e11, nu = 0.3, rho = 7850.0",
        "E = 1.0e6, nu = 0.49, rho = 1100.0",
        "E = 2.0e12, nu = 0.07, rho = 3500.0",
        "E = 2.1e11, nu = -0.9, rho = 7850.0",
        "E = 2.1e11, nu = 0.4999999, rho = 7850.0",
        "E = 2.1e11, nu = -0.999999999, rho = 7850.0",
        "E = 7.0e10, nu = 0.0, rho = 25.0",
        "E = 1.2e11, nu = 0.3, rho = 22500.0, G = 3.0e5",
        "E = 1.0e6, nu = 0.3, rho = 25000.0, G = 1.0e12",
    ),
    length=(-1.7, 1.7),
    # Leg 2 over leg 1.
    lengths=(1.0, 0.55, 1.7, 0.999999),
    # From nearly no stroke to legs that nearly align.
    stroke=(0.02, 0.1, 0.5, 0.9, 0.999),
    # Of the length, of that, and of half of the smaller one.
    size=(-3.0, -0.01),
    side=(-1.5, 0.0),
    wall=(-2.0, 0.0),
    # m/N of a 6×6 of a leg of one metre, how much stiffer along it, and how fully it couples.
    deflection=(-10.0, -5.0),
    along=(-4.0, 0.0),
    coupling=(0.01, 1.0, 1.15),
    leg_mass=(-3.0, 4.0),
    platform_mass=(-6.0, 5.0),
    stiffness=(4.0, 15.0),
)
MILD = SimpleNamespace(
    materials=(
        "E = 2.1e11, nu = 0.3, rho = 7850.0",
        "E = 7.0e10, nu = 0.33, rho = 2700.0",
        "E = 3.0e9, nu = 0.4, rho = 1100.0, G = 8.0e8",
    ),
    length=(-0.5, 0.3),
    lengths=(1.0, 0.6, 1.6),
    stroke=(0.15, 0.5, 0.85),
    size=(-1.2, -0.6),
    side=(-0.4, 0.0),
    wall=(-1.0, -0.4),
    deflection=(-8.0, -6.3),
    along=(-2.0, -1.0),
    coupling=(0.01, 0.5, 1.0),
    leg_mass=(0.7, 2.0),
    platform_mass=(0.7, 2.0),
    stiffness=(7.0, 9.5),
)


def _section(rng, length, spread):
    size = length * 10.0 ** rng.uniform(*spread.size)
    other = size * 10.0 ** rng.uniform(*spread.side)
    wall = 0.49 * other * 10.0 ** rng.uniform(*spread.wall)
    small = 1.001e-6
    width, height = max(size, 10.0 * small), max(other, 10.0 * small)
    wall = max(min(wall, 0.49 * height), small)
    sides = f"width = {width!r}, height = {height!r}"
    return rng.choice(
        (
            f'shape = "rectangle", {sides}',
            f'shape = "hollow-rectangle", {sides}, thickness = {wall!r}',
            f'shape = "circle", diameter = {width!r}',
            f'shape = "tube", diameter = {height!r}, thickness = {wall!r}',
            f'shape = "i-section", {sides}, flange = {wall!r}, web = {wall!r}',
        )
    )


def _leg(rng, length, spread):
    if rng.random() < 0.25:
        # A beam's own 6×6 of any softness, hardly or fully coupled.
        deflection = 10.0 ** rng.uniform(*spread.deflection) * length**2
        rotation = 3.0 * deflection / length**2
        along = max(deflection * 10.0 ** rng.uniform(*spread.along), 2e-15)
        coupling = 0.5 * length * rotation * rng.choice(spread.coupling)
        rows = [[0.0] * 6 for _ in range(6)]
        for i, value in enumerate((along, deflection, deflection, rotation, rotation, rotation)):
            rows[i][i] = value
        rows[1][5] = rows[5][1] = coupling
        rows[2][4] = rows[4][2] = -coupling
        return f"mass = {10.0 ** rng.uniform(*spread.leg_mass)!r}\ncompliance = {rows!r}\n"
    section, material = _section(rng, length, spread), rng.choice(spread.materials)
    return f"section = {{ {section} }}\nmaterial = {{ {material} }}\n"


def random_robots(count, seed, spread=EXTREME):
    """Texts of `count` robot files."""
    rng = random.Random(seed)  # noqa: S311  any choice will do
    for number in range(count):
        first = 10.0 ** rng.uniform(*spread.length)
        second = first * rng.choice(spread.lengths)
        shortest, longest = abs(first - second), first + second
        share = rng.choice(spread.stroke)
        a = shortest + share * (min(longest, 100.0) - shortest)
        yield (
            f'schema = 1\nname = "robot {number}"\ntype = "biglide"\n'
            f"geometry = {{ a = {a!r} }}\n"
            f"platform = {{ mass = {10.0 ** rng.uniform(*spread.platform_mass)!r} }}\n"
            f"actuators = {{ stiffness = {10.0 ** rng.uniform(*spread.stiffness)!r} }}\n\n"
            f"[leg1]\nlength = {first!r}\n{_leg(rng, first, spread)}\n"
            f"[leg2]\nlength = {second!r}\n{_leg(rng, second, spread)}"
        )
