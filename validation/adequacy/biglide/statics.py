"""Compliances of the biglide over its stroke: models, ladders of causes, and the reference.

The reference assembles the robot from what its legs are: solids where they are prisms, the 6×6 of
the file where they are given. Ladders climb by the virtual joint method, which shares no code with
that.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from fem.sections.nonuniform_torsion import held_torsion_compliance
from fem.sections.section_constants import SectionConstants, beam_properties, section_constants
from lumped import biglide_assembly, vjm
from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.legs import ConstantLeg, Ends, GivenLeg, Leg, given_compliance, tip_compliance
from meshes.section.section_mesh import section_mesh
from validation.adequacy.response import Alternative, Reference, Response, Rung
from validation.context import Context, Preset
from validation.leg_solids import COARSEST_WALLS, section_counts, static_ladder
from validation.models.biglide import robot_compliance
from validation.models.options import ModelName, ModelOptions
from validation.robot_solids import TwoMeshes, static_leg, two_meshes

# Unknowns of the finest section mesh of a solid leg; the second number where the first one does not
# allow two meshes of its walls.
UNKNOWNS: dict[Preset, tuple[int, int]] = {
    "quick": (900, 2500),
    "standard": (900, 2500),
    "fine": (2000, 5000),
}
# Edges of held faces and inward corners of sections have singular stresses: no energy converges
# more slowly than with this power of the mesh size (M. L. Williams, J. Appl. Mech. 19 (1952) 526).
SLOWEST_ORDER = 4.0 / 3.0
_SAFETY = 3.0
# The same section constants serve all that is not a mesh study.
SECTION_DIVISIONS = 8
_TWICE = SECTION_DIVISIONS / COARSEST_WALLS
# What the legs' own 6×6 is solved to.
_ROUNDING = 1e-9
HOLD: tuple[Ends, Ends] = ("rigid", "free")
OPEN_ENDS = "how the ends are held"
SAY_ENDS = 'say how the legs\' end faces are held: ends = "rigid" or "free" in [leg1], [leg2]'


def compliances(model: ModelName, robot: Biglide, x: Array, options: ModelOptions) -> Response:
    """What a model of the biglide answers; where it knows x and y alone, it is rigid."""
    found = np.zeros((len(x), 6, 6))
    for at, station in enumerate(x.tolist()):
        known = robot_compliance(model, robot, station, options)
        found[at, : len(known), : len(known)] = known
    return Response(compliance=found)


def step_uncertainty(coarse: Array, fine: Array, ratio: float) -> Array:
    """Relative numerical uncertainty of `fine` from one refinement by `ratio` (any shape).

    Roache's estimate for two meshes, safety factor three, with the lowest order there can be.
    """
    factor = _SAFETY / (ratio**SLOWEST_ORDER - 1.0)
    return np.asarray(factor * np.abs(coarse / fine - 1.0))


def holds(robot: Biglide) -> dict[str, tuple[Ends, Ends]]:
    """Ends of leg 1 and leg 2 by the name of the alternative: what is said, and what is not."""
    said = [_said(leg) for leg in (robot.leg1, robot.leg2)]
    if all(ends is not None for ends in said):
        return {"ends as said": (said[0] or "rigid", said[1] or "rigid")}
    return {f"ends {hold}": (said[0] or hold, said[1] or hold) for hold in HOLD}


def _said(leg: Leg) -> Ends | None:
    # The 6×6 of a given leg has its ends in it.
    return "rigid" if isinstance(leg, GivenLeg) else leg.ends


def static_reference(context: Context, robot: Biglide, x: Array) -> Reference:
    """Solid or given legs, assembled; raises InputError where sections are too fine to mesh."""
    legs = robot.leg1, robot.leg2
    solids = [isinstance(leg, ConstantLeg) for leg in legs]
    meshes = [solid_leg(context, leg) if isinstance(leg, ConstantLeg) else None for leg in legs]
    ratio = min((mesh.ratio for mesh in meshes if mesh), default=1.0)
    section_uncertainty = _section_uncertainty(context, robot, x)
    alternatives = []
    for name, ends in holds(robot).items():
        leg_data = list(zip(legs, meshes, ends, strict=True))
        found = [
            np.array(
                [
                    _assembled(robot, at, [_tip(*one, fine=fine) for one in leg_data])
                    for at in x.tolist()
                ]
            )
            for fine in (False, True)
        ]
        diagonals = [np.diagonal(one, axis1=1, axis2=2) for one in found]
        uncertainty = (
            step_uncertainty(diagonals[0], diagonals[1], ratio)
            if any(solids)
            else np.full(diagonals[1].shape, _ROUNDING)
        )
        uncertainty = uncertainty + section_uncertainty
        alternatives.append(Alternative(name, Response(compliance=found[1]), static=uncertainty))
    return Reference(
        title=_TITLES[solids[0], solids[1]],
        alternatives=alternatives,
        open=OPEN_ENDS if len(alternatives) > 1 else "",
        decides=SAY_ENDS if len(alternatives) > 1 else "",
        computed_by=(
            "fem.bodies.doubling.condensed_leg" if any(solids) else "lumped.legs.given_compliance",
            "lumped.biglide_assembly.compliance",
        ),
    )


_TITLES = {
    (True, True): "robot assembled from solid legs",
    (False, False): "robot assembled from the legs' own 6×6",
    (True, False): "robot assembled from leg 1 as a solid and leg 2 by its own 6×6",
    (False, True): "robot assembled from leg 1 by its own 6×6 and leg 2 as a solid",
}


def solid_leg(context: Context, leg: ConstantLeg) -> TwoMeshes:
    """Tip compliances of a leg as a solid on two meshes, once per run and process.

    Raises InputError where even one section mesh has too many unknowns.
    """
    return context.get(two_meshes, leg, _most(context, leg))


def _most(context: Context, leg: ConstantLeg) -> int:
    """Unknowns of the finest section mesh: more where few do not allow two meshes."""
    first, second = UNKNOWNS[context.preset]
    return first if context.get(static_ladder, leg, first) else second


def _section_uncertainty(context: Context, robot: Biglide, x: Array) -> Array:
    """What section meshes leave open (p×6, relative) where both solids of a leg share one.

    By virtual joints with constants of that mesh and of one twice as fine; else zero.
    """
    legs = robot.leg1, robot.leg2
    shared = [
        isinstance(leg, ConstantLeg) and not context.get(static_ladder, leg, _most(context, leg))
        for leg in legs
    ]
    if not any(shared):
        return np.zeros((len(x), 6))

    def joints(divisions: int) -> Array:
        springs = [
            own_spring(context, leg, divisions if one else SECTION_DIVISIONS)
            for leg, one in zip(legs, shared, strict=True)
        ]
        found = [vjm.compliance(robot, at, (springs[0], springs[1])) for at in x.tolist()]
        return np.diagonal(np.array(found), axis1=1, axis2=2)

    return step_uncertainty(joints(COARSEST_WALLS), joints(SECTION_DIVISIONS), _TWICE)


def _tip(leg: Leg, meshes: TwoMeshes | None, ends: Ends, *, fine: bool) -> Array:
    if meshes is None:
        return given_compliance(leg)
    found = meshes.fine if fine else meshes.coarse
    return found.rigid if ends == "rigid" else found.free


def _assembled(robot: Biglide, x: float, tips: Sequence[Array]) -> Array:
    leg1, leg2 = (
        static_leg(leg, tip, "reference")
        for leg, tip in zip((robot.leg1, robot.leg2), tips, strict=True)
    )
    return biglide_assembly.compliance(biglide_assembly.assemble(robot, x, leg1, leg2))


def static_ladders(context: Context, robot: Biglide, x: Array) -> dict[str, tuple[Rung, ...]]:
    """Rungs for statics by name of the model, each ladder from the model upwards."""
    names = tuple(holds(robot))
    legs = robot.leg1, robot.leg2

    def joints(springs: tuple[Array, Array]) -> Response:
        return Response(np.array([vjm.compliance(robot, at, springs) for at in x.tolist()]))

    def everywhere(response: Response) -> Mapping[str, Response]:
        return dict.fromkeys(names, response)

    given = any(isinstance(leg, GivenLeg) for leg in legs)
    upper: list[Rung] = []
    if not all(isinstance(leg, GivenLeg) for leg in legs):
        own = own_spring(context, legs[0]), own_spring(context, legs[1])
        upper = [
            Rung(
                "textbook section constants",
                "fem.section_constants, tip of the cantilever",
                everywhere(joints(own)),
                "take the section's constants from finite elements",
            ),
            Rung(
                "warping held at the ends",
                "Reissner's torsion with held ends, the section's own Γ",
                {
                    name: joints(_held_springs(context, ends, legs))
                    for name, ends in holds(robot).items()
                },
                "add the warping stiffness",
            ),
            Rung(
                "contraction and warping by shear held at the ends",
                "fem.sections.end_effects, exact along the leg",
                {
                    name: joints(_restrained_springs(context, ends, legs))
                    for name, ends in holds(robot).items()
                },
                "add what rigid end faces take",
            ),
        ]
    as_given = everywhere(joints(vjm.given_leg_springs(robot)))
    section = [
        Rung(
            "equivalent leg: another diagonal than the 6×6",
            "virtual joints with the straight leg's entries of the 6×6",
            everywhere(joints((straight(legs[0]), straight(legs[1])))),
        ),
        Rung(
            "equivalent leg: couplings of the 6×6 left out",
            "virtual joints with the 6×6 as given",
            as_given,
            "take the 6×6 with its couplings",
        ),
    ]
    equivalent = [*section, *upper] if given else upper
    shear = Rung(
        "shear deformation left out",
        "virtual joints with Timoshenko's cantilever",
        everywhere(compliances("vjm", robot, x, ModelOptions(legs="equivalent"))),
        "use Timoshenko",
    )
    drives = Rung(
        "drives only: legs and feet rigid",
        "virtual joints with the legs as given",
        as_given,
        "use vjm",
    )
    return {
        "simplified": (drives, *upper),
        "vjm": tuple(upper),
        "vjm-equivalent": tuple(equivalent),
        "segments": tuple(equivalent),
        "beam": tuple(equivalent),
        "segments-euler-bernoulli": (shear, *equivalent),
        "beam-euler-bernoulli": (shear, *equivalent),
    }


def straight(leg: Leg) -> Array:
    """The entries of a tip compliance that a straight leg of constant section has."""
    tip = given_compliance(leg)
    kept = np.eye(6)
    kept[1, 5] = kept[5, 1] = kept[2, 4] = kept[4, 2] = 1.0
    return tip * kept


def own_spring(context: Context, leg: Leg, divisions: int = SECTION_DIVISIONS) -> Array:
    """Tip compliance (6×6, SI, leg axes): of the 6×6, or of the section's own constants."""
    if isinstance(leg, GivenLeg):
        return leg.compliance
    constants = context.get(own_constants, leg, divisions)
    return tip_compliance(beam_properties(constants, leg.material), leg.length)


