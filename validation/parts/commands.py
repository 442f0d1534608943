"""The commands `faces` and `identify`, as the command line takes them up."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from lumped.errors import InputError
from validation.console.streams import complain, say

Unit = Literal["m", "mm", "cm", "inch"]


def faces(
    part: Path,
    *,
    unit: Unit | None = None,
    out: Path | None = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """List the faces of a CAD part or of a mesh, and draw them numbered.

    Parameters
    ----------
    part
        A STEP or BREP file, or a volume mesh (.msh, .inp, .vtu).
    unit
        Unit of length of a file that names none.
    out
        Folder for PART.faces.png and PART.faces.html; this one if left out.
    json
        Print JSON for programs, and draw nothing.
    """
    from meshes.part.read import read_part  # noqa: PLC0415
    from validation.parts import face_list  # noqa: PLC0415

    found = read_part(part, unit)
    if json:
        say(face_list.as_json(found))
        return 0
    say(face_list.as_text(found))
    from validation.case import Skip  # noqa: PLC0415
    from validation.parts import face_pictures  # noqa: PLC0415

    folder = Path() if out is None else out
    try:
        drawn = face_pictures.picture(found)
        page = face_pictures.scene_page(found)
    except Skip as reason:
        return complain([str(reason)], 0)
    if drawn.left_out:
        complain([drawn.left_out], 0)
    else:
        _write(folder / f"{part.name}.faces.png", drawn.png)
    _write(folder / f"{part.name}.faces.html", page.encode())
    return 0


def _write(path: Path, content: bytes) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from error
    complain([f"{path} written"], 0)
