import os
import shutil
import subprocess
import tomllib
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
from like_ifw import LEG1, LEG2
from sound_biglide import SOUND as WITHOUT_CORRECTIONS

from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, equivalent_leg
from lumped.models.bodies import legs_of
from lumped.robot_file import as_printed, built_in_robots, load_robot, write_template
from lumped.sections import HollowRectangle

# A sound robot of both kinds of leg; the wrong inputs below differ from it by one edit each.
SOUND = f"""
{WITHOUT_CORRECTIONS}
[[corrections]]
key = "leg2.mass"
printed = 94.0
used = 49.0
reason = "digits swapped"
"""


@dataclass(frozen=True)
class Wrong:
    """An edit of the sound file, and what each line of the message must contain."""

    old: str
    new: str
    lines: tuple[tuple[str, ...], ...]


MATERIAL = "material = { E = 2.1e11, nu = 0.3, rho = 7850.0 }"
SECTION = 'section = { shape = "hollow-rectangle", width = 0.10, height = 0.16, thickness = 0.008 }'
FOOT_ROW_1 = "[1.0e-10, 0.0, 0.0, 0.0, 0.0, 0.0]"
LEG2_ROW_1 = "[3.0e-10, 0.0, 0.0, 0.0, 0.0, 0.0]"
LEG2_MM = """compliance = [
    [3.0e-7, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 2.0e-5, 0.0, 0.0, 0.0, 3.0e-8],
    [0.0, 0.0, 3.0e-5, 0.0, -5.0e-8, 0.0],
    [0.0, 0.0, 0.0, 2.5e-10, 0.0, 0.0],
    [0.0, 0.0, -5.0e-8, 0.0, 1.5e-10, 0.0],
    [0.0, 3.0e-8, 0.0, 0.0, 0.0, 1.0e-10],
]"""
LEG2_COMPLIANCE = SOUND[SOUND.rindex("compliance = [") : SOUND.rindex("\n\n[[corr")]


def edit(old: str, new: str, *lines: tuple[str, ...]) -> Wrong:
    return Wrong(old, new, lines)


