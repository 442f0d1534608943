"""Checks of a valid robot file by `flexproof check`: implausible data, warping, faces of CAD parts.

Input: a mechanism. Output: `Finding` records with the value, the suspicion and its evidence, and
lines of text. Rules: a finding is made if a number lies far outside the range of real machines. All
models let sections warp freely; if both end faces of a leg with given section constants prevent
warping, its torsional stiffness follows from the warping constant
(`fem.sections.nonuniform_torsion`). Each interface of a CAD part is listed with its faces and their
distance from the point of the joint, each pressure with its faces and its resultant.
"""

from collections.abc import Iterator

import numpy as np

from lumped.arrays import Array
from lumped.audit import Finding
from lumped.errors import InputError, collect_faults
from lumped.legs import ConstantLeg
from lumped.mechanism.body import Body, Part
from lumped.mechanism.joint import Joint
from lumped.mechanism.mechanism import GROUND, Mechanism
from lumped.sections import SectionProperties
from meshes.part.interfaces import Interface
from meshes.part.reading.read import PartFile
from validation.models.loads.pressures import surface_resultants
from validation.models.reduced_parts import found_in

# Length (m), mass (kg) and mass per length (kg/m) above which a leg is implausible. A solid steel
# bar of 1.1 m × 1.1 m has 1e4 kg/m, the box boom of a large crane 3e3. If millimetres are read as
# metres, a bar of 2.5 mm² of steel has 2e4 kg/m.
_LONG, _HEAVY, _HEAVY_PER_LENGTH = 5.0, 1e4, 1e4
# Span (m) above which, and mass per length (kg/m) below which, a body of given mass is implausible.
# A carbon tube of that length has 0.3 kg/m.
_WIDE, _LIGHT_PER_LENGTH = 10.0, 0.02
# Gravity (m/s²) above which a wrong unit is likely: five times the earth's.
_LARGEST_GRAVITY = 50.0
# Smallest cosine of the angle between a bore and the axis of its joint: that of 30°.
_ALONG = float(np.cos(np.pi / 6.0))
# Largest gap between the bodies of a slide that is round-off, relative to the distance of its
# points.
_TOUCHING = 1e-6
# Relative increase from which a stiffness is stated as a multiple.
_LARGEST_IN_PERCENT = 10.0


def robot_findings(mechanism: Mechanism) -> tuple[Finding, ...]:
    """All findings about a mechanism. Raises InputError for CAD parts that cannot be read."""
    checks = (_size_and_mass, _gravity, _bores, _slides)
    return tuple(finding for check in checks for finding in check(mechanism))


def _size_and_mass(mechanism: Mechanism) -> Iterator[Finding]:
    """Findings of millimetres read as metres: legs far too heavy, or masses far too small."""
    for body in mechanism.bodies.values():
        if body.name == GROUND:
            continue
        span, mass = _span(body), _mass(body)
        heavy = isinstance(body.shape, ConstantLeg) and mass > max(_HEAVY, _HEAVY_PER_LENGTH * span)
        light = 0.0 < mass < _LIGHT_PER_LENGTH * span
        if (heavy and span > _LONG) or (light and span > _WIDE):
            yield Finding(
                f"bodies.{body.name}",
                "size and mass",
                printed=f"{mechanism.lengths.shown(span, 4)} from end to end, {mass:.3g} kg",
                wrong=(
                    "size and mass do not fit together; are lengths given in mm? Lengths "
                    'must be in m, or add units = "mm" at the top of the file'
                ),
                evidence=f"{mass / span:.3g} kg/m; legs of robots have 0.1 to 3000 kg/m",
                severity="warning",
                numbers={"span": span, "mass": mass},
            )


def _span(body: Body) -> float:
    """Largest distance (m) between two interfaces of a body."""
    positions = np.array([frame.position for frame in body.interfaces.values()])
    if not len(positions):
        return 0.0
    return float(np.linalg.norm(positions[:, None] - positions, axis=2).max())


def _mass(body: Body) -> float:
    """Mass (kg) of a body.

    Zero for a CAD part, whose unit of length is checked when its file is read.
    """
    return 0.0 if isinstance(body.shape, Part) else body.shape.mass


def _gravity(mechanism: Mechanism) -> Iterator[Finding]:
    for load in mechanism.loads:
        size = float(np.linalg.norm(load.gravity))
        if size > _LARGEST_GRAVITY:
            yield Finding(
                f"loads.{load.name}.gravity",
                "gravity",
                printed=f"{[float(f'{part:.6g}') for part in load.gravity]} m/s²",
                wrong="gravity on earth is 9.81 m/s²; is it given in mm/s²? It must be in m/s²",
                evidence=f"magnitude {size:.5g} m/s², {size / 9.81:.3g} times that of the earth",
                severity="warning",
                numbers={"gravity": size},
            )


