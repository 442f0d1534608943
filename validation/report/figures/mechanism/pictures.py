"""Pictures of a mechanism: the one beside its verdict, its first modes, and how it yields."""

from io import BytesIO

from lumped.models.bodies import legs_of
from validation.adequacy.mechanism.path import path_postures
from validation.case import Skip
from validation.context import Context
from validation.drawing.opengl import require_vtk
from validation.drawing.rendering import Picture
from validation.drawing.style import plot_style
from validation.exhibits import PATH, PORTRAIT
from validation.kinematics.picture import picture
from validation.models.mechanism_modes import PostureModes
from validation.report.figures.declared import FigureGroup, Shown
from validation.report.figures.mechanism.drawn_modes import finite_elements, segments
from validation.report.figures.mechanism.shapes import FORCE, modes_of, moves, under_loads

_MODES = 4
# Modes of the segments among which those of the beams are looked for.
_BESIDES = 4
_DOTS = 200  # per inch
_HALF = 4.2  # in, beside the errors
portraits = FigureGroup(PATH, "pictures")
figures = FigureGroup(PATH, "pictures")


@portraits.figure(PORTRAIT, "The mechanism")
def portrait(context: Context) -> Shown:
    """The middle pose in full, the first and the last as lines."""
    postures = path_postures(context)
    shown = [postures[0], postures[len(postures) // 2], postures[-1]]
    content = BytesIO()
    with plot_style():
        drawn = picture(context.robot_file.mechanism, shown, _HALF, named=False)
        drawn.savefig(content, dpi=_DOTS, format="png")
    return Shown(
        "In the middle of its path; thin lines: first and last pose. Driven joints are orange, the "
        "loaded point red.",
        picture=Picture(content.getvalue()),
    )


@figures.figure("mechanism.mode-shapes", "First mode shapes of the mechanism", effort=4.0)
def mode_shapes(context: Context) -> Shown:
    """A panel for each mode: beams coloured by displacement, places of the segments over them."""
    beam, beside = _drawn(context)
    found = modes_of(beam, beside, min(_MODES, len(beam.modes.frequencies)))
    said = (
        f"{_drawn_by(beam)} in the middle of the path, coloured by displacement, thin lines: at "
        f"rest. Orange squares: the same mode {_beside(beam)}; orange outlines in three "
        "dimensions. Of modes of one frequency any mixture is one."
    )
    return Shown(said, picture=found.picture, data=found.data, scenes=found.scenes)


@figures.figure(
    "mechanism.deformed", f"The mechanism under {FORCE:g} N along x, y and z", effort=3.0
)
def deformed(context: Context) -> Shown:
    """A panel for each force, each with its own scale."""
    beam, beside = _drawn(context)
    found = under_loads(beam, beside)
    said = (
        f"{_drawn_by(beam)} in the middle of the path, each picture with the enlargement named "
        f"above it. {moves(found)} Red arrow: the force; orange outlines in three dimensions: the "
        f"same {_beside(beam)}."
    )
    return Shown(said, picture=found.picture, data=found.data, scenes=found.scenes)


def _drawn(context: Context) -> tuple[PostureModes, PostureModes]:
    """Finite elements, and the segments beside them."""
    mechanism = context.robot_file.mechanism
    if not (legs_of(mechanism) or mechanism.parts):
        raise Skip("all bodies are rigid: there are no shapes to be drawn")
    require_vtk()
    return finite_elements(context, _MODES), segments(context, _MODES + _BESIDES)


def _drawn_by(drawn: PostureModes) -> str:
    mechanism = drawn.posture.mechanism
    if not mechanism.parts:
        return "Beam model"
    return "Parts as solids" + (" and other legs as beams" if legs_of(mechanism) else "")


def _beside(drawn: PostureModes) -> str:
    if not drawn.posture.mechanism.parts:
        return "of the segments"
    return "with parts condensed on their interfaces"
