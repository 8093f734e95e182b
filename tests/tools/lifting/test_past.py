"""Gaussians of a fill that stand before what other views see are left out; the others stay."""

from __future__ import annotations

import torch

from scenewright.gaussians.cloud import concat
from scenewright.gaussians.rows import mask_of_ids
from scenewright.tools.lifting.past import seen_past

from .conftest import FLOOR, Room, floor


def _fill(room: Room, height: float) -> tuple[torch.Tensor, torch.Tensor]:
    """Ids that are seen past, and all: a true floor under the box alone, and a red sheet at a height beside it."""
    whole, fitted = floor(), room.fitted.cloud
    under = whole[(whole.means[:, :2].abs() < 0.15).all(dim=1)]
    beside = whole[(whole.means[:, 0] > 0.4) & (whole.means[:, 0] < 0.7) & (whole.means[:, 1].abs() < 0.2)]
    red = torch.zeros_like(beside.sh)
    red[:, 0] = torch.tensor([1.5, -1.0, -1.0])
    lifted = beside.means + torch.tensor([0.0, 0.0, height])
    first = int(fitted.ids.max()) + 1
    under = under.replace(ids=torch.arange(len(under)) + first)
    beside = beside.replace(sh=red, means=lifted, ids=torch.arange(len(beside)) + first + len(under))
    after = concat([fitted[fitted.group == FLOOR], under, beside])
    found = seen_past(fitted, after, torch.cat([under.ids, beside.ids]), room.fitted.cameras)
    return mask_of_ids(under.ids, found), mask_of_ids(beside.ids, found)


def test_what_stands_before_the_floor_goes_and_the_floor_stays(room: Room) -> None:
    under, beside = _fill(room, 0.2)
    assert beside.float().mean() > 0.9 and under.sum() == 0


def test_a_fill_that_no_view_contradicts_stays(room: Room) -> None:
    cloud = room.fitted.cloud
    rest = cloud[cloud.group == FLOOR]
    true = room.truth.replace(ids=torch.arange(len(room.truth)) + int(cloud.ids.max()) + 1)
    x, y = true.means[:, 0], true.means[:, 1]
    hole = true[(x.abs() < 0.3) & (y > -0.2) & (y < 0.2)]
    assert len(seen_past(cloud, concat([rest, hole]), hole.ids, room.fitted.cameras)) <= 0.05 * len(hole)


def test_without_cameras_nothing_is_known(room: Room) -> None:
    own = room.new
    assert len(seen_past(room.fitted.cloud, room.filled.cloud, own, ())) == 0
