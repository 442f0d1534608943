"""The picture of a mechanism that stands beside its verdict."""

from io import BytesIO

from validation.adequacy.mechanism.path import path_postures
from validation.context import Context
from validation.drawing.rendering import Picture
from validation.drawing.style import plot_style
from validation.exhibits import PATH, PORTRAIT
from validation.kinematics.picture import picture
from validation.report.figures.declared import FigureGroup, Shown

_DOTS = 200  # per inch
_HALF = 4.2  # in, beside the errors


figures = FigureGroup(PATH, "pictures")


@figures.figure(PORTRAIT, "The mechanism")
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
