"""Choice of the library that factorises large sparse systems.

The choice is stored in environment variables, which the options `--solver`, `--ranks` and `--hosts`
set and which child processes inherit.
"""

import os
import socket
from contextlib import suppress
from enum import StrEnum
from pathlib import Path

from lumped.errors import InputError

VARIABLE, RANKS_VARIABLE = "FLEXPROOF_SOLVER", "FLEXPROOF_RANKS"
HOSTS_VARIABLE = "FLEXPROOF_HOSTS"
# Variable for the path of a Python with petsc4py, and the path if the variable is not set.
PYTHON_VARIABLE, SYSTEM_PYTHON = "FLEXPROOF_PETSC_PYTHON", "/usr/bin/python3"
# Largest number of MPI ranks, or the number of cores if that is larger.
_LARGEST_RANKS = 4


class Solver(StrEnum):
    """Library that factorises large sparse systems.

    AUTO selects a library by the size of the system and the machine. PETSC and GAMG both use PETSc.
    GAMG solves the statics of solids iteratively, without a factor. PETSC does so only if the
    factor does not fit into the memory.
    """

    AUTO = "auto"
    RSLAB = "rslab"
    CUDSS = "cudss"
    PETSC = "petsc"
    GAMG = "gamg"

    @property
    def is_petsc(self) -> bool:
        """True for the libraries that compute through PETSc."""
        return self in {Solver.PETSC, Solver.GAMG}


def requested_solver() -> Solver:
    """Library named in FLEXPROOF_SOLVER. Raises InputError for an unknown name."""
    name = os.environ.get(VARIABLE, "").strip() or Solver.AUTO
    try:
        return Solver(name)
    except ValueError:
        raise InputError(
            f'{VARIABLE} = "{name}": must be auto, rslab, cudss, petsc or gamg'
        ) from None


def requested_ranks() -> int:
    """Number of MPI ranks for petsc from the variable FLEXPROOF_RANKS. By default one per host.

    Raises InputError for an invalid number, for example if it is not a multiple of the number of
    hosts.
    """
    hosts = requested_hosts()
    text = os.environ.get(RANKS_VARIABLE, "").strip() or str(max(1, len(hosts)))
    return rank_count(text, RANKS_VARIABLE, len(hosts))


def rank_count(text: str, source: str, hosts: int = 0) -> int:
    """Number of MPI ranks typed as `text`.

    `hosts` is the number of hosts, 0 if ranks run on this machine only. Raises InputError for an
    invalid number. The message contains `source`, the name of the option or variable.
    """
    largest = max(1, hosts) * max(_LARGEST_RANKS, os.cpu_count() or 1)
    if not text.isdecimal() or not 1 <= int(text) <= largest:
        raise InputError(
            f'{source} = "{text}": must be a whole number from 1 to {largest} (the number of '
            f"cores, at least {_LARGEST_RANKS}{', times that of hosts' if hosts else ''})"
        )
    if hosts and int(text) % hosts:
        raise InputError(
            f'{source} = "{text}": must be a multiple of the number of hosts, {hosts}, so that '
            "each has equally many ranks"
        )
    return int(text)


def requested_hosts() -> tuple[str, ...]:
    """Names of the hosts for petsc. Empty if no hosts are requested.

    Raises InputError under the conditions of `read_hosts`.
    """
    path = os.environ.get(HOSTS_VARIABLE, "").strip()
    return read_hosts(Path(path)) if path else ()


def read_hosts(path: Path) -> tuple[str, ...]:
    """Names of the hosts in a hostfile of mpiexec: one per line, settings and comments ignored.

    Raises InputError if the file cannot be read or has no host, or if a host is unknown or named
    twice. It is also raised if the first host is not this machine, on which the arrays are read.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "is not a text file"
        raise InputError(f"hosts {path}: {reason}; must be a hostfile of mpiexec") from error
    entries = [(number, line.partition("#")[0].split()) for number, line in enumerate(lines, 1)]
    hosts: list[str] = []
    for number, words in entries:
        if not words:
            continue
        host = words[0]
        if host in hosts:
            raise InputError(f'hosts {path}, line {number}: "{host}" is there twice')
        try:
            address = socket.getaddrinfo(host, None)[0]
        except (OSError, UnicodeError) as error:
            raise InputError(f'hosts {path}, line {number}: "{host}" is unknown') from error
        if not hosts and not _is_this_machine(address[0], address[4][0]):
            raise InputError(
                f'hosts {path}, line {number}: "{host}" is not this machine; the first host must '
                "be the one on which flexproof runs"
            )
        hosts.append(host)
    if not hosts:
        raise InputError(f"hosts {path}: has no host; must have one name per line")
    return tuple(hosts)


def _is_this_machine(family: socket.AddressFamily, address: str | int) -> bool:
    """True if an address belongs to this machine, so that a socket can be bound to it."""
    with suppress(OSError), socket.socket(family, socket.SOCK_STREAM) as bound:
        bound.bind((address, 0))
        return True
    return False


def petsc_python() -> str:
    """Path of the Python interpreter that has petsc4py."""
    return os.environ.get(PYTHON_VARIABLE, "").strip() or SYSTEM_PYTHON


def requested_library() -> str:
    """Text that identifies the requested library, for cache keys.

    For petsc it includes the number of ranks and the Python interpreter. Results of different
    libraries differ by round-off.
    """
    request = requested_solver()
    if not request.is_petsc:
        return request.value
    return f"{request.value} {requested_ranks()} {petsc_python()}"


def request_variables() -> dict[str, str]:
    """Environment variables with which a process on another machine requests the same library.

    Raises InputError if hosts are requested.
    """
    if requested_hosts():
        raise InputError(
            "--hosts: cannot be combined with --cluster, whose workers start ranks on their own "
            "machines"
        )
    return {VARIABLE: requested_solver().value, RANKS_VARIABLE: str(requested_ranks())}
