"""Whether this machine can draw 3-D pictures: asked in a subprocess, since VTK dies without OpenGL.

VTK ends the whole process where no usable OpenGL is found, so that it must not be tried here.
"""

import os
import subprocess
import sys
from functools import lru_cache

from validation.case import Skip

# "off": no pictures, whatever the machine can do.
SWITCH = "FLEXPROOF_OPENGL"
WINDOW = "VTK_DEFAULT_OPENGL_WINDOW"
MESSAGE = (
    "no usable OpenGL, 3-D pictures are left out; on Debian and Ubuntu the packages libegl1 and "
    "libgl1 bring it"
)
_TIME_LIMIT = 60.0  # s: importing VTK from a cold disk takes up to ten
_PROBE = """
import sys
from vtkmodules import vtkRenderingOpenGL2, vtkRenderingCore, vtkFiltersSources
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
sys.exit(0 if high > low else 1)
"""


def require_opengl() -> None:
    """Make VTK draw off-screen in this process; raises Skip where it cannot.

    Call it before pyvista is imported.
    """
    window = usable_window()
    if window is None:
        raise Skip(MESSAGE)
    if window:
        os.environ[WINDOW] = window
    os.environ["PYVISTA_OFF_SCREEN"] = "true"


def usable_window() -> str | None:
    """VTK's class of window that works here, "" for its default, None where none works."""
    if os.environ.get(SWITCH, "").lower() == "off":
        return None
    return _first_usable()


@lru_cache(maxsize=1)
def _first_usable() -> str | None:
    return next((window for window in _windows() if renders(window)), None)


def _windows() -> tuple[str, ...]:
    """Windows to try: EGL needs no display and, unlike X, complains to nobody."""
    chosen = os.environ.get(WINDOW)
    if chosen:
        return (chosen,)
    if sys.platform != "linux":
        return ("",)
    return ("vtkEGLRenderWindow", *([""] if os.environ.get("DISPLAY") else []))


def renders(window: str) -> bool:
    """Whether a process of its own can draw a sphere into `window` ("" for VTK's default)."""
    environment = dict(os.environ)
    if window:
        environment[WINDOW] = window
    try:
        done = subprocess.run(  # noqa: S603  our own interpreter and text
            [sys.executable, "-c", _PROBE],
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_TIME_LIMIT,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0
