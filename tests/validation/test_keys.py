"""Keys of stored results: each input of a key is changed, one at a time, and changes the key.

If a key lacks an input of its result, a run with another robot, preset, option, library or source
reads a wrong result.
"""

import ast
import hashlib
import os
import runpy
import shutil
from collections.abc import Iterator
from dataclasses import fields, replace
from functools import partial
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.fakes.cleared_memory import forget
from support.oracles.changed_values import changed_leaves

from lumped.acceptance.measured import Measured, digest
from lumped.acceptance.quantities import measured_quantity
from lumped.legs import ConstantLeg, Material
from lumped.memo import fingerprint
from lumped.robot_file import RobotFile, load_robot
from lumped.sections import HollowRectangle
from meshes.part.interfaces import Interface
from meshes.part.reading.read import PartFile
from validation import api, pytest_plugin
from validation.case import Absolute, Relative
from validation.comparisons.element_convergence import storing
from validation.context import PRESETS, memo_key
from validation.models import reduced_parts, stepped_parts
from validation.models.options import ModelOptions
from validation.parts import identify, meshes
from validation.run import cache, provenance, stored_results
from validation.run.cache import CacheEntry, key_of
from validation.run.executor import in_turn
from validation.run.folder import mark_of
from validation.validate import Request
from validation.variations import curves as CURVES  # noqa: N812
from validation.variations.curves import VariedModels, VariedRobot, computed

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
ROCKER = EXAMPLES / "rocker" / "robot.toml"
BODIES = {ROCKER: "rocker", EXAMPLES / "tapered-biglide" / "robot.toml": "leg1"}
STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
LEG = ConstantLeg(0.85, HollowRectangle(0.10, 0.16, 0.008), STEEL)


def file_and_interfaces(folder: Path) -> tuple[PartFile, tuple[Interface, ...]]:
    """Part file in the folder, and two interfaces of the part."""
    path = folder / "part.step"
    path.write_bytes(b"solid")
    file = PartFile(path, "mm", [1.0, 1.0, 1.0], np.zeros((0, 3)), (), None, None)
    axis = np.array([0.0, 0.0, 1.0])
    bore = Interface("A", (1, 2), np.array([0.0, 0.1, 0.2]), "rigid", "a pin", axis, axis, 1.0)
    plane = Interface("B", (3,), np.array([1.0, 0.0, 0.0]), "average", "", None, None, 2.0)
    return file, (bore, plane)


def varied(robot: str | Path) -> VariedRobot:
    return VariedRobot(load_robot(robot), "quick", "points.A[1] = 0.2", "deflection")


@pytest.mark.parametrize(
    "inputs",
    [
        varied("five-bar"),
        varied("ifw"),
        varied(ROCKER),
        {"legs": LEG, "options": ModelOptions(), "poses": np.eye(3), "at": [0.1, None, True]},
    ],
    ids=["five-bar", "ifw", "rocker", "arguments"],
)
def test_cache_key_has_every_input_field(inputs):
    """Each number and name in the inputs of a robot, a part and a leg is changed in turn."""
    keys = {key_of(inputs): ""}
    for path, changed in changed_leaves(inputs):
        key = key_of(changed)
        assert key not in keys, (path, keys[key])
        keys[key] = path
    assert len(keys) > 5


def test_cache_key_includes_source_code(monkeypatch):
    """Other sources, another key."""
    keys, names = set(), [field.name for field in fields(VariedModels)]
    for letter in "ab":
        monkeypatch.setattr(CURVES, "program", lambda letter=letter: letter)
        monkeypatch.setattr(
            stored_results, "find", lambda key: keys.add(key) or dict.fromkeys(names, np.ones(()))
        )
        forget()
        computed([varied("five-bar")], pytest.fail, "varying")
    forget()
    assert len(keys) == 2


def test_convergence_study_is_read_from_cache(tmp_path, monkeypatch):
    """All element counts, those of the search for the smallest ones and those of the limit."""
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "cache"))
    study_of = partial(api.converge, "five-bar", "segments", elements=[5, 10])
    computed_study = study_of()
    forget()
    monkeypatch.setattr(api, "in_turn", lambda calls: pytest.fail(f"{len(calls)} computed"))
    assert study_of().json() == computed_study.json()
    for changes in ({"elements": [5, 11]}, {"theory": "euler-bernoulli"}, {"body": "rod1"}):
        with pytest.raises(pytest.fail.Exception):
            study_of(**changes)


