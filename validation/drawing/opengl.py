"""Whether this machine can draw 3-D pictures: asked in a subprocess, since VTK dies without OpenGL.

VTK ends the whole process where no usable OpenGL is found, so that it must not be tried here.
Scenes that can be turned in the report need VTK, but no OpenGL.
"""

import os
import subprocess
import sys
from functools import lru_cache

from validation.case import Skip

# "off": no pictures, whatever the machine can do.
SWITCH = "FLEXPROOF_OPENGL"
WINDOW = "VTK_DEFAULT_OPENGL_WINDOW"
PACKAGES = "on Debian and Ubuntu the packages libegl1 and libgl1 bring it"
MESSAGE = f"no usable OpenGL, 3-D pictures are left out; {PACKAGES}"
NOTHING = f"no usable OpenGL, 3-D pictures and scenes are left out; {PACKAGES}"
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


def require_vtk() -> None:
    """Make VTK work off-screen in this process; raises Skip where not even scenes can be made.

    Call it before pyvista is imported.
    """
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


@lru_cache(maxsize=1)
def _first_usable() -> str | None:
    return next((window for window in _windows() if renders(window)), None)


@lru_cache(maxsize=1)
def describes() -> bool:
    """Whether VTK can describe a scene without drawing it, tried in a process of its own."""
    return _succeeds(_DESCRIBED, dict(os.environ))


_DESCRIBED = """
import os
os.environ["ALLOW_PLOTTING"] = "true"
import pyvista
pyvista.Plotter(off_screen=True).add_mesh(pyvista.Sphere())
"""


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
    return _succeeds(_PROBE, environment)


def _succeeds(text: str, environment: dict[str, str]) -> bool:
    try:
        done = subprocess.run(  # noqa: S603  our own interpreter and text
            [sys.executable, "-c", text],
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_TIME_LIMIT,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0
