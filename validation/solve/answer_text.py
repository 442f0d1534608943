"""Solutions as text for people."""

import numpy as np

from lumped.arrays import Array
from lumped.system.response import ToolResponse
from lumped.system.stability import Stability
from validation.models.options import ModelName
from validation.solve.answer import (
    Answer,
    LeftOpen,
    ModePair,
    PartUncertainty,
    Solution,
    deflection_texts,
    heading_of,
    without_round_off,
)

# Parts that are named of those that carry a mode: how many, and from which share on.
_MOST_PARTS, _TOLD = 3, 0.005
# Share of a stiffness from which on it is told that a load takes it.
_WORTH_TELLING = 5e-5


def as_text(solution: Solution) -> str:
    """The answers for people: deflections at 1000 N, the compliance, the frequencies."""
    heard = ", ".join(f"{name} {value}" for name, value in solution.options.items())
    lines = [f"{solution.robot}, {solution.model}" + (f" ({heard})" if heard else "")]
    lines += [solution.accuracy.text] if solution.accuracy else []
    for answer in solution.answers:
        lines += ["", *_answer_lines(answer, solution.model)]
    return "\n".join(lines)


def _static_lines(answer: Answer) -> list[str]:
    """Heading with the compliance, or with the motions without deformation of a free body."""
    if answer.rigid is not None:
        heading, _ = heading_of(answer.place, free=True)
        return [heading, f"  motions without deformation, left out: {answer.rigid}"]
    size = len(answer.compliance)
    deflections = zip("xyz", deflection_texts(answer), strict=False)
    return [
        ", ".join(heading_of(answer.place)),
        "  deflection (µm) along a force of 1000 N:",
        "    " + ", ".join(f"{axis} {text}" for axis, text in deflections),
        f"  compliance {size}×{size} (m/N, rad/N, rad/(N m)):",
        *("    " + " ".join(f"{value: .4e}" for value in row) for row in answer.compliance),
    ]


def _answer_lines(answer: Answer, model: ModelName) -> list[str]:
    lines = _static_lines(answer)
    if answer.loads:
        lines.append("  displacement (µm, µrad) under the loads of the robot file:")
        lines += [f"    {name}: {_moved_text(moved)}" for name, moved in answer.loads.items()]
        bending = "rigid legs" if model == "simplified" else "legs bending as beams"
        lines.append(f"  stability under them, {bending} between their ends:")
        lines += [f"    {name}: {_stability_text(one)}" for name, one in answer.stability.items()]
    if len(answer.frequencies):
        listed = ", ".join(f"{value:.5g}" for value in answer.frequencies)
        lines.append(f"  natural frequencies (Hz): {listed}")
        lines += _mode_lines(answer)
    if answer.damped:
        listed = ", ".join(f"{100.0 * loss:.3g}" for loss in answer.damped[1])
        lines.append(f"  loss factors of the modes (%): {listed}")
    if answer.responses:
        lines.append("  responses of the tool (µm/N) to the harmonic forces of the robot file:")
        lines += [f"    {_response_text(one)}" for one in answer.responses]
    if answer.idle:
        lines.append(f"  idle mobilities, which do not move the tool: {answer.idle}")
    if (mesh := answer.uncertainty) is not None:
        if mesh.known:
            lines.append(
                f"  uncertainty of the mesh (95 %, from the one of --divisions {mesh.divisions}):"
            )
            if mesh.meshes:
                lines.append(
                    "    numbers are extrapolated where the meshes of "
                    f"{', '.join(map(str, mesh.meshes))} divisions show an order of convergence"
                )
            lines += _share_lines(answer, mesh)
        else:
            lines.append(
                "  uncertainty of the mesh: not known; the mesh that would show it, --divisions "
                f"{mesh.divisions}, is too large"
            )
    if answer.of_parts is not None:
        lines += _part_lines(answer, answer.of_parts)
    if (digits := answer.of_digits) is not None:
        lines.append("  uncertainty from the last digits of the 6×6 in the robot file (at most):")
        lines += _share_lines(answer, digits)
    return lines


def _moved_text(moved: Array) -> str:
    """Displacement, its whole length and rotation."""
    if not np.isfinite(moved).all():
        return (
            "none: the mechanism cannot move that way here, or the load has no wrench for this pose"
        )
    names = ("x", "y", "z", "φx", "φy", "φz")
    micro = [without_round_off(1e6 * value) for value in moved]
    told = [f"{name} {value:.4g}" for name, value in zip(names, micro, strict=True)]
    told.insert(3, f"{1e6 * np.linalg.norm(moved[:3]):.4g} in all")
    return ", ".join(told)


def _response_text(one: ToolResponse) -> str:
    """The peak, and the size at the frequency that is asked for."""
    height, frequency, *at = one.judged
    if not height:
        return f"{one.excitation.name}: none, the tool is rigid there"
    peak = f"{1e6 * height:.4g}" if np.isfinite(height) else "without bound"
    there = f", {1e6 * at[0]:.4g} at {one.excitation.at:.5g} Hz" if at else ""
    return f"{one.excitation.name}: peak {peak} at {frequency:.5g} Hz{there}"


