"""Half-widths of a solved model: second mesh of prisms, three meshes of CAD parts, printed digits.

Input: a `SolvedQuestion`. Output: half-widths in each pose, and values extrapolated from at least
four meshes that show an order of convergence. Rule: changes between meshes and changes by digits
make half-widths as in the budgets of references (`validation.references`). Modes of two meshes are
paired by shape.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import cbrt, sqrt
from typing import TypeVar

import numpy as np

from fem.reduction.craig_bampton import frequency_bounds
from lumped.arrays import Array
from lumped.equivalent_leg import sectioned_leg
from lumped.errors import InputError
from lumped.legs import Leg
from lumped.sections import Rectangle, Section
from lumped.system.assembly import assembly
from meshes.section.section_blocks import element_count
from validation.models.options import ModelOptions
from validation.models.reduced_parts import ReducedPart, has_specified_couplings
from validation.parts.meshes import LEVELS
from validation.references.mesh_uncertainty import MeshRow, mesh_frequency_changes
from validation.references.reference_parts import UNKNOWN, part_policy
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import Reading
from validation.references.uncertainty_sources import Perturbations, rounded_readings
from validation.responses.mode_partners import partners
from validation.responses.statics_and_modes import PathModes, Statics
from validation.solids.solid_legs import GRIDS_FOR_ORDER, ROUND_OFF, formal_order, section_of
from validation.solve.answer import HalfWidths, MeshUncertainty, PartUncertainty
from validation.solve.question import Question
from validation.solve.solved_model import SolvedModes, SolvedStatics, digits_model, solved_model
from validation.uncertainty.combiners import Combiner, relative_sizes
from validation.uncertainty.grid_convergence import richardson_limits
from validation.uncertainty.mesh_half_widths import MeshPolicy

H = TypeVar("H")
# Smallest ratio of element sizes of both meshes. Walls with one element across keep one, so that
# half the divisions give a ratio of only 1.2 (tubes) or 1.3.
_RATIO = 1.2


@dataclass(frozen=True, eq=False)
class SolvedQuestion:
    """A question with the `model` that answers it, solved under `reading`.

    `legs`: prisms of the answer, equal ones once. `second`: divisions of the second mesh of prisms,
    None without one.
    """

    question: Question
    responses: Responses
    model: Model
    reading: Reading
    legs: Sequence[Leg] = ()
    second: int | None = None

    @property
    def statics(self) -> SolvedStatics | None:
        """Statics in all poses. None for a free body."""
        statics = self.responses.statics(self.model, self.reading)
        return statics if isinstance(statics, SolvedStatics) else None

    @property
    def modes(self) -> PathModes | None:
        """Modes in all poses. None if none are requested or nothing has mass."""
        return self.responses.known_modes(self.model, self.reading)

    @property
    def count(self) -> int:
        """Number of solved modes."""
        return 0 if self.modes is None else self.modes.frequencies.shape[1]

    @property
    def loads(self) -> list[str]:
        """Names of the loads under which displacements are solved."""
        if self.question.alone is not None:
            return []
        return [load.name for load in self.question.mechanism.loads]

    def on_divisions(self, divisions: int) -> tuple[Statics, Array]:
        """Statics on another mesh of prisms, and the frequencies (P×m) of modes of equal shape."""
        given = {**self.question.given, "divisions": divisions}
        model = solved_model(replace(self.question, given=given))
        statics = self.responses.required_statics(model, self.reading)
        if self.modes is None:
            return statics, np.zeros((len(statics.compliances), 0))
        modes = self.responses.required_modes(model, self.reading)
        return statics, partners(self.modes, modes, self.count).frequency

    def split(self, compliance: Array, loads: Array, frequencies: Array) -> list[HalfWidths]:
        """Half-widths of each pose, from those of all poses (P×6, P×6L and P×m)."""
        displacements = loads.reshape(len(loads), -1, 6)
        return [
            HalfWidths(*of_pose, loads=dict(zip(self.loads, by_load, strict=True)))
            for *of_pose, by_load in zip(compliance, frequencies, displacements, strict=True)
        ]


def with_model(question: Question, responses: Responses, legs: Sequence[Leg]) -> SolvedQuestion:
    """Question with its model. Solids have a second mesh."""
    second = None
    if question.model == "solid" and legs:
        second = second_divisions(question.options, legs)
    reading = Reading(dict.fromkeys(question.mechanism.parts, "rigid"))
    return SolvedQuestion(
        question, responses, solved_model(question, second), reading, legs, second
    )


def diagonals(statics: Statics) -> Array:
    """Compliance (P×6, SI) along and about each axis.

    Shapes: P poses.
    """
    return np.diagonal(statics.compliances, axis1=1, axis2=2)


def _displacements(statics: Statics) -> Array:
    """Displacements (P×6L) under all loads.

    Shapes: P poses, L loads.
    """
    return statics.load_displacements.reshape(len(statics.load_displacements), -1)


def _lengths(displacements: Array) -> Array:
    """Lengths of translations and of rotations (P×6L), repeated for each of their components.

    Shapes: P poses, L loads.
    """
    sizes = np.linalg.norm(displacements.reshape(len(displacements), -1, 3), axis=2)
    return np.repeat(sizes, 3, axis=1)


def _half_widths(solved: SolvedQuestion, row: MeshRow) -> list[HalfWidths]:
    """Half-widths of compliance, frequencies and displacements due to one kind of mesh."""
    responses, reading = solved.responses, solved.reading
    statics, modes = solved.statics, solved.modes

    def of_statics(numbers: Callable[[Statics], Array], scale: Array) -> Array:
        def change(first: Statics, second: Statics, _: Statics) -> Array:
            return relative_sizes(numbers(first) - numbers(second), scale)

        solve = responses.required_statics
        return _absolute(row.half_widths(responses, reading, solve, change), scale)

    poses = len(responses.robot.postures)
    compliance, loads, frequencies = np.zeros((3, poses, 0))
    if statics is not None:
        compliance = of_statics(diagonals, np.abs(diagonals(statics)))
        loads = of_statics(_displacements, _lengths(_displacements(statics)))
    if modes is not None:
        own = modes

        def change(first: PathModes, second: PathModes, _: PathModes) -> Array:
            return mesh_frequency_changes(first, second, own, solved.count)

        shares = row.half_widths(responses, reading, responses.required_modes, change)
        frequencies = _absolute(shares, own.frequencies)
    return solved.split(compliance, loads, frequencies)


def _absolute(shares: Array, scale: Array) -> Array:
    """Half-widths from those relative to a scale. Infinite if unknown."""
    unknown = np.isnan(shares) | np.equal(shares, UNKNOWN)
    return np.where(unknown & np.isfinite(scale), np.inf, shares * scale)


def of_prisms(solved: SolvedQuestion, *, affordable: bool) -> list[MeshUncertainty]:
    """Half-widths due to the mesh of prisms in each pose, from the change to the second mesh.

    The change times Roache's factor, with r³ the ratio of the element counts (Celik et al., J.
    Fluids Eng. 130 (2008) 078001). Infinite if the second mesh is not `affordable`.
    """
    options, divisions = solved.question.options, solved.second
    assert divisions is not None  # noqa: S101  asked for solids only
    policy = mesh_policy(options, solved.legs, divisions) if affordable else UNKNOWN
    levels = (0, 1) if divisions < options.divisions else (1, 0)
    row = MeshRow("mesh", levels, lambda _: policy, lambda _: solved.model)
    return [
        MeshUncertainty(widths.compliance, widths.frequencies, divisions, loads=widths.loads)
        for widths in _half_widths(solved, row)
    ]


def of_parts(solved: SolvedQuestion) -> list[PartUncertainty]:
    """Half-widths due to CAD parts in each pose: meshes, couplings and reduction."""
    responses, modes = solved.responses, solved.modes
    robot, mechanism = responses.robot, solved.question.mechanism
    row = MeshRow("part_mesh", LEVELS, lambda at: part_policy(at.mechanism), lambda _: solved.model)
    postures = modes.postures if isinstance(modes, SolvedModes) else ()
    bodies = postures[0].system.models if postures else {}
    solids = {name: body for name, body in bodies.items() if isinstance(body, ReducedPart)}
    bounds = np.zeros((len(robot.postures), 0))
    if postures:
        prepared = assembly(mechanism, bodies)
        systems = [prepared.at(posture) for posture in robot.postures]
        by_pose = [frequency_bounds(system, solids, solved.count) for system in systems]
        bounds = np.array([bound.upper - bound.lower for bound in by_pose])
    return [
        PartUncertainty(
            widths.compliance,
            widths.frequencies,
            loads=widths.loads,
            bracket=bracket,
            reduction=bound,
            counted={name: (part.counted, part.cutoff) for name, part in solids.items()},
            by=solved.question.options.reduction,
        )
        for widths, bracket, bound in zip(
            _half_widths(solved, row), _brackets(solved), bounds, strict=True
        )
    ]


def _brackets(solved: SolvedQuestion) -> list[HalfWidths]:
    """Changes from rigid to averaged interfaces in each pose.

    Zero if the robot file specifies all couplings.
    """
    parts, statics, modes = solved.question.mechanism.parts, solved.statics, solved.modes
    reading = replace(solved.reading, ends=dict.fromkeys(parts, "free"))
    if all(has_specified_couplings(body) for body in parts.values()):
        reading = solved.reading
    assert statics is not None  # noqa: S101  a robot has statics
    change = solved.responses.required_statics(solved.model, reading) - statics
    frequencies = np.zeros((len(statics.compliances), 0))
    if modes is not None:
        averaged = solved.responses.required_modes(solved.model, reading)
        frequencies = partners(modes, averaged, solved.count).frequency - modes.frequencies
    return solved.split(diagonals(change), _displacements(change), frequencies)


def of_digits(solved: SolvedQuestion) -> list[HalfWidths] | None:
    """Half-widths due to the printed digits of the file's 6×6 in each pose. None if they are zero.

    Compliances: 95 % quantile of the change by independent digits, as for references. Frequencies:
    sum over all digits, an upper bound.
    """
    responses, reading = solved.responses, solved.reading
    if not responses.robot.roundings:
        return None
    model = digits_model(solved.question, solved.count)

    def shares(
        solve: Callable[[Model, Reading], H], numbers: Callable[[H], Array], combiner: Combiner
    ) -> Array:
        nominal = numbers(solve(model, reading))
        return Perturbations(model, rounded_readings, combiner).half_widths(
            responses.robot,
            reading,
            solve,
            numbers,
            lambda changes: relative_sizes(changes, nominal),
        )

    poses = len(responses.robot.postures)
    compliance, frequencies = np.zeros((2, poses, 0))
    if (statics := solved.statics) is not None:
        compliance = shares(responses.required_statics, diagonals, Combiner.PROBABILITY)
        compliance = compliance * np.abs(diagonals(statics))
    if (modes := solved.modes) is not None:
        frequencies = shares(responses.required_modes, _finite_frequencies, Combiner.LINEAR_SUM)
        frequencies = np.nan_to_num(frequencies * modes.frequencies)
    if not (compliance.any() or frequencies.any()):
        return None
    return [HalfWidths(*of_pose) for of_pose in zip(compliance, frequencies, strict=True)]


def _finite_frequencies(modes: PathModes) -> Array:
    """Frequencies (P×m, Hz). Infinite and missing ones, which do not depend on digits, are zero."""
    return np.where(np.isfinite(modes.frequencies), modes.frequencies, 0.0)


def second_divisions(options: ModelOptions, legs: Sequence[Leg]) -> int:
    """Divisions of a second mesh: half of the first, one, or the fewest more that change enough.

    Round and thin-walled sections need so many elements that fewer divisions often give the same
    mesh, whose answer would be called exact.
    """
    present = options.divisions
    candidates = (present // 2, 1, *range(present + 1, 8 * present + 1))
    sections = [section_of(sectioned_leg(leg, options.equivalent)) for leg in legs]
    divisions: int = next(
        candidate
        for candidate in candidates
        if candidate and all(_ratio(section, present, candidate) >= _RATIO for section in sections)
    )
    return divisions


def _ratio(section: Section, first: int, second: int) -> float:
    """Ratio of the element sizes of two meshes of a section, at least 1."""
    try:
        coarse, fine = sorted(element_count(section, divisions) for divisions in (first, second))
    except InputError:
        # A section added by a user: elements in proportion to divisions.
        return max(first, second) / min(first, second)
    return sqrt(fine / coarse)


def mesh_policy(options: ModelOptions, legs: Sequence[Leg], divisions: int) -> MeshPolicy:
    """Rule for half-widths on the mesh of `options` from the change to one of other `divisions`."""
    present = options.divisions
    solid = [sectioned_leg(leg, options.equivalent) for leg in legs]
    order = min(formal_order(leg, options.ends) for leg in solid)
    along = max(present, divisions) / min(present, divisions)
    ratio = min(cbrt(along * _ratio(section_of(leg), present, divisions) ** 2) for leg in solid)
    return MeshPolicy.of_order(ratio if present > divisions else 1.0 / ratio, order)


def extrapolated(
    solved: SolvedQuestion, divisions: Sequence[int], widths: Sequence[MeshUncertainty]
) -> tuple[Array, Array, Sequence[MeshUncertainty]]:
    """Compliances (P×6×6), frequencies (P×m) and half-widths, extrapolated if an order is observed.

    `divisions` are those of all solved meshes, `widths` the half-widths from two of them. Each
    number is treated on its own, if there are at least four meshes and all sections are rectangles:
    walls keep one element across for several divisions, and would show only the order of their
    slices along the leg.
    """
    statics, modes, options = solved.statics, solved.modes, solved.question.options
    poses = len(solved.responses.robot.postures)
    compliances = np.zeros((poses, 0, 0)) if statics is None else statics.compliances.copy()
    frequencies = np.zeros((poses, 0)) if modes is None else modes.frequencies.copy()
    legs = [sectioned_leg(leg, options.equivalent) for leg in solved.legs]
    if (
        statics is None
        or len(divisions) < GRIDS_FOR_ORDER
        or not all(isinstance(section_of(leg), Rectangle) for leg in legs)
    ):
        return compliances, frequencies, widths
    meshes = [solved.on_divisions(count) for count in divisions]
    elements = [sum(n * element_count(section_of(leg), n) for leg in legs) for n in divisions]
    sizes = np.cbrt(1.0 / np.array(elements))
    order = min(formal_order(leg, options.ends) for leg in legs)
    upper = np.triu_indices(6)
    diagonal, count = upper[0] == upper[1], len(upper[0])
    results = []
    for pose, of_two in enumerate(widths):
        values = np.array(
            [
                np.append(mesh_statics.compliances[pose][upper], mesh_frequencies[pose])
                for mesh_statics, mesh_frequencies in meshes
            ]
        )
        # A mode without a partner on one of the meshes is not extrapolated.
        on_all = np.isfinite(values).all(axis=0)
        limits, half_widths = np.full((2, len(on_all)), np.nan)
        limits[on_all], half_widths[on_all] = richardson_limits(
            sizes, values[:, on_all], order, ROUND_OFF
        )
        numbers = np.where(np.isnan(limits), values[-1], limits)
        compliances[pose][upper] = compliances[pose].T[upper] = numbers[:count]
        frequencies[pose] = numbers[count:]
        compliance, modal = np.split(half_widths, [count])
        results.append(
            replace(
                of_two,
                compliance=_known(compliance[diagonal], of_two.compliance),
                frequencies=_known(modal, of_two.frequencies),
                meshes=tuple(divisions),
            )
        )
    return compliances, frequencies, results


def _known(first: Array, otherwise: Array) -> Array:
    return np.where(np.isnan(first), otherwise, first)
