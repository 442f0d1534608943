"""`--measured` beside `--only`: measured values that were asked for are shown, in words as well."""

import pytest
from one_arm import ONE_ARM

from validation.cli import main

MEASURED = "quantity,pose,value,uncertainty,source\nf1,0.1,20.0,0.1,hammer test\n"


@pytest.mark.parametrize("only", ["adequacy", "figures.none*"])
def test_measured_values_are_shown_whatever_else_is_left_out(tmp_path, capsys, only):
    robot, values, out = (tmp_path / name for name in ("arm.toml", "measured.csv", "report"))
    path = "[path]\nfrom = [0.0]\nto = [0.2]\ncount = 2\n"
    robot.write_text(f"{ONE_ARM}{path}", encoding="utf-8")
    values.write_text(MEASURED, encoding="utf-8")
    asked = ["run", str(robot), "--preset", "quick", "--out", str(out), "--jobs", "1"]
    code = main([*asked, "--only", only, "--measured", str(values)])
    said = "".join(capsys.readouterr())
    if only == "figures.none*":
        # A pattern that matches nothing else is a mistake still.
        assert code == 2
        return
    assert code == 0
    page = (out / "report.html").read_text(encoding="utf-8")
    assert (out / "figures" / "measured.values.csv").exists()
    assert "against measured values: " in said
    # The matrix is full: that nothing was compared would be false.
    assert "No comparison was made" not in said + page
