"""Universal files (.uff, .unv) of modal tests, read in a process of its own: modes with shapes.

Mode shapes (dataset 55) are taken as they are. From frequency response functions (dataset 58) the
poles are found by LSCF and the mode constants by LSFD (sdypy-EMA). A pole counts where polynomials
of most orders have it, which is what the eye seeks on a stabilisation chart (Verboven, thesis, VUB
2002, 5.3); its scatter over the orders says how well it is known.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any, NamedTuple, TypeAlias, cast

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
# The line that begins and ends a data set.
_END_WITH_BLANKS = re.compile(rb"^(    -1)[ \t]+(?=\r?$)", re.MULTILINE)
# Order of the highest polynomial, lines of a spectrum that it needs, and steps equal as printed.
_HIGHEST, _FEWEST_ORDERS, _FEWEST_LINES, _AS_PRINTED = 40, 4, 160, 1e-2
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

    found = _sets(path, UFF)
    sets: list[Set] = [found] if isinstance(found, dict) else found
    modes = [one for one in sets if one["type"] == 55 and one["analysis_type"] in _MODES]
    tested = [one for one in sets if one["type"] == 58 and one["func_type"] == _RESPONSE]
    if modes and not tested:
        return _as_given(path, modes)
    if not tested:
        raise InputError(f"{path}: has neither frequency response functions nor mode shapes")
    units = [(one["length"], one["force"]) for one in sets if one["type"] == 164] or [(1.0, 1.0)]
    if min(units[0]) <= 0.0 or len(set(units)) > 1:
        raise InputError(
            f"{path}: units of length and force must be above 0, and must be the same in all of it"
        )
    coherent = [one for one in sets if one["type"] == 58 and one["func_type"] == _COHERENCE]
    functions = _functions(path, tested, coherent, *units[0])
    if not modes:
        return _identified(path, functions)
    return _as_given(path, modes)._replace(
        frequencies=functions.frequencies,
        receptance=functions.receptance,
        ends=functions.ends,
        coherence=functions.coherence,
    )


def _sets(path: Path, uff: Any) -> Set | list[Set]:
    """The data sets of a file; pyuff takes -1 with blanks behind for no end of a set."""
    content = path.read_bytes()
    plain = _END_WITH_BLANKS.sub(rb"\1", content)
    if plain == content:
        return cast("Set | list[Set]", uff(str(path)).read_sets())
    with NamedTemporaryFile(suffix=path.suffix) as file:
        file.write(plain)
        file.flush()
        return cast("Set | list[Set]", uff(file.name).read_sets())


def _as_given(path: Path, modes: Sequence[Set]) -> TestedModes:
    """What was identified elsewhere; what is zero in all modes was not measured."""
    for number, one in enumerate(modes, start=1):
        if not np.isfinite(_pole(one)):
            raise InputError(f"{path}: mode {number} must have a finite frequency")
        moves = one["spec_data_type"] in {*_DERIVATIVES, *_ANY}
        if not (moves and np.isfinite([one["r1"], one["r2"], one["r3"]]).all()):
            raise InputError(
                f"{path}: mode {number} must have finite displacements, velocities or accelerations"
            )
    poles = np.array([_pole(one) for one in modes])
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


def _pole(mode: Set) -> complex:
    """Pole (1/s) of a mode: as given, else by its frequency and viscous damping ratio."""
    if "eig" in mode:
        return complex(mode["eig"])
    ratio = float(mode.get("modal_damp_vis", 0.0))
    ratio = ratio if 0.0 <= ratio < 1.0 else 0.0
    return complex(2.0 * np.pi * mode["freq"] * complex(-ratio, np.sqrt(1.0 - ratio**2)))


class _Functions(NamedTuple):
    """Frequency response functions: `mobility` (p×n, m/(s N)) at multiples of one step.

    `before`: how many lines of 0 Hz and above lie below the first of the `frequencies` (n, Hz).
    """

    frequencies: Array
    mobility: ComplexArray
    ends: IntArray
    coherence: Array
    before: int

    @property
    def receptance(self) -> ComplexArray:
        return np.asarray(self.mobility / (2j * np.pi * self.frequencies))


def _multiples(path: Path, printed: Array) -> tuple[Array, int]:
    """Frequencies (Hz) as exact multiples of one step, and the number of the first.

    As they are printed the first one is no whole number of steps: 51.00006 of them, say.
    """
    steps = np.diff(printed)
    wrong = InputError(f"{path}: must have {_FEWEST_LINES} frequencies, multiples of one step")
    if len(steps) < _FEWEST_LINES or not (np.isfinite(printed).all() and steps[0] > 0.0):
        raise wrong
    first = round(float(printed[0] / steps[0]))
    step = float(printed[-1]) / (first + len(steps))
    frequencies: Array = step * np.arange(first, first + len(printed), dtype=float)
    if not np.abs(printed - frequencies).max() <= _AS_PRINTED * step:
        raise wrong
    return frequencies, first


def _functions(
    path: Path, tested: Sequence[Set], coherent: Sequence[Set], length: float, force: float
) -> _Functions:
    """The functions of one file, of which some are `coherent` by others.

    `length` and `force`: how many of its units are 1 m and 1 N.
    """
    frequencies, first = _multiples(path, np.asarray(tested[0]["x"], dtype=float))
    frequencies, rows = frequencies[(kept := frequencies > 0.0)], []
    for number, one in enumerate(tested, start=1):
        kind, values = one["ordinate_spec_data_type"], np.asarray(one["data"], dtype=complex)
        along = one["rsp_dir"], one["ref_dir"]
        by_force = kind in _DERIVATIVES and one["orddenom_spec_data_type"] == _FORCE
        whole = len(values) == one["num_pts"] == len(kept) and np.isfinite(values).all()
        sound = by_force and whole and {1, 2, 3}.issuperset(np.abs(along))
        if not (
            sound and np.allclose(one["x"][kept], frequencies, atol=_AS_PRINTED * frequencies[0])
        ):
            raise InputError(
                f"{path}: function {number} must be a displacement, velocity or acceleration along "
                "x, y or z by a force along one, with finite values at the frequencies of the first"
            )
        in_g = one["ordinate_axis_units_lab"].strip().lower() == "g"
        to_si = force * (_GRAVITY if in_g else 1.0 / length)
        factor = np.sign(np.prod(along)) * to_si
        rows.append(factor * values[kept] * (2j * np.pi * frequencies) ** -_DERIVATIVES[kind])
    ends = [
        [(int(one[f"{end}_node"]), abs(one[f"{end}_dir"]) - 1) for end in ("rsp", "ref")]
        for one in tested
    ]
    unknown = np.full(len(kept), np.nan)
    known = {
        tuple(one[end] for end in _ENDS): np.real(one["data"])
        for one in coherent
        if len(one["data"]) == len(kept)
    }
    coherence = [known.get(tuple(one[end] for end in _ENDS), unknown)[kept] for one in tested]
    return _Functions(
        frequencies, np.array(rows), np.array(ends), np.array(coherence), max(first, 1)
    )


def _identified(path: Path, functions: _Functions) -> TestedModes:
    """The modes of the functions of one file."""
    frequencies, rows, count = functions.frequencies, functions.mobility, len(functions.mobility)
    # What was held fixed is the place struck or, where the hammer wandered, the sensor: of several
    # each mode is read from the one where it answers most.
    ends = [[(int(node), int(axis)) for node, axis in end] for end in functions.ends.swapaxes(0, 1)]
    held, moved = sorted(ends, key=lambda end: len(set(end)))
    row_of = {pair: row for row, pair in enumerate(zip(held, moved, strict=True))}
    fixed = sorted(set(held))
    freedoms = [one for one in sorted(set(moved)) if all((end, one) in row_of for end in fixed)]
    if len(row_of) < count:
        raise InputError(f"{path}: two functions are of the same motion by the same force")
    if not freedoms:
        raise InputError(f"{path}: no motion was measured with every place that was struck")
    # From 0 Hz on, where nothing was measured zero: sdypy-EMA counts the lines that are missing by
    # rounding up, one too many.
    lines = np.hstack([np.zeros((count, functions.before)), rows])
    whole = frequencies[0] / functions.before * np.arange(lines.shape[1])
    model, highest = _with_poles(path, lines, whole, (frequencies[0], frequencies[-1]))
    chosen, scatter = _stable(model.all_poles, 2.0 * np.pi * frequencies[[0, -1]])
    if not chosen:
        raise InputError(f"{path}: no mode can be told from its functions")
    model.pole_ind = [[highest - 1, place] for place in chosen]
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
        functions.receptance,
        functions.ends,
        functions.coherence,
    )


def _with_poles(
    path: Path, functions: Array, frequencies: Array, band: tuple[float, float]
) -> tuple[Any, int]:
    """Model with poles of all polynomial orders, and the highest order.

    Functions without noise leave no information for high orders, whose equations are then singular,
    on some processors exactly. The highest order is the last one before that. Raises InputError if
    it is below `_FEWEST_ORDERS`.
    """
    # Of the same extra; it loads matplotlib, for which files without functions need not wait.
    from sdypy.EMA import Model  # noqa: PLC0415

    highest = _HIGHEST
    while True:
        options = {"lower": band[0], "upper": band[1], "pol_order_high": highest}
        model = Model(functions, frequencies, frf_form="mobility", **options)
        try:
            model.get_poles(show_progress=False)
        except np.linalg.LinAlgError:
            highest = len(model.all_poles)
            if highest < _FEWEST_ORDERS:
                raise InputError(f"{path}: no mode can be told from its functions") from None
        else:
            return model, highest


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
