"""The tree holds every Gaussian once, and merged levels keep to its leaves and beat dropping Gaussians."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from scenewright.gaussians.assets import furnish
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.files.formats import streamed_sog_writing
from scenewright.gaussians.files.formats.streamed_sog import Streamed
from scenewright.gaussians.levels.making import described, make, measure
from scenewright.gaussians.levels.tree import build
from scenewright.gaussians.reduce import prune, psnr
from scenewright.gaussians.slim.views import choose_views


def test_leaves_are_numbered_in_order_and_none_is_too_large() -> None:
    means = np.random.default_rng(1).normal(size=(5000, 3)).astype(np.float32)
    tree = build(means, 700)
    sizes = np.bincount(tree.leaf_of(means), minlength=tree.leaves)
    assert sizes.sum() == 5000 and sizes.max() <= 700 and sizes.min() > 0 and len(sizes) == tree.leaves


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_many_at_one_place_end_the_division(share: float) -> None:
    means = np.random.default_rng(1).normal(size=(1000, 3)).astype(np.float32) + 9
    means[: round(share * 1000)] = 0
    tree = build(means, 100)
    sizes = np.bincount(tree.leaf_of(means), minlength=tree.leaves)
    assert sizes.sum() == 1000 and sizes.min() > 0 and sizes.max() <= max(100, share * 1000)


@pytest.mark.slow
def test_levels_stay_in_their_leaves_and_beat_dropping(tmp_path: Path) -> None:
    scene = furnish(3).scene
    views = choose_views(scene, size=128)
    levels = make(scene, 3, views.ranking[:12], 4096)
    counts = [len(cloud) for cloud in levels.clouds]
    assert counts == [len(scene.cloud), len(scene.cloud) // 4, len(scene.cloud) // 16]
    for cloud in levels.clouds:  # a mean of positions in a box lies in it, so the tree finds the same leaf
        assert (torch.from_numpy(levels.tree.leaf_of(cloud.means.numpy())) == cloud.group).all()
    streamed_sog_writing.save(levels, tmp_path / "a.lod")
    held_out = views.held_out[:4]
    found = measure(scene.cloud, tmp_path / "a.lod", held_out)
    streamed_sog_writing.annotate(tmp_path / "a.lod", scene, found)
    told = described(Streamed.open(tmp_path / "a.lod"))
    assert [level.gaussians for level in told] == counts
    assert all(mean >= least for mean, least in found) and found[0] > found[1] > found[2]
    assert told[0].bytes > told[1].bytes > told[2].bytes
    assert np.allclose([(level.psnr, level.psnr_least) for level in told], found, atol=1e-3)
    cameras = [view.camera for view in held_out]
    for count, (mean, _) in zip(counts[1:], found[1:], strict=True):
        dropped = prune(scene, count, [view.camera for view in views.ranking[:12]])
        assert mean > np.mean(psnr(scene.cloud, dropped.cloud, cameras)) + 1


def test_no_levels_are_refused() -> None:
    scene = furnish(3).scene
    with pytest.raises(UserError, match="1 to 12 levels, not 0"):
        make(scene, 0, ())
