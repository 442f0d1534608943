"""Script of a user with the types of results: `mypy` checks it, nothing runs it."""

from pathlib import Path

import flexproof as fp

robot = fp.load("ifw", accept={"deflection": 0.1})
solution: fp.Solution = fp.solve(robot, "beam", poses=[0.4975], modes=4, elements=20)
first: float = float(solution.answers[0].frequencies[0])
study = fp.converge(robot, "segments", body="leg1", elements=[5, 10, 20])
rows: tuple[tuple[str | float | None, ...], ...] = study.table("f1").rows
crossed = fp.cross_validate(robot, preset="quick")
crossed.assert_agrees("beam", with_="solid", quantity="f1", within=0.01, body="leg1")
error: float | None = fp.adequacy(robot).entry("vjm", "x", within=0.02).error
finished: fp.Run = fp.run(robot, out=Path("report"), preset="quick", only="adequacy")
agreeing: int = finished.verdicts["agree"]
mass: float = fp.identify(robot, body="leg1").total
largest: float = float(fp.workspace(robot).values("first frequency").max())
best: float = fp.vary(robot, "leg1.length=0.8:0.9:3").best("deflection", "beam")
verdict: str = fp.compare_measured(robot, "measured.csv").entry("beam", "f1").verdict
path: Path = fp.export(robot, "npz", out="a.npz")
fp.draw(robot).savefig("robot.png")