WRONG = {
    "toml syntax": edit("mass = 46.0", "mass = 46.0.0", ("not TOML", "line 11")),
    "schema version": edit("schema = 1", "schema = 3", ("schema = 3", "must be 1 or 2")),
    "schema missing": edit("schema = 1", "", ("schema: missing", "must be 1")),
    "type of robot": edit('"biglide"', '"delta"', ('type = "delta"', 'must be "biglide"')),
    "empty name": edit('"test robot"', '""', ('name = ""', "1 to 100 characters")),
    "name on two lines": edit('"test robot"', r'"a\nb"', ("name", "on one line")),
    "unknown table": edit("[foot]", "[Fot]", ("Fot: unknown key", 'did you mean "foot"')),
    "unknown key": edit("a = 0.9", "a = 0.9\nb = 1.0", ("geometry.b: unknown key", "tool_offset")),
    "key on two lines": edit(
        "a = 0.9", 'a = 0.9\n"x\\n\\u001b" = 1', ("geometry.x", "unknown key")
    ),
    "misspelt key": edit(
        "length = 0.85",
        "lenght = 0.85",
        ("leg1.lenght: unknown key", 'did you mean "length"'),
        ("leg1.length: missing", "above 0 m"),
    ),
    "missing table": edit("[platform]\nmass = 46.0", "", ("platform: missing", "must be a table")),
    "table as number": edit(
        "[platform]\nmass = 46.0", "[[platform]]\nmass = 46.0", ("platform =", "must be a table")
    ),
    "true for a number": edit("mass = 46.0", "mass = true", ("platform.mass = true", "above 0 kg")),
    "not a number": edit("a = 0.9", "a = nan", ("geometry.a = nan", "not finite", "above 0 m")),
    "alpha of zero": edit("a = 0.9", "a = 0.9\nalpha = 0.0", ("geometry.alpha = 0.0", "above 0")),
    "alpha in percent": edit(
        "a = 0.9", "a = 0.9\nalpha = 120", ("geometry.alpha = 120", "at most 10", "percent?")
    ),
    "alpha without room for the slides": edit(
        "a = 0.9", "a = 0.9\nalpha = 0.4", ("geometry.alpha = 0.4: a = -", "apart, a > 0")
    ),
    "zero length": edit("0.85", "0.0", ("leg1.length = 0.0", "must be above 0 m")),
    "length in mm": edit("a = 0.9", "a = 900", ("geometry.a = 900", "at most 100 m", "in mm?")),
    "stiffness in N/µm": edit("1.0e9", "1000.0", ("stiffness = 1000.0", "10000 N/m", "N/µm")),
    "offset of two": edit("[0.0, 0.0, 0.1]", "[0.0, 0.1]", ("tool_offset", "3 numbers", " m")),
    "offset in mm": edit("0.0, 0.1]", "0.0, 155]", ("tool_offset[3] = 155", "10 m", "in mm?")),
    "E in GPa": edit("2.1e11", "210", ("leg1.material.E = 210", "1e+06 Pa", "GPa")),
    "E above diamond": edit("2.1e11", "2.1e14", ("leg1.material.E", "at most 2e+12 Pa")),
    "nu too high": edit("nu = 0.3", "nu = 0.5", ("leg1.material.nu = 0.5", "below 0.5")),
    "nu too low": edit("nu = 0.3", "nu = -1", ("leg1.material.nu = -1", "above -1")),
    "negative G": edit(
        "nu = 0.3", "nu = 0.3, G = -8e10", ("leg1.material.G = -", "at least 300000 Pa")
    ),
    "slip of a size": edit(
        "= 0.008", "= 1e-300", ("thickness = 1e-300: must be at least 1e-06 m",)
    ),
    "slip of a mass": edit(
        "46.0", "5e-324", ("platform.mass = 5e-324: must be at least 1e-09 kg",)
    ),
    "slip of a compliance": edit(
        "[1.0e-10", "[5e-324", ("foot.compliance[1,1] = 5e-324: must be at least 1e-15 m/N",)
    ),
    "rho in g/cm³": edit("7850.0", "7.85", ("leg1.material.rho = 7.85", "25 kg/m³", "g/cm³")),
    "material without nu": edit(
        "nu = 0.3, ", "", ("leg1.material.nu: missing", "above -1 and below 0.5")
    ),
    "unknown shape": edit(
        '"hollow-rectangle"', '"hollow-rectangel"', ("shape = ", 'mean "hollow-rectangle"')
    ),
    "shape missing": edit('shape = "hollow-rectangle", ', "", ("section.shape: missing", "tube")),
    "key of another shape": edit(
        "thickness = 0.008", "thickness = 0.008, web = 0.1", ("section.web: unknown", "height")
    ),
    "size missing": edit(", thickness = 0.008", "", ("section.thickness: missing", "in m")),
    "wall too thick": edit("0.008", "0.05", ("section.thickness = 0.05", "below", "0.05 m")),
    "section in mm": edit(
        "width = 0.10, height = 0.16, thickness = 0.008",
        "width = 100, height = 160, thickness = 8",
        ("section.width = 100", "below", "0.85 m", "in mm?"),
        ("section.height = 160", "below", "0.85 m", "in mm?"),
    ),
    "section no table": edit(SECTION, "section = 0.1", ("leg1.section = 0.1", "a table")),
    "section alone": edit(MATERIAL, "", ("leg1.material: missing", "leg1.section")),
    "material alone": edit(SECTION, "", ("leg1.section: missing", "leg1.material")),
    "neither section nor compliance": edit(
        f"{SECTION}\n{MATERIAL}",
        "",
        ("leg1: neither compliance nor section", "compliance and mass"),
    ),
    "section and compliance": edit(
        "mass = 49.0",
        f"mass = 49.0\n{MATERIAL}",
        ("leg2.compliance and leg2.material: both given", "either"),
    ),
    "compliance without mass": edit("mass = 49.0\n", "", ("leg2.mass: missing", "above 0 kg")),
    "mass and density": edit(
        "length = 0.85",
        "length = 0.85\nmass = 60.0",
        ("leg1.mass and leg1.material.rho: both given", "kg"),
    ),
    "neither mass nor density": edit(
        ", rho = 7850.0", "", ("leg1.material.rho: missing", "kg/m³", "leg1.mass")
    ),
    "matrix too small": edit(
        LEG2_COMPLIANCE, "compliance = [[1e-9, 0.0], [0.0, 1e-9]]", ("2×2", "6 rows of 6", "m/N")
    ),
    "matrix ragged": edit(
        FOOT_ROW_1, "[1.0e-10, 0.0]", ("foot.compliance", "2, 6, 6, 6, 6, 6", "6 rows of 6")
    ),
    "matrix with text": edit(
        FOOT_ROW_1,
        '[1.0e-10, "x", 0.0, true, 0.0, 0.0]',
        ('foot.compliance[1,2] = "x"', "finite number"),
        ("foot.compliance[1,4] = true", "finite number"),
    ),
    "matrix with nan": edit(
        FOOT_ROW_1, "[nan, 0.0, 0.0, 0.0, 0.0, 0.0]", ("foot.compliance[1,1] = nan", "finite")
    ),
    "matrix asymmetric": edit(
        "-4.0e-9, 0.0],\n    [0.0, 0.0, 0.0, 7",
        "4.0e-9, 0.0],\n    [0.0, 0.0, 0.0, 7",
        ("foot.compliance[5,3] = -4e-09, [3,5] = 4e-09", "must be equal"),
    ),
    # 4e-8² > 6e-9 · 3.16e-9: the paper's own misprint in k_Foot
    "matrix indefinite": edit(
        "3.0e-7]", "3.16e-9]", ("foot.compliance", "eigenvalue -3.", "positive definite")
    ),
    "matrix with zero diagonal": edit(
        FOOT_ROW_1, "[0, 0, 0, 0, 0, 0]", ("foot.compliance[1,1] = 0.0", "must be above 0")
    ),
    "stiffness for a compliance": edit(
        LEG2_ROW_1,
        "[3.3e9, 0.0, 0.0, 0.0, 0.0, 0.0]",
        ("leg2.compliance[1,1] = 3300000000.0", "at most 1 m/N", "is this a stiffness?"),
    ),
    "compliance in mm/N": edit(
        LEG2_COMPLIANCE,
        LEG2_MM,
        ("leg2.compliance[2,2] = 2e-05", "m/N", "mm/N"),
        ("leg2.compliance[3,3] = 3e-05", "m/N", "mm/N"),
    ),
    "inertia 2×2": edit(
        "mass = 49.0",
        "mass = 49.0\ninertia = [[1.0, 0.0], [0.0, 1.0]]",
        ("leg2.inertia", "3 rows of 3", "kg m²"),
    ),
    "active no switch": edit(
        "[actuators]",
        "[tool]\nactive = 1\n[actuators]",
        ("tool.active = 1", "true or false"),
        ("tool.compliance: missing", "symmetric 6×6"),
    ),
    "legs too short": edit("a = 0.9", "a = 1.8", ("leg1.length", "1.8 m", "the legs cannot meet")),
    "leg too long": edit("0.85", "1.75", ("geometry.a", "1.75 m", "never becomes horizontal")),
    "correction of nothing": edit(
        '"leg2.mass"', '"leg2.weight"', ("corrections[1].key", "leg2.weight", "must name a number")
    ),
    "correction beyond the matrix": edit(
        '"leg2.mass"', '"foot.compliance[7,1]"', ("corrections[1].key", "must name a number")
    ),
    "correction not used": edit(
        "used = 49.0", "used = 50.0", ("corrections[1].used = 50.0", "leg2.mass", "49.0")
    ),
    "correction that corrects nothing": edit(
        "printed = 94.0", "printed = 49.0", ("corrections[1].printed = 49.0", "must differ")
    ),
    "correction without reason": edit(
        'reason = "digits swapped"', "", ("corrections[1].reason: missing", "a text")
    ),
    "corrections no array": edit(
        "[[corrections]]", "[corrections]", ("corrections = ", "array of tables")
    ),
    "several at once": edit(
        "a = 0.9\ntool_offset = [0.0, 0.0, 0.1]\n\n[platform]\nmass = 46.0",
        'a = "x"\ntool_offset = [0.0, 0.0, inf]\n\n[platform]\nmass = -1\nweight = 3',
        ("platform.weight: unknown key", "mass"),
        ("geometry.a", "above 0 m"),
        ("tool_offset[3] = inf", "-10 to 10 m"),
        ("platform.mass = -1", "above 0 kg"),
    ),
}


