"""Heights for size words ("a small mug") and whether a kind hangs from the ceiling, from the table of kinds."""

from __future__ import annotations

from ....gaussians.world import kinds

_SMALL, _LARGE = ("small", "short"), ("large", "tall")


def usual_height(name: str, size: str) -> float | None:
    """Height in metres of a small or large thing of a kind: the lower or upper end of the kind's range.

    None for width words ("wide"), because a new thing keeps its proportions, and for kinds that are not in the table.
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