def _bores(mechanism: Mechanism) -> Iterator[Finding]:
    """Findings of bores or bosses that do not lie along the axis of their revolute joint."""
    interfaces = {
        (body.name, interface.name): interface
        for body in mechanism.parts.values()
        for interface in found_in(body)[1]
        if interface.axis is not None
    }
    for joint in mechanism.joints:
        if joint.kind not in ("revolute", "cylindrical"):
            continue
        for side in (joint.first, joint.second):
            bore = interfaces.get((side.body, side.point))
            if bore is None or bore.axis is None:
                continue
            axis = mechanism.reference[side.body].rotation @ bore.axis
            cosine = min(abs(float(axis @ joint.axes[0])), 1.0)
            if cosine < _ALONG:
                angle = float(np.degrees(np.arccos(cosine)))
                yield Finding(
                    f"bodies.{side.body}.interfaces.{side.point}",
                    "axis of a bore",
                    printed=f"bore or boss along {_direction(axis)}",
                    wrong=(
                        f"the bore or boss is not parallel to the axis of {joint.name}; check "
                        f"the orientation of the part, bodies.{side.body}.place"
                    ),
                    evidence=f"{joint.name} turns about {_direction(joint.axes[0])}, "
                    f"{angle:.3g}° apart",
                    severity="warning",
                    numbers={"angle": angle},
                )


def _direction(axis: Array) -> str:
    return ", ".join(f"{part + 0.0:.3g}" for part in axis.round(6))


def _slides(mechanism: Mechanism) -> Iterator[Finding]:
    """Findings of slides whose bodies neither overlap nor touch along the axis."""
    for joint in mechanism.joints:
        if joint.kind not in ("prismatic", "cylindrical"):
            continue
        sides = [joint.first, joint.second]
        if GROUND in {side.body for side in sides}:
            continue
        spans = [_span_along(mechanism, joint, side.body) for side in sides]
        (_, low_end), (high_start, _) = sorted(spans)
        gap, distance = high_start - low_end, _distance(mechanism, joint)
        if gap > _TOUCHING * distance:
            yield Finding(
                f"joints.{joint.name}.at",
                "gap of a slide",
                printed=f"{sides[0].point} of {sides[0].body}, {sides[1].point} of {sides[1].body}",
                wrong=(
                    "the sliding bodies do not overlap: the points of the joint lie outside "
                    "the other body"
                ),
                evidence=f"gap of {gap:.4g} m along the axis between them",
                severity="warning",
                numbers={"gap": gap},
            )


def _span_along(mechanism: Mechanism, joint: Joint, name: str) -> tuple[float, float]:
    """Smallest and largest coordinate (m) of a body's interfaces along the axis of a joint."""
    frame = mechanism.reference[name]
    coordinates = [
        float(joint.axes[0] @ (frame @ interface).position)
        for interface in mechanism.bodies[name].interfaces.values()
    ]
    return min(coordinates), max(coordinates)


def _distance(mechanism: Mechanism, joint: Joint) -> float:
    first, second = (
        (mechanism.reference[side.body] @ mechanism.bodies[side.body].interfaces[side.point])
        for side in (joint.first, joint.second)
    )
    return float(np.linalg.norm(second.position - first.position))


def warping_text(mechanism: Mechanism) -> str:
    """Lines on each leg by its constants whose ends can prevent warping. "" if there are none."""
    return "\n".join(_warping_lines(mechanism))


def _warping_lines(mechanism: Mechanism) -> Iterator[str]:
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


def parts_text(mechanism: Mechanism) -> str:
    """Lines on each CAD part: its size, and the faces of each interface with their distance.

    Pressures follow with their resultants. "" if no body is a CAD part. Raises InputError
    with the faults of all parts.
    """
    texts, faults = collect_faults(_part_text, mechanism.parts.values())
    if faults:
        raise InputError(faults)
    return "\n".join([*texts, *_pressure_texts(mechanism)])


def _pressure_texts(mechanism: Mechanism) -> list[str]:
    """Lines on each pressure of the loads: its faces and its resultant."""
    rows = surface_resultants(mechanism)
    heading = "pressures, with resultants about the origin of the part, axes of the part:"
    lines = [f"  {row.load}: {resultant.text}" for row, resultant in rows]
    return [heading, *lines] if lines else []


def _part_text(body: Body) -> str:
    file, interfaces = found_in(body)
    lines = [f"{body.name}: {file.path.name}, {file.size}"]
    return "\n".join(lines + [f"  {_interface_text(file, interface)}" for interface in interfaces])


def _interface_text(file: PartFile, interface: Interface) -> str:
    faces = [file.face(number) for number in interface.faces]
    kinds = " and ".join(dict.fromkeys(face.kind for face in faces))
    numbers = ", ".join(str(face.number) for face in faces)
    text = f"{interface.name}: face{'s' if len(faces) > 1 else ''} {numbers} ({kinds}"
    text += f" of radius {faces[0].radius * 1e3:.4g} mm)" if interface.axis is not None else ")"
    condition = interface.coupling + (" by default" if interface.by_default else "")
    return f"{text}, {_offset_text(file, interface)}, {condition}"


def _offset_text(file: PartFile, interface: Interface) -> str:
    """Text with the distance of the faces of an interface from the point of the joint.

    If the faces have an axis, the distance is perpendicular to the axis.
    """
    if interface.axis is not None and interface.on_axis is not None:
        offset = interface.point - interface.on_axis
        radial_offset = offset - interface.axis * (interface.axis @ offset)
        return f"axis {_millimetres(radial_offset)} from the point"
    areas = np.array([file.face(number).area for number in interface.faces])
    centres = np.array([file.face(number).centre for number in interface.faces])
    offset = areas @ centres / areas.sum() - interface.point
    return f"centre {_millimetres(offset)} from the point"


def _millimetres(arm: Array) -> str:
    distance = 1e3 * float(np.linalg.norm(arm))
    # Round-off due to the digits of a file counts as zero.
    return f"{distance if distance > 1e-6 else 0.0:.3g} mm"
