"""Statics of the robot with solid legs over its stroke, against virtual joints."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from validation.case import Measurement, Relative, Skip, others
from validation.case_group import CaseGroup
from validation.cases.robot.stroke import CURVES, at_stations, largest_difference
from validation.context import Context, Preset
from validation.exhibits import SOLID_ROBOT, Study
from validation.models.legs import constant_leg_of
from validation.solids.robots import has_meshes, mesh_pair
from validation.solids.size import larger_preset
from validation.studies.stroke_statics import stroke_statics

# Unknowns of the finest section mesh; three meshes at least are taken from the ladder.
UNKNOWNS: dict[Preset, int] = {"quick": 900, "standard": 900, "fine": 2000}
# Relative tolerance of deflections: the mesh at the edges of held faces, 3e-5 of I-sections.
_STATICS = 2e-4
_CITATION = "virtual joint method, eqs (3) to (9), "

cases = CaseGroup(
    unit="µm",
    reference_kind="independent-solver",
    tolerance=Relative(_STATICS),
    model="solid",
    section=SOLID_ROBOT,
    group="robot.solid.statics",
    effort=1.0,
)
_CURVE = "name, curve, meaning"
_MIDDLE = "{meaning}, middle of the stroke"
_OWN = _CITATION + "Timoshenko legs of the sections' own finite-element constants"


@dataclass(frozen=True)
class _Curve:
    """One deflection over the stroke (µm, m values each), named as in StrokeStatics.

    Uncertainties: of `rigid` and `free` themselves, and of `rigid` less `held` or `torsion` and
    `free` less `own`, which have one section mesh, whose errors they share.
    """

    x: Array
    rigid: Array
    free: Array
    held: Array
    own: Array
    textbook: Array
    torsion: Array
    uncertainty_rigid: Array
    uncertainty_free: Array
    uncertainty_held: Array
    uncertainty_left: Array
    uncertainty_torsion: Array


def _curve(context: Context, curve: str) -> _Curve:
    try:
        found = context.get(stroke_statics, context.robot, UNKNOWNS[context.preset])
    except InputError as error:
        if _meshed(context, context.preset):
            raise
        takes = larger_preset(context.preset, lambda one: bool(_meshed(context, one)))
        raise Skip(
            f"{'; '.join(error.faults)}: too many for preset {context.preset}; {takes} takes it"
        ) from error
    (
        (coarse_rigid, rigid),
        (coarse_free, free),
        (coarse_held, held),
        (coarse_own, own),
        (coarse_torsion, torsion),
    ) = (
        (getattr(coarse, curve), getattr(fine, curve))
        for coarse, fine in (found.rigid, found.free, found.held, found.own, found.torsion)
    )
    smooth, corners, edges = found.factors
    return _Curve(
        x=found.x,
        rigid=rigid,
        free=free,
        held=held,
        own=own,
        textbook=getattr(found.textbook, curve),
        torsion=torsion,
        # What free ends change of it is not the held edges'.
        uncertainty_rigid=corners * np.abs(free - coarse_free)
        + edges * np.abs((rigid - free) - (coarse_rigid - coarse_free)),
        uncertainty_free=corners * np.abs(free - coarse_free),
        uncertainty_held=smooth * np.abs((rigid - held) - (coarse_rigid - coarse_held)),
        uncertainty_left=smooth * np.abs((free - own) - (coarse_free - coarse_own)),
        uncertainty_torsion=smooth * np.abs((rigid - torsion) - (coarse_rigid - coarse_torsion)),
    )


def _meshed(context: Context, preset: Preset) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Both meshes of each leg with a preset's unknowns; [] where one leg has none."""
    legs = [constant_leg_of(context, number) for number in (1, 2)]
    if not all(has_meshes(leg, UNKNOWNS[preset]) for leg in legs):
        return []
    return [mesh_pair(leg, UNKNOWNS[preset]) for leg in legs]


def _is_finer(context: Context, preset: Preset) -> bool:
    return _meshed(context, preset) != _meshed(context, context.preset)


