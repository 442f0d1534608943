"""Axial stiffness of the nut of a ball screw from the numbers of a manufacturer's table.

Catalogues give the calculated stiffness K of the balls for a stated fraction of the basic dynamic
load rating Ca. This is the preload of a preloaded nut (0.1 Ca, in some series 0.05 Ca), or the load
of a nut with play (0.3 Ca). By Hertz, the stiffness of balls varies with the cube root of the load,
and catalogues multiply it by 0.8 to account for the deformation of the nut itself. Under the load
F:

    k = 0.8 K (F / (share Ca))^(1/3)

(THK, General Catalog, Ball Screw, "Studying the Rigidity"; NSK, Precision Machine Components). K
and Ca are the values for the nut in its table.
"""

from dataclasses import dataclass

# Stiffness of balls and nut, as a fraction of the stiffness of the balls alone.
_WITH_NUT = 0.8
# Fractions of the load rating at which tables give the stiffness of preloaded nuts, and of nuts
# with play.
PRELOADED, WITH_PLAY = 0.1, 0.3


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
