"""Random commands with their files, equal for equal seeds: valid ones, slips, and nonsense.

None of them computes for long: runs request cases that do not exist, and solids are refused.
"""

import json
import random
import tomllib
from pathlib import Path
from typing import NamedTuple

from msgspec.json import encode
from support.random.mutated_robots import mutated, toml
from support.robots.single_arm import LOADS, ONE_ARM
from support.robots.valid_biglide import SOUND

import lumped.robots
from validation.run.records import StoredEntry

_BUILT_IN = ("five-bar", "3-rrr", "delta", "orthoglide", "hexapod")
_FOLDER = Path(lumped.robots.__file__).parent
ROBOTS = (
    *(SOUND, ONE_ARM, ONE_ARM + LOADS),
    *((_FOLDER / f"{name}.toml").read_text(encoding="utf-8") for name in _BUILT_IN),
)
_EMPTY_STEP = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\n"
_RESULTS = ("one.json", "two.json", "folder/results.json")
_SIGNS = '0123456789.e-=[]{}"#,\n'
# What nobody means, as an option, a cell of a table, or in the place of any word of a file.
_ODD = (
    *("", " ", "-1", "0", "1e400", "nan", "-inf", "1000000000", "9" * 400, "x" * 5000, "1e-320"),
    *("\x1b[2J\u202e", "a=b", "=", "::", "0.5:0.6:2", "[]", "{", "{}", "[[", "/", ".", "*", "%s"),
    *("None", "true", "1,2,3", "1e300,1e300", "nan,1", "five-bar", "leg1", "-0.0", '"', "'"),
    *("\\u0000", "0x" + "f" * 9000, "[1.0]", "@", "a\nb", "../robot.toml", "robot.toml"),
)
# Options with values that somebody means; flags have none.
_MEANT = {
    "--x": ("0.4", "0.5"),
    "--pose": ("0.1,0.5", "-0.05,0.5", "0.01"),
    "--leg": ("1", "2"),
    "--body": ("rod1", "arm"),
    "--modes": ("0", "2"),
    "--legs": ("given", "equivalent"),
    "--theory": ("timoshenko", "euler-bernoulli"),
    "--elements": ("2", "5"),
    "--release": ("printed",),
    "--layout": ("literal",),
    "--parts": ("stepped",),
    "--accuracy": ("0.01",),
    "--against": ("segments",),
    "--vary": ("geometry.a=0.9:0.91:2", "tool.mass=1:2:2", "*.width=0.05:0.06:1"),
    "--preset": ("quick", "fine"),
    "--accept": ("deflection=0.1", "f1=0.02"),
    "--rely": ("beam", "vjm"),
    "--inputs": ("0.05",),
    "--measured": ("values.csv",),
    "--baseline": ("one.json", "folder"),
    "--cluster": ("tcp://a..b:1", "tcp://127.0.0.1:1", "tcp://[::1:2"),
    "--interface": ("A = { faces = [1] }", "B = { cylinder = { radius = 0.04 } }"),
    "--material": ("{ E = 2.1e11, nu = 0.3, rho = 7850.0 }",),
    "--unknowns": ("2000",),
    "--unit": ("mm",),
    "--out": ("out.npz", "out.mat", "robot.toml"),
    "--type": _BUILT_IN,
}
_OPTIONS = {
    "check": "",
    "cases": "--json",
    "kinematics": "--pose --json",
    "solve": "--x --pose --leg --body --modes --legs --theory --elements --release --layout"
    " --parts --accuracy --against --vary --json",
    "run": "--preset --accept --rely --accuracy --inputs --measured --vary --baseline --cluster"
    " --resume --strict",
    "identify": "--interface --material --body --unknowns --modes --unit",
    "faces": "--unit --json",
    "export": "--modes --out",
    "compare": "--json",
    "new": "--type",
}
_WEIGHTS = {"check": 5, "kinematics": 4, "solve": 4, "run": 2, "compare": 4, "identify": 1}
_PROGRAMS = ("npz", "exudyn", "statespace", "simscape", "nastran", "")
_MODELS = ("simplified", "vjm", "links", "segments", "beam")


class Command(NamedTuple):
    """Words of a command line, and the files of its folder by name."""

    words: tuple[str, ...]
    files: dict[str, bytes]


def random_commands(count, seed):
    """Generate `count` commands."""
    rng = random.Random(seed)  # noqa: S311  any choice will do
    weights = [_WEIGHTS.get(name, 0.5) for name in _OPTIONS]
    for name in rng.choices(list(_OPTIONS), weights, k=count):
        yield _command(rng, name)


