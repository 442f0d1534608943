"""Modes and frequency responses from a universal file (.uff, .unv) of a modal test.

Input: the file, which is read in a separate process. Output: `TestedModes`. Rule: mode shapes
(dataset 55) are used unchanged. From frequency response functions (dataset 58), poles are
identified by LSCF and residues by LSFD (sdypy-EMA). A pole is accepted if it is stable over most
polynomial orders, as in a stabilisation chart (Verboven, thesis, VUB 2002, 5.3); its scatter over
the orders is its uncertainty.
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
_FILE_KIND = "a universal file of a modal test"
_LARGEST_SIZE = 100_000_000
# Limit on computing time (s). Two hundred functions take ten seconds.
_SECONDS = 300.0
# Codes of the file format: frequency response function, coherence; normal and complex modes.
_RESPONSE, _COHERENCE, _MODES = 4, 6, (2, 3, 7)
_ENDS = ("rsp_node", "rsp_dir", "ref_node", "ref_dir")
# Codes of data types: motions with the number of time derivatives of velocity; force; unspecified.
_DERIVATIVES, _FORCE, _UNSPECIFIED = {8: -1, 11: 0, 12: 1}, 13, (0, 1)
_GRAVITY = 9.80665
# Line that begins and ends a data set.
_END_WITH_BLANKS = re.compile(rb"^(    -1)[ \t]+(?=\r?$)", re.MULTILINE)
# Highest polynomial order; lowest value to which it may be reduced; smallest number of lines of a
# spectrum; largest deviation of printed frequencies from multiples of a step (in steps).
_HIGHEST_ORDER, _FEWEST_ORDERS, _FEWEST_LINES, _STEP_TOLERANCE = 40, 4, 160, 1e-2
# Largest relative distance of equal poles; smallest share of the orders that must have a pole;
# largest damping ratio of a robot's mode.
_POLE_DISTANCE, _SHARE_OF_ORDERS, _LARGEST_RATIO = 0.003, 0.7, 0.3
DataSet: TypeAlias = dict[str, Any]


class TestedModes(NamedTuple):
    """Modes and frequency responses of a modal test.

    `poles` (q, in 1/s) and `shapes` (k×q, real) of q modes. `scatter` (2×q): standard deviations of
    frequencies (Hz) and of damping ratios. `freedoms` (k×2): node and axis (0 to 2) of each row of
    the shapes. `receptance` (p×n, m/N) at `frequencies` (n, Hz), for p pairs of `ends` (p×2×2):
    node and axis of the motion, then of the force. `coherence` (p×n): NaN if the file has none.
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
    """Modes in a universal file, by ascending frequency.

    Raises InputError with one line if the file has none.
    """
    require_extra("hammer", str(path))
    try:
        content = read_ordinary(path, _FILE_KIND, _LARGEST_SIZE)
        if content.split()[-1:] != [b"-1"]:
            raise InputError(
                f"{path}: does not end with -1, so that the file may be truncated; must be "
                f"{_FILE_KIND}"
            )
        return within_limits(_SECONDS, _modes_of_file, path)
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file; must be {_FILE_KIND}") from error
    except ComputationError as error:
        raise InputError(f"{path}: cannot be read ({error}); must be {_FILE_KIND}") from error


def _modes_of_file(path: Path) -> TestedModes:
    from pyuff import UFF  # noqa: PLC0415  of the optional extra

    content = _data_sets(path, UFF)
    sets: list[DataSet] = [content] if isinstance(content, dict) else content
    modes = [
        dataset for dataset in sets if dataset["type"] == 55 and dataset["analysis_type"] in _MODES
    ]
    tested = [
        dataset for dataset in sets if dataset["type"] == 58 and dataset["func_type"] == _RESPONSE
    ]
    if modes and not tested:
        return _given_modes(path, modes)
    if not tested:
        raise InputError(f"{path}: has neither frequency response functions nor mode shapes")
    units = [
        (dataset["length"], dataset["force"]) for dataset in sets if dataset["type"] == 164
    ] or [(1.0, 1.0)]
    if min(units[0]) <= 0.0 or len(set(units)) > 1:
        raise InputError(
            f"{path}: units of length and force must be above 0 and the same in the whole file"
        )
    coherent = [
        dataset for dataset in sets if dataset["type"] == 58 and dataset["func_type"] == _COHERENCE
    ]
    functions = _functions(path, tested, coherent, *units[0])
    if not modes:
        return _identified_modes(path, functions)
    return _given_modes(path, modes)._replace(
        frequencies=functions.frequencies,
        receptance=functions.receptance,
        ends=functions.ends,
        coherence=functions.coherence,
    )


