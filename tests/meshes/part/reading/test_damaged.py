"""STEP files with one damaged token: unchanged, refused in a line, or bridged and said so."""

import random
import re
from pathlib import Path

import numpy as np
import pytest
from drawn_parts import written

from lumped.errors import InputError
from meshes.part.reading.read import read_part

EXAMPLES = Path(__file__).resolve().parents[4] / "examples"
ROCKER = EXAMPLES / "rocker" / "rocker.step"
TOKENS = {
    "reference": re.compile(r"#\d+"),
    "number": re.compile(r"(?<=[(,])[+-]?\d+\.?\d*(?:E[+-]?\d+)?(?=[,)])"),
    "flag": re.compile(r"\.[A-Z]\w*\."),
    "word": re.compile(r"[A-Z]\w+(?=\()"),
}


def bracket(occ):
    """A rounded block with a conical bore, a round groove, a dome and a cavity."""
    block = occ.addBox(0, 0, 0, 120, 60, 40)
    occ.synchronize()
    occ.fillet([block], [1, 3, 5, 7], [6])
    cone, groove = occ.addCone(30, 30, -1, 0, 0, 42, 8, 12), occ.addTorus(85, 30, 40, 14, 4)
    cavity, dome = occ.addSphere(60, 30, 18, 8), occ.addSphere(85, 30, 36, 9)
    fused, _ = occ.fuse([(3, block)], [(3, dome)])
    occ.cut(fused, [(3, one) for one in (cone, groove, cavity)])


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return {
        "rocker": ROCKER,
        "leg": EXAMPLES / "tapered-biglide" / "leg1.step",
        "bracket": written(tmp_path_factory.mktemp("parts") / "bracket.step", bracket),
    }


def damaged(text: str, rng: random.Random) -> tuple[str, str]:
    """The text with one token of its data changed, and what was changed."""
    kind = rng.choice(["reference", "number", "number", "flag", "word"])
    tokens = list(TOKENS[kind].finditer(text, text.index("DATA;")))
    token = rng.choice(tokens)
    old, new = token.group(), rng.choice(tokens).group()
    if kind == "flag":
        new = {".T.": ".F.", ".F.": ".T."}.get(old, new)
    elif kind == "word":
        new = rng.choice([new, old[:-1]])
    elif kind == "number":
        at = rng.choice([i for i, sign in enumerate(old) if sign.isdigit()])
        digit = str((int(old[at]) + rng.randrange(1, 10)) % 10)
        other = f"{float(old) * rng.choice([-1.0, 0.1, 0.9, 1.001, 10.0])!r}"
        new = rng.choice([other, old[:at] + digit + old[at + 1 :], old[:at] + old[at + 1 :]])
    line = text.count("\n", 0, token.start()) + 1
    return text[: token.start()] + new + text[token.end() :], f"line {line}: {old} to {new}"


def is_silent(path, sound) -> bool:
    """Whether the file is read as another part than the sound one, and nothing is said."""
    try:
        part = read_part(path)
    except InputError as error:
        (line,) = error.faults
        assert line.startswith(f"{path}: ")
        assert "\n" not in line
        return False
    own, whole = (
        np.array([one.exact.volume, sum(face.area for face in one.faces), *one.extent])
        for one in (part, sound)
    )
    changed = np.abs(own / whole - 1.0)
    if changed.max() <= 1e-9 or part.unit != sound.unit:
        return False
    off = np.abs(own - whole)[2:].max()
    # The kernel's box is larger by the tolerance that it gave to what it bridged, on both sides.
    bounded = changed[:2].max() <= part.unknown_share and off <= 3.0 * part.gap
    return not (bounded and "gaps of up to" in part.size)


# A third of the hundred damages of each file, and in the soak all of them.
@pytest.mark.parametrize(
    "seeds",
    [
        pytest.param(range(33), marks=pytest.mark.exhaustive),
        pytest.param(range(33, 100), marks=pytest.mark.soak),
    ],
    ids=str,
)
@pytest.mark.parametrize("name", ["rocker", "leg", "bracket"])
def test_no_damage_of_a_token_changes_a_part_in_silence(files, name, seeds, tmp_path):
    source = files[name]
    sound, text, path = read_part(source), source.read_text(), tmp_path / source.name
    silent = []
    for seed in seeds:
        changed, what = damaged(text, random.Random(f"{source.name} {seed}"))  # noqa: S311
        path.write_text(changed)
        if is_silent(path, sound):
            silent.append(f"{seed}, {what}")
    assert silent == []


NAMED = {
    # The other arc of a circle: 495 × 415 × 212 mm for 343 × 263 × 60 mm, volume -3.7 %.
    "an arc the other way": (
        "rocker",
        "#549 = EDGE_CURVE('',#457,#550,#552,.T.)",
        "#549 = EDGE_CURVE('',#457,#550,#552,.F.)",
        r"edges and corners are up to 0\.076 m apart where they should meet, near \(0\.2",
    ),
    # A cavity of the leg does not close: the leg without it, volume +46 %.
    "a cavity lost": ("leg", "#3789 = LINE(", "#3789 = SURFACE_CURVE(", "6 of its 28 faces bound"),
    # Volume, gaps and number of faces stay, the box grows by 2 mm.
    "a cavity moved": (
        "bracket",
        "CARTESIAN_POINT('',(60.,30.,18.))",
        "CARTESIAN_POINT('',(6.0,30.,18.))",
        r"the cavity about \(0\.006, 0\.03, 0\.018\) m sticks out of the solid",
    ),
    # Ends the process, and never comes back.
    "a class cast": ("leg", "#3413 = VECTOR(", "#3413 = SOLID_ANGLE_UNIT(", "its reader fails"),
}


@pytest.mark.parametrize(("name", "old", "new", "message"), NAMED.values(), ids=NAMED.keys())
def test_a_damage_is_refused_with_what_is_wrong(request, files, tmp_path, name, old, new, message):
    if message != "its reader fails":
        request.getfixturevalue("in_this_process")
    text, path = files[name].read_text(), tmp_path / "damaged.step"
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError, match=message):
        read_part(path)


@pytest.mark.usefixtures("in_this_process")
def test_a_small_gap_is_bridged_and_said(tmp_path):
    """A corner of the rocker 0.01 mm off: its place in space is told by nothing but itself."""
    path = tmp_path / "gap.step"
    old = "(20.124611797499,40.249223594996,-30.)"
    path.write_text(ROCKER.read_text().replace(old, old.replace("20.1246", "20.1346")))
    part = read_part(path)
    assert part.gap == pytest.approx(1e-5, rel=1e-6)
    assert re.search(r"60(\.\d+)? mm, gaps of up to 0\.01 mm bridged \(volume to 0\.", part.size)
