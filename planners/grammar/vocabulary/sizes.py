"""How tall a "small mug" is, and what hangs, from the table of kinds."""

from __future__ import annotations

from ....gaussians.world import kinds

_SMALL, _LARGE = ("small", "short"), ("large", "tall")


def usual_height(name: str, size: str) -> float | None:
    """Height in metres of a small or large thing of this kind: the end of the usual range; None if that says nothing.

    Width words ("wide") give None, as a new thing keeps its proportions, and so do kinds that are not in the table.
    """
    kind = kinds.find(name)
    if size not in (*_SMALL, *_LARGE) or kind is None:
        return None
    lowest, highest = kind.size[2]
    return lowest if size in _SMALL else highest


def hangs(name: str) -> bool:
    """Whether things of this kind hang from a ceiling."""
    kind = kinds.find(name)
    return kind is not None and kind.support == "ceiling"
