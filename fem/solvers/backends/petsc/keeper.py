"""Program that runs a command as long as its client lives.

It is started as `keeper.py FOLDER COMMAND…`. Its standard input is a pipe, the other end of which
the client keeps open. When the client has ended in any way, the pipe is closed. Then the command is
ended and the folder is removed. The exit code is that of the command, or 128 + n if signal n ended
it.
"""

import os
import shutil
import subprocess
import sys
from threading import Event, Thread

# Time (s) for the command to end on request, before it is killed.
_PATIENCE = 5.0


def keep(folder: str, command: list[str]) -> int:
    """Run the command. Return its exit code, or 128 + n if signal n ended it."""
    child = subprocess.Popen(command, stdin=subprocess.DEVNULL)  # noqa: S603  by the client
    deserted = Event()

    def watch() -> None:
        os.read(0, 1)
        deserted.set()
        child.terminate()
        try:
            child.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            child.kill()

    Thread(target=watch, daemon=True).start()
    code = child.wait()
    if deserted.is_set():
        shutil.rmtree(folder, ignore_errors=True)
    return code if code >= 0 else 128 - code


if __name__ == "__main__":
    sys.exit(keep(sys.argv[1], sys.argv[2:]))
