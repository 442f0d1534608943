"""Sections along a centre line: flexibility and mass per length, and integrals of both.

The compliance C of a piece of the line follows from equilibrium alone (force method), because each
section carries the wrench on one end of the piece. If C and the wrench are referred to a point o,

    C = ∫ X F Xᵀ ds,   X = shift(o − r(s)),

where F is the flexibility (6×6, per length) of the section at r(s), and shift is the function
`lumped.screws.shift`. This is exact for every taper, step, corner and arc, in the beam theory of F.
The constants of the sections vary smoothly within a span, and are interpolated there by
polynomials. Areas and moments of area of linear tapers are polynomials themselves.

In an arc of curvature k, with the components ky and kz in the section's axes, the length of a fibre
at (y, z) is that of the centre line times 1 − ξ with ξ = ky y + kz z (Winkler). An extension ε and
a change κ of the line's curvature cause the strain (ε + z κy − y κz)/(1 − ξ) of the fibre. The
strain energy is that of a straight beam with the strains

    ε,   κy + kz ε,   κz − ky ε

and with ∫ z²/(1 − ξ) dA and similar integrals in place of the moments of area. For shapes with two
axes of symmetry these integrals are expanded to second order: ∫ z²(1 + ξ²) dA. In an arc of radius
R, the next term is 0.03 (h/R)⁴ of the bending stiffness of a rectangle of height h. Fibres on the
outside of the arc are longer, so that the mass centre lies I/AR off the line.

In a taper, fibres converge: the fibre at (y, z) has the slope (λy y, λz z) against the centre line.
Here λ = d ln a/ds is the rate of the lever arm a = I/S in bending about each axis, with the second
moment of area I, and the first moment of area S of half the section. Equilibrium of the part of the
section outside of a fibre gives the shear flow d(M S/I)/ds. The forces that shear the section are
therefore

    Qy + λy Mz,   Qz − λz My

(Bleich, Stahlhochbauten, 1932). They are zero in a wedge that is loaded at its apex, as Michell
found. Inclined fibres are softer than parallel ones, and shear stresses along them couple moment
and shear force (`lumped.tapers`). These effects are computed for shapes with two axes of symmetry,
and in Timoshenko's theory only. In Euler–Bernoulli theory fibres are taken as parallel. In wedges,
cones and pyramids the errors of bending and tension are of fourth order in the slope. Errors of
torsion, and of other tapers that shrink more in one direction than in the other, are of second
order.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from numpy.polynomial import chebyshev, legendre

from lumped.arrays import Array, IntArray, distinct
from lumped.centre_line import CentreLine
from lumped.errors import ComputationError
from lumped.screws import shift, skew, turn
from lumped.tapers import NODES, TAPER

# Constants of a section, by their names in `BeamProperties`.
FIELDS = (
    *("EA", "EIy", "EIz", "GJ", "GAy", "GAz", "mu", "rho_J", "rho_Iy", "rho_Iz"),
    *("EIyz", "rho_Iyz", "shear_yz", "centre_y", "centre_z", "twist_x", "turn_y", "turn_z"),
)
# Further constants: E times ∫y⁴ dA, ∫z⁴ dA and ∫y²z² dA (N m⁴), and those of the taper. They are
# zero for shapes without two axes of symmetry.
FURTHER = ("EIyyyy", "EIzzzz", "EIyyzz", *TAPER)
# Gauss points per element. A taper 2 : 1 in one element has an error of 5.8^-24.
GAUSS = 12
# Distance, as a fraction of the line's length, below which two ends of spans count as one.
TOGETHER = 1e-9


# Computed when first needed: many processes import this module and solve no curved leg.
@cache
def gauss_points() -> tuple[Array, Array]:
    """Gauss points on [−1, 1] and their weights, for integrals along elements."""
    points, weights = legendre.leggauss(GAUSS)
    return points, weights


@cache
def _interpolation() -> Array:
    """Matrix that maps the values of a function at Gauss points to its Legendre coefficients."""
    return np.asarray(np.linalg.inv(legendre.legvander(gauss_points()[0], GAUSS - 1)))


@cache
def _cumulative_weights() -> Array:
    """Weights of integrals from −1 to each Gauss point, for functions known at these points."""
    points, _ = gauss_points()
    integrals = [
        legendre.legval(points, antiderivative) - legendre.legval(-1.0, antiderivative)
        for antiderivative in (legendre.legint(row) for row in np.eye(GAUSS))
    ]
    return np.asarray(np.column_stack(integrals) @ _interpolation())


def cumulative(values: Array, lengths: Array) -> Array:
    """Integrals (e×GAUSS×…) from the start of each of e elements to each of its Gauss points.

    `values` (e×GAUSS×…) are values of the integrand at the Gauss points, `lengths` (e, in m) are
    the lengths of the elements.
    """
    return np.asarray(np.einsum("pq,eq...,e->ep...", _cumulative_weights(), values, 0.5 * lengths))


def interpolation(coordinates: Array) -> Array:
    """Matrix (n×GAUSS) that interpolates values at the Gauss points to n `coordinates`.

    The coordinates lie between −1 and 1.
    """
    return np.asarray(legendre.legvander(coordinates, GAUSS - 1) @ _interpolation())


@dataclass(frozen=True, eq=False)
class SectionField:
    """Flexibility, stiffness and mass of sections at points of a centre line, SI units.

    All arrays have the same leading dimensions (…). `points` (…×3, in m, leg axes) are the
    positions. A section has six independent strains, in order: extension, shear along its y and z
    axes, twist, and curvature about these axes. Column j of `strains` (…×6×6) is the rate of change
    of the twist along the line (per m, leg axes) for a unit of strain j. `stiffness` (…×6×6) is for
    the six strains. `rigid` (6) marks strains without flexibility, whose rows and columns of
    `stiffness` are zero. `flexibility` and `mass` (…×6×6, leg axes) are per length.
    """

    points: Array
    strains: Array
    flexibility: Array
    stiffness: Array
    mass: Array
    rigid: tuple[bool, ...]


@dataclass(frozen=True, eq=False)
class LocalChange:
    """Change of flexibility and mass of all sections between `start` and `end` (m along the line).

    `factor` (6×6) multiplies the strains of the sections, referred to `point` (3, in m, leg axes).
    `first_moment` (3, in kg, leg axes) is a first moment of mass about the point, per length.
    """

    start: float
    end: float
    point: Array
    factor: Array
    first_moment: Array

    def apply(self, field: SectionField, positions: Array) -> SectionField:
        """Sections at n `positions` (m along the line) with this change."""
        inside = (positions > self.start) & (positions < self.end)
        to_point = shift(self.point - field.points[inside])
        to_section = shift(field.points[inside] - self.point)
        factor = to_section @ self.factor @ to_point
        coupling = np.zeros((6, 6))
        coupling[3:, :3] = skew(self.first_moment)
        coupling[:3, 3:] = -coupling[3:, :3]
        strains, flexibility, mass = (
            field.strains.copy(),
            field.flexibility.copy(),
            field.mass.copy(),
        )
        strains[inside] = factor @ strains[inside]
        flexibility[inside] = factor @ flexibility[inside] @ np.swapaxes(factor, 1, 2)
        mass[inside] += np.swapaxes(to_point, 1, 2) @ coupling @ to_point
        return replace(field, strains=strains, flexibility=flexibility, mass=mass)


@dataclass(frozen=True, eq=False)
class LineSections:
    """Sections of a leg along its centre line.

    `ends` (k+1 values, in m along the line) are the ends of the k spans. `values` (k×p×28) are the
    section constants named in `FIELDS` and `FURTHER`, at p points of each span. The points are at
    the fractions `lumped.tapers.NODES` of the span. `changes` are those of flexibility and mass
    near points of the line, in the order in which they apply.
    """

    line: CentreLine
    ends: Array
    values: Array
    changes: tuple[LocalChange, ...] = ()

    @cached_property
    def breaks(self) -> Array:
        """Positions (m along the line) between which sections vary smoothly, from 0 to its end."""
        limits = [(change.start, change.end) for change in self.changes]
        positions = np.sort(np.concatenate([self.ends, *limits]))
        return np.asarray(distinct(positions, TOGETHER * self.line.length))

    def changed(
        self,
        position: float,
        reaches: Sequence[float],
        compliance: Array,
        first_moment: Array,
    ) -> "LineSections":
        """Sections with an additional `compliance` (6×6, SI, leg axes) at a point of the line.

        `position` (m along the line) is that of the point. The compliance C is the twist, referred
        to the point, under a unit wrench on it. It is spread over the line up to a distance from
        the point, where the line has the compliance R: with R = S Sᵀ, the factor
        S (1 + S⁻¹ C S⁻ᵀ)^½ S⁻¹ on all strains makes it R + C. The distance is the first of the
        `reaches` (m, ascending) with which no flexibility becomes negative. `first_moment` (3, in
        kg m) is the additional first moment of mass about the point. Raises ComputationError if
        R + C is not positive definite for any of the reaches.
        """
        points, _ = self.line.frames(np.array([position]))
        for reach in reaches:
            start, end = max(0.0, position - reach), min(self.line.length, position + reach)
            (own,) = self.compliances(np.array([start, end]), points)
            root = np.linalg.cholesky(own)
            inverse = np.linalg.inv(root)
            ratios, directions = np.linalg.eigh(np.eye(6) + inverse @ compliance @ inverse.T)
            if ratios[0] > 0.0:
                factor = root @ (directions * np.sqrt(ratios)) @ directions.T @ inverse
                moment = first_moment / (end - start)
                change = LocalChange(start, end, points[0], factor, moment)
                return replace(self, changes=(*self.changes, change))
        raise ComputationError(
            "the compliance of a corner or step exceeds that of the leg around it"
        )

    @cached_property
    def _coefficients(self) -> Array:
        """Chebyshev coefficients (k×p×28) of the section constants in each span.

        If a constant is infinite, its first coefficient is infinite and its further coefficients
        are zero.
        """
        infinite = np.isinf(self.values).any(axis=1, keepdims=True)
        finite = np.where(infinite, 0.0, self.values)
        transform = np.linalg.inv(chebyshev.chebvander(2.0 * NODES - 1.0, len(NODES) - 1))
        coefficients = np.einsum("pq,kqf->kpf", transform, finite)
        coefficients[:, :1][infinite] = np.inf
        return np.asarray(coefficients)

    def constants(self, spans: IntArray, positions: Array) -> Array:
        """Section constants (n×28: `FIELDS`, then `FURTHER`) at n `positions` (m along the line).

        `spans` (n) are the indices of the spans to which the positions belong.
        """
        lengths = np.diff(self.ends)
        shares = (positions - self.ends[spans]) / lengths[spans]
        terms = chebyshev.chebvander(2.0 * shares - 1.0, len(NODES) - 1)
        coefficients = self._coefficients[spans]
        infinite = np.isinf(coefficients[:, 0])
        values = np.einsum("np,npf->nf", terms, np.where(infinite[:, None], 0.0, coefficients))
        return np.where(infinite, np.inf, values)

    def edges(self, elements: int) -> Array:
        """Ends (m along the line) of about `elements` elements, each of which lies within one span.

        Limits of local changes divide spans, too. The number of elements in a span is proportional
        to its length and rounded up. It is rounded for a count that is halved as often as possible,
        so that twice as many `elements` halve every element from one element for each span on.
        Orders of convergence require this.
        """
        lengths, halvings = np.diff(self.breaks), 1
        while elements % (2 * halvings) == 0 and elements // (2 * halvings) >= len(lengths):
            halvings *= 2
        shares = lengths / self.breaks[-1]
        counts = halvings * np.ceil(elements // halvings * shares - TOGETHER).astype(int)
        pieces = [
            start + length * np.arange(count) / count
            for start, length, count in zip(
                self.breaks, lengths, np.maximum(counts, 1), strict=False
            )
        ]
        return np.concatenate([*pieces, self.breaks[-1:]])

    def along(self, edges: Array) -> SectionField:
        """Sections at the Gauss points (e×GAUSS) of the e elements between `edges` (e+1, in m).

        Each element lies within one span.
        """
        middles, halves = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
        positions = (middles[:, None] + halves[:, None] * gauss_points()[0]).ravel()
        spans = np.repeat(self.span_at(middles), GAUSS)
        field = self.at(spans, positions)
        shape = (len(middles), GAUSS)
        arrays = (
            values.reshape(*shape, *values.shape[1:])
            for values in (
                field.points,
                field.strains,
                field.flexibility,
                field.stiffness,
                field.mass,
            )
        )
        points, strains, flexibility, stiffness, mass = arrays
        return SectionField(points, strains, flexibility, stiffness, mass, field.rigid)

    def span_at(self, positions: Array) -> IntArray:
        """Index of the span at each of n `positions` (m along the line)."""
        numbers = np.searchsorted(self.ends, positions, side="right") - 1
        return np.clip(numbers, 0, len(self.ends) - 2)

    def at(self, spans: IntArray, positions: Array) -> SectionField:
        """Sections at n `positions` (m along the line).

        `spans` (n) are the indices of the spans to which the positions belong.
        """
        pieces = self.line.piece_at(0.5 * (self.ends[spans] + self.ends[spans + 1]))
        points, axes = self.line.frames(positions, pieces)
        rows = dict(zip((*FIELDS, *FURTHER), self.constants(spans, positions).T, strict=True))
        to_axes = turn(axes)
        own_strains = np.zeros_like(to_axes)
        own_strains[...] = np.eye(6)
        # Inverse of `BeamProperties.to_shear_centre`.
        own_strains[:, 1, 3], own_strains[:, 2, 3] = rows["centre_z"], -rows["centre_y"]
        curvature_y, curvature_z = self.line.curvatures(axes, pieces).T
        own_strains[:, 4, 0], own_strains[:, 5, 0] = -curvature_z, curvature_y
        own_strains[:, 5, 1], own_strains[:, 4, 2] = rows["rate_y"], -rows["rate_z"]
        strains = to_axes @ own_strains
        local = np.zeros_like(to_axes)
        shear = np.stack(
            [[1.0 / rows["GAy"], rows["shear_yz"]], [rows["shear_yz"], 1.0 / rows["GAz"]]]
        )
        bending = np.stack([[rows["EIy"], -rows["EIyz"]], [-rows["EIyz"], rows["EIz"]]])
        yyyy, zzzz, yyzz = (rows[name] for name in ("EIyyyy", "EIzzzz", "EIyyzz"))
        EA = rows["EA"] / (1.0 + rows["softer"])
        bending[0, 0] /= 1.0 + rows["softer_y"]
        bending[1, 1] /= 1.0 + rows["softer_z"]
        squares = curvature_y**2, curvature_z**2
        bending[0, 0] += squares[0] * yyzz + squares[1] * zzzz
        bending[1, 1] += squares[0] * yyyy + squares[1] * yyzz
        bending[0, 1] -= 2.0 * curvature_y * curvature_z * yyzz
        bending[1, 0] = bending[0, 1]
        local[:, 0, 0], local[:, 3, 3] = 1.0 / EA, 1.0 / rows["GJ"]
        local[:, 1:3, 1:3] = np.moveaxis(shear, -1, 0)
        local[:, 4:, 4:] = np.linalg.inv(np.moveaxis(bending, -1, 0))
        for row, column, name in ((0, 3, "twist_x"), (1, 4, "turn_y"), (2, 5, "turn_z")):
            local[:, row, column] = local[:, column, row] = rows[name]
        # σ = −Mz y/Iz and σ = My z/Iy.
        local[:, 1, 5] = local[:, 5, 1] = -rows["cross_y"]
        local[:, 2, 4] = local[:, 4, 2] = rows["cross_z"]
        rigid = tuple(bool(row) for row in (np.diagonal(local, axis1=1, axis2=2) == 0.0).any(0))
        stiffness = np.zeros_like(local)
        elastic = np.flatnonzero(~np.array(rigid))
        block = np.ix_(np.arange(len(local)), elastic, elastic)
        stiffness[block] = np.linalg.inv(local[block])
        mass = np.zeros_like(local)
        mass[:, [0, 1, 2], [0, 1, 2]] = rows["mu"][:, None]
        mass[:, 3, 3], mass[:, 4, 4], mass[:, 5, 5] = (
            rows[name] for name in ("rho_J", "rho_Iy", "rho_Iz")
        )
        mass[:, 4, 5] = mass[:, 5, 4] = -rows["rho_Iyz"]
        moment = np.zeros((len(local), 3))
        moment[:, 1] = -curvature_y * rows["rho_Iz"] - curvature_z * rows["rho_Iyz"]
        moment[:, 2] = -curvature_y * rows["rho_Iyz"] - curvature_z * rows["rho_Iy"]
        mass[:, 3:, :3] = skew(moment)
        mass[:, :3, 3:] = -mass[:, 3:, :3]
        field = SectionField(
            points=points,
            strains=strains,
            flexibility=strains @ local @ np.swapaxes(strains, 1, 2),
            stiffness=stiffness,
            mass=to_axes @ mass @ np.swapaxes(to_axes, 1, 2),
            rigid=rigid,
        )
        for change in self.changes:
            field = change.apply(field, positions)
        return field

    def compliances(self, edges: Array, origins: Array) -> Array:
        """Compliances (k×6×6, SI) of the k pieces between `edges`.

        Each piece is referred to its origin, a row of `origins` (k×3, in m).
        """
        return self._integrals(edges, origins, mass=False)

    def masses(self, edges: Array, origins: Array) -> Array:
        """Mass matrices (k×6×6, SI) of the k pieces between `edges`, as rigid bodies.

        Each piece is referred to its origin, a row of `origins` (k×3, in m).
        """
        return self._integrals(edges, origins, mass=True)

    def _integrals(self, edges: Array, origins: Array, *, mass: bool) -> Array:
        inner = self.breaks[(self.breaks > edges[0]) & (self.breaks < edges[-1])]
        all_edges = np.sort(np.concatenate([edges, inner]))
        all_edges = distinct(all_edges, TOGETHER * self.line.length)
        owner = np.clip(
            np.searchsorted(edges, 0.5 * (all_edges[1:] + all_edges[:-1])) - 1, 0, len(origins) - 1
        )
        field = self.along(all_edges)
        offsets = field.points - origins[owner][:, None]
        if mass:
            levers = shift(offsets)
            values = np.swapaxes(levers, -1, -2) @ field.mass @ levers
        else:
            levers = shift(-offsets)
            values = levers @ field.flexibility @ np.swapaxes(levers, -1, -2)
        weights = 0.5 * np.diff(all_edges)[:, None] * gauss_points()[1]
        totals = np.zeros((len(origins), 6, 6))
        np.add.at(totals, owner, np.einsum("eg,egij->eij", weights, values))
        return totals

    @property
    def tip_compliance(self) -> Array:
        """6×6 compliance (SI, leg axes) at the tip with the root clamped."""
        tip = np.array([[self.line.chord, 0.0, 0.0]])
        # Elements halve the taper within the reach of one quadrature.
        fine = self.edges(4 * (len(self.breaks) - 1))
        tips = np.repeat(tip, len(fine) - 1, axis=0)
        return np.asarray(self.compliances(fine, tips).sum(axis=0))