def _data_sets(path: Path, uff: Any) -> DataSet | list[DataSet]:
    """Data sets of a universal file.

    Blanks after "-1", which ends a data set, are removed because pyuff does not accept them.
    """
    content = path.read_bytes()
    plain = _END_WITH_BLANKS.sub(rb"\1", content)
    if plain == content:
        return cast("DataSet | list[DataSet]", uff(str(path)).read_sets())
    with NamedTemporaryFile(suffix=path.suffix) as file:
        file.write(plain)
        file.flush()
        return cast("DataSet | list[DataSet]", uff(file.name).read_sets())


def _given_modes(path: Path, modes: Sequence[DataSet]) -> TestedModes:
    """Modes that another program has identified and written to the file.

    A degree of freedom that is zero in all modes counts as not measured.
    """
    for number, mode in enumerate(modes, start=1):
        if not np.isfinite(_pole(mode)):
            raise InputError(f"{path}: mode {number} must have a finite frequency")
        moves = mode["spec_data_type"] in {*_DERIVATIVES, *_UNSPECIFIED}
        if not (moves and np.isfinite([mode["r1"], mode["r2"], mode["r3"]]).all()):
            raise InputError(
                f"{path}: mode {number} must have finite displacements, velocities or accelerations"
            )
    poles = np.array([_pole(mode) for mode in modes])
    elastic = [index for index in np.argsort(np.abs(poles)) if abs(poles[index]) > 0.0]
    nodes = sorted({int(node) for mode in modes for node in mode["node_nums"]})
    shapes = np.zeros((len(nodes), 3, len(modes)), dtype=complex)
    for number, mode in enumerate(modes):
        rows = np.searchsorted(nodes, np.array(mode["node_nums"], dtype=int))
        shapes[rows, :, number] = np.transpose([mode["r1"], mode["r2"], mode["r3"]])
    measured = shapes.any(axis=2)
    freedoms = np.argwhere(measured)
    freedoms[:, 0] = np.array(nodes)[freedoms[:, 0]]
    return TestedModes(
        poles[elastic],
        np.zeros((2, len(elastic))),
        _real_shapes(shapes[measured][:, elastic]),
        freedoms,
    )


def _pole(mode: DataSet) -> complex:
    """Pole (1/s) of a mode: that in the file, otherwise from frequency and damping ratio."""
    if "eig" in mode:
        return complex(mode["eig"])
    ratio = float(mode.get("modal_damp_vis", 0.0))
    ratio = ratio if 0.0 <= ratio < 1.0 else 0.0
    return complex(2.0 * np.pi * mode["freq"] * complex(-ratio, np.sqrt(1.0 - ratio**2)))


class _Functions(NamedTuple):
    """Frequency response functions: `mobility` (p×n, m/(s N)) at multiples of one step.

    `frequencies` (n, Hz). `ends` (p×2×2) and `coherence` (p×n) as in `TestedModes`. `before`:
    number of lines between 0 Hz and the first frequency.
    """

    frequencies: Array
    mobility: ComplexArray
    ends: IntArray
    coherence: Array
    before: int

    @property
    def receptance(self) -> ComplexArray:
        return np.asarray(self.mobility / (2j * np.pi * self.frequencies))


