"""`--measured` beside `--only`: measured values that were asked for are shown, in words as well."""

from one_arm import ONE_ARM

from validation.cli import main

MEASURED = "quantity,pose,value,uncertainty,source\nf1,0.1,20.0,0.1,hammer test\n"


def test_measured_values_are_shown_whatever_else_is_left_out(tmp_path, capsys):
    robot, values, out = (tmp_path / name for name in ("arm.toml", "measured.csv", "report"))
    path = "[path]\nposes = [[0.1]]\n"
    robot.write_text(f"{ONE_ARM}{path}", encoding="utf-8")
    values.write_text(MEASURED, encoding="utf-8")
    asked = ["run", str(robot), "--preset", "quick", "--out", str(out), "--jobs", "1"]
    assert main([*asked, "--only", "adequacy", "--measured", str(values)]) == 0
    said = "".join(capsys.readouterr())
    page = (out / "report.html").read_text(encoding="utf-8")
    assert (out / "figures" / "measured.values.csv").exists()
    assert "against measured values: " in said
    # The matrix is full: that nothing was compared would be false.
    assert "No comparison was made" not in said + page
