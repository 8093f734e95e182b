"""Edits that went wrong behind the judge's back, in furnished rooms whose truth is known.

A sabotage changes the scene after an edit, or what the edit was applied to; the words and the receipt claim success.
`HIDDEN` sabotages damage the language field before the edit, so that whoever asks the field again gets the same wrong
answer: only what is seen and measured tells.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import torch
from torch import Tensor

from ..gaussians.cloud import NO_GROUP
from ..gaussians.color import shade_of
from ..gaussians.language.field.measure import sample
from ..gaussians.language.query.selection import Selection, mask_of
from ..gaussians.scene import Scene
from ..tools.cloud_diff import Draft
from ..tools.coloring.repaint import fit
from ..tools.execute import carry_out
from ..tools.operation import Context, EditOp

NEIGHBOURHOOD = 0.3  # metres around the target into which a colour bleeds


@dataclass(frozen=True, eq=False)
class Attempt:
    """A clean edit that a sabotage starts from.

    Attributes:
        scene: before.
        op, context: of the edit.
        selection: what its words mean; empty for an insertion.
        after: the scene after the clean edit.
        truth: `[N]` int32, the true object of each Gaussian, -1 for the shell of the room.
        thing: the true object that is meant, -1 for an insertion.
        rng: of the sabotage's own choices.
    """

    scene: Scene
    op: EditOp
    context: Context
    selection: Selection
    after: Scene
    truth: Tensor
    thing: int
    rng: np.random.Generator

    def again(self, ids: Tensor) -> Scene:
        """The scene after the same operation on other Gaussians."""
        groups = self.selection.groups
        other = Selection(self.selection.query, "found", ids.sort().values, groups, (), "sabotaged")
        return carry_out(self.scene, self.op, self.context, other).scene


Damage = Callable[[Attempt], tuple[Scene, Scene] | None]  # the scenes before and after, None where it does not apply
_TARGETED = frozenset({"delete", "recolor", "move", "scale", "rotate", "replace", "duplicate", "opacity"})


def wrong_target(attempt: Attempt) -> tuple[Scene, Scene] | None:
    """The operation is applied to another object; of an insertion, another kind of thing is inserted."""
    if attempt.op.op == "insert":
        others = [a for a in ("armchair", "potted plant", "floor lamp", "suitcase", "guitar", "stool", "vase")]
        asset = str(attempt.rng.choice([a for a in others if a != attempt.op.asset]))  # type: ignore[attr-defined]
        op = attempt.op.model_copy(update={"asset": asset})
        return attempt.scene, carry_out(attempt.scene, op, attempt.context).scene
    field = attempt.scene.language
    assert field is not None
    others_ = [g for g in field.objects() if g.id not in attempt.selection.groups and g.count > 400]
    if attempt.op.op not in _TARGETED or not others_:
        return None
    group = others_[int(attempt.rng.integers(len(others_)))]
    leaves = torch.tensor(field.leaves(group.id), dtype=torch.int32)
    ids = attempt.scene.cloud.ids[torch.isin(attempt.scene.cloud.group, leaves)]
    other = Selection(attempt.selection.query, "found", ids.sort().values, (group.id,))
    return attempt.scene, carry_out(attempt.scene, attempt.op, attempt.context, other).scene


def residue(attempt: Attempt) -> tuple[Scene, Scene] | None:
    """A connected piece of 8 to 40 % of the target is left out."""
    if attempt.op.op not in ("delete", "recolor", "replace", "move"):
        return None
    left = _piece(attempt)
    return attempt.scene, attempt.again(attempt.selection.ids[~mask_in(attempt.selection.ids, left)])


def floating(attempt: Attempt) -> tuple[Scene, Scene] | None:
    """What was put down hangs 8 to 60 cm in the air, or stands that deep in its support."""
    if attempt.op.op not in ("insert", "duplicate", "replace") and getattr(attempt.op, "place", None) is None:
        return None
    cloud = attempt.after.cloud
    fresh = cloud.ids > int(attempt.scene.cloud.ids.max())
    rows = (fresh if bool(fresh.any()) else mask_of(cloud, attempt.selection.ids)).nonzero().squeeze(1)
    lift = float(attempt.rng.uniform(0.08, 0.6)) * (1 if attempt.rng.random() < 0.75 else -1)
    lift = max(lift, -0.4)
    draft = Draft(cloud)
    draft.map("means", rows, lambda means: means + torch.tensor([0.0, 0.0, lift]))
    return attempt.scene, attempt.after.replace(cloud=draft.done())


def bled(attempt: Attempt) -> tuple[Scene, Scene] | None:
    """The new colour covers what stands or lies within 10 to 30 cm of the target too."""
    color = getattr(attempt.op, "color", None)
    if attempt.op.op != "recolor" or color is None:
        return None
    cloud = attempt.scene.cloud
    target = mask_of(cloud, attempt.selection.ids)
    points = cloud.means[target]
    reach = float(attempt.rng.uniform(0.1, NEIGHBOURHOOD))
    low, high = points.quantile(0.01, dim=0) - reach, points.quantile(0.99, dim=0) + reach
    near = ((cloud.means > low) & (cloud.means < high)).all(dim=1) & ~target
    if int(near.sum()) < 50:
        return None
    return attempt.scene, attempt.after.replace(cloud=_tinted(attempt, near.nonzero().squeeze(1), str(color)))


def nothing(attempt: Attempt) -> tuple[Scene, Scene] | None:
    """The scene is as before, or changed by less than anybody can see."""
    if attempt.rng.random() < 0.5:
        return attempt.scene, attempt.scene
    cloud = attempt.scene.cloud
    rows = mask_of(cloud, attempt.selection.ids).nonzero().squeeze(1)
    draft = Draft(cloud)
    if attempt.op.op in ("move", "rotate", "scale"):
        draft.map("means", rows, lambda means: means + 1e-4)
    else:
        draft.map("sh", rows, lambda sh: sh + 1e-3)
    return attempt.scene, attempt.scene.replace(cloud=draft.done())


def something_gone(attempt: Attempt) -> tuple[Scene, Scene] | None:
    """Another object, or a piece of one or of the floor, is gone too."""
    others = torch.unique(attempt.truth[(attempt.truth != attempt.thing) & (attempt.truth >= 0)])
    one = int(others[int(attempt.rng.integers(len(others)))])
    rows = (attempt.truth == one).nonzero().squeeze(1)
    if attempt.rng.random() < 0.5:
        rows = _half(attempt.scene.cloud.means[rows], rows, float(attempt.rng.uniform(0.15, 0.6)), attempt.rng)
    go = mask_of(attempt.after.cloud, attempt.scene.cloud.ids[rows])
    return attempt.scene, attempt.after.replace(cloud=attempt.after.cloud[~go])


SABOTAGES: dict[str, Damage] = {
    "wrong target": wrong_target,
    "residue": residue,
    "floating": floating,
    "bled": bled,
    "nothing changed": nothing,
    "something gone": something_gone,
}


# -- the field lies too -----------------------------------------------------------------------------------------------


def hidden_target(attempt: Attempt) -> tuple[Scene, Scene] | None:
    """The field takes another object for the one that is named."""
    field = attempt.scene.language
    assert field is not None
    if attempt.op.op not in _TARGETED or len(attempt.selection.groups) != 1:
        return None
    mine = attempt.selection.groups[0]
    others = [g for g in field.objects() if g.id != mine and g.count > 400]
    if field.groups[mine].level != "object" or not others:
        return None
    other = others[int(attempt.rng.integers(len(others)))].id
    vectors, rows = field.embeddings.copy(), list(field.groups)
    vectors[[mine, other]] = vectors[[other, mine]]
    one, two = rows[mine], rows[other]
    rows[mine] = replace(one, label=two.label, label_score=two.label_score)
    rows[other] = replace(two, label=one.label, label_score=one.label_score, lab=one.lab)
    scene = attempt.scene.replace(language=replace(field, embeddings=vectors, groups=tuple(rows)))
    found = attempt.context.resolve(scene, attempt.op.query())  # type: ignore[arg-type]
    if found.verdict != "found" or found.groups != (other,):
        return None
    return scene, carry_out(scene, attempt.op, attempt.context).scene


def hidden_residue(attempt: Attempt) -> tuple[Scene, Scene] | None:
    """A piece of the target belongs to no group, to the floor, or to the nearest other object."""
    if attempt.op.op not in ("delete", "replace", "move") or not attempt.selection.groups:
        return None
    field, cloud = attempt.scene.language, attempt.scene.cloud
    assert field is not None
    rows = mask_of(cloud, _piece(attempt)).nonzero().squeeze(1)
    owner = _new_owner(attempt, rows)
    group = cloud.group.clone()
    group[rows] = owner
    scene = attempt.scene.replace(cloud=cloud.replace(group=group))
    found = attempt.context.resolve(scene, attempt.op.query())  # type: ignore[arg-type]
    if found.verdict != "found" or len(found) >= len(attempt.selection):
        return None
    return scene, carry_out(scene, attempt.op, attempt.context).scene


HIDDEN: dict[str, Damage] = {"wrong target, hidden": hidden_target, "residue, hidden": hidden_residue}


def _new_owner(attempt: Attempt, rows: Tensor) -> int:
    """The group that a piece of the target is filed under."""
    field, cloud = attempt.scene.language, attempt.scene.cloud
    assert field is not None
    draw = attempt.rng.random()
    floors = [g for g in field.groups if g.level == "structure"]
    if draw < 0.4:
        return NO_GROUP
    if draw < 0.7 and floors:
        return max(floors, key=lambda g: g.count).id
    outside = (~mask_of(cloud, attempt.selection.ids) & (cloud.group != NO_GROUP)).nonzero().squeeze(1)
    middle = cloud.means[rows].mean(dim=0)
    nearest = outside[torch.linalg.vector_norm(cloud.means[outside] - middle, dim=1).argmin()]
    return int(cloud.group[nearest])


def mask_in(ids: Tensor, some: Tensor) -> Tensor:
    """`[M]` bool: whether each id is among `some`."""
    return torch.isin(ids, some)


def _piece(attempt: Attempt) -> Tensor:
    """Ids of a piece of the target: what lies beyond a plane through it."""
    cloud = attempt.scene.cloud
    rows = mask_of(cloud, attempt.selection.ids).nonzero().squeeze(1)
    share = float(attempt.rng.uniform(0.08, 0.4))
    return cloud.ids[_half(cloud.means[rows], rows, share, attempt.rng)]


def _half(points: Tensor, rows: Tensor, share: float, rng: np.random.Generator) -> Tensor:
    """The `share` of the rows that lies farthest along a random direction."""
    way = torch.tensor(rng.normal(size=3), dtype=torch.float32)
    along = (points - points.mean(dim=0)) @ (way / way.norm())
    return rows[along.argsort(descending=True)[: max(1, round(share * len(rows)))]]


def _tinted(attempt: Attempt, rows: Tensor, color: str):  # type: ignore[no-untyped-def]
    """The cloud after with some more rows in the new colour."""
    cloud = attempt.after.cloud
    change = fit(sample(cloud, rows), torch.tensor(shade_of(color), dtype=torch.float64))
    draft = Draft(cloud)
    draft.map("sh", rows, change.on_harmonics)
    return draft.done()