@pytest.fixture
def robot_path(tmp_path):
    def write(text: str) -> Path:
        path = tmp_path / "my.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def faults_of(source) -> tuple[str, ...]:
    with pytest.raises(InputError) as error:
        load_robot(source)
    return error.value.faults


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG.keys())
def test_each_fault_is_one_line_with_file_key_and_what_is_allowed(wrong, robot_path):
    assert SOUND.count(wrong.old) >= 1
    path = robot_path(SOUND.replace(wrong.old, wrong.new, 1))
    faults = faults_of(path)
    assert len(faults) == len(wrong.lines), faults
    for parts in wrong.lines:
        assert any(all(part in fault for part in parts) for fault in faults), (parts, faults)
    for fault in faults:
        assert fault.startswith(f"{path}: ")
        assert "\n" not in fault


def distance_of_slides(mechanism):
    return mechanism.reference["slide2"].position[0] - mechanism.reference["slide1"].position[0]


def compliance_of(robot_file, name):
    return next(joint for joint in robot_file.mechanism.joints if joint.name == name).compliance


@pytest.mark.parametrize("alpha", [0.8, 1.5, 2.0])
def test_legs_longer_by_alpha_keep_stroke_and_section(alpha, robot_path):
    text = resources.files("lumped").joinpath("robots/ifw.toml").read_text(encoding="utf-8")
    longer = load_robot(robot_path(text.replace("alpha = 1.0", f"alpha = {alpha}"))).mechanism
    leg1, leg2 = legs_of(longer).values()
    l10, l20, a0 = 0.85, 0.775, 0.92
    # eq. (10): L_i = α L_i0; eq. (11): a = α (L10 + L20) − d with the stroke d = L10 + L20 − a0
    assert [leg1.length, leg2.length] == pytest.approx([alpha * l10, alpha * l20])
    assert distance_of_slides(longer) == pytest.approx(
        alpha * (l10 + l20) - (l10 + l20 - a0), rel=1e-14
    )
    for leg, before in ((leg1, LEG1), (leg2, LEG2)):
        assert leg.section == equivalent_leg(before).section
        assert leg.mass == pytest.approx(alpha * before.mass)


