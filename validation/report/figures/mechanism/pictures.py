"""Pictures of a mechanism: the one beside its verdict, its first modes, and how it yields."""

from lumped.models.bodies import legs_of
from validation.adequacy.mechanism.path import path_postures
from validation.case import Skip
from validation.context import Context
from validation.exhibits import PATH, PORTRAIT
from validation.kinematics.picture import scene
from validation.report.figures.declared import FigureGroup, Shown
from validation.report.figures.mechanism.drawn_modes import finite_elements, segments
from validation.report.figures.mechanism.shapes import FORCE, Pair, modes_of, under_loads

_MODES = 4
# Modes of the segments among which those of the beams are looked for.
_BESIDES = 4
_HALF = 4.2  # in, beside the errors
portraits = FigureGroup(PATH, "pictures")
figures = FigureGroup(PATH, "pictures")


@portraits.figure(PORTRAIT, "The mechanism")
def portrait(context: Context) -> Shown:
    """The middle pose in full, the first and the last as lines."""
    postures = path_postures(context)
    shown = [postures[0], postures[len(postures) // 2], postures[-1]]
    return Shown(
        "In the middle of its path; thin lines: first and last pose. Driven joints are orange, the "
        "loaded point red.",
        scenes=[scene(context.robot_file.mechanism, shown, named=False)],
        width=_HALF,
        turned=False,
    )


@figures.figure("mechanism.mode-shapes", "First mode shapes of the mechanism", effort=4.0)
def mode_shapes(context: Context) -> Shown:
    """A panel for each mode: beams coloured by displacement, places of the segments over them."""
    pair = _drawn(context)
    count = min(_MODES, len(pair.beam.modes.frequencies))
    return modes_of(pair, count, "Of modes of one frequency any mixture is one.")


@figures.figure(
    "mechanism.deformed", f"The mechanism under {FORCE:g} N along x, y and z", effort=3.0
)
def deformed(context: Context) -> Shown:
    """A panel for each force, each with its own scale."""
    return under_loads(_drawn(context))


def _drawn(context: Context) -> Pair:
    """Finite elements, and the segments beside them."""
    mechanism = context.robot_file.mechanism
    prisms, parts = bool(legs_of(mechanism)), bool(mechanism.parts)
    if not (prisms or parts):
        raise Skip("all bodies are rigid: there are no shapes to be drawn")
    model = f"Parts as solids{' and other legs as beams' * prisms}" if parts else "Beam model"
    return Pair(
        finite_elements(context, _MODES),
        segments(context, _MODES + _BESIDES),
        f"{model} in the middle of the path",
        "with parts condensed on their interfaces" if parts else "by segments",
    )
