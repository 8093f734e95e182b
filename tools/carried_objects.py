"""What stands on a thing: it goes where the thing goes, or is told to hang in the air when the thing goes alone.

The vase on the table, the cushions on the sofa. What is flat, such as a rug, carries nothing: it slides away from under
the furniture.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import torch
from torch import Tensor

from ..gaussians.language.field.language_field import Group
from ..gaussians.language.query.selection import Selection, mask_of
from ..gaussians.scene import Scene
from ..gaussians.world.support import standing_on
from .field_update import rows_in
from .placement.bodies import Body

TOLD = 4  # names in a note; more are counted


def riders_of(scene: Scene, groups: Iterable[int]) -> tuple[int, ...]:
    """Ids of the objects that go along when `groups` move, what stands on them in turn included; without `groups`."""
    field = scene.language
    if field is None:
        return ()
    own = [g for g in groups if g >= 0]
    found, open_ = dict.fromkeys(own), list(own)
    while open_:
        under = standing_on(field, scene.frame, field.groups[open_.pop()])
        fresh = [g.id for g in under if g.id not in found]
        found |= dict.fromkeys(fresh)
        open_ += fresh
    return tuple(g for g in found if g not in own)


def loaded(scene: Scene, bodies: Sequence[Body]) -> list[Body]:
    """The bodies with the Gaussians of what stands on them; a thing on two of them goes with the first."""
    full, claimed = list[Body](), {b.group for b in bodies}
    for body in bodies:
        riders = tuple(g for g in riders_of(scene, [body.group]) if g not in claimed)
        claimed |= set(riders)
        if not riders or scene.language is None:
            full.append(body)
            continue
        rows = torch.cat([body.rows, *(rows_in(scene.cloud, scene.language, g) for g in riders)])
        full.append(replace(body, rows=rows.sort().values, riders=riders))
    return full


def rows_along(scene: Scene, selection: Selection) -> Tensor:
    """`[N]` bool: the selection's Gaussians and those of what stands on its objects."""
    mask = mask_of(scene.cloud, selection.ids)
    field = scene.language
    if field is not None:
        for group in riders_of(scene, selection.groups):
            mask[rows_in(scene.cloud, field, group)] = True
    return mask


def went_along(scene: Scene, bodies: Sequence[Body]) -> tuple[str, ...]:
    """A note naming what went along; none if nothing did."""
    if scene.language is None:
        return ()
    names = [scene.language.groups[g].label or "something" for b in bodies for g in b.riders]
    more = f" and {len(names) - TOLD} more" if len(names) > TOLD else ""
    return (f"what stood on it went along: {', '.join(names[:TOLD])}{more}",) if names else ()


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
