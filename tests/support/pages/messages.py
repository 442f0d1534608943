"""Messages of commands on stderr."""


def only_message(printed):
    """The single message on stderr, without forecasts and progress of a busy machine."""
    *earlier, line = printed.splitlines()
    assert all("about " in line or "elapsed" in line for line in earlier), earlier
    return line
