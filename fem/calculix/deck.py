"""Input decks for CalculiX (and Abaqus): a model as plain data, and the text of its deck.

Rigid faces, joints and supports are linear equations between nodal displacements. Linear equations
are exact in a linear step; *RIGID BODY, which is made for finite rotations, need not be. A rotation
is represented by the displacement of a separate node. A freedom is a pair (node, component), with
the components 0, 1, 2 for x, y, z. Nodes are numbered from 0 here and from 1 in the text. Units are
SI.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isclose
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.errors import InputError
from lumped.legs import Material
from meshes.elements import ELEMENTS, SolidElement

Freedom: TypeAlias = tuple[int, int]  # node, component
# A freedom with a coefficient, the stiffness of a spring to the ground (N/m or N m/rad), or a force
# (N or N m).
OnFreedom: TypeAlias = tuple[Freedom, float]

# CalculiX reads only the first twenty characters of a number, even if the exponent comes later.
_NUMBER_WIDTH = 20
_TERMS_PER_LINE = 4
# Largest number of entries that CalculiX reads in one line.
_ENTRIES_PER_LINE = 16


@dataclass(frozen=True, eq=False)
class ElementSet:
    """Elements of one type and one material.

    `cells` (M×k) are node numbers in the order of `meshes.elements`. The columns of `axes` (3×3)
    are the axes of the material in the axes of the deck. None if both are the same. `elasticity`
    (6×6, in Pa; xx yy zz yz xz xy) is the elasticity matrix of an orthotropic material in the axes
    of the material. None if `material` gives the elasticity. The density is always that of
    `material`.
    """

    cells: IntArray
    element: SolidElement
    material: Material
    axes: Array | None = None
    elasticity: Array | None = None


@dataclass(frozen=True)
class Equation:
    """Linear equation u(dependent) = Σ coefficient · u(freedom) between displacements u.

    `terms` are pairs of a freedom and its coefficient. The `dependent` freedom must not occur in
    any other equation.
    """

    dependent: Freedom
    terms: tuple[OnFreedom, ...]


@dataclass(frozen=True, eq=False)
class Deck:
    """A linear model with its load cases and the number of requested modes.

    `nodes` (N×3, in m) are positions, `parts` the elements. `held` are freedoms fixed at zero.
    `masses` are pairs of a node and a point mass (kg). `springs` are pairs of a freedom and the
    stiffness (N/m or N m/rad) of a spring to the ground. Each of the `load_cases` is one static
    step, given by pairs of a freedom and a force (N or N m). Displacements are printed for the
    nodes `watched`. `modes` is the number of modes. If it is 0, no frequencies are computed.
    """

    title: str
    nodes: Array
    parts: tuple[ElementSet, ...]
    equations: tuple[Equation, ...] = ()
    held: tuple[Freedom, ...] = ()
    masses: tuple[tuple[int, float], ...] = ()
    springs: tuple[OnFreedom, ...] = ()
    load_cases: tuple[tuple[OnFreedom, ...], ...] = ()
    watched: tuple[int, ...] = ()
    modes: int = 0


def deck_text(deck: Deck) -> str:
    """Text of the input deck. Raises InputError for elements that CalculiX does not have."""
    return "\n".join(_lines(deck)) + "\n"


def _lines(deck: Deck) -> Iterator[str]:
    # The prefix is needed because a robot may have the name of a keyword.
    yield from ("*HEADING", f"deck of {deck.title}")
    yield "*NODE, NSET=ALL"
    for number, (x, y, z) in enumerate(deck.nodes.tolist(), start=1):
        yield f"{number}, {_number(x)}, {_number(y)}, {_number(z)}"
    first = 1
    for index, part in enumerate(deck.parts, start=1):
        yield from _part(part, f"PART{index}", first)
        first += len(part.cells)
    for index, (node, mass) in enumerate(deck.masses, start=1):
        name = f"MASS{index}"
        yield f"*ELEMENT, TYPE=MASS, ELSET={name}"
        yield f"{first}, {node + 1}"
        yield from (f"*MASS, ELSET={name}", _number(mass))
        first += 1
    for index, ((node, component), stiffness) in enumerate(deck.springs, start=1):
        name = f"SPRING{index}"
        yield f"*ELEMENT, TYPE=SPRING1, ELSET={name}"
        yield f"{first}, {node + 1}"
        yield from (f"*SPRING, ELSET={name}", f"{component + 1}", _number(stiffness))
        first += 1
    if deck.equations:
        yield "*EQUATION"
        for equation in deck.equations:
            yield from _equation(equation)
    if deck.held:
        yield "*BOUNDARY"
        yield from (f"{node + 1}, {component + 1}" for node, component in deck.held)
    if deck.watched:
        yield "*NSET, NSET=WATCHED"
        yield from (f"{node + 1}," for node in deck.watched)
    for forces in deck.load_cases:
        # OP=NEW removes the loads of the previous step.
        yield from ("*STEP", "*STATIC", "*CLOAD, OP=NEW")
        for (node, component), force in forces:
            yield f"{node + 1}, {component + 1}, {_number(force)}"
        yield from ("*NODE PRINT, NSET=WATCHED", "U", "*END STEP")
    if deck.modes:
        yield from ("*STEP", "*FREQUENCY", f"{deck.modes}", "*END STEP")


def _part(part: ElementSet, name: str, first: int) -> Iterator[str]:
    kind = ELEMENTS[part.element]
    if kind.abaqus is None:
        raise InputError(
            f"{part.element} elements cannot be exported, because CalculiX has no element with "
            f"{kind.node_count} nodes; take tet10, tet4 or hex8"
        )
    yield f"*ELEMENT, TYPE={kind.abaqus}, ELSET={name}"
    for number, nodes in enumerate((part.cells + 1).tolist(), start=first):
        entries = [str(number), *map(str, nodes)]
        yield from _continued(entries)
    yield f"*MATERIAL, NAME={name}"
    if part.elasticity is None:
        yield from _elastic(part.material)
    else:
        yield from _orthotropic(part.elasticity)
    yield from ("*DENSITY", _number(part.material.rho))
    section = f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"
    if part.axes is None:
        yield section
        return
    yield f"*ORIENTATION, NAME={name}, SYSTEM=RECTANGULAR"
    yield ", ".join(_number(x) for x in part.axes[:, :2].T.ravel())
    yield f"{section}, ORIENTATION={name}"


def _continued(entries: Sequence[str]) -> Iterator[str]:
    """Lines with at most `_ENTRIES_PER_LINE` entries each. All but the last end with a comma."""
    starts = range(0, len(entries), _ENTRIES_PER_LINE)
    lines = [", ".join(entries[start : start + _ENTRIES_PER_LINE]) for start in starts]
    yield from (f"{line}," for line in lines[:-1])
    yield lines[-1]


def _elastic(material: Material) -> Iterator[str]:
    E, G, nu = material.E, material.G, material.nu
    if isclose(G, E / (2.0 * (1.0 + nu)), rel_tol=1e-14):
        yield from ("*ELASTIC", f"{_number(E)}, {_number(nu)}")
        return
    C11 = E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
    C12 = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    elasticity = np.diag([C11, C11, C11, G, G, G])
    elasticity[[0, 0, 1, 1, 2, 2], [1, 2, 0, 2, 0, 1]] = C12
    yield from _orthotropic(elasticity)


def _orthotropic(elasticity: Array) -> Iterator[str]:
    """Lines of the card *ELASTIC for an orthotropic elasticity matrix (6×6, Pa).

    CalculiX expects the entries C_ijkl of the matrix in the order ijkl = 1111, 1122, 2222, 1133,
    2233, 3333, 1212, 1313, 2323.
    """
    places = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2), (5, 5), (4, 4), (3, 3))
    *first, last = (_number(float(elasticity[index])) for index in places)
    yield "*ELASTIC, TYPE=ORTHO"
    yield ", ".join(first)
    yield last


def _equation(equation: Equation) -> Iterator[str]:
    terms = [(equation.dependent, 1.0), *((f, -c) for f, c in equation.terms)]
    yield f"{len(terms)}"
    for start in range(0, len(terms), _TERMS_PER_LINE):
        yield ", ".join(
            f"{node + 1}, {component + 1}, {_number(coefficient)}"
            for (node, component), coefficient in terms[start : start + _TERMS_PER_LINE]
        )


def _number(value: float) -> str:
    """Text of a number with all digits, or with fourteen if CalculiX cannot read more."""
    shortest = repr(float(value))
    return shortest if len(shortest) <= _NUMBER_WIDTH else f"{value:.{_NUMBER_WIDTH - 7}e}"