def test_sound_file_is_read(robot_path):
    path = robot_path(SOUND)
    loaded = load_robot(path)
    assert (loaded.source, loaded.built_in) == (str(path), False)
    leg1, leg2 = legs_of(loaded.mechanism).values()
    assert isinstance(leg1, ConstantLeg)
    assert leg1.section == HollowRectangle(0.10, 0.16, 0.008)
    # hollow rectangle 0.1 × 0.16 × 0.008 of steel: (0.016 − 0.084·0.144) m² · 7850 · 0.85
    assert leg1.mass == pytest.approx((0.016 - 0.084 * 0.144) * 7850 * 0.85)
    assert isinstance(leg2, GivenLeg)
    assert leg2.compliance[1, 5] == 3.0e-8
    assert loaded.mechanism.tool.datum == (0.0, 0.0, 0.1)
    assert "spring" not in {joint.name for joint in loaded.mechanism.joints}


def test_mass_stands_for_the_density_and_g_for_that_of_an_isotropic_material(robot_path):
    text = SOUND.replace(", rho = 7850.0", "").replace("length = 0.85", "length = 0.85\nmass = 60")
    leg = legs_of(load_robot(robot_path(text)).mechanism)["leg1"]
    assert leg.mass == pytest.approx(60.0)
    # E over 2(1 + ν)
    assert pytest.approx(2.1e11 / 2.6) == leg.material.G
    own = load_robot(robot_path(SOUND.replace("nu = 0.3", "nu = 0.3, G = 7e10"))).mechanism
    assert legs_of(own)["leg1"].material.G == 7e10


def test_byte_order_mark_and_windows_line_ends_are_read(tmp_path):
    path = tmp_path / "windows.toml"
    path.write_bytes(b"\xef\xbb\xbf" + SOUND.replace("\n", "\r\n").encode())
    assert distance_of_slides(load_robot(path).mechanism) == 0.9


def test_rounding_of_seven_digits_is_symmetric_enough(robot_path):
    text = SOUND.replace(
        "[0.0, 4.0e-8, 0.0, 0.0, 0.0, 3.0e-7]", "[0.0, 4.000001e-8, 0.0, 0.0, 0.0, 3.0e-7]"
    )
    foot = compliance_of(load_robot(robot_path(text)), "foot1")
    assert np.array_equal(foot, foot.T)


def test_a_path_that_leads_to_no_robot(tmp_path):
    latin = tmp_path / "latin.toml"
    latin.write_bytes(b'name = "Gr\xf6\xdfe"')
    robots = f"must be a robot file or a built-in robot ({', '.join(built_in_robots())})"
    for path, said in (
        (tmp_path / "none.toml", f"none.toml: no such file; {robots}"),
        ("IWF", f'IWF: no such file; {robots}; did you mean "ifw"?'),
        (tmp_path, f"{tmp_path}: is a folder; must be a robot file"),
        (latin, f"{latin}: byte 11 is not UTF-8; must be a TOML text in UTF-8"),
        (tmp_path / ("x" * 1000), "cannot be read"),
    ):
        (fault,) = faults_of(path)
        assert said in fault