def _exact_frequencies(path: Path, printed: Array) -> tuple[Array, int]:
    """Frequencies (n, Hz) as exact multiples of one step, and the number of steps to the first.

    Frequencies in files are rounded: the first can be 51.00006 times the step.
    """
    steps = np.diff(printed)
    wrong = InputError(f"{path}: must have {_FEWEST_LINES} frequencies, multiples of one step")
    if len(steps) < _FEWEST_LINES or not (np.isfinite(printed).all() and steps[0] > 0.0):
        raise wrong
    first = round(float(printed[0] / steps[0]))
    step = float(printed[-1]) / (first + len(steps))
    frequencies: Array = step * np.arange(first, first + len(printed), dtype=float)
    if not np.abs(printed - frequencies).max() <= _STEP_TOLERANCE * step:
        raise wrong
    return frequencies, first


def _functions(
    path: Path, tested: Sequence[DataSet], coherent: Sequence[DataSet], length: float, force: float
) -> _Functions:
    """Frequency response functions of one file, with their coherence from the `coherent` data sets.

    `length` and `force`: number of the file's units of length in 1 m, and of force in 1 N.
    """
    frequencies, first = _exact_frequencies(path, np.asarray(tested[0]["x"], dtype=float))
    frequencies, rows = frequencies[(positive := frequencies > 0.0)], []
    for number, function in enumerate(tested, start=1):
        kind, values = (
            function["ordinate_spec_data_type"],
            np.asarray(function["data"], dtype=complex),
        )
        along = function["rsp_dir"], function["ref_dir"]
        by_force = kind in _DERIVATIVES and function["orddenom_spec_data_type"] == _FORCE
        complete = len(values) == function["num_pts"] == len(positive) and np.isfinite(values).all()
        sound = by_force and complete and {1, 2, 3}.issuperset(np.abs(along))
        if not (
            sound
            and np.allclose(
                function["x"][positive], frequencies, atol=_STEP_TOLERANCE * frequencies[0]
            )
        ):
            raise InputError(
                f"{path}: function {number} must be displacement, velocity or "
                "acceleration along x, y or z per force along x, y or z, with finite "
                "values at the frequencies of the first function"
            )
        in_g = function["ordinate_axis_units_lab"].strip().lower() == "g"
        to_si = force * (_GRAVITY if in_g else 1.0 / length)
        factor = np.sign(np.prod(along)) * to_si
        rows.append(factor * values[positive] * (2j * np.pi * frequencies) ** -_DERIVATIVES[kind])
    ends = [
        [(int(function[f"{end}_node"]), abs(function[f"{end}_dir"]) - 1) for end in ("rsp", "ref")]
        for function in tested
    ]
    missing = np.full(len(positive), np.nan)
    coherence_by_ends = {
        tuple(function[end] for end in _ENDS): np.real(function["data"])
        for function in coherent
        if len(function["data"]) == len(positive)
    }
    coherence = [
        coherence_by_ends.get(tuple(function[end] for end in _ENDS), missing)[positive]
        for function in tested
    ]
    return _Functions(
        frequencies, np.array(rows), np.array(ends), np.array(coherence), max(first, 1)
    )


def _identified_modes(path: Path, functions: _Functions) -> TestedModes:
    """Modes identified from the frequency response functions of one file."""
    frequencies, rows, count = functions.frequencies, functions.mobility, len(functions.mobility)
    # The fixed end is the point of the force or, with a roving hammer, the sensor. If there are
    # several fixed ends, each mode is read from that with the largest response.
    ends = [[(int(node), int(axis)) for node, axis in end] for end in functions.ends.swapaxes(0, 1)]
    fixed_ends, varied_ends = sorted(ends, key=lambda end: len(set(end)))
    row_of = {pair: row for row, pair in enumerate(zip(fixed_ends, varied_ends, strict=True))}
    fixed = sorted(set(fixed_ends))
    freedoms = [
        freedom
        for freedom in sorted(set(varied_ends))
        if all((end, freedom) in row_of for end in fixed)
    ]
    if len(row_of) < count:
        raise InputError(
            f"{path}: two functions have the same response and force coordinates; leave one out"
        )
    if not freedoms:
        raise InputError(f"{path}: no response point was measured for all excitation points")
    # Lines start at 0 Hz, with zeros where nothing was measured: sdypy-EMA would add missing lines
    # itself, but can round their number up by one.
    lines = np.hstack([np.zeros((count, functions.before)), rows])
    all_frequencies = frequencies[0] / functions.before * np.arange(lines.shape[1])
    model, highest = _with_poles(path, lines, all_frequencies, (frequencies[0], frequencies[-1]))
    stable, scatter = _stable_poles(model.all_poles, 2.0 * np.pi * frequencies[[0, -1]])
    if not stable:
        raise InputError(f"{path}: no mode can be identified from the frequency response functions")
    model.pole_ind = [[highest - 1, index] for index in stable]
    # Excludes the last line, which sdypy-EMA drops.
    constants = model.get_constants(f_upper=model.freq[-1])[1]
    parts = np.array([constants[[row_of[end, freedom] for freedom in freedoms]] for end in fixed])
    strongest = np.linalg.norm(parts, axis=1).argmax(axis=0)
    shapes = parts[strongest, :, np.arange(len(stable))].T
    return TestedModes(
        model.all_poles[-1][stable],
        np.array(scatter).T,
        _real_shapes(shapes),
        np.array(freedoms),
        frequencies,
        functions.receptance,
        functions.ends,
        functions.coherence,
    )


