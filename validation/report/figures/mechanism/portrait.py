"""The picture of a mechanism that stands beside its verdict."""

from io import BytesIO

from validation.adequacy.mechanism.path import path_postures
from validation.context import Context
from validation.drawing.style import plot_style
from validation.exhibits import PATH, PORTRAIT, Drawing, Figure
from validation.kinematics.picture import picture

_DOTS = 200  # per inch
_HALF = 4.2  # in, beside the errors


def drawings() -> tuple[Drawing, ...]:
    """The picture."""
    return (Drawing(PORTRAIT, "The mechanism", portrait, section=PATH, group="pictures"),)


def portrait(context: Context) -> Figure:
    """The middle pose in full, the first and the last as lines."""
    postures = path_postures(context)
    shown = [postures[0], postures[len(postures) // 2], postures[-1]]
    content = BytesIO()
    with plot_style():
        drawn = picture(context.robot_file.mechanism, shown, _HALF, named=False)
        drawn.savefig(content, dpi=_DOTS, format="png")
    return Figure(
        id=PORTRAIT,
        title="The mechanism",
        caption="In the middle of its path; thin lines: first and last pose. Driven joints are "
        "orange, the loaded point red.",
        section=PATH,
        png=content.getvalue(),
    )
