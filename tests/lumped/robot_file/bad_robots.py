"""Robot files that are wrong, as many as are asked for, always the same for one seed.

Each is a sound file with one thing done to it that leaves no robot: what slips while one types,
what other programs write, and what someone writes who wants to break the reader.
"""

import random
from collections.abc import Callable, Iterator

SOUND = """\
schema = 1
name = "test robot"
type = "biglide"

[geometry]
a = 0.9
tool_offset = [0.0, 0.0, 0.1]

[platform]
mass = 46.0

[actuators]
stiffness = 1.0e9

[foot]
compliance = [
    [1.0e-10, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 6.0e-9, 0.0, 0.0, 0.0, 4.0e-8],
    [0.0, 0.0, 5.0e-10, 0.0, -4.0e-9, 0.0],
    [0.0, 0.0, 0.0, 7.0e-8, 0.0, 0.0],
    [0.0, 0.0, -4.0e-9, 0.0, 8.0e-8, 0.0],
    [0.0, 4.0e-8, 0.0, 0.0, 0.0, 3.0e-7],
]

[leg1]
length = 0.85
section = { shape = "hollow-rectangle", width = 0.10, height = 0.16, thickness = 0.008 }
material = { E = 2.1e11, nu = 0.3, rho = 7850.0 }

[leg2]
length = 0.8
mass = 49.0
compliance = [
    [3.0e-10, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 2.0e-8, 0.0, 0.0, 0.0, 3.0e-8],
    [0.0, 0.0, 3.0e-8, 0.0, -5.0e-8, 0.0],
    [0.0, 0.0, 0.0, 2.5e-7, 0.0, 0.0],
    [0.0, 0.0, -5.0e-8, 0.0, 1.5e-7, 0.0],
    [0.0, 3.0e-8, 0.0, 0.0, 0.0, 1.0e-7],
]
"""

# Numbers of the file that have bounds on both sides, as they stand there.
_BOUNDED = (
    *("a = 0.9", "mass = 46.0", "stiffness = 1.0e9", "length = 0.85", "length = 0.8\n"),
    *("mass = 49.0", "E = 2.1e11", "rho = 7850.0", "nu = 0.3", "width = 0.10", "thickness = 0.008"),
)
_OUT_OF_BOUNDS = ("-1", "0", "-0.0", "1e300", "1e-300", "5e-324", "-1e-9", "1e17", "nan", "inf")
_NO_NUMBER = ('"0.9"', "true", "[]", "{}", "[[]]", "1979-05-27", '""', "{ a = 1 }", "[1, 2]")
_REQUIRED = (
    *("schema = 1\n", 'name = "test robot"\n', 'type = "biglide"\n', "a = 0.9\n", "mass = 46.0\n"),
    *("stiffness = 1.0e9\n", "length = 0.85\n", "mass = 49.0\n", 'shape = "hollow-rectangle", '),
    *("E = 2.1e11, ", "nu = 0.3, ", ", rho = 7850.0", "[leg2]\n", "[geometry]\n"),
)
_DIAGONAL = ("1.0e-10", "6.0e-9", "5.0e-10", "7.0e-8", "8.0e-8", "3.0e-10", "2.5e-7")
# Control characters, marks that turn the direction of reading, signs without width, half pairs.
_HOSTILE = (
    "\\u001b[2J",
    "\\u202e",
    "\\u2066",
    "\\u200b",
    "\\u0000",
    "\\r\\n",
    "\\u0007",
    "\\ufeff",
)


def _out_of_bounds(rng: random.Random) -> str:
    place, value = rng.choice(_BOUNDED), rng.choice(_OUT_OF_BOUNDS)
    if place.startswith("nu"):
        # Zero and all that is near to it are fine Poisson's ratios.
        value = rng.choice(("0.5", "-1", "17", "nan", "-inf", "1e300"))
    return SOUND.replace(place, f"{place.split(' = ')[0]} = {value}" + "\n" * place.endswith("\n"))


def _no_number(rng: random.Random) -> str:
    place = rng.choice(_BOUNDED)
    return SOUND.replace(
        place, f"{place.split(' = ')[0]} = {rng.choice(_NO_NUMBER)}" + "\n" * place.endswith("\n")
    )


def _left_out(rng: random.Random) -> str:
    return SOUND.replace(rng.choice(_REQUIRED), "", 1)


def _cut_off(rng: random.Random) -> str:
    # Short of the last row of leg 2's matrix there is always something missing.
    return SOUND[: rng.randrange(SOUND.rindex("[0.0, 3.0e-8"))]


def _noise(rng: random.Random) -> bytes:
    return rng.randbytes(rng.choice((1, 10, 1000, 100_000))) + b"\xff"


def _broken_byte(rng: random.Random) -> bytes:
    at = rng.randrange(len(SOUND))
    return SOUND[:at].encode() + rng.choice((b"\xff", b"\x00", b"\xc0\x80", b"\x1b")) + b"=" * 3


def _unknown_key(rng: random.Random) -> str:
    name = "".join(rng.choice("abcxyz_-019") for _ in range(rng.choice((1, 8, 50, 5000))))
    hostile = "".join(rng.choice(_HOSTILE[:-1]) for _ in range(rng.randint(0, 3)))
    place = rng.choice(("a = 0.9\n", "mass = 46.0\n", "length = 0.85\n"))
    return SOUND.replace(place, f'{place}"{name}{hostile}" = {rng.choice(_NO_NUMBER)}\n')


