"""Text of `flexproof check` on warping of legs whose section is given by its constants.

Input: a mechanism. Output: lines of text. Rule: all models let sections warp freely. If both end
faces of a leg prevent warping, its torsional stiffness follows from the warping constant
(`fem.sections.nonuniform_torsion`).
"""

from collections.abc import Iterator

from lumped.legs import ConstantLeg
from lumped.mechanism.mechanism import Mechanism
from lumped.sections import SectionProperties

# Relative increase from which a stiffness is stated as a multiple.
_LARGEST_IN_PERCENT = 10.0


def warping_text(mechanism: Mechanism) -> str:
    """Lines on each leg by its constants whose ends can prevent warping. "" if there are none."""
    return "\n".join(_lines(mechanism))


def _lines(mechanism: Mechanism) -> Iterator[str]:
    for name, body in mechanism.bodies.items():
        leg = body.shape
        if not isinstance(leg, ConstantLeg) or not isinstance(leg.section, SectionProperties):
            continue
        if leg.section.Iw is None:
            if leg.ends == "rigid":
                yield (
                    f"{name}: has no warping constant Iw; by how much its rigid ends stiffen it in "
                    "torsion is not known, and all models let it warp"
                )
        elif leg.ends != "free":
            yield (
                f"{name}: would be {_stiffer(held_stiffening(leg, leg.section))} in torsion if "
                "both ends prevented warping (Iw); all models let it warp"
            )


def _stiffer(increase: float) -> str:
    """Relative increase of a stiffness as text: "164 % stiffer", "54.1 times as stiff"."""
    if increase < _LARGEST_IN_PERCENT:
        return f"{100.0 * increase:.3g} % stiffer"
    return f"{1.0 + increase:.3g} times as stiff"


def held_stiffening(leg: ConstantLeg, section: SectionProperties) -> float:
    """Relative increase of the torsional stiffness of `leg` if both ends prevent warping."""
    # Imported here, because it takes a second that `check` of other robots need not wait.
    from fem.sections.nonuniform_torsion import (  # noqa: PLC0415
        WarpingRod,
        held_torsion_compliance,
    )

    E, G = leg.material.E, leg.material.G
    polar = section.Iy + section.Iz + section.A * (section.ys**2 + section.zs**2)
    rod = WarpingRod(
        twist=G * polar,
        shear=G * (polar - section.J),
        bimoment=E * (section.Iw or 0.0),
        rotary=leg.material.rho * polar,
        warping=leg.material.rho * (section.Iw or 0.0),
    )
    return leg.length / (G * section.J) / held_torsion_compliance(rod, leg.length) - 1.0
