"""What an edit leaves hanging in the air: things that stood on what was moved or taken away.

Knows the table of groups before and after. It tells and does not act: whoever asked for the table to go did not say
what should become of the vase on it.
"""

from __future__ import annotations

from ..gaussians.camera import Camera
from ..gaussians.language.field import Group
from ..gaussians.language.relations import HOLDS, Stand, score, viewer_stand
from ..gaussians.scene import Scene

TOLD = 4  # names in the note; more are counted


def left_hanging(before: Scene, after: Scene, groups: tuple[int, ...], viewer: Camera) -> tuple[str, ...]:
    """A note naming the things that stood on one of `groups` and no longer do; none without a language field."""
    if before.language is None or after.language is None:
        return ()
    old, new = before.language.groups, after.language.groups
    targets = [old[g] for g in groups if old[g].level == "object"]
    sizes = sorted(max(g.box.size) for g in before.language.objects() if g.count)
    if not targets or not sizes:
        return ()
    stand = viewer_stand(viewer, before.frame.up_vector, sizes[len(sizes) // 2])
    hanging = [
        g
        for g in before.language.objects()
        if g.id not in groups and new[g.id].count and any(_dropped(g, t, new, stand) for t in targets)
    ]
    if not hanging:
        return ()
    named = ", ".join(g.label or "something" for g in hanging[:TOLD])
    more = f" and {len(hanging) - TOLD} more" if len(hanging) > TOLD else ""
    return (f"left hanging in the air: {named}{more}; move or delete what stood there too",)


def _dropped(thing: Group, support: Group, new: tuple[Group, ...], stand: Stand) -> bool:
    """Whether `thing` stood on `support` and stands on it no longer."""
    if score("on", thing, [support], stand) < HOLDS:
        return False
    now = new[support.id]
    return not now.count or score("on", new[thing.id], [now], stand) < HOLDS
