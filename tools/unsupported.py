"""What an edit leaves hanging in the air: things that stood on what was turned over, resized or taken away.

Knows the table of groups before and after. It tells and does not act: whoever asked for the table to go did not say
what should become of the vase on it. What goes along when the table is moved is in carried_objects.py.
"""

from __future__ import annotations

from ..gaussians.language.field.language_field import Group
from ..gaussians.scene import Scene
from ..gaussians.world.support import standing_on
from .carried_objects import TOLD


def left_hanging(before: Scene, after: Scene, groups: tuple[int, ...]) -> tuple[str, ...]:
    """A note naming the things that stood on one of `groups` and no longer do; none without a language field."""
    if before.language is None or after.language is None:
        return ()
    old, new = before.language, after.language
    if all(a.box == b.box and a.count == b.count for a, b in zip(old.groups, new.groups, strict=False)):
        return ()  # nothing moved or went
    targets = [old.groups[g] for g in groups if old.groups[g].level == "object"]
    stood = {g.id: (g, t) for t in targets for g in standing_on(old, before.frame, t) if g.id not in groups}
    hanging = [g for g, t in stood.values() if new.groups[g.id].count and not _still(after, g, t)]
    if not hanging:
        return ()
    named = ", ".join(g.label or "something" for g in sorted(hanging, key=lambda g: g.id)[:TOLD])
    more = f" and {len(hanging) - TOLD} more" if len(hanging) > TOLD else ""
    return (f"left hanging in the air: {named}{more}; move or delete what stood there too",)


def _still(after: Scene, thing: Group, support: Group) -> bool:
    """Whether `thing` stands on `support` after the edit."""
    field = after.language
    assert field is not None
    now = field.groups[support.id]
    return bool(now.count) and any(g.id == thing.id for g in standing_on(field, after.frame, now))
