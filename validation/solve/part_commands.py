"""Commands `faces` and `identify` of the command line.

Input: the path of a CAD part, or its name in a robot file, and the options of the command. Output:
text on stdout and the requested files.
"""

from functools import partial
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from lumped.errors import InputError
from validation.console.streams import write_messages, write_results
from validation.console.typed import (
    DEFAULT_SOLVER,
    AsJson,
    Force,
    LengthUnit,
    PathArgument,
    SolverChoice,
    WholeNumber,
    require_writable,
    write,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from validation.run.cache import CacheEntry

# Time (s) of an idle core: to read a byte, to identify a part, and per unknown of its finest mesh.
_READING_A_BYTE, _IDENTIFYING, _EACH_UNKNOWN = 1e-5, 5.0, 2e-4


def faces(
    part: PathArgument,
    *,
    unit: LengthUnit | None = None,
    out: PathArgument | None = None,
    force: Force = False,
    json: bool = False,
) -> int:
    """List the faces of a CAD part or of a mesh, and draw them numbered.

    Parameters
    ----------
    part
        A STEP or BREP file, or a volume mesh (.msh, .inp, .vtu).
    unit
        Unit of length, for a file without one.
    out
        Folder for PART.faces.png and PART.faces.html; by default the current folder.
    json
        Print JSON for programs, and draw nothing.
    """
    from validation.console.progress import stage  # noqa: PLC0415
    from validation.parts import face_list  # noqa: PLC0415
    from validation.parts.meshes import part_file  # noqa: PLC0415

    folder = Path() if out is None else out
    drawing, scene = (folder / f"{part.name}.faces{kind}" for kind in (".png", ".html"))
    if not json:
        require_writable(drawing, ".png", force=force)
        require_writable(scene, ".html", force=force)
    size = part.stat().st_size if part.is_file() else 0
    with stage(f"reading {part.name}", _READING_A_BYTE * size):
        file = part_file(part, unit)
    if json:
        write_results(face_list.as_json(file))
        return 0
    write_results(face_list.as_text(file))
    from validation.parts import face_pictures  # noqa: PLC0415

    with stage("drawing the faces"):
        drawn = face_pictures.picture(file)
    if drawn.left_out:
        write_messages([drawn.left_out], 0)
    else:
        write(drawing, drawn.png, ".png")
    write(scene, face_pictures.scene_page(file).encode(), ".html")
    return 0


def identify(
    part: str,
    *,
    interface: tuple[str, ...] = (),
    material: str | None = None,
    unit: LengthUnit | None = None,
    body: str | None = None,
    free: bool = False,
    unknowns: WholeNumber | None = None,
    modes: WholeNumber | None = None,
    accuracy: float | None = None,
    solver: SolverChoice = DEFAULT_SOLVER,
    cluster: str | None = None,
    out: PathArgument | None = None,
    force: Force = False,
    json: AsJson = False,
) -> int:
    """Identify a part: stiffness, mass and frequencies between its interfaces, with uncertainty.

    Parameters
    ----------
    part
        A STEP or BREP file, a volume mesh (.msh, .inp, .vtu), or with --body a robot.
    interface
        Interface as in a robot file, such as 'A = { cylinder = { radius = 0.04 } }'. Repeat the
        option for each interface; the first one is clamped. `flexproof faces` lists the faces.
    material
        Material as in a robot file (Pa, kg/m³), such as '{ E = 2.1e11, nu = 0.3, rho = 7850.0 }'.
    unit
        Unit of length, for a file without one.
    body
        CAD part of the robot, by its name.
    free
        Frequencies of the part without supports, its six rigid-body motions counted and left out.
        Interfaces are not needed.
    unknowns
        Unknowns of the finest of the three meshes. Default: 100000.
    modes
        Number of frequencies. Default: 6.
    accuracy
        Refine the meshes until the relative half-width of every value is at most this
        number, for example 0.002, within the limits of memory and of 800 000 unknowns.
    cluster
        Address of a Dask scheduler (tcp://host:port), one worker of which meshes and solves the
        part; needs the extra "cluster".
    out
        An .npz file to write all matrices to.
    """
    import numpy as np  # noqa: PLC0415

    from lumped.robot_file import load_robot  # noqa: PLC0415
    from meshes.part.interfaces import find_interfaces  # noqa: PLC0415
    from validation.console.progress import stage  # noqa: PLC0415
    from validation.models.reduced_parts import found_in, shape_of  # noqa: PLC0415
    from validation.parts import identified_text, request  # noqa: PLC0415
    from validation.parts import identify as identifying  # noqa: PLC0415
    from validation.parts.free_modes import free_entry  # noqa: PLC0415
    from validation.parts.meshes import part_file  # noqa: PLC0415
    from validation.run.cluster import requested_executor  # noqa: PLC0415
    from validation.run.provisions import value_by_worker  # noqa: PLC0415
    from validation.uncertainty.refinement import accuracy_faults, refined  # noqa: PLC0415

    solver.request()
    require_writable(out, ".npz", force=force)
    faults = [] if accuracy is None else accuracy_faults(accuracy)
    faults += request.faults_of_numbers(unknowns, modes)
    if body is None and material is None:
        faults.append(
            "--material: missing; add it, for example { E = 2.1e11, nu = 0.3, rho = 7850.0 }"
        )
    if free and interface:
        faults.append("--interface: a part without supports has none; leave it out")
    if free and modes == 0:
        faults.append(
            "--modes 0: a part without supports has no results but frequencies; must be 1 or more"
        )
    if body is not None and (interface or material or unit):
        faults.append(
            "--body: not with --material, --interface or --unit, which are in the robot file "
            "for this body; leave them out"
        )
    if faults:
        raise InputError(faults)
    size = identifying.DEFAULT_UNKNOWNS if unknowns is None else unknowns
    count = identifying.DEFAULT_MODES if modes is None else modes
    if body is not None:
        shape = request.part_of(load_robot(part), body)
        (file, interfaces), properties = found_in(shape), shape_of(shape).material
    else:
        definitions, points = request.interfaces_of(interface) if not free else ({}, {})
        properties = request.material_of(material or "")
        file = part_file(Path(part), unit)
        interfaces = () if free else find_interfaces(file, definitions, points)
    entry_of: Callable[..., CacheEntry[Any]] = partial(free_entry, material=properties, modes=count)
    if not free:
        entry_of = partial(
            identifying.identified_entry, interfaces=interfaces, material=properties, modes=count
        )

    with (
        stage(f"identifying {body or part}", _IDENTIFYING + _EACH_UNKNOWN * size),
        requested_executor(cluster) as executor,
    ):

        def at(size: int) -> Any:
            entry = partial(entry_of, unknowns=size)
            return value_by_worker(executor, file, entry) if cluster else entry(file).value()

        solution, reached = refined(
            size,
            at,
            identifying.largest_half_width,
            identifying.more_unknowns,
            accuracy or np.inf,
        )
    text = identified_text.as_json if json else identified_text.as_text
    write_results(text(solution, reached if accuracy else None))
    if out is not None:
        buffer, arrays = BytesIO(), cast("Any", identified_text.as_arrays(solution))
        np.savez(buffer, **arrays)
        write(out, buffer.getvalue(), ".npz")
    return 0
