"""Solutions of `solve` as text.

Input: a `Solution`. Output: lines with deflections, compliance, frequencies and uncertainties.
"""

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.load import Excitation
from lumped.system.response import HarmonicResponse
from lumped.system.stability import Stability
from validation.models.loads.stability import bending_before_buckling
from validation.models.options import ModelName
from validation.solve.answer import (
    Answer,
    HalfWidths,
    ModePair,
    PartUncertainty,
    Solution,
    deflection_texts,
    without_round_off,
)

# Largest number of bodies listed for a mode, and smallest listed share of its energy.
_LISTED_PARTS, _SMALLEST_SHARE = 3, 0.005
# Smallest listed relative loss of stiffness under a load.
_SMALLEST_LOSS = 5e-5


def as_text(solution: Solution) -> str:
    """Solution as text: deflections under 1000 N, compliance, frequencies."""
    options = ", ".join(f"{name} {value}" for name, value in solution.options.items())
    lines = [f"{solution.robot}, {solution.model}" + (f" ({options})" if options else "")]
    lines += [solution.accuracy.text] if solution.accuracy else []
    for answer in solution.answers:
        lines += ["", *_answer_lines(answer, solution.model)]
    return "\n".join(lines)


def _static_lines(answer: Answer) -> list[str]:
    """Lines with heading, deflections and compliance.

    For a free body, heading and number of rigid-body motions.
    """
    if answer.rigid is not None:
        motions = f"  rigid-body motions (omitted): {answer.rigid}"
        return [answer.place.free_title, motions]
    size = len(answer.compliance)
    deflections = zip("xyz", deflection_texts(answer), strict=False)
    return [
        f"{answer.place.title}, {answer.place.axes}",
        "  deflection (µm) along a force of 1000 N:",
        "    " + ", ".join(f"{axis} {text}" for axis, text in deflections),
        f"  compliance {size}×{size} (m/N, rad/N, rad/(N m)):",
        *("    " + " ".join(f"{value: .4e}" for value in row) for row in answer.compliance),
    ]


def _answer_lines(answer: Answer, model: ModelName) -> list[str]:
    lines = _static_lines(answer)
    if answer.loads:
        lines.append("  displacement (µm, µrad) under the loads of the robot file:")
        lines += [
            f"    {name}: {_displacement_text(displacement)}"
            for name, displacement in answer.loads.items()
        ]
        lines += _pressure_lines(answer)
        bending = "rigid legs" if model == "simplified" else "legs bending as beams"
        lines.append(
            f"  stability under the loads of the robot file, {bending} between their ends:"
        )
        lines += [
            f"    {name}: {_stability_text(stability)}"
            if stability or name not in answer.pressures
            else f"    {name}: not computed, the pressures turn with the part that gives way first"
            for name, stability in answer.stability.items()
        ]
        if answer.bent:
            lines.append(f"    {bending_before_buckling(answer.bent)}")
    if len(answer.frequencies):
        listed = ", ".join(f"{value:.5g}" for value in answer.frequencies)
        lines.append(f"  natural frequencies (Hz): {listed}")
        lines += _mode_lines(answer)
    if answer.damped:
        listed = ", ".join(f"{100.0 * loss:.3g}" for loss in answer.damped[1])
        lines.append(f"  loss factors of the modes (%): {listed}")
    if answer.responses:
        lines.append("  responses (µm/N) to the harmonic forces of the robot file:")
        lines += [f"    {_response_text(response)}" for response in answer.responses]
    if answer.idle:
        lines.append(f"  idle mobilities (motions that do not move the tool): {answer.idle}")
    if (mesh := answer.uncertainty) is not None:
        if mesh.known:
            lines.append(
                "  uncertainty due to the mesh (95 %, from the mesh with --divisions "
                f"{mesh.divisions}):"
            )
            if mesh.meshes:
                lines.append(
                    "    values are extrapolated if the meshes with "
                    f"{', '.join(map(str, mesh.meshes))} divisions show an order of "
                    "convergence"
                )
            lines += _share_lines(answer, mesh)
        else:
            lines.append(
                "  uncertainty due to the mesh: unknown, because the second mesh, "
                f"--divisions {mesh.divisions}, is too large"
            )
    if answer.of_parts is not None:
        lines += _part_lines(answer, answer.of_parts)
    if (digits := answer.of_digits) is not None:
        lines.append(
            "  uncertainty due to rounding of the 6×6 compliance in the robot file (95 %):"
        )
        lines += _share_lines(answer, digits)
    return lines