def _command(rng, name):
    files = {"robot.toml": _robot(rng)}
    words = [name]
    match name:
        case "compare":
            files |= {file: _results(rng) for file in _RESULTS}
            words.append(rng.choice(("one.json", "folder", _odd(rng))))
            words.append(rng.choice(("one.json", "two.json")))
        case "new":
            words.append(rng.choice(("new.toml", "robot.toml", _odd(rng))))
        case "faces" | "identify":
            files["part.step"] = _damaged(rng, _EMPTY_STEP)
            words.append(rng.choice(("robot.toml", *_BUILT_IN, "part.step", _odd(rng))))
        case _:
            names = ("robot.toml", "ifw", "five-bar", _odd(rng))
            words += rng.choices(names, (12, 1, 1, 1))
    if name == "export":
        words.append(f"--to={rng.choice(_PROGRAMS)}")
        words.append(rng.choice(("--body=nobody", "--pose=90,90", f"--body={_odd(rng)}")))
    if name == "solve" and rng.random() < 0.95:
        words += ["--model", rng.choice(_MODELS)]
    if name == "run":
        files |= {"values.csv": _measured(rng), **{file: _results(rng) for file in _RESULTS}}
        words += ["--only", rng.choice(("nothing", "no*", "", "[[", "x" * 5000))]
    options = _OPTIONS[name].split()
    for option in rng.sample(options, min(len(options), rng.choice((0, 0, 1, 1, 2, 3)))):
        values = _MEANT.get(option)
        value = rng.choice(values) if values and rng.random() < 0.6 else _odd(rng)
        # Joined, so that a value may begin with a hyphen.
        words.append(f"{option}={value}" if values else option)
    return Command(tuple(words), files)


def _odd(rng):
    return rng.choice(_ODD)


def _robot(rng):
    text = rng.choice(ROBOTS)
    match rng.randrange(5):
        case 0:
            return text.encode()
        case 1 | 2:
            return toml(mutated(rng, tomllib.loads(text))).encode()
        case _:
            return _damaged(rng, text)


def _damaged(rng, text):
    """Text in which one or two bytes, words or ranges are lost, doubled or replaced."""
    for _ in range(rng.choice((1, 1, 2))):
        begin, end = sorted(rng.randrange(len(text) + 1) for _ in range(2))
        match rng.randrange(5):
            case 0:
                text = text[:begin] + text[end:]
            case 1:
                text = text[:end] + text[begin:]
            case 2:
                words = text.split(" ")
                words[rng.randrange(len(words))] = _odd(rng)
                text = " ".join(words)
            case 3:
                text = text.replace(rng.choice(_SIGNS), rng.choice(_SIGNS), rng.choice((1, 3)))
            case _:
                data = bytearray(text.encode())
                for index in rng.choices(range(len(data)), k=3) if data else ():
                    data[index] = rng.randrange(256)
                return bytes(data)
    return text.encode()


def _measured(rng):
    quantities = ("x", "f1", "phi_z", "leg1.c22", "f99", _odd(rng))
    numbers = ("1e-6", "0.01", "60", "-1", "0.5 0.4", _odd(rng))
    rows = [
        ",".join([rng.choice(quantities), *(rng.choice(numbers) for _ in range(3)), "rig"])
        for _ in range(rng.choice((0, 1, 3, 80)))
    ]
    text = "\n".join(["quantity,pose,value,uncertainty,source", *rows])
    return text.encode() if rng.random() < 0.6 else _damaged(rng, text)


_AGREED = {"verdict": "agree", "value": 1.0, "reference": 1.0, "tolerance": 0.1}
_RUN = {
    "schema": 1,
    "run": {"robot": "r", "preset": "quick", "robot_tables": {"a": [1.0, 2.0]}},
    "cases": [{"id": name, **_AGREED} for name in ("one", "two", "three")],
    "adequacy": [StoredEntry(model="beam", quantity="x", verdict="adequate", poses=((0.1,),))],
}


def _results(rng):
    run = json.loads(encode(_RUN))
    run["cases"][0]["verdict"] = rng.choice(("agree", "undecided", "disagree"))
    match rng.randrange(4):
        case 0:
            return json.dumps(run).encode()
        case 1 | 2:
            return json.dumps(mutated(rng, run)).encode()
        case _:
            return _damaged(rng, json.dumps(run))
