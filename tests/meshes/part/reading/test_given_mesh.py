"""Volume meshes of other programs: the same mesh in three formats gives the same part."""

import lzma
import zlib
from base64 import b64encode

import gmsh
import meshio
import numpy as np
import pytest
from support.robots.drawn_parts import meshed
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

from lumped.errors import InputError
from lumped.mechanism.body import ByCylinder, ByName, PartInterface
from meshes.elements import ELEMENTS
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.part.reading.vtu_sizes import inflated_size

pytestmark = pytest.mark.usefixtures("in_this_process")


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Return a folder with a bored plate of quadratic tetrahedra, in mm, as .msh, .inp and .vtu."""
    folder = tmp_path_factory.mktemp("meshes")

    def draw(occ):
        plate, bore = occ.addBox(-30, -20, 0, 60, 40, 10), occ.addCylinder(0, 0, -5, 0, 0, 20, 8)
        occ.cut([(3, plate)], [(3, bore)])
        occ.synchronize()
        faces = [tag for _, tag in gmsh.model.getEntities(2)]
        bores = [tag for tag in faces if gmsh.model.getType(2, tag) == "Cylinder"]
        gmsh.model.addPhysicalGroup(2, bores, name="bore")
        gmsh.model.addPhysicalGroup(3, [gmsh.model.getEntities(3)[0][1]], name="plate")

    raw = meshio.read(meshed(folder / "plate.msh", draw, 12.0, 12.0))
    solid = [block for block in raw.cells if block.type == "tetra10"]
    plain = meshio.Mesh(raw.points, [("tetra10", solid[0].data)])
    for suffix in (".inp", ".vtu"):
        meshio.write(folder / f"plate{suffix}", plain)
    return folder


def test_mesh_formats_give_one_part(files):
    """Plate with a bore as .msh, .inp and .vtu: equal nodes, elements and bore."""
    parts = [read_part(files / f"plate{suffix}", "mm") for suffix in (".msh", ".inp", ".vtu")]
    first = parts[0]
    assert first.size == "read in mm: 60 × 40 × 10 mm"
    for part in parts:
        (bore,) = [face for face in part.faces if face.kind == "bore"]
        assert bore.radius == pytest.approx(8e-3, rel=1e-6)
        assert part.mesh.element == "tet10"
        # The formats store at least 12 digits, and the nodes in different orders.
        order, first_order = (np.lexsort(np.round(p.mesh.nodes, 9).T) for p in (part, first))
        assert part.mesh.nodes[order] == pytest.approx(first.mesh.nodes[first_order], abs=1e-12)
    assert len(first.faces) == 7


def test_physical_group_selects_interface(files):
    """A group of gmsh called "bore" selects the faces of that cylinder."""
    part = read_part(files / "plate.msh", "mm")
    by_name, by_radius = (
        find_interfaces(part, {"A": PartInterface(choice)})[0]
        for choice in (ByName("bore"), ByCylinder(0.008))
    )
    assert by_name.faces == by_radius.faces
    with pytest.raises(InputError, match='did you mean "bore"'):
        find_interfaces(part, {"A": PartInterface(ByName("bores"))})


CUBE = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float
)
HEXAHEDRON = np.arange(8)[None]
FOLDED = HEXAHEDRON[:, [4, 5, 6, 7, 0, 1, 2, 3]]


def two_cubes(*shift, shared=()):
    """Return points and cells of two cubes; `shared` has pairs (node of second, node of first)."""
    nodes = np.arange(16)
    for second, first in shared:
        nodes[second] = first
    return np.vstack([CUBE, CUBE + shift]), "hexahedron", nodes.reshape(2, 8)


def mesh_file(folder, points, kind, cells, **mesh_options):
    path = folder / ("mesh.inp" if "point_sets" in mesh_options else "mesh.vtu")
    meshio.write(path, meshio.Mesh(0.1 * points, [(kind, cells)], **mesh_options))
    return path


@pytest.mark.parametrize(
    ("points", "kind", "cells", "message"),
    [
        (CUBE, "wedge", [[0, 1, 2, 4, 5, 6]], "kinds wedge; must be of one kind among tetra"),
        (CUBE, "quad", [[0, 1, 2, 3]], "only a surface"),
        (CUBE, "hexahedron", FOLDED, "folded, the first is element 1 at (0.05, 0.05, 0.05) m"),
        (CUBE, "tetra", [[0, 0, 1, 2]], "inverted or folded"),
        (*two_cubes(1, 0, 0), "4 nodes coincide with another"),
        (*two_cubes(2, 0, 0), "in 2 pieces that share no face"),
        # Two cubes that share only an edge, then only a corner.
        (*two_cubes(1, 1, 0, shared=[(8, 2), (12, 6)]), "in 2 pieces that share no face"),
        (*two_cubes(1, 1, 1, shared=[(8, 6)]), "in 2 pieces that share no face"),
        (CUBE, "hexahedron", HEXAHEDRON[[0, 0]], "given twice, the first is element 1"),
        (1e4 * CUBE, "hexahedron", HEXAHEDRON, "is not the size of a robot's part"),
        (np.where(CUBE == 1.0, np.nan, CUBE), "hexahedron", HEXAHEDRON, "finite"),
    ],
)
def test_bad_mesh_is_refused(tmp_path, points, kind, cells, message):
    """Wedges, mixed types, inverted or flat elements and other faults, each with its reason."""
    with pytest.raises(InputError) as error, np.errstate(all="ignore"):
        read_part(mesh_file(tmp_path, points, kind, np.array(cells)))
    assert message in error.value.faults[0]


@pytest.mark.parametrize(
    ("added", "refused"),
    [
        ("*Ngen\n1, 5, 1", r"\*NGEN"),
        ("*ELGEN, ELSET=all\n1, 2, 1, 1", r"\*ELGEN"),
        ("*NODE, SYSTEM=C\n900, 1.0, 0.0, 0.0", r"SYSTEM of \*NODE"),
        ("*ELEMENT, TYPE=C3D4, INPUT=more.txt", r"INPUT of \*ELEMENT"),
        ("*Instance, name=a, part=b\n10., 0., 0.\n*End Instance", r"the place of \*INSTANCE"),
    ],
)
def test_unknown_keyword_is_refused(files, tmp_path, added, refused):
    """Cards that generate nodes or elements are refused, cards of materials are ignored."""
    text = (files / "plate.inp").read_text()
    path = tmp_path / "plate.inp"
    path.write_text(f"{text}\n{added}\n")
    with pytest.raises(InputError, match=rf"line \d+: {refused} is not supported; write all nodes"):
        read_part(path, "mm")
    # Keywords that do not change nodes or elements are ignored.
    path.write_text(f"{text}\n*MATERIAL, NAME=steel\n*ELASTIC\n2.1e11, 0.3\n*END PART\n")
    assert read_part(path, "mm").size == read_part(files / "plate.inp", "mm").size


def test_missing_deck_node_is_refused(tmp_path):
    """An element with an unlisted node, and a set of nodes that is no element face."""
    path = tmp_path / "mesh.inp"
    nodes = "1, 0., 0., 0.\n2, .1, 0., 0.\n3, 0., .1, 0."
    path.write_text(f"*NODE\n{nodes}\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n")
    with pytest.raises(InputError, match="the file refers to node 4, which it does not contain"):
        read_part(path)
    path = mesh_file(tmp_path, CUBE, "hexahedron", HEXAHEDRON, point_sets={"A": np.array([0])})
    with pytest.raises(InputError, match="contains no complete element face"):
        find_interfaces(read_part(path), {"A": PartInterface(ByName("A"))})


@pytest.mark.parametrize("kind", ["hexahedron", "hexahedron20", "hexahedron27"])
def test_hexahedra_have_six_plane_faces(tmp_path, kind):
    """One cube of 8, 20 or 27 nodes: six plane faces with outward normals."""
    element = ELEMENTS[{"hexahedron": "hex8", "hexahedron20": "hex20"}.get(kind, "hex27")]
    points = element.nodes[list(element.vtk_order)]
    part = read_part(mesh_file(tmp_path, points, kind, np.arange(len(points))[None]))
    assert [face.kind for face in part.faces] == ["plane"] * 6
    assert [face.area for face in part.faces] == pytest.approx([0.01] * 6, rel=1e-12)
    outward = sum(face.direction * face.area for face in part.faces)
    assert outward == pytest.approx(np.zeros(3), abs=1e-15)
    for face in part.faces:
        assert face.direction @ (face.centre - 0.05) == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("mesh.msh", "hello", "the file is damaged, cut off or not in the format of gmsh"),
        ("mesh.vtu", "<html></html>", "the format of vtu: Expected tag 'VTKFile', found html"),
    ],
)
def test_file_without_mesh_is_refused(tmp_path, capfd, name, text, message):
    """Other texts named .msh, .vtu or .inp: one line with the reason."""
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(InputError) as error:
        read_part(path)
    (line,) = error.value.faults
    assert line.startswith(f"{path}: cannot be read as a mesh: ")
    assert message in line
    assert capfd.readouterr() == ("", "")


ENCODINGS = ("binary", "base64", "raw")


VTU = """<VTKFile type="UnstructuredGrid" version="0.1" byte_order="{order}"
header_type="UInt{bits}" compressor="vtk{compressor}DataCompressor"><UnstructuredGrid>
<Piece NumberOfPoints="1" NumberOfCells="1"><Points>
<DataArray type="Float64" NumberOfComponents="3" {array}</DataArray></Points></Piece>
</UnstructuredGrid>{appended}</VTKFile>"""


def vtu_of(folder, encoding, parts, before="", order="LittleEndian", bits=32, compressor="ZLib"):
    """Write a VTU file with one compressed array (head and blocks) after the bytes `before`."""
    array, appended = 'format="binary">\n  {}', ""
    if encoding != "binary":
        array = f"format='appended' offset=\"{len(before)}\">"
        appended = f'<AppendedData encoding="{encoding}">\n _{before}{{}}\n</AppendedData>'
    text = VTU.format(order=order, bits=bits, compressor=compressor, array=array, appended=appended)
    data = b"".join(parts if encoding == "raw" else map(b64encode, parts))
    path = folder / "array.vtu"
    path.write_bytes(text.encode().replace(b"{}", data))
    return path


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize(("order", "bits"), [("LittleEndian", 32), ("BigEndian", 64)])
def test_oversized_vtu_header_is_refused(tmp_path, encoding, order, bits):
    """1.5 GB of zeros compress to 1.5 MB; the file contains only the header of such an array."""
    head = np.array([45_776, 32_768, 100], f"{'<' if bits == 32 else '>'}u{bits // 8}")
    path = vtu_of(tmp_path, encoding, [head.tobytes()], "AAAA", order, bits)
    with pytest.raises(InputError, match=r"unpack to 1499\.96 MB; must be at most 500 MB"):
        read_part(path)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize(("compressor", "library"), [("ZLib", zlib), ("LZMA", lzma)])
def test_invalid_vtu_header_is_refused(tmp_path, encoding, compressor, library):
    """The header of each block states 100 bytes; the block has 1000."""
    block = library.compress(bytes(1000))
    head = np.array([1000, 100, 100, *[len(block)] * 1000], "<u4").tobytes()
    path = vtu_of(tmp_path, encoding, [head, 1000 * block], compressor=compressor)
    with pytest.raises(InputError, match="is longer or shorter than the file specifies"):
        read_part(path)


@pytest.mark.parametrize("compression", ["zlib", "lzma", None])
def test_vtu_header_gives_inflated_size(files, tmp_path, compression):
    """Size of all arrays after decompression, from their headers; 0 without compression."""
    mesh, path = meshio.read(files / "plate.vtu"), tmp_path / "plate.vtu"
    meshio.vtu.write(path, mesh, compression=compression)
    (cells,) = mesh.cells
    # Beside its connectivity each cell has an offset and a type of eight bytes each.
    size = mesh.points.nbytes + cells.data.nbytes + 16 * len(cells.data)
    assert inflated_size(path.read_bytes()) == (size if compression else 0)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("compressor", ["ZLib", "LZMA"])
def test_vtu_file_of_vtk_writer_is_read(files, tmp_path, encoding, compressor):
    """VTK writes appended data (default, as ParaView) or binary data."""
    path = tmp_path / "plate.vtu"
    reader, writer = vtkXMLUnstructuredGridReader(), vtkXMLUnstructuredGridWriter()
    reader.SetFileName(str(files / "plate.vtu"))
    writer.SetFileName(str(path))
    writer.SetInputConnection(reader.GetOutputPort())
    getattr(writer, f"SetCompressorTypeTo{compressor}")()
    writer.SetDataMode(writer.Binary if encoding == "binary" else writer.Appended)
    writer.SetEncodeAppendedData(encoding == "base64")
    writer.SetHeaderTypeToUInt64()
    assert writer.Write()
    rewritten, original = (read_part(file, "mm") for file in (path, files / "plate.vtu"))
    assert [face.area for face in rewritten.faces] == [face.area for face in original.faces]
