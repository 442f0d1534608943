"""Contents of files with reduced bodies and robots, in the formats of other programs.

Input: a `Reduced` or `ReducedRobot`. Output: bytes of a .npz, .py (EXUDYN), .mat (Simscape), .bdf
(Nastran) or state-space file, in SI units.
"""

from collections.abc import Callable, Mapping
from io import BytesIO, StringIO

import numpy as np

from lumped.arrays import Array
from lumped.system.response import modal_damping
from lumped.text import counted, visible
from validation.export.reduced import TWIST, Reduced, ReducedRobot

# Number of the first scalar point of Nastran. Scalar points are the modal amplitudes.
_SCALARS = 100_001
_WRENCH = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
# Python reads the encoding of a script from its first two lines (PEP 263), editors read settings
# from the first five. These lines therefore contain no text of the robot file.
_EXUDYN = '''\
# -*- coding: utf-8 -*-
# Reduced model for EXUDYN, {unknowns}, SI units.
# Frequencies (Hz) of the model, with the largest amount by which each may be too high:
{frequencies}

import exudyn as exu
import numpy as np
from exudyn.itemInterface import MarkerNodeCoordinates, NodeGenericODE2, ObjectGenericODE2

# {name}: {about}.
stiffness = np.array({stiffness})
mass = np.array({mass})
# Twists of the ports per unit of the unknowns (rows x y z phi_x phi_y phi_z, or displacement along
# a drive). A wrench at a port gives the forces ports["tool"].T @ wrench on the unknowns.
ports = {ports}


def add_to(mbs, forces=np.zeros({n})):
    """Add the object with `forces` (n) on its unknowns. Returns the object and its node."""
    node = mbs.AddNode(
        NodeGenericODE2(
            numberOfODE2Coordinates={n},
            referenceCoordinates=[0.0] * {n},
            initialCoordinates=[0.0] * {n},
            initialCoordinates_t=[0.0] * {n},
        )
    )
    body = mbs.AddObject(
        ObjectGenericODE2(
            nodeNumbers=[node], massMatrix=mass, stiffnessMatrix=stiffness, forceVector=forces
        )
    )
    mbs.AddMarker(MarkerNodeCoordinates(nodeNumber=node))
    return body, node


if __name__ == "__main__":
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    add_to(mbs)
    mbs.Assemble()
    print(mbs.ComputeODE2Eigenvalues(convert2Frequencies=True)[0].tolist())
'''


def as_npz(reduced: Reduced) -> bytes:
    """Arrays for numpy (.npz): K, M, unknowns, ports, points, frequencies and their bounds."""
    return _npz(
        {
            "K": reduced.stiffness,
            "M": reduced.mass,
            "unknowns": np.array(reduced.unknowns),
            **{f"port {name}": rows for name, rows in reduced.ports.items()},
            **{f"point {name}": point for name, point in reduced.points.items()},
            "frequencies": reduced.frequencies,
            "bounds": reduced.bounds,
            "counted": np.array([[n, *count] for n, count in reduced.counted.items()], dtype=str),
            "about": np.array(f"{reduced.name}: {reduced.about}; SI units"),
        }
    )


def as_exudyn(reduced: Reduced) -> bytes:
    """Script that adds the matrices to a system of EXUDYN.

    Run on its own, it prints frequencies.
    """
    ports = "".join(
        f"\n    {name!r}: np.array({rows.tolist()})," for name, rows in reduced.ports.items()
    )
    pairs = zip(reduced.frequencies, reduced.bounds, strict=True)
    frequencies = "\n".join(f"#     {frequency:.9g} (-{bound:.2g})" for frequency, bound in pairs)
    text = _EXUDYN.format(
        name=visible(reduced.name),
        about=reduced.about,
        unknowns=counted(len(reduced.unknowns), "unknown"),
        n=len(reduced.unknowns),
        frequencies=frequencies,
        stiffness=reduced.stiffness.tolist(),
        mass=reduced.mass.tolist(),
        ports=f"{{{ports}\n}}",
    )
    return text.encode("utf-8")


def as_simscape(reduced: Reduced) -> bytes:
    """Variables (.mat) of the block Reduced Order Flexible Solid.

    The variables are origins, stiffness, mass and damping. Each interface has a frame with the axes
    of the body; frames are in the order of the unknowns.
    """
    return _mat(
        {
            "origins": np.array(list(reduced.points.values())),
            "frames": np.array(list(reduced.points), dtype=object),
            "stiffness": reduced.stiffness,
            "mass": reduced.mass,
            "damping": np.zeros_like(reduced.mass),
            "frequencies": reduced.frequencies,
            "bounds": reduced.bounds,
            "about": f"{reduced.name}: {reduced.about}; SI units",
        }
    )