def _pressure_lines(answer: Answer) -> list[str]:
    """Lines with the resultants of pressures on faces of CAD parts."""
    if not answer.pressures:
        return []
    return [
        "  resultants of pressures about the origin of the part, axes of the part:",
        *(
            f"    {load}: {pressure.text}"
            for load, pressures in answer.pressures.items()
            for pressure in pressures
        ),
    ]


def _displacement_text(displacement: Array) -> str:
    """Text with the components and the length of a displacement, and its rotations."""
    if not np.isfinite(displacement).all():
        return "none: the robot cannot accelerate as required, or the load has no wrench here"
    names = ("x", "y", "z", "φx", "φy", "φz")
    micro = [without_round_off(1e6 * value) for value in displacement]
    texts = [f"{name} {value:.4g}" for name, value in zip(names, micro, strict=True)]
    texts.insert(3, f"magnitude {1e6 * np.linalg.norm(displacement[:3]):.4g}")
    return ", ".join(texts)


def _excitation_text(excitation: Excitation) -> str:
    """Name of a response, with the points of force and displacement unless both are the tool."""
    if excitation.loaded is None and excitation.moved is None:
        return excitation.name
    force, motion = (
        "tool" if point is None else f"{point[1]} of {point[0]}"
        for point in (excitation.loaded, excitation.moved)
    )
    return f"{excitation.name} (force at {force}, displacement of {motion})"


def _response_text(response: HarmonicResponse) -> str:
    """Text with the peak of a receptance, and its magnitude at the requested frequency."""
    height, frequency, *size_at_frequency = response.judged
    name = _excitation_text(response.excitation)
    if not height:
        return f"{name}: none, the point is rigid there"
    peak = f"{1e6 * height:.4g}" if np.isfinite(height) else "without bound"
    suffix = (
        f", {1e6 * size_at_frequency[0]:.4g} at {response.excitation.at:.5g} Hz"
        if size_at_frequency
        else ""
    )
    return f"{name}: peak {peak} at {frequency:.5g} Hz{suffix}"


def _stability_text(stability: Stability | None) -> str:
    """Text with buckling factor, bodies with most of the buckling energy, and loss of stiffness."""
    if stability is None:
        return "not computed, because the load has no displacement at this pose"
    buckling = "does not buckle"
    if stability.factor is not None:
        largest = list(stability.shares.items())[:_LISTED_PARTS]
        shares = ", ".join(
            f"{name} {100.0 * share:.0f} %" for name, share in largest if share >= _SMALLEST_SHARE
        )
        buckling = f"buckles at {stability.factor:.4g} times the load ({shares})"
    if not np.isfinite(stability.stiffness_losses).all():
        return f"{buckling}; no stiffness left"
    names = ("x", "y", "z", "φx", "φy", "φz")
    losses = [
        f"{name} {100.0 * share:.2g} %"
        for name, share in zip(names, stability.stiffness_losses, strict=True)
        if abs(share) >= _SMALLEST_LOSS
    ]
    loss = f"loss of stiffness {', '.join(losses)}" if losses else "no loss of stiffness"
    frequencies = ", ".join(f"{value:.5g}" for value in stability.frequencies)
    return f"{buckling}; {loss}" + (
        f"; frequencies under load {frequencies} Hz" if frequencies else ""
    )


