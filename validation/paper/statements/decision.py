"""What the paper concludes of the length of the legs, and of sixty modes, with legs as solids."""

import numpy as np

from fem.bodies.solid import solid_leg_matrices
from lumped.arrays import Array
from validation.agreement.convergence import step_factor
from validation.case import Absolute, Measurement, Sides
from validation.cases.mechanism.quantities import ASSEMBLER
from validation.context import Context, Preset
from validation.models.options import ModelName, ModelOptions
from validation.paper.robot import (
    ALPHAS,
    FIGURE_POINTS,
    deflections,
    family,
    frequencies,
    member,
    over_stroke,
    unreduced_modes,
)
from validation.paper.statements.statement import PAPER, SIMPLIFIED, Statements
from validation.solids.legs import FORMAL_ORDER, held_solid
from validation.variations.decision import equally_good, spearman

_CONCLUSIONS = "§2.3, §3.3 and conclusions"
_SOLVED: tuple[Preset, ...] = ("standard", "fine")
# Members of the family as solids, elements across the smaller side of their sections.
_MEMBERS = ALPHAS[::2]
_DIVISIONS: dict[Preset, int] = {"standard": 2, "fine": 3}
_COARSE = 1
_POSTURES = 21
_SIXTY = 60
# Share of the strain energy above which a mode is due to a part alone.
_ALONE = 0.95
statements = Statements(**PAPER)


@statements.says(
    "solid.none-due-to-the-actuators",
    "§3.2, the 60 first modes",
    f"None of the first {_SIXTY} modes of the solid robot is due to the feet alone",
    quantity=f"modes with more than {100.0 * _ALONE:g} % of the strain energy in the feet",
    tolerance=Absolute(0.5),
    tolerance_reason="a count: nothing but none will do",
    sides=Sides((solid_leg_matrices, *ASSEMBLER)),
    group="paper.solid.sixty",
    effort=2.0,
    # A count needs a second mesh to be believed, which a quick answer has no time for.
    presets=_SOLVED,
    model="solid",
)
def _due_to_actuators(context: Context) -> Measurement:
    _, centre, _ = over_stroke(context.robot_file.mechanism, 3)[0].postures
    divisions = _DIVISIONS[context.preset]
    coarse, fine = (
        context.get(unreduced_modes, centre, _SIXTY, number) for number in (_COARSE, divisions)
    )
    count, rough = (float(np.sum(found.in_the_feet > _ALONE)) for found in (fine, coarse))
    feet = fine.in_the_feet
    most = int(np.argmax(feet))
    return Measurement(
        count,
        0.0,
        value_uncertainty=step_factor(divisions / _COARSE, FORMAL_ORDER) * abs(count - rough),
        notes=(
            f"at most {100.0 * feet[most]:.2f} %, mode {most + 1} at "
            f"{fine.frequencies[most]:.0f} Hz; at most {100.0 * coarse.in_the_feet.max():.2f} % "
            "on the coarser mesh",
        ),
        table={
            "mode": tuple(float(k) for k in range(1, _SIXTY + 1)),
            "frequency (Hz)": tuple(fine.frequencies.tolist()),
        }
        | {f"{part} (%)": tuple((100.0 * share).tolist()) for part, share in fine.strain.items()},
    )


@statements.says(
    "decision.longest",
    _CONCLUSIONS,
    "The simplified model has nothing against the longest legs",
    quantity="largest α among its best by deflection",
    tolerance=Absolute(0.1),
    tolerance_reason="a tenth of the paper's range of α",
    sides=SIMPLIFIED,
)
def _longest(context: Context) -> Measurement:
    members = (member(context.robot_file, alpha).mechanism for alpha in ALPHAS)
    strokes = (over_stroke(mechanism, _POSTURES) for mechanism in members)
    found = [context.get(deflections, "simplified", places) for places in strokes]
    worst = np.array([one.largest_planar for one in found])
    best = [ALPHAS[number] for number in equally_good(worst, "deflection")]
    note = f"Equally good from α = {best[0]:.4g} on."
    return Measurement(best[-1], reference=ALPHAS[-1], exact=True, notes=(note,))


@statements.says(
    "decision.contradiction[{objective}]",
    _CONCLUSIONS,
    "Solid legs order the family by {objective} against the simplified model",
    over={"objective": ("deflection", "frequency")},
    quantity="Spearman's ρ of simplified and solid over the family, centre of stroke",
    tolerance=Absolute(0.1),
    tolerance_reason="the paper's 'in contradiction': opposite order, but for an exchange of "
    "neighbours among five designs or more, 12/n(n² − 1)",
    sides=Sides(SIMPLIFIED.value, (held_solid,)),
    group="paper.decision",
    effort=3.0,
    presets=_SOLVED,
    model="solid",
)
def _contradiction(context: Context, objective: str) -> Measurement:
    def curve(model: ModelName, divisions: int = _COARSE) -> Array:
        options = ModelOptions(divisions=divisions)
        members = context.get(family, context.robot_file, FIGURE_POINTS["centre"], _MEMBERS)
        if objective == "frequency":
            return context.get(frequencies, model, members, 1, options)[:, 0]
        found = context.get(deflections, model, members, options)
        return found.planar_x if model == "simplified" else found.along_z

    simple, solid = curve("simplified"), curve("solid", _DIVISIONS[context.preset])
    found = spearman(simple, solid)
    what = "deflection (µm)" if objective == "deflection" else "first frequency (Hz)"
    return Measurement(
        found,
        reference=-1.0,
        value_uncertainty=abs(found - spearman(simple, curve("solid"))),
        table={
            "α": _MEMBERS,
            f"simplified: {what}": tuple(simple.tolist()),
            f"solid: {what}": tuple(solid.tolist()),
        },
    )
