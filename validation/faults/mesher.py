"""The fresh process that meshes under a fault: `python -m validation.faults.mesher DESCRIPTOR`.

Through that connection arrive a place, the fault's id and arguments; what the function at the place
says, or the error that it raises, goes back.
"""

import os
import sys
import threading
from contextlib import suppress
from multiprocessing.connection import Connection

from lumped.errors import ComputationError, InputError
from validation.faults.catalogue import FAULTS
from validation.faults.fault import sound_function
from validation.store.cache import nothing_kept


def main(descriptor: int) -> None:
    """Answer one question; end as soon as whoever asked is gone."""
    connection = Connection(descriptor)
    place, identifier, args = connection.recv()
    threading.Thread(target=_wait_and_leave, args=(connection,), daemon=True).start()
    fault = next(one for one in FAULTS if one.id == identifier)
    with fault.inject(), nothing_kept():
        try:
            answer = sound_function(place)(*args)
        except InputError as error:
            answer = InputError(error.faults)
        except Exception as error:  # noqa: BLE001  a fault may break anything
            answer = ComputationError(f"{type(error).__name__}: {error}")
    connection.send(answer)


def _wait_and_leave(connection: Connection) -> None:
    with suppress(OSError, EOFError):
        connection.recv_bytes()
    os._exit(1)


if __name__ == "__main__":
    main(int(sys.argv[1]))
