"""Stiffnesses and inertias of a prismatic beam, and its compliance at the tip.

Axes of the leg: x runs along the line of centroids from the root to the tip, y and z are axes of
the section.
"""

from dataclasses import dataclass, replace

import numpy as np

from lumped.arrays import Array
from lumped.centre_line import straight_line
from lumped.line_sections import FIELDS, FURTHER, LineSections
from lumped.screws import move_compliance
from lumped.tapers import NODES


@dataclass(frozen=True)
class BeamProperties:
    """Stiffnesses and inertias of a prismatic leg, about the line of its centroids.

    `EA` is in N, `EIy`, `EIz` and `GJ` are in N m². `GAy` and `GAz` (N) are κGA for shear along y
    and along z, infinite without shear deformation. `mu` is the mass per length (kg/m). `rho_J`,
    `rho_Iy` and `rho_Iz` (kg m) are the rotary inertia per length about x, y and z. `rho_Iy` and
    `rho_Iz` are zero in Euler–Bernoulli theory.

    The remaining fields are zero for a section of one material with two axes of symmetry. `EIyz` is
    E∫yz dA (N m²) and `rho_Iyz` is ρ∫yz dA (kg m). `shear_yz` (1/N) is the shear strain along z due
    to a unit force along y. (`centre_y`, `centre_z`) is the position (m) of the shear centre,
    through which forces do not twist the leg, and (`mass_y`, `mass_z`) that of the centre of mass.
    Both are relative to the centroid, which is weighted by Young's modulus. Rotary inertias are
    taken about this centroid.

    Helical fibres couple tension with torsion, and shear with bending: `twist_x` is the rate of
    twist per axial force, and `turn_y` and `turn_z` are the rates of φy and φz per shear force
    along y and along z (1/(N m)). `EA`, `GJ`, EI and κGA are then stiffnesses with all other stress
    resultants zero. Such a section must have its shear centre and its centre of mass at the
    centroid.
    """

    EA: float
    EIy: float
    EIz: float
    GJ: float
    GAy: float
    GAz: float
    mu: float
    rho_J: float
    rho_Iy: float
    rho_Iz: float
    EIyz: float = 0.0
    rho_Iyz: float = 0.0
    shear_yz: float = 0.0
    centre_y: float = 0.0
    centre_z: float = 0.0
    mass_y: float = 0.0
    mass_z: float = 0.0
    twist_x: float = 0.0
    turn_y: float = 0.0
    turn_z: float = 0.0

    @property
    def is_helical(self) -> bool:
        """True if tension twists the leg, or a shear force bends it normal to the force."""
        return bool(self.twist_x or self.turn_y or self.turn_z)

    @property
    def couples_bending(self) -> bool:
        """True if a force along y also deflects the leg along z."""
        return bool(self.EIyz or self.shear_yz)

    @property
    def couples_torsion(self) -> bool:
        """True if forces through the centroid twist the leg."""
        return bool(self.centre_y or self.centre_z)

    @property
    def is_eccentric(self) -> bool:
        """True if the centre of mass differs from the centroid."""
        return bool(self.mass_y or self.mass_z)

    @property
    def couplings(self) -> dict[tuple[int, int], float]:
        """Entries of the section's 6×6 flexibility due to helical fibres, by row and column."""
        if not self.is_helical:
            return {}
        return {(0, 3): self.twist_x, (1, 4): self.turn_y, (2, 5): self.turn_z}

    @property
    def section_mass(self) -> Array:
        """6×6 mass matrix per length (kg/m, kg, kg m) of a section, for the twist of its centroid.

        An eccentric mass couples axial motion with bending rotations. Euler–Bernoulli beams have no
        rotary inertia of bending, and this coupling is left out for them, too.
        """
        mass = np.diag([self.mu] * 3 + [self.rho_J, self.rho_Iy, self.rho_Iz])
        mass[4, 5] = mass[5, 4] = -self.rho_Iyz
        mass[1, 3] = mass[3, 1] = -self.mu * self.mass_z
        mass[2, 3] = mass[3, 2] = self.mu * self.mass_y
        if self.rho_Iy or self.rho_Iz:
            mass[0, 4] = mass[4, 0] = self.mu * self.mass_z
            mass[0, 5] = mass[5, 0] = -self.mu * self.mass_y
        return mass

    @property
    def bending(self) -> Array:
        """Bending stiffness [EIz EIyz; EIyz EIy] (N m²).

        Multiplied by the curvatures of the deflections along y and z it gives (Mz, −My).
        """
        return np.array([[self.EIz, self.EIyz], [self.EIyz, self.EIy]])

    @property
    def shear_flexibility(self) -> Array:
        """Shear flexibility [1/GAy s; s 1/GAz] (1/N) with s = `shear_yz`.

        Multiplied by the shear forces (Vy, Vz) it gives the shear strains along y and z.
        """
        return np.array([[1.0 / self.GAy, self.shear_yz], [self.shear_yz, 1.0 / self.GAz]])

    @property
    def rotary_inertia(self) -> Array:
        """Rotary inertia per length [ρIz ρIyz; ρIyz ρIy] (kg m) for the rotations (φz, −φy)."""
        return np.array([[self.rho_Iz, self.rho_Iyz], [self.rho_Iyz, self.rho_Iy]])

    @property
    def to_shear_centre(self) -> Array:
        """6×6 matrix T: twist at the shear centre of a section = T · twist at its centroid."""
        transfer = np.eye(6)
        transfer[1, 3], transfer[2, 3] = -self.centre_z, self.centre_y
        return transfer

    def as_euler_bernoulli(self) -> "BeamProperties":
        """Copy of the properties without shear deformation and rotary inertia of bending."""
        rigid = replace(self, GAy=np.inf, GAz=np.inf, shear_yz=0.0, turn_y=0.0, turn_z=0.0)
        return replace(rigid, rho_Iy=0.0, rho_Iz=0.0, rho_Iyz=0.0)

    def piece_compliance(self, length: float) -> Array:
        """6×6 compliance (SI, leg axes) of a piece of `length` l (m), referred to its middle.

        The reference point is the centroid of the section in the middle of the piece. For a section
        with two axes of symmetry the matrix is diagonal: (l/EA, l³/12EIz + l/κGA, l³/12EIy + l/κGA,
        l/GJ, l/EIy, l/EIz). Rigid elements joined by such springs have exact static deflections for
        any number of elements. For sections without these symmetries, bending and shear are 2×2
        blocks. If the shear centre is not the centroid, the compliance C_s is computed for the
        shear centre, which torsion does not move, and transformed to the centroid: C = T⁻¹ C_s T⁻ᵀ
        with T = `to_shear_centre`.
        """
        compliance = np.diag(
            [
                length / self.EA,
                length**3 / (12.0 * self.EIz) + length / self.GAy,
                length**3 / (12.0 * self.EIy) + length / self.GAz,
                length / self.GJ,
                length / self.EIy,
                length / self.EIz,
            ]
        )
        if self.couples_bending:
            flexibility = np.linalg.inv(self.bending)
            shear = length * self.shear_flexibility
            compliance[1:3, 1:3] = length**3 / 12.0 * flexibility + shear
            # φz = dv/dx for the deflection v along y, φy = −dw/dx for the deflection w along z.
            signs = np.array([[1.0, -1.0], [-1.0, 1.0]])
            compliance[4:, 4:] = length * signs * flexibility[::-1, ::-1]
        # Shear forces are constant along the piece, and bending is odd about its middle, so that
        # couplings are those of the section.
        for (row, column), coupling in self.couplings.items():
            compliance[row, column] = compliance[column, row] = length * coupling
        if self.couples_torsion:
            from_shear_centre = np.linalg.inv(self.to_shear_centre)
            compliance = from_shear_centre @ compliance @ from_shear_centre.T
        return np.asarray(compliance)


def tip_compliance(properties: BeamProperties, length: float) -> Array:
    """6×6 compliance (SI, leg axes) at the tip of a prismatic cantilever of `length` L (m).

    It is the compliance of the whole leg about its middle, transferred to its end. For a section
    with two axes of symmetry, c22 = L³/3EIz + L/κGA, c26 = L²/2EIz and c35 = −L²/2EIy.
    """
    return move_compliance(properties.piece_compliance(length), np.array([length / 2.0, 0.0, 0.0]))


def prism_sections(properties: BeamProperties, length: float) -> LineSections:
    """Sections of a prism of `length` (m) along its centre line.

    The sections have the given `properties`, whose centre of mass must be the centroid.
    """
    constants = [*(getattr(properties, name) for name in FIELDS), *[0.0] * len(FURTHER)]
    values = np.tile(constants, (1, len(NODES), 1))
    return LineSections(straight_line(length), np.array([0.0, length]), values)
