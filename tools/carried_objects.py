"""Objects that stand on a target: they move with it, or a note says that they lost their support.

Examples are the vase on a table and the cushions on a sofa. Flat things such as rugs carry nothing: a rug is pulled
from under the furniture.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from torch import Tensor

from ..gaussians.kept import Kept
from ..gaussians.language.field.language_field import Group, LanguageField
from ..gaussians.language.query.color.fallback import is_reliable
from ..gaussians.language.query.selection import Selection
from ..gaussians.language.query.telling import told
from ..gaussians.rows import rows_where
from ..gaussians.scene import Scene
from ..gaussians.world.support import is_sheet, standing_on
from .contact import held_by, touching
from .field_update import rows_in
from .placement.bodies import Body, bodies_of, body_of, mask_of_bodies

_OVER = 0.35  # of its height, from its middle: what lies higher in a region's footprint is on it
_HIGHEST = 3.0  # times its height: what lies higher above it is something else
_SHARE = 0.3  # of its objects' Gaussians: a region as large as that may have the rest of them on it
_DROP = 1.15  # of the height of what a thing stood on: how far it comes down, with the error of measured boxes
_WIDEST = 1.2  # of the longer side of what carries it: a rider that is wider, where boxes are of a capture, is none
_MOST_OVER = 0.8  # of the footprint of what surely stands on a thing: over that thing
_PIECE = 30  # Gaussians of the same object on a region from which they are a thing on it
MAX_NAMED = 4  # names in a note; further objects are counted


@dataclass(frozen=True, eq=False)
class Stack:
    """Things that come down together: one, and what stands on it.

    Attributes:
        ids: `[M]` int64, their Gaussians.
        foot: `[K]` int64, those of the lowest thing, by which they stand.
        label: its name.
        most: how far it comes down at most, scene units: the height of what it stood on.
    """

    ids: Tensor
    foot: Tensor
    label: str
    most: float = float("inf")


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
    """Ids of all objects that stand on a body, directly or on one another, or are held by nothing but those.

    Of a region or a part it is its own box that carries, and what it is a part of does not stand on it.
    """
    field = scene.language
    if field is None:
        return ()
    if body.group >= 0 and (field.groups[body.group].level != "object" or is_sheet(field.groups[body.group].box.size)):
        return ()
    own = [body.group] if body.group >= 0 else _owners(field, scene.cloud.group[body.rows])
    found = carried_by(scene, own) if body.group >= 0 else _carried(scene, field, [_region(body)], own)
    if scene.frame.metres_per_unit is None:  # boxes of captures reach far: what does not touch it does not stand on it
        narrow = tuple(g for g in found if _level_side(field.groups[g]) <= _WIDEST * max(body.box.size[:2]))
        found = touching(scene, body, narrow, own)
    return (*found, *held_by(scene, body, (*own, *found)))


def is_told_apart(scene: Scene) -> bool:
    """Whether things, their names and what they stand on are known: in rooms of known scale, and where names are sure.
    Of a capture, groups are pieces of things, and their boxes reach far."""
    if scene.frame.metres_per_unit is not None or scene.language is None:
        return True
    return is_reliable(scene.language)


def _lies_on(thing: Group, support: Group) -> bool:
    """Whether nearly all of the footprint of a thing is over that of its support."""
    corners = support.box.local(thing.box.corners())[:, :2]
    half = np.array(support.box.size[:2]) / 2
    low, high = corners.min(axis=0), corners.max(axis=0)
    inner = np.clip(np.minimum(high, half) - np.maximum(low, -half), 0, None)
    return bool(float(np.prod(inner)) >= _MOST_OVER * float(np.prod(np.maximum(high - low, 1e-12))))


def _level_side(group: Group) -> float:
    return max(group.box.size[:2])


def _region(body: Body) -> Group:
    """A group outside the table for a body that has none."""
    return Group(-1, "object", -1, body.label, 0.0, body.box, (0.0, 0.0, 0.0), len(body.rows), 0, 0.0)


def _owners(field: LanguageField, leaves: Tensor) -> list[int]:
    """Ids of the groups that some Gaussians are in, with their objects; `leaves` `[M]` are their own groups."""
    found = {int(g) for g in torch.unique(leaves) if g >= 0}
    return sorted(found | {field.groups[g].parent for g in found} - {-1})


def stacks_on(scene: Scene, body: Body) -> list[Stack]:
    """What stands on a body, each thing with what stands on it in turn; the lowest first."""
    field, stacks, claimed = scene.language, list[Stack](), set[int]()
    if field is None:
        return stacks
    up, every_one = scene.frame.up_vector, carried_on(scene, body)
    most = _DROP * body.box.size[2]
    if len(above := _rest_above(scene, body)):  # what lies on a region carries the other things on it
        rows = torch.unique(torch.cat([above, *(rows_in(scene.cloud, field, g) for g in every_one)]))
        down = most if is_told_apart(scene) else 0.0
        return [Stack(scene.cloud.ids[rows], scene.cloud.ids[above], "the rest of it", down)]
    apart = is_told_apart(scene)
    for group in sorted(every_one, key=lambda g: (field.groups[g].box.bottom(up), g)):
        if group in claimed:
            continue
        on_it = carried_on(scene, body_of(scene, rows_in(scene.cloud, field, group), group))
        whole = [g for g in (group, *on_it) if g not in claimed and g in every_one]
        claimed |= set(whole)
        rows = [rows_in(scene.cloud, field, g) for g in whole]
        foot, every = scene.cloud.ids[rows[0]], scene.cloud.ids[torch.unique(torch.cat(rows))]
        down = most if apart or field.groups[group].named_by or field.groups[group].inserted else 0.0
        stacks.append(Stack(every, foot, told(field, field.groups[group]), down))
    return stacks


def with_carried(scene: Scene, bodies: Sequence[Body]) -> list[Body]:
    """The bodies with the Gaussians of the objects on them added; an object on two of them moves with the first.

    The last few are kept, as an operation and its checks ask for the same.
    """
    return list(_known.get((scene, *bodies), lambda: tuple(_with_carried(scene, bodies))))


_known: Kept[tuple[Body, ...]] = Kept(4)


def _with_carried(scene: Scene, bodies: Sequence[Body]) -> list[Body]:
    """See `with_carried`."""
    full, claimed = list[Body](), {b.group for b in bodies}
    for body in bodies:
        carried = tuple(g for g in carried_on(scene, body) if g not in claimed)
        claimed |= set(carried)
        above = _rest_above(scene, body)
        if (not carried and not len(above)) or scene.language is None:
            full.append(body)
            continue
        rows = torch.cat([body.rows, above, *(rows_in(scene.cloud, scene.language, g) for g in carried)])
        full.append(replace(body, rows=torch.unique(rows), carried=carried))
    return full


def _rest_above(scene: Scene, body: Body) -> Tensor:
    """Rows of what lies on a region and is of the same object: the stand on a cloth that was found by its colour."""
    field = scene.language
    none = body.rows[:0]
    if field is None:
        return none
    leaves = [g for g in _owners(field, scene.cloud.group[body.rows]) if field.groups[g].level != "structure"]
    if len(body.rows) < _SHARE * sum(field.groups[g].count for g in leaves if field.groups[g].parent < 0):
        return none  # a small patch of something large: what is above it is that
    mine = torch.zeros(len(field.groups) + 1, dtype=torch.bool, device=scene.cloud.device)
    mine[leaves] = True
    mine = mine[scene.cloud.group]
    mine[body.rows] = False
    rows = rows_where(mine)
    place = body.box.local(scene.cloud.means[rows].cpu().numpy()) / np.maximum(np.array(body.box.size), 1e-9)
    over = (place[:, 2] > _OVER) & (place[:, 2] < 0.5 + _HIGHEST) & (np.abs(place[:, :2]) <= 0.5).all(axis=1)
    return rows[torch.from_numpy(over).to(rows.device)] if over.sum() >= _PIECE else none


def rows_with_carried(scene: Scene, selection: Selection) -> Tensor:
    """`[N]` bool: the Gaussians of the selected things and those of the objects that stand on them."""
    return mask_of_bodies(scene, with_carried(scene, bodies_of(scene, selection)))


def carried_note(scene: Scene, bodies: Sequence[Body]) -> tuple[str, ...]:
    """A note that names the carried objects; empty if there are none."""
    if scene.language is None:
        return ()
    names = [told(scene.language, scene.language.groups[g]) for b in bodies for g in b.carried]
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
    if not is_told_apart(before):
        stood = {i: (g, t) for i, (g, t) in stood.items() if _lies_on(g, t)}
    left = [(g, t) for g, t in stood.values() if new.groups[g.id].count and new.groups[g.id].box == g.box]
    hanging = [g for g, t in left if not _still_stands(after, g, t)]
    if not hanging:
        return ()
    named = ", ".join(told(old, g) for g in sorted(hanging, key=lambda g: g.id)[:MAX_NAMED])
    more = f" and {len(hanging) - MAX_NAMED} more" if len(hanging) > MAX_NAMED else ""
    if not is_told_apart(before):
        return (f"what seems to have stood on it stays where it is: {named}{more}",)
    return (f"left hanging in the air: {named}{more}; move or delete what stood there too",)


def _still_stands(after: Scene, thing: Group, support: Group) -> bool:
    """Whether `thing` stands on `support` after the edit."""
    field = after.language
    assert field is not None
    now = field.groups[support.id]
    return bool(now.count) and any(g.id == thing.id for g in standing_on(field, after.frame, now))