def _held_springs(
    context: Context, ends: tuple[Ends, Ends], legs: tuple[Leg, Leg]
) -> tuple[Array, Array]:
    """Springs of the legs' own constants; c44 by non-uniform torsion where ends are held."""
    springs = []
    for leg, hold in zip(legs, ends, strict=True):
        spring = own_spring(context, leg)
        if isinstance(leg, ConstantLeg) and hold == "rigid":
            spring = spring.copy()
            constants = context.get(own_constants, leg)
            spring[3, 3] = held_torsion_compliance(constants, leg.material, leg.length)
        springs.append(spring)
    return springs[0], springs[1]


def _restrained_springs(
    context: Context, ends: tuple[Ends, Ends], legs: tuple[Leg, Leg]
) -> tuple[Array, Array]:
    """Springs of the legs' own constants, less all that rigid faces take where ends are held."""
    springs = []
    for leg, hold in zip(legs, ends, strict=True):
        spring = own_spring(context, leg)
        if isinstance(leg, ConstantLeg) and hold == "rigid":
            spring = spring + solid_leg(context, leg).fine.restrained
        springs.append(spring)
    return springs[0], springs[1]


def own_constants(leg: ConstantLeg, divisions: int = SECTION_DIVISIONS) -> SectionConstants:
    """Constants of a leg's section from finite elements, without thin-wall assumptions."""
    material = leg.material
    mesh = section_mesh(leg.section, section_counts(leg, divisions))
    return section_constants(mesh, material.nu, material.G / material.E)
