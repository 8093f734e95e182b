"""Ways in which the result of an operation is spoilt before its checks see it.

The outcome of the operation claims what was done: the maps of its bodies, the ids that it touched, the height of its
support. A spoilt outcome claims consistently the wrong thing, as a fault in the operation would, so that book-keeping
alone does not tell. Each spoils by an amount that a person sees in a picture.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import torch
from torch import Tensor

from ...gaussians.color import lab_to_rgb, rgb_to_lab
from ...gaussians.harmonics import color_to_dc, dc_to_color
from ...gaussians.language.field.measure import solid_points
from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.scene import Scene
from ...tools.cloud_diff import Draft
from ...tools.operation import Affine, Context, EditOp, Outcome
from ...tools.placement.bodies import bodies_of, contact_box
from ...tools.transform import stretch

SMALLER, LARGER = (0.55, 0.75), (1.35, 2.0)  # factors of a thing that is scaled
DWARFED, HUGE = (0.25, 0.4), (2.5, 4.0)  # factors of a new thing
DRIFT = (0.75, 2.0)  # of the larger level side of a thing
LIFT = (0.08, 0.6)  # metres, or of the height where the scale is unknown
SUNK = 0.4  # of the height: how deep it sinks at most
HUE = (18.0, 45.0)  # Lab distance in a and b
COLORED = 12.0  # Lab chroma from which a surface has a hue
SEEN = 12.0  # Lab distance that remains on a display
RESIDUE = (0.08, 0.4)  # share of the target


@dataclass(frozen=True, eq=False)
class Attempt:
    """An honest outcome that a sabotage starts from.

    Attributes:
        scene: before.
        op, context: of the edit.
        chosen: what it was applied to.
        outcome: of the operation.
        others: other things of the scene, ids of their Gaussians `[M]` each.
        rng: of the sabotage's own choices.
    """

    scene: Scene
    op: EditOp
    context: Context
    chosen: Selection
    outcome: Outcome
    others: tuple[Tensor, ...]
    rng: np.random.Generator


Spoiling = Callable[[Attempt], Outcome | None]  # None where it does not apply
_PUT = frozenset({"insert", "duplicate", "replace"})


def wrong_size(a: Attempt) -> Outcome | None:
    """It was scaled by another factor than was asked; a new thing is a dwarf or a giant."""
    if a.op.op not in _PUT | {"scale"}:
        return None
    small, large = (DWARFED, HUGE) if a.op.op in _PUT else (SMALLER, LARGER)
    factor = float(a.rng.uniform(*(small if a.rng.random() < 0.5 else large)))
    return _remapped(a, lambda body: (np.eye(3) * factor, _foot(a.outcome.scene, body.rows) * (1 - factor), 0.0))


def drifted(a: Attempt) -> Outcome | None:
    """The pivot was elsewhere, or the thing went another way, or elsewhere than to the old place."""
    moves = a.op.op == "move" and getattr(a.op, "direction", None) is not None
    if a.op.op not in ("rotate", "scale", "replace") and not moves:
        return None
    angle = float(a.rng.uniform(0, 2 * np.pi))

    def change(body: Affine) -> tuple[np.ndarray, np.ndarray, float]:
        box = contact_box(solid_points(a.outcome.scene.cloud, body.rows), a.scene.frame)
        old = [max(b.box.size[:2]) for b in bodies_of(a.scene, a.chosen)] if a.op.op == "replace" else []
        far = float(a.rng.uniform(*DRIFT)) * max(*box.size[:2], *old)
        east, north, _ = a.scene.frame.basis()
        return np.eye(3), far * (np.cos(angle) * np.array(east) + np.sin(angle) * np.array(north)), 0.0

    return _remapped(a, change)


def hue_shifted(a: Attempt) -> Outcome | None:
    """The colour has another hue than was asked, or one that was not asked for at all."""
    if a.op.op in ("delete", "opacity", "insert", "isolate"):
        return None
    if a.op.op == "replace" and getattr(a.op, "color", None) is None:
        return None
    cloud = a.outcome.scene.cloud
    ids = torch.cat([a.outcome.touched, a.outcome.added])
    rows = mask_of(cloud, ids).nonzero().squeeze(1)
    angle, far = float(a.rng.uniform(0, 2 * np.pi)), float(a.rng.uniform(*HUE))
    draft = Draft(cloud)
    lab = rgb_to_lab(dc_to_color(cloud.sh[rows, 0].double()).clamp(0, 1))
    middle = lab[:, 1:].median(dim=0).values
    if float(torch.linalg.vector_norm(middle)) > COLORED:  # to another hue, not to a paler one
        angle = float(np.arctan2(float(middle[1]), float(middle[0]))) + (np.pi / 2 if angle > np.pi else -np.pi / 2)
    lab = lab + far * torch.tensor([0.0, np.cos(angle), np.sin(angle)])
    sh = cloud.sh[rows].clone()
    rgb = lab_to_rgb(lab).clamp(0, 1)
    was = rgb_to_lab(dc_to_color(sh[:, 0].double()).clamp(0, 1))
    if float(torch.linalg.vector_norm(rgb_to_lab(rgb) - was, dim=1).median()) < SEEN:
        return None  # a display shows hardly any of it
    sh[:, 0] = color_to_dc(rgb).to(sh.dtype)
    draft.write("sh", rows, sh)
    return replace(a.outcome, scene=a.outcome.scene.replace(cloud=draft.done()))


def floating(a: Attempt) -> Outcome | None:
    """It hangs in the air or is sunk; half of the time the height of its support was measured as wrongly."""
    placed = a.op.op in _PUT | {"rotate", "scale", "exchange"} or getattr(a.op, "place", None) is not None
    if not placed:
        return None
    up, lying = a.scene.frame.up_vector, a.rng.random() < 0.5
    down = a.rng.random() < 0.25

    def change(body: Affine) -> tuple[np.ndarray, np.ndarray, float]:
        height = contact_box(solid_points(a.outcome.scene.cloud, body.rows), a.scene.frame).size[2]
        scale = a.scene.frame.metres_per_unit
        unit = 1 / scale if scale is not None else height
        lift = max(float(a.rng.uniform(*LIFT)) * unit, 0.25 * height)
        lift = -min(lift, SUNK * height) if down else lift
        return np.eye(3), up * lift, lift if lying else 0.0

    return _remapped(a, change)


def residue(a: Attempt) -> Outcome | None:
    """A connected piece of the target was left out."""
    if a.op.op not in ("delete", "recolor", "replace", "move"):
        return None
    rows = mask_of(a.scene.cloud, a.chosen.ids).nonzero().squeeze(1)
    piece = _end_of(a.scene.cloud.means[rows], rows, float(a.rng.uniform(*RESIDUE)), a.rng)
    kept = a.chosen.ids[~torch.isin(a.chosen.ids, a.scene.cloud.ids[piece])]
    return a.op.apply(a.scene, replace(a.chosen, ids=kept), a.context)


def wrong_thing(a: Attempt) -> Outcome | None:
    """It was done to another thing."""
    if a.op.query() is None or not a.others:
        return None
    ids = a.others[int(a.rng.integers(len(a.others)))]
    return a.op.apply(a.scene, replace(a.chosen, ids=ids.sort().values), a.context)


def neighbours_changed(a: Attempt) -> Outcome | None:
    """Something beside it was recoloured, moved or taken away along with it."""
    if not a.others:
        return None
    ids = a.others[int(a.rng.integers(len(a.others)))]
    cloud = a.outcome.scene.cloud
    rows = mask_of(cloud, ids).nonzero().squeeze(1)
    rows = _end_of(cloud.means[rows], rows, float(a.rng.uniform(0.2, 1.0)), a.rng)
    if not len(rows):
        return None
    kind = int(a.rng.integers(3))
    if kind == 0 and not a.outcome.moved:
        keep = torch.ones(len(cloud), dtype=torch.bool)
        keep[rows] = False
        gone = torch.cat([a.outcome.removed, cloud.ids[rows]])
        return replace(a.outcome, scene=a.outcome.scene.replace(cloud=cloud[keep]), removed=gone.sort().values)
    draft = Draft(cloud)
    if kind < 2:
        draft.map("sh", rows, lambda sh: sh + 0.5)
    else:
        draft.map("means", rows, lambda means: means + 0.1 * (means.amax(dim=0) - means.amin(dim=0)).max())
    touched = torch.unique(torch.cat([a.outcome.touched, cloud.ids[rows]]))
    return replace(a.outcome, scene=a.outcome.scene.replace(cloud=draft.done()), touched=touched)


SPOILINGS: dict[str, Spoiling] = {
    "wrong size": wrong_size,
    "drifted": drifted,
    "hue shift": hue_shifted,
    "floating": floating,
    "residue": residue,
    "wrong thing": wrong_thing,
    "neighbours": neighbours_changed,
}


def _remapped(a: Attempt, change: Callable[[Affine], tuple[np.ndarray, np.ndarray, float]]) -> Outcome | None:
    """The outcome with every body mapped again by a matrix and an offset, and its support shifted; the maps say so."""
    if not a.outcome.moved:
        return None
    draft, moved = Draft(a.outcome.scene.cloud), []
    for body in a.outcome.moved:
        matrix, offset, lift = change(body)
        stretch(draft, body.rows, matrix, offset)
        support = None if body.support is None else body.support + lift
        moved.append(replace(body, matrix=matrix @ body.matrix, offset=matrix @ body.offset + offset, support=support))
    return replace(a.outcome, scene=a.outcome.scene.replace(cloud=draft.done()), moved=tuple(moved))


def _foot(scene: Scene, rows: Tensor) -> np.ndarray:
    """`[3]`, middle of the underside of some rows."""
    box = contact_box(solid_points(scene.cloud, rows), scene.frame)
    return np.array(box.center) - scene.frame.up_vector * (box.size[2] / 2)


def _end_of(points: Tensor, rows: Tensor, share: float, rng: np.random.Generator) -> Tensor:
    """The `share` of the rows that lies farthest along a random direction."""
    way = torch.tensor(rng.normal(size=3), dtype=torch.float32)
    along = (points - points.mean(dim=0)) @ (way / way.norm())
    return rows[along.argsort(descending=True)[: max(1, round(share * len(rows)))]]
