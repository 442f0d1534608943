"""Compliance of a part by PETSc on two hosts, which are two network namespaces of one machine.

    python tests/benchmarks/petsc_hosts.py

Runs as root on Linux with iproute2 and the packages that option `--hosts` needs. A virtual cable
connects the namespaces. This program runs in the first one, and mpiexec enters the second one by a
script in place of ssh (`plm_rsh_agent`). One rank computes in each: MUMPS, then GAMG. The largest
difference from rslab is printed, relative to the energies of the unit loads; it must be below 1e-9.
"""

# ruff: noqa: T201, E402  a script that prints its figures

import os
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(Path(__file__).parent)]

import numpy as np
from graphics_card import leg_of, mesh_of

from fem.bodies.solid import clamped_leg, solid_leg
from fem.solvers.backends.choice import solver_name
from lumped.solver_request import HOSTS_VARIABLE, VARIABLE

# Names of this process, so that namespaces of other programs stay untouched.
NAMES = tuple(f"petsc-{end}-{os.getpid()}" for end in "ab")
CABLES = tuple(f"fp{end}{os.getpid()}" for end in "ab")
ADDRESSES = "10.77.0.1", "10.77.0.2"
# The second host has a name of its own, as machines have.
AGENT = f"""#!/bin/sh
shift
exec ip netns exec {NAMES[1]} unshare --uts sh -c 'hostname {NAMES[1]}; eval "$*"' sh "$@"
"""
TOLERANCE = 1e-9


def ip(*words: str) -> None:
    """Run the program ip."""
    subprocess.run(["/sbin/ip", *words], check=True)


def connect(stack: ExitStack) -> None:
    """Create both namespaces and the cable between them. The stack removes them."""
    for name in NAMES:
        ip("netns", "add", name)
        stack.callback(ip, "netns", "delete", name)
    ip("link", "add", CABLES[0], "type", "veth", "peer", "name", CABLES[1])
    for name, cable, address in zip(NAMES, CABLES, ADDRESSES, strict=True):
        ip("link", "set", cable, "netns", name)
        ip("-n", name, "address", "add", f"{address}/24", "dev", cable)
        for device in ("lo", cable):
            ip("-n", name, "link", "set", device, "up")


def compare() -> int:
    """Compute by rslab and by PETSc on both hosts. Return 1 if they differ."""
    with TemporaryDirectory() as folder:
        solid = solid_leg(leg_of("9k"), mesh_of("9k", Path(folder)))
    worst = 0.0
    os.environ[VARIABLE] = "rslab"
    expected = clamped_leg(solid).compliance
    sizes = np.sqrt(np.diag(expected))
    for solver in ("petsc", "gamg"):
        os.environ[VARIABLE] = solver
        begun = perf_counter()
        compliance = clamped_leg(solid).compliance
        difference = np.abs((compliance - expected) / np.outer(sizes, sizes)).max()
        print(f"{solver}: {difference:.1e} in {perf_counter() - begun:.1f} s, {solver_name()}")
        worst = max(worst, difference)
    return int(not worst <= TOLERANCE)


def main() -> int:
    """Compare in a namespace, or create the namespaces and start the comparison in the first."""
    if HOSTS_VARIABLE in os.environ:
        return compare()
    with TemporaryDirectory() as temporary, ExitStack() as stack:
        folder = Path(temporary)
        agent, hosts = folder / "agent", folder / "hosts"
        agent.write_text(AGENT, encoding="ascii")
        agent.chmod(0o700)
        hosts.write_text("".join(f"{address}\n" for address in ADDRESSES), encoding="ascii")
        variables = {HOSTS_VARIABLE: str(hosts), "OMPI_MCA_plm_rsh_agent": str(agent)}
        command = ["/sbin/ip", "netns", "exec", NAMES[0], sys.executable, __file__]
        connect(stack)
        return subprocess.run(command, env=os.environ | variables, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