def test_convergence_key_includes_part_file(tmp_path):
    """One byte more in a STEP file."""
    shutil.copytree(ROCKER.parent, tmp_path / "rocker")
    mechanism = load_robot(tmp_path / "rocker" / "robot.toml").mechanism
    inputs = storing(in_turn, mechanism).inputs
    with (tmp_path / "rocker" / "rocker.step").open("a") as file:
        file.write("\n")
    assert storing(in_turn, mechanism).inputs != inputs


def test_source_digest_includes_every_file(tmp_path, monkeypatch):
    """A byte, a name, a folder or an additional file each change the digest."""
    monkeypatch.setattr(cache, "__file__", str(tmp_path / "a" / "b" / "cache.py"))
    names = [f"{package}/x/one.py" for package in ("lumped", "meshes", "fem", "validation")]
    names += [f"validation/x/one.{kind}" for kind in ("toml", "j2", "css", "js")]
    files = [tmp_path / name for name in names]
    for file in files:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("0")
    digests = [digest_now()]
    for file in files:
        file.write_text("1")
        digests.append(digest_now())
        file.rename(file.with_stem("other"))
        digests.append(digest_now())
    assert len(set(digests)) == 1 + 2 * len(files)
    forget()


def digest_now() -> str:
    forget()
    return cache.source_digest()


def part_keys(folder: Path) -> list[str]:
    """Keys of a mesh of a part and of the part's identification on it."""
    file, interfaces = file_and_interfaces(folder)
    (mesh,) = meshes.mesh_entries(file, interfaces, 1000, [0])
    return [mesh.key, identify.identified_entry(file, interfaces, STEEL, 1000, 6).key]


def test_changed_source_changes_keys(tmp_path, monkeypatch):
    """A copy of the sources in another folder, such as an installed wheel, has the same keys."""
    for package in cache.PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package)

    def keys() -> list[str]:
        forget()
        return [*part_keys(tmp_path), cache.program()]

    before = keys()
    monkeypatch.setattr(cache, "__file__", str(tmp_path / "validation" / "run" / "cache.py"))
    os.utime(tmp_path / "lumped" / "screws.py", (0, 0))
    (tmp_path / "lumped" / "__pycache__").mkdir(exist_ok=True)
    (tmp_path / "lumped" / "__pycache__" / "more.py").write_text("1")
    assert keys() == before
    # Which keys are others: of a mesh, of what is computed on it, and of the whole program.
    changes = {
        "lumped/screws.py": [True, True, True],
        "meshes/part/volume.py": [True, True, True],
        "fem/elasticity.py": [False, True, True],
        "validation/models/reduced_parts.py": [False, True, True],
        "validation/report/page.py": [False, False, True],
    }
    for name, changed in changes.items():
        with (tmp_path / name).open("a", encoding="utf-8") as file:
            file.write("MORE = 1\n")
        after = keys()
        assert [a != b for a, b in zip(before, after, strict=True)] == changed, name
        before = after
    forget()


# What shows numbers and computes none.
VIEWS = {"validation.tables", "validation.parts.identified_plot"}


def test_part_key_includes_sources():
    """Sources: all modules imported, also indirectly, by those that compute cache entries."""
    drawing = runpy.run_path(str(ROOT / "docs" / "pictures" / "architecture.py"))
    files = drawing["modules"]()
    for start, places in (
        ({"validation.parts.meshes"}, meshes.MESHING),
        (
            {module.__name__ for module in (identify, reduced_parts, stepped_parts)},
            meshes.COMPUTING,
        ),
    ):
        imported, waiting = set(), list(start)
        while waiting:
            imported.add(name := waiting.pop())
            waiting += drawing["imports"](files[name], files) - imported - VIEWS
        digested = {path for folder in places for path in cache._files(str(ROOT / folder))}
        for name in imported:
            if str(files[name]) not in digested:
                body = ast.parse(files[name].read_text(encoding="utf-8")).body
                assert all(isinstance(statement, ast.Expr) for statement in body), name


