"""A part's file read once: what is kept is all that reading found, and of no other file."""

import pytest
from drawn_parts import written
from forgetting import forget

from lumped.memo import fingerprint
from meshes.part.reading.read import read_part
from validation.parts import meshes
from validation.parts.meshes import part_file

pytestmark = pytest.mark.usefixtures("coarse_parts")


def test_what_is_kept_of_a_file_is_all_that_reading_finds(tmp_path, monkeypatch):
    """Its faces are a plate's with a bore; a byte more, or another unit, is another part."""
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "cache"))

    def plate(kernel):
        kernel.cut(
            [(3, kernel.addBox(0, 0, 0, 90, 60, 8))],
            [(3, kernel.addCylinder(30, 30, 0, 0, 0, 8, 9))],
        )

    path = written(tmp_path / "plate.brep", plate)
    found = read_part(path, "mm")
    assert [face.kind for face in found.faces].count("bore") == 1
    assert fingerprint(part_file(path, "mm")) == fingerprint(found)
    asked = []
    monkeypatch.setattr(meshes, "read_part", lambda *one: asked.append(one) or pytest.fail("read"))
    forget()
    assert fingerprint(part_file(path, "mm")) == fingerprint(found)
    assert asked == []
    with pytest.raises(pytest.fail.Exception):
        part_file(path, "m")
    path.write_bytes(path.read_bytes() + b"\n")
    with pytest.raises(pytest.fail.Exception):
        part_file(path, "mm")
