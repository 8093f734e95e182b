"""How tall a "small mug" is, and what hangs, from the catalogue of what can be made. Knows nothing of sentences."""

from __future__ import annotations

from ....gaussians.errors import UserError

_SMALL, _LARGE = ("small", "short"), ("large", "tall")


def usual_height(name: str, size: str) -> float | None:
    """Height in metres of a small or large thing of this kind: the end of the usual range; None if that says nothing.

    Width words ("wide") give None, as a new thing keeps its proportions, and so do kinds that are not in the catalogue.
    """
    from ....gaussians.assets import find

    if size not in (*_SMALL, *_LARGE):
        return None
    try:
        lowest, highest = find(name).sizes[2]
    except UserError:
        return None
    return lowest if size in _SMALL else highest


def hangs(name: str) -> bool:
    """Whether things of this kind in the catalogue hang from a ceiling."""
    from ....gaussians.assets import find

    try:
        return find(name).support == "ceiling"
    except UserError:
        return False
