"""Test whether this machine can draw 3-D pictures with OpenGL.

Input: environment variables. Output: true or false, with VTK set to a window class that works.
Rule: a sphere is drawn in another process, because VTK ends the whole process if OpenGL is not
usable. Scenes that are turned in a browser need neither VTK nor OpenGL.
"""

import os
import sys

from lumped.errors import ComputationError
from lumped.memo import memo
from meshes.processes import in_own_process

# Environment variable that suppresses 3-D pictures if its value is "off".
SWITCH = "FLEXPROOF_OPENGL"
WINDOW = "VTK_DEFAULT_OPENGL_WINDOW"
MESSAGE = (
    "no usable OpenGL, so 3-D pictures are left out; on Debian and Ubuntu install libegl1 and "
    "libgl1"
)
_TIME_LIMIT = 60.0  # s: importing VTK from a cold disk takes up to ten


def can_draw() -> bool:
    """True if this machine can draw 3-D pictures. Sets VTK to draw off-screen.

    It must be called before pyvista is imported.
    """
    if os.environ.get(SWITCH, "").lower() == "off" or (window := _usable_window()) is None:
        return False
    if window:
        os.environ[WINDOW] = window
    os.environ["PYVISTA_OFF_SCREEN"] = "true"
    # Without this variable, pyvista would repeat the test for each picture.
    os.environ["ALLOW_PLOTTING"] = "true"
    return True


@memo(1)
def _usable_window() -> str | None:
    """VTK window class that works on this machine. "" for the default, None if none works."""
    return next(filter(_draws_in_other_process, _windows()), None)


def _windows() -> tuple[str, ...]:
    """VTK window classes to try. EGL is first: it needs no display and, unlike X, logs nothing."""
    user_choice = os.environ.get(WINDOW)
    if user_choice:
        return (user_choice,)
    if sys.platform != "linux":
        return ("",)
    return ("vtkEGLRenderWindow", *([""] if os.environ.get("DISPLAY") else []))


def _draws_in_other_process(window: str) -> bool:
    try:
        return in_own_process(_draws, window, patience=_TIME_LIMIT)
    except ComputationError:
        return False


def _draws(kind: str) -> bool:
    """True if a sphere drawn into a window gives an image that is not uniform.

    `kind` is the window class, "" for VTK's default.
    """
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
    image = vtkRenderingCore.vtkWindowToImageFilter()
    image.SetInput(window)
    image.Update()
    low, high = image.GetOutput().GetScalarRange()
    return bool(high > low)
