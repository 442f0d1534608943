"""Cases on the whole robot: VJM, links, segments and beams against the robot with solid legs.

Input: the robot in the middle of its path, with all legs of constant section; a leg specified by
its 6×6 compliance is replaced by its equivalent prism. Output: a verdict for each model on six tool
motions and four frequencies. Rule: as for a single leg (`leg_beam_vs_solid`), the difference less
the allowances must be within the tolerance of [agree]. Each allowance is the difference between two
robots whose legs differ by one named cause alone. The end condition of the solids is that of
[agree], otherwise `ends` of each leg, otherwise rigid faces. The robots are computed in
`robots_of_prisms`.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from lumped.acceptance.requirement import AgreementLimits
from lumped.legs import ConstantLeg, LineLeg
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of, on_equivalent_legs
from validation.case import Allowance, Measurement, Skip
from validation.cases.leg_waves import NO_WAVES, WAVES_SOURCE
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
from validation.comparisons.robots_of_prisms import COARSE, FINE, prisms, robot_modes, robot_statics
from validation.context import Context
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.models.robot_models import answers
from validation.references.modes_on_path import (
    SolidMeshes,
    model_vibration,
    solid_meshes,
)
from validation.references.reference_legs import (
    most_unknowns,
    slowest,
)
from validation.references.robot_on_path import (
    computed_count,
    known_legs,
    path_postures,
    why_not_serial,
)
from validation.responses.mode_partners import partners
from validation.solids.leg_meshes import COARSEST_WALLS, FORMAL_ORDER, has_meshes
from validation.solids.solid_legs import (
    SHARED_SOLIDS,
    decay_of_warping,
)
from validation.solids.solid_size import too_large, why_shapeless
from validation.uncertainty.half_widths import MeshPolicy

# Remedies for an undecided comparison: if rigid end faces are the cause, and if meshes are.
_FREE_ENDS = (
    "held end faces change this mode by more than their theory explains; compare with free ends"
)
_REFINE = "refine the models until the numerical uncertainty is below the tolerance"
_HELICAL = (
    "waves of 3-D elasticity are available only for balanced layups of fibres, whose tension does "
    "not twist the leg"
)
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
cases = agreement_group(group=SHARED_SOLIDS, effort=0.5)


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
    if shapeless := why_shapeless(list(prisms(posture.mechanism).values())):
        raise Skip(shapeless)
    for leg in prisms(posture.mechanism).values():
        if not has_meshes(leg, most_unknowns(context.meshes, leg)):
            raise Skip(
                f"{leg.name}: the mesh of its section has too many unknowns for preset "
                f"{context.meshes}"
            )
    statics = context.get(robot_statics, posture, context.meshes, limits)
    policy = slowest(statics.ratio)
    reference = float(statics.solid[FINE, entry])
    motions_of_kind = statics.solid[FINE, :3] if entry < 3 else statics.solid[FINE, 3:]
    if reference <= _STILL * motions_of_kind.max():
        direction = f"{'along' if entry < 3 else 'about'} {'xyz'[entry % 3]}"
        raise Skip(f"the tool does not yield {direction}, so that no compliance is compared")
    response = context.get(answers, model, (posture,), 0, _options(limits))
    computed = float(statics.computed[FINE, entry])
    residuals = (statics.restrained - statics.solid)[:, entry]
    formula = formula_allowance(
        statics.textbook[entry],
        computed,
        (statics.stiff[entry], statics.soft[entry]),
        policy.half_width(computed - statics.other_mesh[entry]),
    )
    return Measurement(
        float(response.compliances[0, entry, entry]),
        reference,
        reference_uncertainty=policy.half_width(reference - statics.solid[COARSE, entry]),
        judged_uncertainty=policy.half_width(residuals[FINE] - residuals[COARSE]),
        allowances=(
            Allowance(
                HELD_FACES,
                computed - float(statics.restrained[FINE, entry]),
                "fem.couplings.end_effects",
            ),
            formula,
        ),
        pose=tuple(posture.pose.tolist()),
    )


def _options(limits: AgreementLimits) -> ModelOptions:
    return replace(DEFAULT_OPTIONS, elements=limits.elements)


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
            raise Skip(f"{leg.name}: {_HELICAL}")
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
    legs = list(prisms(posture.mechanism).values())
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
    reference, free = float(modes.specified_ends[FINE, index]), modes.free_ends[:, index]
    computed = float(modes.computed[FINE, index])
    policy = MeshPolicy.of_order(meshes.ratio(legs), FORMAL_ORDER)
    residuals = distorted - free
    formula = formula_allowance(
        modes.textbook[index],
        computed,
        (modes.soft[index], modes.stiff[index]),
        policy.half_width(computed - float(modes.computed[COARSE, index])),
    )
    shares = [
        context.get(rigid_end_share, leg, meshes.fine.section_divisions(leg), kind)
        for leg in legs
        if limits.ends_of(leg.ends) == "rigid"
        for kind in ("tension", "bending y", "bending z")
    ]
    steps = (
        reference - float(modes.specified_ends[COARSE, index]),
        float(free[FINE] - free[COARSE]),
    )
    difference = float(free[FINE]) - reference
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
        judged_uncertainty=policy.half_width(residuals[FINE] - residuals[COARSE]) + beyond,
        allowances=(
            Allowance(HELD_FACES, faces, HELD_SOURCE),
            Allowance(DISTORTION, computed - float(distorted[FINE]), WAVES_SOURCE),
            formula,
        ),
        pose=tuple(posture.pose.tolist()),
        decides=_FREE_ENDS if beyond else _REFINE,
    )