def _stability_text(found: Stability | None) -> str:
    """When it buckles, where most, and the stiffness of the tool that the load takes."""
    if found is None:
        return "none, the mechanism cannot move that way here"
    said = "does not buckle"
    if found.factor is not None:
        where = list(found.shares.items())[:_MOST_PARTS]
        told = ", ".join(f"{name} {100.0 * share:.0f} %" for name, share in where if share >= _TOLD)
        said = f"buckles at {found.factor:.4g} times the load ({told})"
    if not np.isfinite(found.stiffness_losses).all():
        return f"{said}; no stiffness is left"
    names = ("x", "y", "z", "φx", "φy", "φz")
    worth = [
        f"{name} {100.0 * share:.2g} %"
        for name, share in zip(names, found.stiffness_losses, strict=True)
        if abs(share) >= _WORTH_TELLING
    ]
    lost = f"takes {', '.join(worth)} of the stiffness" if worth else "takes no stiffness"
    more = ", ".join(f"{value:.5g}" for value in found.frequencies)
    return f"{said}; {lost}" + (f"; then {more} Hz" if more else "")


def _mode_lines(answer: Answer) -> list[str]:
    """What carries most of each mode's strain energy, and which mode of another model it is."""
    lines = []
    if answer.strain:
        names, shares = list(answer.strain), np.array(list(answer.strain.values()))
        lines.append("  most of their strain energy in:")
        for mode, column in enumerate(shares.T, start=1):
            # Shares that are equal but for rounding stand in the order of the file.
            largest = np.argsort(-column.round(6), kind="stable")[:_MOST_PARTS]
            told = [i for i in largest if column[i] >= _TOLD]
            said = ", ".join(f"{names[i]} {100.0 * column[i]:.0f} %" for i in told)
            lines.append(f"    {mode}: {said}")
    if answer.paired:
        lines.append(f"  the same modes by the {answer.paired.against} model:")
        lines += [
            f"    {pair.mode}: {_partner(pair)}, MAC {pair.mac:.4f}" for pair in answer.paired.pairs
        ]
    return lines


def _partner(pair: ModePair) -> str:
    """The partner of a mode, or why it has none."""
    if pair.undecided:
        return "several modes have the shape of one, which of them it is is open"
    if pair.local:
        whole = f"{100.0 * pair.seen:.2g} % of its kinetic energy"
        return f"none, a local mode ({whole} in whole cross-sections and bodies)"
    if not pair.partner:
        return "none of this shape"
    partner = f"mode {pair.partner}, {pair.frequency:.5g} Hz"
    if pair.open:
        low, high = pair.open
        return f"{partner} (shapes mix: {low:.5g} to {high:.5g} Hz)"
    return partner


def _part_lines(answer: Answer, found: PartUncertainty) -> list[str]:
    """What meshes, holding and reduction of CAD parts leave open."""
    if found.known:
        lines = ["  uncertainty of the parts' meshes (95 %, from three of each):"]
        lines += _share_lines(answer, found)
    else:
        lines = ["  uncertainty of the parts' meshes: not known: a given mesh cannot be refined"]
    if found.bracket.compliance.any():
        lines.append("  averaged minus rigid interfaces, where the robot file leaves it open:")
        lines += _share_lines(answer, found.bracket, "+.2g")
    if found.counted and len(answer.frequencies):
        counts = ", ".join(
            f"{name} {count} below {below:.4g} Hz" for name, (count, below) in found.counted.items()
        )
        most = 100.0 * float(np.max(found.reduction / answer.frequencies))
        lines.append(
            f"  modes of the parts with interfaces {found.by}, counted and all kept: {counts};"
        )
        lines.append(f"    those dropped lower no frequency by more than {most:.1g} %")
    return lines


def _share_lines(answer: Answer, left_open: LeftOpen, digits: str = ".2g") -> list[str]:
    """Shares of the diagonal of the compliance and of the frequencies, in percent."""
    shares = 100.0 * left_open.compliance / np.abs(np.diag(answer.compliance))
    lines = []
    if len(shares):
        named = zip(("x", "y", "z", "φx", "φy", "φz"), shares, strict=True)
        lines.append("    " + ", ".join(f"{name} {share:{digits}} %" for name, share in named))
    if len(answer.frequencies):
        shares = 100.0 * left_open.frequencies / answer.frequencies
        lines.append("    frequencies " + ", ".join(f"{share:{digits}} %" for share in shares))
    if shares_of_loads := left_open.shares_of_loads(answer.loads):
        told = (f"{name} {100.0 * share:.2g} %" for name, share in shares_of_loads.items())
        lines.append("    under loads " + ", ".join(told))
    return lines