def _mode_lines(answer: Answer) -> list[str]:
    """Lines on each mode: bodies with most of its strain energy, and partner in another model."""
    lines = []
    if answer.strain:
        names, shares = list(answer.strain), np.array(list(answer.strain.values()))
        lines.append("  largest shares of their strain energy:")
        for mode, column in enumerate(shares.T, start=1):
            # Shares that are equal up to round-off are listed in the order of the file.
            largest = np.argsort(-column.round(6), kind="stable")[:_LISTED_PARTS]
            leading = [i for i in largest if column[i] >= _SMALLEST_SHARE]
            text = ", ".join(f"{names[i]} {100.0 * column[i]:.0f} %" for i in leading)
            lines.append(f"    {mode}: {text}")
    if answer.paired:
        lines.append(f"  the same modes by the {answer.paired.against} model:")
        lines += [
            f"    {pair.mode}: {_partner(pair)}, MAC {pair.mac:.4f}" for pair in answer.paired.pairs
        ]
    return lines


def _partner(pair: ModePair) -> str:
    """Text on the partner of a mode, or the reason why it has none."""
    if pair.undecided:
        return "ambiguous: several modes have this shape"
    if pair.local:
        share = f"{100.0 * pair.seen:.2g} % of its kinetic energy"
        return (
            f"none, a local mode of the section ({share} in rigid motion of "
            "cross-sections and bodies)"
        )
    if not pair.partner:
        return "no mode of this shape"
    partner = f"mode {pair.partner}, {pair.frequency:.5g} Hz"
    if pair.open:
        low, high = pair.open
        return f"{partner} (mixed shapes: {low:.5g} to {high:.5g} Hz)"
    return partner


def _part_lines(answer: Answer, parts: PartUncertainty) -> list[str]:
    """Lines on the uncertainty due to meshes, end conditions and reduction of CAD parts."""
    if parts.known:
        lines = [
            ("  uncertainty due to the meshes of the parts (95 %, from three meshes of each part):")
        ]
        lines += _share_lines(answer, parts)
    else:
        lines = [
            (
                "  uncertainty due to the meshes of the parts: unknown, because a mesh from a "
                "file cannot be refined"
            )
        ]
    if parts.bracket.compliance.any():
        lines.append(
            "  difference averaged minus rigid interfaces, if the robot file leaves the "
            "coupling open:"
        )
        lines += _share_lines(answer, parts.bracket, "+.2g")
    if parts.counted and len(answer.frequencies):
        counts = ", ".join(
            f"{name} {count} below {below:.4g} Hz" for name, (count, below) in parts.counted.items()
        )
        largest_change = 100.0 * float(np.max(parts.reduction / answer.frequencies))
        lines.append(
            f"  modes of the parts with interfaces {parts.by}, all kept and confirmed by "
            f"a mode count: {counts};"
        )
        lines.append(f"    omitted modes change no frequency by more than {largest_change:.1g} %")
    return lines


def _share_lines(answer: Answer, half_widths: HalfWidths, digits: str = ".2g") -> list[str]:
    """Lines with the relative half-widths (%) of compliances, frequencies and displacements.

    Compliances are the diagonal ones. Displacements are those under the loads of the robot file.
    `digits`: format of the numbers.
    """
    shares = 100.0 * half_widths.compliance / np.abs(np.diag(answer.compliance))
    lines = []
    if len(shares):
        named_shares = zip(("x", "y", "z", "φx", "φy", "φz"), shares, strict=True)
        lines.append(
            "    " + ", ".join(f"{name} {share:{digits}} %" for name, share in named_shares)
        )
    if len(answer.frequencies):
        shares = 100.0 * half_widths.frequencies / answer.frequencies
        texts = (f"{share:{digits}} %" if np.isfinite(share) else "unknown" for share in shares)
        lines.append("    frequencies " + ", ".join(texts))
    if shares_of_loads := half_widths.shares_of_loads(answer.loads):
        named = (f"{name} {100.0 * share:.2g} %" for name, share in shares_of_loads.items())
        lines.append("    under loads " + ", ".join(named))
    return lines
