"""Half-widths of a solved model: second mesh of prisms, three meshes of CAD parts, printed digits.

Input: a `SolvedQuestion`. Output: half-widths in each pose, and values extrapolated from at least
four meshes that show an order of convergence. Rule: changes between meshes and changes by digits
make half-widths as in the budgets of references (`validation.references`). Modes of two meshes are
paired by shape.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from math import cbrt, sqrt
from typing import TypeVar

import numpy as np

from fem.reduction.craig_bampton import frequency_bounds
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import SectionedLeg
from lumped.mechanism.mechanism import Posture
from lumped.sections import Rectangle, Section
from meshes.section.section_blocks import element_count
from validation.models.leg_models import leg_compliance, leg_modes
from validation.models.options import OF_ELEMENTS, ModelOptions
from validation.models.reduced_parts import ReducedPart, has_specified_couplings
from validation.models.robot_models import answers, mechanism_modes
from validation.parts.meshes import LEVELS
from validation.references.reference_parts import UNKNOWN, part_policy
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import Reading
from validation.responses.mode_partners import frequency_changes, partners
from validation.responses.statics_and_modes import Statics
from validation.solids.leg_meshes import formal_order, section_of
from validation.solids.solid_legs import GRIDS_FOR_ORDER, ROUND_OFF
from validation.solve.answer import HalfWidths, MeshUncertainty, PartUncertainty
from validation.solve.question import Question
from validation.solve.solved_model import SolvedModes, leg_alone, solved_model
from validation.uncertainty.grid_convergence import richardson_limits
from validation.uncertainty.half_widths import (
    Combiner,
    MeshPolicy,
    half_widths_by,
    half_widths_on,
    relative_sizes,
)

S = TypeVar("S")
# Smallest ratio of element sizes of both meshes. Walls with one element across keep one, so that
# half the divisions give a ratio of only 1.2 (tubes) or 1.3.
_RATIO = 1.2
# Elements per leg for the effect of printed digits. For six modes, this effect differs by one per
# cent from that with 20 elements.
_FEW_ELEMENTS = 6


@dataclass(frozen=True, eq=False)
class SolvedQuestion:
    """A question with the solutions of its model on all meshes of prisms that were solved so far.

    `models`: models of the question, by the divisions of their meshes.
    """

    question: Question
    responses: Responses
    models: dict[int, Model] = field(default_factory=dict)

    def model(self, divisions: int | None = None) -> Model:
        """Model with these `divisions` of prisms. None stands for the divisions of the question."""
        divisions = divisions or self.question.options.divisions
        if divisions not in self.models:
            self.models[divisions] = solved_model(self.question.with_divisions(divisions))
        return self.models[divisions]

    @cached_property
    def reading(self) -> Reading:
        """Interpretation of the robot file, and meshes, with which the question is solved.

        CAD parts have rigid interfaces and their finest mesh.
        """
        return Reading(dict.fromkeys(self.question.mechanism.parts, "rigid"))

    @property
    def poses(self) -> int:
        """Number of poses. 1 for a body alone."""
        return len(self.responses.robot.postures)

    @cached_property
    def statics(self) -> Statics | None:
        """Statics in all poses. None for a free body."""
        statics = self.responses.statics(self.model(), self.reading)
        return statics if isinstance(statics, Statics) else None

    @cached_property
    def modes(self) -> SolvedModes | None:
        """Modes in all poses. None if none are requested or nothing has mass."""
        modes = self.responses.modes(self.model(), self.reading)
        return modes if isinstance(modes, SolvedModes) else None

    @property
    def compliances(self) -> Array:
        """Compliances (P×6×6, SI) in P poses. P×0×0 for a free body."""
        statics = self.statics
        return np.zeros((self.poses, 0, 0)) if statics is None else statics.compliances

    @property
    def frequencies(self) -> Array:
        """Frequencies (P×m, Hz) of the m modes of the answer in P poses. NaN for missing ones."""
        modes = self.modes
        return np.zeros((self.poses, 0)) if modes is None else modes.frequencies[:, : modes.count]

    @property
    def loads(self) -> list[str]:
        """Names of the loads under which displacements are solved."""
        if self.question.alone is not None:
            return []
        return [load.name for load in self.question.mechanism.loads]

    def by_load(self, displacements: Array) -> list[dict[str, Array]]:
        """Displacements (P×6L) under L loads in each of P poses, by name of the load."""
        rows = displacements.reshape(self.poses, -1, 6)
        return [dict(zip(self.loads, of_pose, strict=True)) for of_pose in rows]

    @property
    def displacements(self) -> list[dict[str, Array]]:
        """Displacements (6, m and rad) under each load in each pose, by name of the load."""
        statics = self.statics
        return self.by_load(np.zeros(0) if statics is None else statics.load_displacements)

    def split(self, compliance: Array, loads: Array, frequencies: Array) -> list[HalfWidths]:
        """Half-widths as one record for each pose, from arrays for all poses (P×6, P×6L and P×m).

        Shapes: P poses, L loads, m modes.
        """
        rows = zip(compliance, frequencies, self.by_load(loads), strict=True)
        return [HalfWidths(*of_pose, loads=by_load) for *of_pose, by_load in rows]


def diagonals(statics: Statics) -> Array:
    """Compliance (P×6, SI) along and about each axis in P poses."""
    return np.diagonal(statics.compliances, axis1=1, axis2=2)


def _displacements(statics: Statics) -> Array:
    """Displacements (P×6L) under L loads in P poses."""
    return statics.load_displacements.reshape(len(statics.load_displacements), -1)


def _lengths(displacements: Array) -> Array:
    """Length (P×6L) of the translation or rotation to which each of the `displacements` belongs."""
    sizes = np.linalg.norm(displacements.reshape(len(displacements), -1, 3), axis=2)
    return np.repeat(sizes, 3, axis=1)


def _half_widths(
    solved: SolvedQuestion,
    levels: Sequence[int],
    policy: MeshPolicy | float,
    mesh_model: Callable[[int], tuple[Model, Reading]],
) -> list[HalfWidths]:
    """Half-widths of compliance, frequencies and displacements due to one kind of mesh.

    `mesh_model`: function that returns, for each of the mesh `levels`, the model and the `Reading`
    (interpretation of the robot file and choice of meshes) to be solved. If `policy` is a number,
    it is the relative half-width itself, and no mesh is solved.
    """
    responses, statics, modes = solved.responses, solved.statics, solved.modes

    # Half-widths due to each `change` of the solution, relative to `scale`. Infinite if unknown.
    def of_numbers(
        solution: Callable[[Model, Reading], S], change: Callable[[S, S, S], Array], scale: Array
    ) -> Array:
        shares = half_widths_on(levels, policy, lambda level: solution(*mesh_model(level)), change)
        unknown = np.isnan(shares) | np.equal(shares, UNKNOWN)
        return np.where(unknown & np.isfinite(scale), np.inf, shares * scale)

    def of_statics(numbers: Callable[[Statics], Array], scale: Array) -> Array:
        def change(first: Statics, second: Statics, _: Statics) -> Array:
            return relative_sizes(numbers(first) - numbers(second), scale)

        return of_numbers(responses.required_statics, change, scale)

    compliance, loads, frequencies = np.zeros((3, solved.poses, 0))
    if statics is not None:
        compliance = of_statics(diagonals, np.abs(diagonals(statics)))
        loads = of_statics(_displacements, _lengths(_displacements(statics)))
    if modes is not None:
        first_modes, count = modes, modes.count
        frequencies = of_numbers(
            responses.required_modes,
            lambda first, second, _: frequency_changes(first_modes, first, count, second),
            solved.frequencies,
        )
    return solved.split(compliance, loads, frequencies)


def of_prisms(
    solved: SolvedQuestion, affordable: Callable[[int], bool] = lambda _: True
) -> list[MeshUncertainty]:
    """Half-widths due to the mesh of prisms in each pose, from the change to a second mesh.

    A half-width is the change times Roache's factor for the refinement ratio r, where r³ is the
    ratio of the element counts (Celik et al., J. Fluids Eng. 130 (2008) 078001). It is infinite if
    the second mesh is finer and its divisions are not `affordable`. The list is empty if there are
    no solid prisms.
    """
    options, legs = solved.question.options, solved.question.legs
    if solved.question.model != "solid" or not legs:
        return []
    second = second_divisions(options, legs)
    coarser = second < options.divisions
    policy: MeshPolicy | float = UNKNOWN
    if coarser or affordable(second):
        policy = mesh_policy(options, legs, second)
    levels = (second, options.divisions) if coarser else (options.divisions, second)
    widths = _half_widths(solved, levels, policy, lambda n: (solved.model(n), solved.reading))
    return [
        MeshUncertainty(of_pose.compliance, of_pose.frequencies, second, loads=of_pose.loads)
        for of_pose in widths
    ]


def of_parts(solved: SolvedQuestion) -> list[PartUncertainty]:
    """Half-widths due to CAD parts in each pose: meshes, couplings and reduction.

    The list is empty if there are no solid parts.
    """
    question, modes, model = solved.question, solved.modes, solved.model()
    mechanism = question.mechanism
    if question.model != "solid" or question.alone is not None or not mechanism.parts:
        return []
    brackets, bounds, solids = _brackets(solved), np.zeros((solved.poses, 0)), {}
    if modes is not None:
        bodies = modes.postures[0].system.models
        solids = {name: body for name, body in bodies.items() if isinstance(body, ReducedPart)}
        by_pose = [
            frequency_bounds(solved_modes.system, solids, modes.count)
            for solved_modes in modes.postures
        ]
        bounds = np.array([bound.upper - bound.lower for bound in by_pose])
    widths = _half_widths(
        solved,
        LEVELS,
        part_policy(mechanism),
        lambda level: (model, solved.reading.on_mesh("part_mesh", level)),
    )
    return [
        PartUncertainty(
            of_pose.compliance,
            of_pose.frequencies,
            loads=of_pose.loads,
            bracket=bracket,
            reduction=bound,
            counted={name: (part.counted, part.cutoff) for name, part in solids.items()},
            by=question.options.reduction,
        )
        for of_pose, bracket, bound in zip(widths, brackets, bounds, strict=True)
    ]


def _brackets(solved: SolvedQuestion) -> list[HalfWidths]:
    """Changes of compliance and frequencies from rigid to averaged interfaces in each pose.

    Zero if the robot file specifies all couplings.
    """
    parts, responses, modes = solved.question.mechanism.parts, solved.responses, solved.modes
    averaged = solved.reading
    if not all(has_specified_couplings(body) for body in parts.values()):
        averaged = replace(averaged, ends=dict.fromkeys(parts, "free"))
    rigid, free = (
        responses.required_statics(solved.model(), reading)
        for reading in (solved.reading, averaged)
    )
    frequencies = np.zeros((solved.poses, 0))
    if modes is not None:
        free_modes = responses.required_modes(solved.model(), averaged)
        frequencies = partners(modes, free_modes, modes.count).frequency - solved.frequencies
    change = free - rigid
    return solved.split(diagonals(change), _displacements(change), frequencies)


def of_digits(solved: SolvedQuestion) -> list[HalfWidths] | None:
    """Half-widths due to the printed digits of the file's 6×6 in each pose. None if they are zero.

    Compliances: 95 % quantile of the change due to independent errors of the digits, as for
    references. Frequencies: sum of the changes due to each digit, an upper bound. Relative
    half-widths are those of the question's model with few elements and with beams instead of
    solids, because they depend little on the model.
    """
    robot, question = solved.responses.robot, solved.question
    if not robot.roundings:
        return None
    options = question.given
    if question.model == "solid":
        options = {name: options[name] for name in ("equivalent",) if name in options}
        question = replace(question, model="beam")
    if question.model in OF_ELEMENTS:
        options = {**options, "elements": min(question.options.elements, _FEW_ELEMENTS)}
    count = solved.frequencies.shape[1]
    numbers = partial(_diagonals_and_frequencies, replace(question, given=options), count)
    nominal = numbers(robot.postures)
    perturbed = [(rounding.factor, numbers(rounding.postures)) for rounding in robot.roundings]
    statics, compliance = solved.statics, np.zeros((solved.poses, 0))

    def shares(columns: slice, combiner: Combiner) -> Array:
        size = partial(relative_sizes, values=nominal[:, columns])
        return half_widths_by(nominal, perturbed, lambda row: row[:, columns], size, combiner)

    if statics is not None:
        compliance = diagonals(statics)
        compliance = np.abs(compliance) * shares(slice(0, 6), Combiner.PROBABILITY)
    shares_of_modes = shares(slice(compliance.shape[1], None), Combiner.LINEAR_SUM)
    frequencies = np.nan_to_num(solved.frequencies * shares_of_modes)
    if not (compliance.any() or frequencies.any()):
        return None
    return [HalfWidths(*of_pose) for of_pose in zip(compliance, frequencies, strict=True)]


def _diagonals_and_frequencies(
    question: Question, count: int, postures: Sequence[Posture]
) -> Array:
    """Diagonal compliances (SI) and `count` frequencies (Hz) in each of P poses: P×(6 + count).

    A free body has no compliances: P×count. Infinite and missing frequencies are zero.
    """
    model, options = question.model, question.options
    if question.alone is None and count:
        solutions = mechanism_modes(model, postures, count, options)
        rows = [np.append(np.diag(pose.compliance), pose.modes.frequencies) for pose in solutions]
    elif question.alone is None:
        compliances = answers(model, postures, 0, options).compliances
        rows = list(np.diagonal(compliances, axis1=1, axis2=2))
    else:
        leg, options = leg_alone(question.alone, postures[0].mechanism, options)
        numbers = np.zeros(0)
        if not question.free:
            numbers = np.diag(leg_compliance(model, leg, options))
        if count:
            modes = leg_modes(model, leg, count, options, free=question.free)
            numbers = np.append(numbers, modes.frequencies[0])
        rows = [numbers]
    return np.where(np.isfinite(rows), rows, 0.0)


def second_divisions(options: ModelOptions, legs: Sequence[SectionedLeg]) -> int:
    """Divisions of a second mesh, whose element sizes differ enough from those of the first mesh.

    The first sufficient number is returned. Half the divisions of the first mesh are tried first,
    then one division, then numbers larger than that of the first mesh, in ascending order.

    Round and thin-walled sections need so many elements that fewer divisions often give the same
    mesh, whose uncertainty would then appear to be zero.
    """
    present = options.divisions
    candidates = (present // 2, 1, *range(present + 1, 8 * present + 1))
    sections = [section_of(leg) for leg in legs]
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
        # For a section added by a user, the element size is assumed proportional to 1/divisions.
        return max(first, second) / min(first, second)
    return sqrt(fine / coarse)


def mesh_policy(options: ModelOptions, legs: Sequence[SectionedLeg], divisions: int) -> MeshPolicy:
    """Rule for half-widths on the mesh of `options`, from the change to a mesh with `divisions`."""
    present = options.divisions
    along = max(present, divisions) / min(present, divisions)
    ratio = min(cbrt(along * _ratio(section_of(leg), present, divisions) ** 2) for leg in legs)
    order = min(formal_order(leg, options.ends) for leg in legs)
    return MeshPolicy.of_order(ratio if present > divisions else 1.0 / ratio, order)


def extrapolated(
    solved: SolvedQuestion, widths: Sequence[MeshUncertainty]
) -> tuple[Array, Array, Sequence[MeshUncertainty]]:
    """Compliances (P×6×6), frequencies (P×m) and half-widths, extrapolated if an order is observed.

    `widths`: half-widths from two meshes, returned if nothing is extrapolated. Each number is
    extrapolated on its own, from at least four meshes. All sections must be rectangles: thin walls
    keep one element across over several divisions, so that only the length of the elements along
    the leg would change. A mode without a partner on one of the meshes is not extrapolated.
    """
    statics, modes, options = solved.statics, solved.modes, solved.question.options
    compliances, frequencies = solved.compliances.copy(), solved.frequencies.copy()
    legs, divisions = solved.question.legs, sorted(solved.models)
    if (
        statics is None
        or len(divisions) < GRIDS_FOR_ORDER
        or not all(isinstance(section_of(leg), Rectangle) for leg in legs)
    ):
        return compliances, frequencies, widths
    elements = [sum(n * element_count(section_of(leg), n) for leg in legs) for n in divisions]
    sizes = np.cbrt(1.0 / np.array(elements))
    order = min(formal_order(leg, options.ends) for leg in legs)
    upper = np.triu_indices(6)
    diagonal, count = upper[0] == upper[1], len(upper[0])
    values_by_mesh = []
    for model in map(solved.model, divisions):
        on_mesh = solved.responses.required_statics(model, solved.reading).compliances
        numbers = [compliance[upper] for compliance in on_mesh], frequencies
        if modes is not None:
            other_modes = solved.responses.required_modes(model, solved.reading)
            numbers = numbers[0], partners(modes, other_modes, modes.count).frequency
        values_by_mesh.append(np.hstack(numbers))
    results = []
    for pose, (values, of_two) in enumerate(
        zip(np.stack(values_by_mesh, axis=1), widths, strict=True)
    ):
        on_all = np.isfinite(values).all(axis=0)
        limits, half_widths = np.full((2, len(on_all)), np.nan)
        limits[on_all], half_widths[on_all] = richardson_limits(
            sizes, values[:, on_all], order, ROUND_OFF
        )
        numbers_at = np.where(np.isnan(limits), values[-1], limits)
        compliances[pose][upper] = compliances[pose].T[upper] = numbers_at[:count]
        frequencies[pose] = _known(numbers_at[count:], frequencies[pose])
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