def as_nastran(reduced: Reduced) -> bytes:
    """Bulk data: a GRID at each interface, an SPOINT for each mode, K and M as DMIG.

    The case control has K2GG = KRED and M2GG = MRED. Needs the extra "nastran".
    """
    from pandas import DataFrame, MultiIndex  # noqa: PLC0415  installed with the extra
    from pyyeti.nastran import wtdmig  # noqa: PLC0415

    grids = range(1, len(reduced.points) + 1)
    inner = len(reduced.unknowns) - 6 * len(grids)
    freedoms = [(grid, i + 1) for grid in grids for i in range(6)]
    freedoms += [(_SCALARS + i, 0) for i in range(inner)]
    index = MultiIndex.from_tuples(freedoms, names=["id", "dof"])
    text = StringIO()
    text.write("$ Reduced model for Nastran, SI units; K2GG = KRED, M2GG = MRED\n")
    text.write(f"$ {visible(reduced.name)}: {reduced.about}\n")
    for grid, (name, point) in zip(grids, reduced.points.items(), strict=True):
        text.write(f"$ {name}\nGRID*   {grid:16d}{0:16d}{point[0]:16.9E}{point[1]:16.9E}\n")
        text.write(f"*       {point[2]:16.9E}\n")
    if inner:
        text.write(f"SPOINT  {_SCALARS:8d}THRU    {_SCALARS + inner - 1:8d}\n")
    for name, matrix in (("KRED", reduced.stiffness), ("MRED", reduced.mass)):
        wtdmig(text, {name: DataFrame(matrix, index=index, columns=index)})
    # Decks are ASCII. Names occur in comments only and can be escaped.
    return text.getvalue().encode("ascii", "backslashreplace")


def as_statespace(robot: ReducedRobot, kind: str) -> bytes:
    """State space (A, B, C, D) of the robot about its pose. `kind` is the suffix, .npz or .mat.

    States: modal amplitudes q (kg^½ m) and their rates. Inputs: forces of the elastic drives along
    their axes, then the wrench at the tool. Outputs: the tool's twist. Each mode is damped by its
    loss factor at its own frequency; dashpots couple the modes. D is the static compliance of all
    omitted modes, so that the static response is exact.
    """
    reduced, solution, modes = robot.matrices, robot.solution, robot.modes
    angular_frequencies = 2.0 * np.pi * modes.frequencies
    squared = angular_frequencies**2
    damping = modal_damping(solution, modes)
    count, tool = len(squared), reduced.ports["tool"]
    drives = {name: rows for name, rows in reduced.ports.items() if name != "tool"}
    inputs = np.vstack([*drives.values(), tool])
    input_shapes, output_shapes = inputs @ modes.shapes, tool @ modes.shapes
    static = solution.displacements(tool.T).T @ inputs.T
    zeros = np.zeros((count, count))
    arrays = {
        "A": np.block([[zeros, np.eye(count)], [-np.diag(squared), -damping]]),
        "B": np.vstack([np.zeros_like(input_shapes.T), input_shapes.T]),
        "C": np.hstack([output_shapes, np.zeros_like(output_shapes)]),
        "D": static - output_shapes / squared @ input_shapes.T,
        "inputs": np.array([*drives, *(f"tool {name}" for name in _WRENCH)]),
        "outputs": np.array([f"tool {name}" for name in TWIST]),
        "frequencies": reduced.frequencies,
        "bounds": reduced.bounds,
        "about": np.array(f"{reduced.name}: {reduced.about}; SI units"),
    }
    return _npz(arrays) if kind == ".npz" else _mat(arrays)


# Functions that return the content of a file, by name of the format: from matrices of a body or of
# the robot, and from the robot's state and the suffix of the file.
OF_BODIES: Mapping[str, Callable[[Reduced], bytes]] = {
    "npz": as_npz,
    "exudyn": as_exudyn,
    "simscape": as_simscape,
    "nastran": as_nastran,
}
OF_ROBOTS: Mapping[str, Callable[[ReducedRobot, str], bytes]] = {"statespace": as_statespace}


def _npz(arrays: Mapping[str, Array]) -> bytes:
    file = BytesIO()
    np.savez_compressed(file, allow_pickle=False, **arrays)
    return file.getvalue()


def _mat(arrays: Mapping[str, object]) -> bytes:
    from scipy.io import savemat  # noqa: PLC0415  few exports need it

    file = BytesIO()
    savemat(file, dict(arrays), do_compression=True, oned_as="column")
    return file.getvalue()