def _many_unknown_keys(rng: random.Random) -> str:
    count = rng.choice((51, 1000, 20_000))
    return SOUND.replace("a = 0.9\n", "".join(f"lenght{i} = {i}\n" for i in range(count)))


def _hostile_name(rng: random.Random) -> str:
    name = "".join(rng.choice(_HOSTILE[3:]) for _ in range(3)) + "\\u0001" * rng.randint(1, 200)
    return SOUND.replace('"test robot"', f'"{name}"')


def _digits(rng: random.Random) -> str:
    digits = "9" * rng.choice((400, 4299, 4301, 100_000))
    number = rng.choice((digits, f"0x{digits}", f"{digits}.0", f"-{digits}", f"1e{digits}"))
    return SOUND.replace(rng.choice(("0.9\n", "46.0", "1.0e-10", "0.85")), number + "\n", 1)


def _nested(rng: random.Random) -> str:
    depth = rng.choice((101, 1000, 100_000))
    deep = rng.choice(("[" * depth, "[" * depth + "]" * depth, "{a=" * depth, "a." * depth + "a"))
    return rng.choice((f"a = {deep}", f"{deep} = 1", f"[{deep}]", SOUND + f"\nx = {deep}"))


def _matrix(rng: random.Random) -> str:
    value = rng.choice(
        ("nan", "inf", "-inf", '"x"', "true", "[]", "5e-324", "1e-300", "0", "-1e-9")
    )
    return SOUND.replace(rng.choice(_DIAGONAL), value, 1)


def _shape_of_matrix(rng: random.Random) -> str:
    rows, columns = rng.choice(((0, 0), (1, 6), (6, 5), (7, 7), (1000, 6), (6, 1000), (300, 300)))
    matrix = "[" + ", ".join([f"[{', '.join(['1e-9'] * columns)}]"] * rows) + "]"
    start = SOUND.index("compliance = [", SOUND.index(rng.choice(("[foot]", "[leg2]"))))
    return SOUND[:start] + f"compliance = {matrix}" + SOUND[SOUND.index("\n]\n", start) + 2 :]


def _asymmetric(rng: random.Random) -> str:
    return SOUND.replace(rng.choice(("4.0e-8", "-4.0e-9", "3.0e-8]", "-5.0e-8")), "1.0e-8]", 1)


def _stiffness(rng: random.Random) -> str:
    size = 10.0 ** rng.uniform(5.0, 10.0)
    rows = ", ".join(
        "[" + ", ".join(repr(size * (i == j)) for j in range(6)) + "]" for i in range(6)
    )
    start = SOUND.index("compliance = [", SOUND.index("[leg2]"))
    return SOUND[:start] + f"compliance = [{rows}]\n"


def _impossible(rng: random.Random) -> str:
    old, new = rng.choice(
        (
            ("a = 0.9", "a = 1.7"),
            ("length = 0.85", "length = 1.75"),
            ("thickness = 0.008", "thickness = 0.05"),
            ("thickness = 0.008", "thickness = 1e-300"),
            ("width = 0.10", "width = 1.0"),
            ('shape = "hollow-rectangle"', 'shape = "tube"'),
            ("nu = 0.3", "nu = 0.3, G = 1.0"),
            ("rho = 7850.0", "rho = 7.85"),
            ("mass = 49.0", "mass = 49.0\nsection = { shape = 'circle', diameter = 0.1 }"),
            ("[leg2]", "[leg1]"),
            ("schema = 1", "schema = 99"),
            ("schema = 1", "schema = '1'"),
            ('type = "biglide"', 'type = "hexapod"'),
            ("a = 0.9", "a = 0.9\na = 0.9"),
        )
    )
    return SOUND.replace(old, new, 1)


def _unclosed(rng: random.Random) -> str:
    opened = rng.choice(('"' + '\\"' * 50_000, '"""' * 1001 + '"', "'" * 1000, "[" * 50, "{" * 50))
    return SOUND.replace("0.9", opened, 1)


def _corrections(rng: random.Random) -> str:
    key = rng.choice(
        ("leg2.weight", "x" * 10_000, "leg2.compliance[9,9]", "\\u202e", "leg1.section")
    )
    wrong = f'[[corrections]]\nkey = "{key}"\nprinted = 1.0\nused = 2.0\nreason = "r"\n'
    return SOUND + wrong * rng.choice((1, 60, 2000))


def _other_files(rng: random.Random) -> str:
    return rng.choice(
        (
            "",
            " \n\t\n",
            "#" * 1_000_000,
            '{"schema": 1, "name": "json"}',
            "<?xml version='1.0'?><robot/>",
            "schema: 1\nname: yaml\n",
            "%PDF-1.7",
            "\N{BYTE ORDER MARK}" * 2 + SOUND,
        )
    )


KINDS: tuple[Callable[[random.Random], str | bytes], ...] = (
    *(_out_of_bounds, _no_number, _left_out, _cut_off, _noise, _broken_byte, _unknown_key),
    *(_many_unknown_keys, _hostile_name, _digits, _nested, _matrix, _shape_of_matrix, _asymmetric),
    *(_stiffness, _impossible, _unclosed, _corrections, _other_files),
)


def bad_robots(count: int, seed: int) -> Iterator[tuple[str, bytes]]:
    """`count` files, each with the name of what was done to it."""
    rng = random.Random(seed)  # noqa: S311  any choice will do
    for number in range(count):
        kind = KINDS[number % len(KINDS)]
        made = kind(rng)
        yield kind.__name__.lstrip("_"), made if isinstance(made, bytes) else made.encode()
