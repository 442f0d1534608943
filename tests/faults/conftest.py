"""Says at the end which test noticed which mistake."""


def pytest_terminal_summary(terminalreporter):
    noticed = [
        (report.nodeid.partition("[")[2].rstrip("]"), test)
        for report in terminalreporter.getreports("passed")
        for name, test in report.user_properties
        if name == "noticed by"
    ]
    if noticed:
        terminalreporter.section("mistakes noticed")
        for mistake, test in sorted(noticed):
            terminalreporter.line(f"{mistake:32} {test}")
