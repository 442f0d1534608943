"""Messages of commands on stderr."""


def only_message(printed):
    """The one line on stderr, which forecasts and progress may precede on a busy machine."""
    *earlier, line = printed.splitlines()
    assert all("about " in one or "elapsed" in one for one in earlier), earlier
    return line