def test_memo_key_has_all_arguments():
    """Values, types, shapes and names of arguments. Names of legs do not count."""
    arguments = [
        *((), (1,), (1.0,), ("1",), (True,), ((1, 2), 3), (1, (2, 3))),
        *((np.zeros(6),), (np.zeros((2, 3)),), (np.zeros((3, 2)),), (np.zeros(6, np.float32),)),
        *((changed_leaves,), (varied,), (Absolute(1.0),), (Relative(1.0),)),
    ]
    calls = [(changed_leaves, values, {}) for values in arguments]
    calls += [(varied, (), {}), *((changed_leaves, (), {name: 1}) for name in "ab")]
    assert len({memo_key(*call) for call in calls}) == len(calls)
    # What a leg is called is no difference to what is remembered of it.
    for changed, are_equal in (
        (replace(LEG, name="leg2"), True),
        (replace(LEG, length=0.86), False),
    ):
        assert (memo_key(varied, (LEG,), {}) == memo_key(varied, (changed,), {})) == are_equal
        assert key_of(LEG) != key_of(changed)
    with pytest.raises(ValueError, match="only module-level functions"):
        memo_key(lambda: None, (), {})
    with pytest.raises(TypeError, match="must be plain data"):
        fingerprint(object())


def test_part_key_depends_on_every_input(tmp_path, monkeypatch):
    """Interfaces and their order, material, unit, options, sources, library versions and file."""
    file, interfaces = file_and_interfaces(tmp_path)
    inputs = [(interfaces, STEEL), (interfaces[::-1], STEEL)]
    for position in (0, 1):
        changed = [other for _, other in changed_leaves(inputs[0][position])]
        inputs += [(value, STEEL) if position == 0 else (interfaces, value) for value in changed]
    keys = [meshes.part_key(file, *pair) for pair in inputs]
    keys.append(meshes.part_key(replace(file, unit="m"), *inputs[0]))
    keys += [
        meshes.part_key(file, *inputs[0], *options) for options in ((1,), (2,), ("1",), (1, 2))
    ]
    keys.append(meshes.part_key(file, *inputs[0], sources=meshes.MESHING))
    with monkeypatch.context() as patch:
        patch.setattr(cache, "version", lambda _library: "another")
        forget()
        keys.append(meshes.part_key(file, *inputs[0]))
    forget()
    file.path.write_bytes(b"Solid")
    keys.append(meshes.part_key(file, *inputs[0]))
    assert len(set(keys)) == len(keys) >= 30


def calls_of_parts(file: PartFile, interfaces: tuple[Interface, ...]) -> Iterator[partial[Any]]:
    """Yield calls for all results of a part that are cached, with each option changed."""
    body, leg = (load_robot(robot).mechanism.parts[name] for robot, name in BODIES.items())
    lighter = replace(body, shape=replace(body.shape, material=replace(STEEL, rho=7000.0)))
    for count in (1000, 1001):
        yield from (partial(meshes.part_mesh, file, interfaces, count, level) for level in (0, 1))
        yield partial(meshes.gradings, file, interfaces, count)
        for modes in (6, 7):
            yield partial(identify.identify, file, interfaces, STEEL, count, modes)
    yield partial(identify.identify, file, interfaces, replace(STEEL, nu=0.29), 1000, 6)
    plain = {"highest": 800.0, "cutoff": 2000.0}
    other_values = {"highest": 801.0, "cutoff": 2001.0, "level": 1, "hold": "average", "by": "free"}
    yield from (partial(reduced_parts.reduced, part, **plain) for part in (body, lighter))
    yield from (
        partial(reduced_parts.reduced, body, **plain | {name: other_values[name]})
        for name in other_values
    )
    yield from (partial(stepped_parts.stepped, leg, pieces) for pieces in (10, 11))


def test_results_have_unique_keys(tmp_path, monkeypatch):
    """The calls of `calls_of_parts` all have different keys."""

    def noted(entry):
        keys.append(entry.key)
        raise InterruptedError

    keys: list[str] = []
    part = file_and_interfaces(tmp_path)
    monkeypatch.setattr(reduced_parts, "found_in", lambda _: part)
    monkeypatch.setattr(CacheEntry, "value", noted)
    calls = list(calls_of_parts(*part))
    for ask in calls:
        with pytest.raises(InterruptedError):
            ask()
    assert len(set(keys)) == len(keys) == len(calls)


