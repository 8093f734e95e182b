"""Laws of furnished rooms: nothing interpenetrates, everything is carried, inside, and the truth lines up."""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians import assets
from scenewright.gaussians.assets.furnishing.layout import TOUCHING
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.world.box import YawBox, meet

SEEDS = tuple(range(8))


@cache
def furnished(seed: int) -> assets.Room:
    return assets.furnish(seed, detail=0.3)


def box_of(o: assets.TruthObject) -> YawBox:
    x, y, z = o.position
    return YawBox(x, y, z - o.size[2] / 2, *o.size, o.yaw)


@pytest.mark.parametrize("seed", SEEDS)
def test_nothing_interpenetrates_and_all_is_inside(seed: int) -> None:
    room = furnished(seed)
    w, d, h = room.size
    for o in room.truth.objects:
        b = box_of(o)
        corners = b.corners()
        # windows and doors are set 2 mm before the wall's plane
        assert np.abs(corners[:, 0]).max() <= w / 2 + 1e-3 and np.abs(corners[:, 1]).max() <= d / 2 + 1e-3, o
        assert b.low >= -1e-6 and b.high <= h + 1e-6, o
    for a, b in combinations(room.truth.objects, 2):
        assert not meet(box_of(a), box_of(b), 1e-3), (a, b)


@pytest.mark.parametrize("seed", SEEDS)
def test_everything_is_supported(seed: int) -> None:
    room = furnished(seed)
    w, d, _ = room.size
    for o in room.truth.objects:
        b = box_of(o)
        if o.support == "floor":
            assert abs(b.low) < 1e-6
        elif o.support == "wall":
            backs = [np.array(b.world(s * b.w / 2, b.d / 2)) for s in (-1, 1)]
            # its back hangs at most 2 cm from one wall, all along
            off = [np.array([w / 2 - abs(p[0]), d / 2 - abs(p[1])]) for p in backs]
            assert np.max(off, axis=0).min() < 0.02, o
        else:
            assert isinstance(o.support, int)
            under = room.truth.objects[o.support]
            base = box_of(under)
            local = (b.corners() - np.array([base.x, base.y])) @ base.axes.T
            assert (np.abs(local) <= np.array([base.w, base.d]) / 2 + 1e-3).all(), (o, under)
            assert base.low < b.low <= base.high + 1e-6
            below = room.scene.cloud.means[room.truth.ids == o.support].numpy()
            near = (np.abs(below[:, :2] - [b.x, b.y]) < 0.5 * max(b.w, b.d) + 0.1).all(axis=1)
            assert np.abs(below[near, 2] - b.low).min() < 0.01, (o, under)


@pytest.mark.parametrize("seed", SEEDS)
def test_truth_lines_up_with_the_cloud(seed: int) -> None:
    room = furnished(seed)
    cloud, truth = room.scene.cloud, room.truth
    assert truth.ids.dtype == torch.int32 and truth.ids.shape == (len(cloud),)
    assert (cloud.group == -1).all() and room.scene.language is None
    assert truth.ids.min() == -1 and int(truth.ids.max()) == len(truth.objects) - 1
    for o in truth.objects:
        means = cloud.means[truth.ids == o.id].numpy()
        assert len(means) > 50
        b = box_of(o)
        local = (means[:, :2] - np.array([b.x, b.y])) @ b.axes.T
        assert (np.abs(local) <= np.array([b.w, b.d]) / 2 + 1e-3).all(), o
        assert means[:, 2].min() >= b.low - 1e-3 and means[:, 2].max() <= b.high + 1e-3
        assert assets.KINDS[o.kind].known.shown and o.color
    assert len(torch.unique(cloud.ids)) == len(cloud)


