"""Footprints of 16 Gaussians at once: as the reference renderer has them, whatever lane a Gaussian falls into."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.render import convention, cpu, reference
from scenewright.gaussians.render.cpu import layout, order, project

CAMERA = Camera.look_at([0, -3, 0.5], [0, 0, 0], [0, 0, 1], 150, 130)
COLORS = slice(layout.RED, layout.BLUE + 1)


def random_cloud(count: int, coefficients: int, spread: float = 1.0) -> GaussianCloud:
    rng = np.random.default_rng(count)
    columns = (
        rng.normal(0, spread, (count, 3)), rng.normal(size=(count, 4)), np.exp(rng.normal(-3, 1, (count, 3))),
        rng.uniform(0.001, 1.2, count), rng.normal(0, 0.3, (count, coefficients, 3)),
    )  # fmt: skip
    return GaussianCloud.create(*(torch.tensor(column, dtype=torch.float32) for column in columns))


def projected(cloud: GaussianCloud, view: layout.View) -> tuple[project.Projected, np.ndarray]:
    """The footprints of a cloud, and its visible rows in order."""
    found = project.run(cpu._columns(cloud), view, 1)
    chunks = [found.visible[0, c, :count] for c, count in enumerate(found.found[:, 0])]
    return found, (np.concatenate(chunks) & np.uint64(0xFFFFFFFF)).astype(np.int64)


def view_of(cloud: GaussianCloud) -> layout.View:
    return layout.make_view(CAMERA, convention.near_plane(cloud.means), 0, CAMERA.height)


@pytest.mark.parametrize("coefficients", [1, 4, 9, 16])
@pytest.mark.parametrize("count", [1, 16, 17, project.CHUNK + 5])
def test_footprints_are_those_of_the_reference(count: int, coefficients: int) -> None:
    """Sums of a dozen products of numbers rounded to 24 bits: a few 1e-6 of the largest, of which squares of an
    ellipse lose as many digits again as it is long over wide; 2e-3 allows for 1000."""
    cloud = random_cloud(count, coefficients)
    found, rows = projected(cloud, view_of(cloud))
    truth = reference.project(cloud, CAMERA, torch.float64)
    place = {int(row): k for k, row in enumerate(truth.row)}
    assert set(rows.tolist()) <= place.keys()
    assert len(rows) >= 0.9 * len(place)  # those that touch no pixel centre are left out here
    at, record = [place[int(row)] for row in rows], found.records[rows].astype(np.float64)
    l1, l2, l3 = record[:, layout.L1], record[:, layout.L2], record[:, layout.L3]
    conic = 16 * np.stack([l1 * l1, l1 * l2, l2 * l2 + l3 * l3], axis=1)
    wanted = truth.conic[at].numpy()
    assert np.abs(conic - wanted).max(axis=1, initial=0) == pytest.approx(
        0 * l1, abs=2e-3 * np.abs(wanted).max(initial=1)
    )
    center = record[:, [layout.X, layout.Y]]
    np.testing.assert_allclose(center, truth.center[at].numpy(), rtol=1e-4, atol=1e-3)
    np.testing.assert_allclose(record[:, layout.DEPTH], truth.depth[at].numpy(), rtol=1e-5)
    np.testing.assert_allclose(record[:, layout.REACH_Y], truth.reach[at].numpy()[:, 1], rtol=1e-3)
    np.testing.assert_allclose(record[:, COLORS], truth.color[at].numpy(), atol=1e-5)
    np.testing.assert_array_equal(record.astype(np.float32)[:, layout.GROUP].view(np.int32), cloud.group.numpy()[rows])


@pytest.mark.parametrize("coefficients", [1, 4, 9, 16])
def test_a_footprint_does_not_depend_on_its_neighbours(coefficients: int) -> None:
    cloud = random_cloud(51, coefficients)
    view = view_of(cloud)
    whole, rows = projected(cloud, view)
    assert 10 < len(rows) < 51
    for row in range(len(cloud)):
        alone, seen = projected(cloud[torch.tensor([row])], view)
        assert len(seen) == (row in rows)
        if len(seen):
            assert alone.records[0].tobytes() == whole.records[row].tobytes()
            assert alone.spots[0].tobytes() == whole.spots[row].tobytes()


def test_masks_of_tiles_hold_every_pixel_of_the_ellipse() -> None:
    """The tiles of a footprint, whole boxes or tested one by one, against its exponent at every pixel centre."""
    cloud = random_cloud(300, 1)
    found, rows = projected(cloud, view_of(cloud))
    x, y = np.meshgrid(np.arange(CAMERA.width) + 0.5, np.arange(CAMERA.height) + 0.5)
    tiles_wide, some, many = -(-CAMERA.width // layout.TILE), 0, 0
    for row in rows:
        record, (mask, corner) = found.records[row].astype(np.float64), found.spots[row].tolist()
        if not mask:
            many += 1
            continue
        dx, dy = x - record[layout.X], y - record[layout.Y]
        q = (record[layout.L1] * dx + record[layout.L2] * dy) ** 2 + (record[layout.L3] * dy) ** 2
        inside = np.argwhere(q < record[layout.LIMIT] * 0.9999)
        needed = set((inside[:, 0] // layout.TILE * tiles_wide + inside[:, 1] // layout.TILE).tolist())
        base = (corner >> 16) * tiles_wide + (corner & 0xFFFF)
        bits = [bit for bit in range(64) if mask >> bit & 1]
        assert needed <= {base + bit // layout.MASK_SIDE * tiles_wide + bit % layout.MASK_SIDE for bit in bits}
        some += len(bits) > 6
    assert some > 5 and many > 0


@pytest.mark.parametrize("parts", [1, 2, order.PARTS])
@pytest.mark.parametrize("depths", ["near each other", "over all sizes", "equal", "few", "none"])
def test_rows_are_sorted_by_depth_and_equal_ones_by_row(depths: str, parts: int) -> None:
    rng = np.random.default_rng(parts)
    depth = {
        "near each other": rng.uniform(1, 1.001, 9_000), "over all sizes": 10 ** rng.uniform(-30, 30, 9_000),
        "equal": np.full(9_000, 2.5), "few": rng.integers(1, 6, 9_000) / 3, "none": np.empty(0),
    }[depths].astype(np.float32)  # fmt: skip
    bits = depth.view(np.uint32).astype(np.uint64)
    values = bits << layout.KEY | np.arange(len(depth), dtype=np.uint64)
    levels = np.sort(bits)[len(bits) * np.arange(1, parts) // parts] if len(bits) else np.zeros(parts - 1, np.uint64)
    part = np.searchsorted(levels, bits, side="right")
    chunks = -(-len(depth) // 1_000)
    visible, found = np.zeros((parts, chunks, 1_000), np.uint64), np.zeros((chunks, parts), np.int32)
    for row, value in enumerate(values):
        place = row // 1_000, part[row]
        visible[place[1], place[0], found[place]] = value
        found[place] += 1
    np.testing.assert_array_equal(order.by_depth(visible, found), np.argsort(depth, kind="stable"))


def test_a_cloud_is_divided_into_parts_of_like_size() -> None:
    cloud = random_cloud(2 * order.ALONE, 1)
    view = view_of(cloud)
    bounds = order.divide(cloud.means[::16].numpy(), view, 64, len(cloud))
    found = project.run(cpu._columns(cloud), view, 2, bounds).found.sum(axis=0)
    assert len(found) == order.PARTS
    assert found.max() < 1.5 * found.mean()  # a sample of 4,096, of which some are outside the image
    behind = layout.make_view(Camera.look_at([0, -3, 0], [0, -6, 0], [0, 0, 1], 64, 64), 0.1, 0, 64)
    np.testing.assert_array_equal(order.divide(np.full((9, 3), np.nan), behind, 2, len(cloud)), [order.FARTHEST])