def test_empty_file_names_every_missing_key(robot_path):
    faults = faults_of(robot_path(""))
    missing = {fault.split(": ")[1] for fault in faults if ": missing" in fault}
    assert missing == {
        *("schema", "name", "type", "geometry", "platform", "actuators", "leg1", "leg2")
    }


# Paper, appendix.
def test_ifw_has_the_appendix_values():
    mechanism = load_robot("ifw").mechanism
    assert (distance_of_slides(mechanism), LEG1.length, LEG2.length) == (0.92, 0.85, 0.775)
    assert (LEG1.mass, LEG2.mass, mechanism.tool.mass) == (69.705, 49.366, 46.0)
    assert (LEG1.mass_centre, LEG2.mass_centre) == (0.542, 0.375)
    drives = [joint.drive for joint in mechanism.joints if joint.drive]
    assert [drive.simplified for drive in drives] == [1e9, 1e9]
    assert not any(mechanism.tool.datum)
    assert LEG1.compliance[1, 5] == -2.90e-7
    assert LEG2.compliance[2, 2] == 1.07e-9
    # sums of the printed diagonals, added by hand
    assert np.trace(LEG1.compliance) == pytest.approx(1.80571e-6)
    assert np.trace(LEG2.compliance) == pytest.approx(1.157941e-6)
    assert np.trace(LEG1.inertia) == pytest.approx(6.855)


def test_ifw_corrections_hold_the_printed_values_beside_the_used():
    loaded = load_robot("ifw")
    table = {c.key: (c.printed, c.used) for c in loaded.corrections}
    assert table == {
        "foot.compliance[6,6]": (3.16e-9, 3.16e-7),
        "tool.compliance[2,1]": (9.70e-11, -9.70e-11),
        "leg1.inertia[2,3]": (-0.940, -0.094),
        "leg1.inertia[3,2]": (-0.940, -0.094),
    }
    printed = as_printed(loaded)
    assert printed["foot"]["compliance"][5][5] == 3.16e-9
    assert printed["tool"]["compliance"][1][0] == 9.70e-11
    assert printed["leg1"]["inertia"][1][2] == printed["leg1"]["inertia"][2][1] == -0.940
    assert loaded.tables["foot"]["compliance"][5][5] == 3.16e-7
    assert compliance_of(loaded, "foot1")[5, 5] == 3.16e-7


def test_tool_compliance_acts_only_when_active(tmp_path):
    loaded = load_robot("ifw")
    assert "spring" not in {joint.name for joint in loaded.mechanism.joints}
    path = tmp_path / "ifw-tool.toml"
    path.write_text(loaded.text.replace("active = false", "active = true"), encoding="utf-8")
    assert compliance_of(load_robot(path), "spring")[1, 0] == -9.70e-11


@pytest.mark.skipif(shutil.which("sha256sum") is None, reason="needs sha256sum")
def test_digest_is_that_of_the_bytes(robot_path):
    path = robot_path(SOUND)
    printed = subprocess.run(["sha256sum", path], capture_output=True, text=True, check=True)  # noqa: S607
    assert load_robot(path).sha256 == printed.stdout.split()[0]


def test_template_loads_and_is_never_overwritten(tmp_path):
    path = tmp_path / "new.toml"
    write_template(path)
    assert load_robot(path).mechanism.poses[[0, -1], 0] == pytest.approx([0.2, 0.9])
    before = path.read_bytes()
    with pytest.raises(InputError, match=r"exists already; must be the name of a new file"):
        write_template(path)
    assert path.read_bytes() == before


def test_template_with_its_comments_taken_off_is_still_toml(tmp_path):
    path = tmp_path / "new.toml"
    write_template(path)
    text = path.read_text(encoding="utf-8")
    foot = text[text.index("# [foot]") : text.index("# Optional: a spring")]
    tables = tomllib.loads("\n".join(line.removeprefix("# ") for line in foot.splitlines()))
    matrix = np.array(tables["foot"]["compliance"])
    assert np.array_equal(matrix, matrix.T)
    assert np.linalg.eigvalsh(matrix)[0] > 0.0


def test_template_in_a_missing_folder(tmp_path):
    with pytest.raises(InputError, match=r"cannot be written \(No such file or directory\)"):
        write_template(tmp_path / "none" / "new.toml")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_template_in_an_unwritable_folder(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match="cannot be written"):
        write_template(tmp_path / "new.toml")
    assert not list(tmp_path.iterdir())
