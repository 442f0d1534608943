"""Cases on the whole robot: VJM, links, segments and beams against the robot with solid legs.

Input: the robot in the middle of its path, with all legs of constant section; a leg specified by
its 6×6 compliance is replaced by its equivalent prism. Output: a verdict for each model on six tool
motions and four frequencies. Rule: as for a single leg (`leg_beam_vs_solid`), the difference less
the allowances must be within the tolerance of [agree]. Each allowance is the difference between two
robots whose legs differ by one named cause alone. The end condition of the solids is that of
[agree], otherwise `ends` of each leg, otherwise rigid faces.

Statics: each leg is represented by its tip compliance, for solids by the doubling method
(`fem.bodies.doubling`) on two meshes. Dynamics: solids reduced to their ends; beams with section
constants computed on the mesh of the solid, with and without the waves of 3-D elasticity
(`validation.cases.leg_waves`). Modes are paired by shape.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from fem.beams.beam import beam_leg
from fem.reduction.craig_bampton import CraigBampton, craig_bampton
from fem.reduction.superelement import held_leg
from lumped.acceptance.requirement import DEFAULT_LIMITS, AgreementLimits
from lumped.arrays import Array, IntArray
from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg, LineLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.memo import memo
from lumped.models.bodies import legs_of, links, on_equivalent_legs
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, solved
from meshes.section.section_mesh import section_mesh
from validation.case import Allowance, Measurement, Skip
from validation.cases.leg_theory import HELICAL
from validation.cases.leg_waves import NO_WAVES, WAVES_SOURCE, wave_changes, waves_of
from validation.comparisons.agreement_cases import (
    DISTORTION,
    HELD_FACES,
    agreement_group,
    compliance_cases,
    formula_allowance,
    frequency_cases,
    limited,
)
from validation.comparisons.element_convergence import MODES
from validation.comparisons.leg_beam_vs_solid import is_strip, rigid_end_share
from validation.comparisons.section_formulas import leg_formula_band, mesh_formula_band
from validation.context import Context, Preset
from validation.models.leg_models import filled
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.models.robot_bodies import CUTOFF
from validation.models.robot_models import answers, highest_frequency, modes_along
from validation.references.mode_samples import samples_of
from validation.references.modes_on_path import (
    SolidMeshes,
    computed_beam_vibration,
    model_vibration,
    solid_meshes,
    solid_vibration,
    vibration_of,
)
from validation.references.reference_legs import (
    SECTION_DIVISIONS,
    most_unknowns,
    slowest,
)
from validation.references.robot_on_path import (
    Holds,
    Reading,
    computed_count,
    known_legs,
    path_postures,
    why_not_serial,
)
from validation.responses.mode_partners import partners
from validation.responses.statics_and_modes import PathModes
from validation.solids.leg_meshes import COARSEST_WALLS, FORMAL_ORDER, has_meshes, mesh_pair
from validation.solids.solid_legs import (
    ELEMENTS,
    SHARED_SOLIDS,
    computed_beam,
    computed_properties,
    decay_of_warping,
    doubled_tips,
    face_restraint,
)
from validation.solids.solid_size import too_large, why_shapeless
from validation.uncertainty.half_widths import MeshPolicy

# Remedies for an undecided comparison: if rigid end faces are the cause, and if meshes are.
_FREE_ENDS = (
    "held end faces change this mode by more than their theory explains; compare with free ends"
)
_REFINE = "refine the models until the numerical uncertainty is below the tolerance"
# Largest ratio of the decay length of warping to the length of a leg for which waves are computed,
# since they neglect warping. With the ratio 0.106 of leg 2 of the built-in robot, the neglected
# warping changes f4 by 3e-4.
_WARPING = 0.2
# Fraction of the largest translation or rotation below which a motion is round-off.
_STILL = 1e-9
# Factor on the frequency change by Reissner's theory of restrained warping, which is within a fifth
# of the change by solids.
_REISSNER = 1.2
HELD_SOURCE = (
    "solids with free and with held end faces, at most the effect in beams with "
    "restrained warping and, in bending and tension, with fields that decay from held "
    "faces"
)
# Row indices of the meshes in `RobotStatics` and `RobotModes`.
_COARSE, _FINE = 0, 1

cases = agreement_group(group=SHARED_SOLIDS, effort=0.5)


# Function that returns the tip compliance (6×6, SI, leg axes) of a named leg on a mesh.
Spring: TypeAlias = Callable[[str, ConstantLeg, int], Array]


@dataclass(frozen=True, eq=False)
class RobotStatics:
    """Motions (6, SI) of the tool along and about the base axes, each under its own unit load.

    Results on a coarse and a fine mesh (2×6), whose element sizes differ by a factor of `ratio` or
    more: `solid`, legs as solids; `computed`, beams with section constants computed on the mesh of
    the solid; `restrained`, the same beams with the end restraint of rigid faces. Further results
    (6): `other_mesh`, the computed beams on a section mesh other than the fine one; `textbook`,
    beams with textbook constants; `soft` and `stiff`, the limits of correct textbook formulas.
    """

    solid: Array
    computed: Array
    restrained: Array
    other_mesh: Array
    textbook: Array
    soft: Array
    stiff: Array
    ratio: float


@dataclass(frozen=True, eq=False)
class RobotModes:
    """Frequencies (Hz) of the first k modes with solid legs, and of their partners in beam models.

    Results on a coarse and a fine mesh (2×k): `specified_ends` and `free_ends`, solids with these
    end conditions; `computed`, beams with section constants computed on the mesh of the solid;
    `distortion`, relative change of the computed frequencies by distortion of the section (waves in
    the legs). Further results (k): `rigid_end_changes`, relative changes due to rigid ends, by
    beams with warping; `textbook`, `soft` and `stiff` as in `RobotStatics`. NaN for a mode without
    a partner. `reference`: modes with `specified_ends` on the fine mesh, with which modes are
    paired.
    """

    reference: PathModes
    specified_ends: Array
    free_ends: Array
    rigid_end_changes: Array
    computed: Array
    distortion: Array
    textbook: Array
    soft: Array
    stiff: Array


def constant_posture(context: Context) -> Posture:
    """Posture in the middle of the path, with equivalent prisms for legs given by a compliance."""
    return context.get(_constant_posture, path_postures(context))


def _constant_posture(postures: tuple[Posture, ...]) -> Posture:
    middle = postures[len(postures) // 2]
    mechanism = on_equivalent_legs(middle.mechanism)
    return Posture(mechanism, middle.pose, middle.frames, middle.coordinates)


def _require_prisms(mechanism: Mechanism) -> None:
    """Raise Skip if a robot has CAD parts, or legs that are tapered, stepped or curved."""
    if parts := ", ".join(mechanism.parts):
        raise Skip(
            f"{parts}: this comparison is for legs of constant section, not for CAD parts, which "
            'the table "Adequacy of the models" compares with solids'
        )
    lines = [name for name, leg in legs_of(mechanism).items() if isinstance(leg, LineLeg)]
    if lines:
        raise Skip(
            f"{', '.join(lines)}: this comparison is for legs of constant section; legs along a "
            "line are compared with their own solids, and the table "
            '"Adequacy of the models" compares the robot with such solids'
        )


def _ends(mechanism: Mechanism, limits: AgreementLimits) -> Holds:
    """End condition of the solid of each leg, by body name."""
    return {name: limits.ends_of(leg.ends) for name, leg in _prisms(mechanism).items()}


def _prisms(mechanism: Mechanism) -> dict[str, ConstantLeg]:
    """Legs of constant section by body name. Equal legs are one object."""
    return {
        name: leg for name, leg in known_legs(mechanism).items() if isinstance(leg, ConstantLeg)
    }


def robot_statics(
    posture: Posture, preset: Preset, limits: AgreementLimits = DEFAULT_LIMITS
) -> RobotStatics:
    """Tool motions with solid legs and with the corresponding beams, on two meshes of a preset."""
    mechanism = posture.mechanism
    legs, ends = _prisms(mechanism), _ends(mechanism, limits)
    meshes = {name: mesh_pair(leg, most_unknowns(preset, leg)) for name, leg in legs.items()}
    # If both meshes share the section mesh, a third one gives the uncertainty of the section
    # constants.
    other = {
        name: coarse if coarse != fine else SECTION_DIVISIONS
        for name, ((coarse, _), (fine, _)) in meshes.items()
    }

    def motions(spring: Spring, mesh: int = _FINE) -> Array:
        tips = {name: spring(name, leg, mesh) for name, leg in legs.items()}
        bodies = links(mechanism, tips)
        return np.diag(compliance(solved(assembly(mechanism, bodies).at(posture)))).copy()

    def on_both(spring: Spring) -> Array:
        return np.array([motions(spring, mesh) for mesh in (_COARSE, _FINE)])

    def solid(name: str, leg: ConstantLeg, mesh: int) -> Array:
        return doubled_tips(leg, *meshes[name][mesh])[ends[name]]

    def computed(name: str, leg: ConstantLeg, mesh: int) -> Array:
        return _computed_tip(leg, meshes[name][mesh][0])

    def restrained(name: str, leg: ConstantLeg, mesh: int) -> Array:
        restraint = face_restraint(leg, meshes[name][mesh][0]) if ends[name] == "rigid" else 0.0
        return computed(name, leg, mesh) + restraint

    def by_formula(side: int) -> Array:
        return motions(
            lambda name, leg, mesh: tip_compliance(
                leg_formula_band(leg, meshes[name][mesh][0])[side], leg.length
            )
        )

    return RobotStatics(
        solid=on_both(solid),
        computed=on_both(computed),
        restrained=on_both(restrained),
        other_mesh=motions(lambda name, leg, _: _computed_tip(leg, other[name])),
        textbook=motions(lambda _name, leg, _mesh: tip_compliance(leg.timoshenko, leg.length)),
        soft=by_formula(0),
        stiff=by_formula(1),
        ratio=min(fine[1] / coarse[1] for coarse, fine in meshes.values()),
    )


@memo(16)
def _computed_tip(leg: ConstantLeg, divisions: int) -> Array:
    """Tip compliance (6×6, SI) of the beam with section constants by finite elements."""
    return tip_compliance(computed_properties(leg, divisions), leg.length)


@compliance_cases(
    cases,
    "robot",
    "Robot",
    "that with solid legs",
    quantity="displacement of the tool, {motion}, under a unit load, middle pose of the path",
    citation="the same legs meshed with quadratic hexahedra",
)
def _motion(context: Context, model: ModelName, entry: int, limits: AgreementLimits) -> Measurement:
    _require_prisms(context.robot_file.mechanism)
    posture = constant_posture(context)
    if model == "vjm" and (reason := context.get(why_not_serial, (posture,))):
        raise Skip(reason)
    if shapeless := why_shapeless(list(_prisms(posture.mechanism).values())):
        raise Skip(shapeless)
    for leg in _prisms(posture.mechanism).values():
        if not has_meshes(leg, most_unknowns(context.meshes, leg)):
            raise Skip(
                f"{leg.name}: the mesh of its section has too many unknowns for preset "
                f"{context.meshes}"
            )
    statics = context.get(robot_statics, posture, context.meshes, limits)
    policy = slowest(statics.ratio)
    reference = float(statics.solid[_FINE, entry])
    motions_of_kind = statics.solid[_FINE, :3] if entry < 3 else statics.solid[_FINE, 3:]
    if reference <= _STILL * motions_of_kind.max():
        direction = f"{'along' if entry < 3 else 'about'} {'xyz'[entry % 3]}"
        raise Skip(f"the tool does not yield {direction}, so that no compliance is compared")
    (model_response,) = context.get(answers, model, (posture,), 0, _options(limits))
    computed = float(statics.computed[_FINE, entry])
    residuals = (statics.restrained - statics.solid)[:, entry]
    formula = formula_allowance(
        statics.textbook[entry],
        computed,
        (statics.stiff[entry], statics.soft[entry]),
        policy.half_width(computed - statics.other_mesh[entry]),
    )
    return Measurement(
        float(model_response.compliance[entry, entry]),
        reference,
        reference_uncertainty=policy.half_width(reference - statics.solid[_COARSE, entry]),
        judged_uncertainty=policy.half_width(residuals[_FINE] - residuals[_COARSE]),
        allowances=(
            Allowance(
                HELD_FACES,
                computed - float(statics.restrained[_FINE, entry]),
                "fem.couplings.end_effects",
            ),
            formula,
        ),
        pose=tuple(posture.pose.tolist()),
    )


def _options(limits: AgreementLimits) -> ModelOptions:
    return replace(DEFAULT_OPTIONS, elements=limits.elements)


def robot_modes(
    posture: Posture, meshes: SolidMeshes, count: int, limits: AgreementLimits = DEFAULT_LIMITS
) -> RobotModes:
    """Frequencies with solid legs and with the corresponding beams, on two meshes.

    `count` modes are computed for each model.
    """
    legs, ends = _prisms(posture.mechanism), _ends(posture.mechanism, limits)
    free: Holds = dict.fromkeys(legs, "free")

    def solids(hold: Holds) -> list[PathModes]:
        return [solid_vibration((posture,), Reading(hold), mesh, count) for mesh in meshes]

    free_ends = solids(free)
    specified = free_ends if ends == free else solids(ends)
    reference = specified[_FINE]

    def partner(other: PathModes) -> tuple[Array, IntArray]:
        paired = partners(reference, other, MODES)
        return paired.frequency[0], paired.partner_indices[0]

    faces = [{name: mesh.section_divisions(leg) for name, leg in legs.items()} for mesh in meshes]
    computed, distortion = [], []
    for section_divisions in faces:
        beams = {leg: computed_beam(leg, section_divisions[name]) for name, leg in legs.items()}
        vibration, reduced = _beam_vibration(posture, beams, count)
        frequencies, numbers = partner(vibration)
        by_waves = wave_changes(
            (posture,),
            {name: reduced[leg] for name, leg in legs.items()},
            {name: beams[leg] for name, leg in legs.items()},
            waves_of(legs, section_divisions),
            elements=ELEMENTS,
            basis_count=count,
            count=int(numbers.max()) + 1,
        )[0]
        computed.append(frequencies)
        distortion.append(np.where(numbers >= 0, by_waves[numbers], np.nan))

    def warping(hold: Holds) -> Array:
        return partner(computed_beam_vibration((posture,), meshes.fine, hold, count))[0]

    def by_formula(side: int) -> Array:
        beams = {
            leg: beam_leg(
                mesh_formula_band(leg, section_mesh(leg.section, faces[_FINE][name]))[side],
                leg.length,
                ELEMENTS,
            )
            for name, leg in legs.items()
        }
        return partner(_beam_vibration(posture, beams, count)[0])[0]

    return RobotModes(
        reference=reference,
        specified_ends=np.array([partner(solution)[0] for solution in specified]),
        free_ends=np.array([partner(solution)[0] for solution in free_ends]),
        rigid_end_changes=warping(ends) / warping(free) - 1.0,
        computed=np.array(computed),
        distortion=np.array(distortion),
        textbook=partner(model_vibration((posture,), "beam", DEFAULT_OPTIONS, count))[0],
        soft=by_formula(0),
        stiff=by_formula(1),
    )


def _beam_vibration(
    posture: Posture, beams: Mapping[ConstantLeg, LegMatrices], count: int
) -> tuple[PathModes, dict[ConstantLeg, CraigBampton]]:
    """Modes of the robot (`count`) with the models `beams` of its legs, and the reduced legs."""
    highest = highest_frequency((posture,), count)
    reduced = {
        leg: craig_bampton(held_leg(beam), highest, CUTOFF["beam"] * highest)
        for leg, beam in beams.items()
    }
    legs = _prisms(posture.mechanism)
    bodies = {name: filled(reduced[leg].matrices) for name, leg in legs.items()}
    modes = modes_along(assembly(posture.mechanism, bodies), (posture,), count)
    return vibration_of(samples_of(posture.mechanism), modes, count), reduced


def _mode_count(context: Context) -> int:
    """Number of modes to compute for the comparison of the robot with its solids.

    If the verdicts of adequacy use the same solids, it is the number of modes of these verdicts, so
    that the solids are solved once. Otherwise it is smaller.
    """
    legs = known_legs(context.robot_file.mechanism).values()
    shared = all(isinstance(leg, ConstantLeg) for leg in legs)
    return (
        computed_count(max(MODES, context.robot_file.requirement.modes))
        if shared
        else computed_count(1)
    )


def _require_waves(context: Context, legs: Sequence[ConstantLeg], meshes: SolidMeshes) -> None:
    """Raise Skip if solids of the legs are too large for the preset, or the waves do not apply.

    The theory of waves requires sections with two axes of symmetry and without helical fibres. It
    neglects warping over much of a leg's length and plate bending of strips.
    """
    numbers = [meshes.fine.divisions(leg) for leg in legs]
    if reason := too_large(legs, numbers, context.preset):
        raise Skip(reason)
    for leg, number in zip(legs, numbers, strict=True):
        if not leg.section.is_doubly_symmetric:
            raise Skip(
                f"{leg.name}: waves of 3-D elasticity are available only for sections "
                f"that are symmetric about y and z, not for a {leg.section.shape}"
            )
        if any(leg.section.couplings):
            raise Skip(f"{leg.name}: {HELICAL}")
        if decay_of_warping(leg, number) > _WARPING * leg.length:
            raise Skip(
                f"{leg.name}: open section; its warping extends over more than a fifth of "
                "the length, so that beam theory without warping does not hold"
            )
        if is_strip(leg):
            raise Skip(
                f"{leg.name}: strip wider than a tenth of its length; not compared, because the "
                "reference, waves of 3-D elasticity along the strip, neglects that it bends as a "
                "plate near its ends (errors of 1 % for two leaf springs thrice as long as wide)"
            )


@frequency_cases(
    cases,
    "robot",
    "Robot",
    "that with solid legs",
    quantity="natural frequency {mode}, middle pose of the path, modes paired by shape",
    citation="the same legs meshed with quadratic hexahedra, reduced to their ends",
    figure="mechanism.mode-shapes",
)
def _frequency(
    context: Context, model: ModelName, index: int, limits: AgreementLimits
) -> Measurement:
    _require_prisms(context.robot_file.mechanism)
    posture = constant_posture(context)
    legs = list(_prisms(posture.mechanism).values())
    coarse, fine = solid_meshes(context.preset)
    # Four divisions at least, as in the reference of the adequacy verdicts. Fewer are too stiff.
    meshes = SolidMeshes(coarse, fine._replace(least=COARSEST_WALLS))
    _require_waves(context, legs, meshes)
    count = _mode_count(context)
    modes = context.get(robot_modes, posture, meshes, count, limits)
    vibration = context.get(model_vibration, (posture,), model, _options(limits), count)
    value = float(partners(modes.reference, vibration, MODES).frequency[0, index])
    distorted = (modes.computed * (1.0 + modes.distortion))[:, index]
    if not np.isfinite(distorted).all():
        raise Skip(NO_WAVES)
    reference, free = float(modes.specified_ends[_FINE, index]), modes.free_ends[:, index]
    computed = float(modes.computed[_FINE, index])
    policy = MeshPolicy.of_order(meshes.ratio(legs), FORMAL_ORDER)
    residuals = distorted - free
    formula = formula_allowance(
        modes.textbook[index],
        computed,
        (modes.soft[index], modes.stiff[index]),
        policy.half_width(computed - float(modes.computed[_COARSE, index])),
    )
    shares = [
        context.get(rigid_end_share, leg, meshes.fine.section_divisions(leg), kind)
        for leg in legs
        if limits.ends_of(leg.ends) == "rigid"
        for kind in ("tension", "bending y", "bending z")
    ]
    steps = (
        reference - float(modes.specified_ends[_COARSE, index]),
        float(free[_FINE] - free[_COARSE]),
    )
    difference = float(free[_FINE]) - reference
    share = _REISSNER * float(modes.rigid_end_changes[index]) + max(shares, default=0.0)
    faces = limited(difference, (-share * reference, 0.0), policy.half_width(np.abs(steps).sum()))
    # Static fields underestimate the end restraint in vibration, for short waves by less than a
    # factor of two. Within this factor the comparison is undecided; beyond it the solid is wrong.
    beyond = abs(difference - faces) if abs(difference) <= 2.0 * abs(faces) else 0.0
    return Measurement(
        value,
        reference,
        reference_uncertainty=policy.half_width(steps[0]),
        # Section constants, waves and solids share the error of one section mesh, which cancels.
        judged_uncertainty=policy.half_width(residuals[_FINE] - residuals[_COARSE]) + beyond,
        allowances=(
            Allowance(HELD_FACES, faces, HELD_SOURCE),
            Allowance(DISTORTION, computed - float(distorted[_FINE]), WAVES_SOURCE),
            formula,
        ),
        pose=tuple(posture.pose.tolist()),
        decides=_FREE_ENDS if beyond else _REFINE,
    )
