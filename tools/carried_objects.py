"""What stands on a thing and goes where the thing goes: the vase on the table, the cushions on the sofa.

Knows the table of groups. Refuses to know operations, and to load furniture on a rug: what is flat is stood upon.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import torch
from torch import Tensor

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
