"""Makes the STEP files of the examples: `python examples/make_parts.py` (needs gmsh alone).

Numbers in mm. A leg's x axis runs from the axis of its first bore to that of its second, its z axis
along the bores.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import gmsh

HERE = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Leg:
    """A tapered hollow leg with a lug at either end.

    Sides (y, z) of the outer and inner loft and where they stand along x; radii of lugs and bores;
    `ribs`: where along x walls of `wall` stay in the cavity; `fillet` of the long outer edges.
    """

    length: float
    outer: tuple[tuple[float, float], tuple[float, float]]
    inner: tuple[tuple[float, float], tuple[float, float]]
    cavity: tuple[float, float]
    lugs: tuple[float, float]
    bores: tuple[float, float]
    ribs: tuple[float, ...] = ()
    wall: float = 0.0
    fillet: float = 0.0


MEASURED = Leg(
    length=850.0,
    outer=((170.0, 210.0), (100.0, 140.0)),
    inner=((139.0, 179.0), (83.0, 123.0)),
    cavity=(90.0, 770.0),
    lugs=(85.0, 55.0),
    bores=(40.0, 28.0),
)
LEG1 = Leg(
    length=850.0,
    outer=((150.0, 200.0), (96.0, 140.0)),
    inner=((126.0, 176.0), (80.0, 124.0)),
    cavity=(100.0, 770.0),
    lugs=(80.0, 55.0),
    bores=(40.0, 28.0),
    ribs=(435.0,),
    wall=14.0,
    fillet=16.0,
)
LEG2 = Leg(
    length=775.0,
    outer=((130.0, 220.0), (90.0, 140.0)),
    inner=((104.0, 194.0), (72.0, 122.0)),
    cavity=(95.0, 700.0),
    lugs=(78.0, 52.0),
    bores=(38.0, 25.0),
    ribs=(400.0,),
    wall=14.0,
    fillet=16.0,
)


def leg(occ: ModuleType, data: Leg) -> None:
    """Add the leg to an empty model."""
    outer = _loft(occ, (0.0, data.length), data.outer)
    if data.fillet:
        occ.synchronize()
        boxes = {tag: occ.getBoundingBox(1, tag) for _, tag in gmsh.model.getEntities(1)}
        along = [tag for tag, box in boxes.items() if box[3] - box[0] > data.length / 2.0]
        outer = occ.fillet([outer], along, [data.fillet])[0][1]
    ends = list(zip((0.0, data.length), data.outer, data.lugs, data.bores, strict=True))
    lugs = [(3, occ.addCylinder(x, 0, -z / 2, 0, 0, z, r)) for x, (_, z), r, _ in ends]
    body, _ = occ.fuse([(3, outer)], lugs)
    holes = [(3, occ.addCylinder(x, 0, -z, 0, 0, 2 * z, r)) for x, (_, z), _, r in ends]
    holes += [(3, _loft(occ, *piece)) for piece in _cavities(data)]
    occ.cut(body, holes)


def _cavities(data: Leg) -> Iterator[tuple[tuple[float, float], tuple]]:
    """The cavity in pieces between its ribs: where each begins and ends, and its sides there."""
    start, end = data.cavity
    at = [start, *(x for rib in data.ribs for x in (rib - data.wall / 2, rib + data.wall / 2)), end]
    for first, last in zip(at[::2], at[1::2], strict=True):
        shares = [(x - start) / (end - start) for x in (first, last)]
        sides = [
            tuple(a + share * (b - a) for a, b in zip(*data.inner, strict=True)) for share in shares
        ]
        yield (first, last), (sides[0], sides[1])


def _loft(occ: ModuleType, at: tuple[float, float], sides: tuple) -> int:
    """A ruled loft of two rectangles across x."""
    wires = []
    for x, (y, z) in zip(at, sides, strict=True):
        corners = [(-y, -z), (y, -z), (y, z), (-y, z)]
        points = [occ.addPoint(x, a / 2.0, b / 2.0) for a, b in corners]
        lines = [occ.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
        wires.append(occ.addWire(lines))
    return next(tag for dim, tag in occ.addThruSections(wires, makeRuled=True) if dim == 3)


def rocker(occ: ModuleType) -> None:
    """A flat triangular rocker of 60 mm with three bores along z: A, B and C."""
    corners = [(0.0, 0.0, 45.0, 22.0), (260.0, 0.0, 38.0, 16.0), (90.0, 180.0, 38.0, 16.0)]
    height = 60.0
    points = [occ.addPoint(x, y, -height / 2.0) for x, y, _, _ in corners]
    lines = [occ.addLine(points[i], points[(i + 1) % 3]) for i in range(3)]
    plate = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    web = next(tag for dim, tag in occ.extrude([(2, plate)], 0, 0, height) if dim == 3)
    eyes = [(3, occ.addCylinder(x, y, -height / 2, 0, 0, height, r)) for x, y, r, _ in corners]
    body, _ = occ.fuse([(3, web)], eyes)
    holes = [(3, occ.addCylinder(x, y, -height, 0, 0, 2 * height, r)) for x, y, _, r in corners]
    holes.append((3, occ.addCylinder(112.0, 58.0, -height, 0, 0, 2 * height, 28.0)))
    occ.cut(body, holes)


def write(path: Path, build: Callable[[ModuleType], None]) -> Path:
    """Write what `build` adds to an empty model as STEP in millimetres, without a date."""
    gmsh.initialize(["gmsh", "-v", "0"], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        build(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.model.removeEntities(gmsh.model.getEntities(2), recursive=False)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    text = re.sub(r"'\d{4}-\d\d-\d\dT[\d:]+'", "'2026-01-01T00:00:00'", path.read_text())
    path.write_text(text)
    return path


PARTS: dict[str, Callable[[ModuleType], None]] = {
    "tapered-biglide/leg1.step": lambda occ: leg(occ, LEG1),
    "tapered-biglide/leg2.step": lambda occ: leg(occ, LEG2),
    "rocker/rocker.step": rocker,
}


if __name__ == "__main__":
    for name, build in PARTS.items():
        write(HERE / name, build)
