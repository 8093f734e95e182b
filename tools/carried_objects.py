"""What stands on a thing and goes where the thing goes: the vase on the table, the cushions on the sofa.

Knows the table of groups. Refuses to know operations, and to load furniture on a rug: what is flat is stood upon.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from ..gaussians.language.field.language_field import Group, LanguageField
from ..gaussians.language.query.selection import Selection, mask_of
from ..gaussians.scene import Frame, Scene
from ..gaussians.world.relations import HOLDS, Stand, score
from .field_update import rows_in
from .placement.bodies import Body

_FLAT = 20.0  # a thing longer than so many times its height is a rug, which slides away from under a chair
TOLD = 4  # names in a note; more are counted


def standing_on(field: LanguageField, frame: Frame, support: Group) -> tuple[Group, ...]:
    """Objects that stand directly on an object, or in it as on a shelf; none on a rug."""
    if support.level != "object" or max(support.box.size[:2]) > _FLAT * support.box.size[2]:
        return ()
    east, north, up = frame.basis()
    stand = Stand(east, north, up, np.zeros(3), field.typical_size)
    others = (g for g in field.objects() if g.count and g.id != support.id)
    return tuple(g for g in others if score("on", g, [support], stand) >= HOLDS)


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
