"""Five-bars as robot files at random, with everything that no built-in robot has.

Unlike legs, some given by a 6×6, joints that give, drives of all stiffnesses; poses are away from
the reference posture. Beside each stands its own answer, from the tables as written and closed
forms alone: positions by circles, compliances by virtual joints written out.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.robot_file import RobotFile, load_robot

Z = np.array([0.0, 0.0, 1.0])
Tables = dict[str, Any]


def carried(compliance: Array, offset: Array) -> Array:
    """A compliance as felt at a point `offset` (m) further: u + φ × r."""
    moved = np.eye(6)
    moved[:3, 3:] = np.cross(np.eye(3), offset).T
    return moved @ compliance @ moved.T


def turned(compliance: Array, rotation: Array) -> Array:
    """A 6×6 in axes that are the columns of `rotation`, in base axes."""
    both = np.kron(np.eye(2), rotation)
    return both @ compliance @ both.T


def rotation_between(before: Array, after: Array) -> Array:
    """About z, from one direction in the plane to another."""
    return leg_axes(after) @ leg_axes(before).T


def leg_axes(direction: Array) -> Array:
    """x along the leg, which lies in the plane, z the base's."""
    x = direction / np.linalg.norm(direction)
    return np.column_stack([x, np.cross(Z, x), Z])


def cantilever(length: float, section: Mapping[str, Any], material: Mapping[str, float]) -> Array:
    """Euler and Bernoulli's 6×6 at the tip, leg axes."""
    E, G = material["E"], material["E"] / (2.0 * (1.0 + material["nu"]))
    if section["shape"] == "rectangle":
        w, h = section["width"], section["height"]
        A, Iy, Iz = w * h, w * h**3 / 12.0, h * w**3 / 12.0
        b, a = sorted((w, h))
        odd = np.arange(1, 200, 2)
        # Saint-Venant's series; b is the shorter side.
        series = (np.tanh(odd * np.pi * a / (2.0 * b)) / odd**5).sum()
        J = a * b**3 * (1.0 / 3.0 - 64.0 / np.pi**5 * b / a * series)
    else:
        outer = section["diameter"] / 2.0
        inner = outer - section.get("thickness", outer)
        A = np.pi * (outer**2 - inner**2)
        Iy = Iz = np.pi / 4.0 * (outer**4 - inner**4)
        J = 2.0 * Iy
    L, C = length, np.zeros((6, 6))
    C[0, 0], C[3, 3] = L / (E * A), L / (G * J)
    C[1, 1], C[5, 5], C[1, 5] = L**3 / (3 * E * Iz), L / (E * Iz), L**2 / (2 * E * Iz)
    C[2, 2], C[4, 4], C[2, 4] = L**3 / (3 * E * Iy), L / (E * Iy), -(L**2) / (2 * E * Iy)
    C[5, 1], C[4, 2] = C[1, 5], C[2, 4]
    return C


@dataclass(frozen=True)
class Linkage:
    """A robot file's tables with what it answers to in `pose` by closed forms, SI, base axes."""

    tables: Tables
    pose: tuple[float, ...]
    compliance: Array

    def written(self, folder: Path) -> RobotFile:
        """The robot read from a file in `folder`."""
        path = folder / f"{self.tables['name']}.toml"
        lines = [f"{key} = {_text(value)}\n" for key, value in self.tables.items()]
        path.write_text("".join(lines), encoding="utf-8")
        return load_robot(path)


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_text(one)}" for key, one in value.items()) + " }"
    return json.dumps(value, default=np.ndarray.tolist)


def _joint(kind: str, first: str, second: str, at: str, **more: Any) -> Tables:
    return {"type": kind, "between": [first, second], "at": at, **more}


def give(rng: np.random.Generator, size: float = 1e-9) -> Array:
    """The 6×6 of a bearing, all its terms coupled."""
    root = rng.normal(size=(6, 6)) * np.sqrt([size] * 3 + [50.0 * size] * 3)[:, None]
    return root @ root.T + size * np.diag([1.0] * 3 + [50.0] * 3)


def section(rng: np.random.Generator) -> Tables:
    """A slender section of its own."""
    size = float(rng.uniform(0.03, 0.05))
    sections: list[Tables] = [
        {"shape": "circle", "diameter": size},
        {"shape": "tube", "diameter": size, "thickness": 0.15 * size},
        {"shape": "rectangle", "width": size, "height": float(rng.uniform(0.5, 1.9)) * size},
    ]
    return sections[int(rng.integers(3))]


def material(rng: np.random.Generator) -> Tables:
    """From plastics to steel."""
    E, nu = 10.0 ** rng.uniform(10.0, 11.4), rng.uniform(0.0, 0.4)
    return {"E": float(E), "nu": float(nu), "rho": float(rng.uniform(1000.0, 8000.0))}


