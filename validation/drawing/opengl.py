"""Whether this machine can draw 3-D pictures: tried elsewhere, since VTK dies without OpenGL.

VTK ends the whole process where no usable OpenGL is found, so that it must not be tried here.
Faces of parts that can be turned need VTK, but no OpenGL; scenes of the report need neither.
"""

import os
import sys
from collections.abc import Callable

from lumped.errors import ComputationError
from lumped.memo import memo
from meshes.processes import in_own_process

# "off": no pictures, whatever the machine can do.
SWITCH = "FLEXPROOF_OPENGL"
WINDOW = "VTK_DEFAULT_OPENGL_WINDOW"
PACKAGES = "on Debian and Ubuntu the packages libegl1 and libgl1 bring it"
MESSAGE = f"no usable OpenGL, 3-D pictures are left out; {PACKAGES}"
NOTHING = f"no usable OpenGL, 3-D pictures and scenes are left out; {PACKAGES}"
_TIME_LIMIT = 60.0  # s: importing VTK from a cold disk takes up to ten


def require_vtk() -> None:
    """Make VTK work off-screen in this process; raises Skip where not even scenes can be made.

    Call it before pyvista is imported.
    """
    # Numerical libraries, of which those that try a window have no need.
    from validation.case import Skip  # noqa: PLC0415

    window = usable_window()
    if window is None and not describes():
        raise Skip(NOTHING)
    if window:
        os.environ[WINDOW] = window
    os.environ["PYVISTA_OFF_SCREEN"] = "true"
    # What can be drawn has been found out here; pyvista would ask again for every picture.
    os.environ["ALLOW_PLOTTING"] = "true"


def usable_window() -> str | None:
    """VTK's class of window that works here, "" for its default, None where none works."""
    if os.environ.get(SWITCH, "").lower() == "off":
        return None
    return _first_usable()


@memo(1)
def _first_usable() -> str | None:
    return next((window for window in _windows() if _succeeds(_is_drawn, window)), None)


def _windows() -> tuple[str, ...]:
    """Windows to try: EGL needs no display and, unlike X, complains to nobody."""
    chosen = os.environ.get(WINDOW)
    if chosen:
        return (chosen,)
    if sys.platform != "linux":
        return ("",)
    return ("vtkEGLRenderWindow", *([""] if os.environ.get("DISPLAY") else []))


@memo(1)
def describes() -> bool:
    """Whether VTK makes surfaces where it draws none, tried in a process of its own."""
    return _succeeds(_is_described)


def _succeeds(attempt: Callable[..., bool], *arguments: str) -> bool:
    try:
        return in_own_process(attempt, *arguments, patience=_TIME_LIMIT)
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


def _is_described() -> bool:
    import pyvista  # noqa: PLC0415

    return bool(pyvista.Sphere().n_points)
