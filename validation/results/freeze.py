"""Frozen values: the project's own earlier numbers for the robots that come with it.

They are kept beside the program, one small file per robot and preset, so that every run shows how
far the numbers have moved. `python -m validation.results.freeze RUN` renews the file from a run: do
so when a change of the numbers is meant, and let the commit say why.
"""

import json
import sys
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path

from lumped.errors import InputError
from lumped.robot_file import RobotFile, built_in_robots, load_robot
from validation.context import Preset
from validation.results.records import RunRecord, load_run, parse_run

FOLDER = Path(str(resources.files("validation"))) / "frozen"


def built_in_frozen(robot_file: RobotFile, preset: Preset) -> RunRecord | None:
    """The frozen run of a built-in robot; None where there is none or the robot has changed."""
    path = FOLDER / f"{robot_file.source}-{preset}.json"
    if not robot_file.built_in or not path.exists():
        return None
    run = parse_run(path.read_bytes(), str(path))
    return run if run.run.get("robot_sha256") == robot_file.sha256 else None


def frozen_text(run: RunRecord) -> str:
    """What is kept of a run: verdicts, values and uncertainties, one line per case."""
    kept = {name: run.run.get(name) for name in ("robot_file", "robot_sha256", "preset")}
    lines = [
        json.dumps(
            {
                "id": case.id,
                "verdict": case.verdict,
                "value": case.value,
                "numerical_uncertainty": case.numerical_uncertainty,
            }
            | ({"pose": case.pose} if case.pose else {}),
            ensure_ascii=False,
        )
        for case in sorted(run.cases, key=lambda case: case.id)
    ]
    cases = ",\n".join(lines)
    return f'{{"schema": 1, "run": {json.dumps(kept)}, "cases": [\n{cases}\n]}}\n'


def freeze(path: Path, folder: Path = FOLDER) -> Path:
    """Keep the values of the run at `path` in `folder`; returns the file written.

    Raises InputError for a run that is not a whole one of a built-in robot, or that failed.
    """
    run = load_run(path)
    faults = _faults(run.run, run)
    if faults:
        raise InputError([f"{path}: {fault}" for fault in faults])
    target = folder / f"{run.run['robot_file']}-{run.run['preset']}.json"
    target.write_text(frozen_text(run), encoding="utf-8")
    return target


def _faults(header: Mapping[str, object], run: RunRecord) -> list[str]:
    faults = []
    robot = str(header.get("robot_file"))
    if robot not in built_in_robots():
        faults.append(f"robot {robot}: only the values of built-in robots are frozen")
    elif header.get("robot_sha256") != load_robot(robot).sha256:
        faults.append(f"robot {robot} has changed since")
    options = header.get("options")
    if isinstance(options, Mapping) and ("only" in options or "selftest" in options):
        faults.append(f"only a part was run (options {options})")
    if header.get("unfinished", 0):
        faults.append(f"{header['unfinished']} cases or figures were not computed")
    faults += [f"{case.id} has failed" for case in run.cases if case.verdict == "failed"]
    return faults


def main(arguments: Sequence[str]) -> int:
    """Freeze the run named on the command line; the exit code."""
    if len(arguments) != 1:
        sys.stderr.write("usage: python -m validation.results.freeze RUN\n")
        return 2
    try:
        target = freeze(Path(arguments[0]))
    except InputError as error:
        sys.stderr.writelines(f"freeze: {fault}\n" for fault in error.faults)
        return 2
    sys.stdout.write(f"{target} written\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
