"""Objects that stand on a target: they move with it, or a note says that they lost their support.

Examples are the vase on a table and the cushions on a sofa. Flat things such as rugs carry nothing: a rug is pulled
from under the furniture.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import torch
from torch import Tensor

from ..gaussians.language.field.language_field import Group, LanguageField
from ..gaussians.language.query.selection import Selection
from ..gaussians.scene import Scene
from ..gaussians.world.support import standing_on
from .field_update import rows_in
from .placement.bodies import Body, bodies_of, mask_of_bodies

MAX_NAMED = 4  # names in a note; further objects are counted


def carried_by(scene: Scene, groups: Iterable[int]) -> tuple[int, ...]:
    """Ids of all objects that stand on `groups`, directly or on one another; `groups` themselves are left out."""
    field = scene.language
    own = [g for g in groups if g >= 0]
    return () if field is None else _carried(scene, field, [field.groups[g] for g in own], own)


def _carried(scene: Scene, field: LanguageField, supports: Sequence[Group], but: Sequence[int]) -> tuple[int, ...]:
    """Ids of all objects that stand on some groups, directly or on one another; those in `but` are left out."""
    found, open_ = dict.fromkeys(but), list(supports)
    while open_:
        under = standing_on(field, scene.frame, open_.pop())
        fresh = [g for g in under if g.id not in found]
        found |= dict.fromkeys(g.id for g in fresh)
        open_ += fresh
    return tuple(g for g in found if g not in but)


def carried_on(scene: Scene, body: Body) -> tuple[int, ...]:
    """Ids of all objects that stand on a body, directly or on one another.

    Of a region or a part it is its own box that carries, and what it is a part of does not stand on it.
    """
    field = scene.language
    if field is None:
        return ()
    if body.group >= 0:
        return carried_by(scene, [body.group])
    leaves = {int(g) for g in torch.unique(scene.cloud.group[body.rows]) if g >= 0}
    own = sorted(leaves | {field.groups[g].parent for g in leaves} - {-1})
    region = Group(-1, "object", -1, body.label, 0.0, body.box, (0.0, 0.0, 0.0), len(body.rows), 0, 0.0)
    return _carried(scene, field, [region], own)


def with_carried(scene: Scene, bodies: Sequence[Body]) -> list[Body]:
    """The bodies with the Gaussians of the objects on them added; an object on two of them moves with the first."""
    full, claimed = list[Body](), {b.group for b in bodies}
    for body in bodies:
        carried = tuple(g for g in carried_on(scene, body) if g not in claimed)
        claimed |= set(carried)
        if not carried or scene.language is None:
            full.append(body)
            continue
        rows = torch.cat([body.rows, *(rows_in(scene.cloud, scene.language, g) for g in carried)])
        full.append(replace(body, rows=torch.unique(rows), carried=carried))
    return full


def rows_with_carried(scene: Scene, selection: Selection) -> Tensor:
    """`[N]` bool: the Gaussians of the selected things and those of the objects that stand on them."""
    return mask_of_bodies(scene, with_carried(scene, bodies_of(scene, selection)))


def carried_note(scene: Scene, bodies: Sequence[Body]) -> tuple[str, ...]:
    """A note that names the carried objects; empty if there are none."""
    if scene.language is None:
        return ()
    names = [scene.language.groups[g].label or "something" for b in bodies for g in b.carried]
    more = f" and {len(names) - MAX_NAMED} more" if len(names) > MAX_NAMED else ""
    return (f"what stood on it went along: {', '.join(names[:MAX_NAMED])}{more}",) if names else ()


def unsupported_note(before: Scene, after: Scene, groups: tuple[int, ...]) -> tuple[str, ...]:
    """A note that names the objects that stood on one of `groups` and no longer do; empty without a language field."""
    if before.language is None or after.language is None:
        return ()
    old, new = before.language, after.language
    if all(a.box == b.box and a.count == b.count for a, b in zip(old.groups, new.groups, strict=False)):
        return ()  # nothing moved or was removed
    targets = [old.groups[g] for g in groups if old.groups[g].level == "object"]
    stood = {g.id: (g, t) for t in targets for g in standing_on(old, before.frame, t) if g.id not in groups}
    hanging = [g for g, t in stood.values() if new.groups[g.id].count and not _still_stands(after, g, t)]
    if not hanging:
        return ()
    named = ", ".join(g.label or "something" for g in sorted(hanging, key=lambda g: g.id)[:MAX_NAMED])
    more = f" and {len(hanging) - MAX_NAMED} more" if len(hanging) > MAX_NAMED else ""
    return (f"left hanging in the air: {named}{more}; move or delete what stood there too",)


def _still_stands(after: Scene, thing: Group, support: Group) -> bool:
    """Whether `thing` stands on `support` after the edit."""
    field = after.language
    assert field is not None
    now = field.groups[support.id]
    return bool(now.count) and any(g.id == thing.id for g in standing_on(field, after.frame, now))
