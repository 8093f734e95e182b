"""How a fill was optimised against pictures, in words."""

from __future__ import annotations

from ..receipt import Lifted

PHOTOGRAPHS = "photographs"


def note(told: Lifted) -> str:
    """One sentence for a receipt."""
    if told.source != PHOTOGRAPHS:
        return _inpainted(told)
    if not told.views:
        return f"the fill was not compared with {told.source}: {told.reason}"
    seen = f"{told.views} of {told.looked} {told.source} that show the place see behind it"
    if told.reason:
        return f"{seen}; {told.reason} ({told.psnr_before:.1f} dB there), and stays as it was"
    there = f"there it went from {told.psnr_before:.1f} to {told.psnr_after:.1f} dB"
    held = f" in {told.held_out} that were kept apart" if told.held_out else ""
    return f"{seen}; the fill was optimised against them: {there}{held}, in {told.steps} steps and {told.seconds:.0f} s"


def restyle_note(told: Lifted) -> str:
    """The same of a thing whose views a model painted."""
    if told.reason:
        return f"{told.source} painted nothing, so the material stays as it was drawn: {told.reason}"
    return f"{told.source} painted {told.views} views of it, and its colours follow them, in {told.seconds:.0f} s"


def _inpainted(told: Lifted) -> str:
    if told.reason:
        return f"{told.source} filled nothing, so the fill from the scene itself stays: {told.reason}"
    return (
        f"{told.source} inpainted {told.views} views of the hole: {told.made:,} Gaussians were made from them in place "
        f"of {told.replaced:,}, and optimised against these views to {told.psnr_after:.1f} dB, in {told.seconds:.0f} s"
    )