def _with_poles(
    path: Path, functions: Array, frequencies: Array, band: tuple[float, float]
) -> tuple[Any, int]:
    """Model of sdypy-EMA with the poles of all polynomial orders, and the highest order.

    `functions` (p×n): mobilities at n `frequencies` (Hz). `band`: lowest and highest frequency (Hz)
    of the poles. Measurements without noise leave the equations of high orders singular, on some
    processors exactly. The highest order is the last one with regular equations. Raises InputError
    if it is below `_FEWEST_ORDERS`.
    """
    # Imported here because it loads matplotlib, which files without functions do not need.
    from sdypy.EMA import Model  # noqa: PLC0415

    highest = _HIGHEST_ORDER
    while True:
        options = {"lower": band[0], "upper": band[1], "pol_order_high": highest}
        model = Model(functions, frequencies, frf_form="mobility", **options)
        try:
            model.get_poles(show_progress=False)
        except np.linalg.LinAlgError:
            highest = len(model.all_poles)
            if highest < _FEWEST_ORDERS:
                raise InputError(
                    f"{path}: no mode can be identified from the frequency response functions"
                ) from None
        else:
            return model, highest


def _stable_poles(poles: list[ComplexArray], band: Array) -> tuple[list[int], list[list[float]]]:
    """Indices of stable poles among those of the highest order, and their scatter.

    `poles` (1/s): those of each polynomial order. `band` (2, rad/s): lowest and highest accepted
    frequency. A pole is stable if it recurs at most of the high orders. Scatter: standard
    deviations of frequency (Hz) and damping ratio over these orders.
    """
    upper_half = poles[len(poles) // 2 :]
    orders = [of_order[(of_order.imag > 0.0) & (of_order.real < 0.0)] for of_order in upper_half]
    stable: list[int] = []
    scatter = []
    for index in np.argsort(np.abs(poles[-1])):
        pole, size = poles[-1][index], abs(poles[-1][index])
        sound = (
            pole.imag > 0.0
            and 0.0 < -pole.real < _LARGEST_RATIO * size
            and band[0] < size < band[1]
        )
        if not sound or any(
            abs(pole - poles[-1][other]) < _POLE_DISTANCE * size for other in stable
        ):
            continue
        nearest = np.array(
            [order[np.argmin(np.abs(order - pole))] for order in orders if len(order)]
        )
        matching = nearest[np.abs(nearest - pole) < _POLE_DISTANCE * size]
        if len(matching) >= _SHARE_OF_ORDERS * len(orders):
            stable.append(int(index))
            sizes = np.abs(matching)
            scattered = sizes / (2.0 * np.pi), matching.real / sizes
            scatter.append([float(np.std(values)) for values in scattered])
    return stable, scatter


def _real_shapes(shapes: ComplexArray) -> Array:
    """Real parts of m mode shapes (k×m), each in the phase in which its real part is largest."""
    turned = np.exp(-0.5j * np.angle(np.sum(np.square(shapes), axis=0)))
    return np.asarray((shapes * turned).real)
