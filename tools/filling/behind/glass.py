"""Mirrors and windows of a scene: surfaces that show something else than themselves and cannot be continued."""

from __future__ import annotations

from ....gaussians.scene import Scene
from ....gaussians.world import kinds

_NAMED = 0.5  # probability of a name from which it counts
_GLASS = ("mirror", "window")


def glass_of(scene: Scene) -> frozenset[int]:
    """The groups of things that are mirrors or windows by their names, with their parts."""
    if scene.language is None:
        return frozenset()
    groups = scene.language.groups
    named = {g.id for g in groups if g.label and g.label_score >= _NAMED and _is_glass(g.label)}
    return frozenset(g.id for g in groups if g.id in named or g.parent in named)


def _is_glass(label: str) -> bool:
    kind = kinds.of(label)
    return kind is not None and kind.name in _GLASS