def test_run_key_contains_all_options():
    """Each field of the header but the time of the start."""
    header = {
        "robot": "r",
        "robot_sha256": "1",
        "preset": "quick",
        "suite_sha256": "2",
        "versions": {"python": "3", "numpy": "2", "gmsh": "4", "linear solver": "rslab"},
        "options": {"accept": "x=0.1"},
    }
    changed = [
        header | {name: other} for name in header for _, other in changed_leaves(header[name])
    ]
    assert len({mark_of(changed_header).run for changed_header in (header, *changed)}) == 1 + len(
        changed
    )
    assert mark_of(header | {"started": "later"}).run == mark_of(header).run
    needed = {"python", "numpy", "scipy", "gmsh", "scikit-fem", "rslab", "linear solver"}
    assert needed <= provenance.versions().keys()


def test_run_digest_depends_on_measurements():
    """Options, and each field of each measured value."""
    plain = Request(load_robot("ifw"), "quick", Path("out"), 1)
    changed = {"only": "leg*", "accept": ("x=0.1",), "vary": ("geometry.a=0.9:1:3",)}
    requests = [plain, *(replace(plain, **{name: other}) for name, other in changed.items())]
    assert len({fingerprint(dict(request.options)) for request in requests}) == 4
    values = (
        Measured(measured_quantity("x"), 1e-6, 1e-8, "rig", (0.3,), 100.0),
        Measured(measured_quantity("f1"), 80.0, 0.1, "rig"),
    )
    other_measurements = [other for _, other in changed_leaves(values)]
    assert len({digest(measurements) for measurements in (values, *other_measurements)}) == 1 + len(
        other_measurements
    )


def with_part(folder: Path, change: bytes = b"") -> RobotFile:
    """Robot file of the rocker, copied to a folder, with `change` appended to its STEP file."""
    folder.mkdir()
    part = ROCKER.with_name("rocker.step").read_bytes()
    (folder / "rocker.step").write_bytes(part + change)
    (folder / "robot.toml").write_bytes(ROCKER.read_bytes())
    return load_robot(folder / "robot.toml")


@pytest.mark.usefixtures("coarse_parts")
def test_robot_digest_covers_file_and_parts(tmp_path):
    """SHA-256 of the robot file, and of its part's file if it has one."""
    first, unchanged = with_part(tmp_path / "one"), with_part(tmp_path / "same")
    other = with_part(tmp_path / "other", b"/* other */\n")
    assert first.sha256 == unchanged.sha256 != other.sha256
    assert load_robot("ifw").sha256 == hashlib.sha256(load_robot("ifw").text.encode()).hexdigest()
    # A part that was written again under a session, as long as before, is read again.
    body, part = first.mechanism.parts["rocker"], tmp_path / "one" / "rocker.step"
    before, _ = reduced_parts.found_in(body)
    assert reduced_parts.found_in(body)[0] is before
    part.write_text(part.read_text().replace("\n", " ", 1))
    assert reduced_parts.found_in(body)[0] is not before
    part.unlink()
    assert load_robot(tmp_path / "one" / "robot.toml").sha256 != first.sha256


def test_plugin_computes_robots_once(tmp_path, monkeypatch):
    """The pytest plugin judges each robot once per preset, and again if a part file changes."""
    judged = []

    def judge(robot, *, preset, accept):
        judged.append((robot.sha256, preset, accept))
        return SimpleNamespace(accepting=lambda _: None)

    monkeypatch.setattr(api, "adequacy", judge)
    robots = [with_part(tmp_path / name, b"/* b */\n" * (name == "b")) for name in "ab"]
    assessments = {pytest_plugin._ASSESSMENTS: {}}
    for robot, preset, accept in 2 * list(product(robots, PRESETS, (None, {"modes": 6}))):
        config = SimpleNamespace(stash=assessments, getoption=lambda _, preset=preset: preset)
        pytest_plugin._assessment(config, robot.source, accept)
    assert len({fingerprint(request) for request in judged}) == len(judged) == 2 * len(PRESETS) * 2