def _decided(measurement: Measurement, context: Context) -> Measurement:
    """The measurement; Skip where two meshes, three times their step, leave it undecided."""
    places = [
        (measurement.unexplained, measurement.reference, measurement.numerical_uncertainty),
        *((one.difference, one.reference, one.uncertainty) for one in measurement.elsewhere),
    ]
    for difference, reference, uncertainty in places:
        if abs(difference) <= _STATICS * abs(reference) < (uncertainty or 0.0):
            has = larger_preset(context.preset, partial(_is_finer, context))
            raise Skip(
                f"two meshes of these sections show no order, and their uncertainty of "
                f"{100.0 * (uncertainty or 0.0) / abs(reference):.2g} % exceeds the tolerance in "
                f"preset {context.preset}; {has} has finer ones"
            )
    return measurement


@cases.case(
    "robot.solid.statics-rigid.{name}",
    "Solid legs with rigid end faces give the {meaning} of virtual joints whose legs have held "
    "faces",
    over={_CURVE: CURVES},
    quantity=_MIDDLE,
    headlines=("robot.statics.solid",),
    citation=_OWN + ", less what held faces take from them (fem.couplings.end_effects)",
    tolerance_reason="end effects decay as Saint-Venant's theory of the prism says: the mesh "
    "alone, 0.02 %",
)
def _rigid(context: Context, curve: str) -> Measurement:
    found = _curve(context, curve)
    share = 100.0 * (found.rigid / found.textbook - 1.0)
    taken = f"held faces take up to {100.0 * np.max(1.0 - found.held / found.own):.3g} %"
    measured = replace(
        _in_the_middle(
            found, found.rigid, found.held, found.uncertainty_rigid, found.uncertainty_held
        ),
        notes=(largest_difference(found.x.tolist(), found.rigid, found.held), taken),
        table={
            "x (m)": tuple(found.x.tolist()),
            "virtual joints, textbook legs (µm)": tuple(found.textbook.tolist()),
            "virtual joints, held faces (µm)": tuple(found.held.tolist()),
            "solid, rigid faces (µm)": tuple(found.rigid.tolist()),
            "solid, free ends (µm)": tuple(found.free.tolist()),
            "rigid faces to textbook (%)": tuple(share.tolist()),
        },
        studies=(_study(curve, found),),
    )
    return _decided(measured, context)


@cases.case(
    "robot.solid.statics-free.{name}",
    "Solid legs with ends free to warp give the virtual joints' {meaning}",
    over={_CURVE: CURVES},
    quantity=_MIDDLE,
    headlines=("robot.statics.solid",),
    citation=_OWN,
    tolerance_reason="with Saint-Venant's tractions both are one theory: the mesh alone, 0.02 %",
)
def _free(context: Context, curve: str) -> Measurement:
    found = _curve(context, curve)
    measured = _in_the_middle(
        found, found.free, found.own, found.uncertainty_free, found.uncertainty_left
    )
    return _decided(measured, context)


def _in_the_middle(
    found: _Curve, value: Array, reference: Array, uncertainty: Array, judged: Array
) -> Measurement:
    """Value and reference in the middle of the stroke, all postures judged.

    `uncertainty` is that of the value, `judged` that of the difference.
    """
    stations, middle = found.x.tolist(), len(found.x) // 2
    return Measurement(
        float(value[middle]),
        float(reference[middle]),
        value_uncertainty=float(uncertainty[middle]),
        judged_uncertainty=float(judged[middle]),
        notes=(largest_difference(stations, value, reference),),
        pose=(stations[middle],),
        elsewhere=others(at_stations(stations), value, reference, judged, middle),
    )


def _study(curve: str, found: _Curve) -> Study:
    return Study(
        id=f"robot.solid.statics.{curve}",
        kind="sweep",
        title=f"{curve.replace('_', ' ')}: solid legs and virtual joints",
        x_label="x (m)",
        y_label="deflection",
        unit="µm",
        x=tuple(found.x.tolist()),
        series={
            "vjm": tuple(found.textbook.tolist()),
            "solid, rigid end faces": tuple(found.rigid.tolist()),
            "solid, free ends": tuple(found.free.tolist()),
        },
    )