@pytest.mark.parametrize("seed", SEEDS)
def test_one_can_walk_in(seed: int) -> None:
    """At least 40 % of the floor is bare, and a person of 40 cm reaches nine tenths of what is wide enough."""
    from scipy.ndimage import binary_erosion, label

    room = furnished(seed)
    w, d, _ = room.size
    xs, ys = np.meshgrid(np.arange(-w / 2, w / 2, 0.05), np.arange(-d / 2, d / 2, 0.05), indexing="ij")
    free = np.ones(xs.shape, dtype=bool)
    for o in room.truth.objects:
        b = box_of(o)
        if b.low > 0.5 or o.kind == "rug":
            continue
        local = (np.stack([xs, ys], -1) - np.array([b.x, b.y])) @ b.axes.T
        free &= ~((np.abs(local[..., 0]) < b.w / 2) & (np.abs(local[..., 1]) < b.d / 2))
    assert free.mean() > 0.4
    wide = binary_erosion(free, iterations=4, border_value=1)
    parts, count = label(wide)
    biggest = max((parts == k).sum() for k in range(1, count + 1))
    assert biggest > 0.8 * wide.sum()


@pytest.mark.parametrize("seed", SEEDS)
def test_frame_and_cameras(seed: int) -> None:
    room = furnished(seed)
    frame = room.scene.frame
    assert frame.up == (0.0, 0.0, 1.0) and frame.floor == 0.0 and frame.metres_per_unit == 1.0
    assert frame.up_source == frame.scale_source == "given"
    assert len(room.scene.cameras) >= 4
    w, d, _ = room.size
    for camera in room.scene.cameras:
        pixels, depth = camera.project(room.scene.cloud.means.numpy())
        seen = (depth > 0) & (pixels >= 0).all(axis=1) & (pixels < [camera.width, camera.height]).all(axis=1)
        assert seen.mean() > 0.2, camera.name
        if camera.name != "overview":
            x, y, z = camera.position
            assert abs(x) < w / 2 and abs(y) < d / 2 and 1.4 < z < 1.7
    assert 10 <= len(room.truth.objects) <= 40


def test_same_seed_same_bytes_and_seeds_differ() -> None:
    again = assets.furnish(3, detail=0.3)
    assert again.scene.cloud.digest() == furnished(3).scene.cloud.digest()
    assert again.truth.objects == furnished(3).truth.objects
    assert len({furnished(s).scene.cloud.digest() for s in SEEDS}) == len(SEEDS)


def test_kind_of_room_extra_things_and_ceiling() -> None:
    room = assets.furnish(5, "bedroom", detail=0.2, include=("guitar", "teddy"), ceiling=True)
    kinds = [o.kind for o in room.truth.objects]
    assert room.kind == "bedroom" and {"bed", "guitar", "teddy bear"} <= set(kinds)
    # the ceiling hangs at the room's height
    assert float(room.scene.cloud.means[room.truth.ids == -1][:, 2].max()) > room.size[2] - 0.01


def test_wrong_requests_say_the_fix() -> None:
    with pytest.raises(UserError, match="living room"):
        assets.furnish(0, "garage")
    with pytest.raises(UserError, match="between 3 and 40"):
        assets.furnish(0, objects=1)
    with pytest.raises(UserError, match="teddy"):
        assets.furnish(0, include=("tedy",))


boxes = st.builds(
    YawBox, *(st.floats(-2, 2),) * 2, st.floats(0, 1), *(st.floats(0.1, 2),) * 3, st.floats(-180, 180, allow_nan=False)
)


@given(boxes, boxes)
def test_overlap_is_symmetric_and_agrees_with_points(a: YawBox, b: YawBox) -> None:
    assert meet(a, b, TOUCHING) == meet(b, a, TOUCHING)
    # a grid of points of `a` inside `b` proves an overlap (points well inside, so the slack does not matter)
    t = np.linspace(-0.45, 0.45, 7)
    grid = np.stack(np.meshgrid(t * a.w, t * a.d, indexing="ij"), -1).reshape(-1, 2) @ a.axes + [a.x, a.y]
    local = (grid - [b.x, b.y]) @ b.axes.T
    inside = (np.abs(local) < np.array([b.w, b.d]) / 2 - 0.01).all(axis=1).any()
    level = a.low + 0.01 < b.high and b.low + 0.01 < a.high
    if inside and level:
        assert meet(a, b, TOUCHING)
