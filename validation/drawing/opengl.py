"""Whether this machine can draw 3-D pictures: tried elsewhere, since VTK dies without OpenGL.

VTK ends the whole process where no usable OpenGL is found, so that it must not be tried here.
Scenes that are turned in a browser need neither.
"""

import os
import sys

from lumped.errors import ComputationError
from lumped.memo import memo
from meshes.processes import in_own_process

# "off": no pictures, whatever the machine can do.
SWITCH = "FLEXPROOF_OPENGL"
WINDOW = "VTK_DEFAULT_OPENGL_WINDOW"
MESSAGE = (
    "no usable OpenGL, 3-D pictures are left out; on Debian and Ubuntu the packages libegl1 and "
    "libgl1 bring it"
)
_TIME_LIMIT = 60.0  # s: importing VTK from a cold disk takes up to ten


def can_draw() -> bool:
    """Whether pictures can be drawn here; if so, VTK is made to draw off-screen in this process.

    Call it before pyvista is imported.
    """
    window = usable_window()
    if window is None:
        return False
    if window:
        os.environ[WINDOW] = window
    os.environ["PYVISTA_OFF_SCREEN"] = "true"
    # What can be drawn has been found out here; pyvista would ask again for every picture.
    os.environ["ALLOW_PLOTTING"] = "true"
    return True


def usable_window() -> str | None:
    """VTK's class of window that works here, "" for its default, None where none works."""
    if os.environ.get(SWITCH, "").lower() == "off":
        return None
    return _first_usable()


@memo(1)
def _first_usable() -> str | None:
    return next(filter(_is_drawn_elsewhere, _windows()), None)


def _windows() -> tuple[str, ...]:
    """Windows to try: EGL needs no display and, unlike X, complains to nobody."""
    chosen = os.environ.get(WINDOW)
    if chosen:
        return (chosen,)
    if sys.platform != "linux":
        return ("",)
    return ("vtkEGLRenderWindow", *([""] if os.environ.get("DISPLAY") else []))


def _is_drawn_elsewhere(window: str) -> bool:
    try:
        return in_own_process(_is_drawn, window, patience=_TIME_LIMIT)
    except ComputationError:
        return False


def _is_drawn(kind: str) -> bool:
    """Draw a sphere into a window ("" for VTK's default), and see whether it is there."""
    if kind:
        os.environ[WINDOW] = kind
    from vtkmodules import (  # noqa: PLC0415
        vtkFiltersSources,
        vtkRenderingCore,
        vtkRenderingOpenGL2,  # noqa: F401  brings the classes that draw
    )

    window = vtkRenderingCore.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(16, 16)
    source = vtkFiltersSources.vtkSphereSource()
    mapper = vtkRenderingCore.vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    actor = vtkRenderingCore.vtkActor()
    actor.SetMapper(mapper)
    renderer = vtkRenderingCore.vtkRenderer()
    renderer.AddActor(actor)
    window.AddRenderer(renderer)
    window.Render()
    grabbed = vtkRenderingCore.vtkWindowToImageFilter()
    grabbed.SetInput(window)
    grabbed.Update()
    low, high = grabbed.GetOutput().GetScalarRange()
    return bool(high > low)
