"""Robots whose legs of constant section are solids or beams, on a coarse and a fine mesh.

Input: a posture of a robot whose legs have a constant section. Output: `RobotStatics`, motions of
the tool, and `RobotModes`, frequencies, of robots whose legs differ by one named cause alone.
Statics: each leg is represented by its tip compliance, for solids by the doubling method
(`fem.bodies.doubling`). Dynamics: solids reduced to their ends; beams with section constants
computed on the mesh of the solid, with and without the waves of 3-D elasticity
(`validation.cases.leg_waves`). Modes are paired by shape.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from fem.beams.beam import beam_leg
from fem.reduction.craig_bampton import CraigBampton, craig_bampton
from fem.reduction.superelement import held_leg
from lumped.acceptance.requirement import DEFAULT_LIMITS, AgreementLimits
from lumped.arrays import Array, IntArray
from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.memo import memo
from lumped.models.bodies import links
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, solved
from meshes.section.section_mesh import section_mesh
from validation.cases.leg_waves import wave_changes, waves_of
from validation.comparisons.element_convergence import MODES
from validation.comparisons.section_formulas import leg_formula_band, mesh_formula_band
from validation.context import Preset
from validation.models.leg_models import filled
from validation.models.options import DEFAULT_OPTIONS
from validation.models.robot_bodies import CUTOFF
from validation.models.robot_models import highest_frequency, modes_along
from validation.references.mode_samples import samples_of
from validation.references.modes_on_path import (
    SolidMeshes,
    computed_beam_vibration,
    model_vibration,
    solid_vibration,
    vibration_of,
)
from validation.references.reference_legs import (
    SECTION_DIVISIONS,
    most_unknowns,
)
from validation.references.robot_on_path import (
    Holds,
    Reading,
    known_legs,
)
from validation.responses.mode_partners import partners
from validation.responses.statics_and_modes import PathModes
from validation.solids.leg_meshes import mesh_pair
from validation.solids.solid_legs import (
    ELEMENTS,
    computed_beam,
    computed_properties,
    doubled_tips,
    face_restraint,
)

# Row indices of the meshes in `RobotStatics` and `RobotModes`.
COARSE, FINE = 0, 1


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


def _ends(mechanism: Mechanism, limits: AgreementLimits) -> Holds:
    """End condition of the solid of each leg, by body name."""
    return {name: limits.ends_of(leg.ends) for name, leg in prisms(mechanism).items()}


def prisms(mechanism: Mechanism) -> dict[str, ConstantLeg]:
    """Legs of constant section by body name. Equal legs are one object."""
    return {
        name: leg for name, leg in known_legs(mechanism).items() if isinstance(leg, ConstantLeg)
    }


def robot_statics(
    posture: Posture, preset: Preset, limits: AgreementLimits = DEFAULT_LIMITS
) -> RobotStatics:
    """Tool motions with solid legs and with the corresponding beams, on two meshes of a preset."""
    mechanism = posture.mechanism
    legs, ends = prisms(mechanism), _ends(mechanism, limits)
    meshes = {name: mesh_pair(leg, most_unknowns(preset, leg)) for name, leg in legs.items()}
    # If both meshes share the section mesh, a third one gives the uncertainty of the section
    # constants.
    other = {
        name: coarse if coarse != fine else SECTION_DIVISIONS
        for name, ((coarse, _), (fine, _)) in meshes.items()
    }

    def motions(spring: Spring, mesh: int = FINE) -> Array:
        tips = {name: spring(name, leg, mesh) for name, leg in legs.items()}
        bodies = links(mechanism, tips)
        return np.diag(compliance(solved(assembly(mechanism, bodies).at(posture)))).copy()

    def on_both(spring: Spring) -> Array:
        return np.array([motions(spring, mesh) for mesh in (COARSE, FINE)])

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


def robot_modes(
    posture: Posture, meshes: SolidMeshes, count: int, limits: AgreementLimits = DEFAULT_LIMITS
) -> RobotModes:
    """Frequencies with solid legs and with the corresponding beams, on two meshes.

    `count` modes are computed for each model.
    """
    legs, ends = prisms(posture.mechanism), _ends(posture.mechanism, limits)
    free: Holds = dict.fromkeys(legs, "free")

    def solids(hold: Holds) -> list[PathModes]:
        return [solid_vibration((posture,), Reading(hold), mesh, count) for mesh in meshes]

    free_ends = solids(free)
    specified = free_ends if ends == free else solids(ends)
    reference = specified[FINE]

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
        return partner(computed_beam_vibration((posture,), meshes.fine, hold, None, count))[0]

    def by_formula(side: int) -> Array:
        beams = {
            leg: beam_leg(
                mesh_formula_band(leg, section_mesh(leg.section, faces[FINE][name]))[side],
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
    legs = prisms(posture.mechanism)
    bodies = {name: filled(reduced[leg].matrices) for name, leg in legs.items()}
    modes = modes_along(assembly(posture.mechanism, bodies), (posture,), count)
    return vibration_of(samples_of(posture.mechanism), modes, count), reduced
