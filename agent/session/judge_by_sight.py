"""The verdict of a vision model on an edit, as checks: it sees the scenes before and after from the same places."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from torch import Tensor

    from ...gaussians.cloud import GaussianCloud
    from ...gaussians.scene import Scene
    from ...gaussians.viewpoints.for_groups import ChosenView
    from ...gaussians.viewpoints.view_candidates import View
    from ...planners.vision.judging import Verdict
    from ...planners.vision.looker import Shown
    from ...tools.receipt import Check
    from .vision_client import VisionClient

PAIRS = 2  # pictures before, and as many after
SIZE = (512, 384)  # pixels
SEEN = "seen: "  # names of checks that a vision model decided begin with this
_MOST_GROUPS = 3  # groups that the views are chosen for


def checks_by_sight(instruction: str, before: Scene, after: Scene, vision: VisionClient) -> tuple[Check, ...]:
    """What a vision model says of an edit.

    Args:
        instruction: in the user's words.
        before, after: embedded scenes.

    Raises:
        BackendError: the model cannot be asked, gave no usable reply, or its budget is used up.
    """
    from ...planners.vision.judging import verdict

    pairs = pictures(before, after)
    old, new = tuple(a for a, _ in pairs), tuple(b for _, b in pairs)
    return _checks(verdict(instruction, old, new, vision.backend, vision.purse(2 * PAIRS)))


def _checks(said: Verdict) -> tuple[Check, ...]:
    from ...tools.receipt import at_least, at_most

    flags = {"done": said.done, "right thing": said.right_thing, "no residue": not said.residue,
             "plausible": said.looks_right}  # fmt: skip
    found = [at_least(f"{SEEN}{name}", float(holds), 1, "1", said.reason) for name, holds in flags.items()]
    effects = "; ".join(said.side_effects) or said.reason
    return *found, at_most(f"{SEEN}no side effects", len(said.side_effects), 0, "changes", effects)


def pictures(before: Scene, after: Scene) -> tuple[tuple[Shown, Shown], ...]:
    """At most `PAIRS` pairs of pictures before and after, each pair from one place that shows what changed."""
    return tuple((_drawn(before, view), _drawn(after, view)) for view in _views(before, after))


def _views(before: Scene, after: Scene) -> list[View]:
    """Views of the things that changed: where they were, and where they are now."""
    from ...gaussians.viewpoints.for_groups import Sights, choose
    from ...tools.judging.changes import changes_between

    changes = changes_between(before.cloud, after.cloud)
    altered = changes.any.nonzero().squeeze(1)
    stayed = changes.row[altered]
    was = _owners(before, before.cloud, altered)
    now = _owners(after, after.cloud, _joined(stayed[stayed >= 0], changes.added))
    moved = bool(changes.placed.any()) or bool(len(changes.added))
    chosen: list[ChosenView] = []
    if was or not now:
        chosen += choose(Sights.of(before), was, 1 if moved and now else PAIRS, SIZE)
    if now and moved:
        chosen += choose(Sights.of(after), now, PAIRS - len(chosen), SIZE)
    return [c.view for c in chosen]


def _joined(one: Tensor, other: Tensor) -> Tensor:
    import torch

    return torch.cat([one, other])


def _owners(scene: Scene, cloud: GaussianCloud, rows: Tensor) -> Sequence[int]:
    """The objects that most of some rows belong to, the largest share first."""
    import torch

    field = scene.language
    leaves = cloud.group[rows]
    leaves = leaves[leaves >= 0].to(torch.int64)
    if field is None or not len(leaves):
        return ()
    count = torch.bincount(leaves, minlength=len(field.groups))
    most = count.argsort(descending=True, stable=True)[:_MOST_GROUPS]
    owners = (field.groups[int(g)] for g in most if int(count[g]))
    whole = (g if g.parent < 0 else field.groups[g.parent] for g in owners)
    return tuple(dict.fromkeys(g.id for g in whole if g.count))


def _drawn(scene: Scene, view: View) -> Shown:
    from ...gaussians.render import render
    from ...planners.vision.looker import Shown
    from ..pictures.image_files import encoded_png
    from ..pictures.marked_views import BACKGROUND

    drawn = render(view.cut.apply(scene), view.camera, BACKGROUND if view.cut else (0.0, 0.0, 0.0)).to_uint8()
    size = (view.camera.width, view.camera.height)
    return Shown(view.name, encoded_png(drawn), size, {}, f"A view, {view.name}.")
