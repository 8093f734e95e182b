"""Cast the contact shadows of things on what carries them: one fast pass for one thing, or for all things of a room."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.language.field.group_index import index_groups
from ...gaussians.scene import Scene
from ..cloud_diff import fresh_ids, joined
from ..field_update import after_recolor, recount
from ..filling.occlusion import depth_of
from ..filling.shadow import multiplied
from .carrier import carried
from .finer import finer
from .strength import FAINT, Strength, fitted, strength_of

F64 = NDArray[np.float64]
_LEAST = 0.01  # logarithm of a colour's change below which a Gaussian stays as it is
_RECOLORED = 0.05  # of a group's Gaussians: fewer that are darker do not change its colour
_TOLD = 0.05  # strength from which a shadow is there
_PART = 0.5  # of a shadow: how much darker or lighter it becomes


@dataclass(frozen=True)
class Told:
    """What was cast: how many Gaussians are darker, under how many things, how many hang or stand on nothing seen,
    how dark the shadows are, and how many Gaussians were made by splitting, how many those replaced, and
    how many others are darker."""

    darker: int
    things: int
    missing: int
    strength: Strength
    made: int = 0
    replaced: int = 0
    changed: int = 0


def shadows_under(
    scene: Scene,
    things: Sequence[Tensor],
    strength: Strength | None = None,
    apart: bool = True,
    lit: Scene | None = None,
    split: bool = False,
    layers: bool = False,
) -> tuple[Scene, Told]:
    """The scene with the contact shadows of things where they stand or hang; only colours of other Gaussians change.

    Args:
        things: rows of each.
        apart: whether none of them darkens another's Gaussians.
        lit: the scene whose light is taken, as it was before an edit; None: this one.
        strength: how dark; None: as those that the scene has.
        split: whether Gaussians that are too coarse to show the shadows are split; their children are the last rows.
        layers: whether they fall on all that is seen of fitted ground, above and below its middle.
    """
    strength = strength_of(scene) if strength is None else strength
    if strength.value <= 0 or not things:
        return scene, Told(0, 0, 0, strength)
    own = torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)
    for rows in things:
        own[rows] = True
    others = own if apart else None
    places = [p for rows in things if (p := carried(scene, rows, others, layers=layers, lit=lit)) is not None]
    missing = len(things) - len(places)
    parted = finer(scene.cloud, places, strength.value) if split else None
    dark = torch.zeros(len(scene.cloud), dtype=torch.float64)
    for place in places:
        dark[place.rows.cpu()] += strength.value * torch.from_numpy(depth_of(place.share(scene.cloud)))
    before, made, removed = scene, 0, 0
    if parted is not None:
        under = torch.zeros(len(parted.children), dtype=torch.float64)
        for place in places:
            on = torch.isin(parted.parents, place.rows.cpu()).nonzero().squeeze(1)
            under[on] += strength.value * torch.from_numpy(depth_of(place.share_of(parted.children[on])))
        stays = torch.ones(len(scene.cloud), dtype=torch.bool)
        stays[parted.split] = False
        made, removed = len(parted.children), len(parted.split)
        children = parted.children.replace(ids=fresh_ids(scene.cloud, made))
        cloud = joined(scene.cloud, ~stays, [children])
        scene = scene.replace(cloud=cloud, language=recount(scene.language, cloud))
        dark = torch.cat([dark[stays], under])
    rows = (dark > _LEAST).nonzero().squeeze(1).to(scene.cloud.device)
    told = Told(len(rows), len(places), missing, strength, made, removed, int((rows < len(scene.cloud) - made).sum()))
    if not len(rows):
        return before, Told(0, len(places), missing, strength)
    sh = scene.cloud.sh.clone()
    sh[rows] = multiplied(sh[rows], torch.exp(-dark[rows.cpu()]).to(sh))
    scene = scene.replace(cloud=scene.cloud.replace(sh=sh))
    return scene.replace(language=after_recolor(scene, _told_by_color(scene, rows))), told


def _told_by_color(scene: Scene, rows: Tensor) -> Tensor:
    """Ids of those of some rows whose groups changed enough for their colour to be another."""
    groups = scene.cloud.group + 1
    changed = torch.bincount(groups[rows], minlength=int(groups.max()) + 1)
    many = changed >= _RECOLORED * torch.bincount(groups, minlength=len(changed))
    return scene.cloud.ids[rows[many[groups[rows]]]]


@dataclass(frozen=True, eq=False)
class Changed:
    """What was done to shadows: the rows that are of another colour now, and how many things something carries."""

    rows: Tensor
    carried: int


def changed_shadow(
    scene: Scene, things: Sequence[Tensor], change: Literal["remove", "cast", "darker", "lighter"]
) -> tuple[GaussianCloud, Changed]:
    """The cloud with the contact shadows of things taken away, cast, or made darker or lighter.

    How dark a thing's shadow is now is measured on the surface that carries it; where it has the shadow that is asked
    for, nothing changes.

    Args:
        things: rows of each.
    """
    own = torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)
    for rows in things:
        own[rows] = True
    usual = strength_of(scene).value or FAINT
    dark, found = torch.zeros(len(scene.cloud), dtype=torch.float64), 0
    for rows in things:
        place = carried(scene, rows, own, layers=True)
        if place is None:
            continue
        found += 1
        now = fitted(scene.cloud, place)
        step = _step(change, now, usual)
        dark[place.rows.cpu()] += torch.from_numpy(step * depth_of(place.share(scene.cloud)))
    rows = (dark.abs() > _LEAST).nonzero().squeeze(1).to(scene.cloud.device)
    if not len(rows):
        return scene.cloud, Changed(rows, found)
    sh = scene.cloud.sh.clone()
    sh[rows] = multiplied(sh[rows], torch.exp(-dark[rows.cpu()]).to(sh))
    return scene.cloud.replace(sh=sh), Changed(rows, found)


def _step(change: str, now: float | None, usual: float) -> float:
    """By what the strength of a shadow changes."""
    there = max(0.0, now if now is not None else 0.0)
    if change == "remove":
        return -there if there > _TOLD else 0.0
    if change == "lighter":
        return -_PART * there if there > _TOLD else 0.0
    if change == "darker":
        return _PART * max(there, usual)
    return max(0.0, usual - there) if there < _PART * usual else 0.0


def shadows_under_everything(
    scene: Scene, strength: Strength | None = None, but: Collection[str] = ()
) -> tuple[Scene, Told]:
    """The scene with a contact shadow under each of its things, in one pass; only colours change.

    For scenes whose things were put together from parts that cast none on each other. What a capture shows has its
    shadows already.

    Args:
        strength: how dark; None: the usual one.
        but: labels of things that cast none: what is let into a wall.
    """
    field = scene.language
    index = index_groups(scene.cloud)
    objects = () if field is None else [g for g in field.objects() if g.count and g.label not in but]
    things = [torch.from_numpy(index.rows(field.leaves(g.id))) for g in objects] if field is not None else []
    return shadows_under(scene, things, strength or Strength(FAINT, 0), apart=False)
