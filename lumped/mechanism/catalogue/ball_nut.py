"""Axial stiffness of nuts and fixed bearings of ball screws, from manufacturers' tables.

Catalogues give the calculated stiffness K of the balls under a stated fraction of the basic dynamic
load rating Ca. The fraction is 0.1, in some series 0.05, for the preload of a preloaded nut, and
0.3 for the load of a nut with play. By Hertz, the stiffness of balls varies with the cube root of
the load. Catalogues multiply it by 0.8 to account for the deformation of the nut itself. Under the
load F the stiffness is

    k = 0.8 K (F / (share Ca))^(1/3)

with the stated fraction `share`, and with K and Ca from the table of the nut (THK, General Catalog,
Ball Screw, "Studying the Rigidity"; NSK, Precision Machine Components; HIWIN, Ballscrews,
"Rigidity").

The nuts in `NUTS` are from HIWIN's tables of ground screws to DIN 69051-5. Only nuts are included
whose designation has a single value of K and whose values agree with each other. They are double
nuts (FDI, FDC) with K under a preload of 0.1 Ca, and single nuts with play (FSI) with K under 0.28
Ca. The balls of the double nuts alone, all loaded in rigid threads, would be 1.5 to 1.7 times as
stiff as K.
"""

from dataclasses import dataclass

# Stiffness of balls and nut, as a fraction of the stiffness of the balls alone.
_WITH_NUT = 0.8
# Fractions of the load rating at which tables give the stiffness of preloaded nuts, and of nuts
# with play; and of HIWIN's nuts with play.
PRELOADED, WITH_PLAY, _HIWIN_WITH_PLAY = 0.1, 0.3, 0.28
# Root diameter of the shaft (m), K (N/m) and Ca (N) of nuts by their designation: R, diameter,
# lead, number of circuits (T of one turn each, K of cassettes), type. HIWIN GmbH, Ballscrews,
# tables 6.5 (FDC), 6.6 (FSI) and 6.7 (FDI).
NUTS: dict[str, tuple[float, float, float]] = {
    "R20-5T4-FDI": (17.32e-3, 540e6, 10_910.0),
    "R25-5T4-FDI": (22.32e-3, 730e6, 12_520.0),
    "R25-10T3-FDI": (21.13e-3, 490e6, 16_430.0),
    "R32-5T4-FDI": (29.32e-3, 820e6, 14_310.0),
    "R32-10T3-FDI": (26.91e-3, 680e6, 25_390.0),
    "R40-10T4-FDI": (34.91e-3, 1010e6, 37_890.0),
    "R50-10T4-FDI": (44.91e-3, 1240e6, 43_500.0),
    "R63-10T6-FDI": (57.91e-3, 2280e6, 68_870.0),
    "R15-10K3-FDC": (12.324e-3, 330e6, 9_600.0),
    "R16-16K2-FDC": (13.124e-3, 230e6, 6_800.0),
    "R20-10K3-FDC": (17.324e-3, 420e6, 11_300.0),
    "R20-20K2-FDC": (17.324e-3, 270e6, 7_600.0),
    "R25-25K2-FDC": (22.324e-3, 320e6, 8_400.0),
    "R32-20K3-FDC": (28.744e-3, 680e6, 19_000.0),
    "R32-32K2-FDC": (28.744e-3, 440e6, 12_800.0),
    "R40-20K4-FDC": (34.910e-3, 1150e6, 51_300.0),
    "R40-40K2-FDC": (34.910e-3, 560e6, 26_600.0),
    "R20-5T4-FSI": (17.32e-3, 270e6, 10_910.0),
    "R25-5T4-FSI": (22.32e-3, 370e6, 12_520.0),
    "R32-10T4-FSI": (26.91e-3, 480e6, 32_520.0),
    "R40-10T4-FSI": (34.91e-3, 510e6, 37_890.0),
}
_SINGLE_NUT = "FSI"
# Axial stiffness (N/m) of preloaded two-row bearings for the fixed end of a screw, contact angle
# 60°, by their designation: Schaeffler, in HIWIN GmbH, Ballscrews, table 8.38. Bearings ZKLN of the
# same bore have the same stiffness.
FIXED_BEARINGS: dict[str, float] = {
    "ZKLF1255": 375e6,
    "ZKLF1762": 450e6,
    "ZKLF2068": 650e6,
    "ZKLF3080": 850e6,
    "ZKLF3590": 900e6,
    "ZKLF40115": 1200e6,
    "ZKLF50115": 1250e6,
}


@dataclass(frozen=True)
class BallNut:
    """Nut with the catalogue stiffness `rigidity` (N/m) at the load `share` · `load_rating` (N)."""

    rigidity: float
    load_rating: float
    share: float

    def stiffness(self, load: float) -> float:
        """Axial stiffness (N/m) under `load` (N): the preload, or the load of a nut with play."""
        ratio = load / (self.share * self.load_rating)
        return float(_WITH_NUT * self.rigidity * ratio ** (1.0 / 3.0))


def nut_of_size(size: str) -> BallNut:
    """Catalogue data of the nut with the designation `size`, a key of `NUTS`."""
    _, rigidity, load_rating = NUTS[size]
    return BallNut(rigidity, load_rating, _HIWIN_WITH_PLAY if has_play(size) else PRELOADED)


def root_diameter(size: str) -> float:
    """Root diameter (m) of the shaft for the nut with the designation `size`, a key of `NUTS`."""
    return NUTS[size][0]


def has_play(size: str) -> bool:
    """True if the nut with the designation `size` has play, False if it is preloaded.

    `size` is a key of `NUTS`.
    """
    return size.endswith(_SINGLE_NUT)
