"""How a fill was optimised against pictures, in words."""

from __future__ import annotations

from ..receipt import Lifted


def note(told: Lifted) -> str:
    """One sentence for a receipt."""
    if not told.views:
        return f"the fill was not compared with {told.source}: {told.reason}"
    seen = f"{told.views} of {told.looked} {told.source} that show the place see behind it"
    if told.reason:
        return f"{seen}; {told.reason} ({told.psnr_before:.1f} dB there), and stays as it was"
    there = f"there it went from {told.psnr_before:.1f} to {told.psnr_after:.1f} dB"
    held = f" in {told.held_out} that were kept apart" if told.held_out else ""
    return f"{seen}; the fill was optimised against them: {there}{held}, in {told.seconds:.0f} s"
