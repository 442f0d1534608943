"""Resources of this machine for a computation: memory, cores, threads."""

import gc
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from lumped.errors import ComputationError
from lumped.posix import resource

# Address space (bytes) of stacks, heaps and buffers of libraries for each thread.
_ADDRESSES_PER_CORE = 150_000_000
# Address space (bytes) that libraries need before the first computation. First number: to read and
# check files. Second number: to mesh and solve. With less they end the process, hang or crash.
TO_READ, TO_COMPUTE = 250_000_000, 1_000_000_000
# Environment of a process whose BLAS has one thread. Sums over several threads differ by round-off,
# up to 1e-6 of a result, and small dense matrices are slower with several threads.
ONE_BLAS_THREAD: Mapping[str, str] = dict.fromkeys(
    ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"), "1"
)
# Thresholds of Python's search for unused objects that refer to each other. It starts after 20,000
# new objects instead of 700, because figures consist of many small objects that remain in use: with
# Python's own thresholds, the search takes a sixth of the time of a chart. Arrays are freed without
# it, as soon as nothing refers to them.
_CYCLE_SEARCH = (20_000, 20, 20)
# Number of files that a command may have open at the same time, including libraries and pipes.
_OPEN_FILES = 64


def available_memory() -> int | None:
    """Memory (bytes) available to a new computation. None if it is unknown."""
    limits = []
    meminfo = Path("/proc/meminfo")
    if meminfo.exists():
        fields = dict(line.split(":", 1) for line in meminfo.read_text().splitlines())
        if "MemAvailable" in fields:
            limits.append(1024 * int(fields["MemAvailable"].split()[0]))
    group = Path("/sys/fs/cgroup")
    if (group / "memory.max").exists() and (group / "memory.current").exists():
        limit = (group / "memory.max").read_text().strip()
        if limit != "max":
            limits.append(int(limit) - int((group / "memory.current").read_text()))
    if (address_space := _address_space()) is not None:
        limits.append(address_space)
    if not limits and "SC_PHYS_PAGES" in getattr(os, "sysconf_names", {}):
        limits.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    return min(limits) if limits else None


def search_cycles_rarely() -> None:
    """Reduce how often Python searches this process for unused objects that refer to each other."""
    gc.set_threshold(*_CYCLE_SEARCH)


def require_room(needed: int) -> None:
    """Raise ComputationError if the limits on memory, threads or open files are too low.

    `needed` (bytes) is the required memory without that of the threads. If the limits are too low,
    numerical libraries end the process at their start without a message.
    """
    if resource is None:
        return
    files, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if files != resource.RLIM_INFINITY and files < _OPEN_FILES:
        raise ComputationError(
            f"the limit of open files (ulimit -n) is {files}; raise it to at least {_OPEN_FILES}"
        )
    needed += _ADDRESSES_PER_CORE * usable_cores()
    address_space = _address_space()
    if address_space is not None and address_space < needed:
        raise ComputationError(
            f"the limit of the address space (ulimit -v) leaves {address_space / 1e9:.2g} GB and "
            f"the numerical libraries need {needed / 1e9:.2g} GB before they compute anything: "
            "raise the limit"
        )


def _address_space() -> int | None:
    """Address space (bytes) that this process may still use. None if it has no limit."""
    if resource is None:
        return None
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return None
    statm = Path("/proc/self/statm")
    used = int(statm.read_text().split()[0]) * resource.getpagesize() if statm.exists() else 0
    return max(0, int(limit) - used)


def usable_cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def threads() -> int:
    """Number of threads for a computation: OMP_NUM_THREADS, otherwise one per usable core."""
    setting = os.environ.get("OMP_NUM_THREADS", "")
    return int(setting) if setting.isdecimal() and int(setting) > 0 else usable_cores()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Context in which BLAS uses one thread, as in a worker process.

    Results are then equal to the last bit to those of a worker process. The sparse solver still
    uses several `threads`, because its results do not depend on their number.
    """
    # Imported here because commands do not need it: their environment sets the number of threads.
    from threadpoolctl import threadpool_limits  # noqa: PLC0415

    with threadpool_limits(limits=1, user_api="blas"):
        yield
