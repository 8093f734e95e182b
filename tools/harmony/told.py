"""What was done to fit things to a scene, in words."""

from __future__ import annotations

from .shadows import Told


def notes(told: Told) -> tuple[str, ...]:
    """What is to be said of the contact shadows of things that were put somewhere."""
    strength = told.strength
    if strength.value <= 0:
        if strength.measured:
            return (f"no contact shadow: {strength.measured} things of this scene cast none either",)
        return ("no contact shadow: nothing in this scene is shaded",)
    if not told.things:
        return ("no contact shadow: no surface is seen that carries it",)
    if not told.darker:
        return ()
    many = f"those of {strength.measured} things here"
    like = f"as dark as {many}" if strength.measured else "a faint one, as none of this scene could be measured"
    lines = [f"its contact shadow makes {told.darker:,} Gaussians around it darker ({like})"]
    if told.missing:
        lines.append(f"{told.missing} of them cast no shadow: no surface is seen that carries them")
    return tuple(lines)
