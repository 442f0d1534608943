"""The four functions of validation.api on the built-in robot."""

from validation import api


def main() -> None:
    # Limits as in [accept]; all faults of a file come in one InputError.
    robot = api.load("ifw", accept={"deflection": 0.10})

    answers = api.solve(robot, "segments", poses=[0.3, 0.5], modes=3, theory="timoshenko").answers
    print(answers[0].compliance[2, 2], answers[0].frequencies)  # m/N at the loaded point; Hz

    judged = api.adequacy(robot, preset="quick")  # every model by every quantity
    print(judged.sentence)
    entry = judged.entry("segments", "z")
    print(entry.verdict, entry.error, entry.uncertainty, entry.pose, entry.causes, entry.remedy)
    judged.assert_adequate("vjm", "x", within=0.02)  # else AssertionError with cause and remedy

    finished = api.run(robot, out="report", preset="quick", only="adequacy")
    print(finished.exit_code, finished.verdicts, finished.report)


if __name__ == "__main__":
    main()
