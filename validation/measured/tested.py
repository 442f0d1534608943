"""Universal files (.uff, .unv) of modal tests, read in a process of its own: modes with shapes.

Mode shapes (dataset 55) are taken as they are. From frequency response functions (dataset 58) the
poles are found by LSCF and the mode constants by LSFD (sdypy-EMA). A pole counts where polynomials
of most orders have it, which is what the eye seeks on a stabilisation chart (Verboven, thesis, VUB
2002, 5.3); its scatter over the orders says how well it is known.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from fem.extras import require_extra
from lumped.arrays import Array, ComplexArray, IntArray
from lumped.errors import ComputationError, InputError
from lumped.files import read_ordinary
from meshes.processes import within_limits

SUFFIXES = (".uff", ".unv")
_KIND = "a universal file of a modal test"
_LARGEST = 100_000_000
# Of computing: two hundred functions take ten.
_SECONDS = 300.0
# Frequency response functions among functions; normal and complex modes among data at nodes.
_RESPONSE, _COHERENCE, _MODES = 4, 6, (2, 3, 7)
_ENDS = ("rsp_node", "rsp_dir", "ref_node", "ref_dir")
# Specific data types of motions, by how many derivatives each is off a velocity, of force, and of
# what is not named.
_DERIVATIVES, _FORCE, _ANY = {8: -1, 11: 0, 12: 1}, 13, (0, 1)
_GRAVITY = 9.80665
# Order of the highest polynomial, lines of a spectrum that it needs, and steps equal as printed.
_HIGHEST, _FEWEST_LINES, _AS_PRINTED = 40, 160, 1e-2
# Distance of poles that are one, of their size, share of the orders that must have it, and damping
# ratio above which a pole is none of a robot's modes.
_ALIKE, _MOST, _DAMPED = 0.003, 0.7, 0.3
Set: TypeAlias = dict[str, Any]


class TestedModes(NamedTuple):
    """Modes of a test: `poles` (m, 1/s) and `shapes` (k×m, real).

    `scatter` (2×m) is standard, of frequencies (Hz) and of damping ratios. Of each row of the
    shapes `freedoms` (k×2) are the node and its axis (0 to 2). The `receptance` (p×n, m/N) at
    `frequencies` (n, Hz) is that of each two such `ends` (p×2×2), what moves and what is struck;
    `coherence` (p×n) is NaN where the file has none.
    """

    poles: ComplexArray
    scatter: Array
    shapes: Array
    freedoms: IntArray
    frequencies: Array = np.zeros(0)
    receptance: ComplexArray = np.zeros((0, 0), dtype=complex)
    ends: IntArray = np.zeros((0, 2, 2), dtype=int)
    coherence: Array = np.zeros((0, 0))


def read_modes(path: Path) -> TestedModes:
    """The modes of a universal file, by frequency; raises InputError, one line."""
    require_extra("hammer", str(path))
    try:
        content = read_ordinary(path, _KIND, _LARGEST)
        if content.split()[-1:] != [b"-1"]:
            raise InputError(f"{path}: does not end with -1, is it cut off? must be {_KIND}")
        return within_limits(_SECONDS, _read, path)
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file; must be {_KIND}") from error
    except ComputationError as error:
        raise InputError(f"{path}: cannot be read ({error}); must be {_KIND}") from error


def _read(path: Path) -> TestedModes:
    from pyuff import UFF  # noqa: PLC0415  of the optional extra

    found = UFF(str(path)).read_sets()
    sets: list[Set] = [found] if isinstance(found, dict) else found
    if modes := [one for one in sets if one["type"] == 55 and one["analysis_type"] in _MODES]:
        return _as_given(path, modes)
    tested = [one for one in sets if one["type"] == 58 and one["func_type"] == _RESPONSE]
    if not tested:
        raise InputError(f"{path}: has neither frequency response functions nor mode shapes")
    units = [(one["length"], one["force"]) for one in sets if one["type"] == 164] or [(1.0, 1.0)]
    if min(units[0]) <= 0.0 or len(set(units)) > 1:
        raise InputError(
            f"{path}: units of length and force must be above 0, and must be the same in all of it"
        )
    coherent = [one for one in sets if one["type"] == 58 and one["func_type"] == _COHERENCE]
    return _identified(path, tested, coherent, *units[0])


def _as_given(path: Path, modes: Sequence[Set]) -> TestedModes:
    """What was identified elsewhere; what is zero in all modes was not measured."""
    for number, one in enumerate(modes, start=1):
        moves = one["spec_data_type"] in {*_DERIVATIVES, *_ANY}
        if not (moves and np.isfinite([one["r1"], one["r2"], one["r3"]]).all()):
            raise InputError(
                f"{path}: mode {number} must have finite displacements, velocities or accelerations"
            )
    poles = np.array([one["eig"] if "eig" in one else 2j * np.pi * one["freq"] for one in modes])
    elastic = [place for place in np.argsort(np.abs(poles)) if abs(poles[place]) > 0.0]
    nodes = sorted({int(node) for one in modes for node in one["node_nums"]})
    shapes = np.zeros((len(nodes), 3, len(modes)), dtype=complex)
    for number, one in enumerate(modes):
        rows = np.searchsorted(nodes, np.array(one["node_nums"], dtype=int))
        shapes[rows, :, number] = np.transpose([one["r1"], one["r2"], one["r3"]])
    seen = shapes.any(axis=2)
    freedoms = np.argwhere(seen)
    freedoms[:, 0] = np.array(nodes)[freedoms[:, 0]]
    return TestedModes(
        poles[elastic], np.zeros((2, len(elastic))), _real(shapes[seen][:, elastic]), freedoms
    )


def _identified(
    path: Path, tested: Sequence[Set], coherent: Sequence[Set], length: float, force: float
) -> TestedModes:
    """Of functions of one file, of which some are `coherent` by others.

    `length` and `force`: how many of its units are 1 m and 1 N.
    """
    frequencies = np.asarray(tested[0]["x"], dtype=float)
    steps = np.diff(frequencies)
    uneven = np.ptp([*steps, (frequencies[0] + 0.5 * steps[0]) % steps[0] + 0.5 * steps[0]])
    if len(steps) < _FEWEST_LINES or uneven > _AS_PRINTED * steps[0]:
        raise InputError(f"{path}: must have {_FEWEST_LINES} frequencies, multiples of one step")
    frequencies, rows = frequencies[(kept := frequencies > 0.0)], []
    for number, one in enumerate(tested, start=1):
        kind, values = one["ordinate_spec_data_type"], np.asarray(one["data"], dtype=complex)
        along = one["rsp_dir"], one["ref_dir"]
        by_force = kind in _DERIVATIVES and one["orddenom_spec_data_type"] == _FORCE
        whole = len(values) == one["num_pts"] == len(kept) and np.isfinite(values).all()
        sound = by_force and whole and {1, 2, 3}.issuperset(np.abs(along))
        if not (sound and np.allclose(one["x"][kept], frequencies)):
            raise InputError(
                f"{path}: function {number} must be a displacement, velocity or acceleration along "
                "x, y or z by a force along one, with finite values at the frequencies of the first"
            )
        in_g = one["ordinate_axis_units_lab"].strip().lower() == "g"
        to_si = force * (_GRAVITY if in_g else 1.0 / length)
        factor = np.sign(np.prod(along)) * to_si
        rows.append(factor * values[kept] * (2j * np.pi * frequencies) ** -_DERIVATIVES[kind])
    # What was held fixed is the place struck or, where the hammer wandered, the sensor: of several
    # each mode is read from the one where it answers most.
    ends = [
        [(int(one[f"{end}_node"]), abs(one[f"{end}_dir"]) - 1) for one in tested]
        for end in ("rsp", "ref")
    ]
    held, moved = sorted(ends, key=lambda end: len(set(end)))
    row_of = {pair: row for row, pair in enumerate(zip(held, moved, strict=True))}
    fixed = sorted(set(held))
    freedoms = [one for one in sorted(set(moved)) if all((end, one) in row_of for end in fixed)]
    if len(row_of) < len(tested):
        raise InputError(f"{path}: two functions are of the same motion by the same force")
    if not freedoms:
        raise InputError(f"{path}: no motion was measured with every place that was struck")
    unknown = np.full(len(kept), np.nan)
    known = {
        tuple(one[end] for end in _ENDS): np.real(one["data"])
        for one in coherent
        if len(one["data"]) == len(kept)
    }
    # Of the same extra; it loads matplotlib, for which files without functions need not wait.
    from sdypy.EMA import Model  # noqa: PLC0415

    band = {"lower": frequencies[0], "upper": frequencies[-1]}
    model = Model(np.array(rows), frequencies, pol_order_high=_HIGHEST, frf_form="mobility", **band)
    model.get_poles(show_progress=False)
    chosen, scatter = _stable(model.all_poles, 2.0 * np.pi * frequencies[[0, -1]])
    if not chosen:
        raise InputError(f"{path}: no mode can be told from its functions")
    model.pole_ind = [[_HIGHEST - 1, place] for place in chosen]
    # Without the last line, which sdypy-EMA drops.
    constants = model.get_constants(f_upper=model.freq[-1])[1]
    parts = np.array([constants[[row_of[end, one] for one in freedoms]] for end in fixed])
    strongest = np.linalg.norm(parts, axis=1).argmax(axis=0)
    shapes = parts[strongest, :, np.arange(len(chosen))].T
    return TestedModes(
        model.all_poles[-1][chosen],
        np.array(scatter).T,
        _real(shapes),
        np.array(freedoms),
        frequencies,
        np.array(rows) / (2j * np.pi * frequencies),
        np.stack(ends, axis=1),
        np.array([known.get(tuple(one[end] for end in _ENDS), unknown)[kept] for one in tested]),
    )


def _stable(poles: list[ComplexArray], band: Array) -> tuple[list[int], list[list[float]]]:
    """Places of the stable poles among those of the highest order, and their scatter."""
    orders = [one[(one.imag > 0.0) & (one.real < 0.0)] for one in poles[len(poles) // 2 :]]
    chosen: list[int] = []
    scatter = []
    for place in np.argsort(np.abs(poles[-1])):
        pole, size = poles[-1][place], abs(poles[-1][place])
        sound = pole.imag > 0.0 and 0.0 < -pole.real < _DAMPED * size and band[0] < size < band[1]
        if not sound or any(abs(pole - poles[-1][other]) < _ALIKE * size for other in chosen):
            continue
        nearest = np.array([one[np.argmin(np.abs(one - pole))] for one in orders if len(one)])
        alike = nearest[np.abs(nearest - pole) < _ALIKE * size]
        if len(alike) >= _MOST * len(orders):
            chosen.append(int(place))
            sizes = np.abs(alike)
            both = sizes / (2.0 * np.pi), alike.real / sizes
            scatter.append([float(np.std(one)) for one in both])
    return chosen, scatter


def _real(shapes: ComplexArray) -> Array:
    """Shapes (k×m) turned to where most of each is real."""
    turned = np.exp(-0.5j * np.angle(np.sum(np.square(shapes), axis=0)))
    return np.asarray((shapes * turned).real)