def _elbow(base: Array, tip: Array, lengths: tuple[float, float], side: float) -> Array:
    """Where two circles about `base` and `tip` meet, to the left (side > 0) or right of the way."""
    way = tip - base
    d = float(np.linalg.norm(way))
    along = (lengths[0] ** 2 - lengths[1] ** 2 + d**2) / (2.0 * d)
    across = np.sqrt(lengths[0] ** 2 - along**2)
    return np.asarray(base + along * way / d + side * across * np.cross(Z, way) / d)


def five_bar(seed: int, *, matrices: bool = False) -> Linkage:
    """Two unlike cranks and rods in the plane, the tool off the reference posture.

    With `matrices` one leg is given by a 6×6.
    """
    rng = np.random.default_rng(seed)
    points, now = {}, {}
    P = np.array([rng.uniform(-0.05, 0.05), rng.uniform(0.5, 0.6), 0.0])
    pose = P + np.array([rng.uniform(-0.12, 0.12), rng.uniform(-0.1, 0.05), 0.0])
    for n, side in ((1, 1.0), (2, -1.0)):
        base = np.array([-side * rng.uniform(0.1, 0.2), rng.uniform(-0.05, 0.05), 0.0])
        lengths = rng.uniform(0.28, 0.4), rng.uniform(0.4, 0.5)
        for places, tip in ((points, P), (now, pose)):
            places |= {f"A{n}": base, f"B{n}": _elbow(base, tip, lengths, side), "P": tip}
    names = {f"crank{n}": (f"A{n}", f"B{n}") for n in (1, 2)}
    names |= {f"rod{n}": (f"B{n}", "P") for n in (1, 2)}
    ways = {name: points[end] - points[start] for name, (start, end) in names.items()}
    ways_now = {name: now[end] - now[start] for name, (start, end) in names.items()}
    given = rng.choice(list(names)) if matrices else None
    bodies, tips = {}, {}
    for name, (start, end) in names.items():
        one, made_of = section(rng), material(rng)
        tips[name] = cantilever(float(np.linalg.norm(ways[name])), one, made_of)
        said: Tables = {"section": one, "material": made_of}
        if name == given:
            tips[name] = tips[name] + give(rng, 1e-7)
            said = {"mass": 2.0, "compliance": tips[name]}
        bodies[name] = {"from": start, "to": end, **said}
    drives = {n: 10.0 ** rng.uniform(4.5, 6.0) for n in (1, 2)}
    gives = {name: give(rng) for name in ("motor1", "motor2", "elbow1", "elbow2", "pin")}
    joints = {"pin": _joint("revolute", "rod1", "rod2", "P", axis=Z)}
    for n in (1, 2):
        drive = {"stiffness": drives[n]}
        motor = _joint("revolute", "ground", f"crank{n}", f"A{n}", axis=Z, drive=drive)
        elbow = _joint("revolute", f"crank{n}", f"rod{n}", f"B{n}", axis=Z)
        joints |= {f"motor{n}": motor, f"elbow{n}": elbow}
    for name, own in gives.items():
        joints[name]["compliance"] = own
    tables = {
        "schema": 2,
        "name": "five-bar-at-random",
        "points": points,
        "bodies": bodies,
        "joints": joints,
        "tool": {"body": "rod1", "point": "P", "moves": ["x", "y"], "mass": 2.0},
        "path": {"from": P[:2], "to": pose[:2], "count": 3},
    }
    about_z = np.concatenate([np.zeros(3), Z])
    stiffness = np.zeros((6, 6))
    for n in (1, 2):
        drive_too = gives[f"motor{n}"] + np.outer(about_z, about_z) / drives[n]
        chain = carried(drive_too, pose - now[f"A{n}"])
        for name in (f"crank{n}", f"rod{n}"):
            leg = turned(tips[name], leg_axes(ways_now[name]))
            chain = chain + carried(leg, pose - now[names[name][1]])
        turn = rotation_between(ways[f"crank{n}"], ways_now[f"crank{n}"])
        arm = pose - now[f"B{n}"]
        chain = chain + carried(turned(gives[f"elbow{n}"], turn), arm)
        free = [np.concatenate([np.cross(Z, arm), Z])]
        if n == 2:
            chain = chain + turned(gives["pin"], rotation_between(ways["rod1"], ways_now["rod1"]))
            free.append(about_z)
        held, J = np.linalg.inv(chain), np.array(free).T
        stiffness += held - held @ J @ np.linalg.inv(J.T @ held @ J) @ J.T @ held
    return Linkage(tables, tuple(pose[:2].tolist()), np.linalg.inv(stiffness))
