"""What the encoder is trained on: variants of assets, objects by others, and augmented pictures."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from scenewright.gaussians import assets
from scenewright.gaussians.world import kinds
from scenewright.training import renders, restyle, sets, strangers
from scenewright.training.augment import augment, plain


def _crops(count: int) -> torch.Tensor:
    """Discs of random colours, premultiplied."""
    rng = np.random.default_rng(0)
    at = np.stack(np.meshgrid(*[np.linspace(-1, 1, 80)] * 2), axis=-1)
    alpha = (np.linalg.norm(at, axis=-1) < 0.7).astype(np.float32)[None, ..., None] * np.ones((count, 1, 1, 1))
    rgb = rng.random((count, 1, 1, 3)) * alpha
    return torch.from_numpy((np.concatenate([rgb, alpha], axis=-1) * 255).astype(np.uint8))


def test_augmentation_depends_on_the_seed_alone() -> None:
    crops = _crops(16)
    first = augment(crops, 5)
    assert first.shape == (16, 3, 64, 64) and first.min() >= 0 and first.max() <= 1
    assert torch.equal(first, augment(crops, 5))
    assert not torch.equal(first, augment(crops, 6))


def test_augmentation_keeps_the_object_in_the_picture() -> None:
    crops = _crops(200)
    seen = augment(crops, 1)
    expected = plain(crops)
    inside, outside = seen[:, :, 28:36, 28:36].mean(dim=(1, 2, 3)), seen[:, :, :3, :3].mean(dim=(1, 2, 3))
    apart = (inside - outside).abs()  # hue and gain change the colours; the background is mostly grey
    wanted = (expected[:, :, 28:36, 28:36].mean(dim=(1, 2, 3)) - 0.5).abs()
    assert np.corrcoef(apart.numpy(), wanted.numpy())[0, 1] > 0.4


def test_a_variant_keeps_the_order_of_the_gaussians() -> None:
    asset = assets.make("chair", 3, detail=0.4)
    for seed in range(8):
        cloud = restyle.restyled(restyle.of_asset(asset), np.random.default_rng(seed))
        assert len(cloud) == len(asset.cloud)
        assert torch.isfinite(cloud.means).all() and torch.isfinite(cloud.sh).all()
        # The form is changed by some 16 % along each axis: points stay where they were, relative to the object.
        old, new = (c.means[:, 2] / c.means[:, 2].max() for c in (asset.cloud, cloud))
        assert np.corrcoef(old.numpy(), new.numpy())[0, 1] > 0.99


def test_the_look_of_fitted_gaussians_is_that_of_the_same_thing() -> None:
    asset = assets.make("armchair", 1, detail=0.4)
    worn = restyle.as_fitted(asset.cloud, np.random.default_rng(2))
    assert 0.3 * len(asset.cloud) < len(worn) <= len(asset.cloud) + 30
    middle = worn.means.median(dim=0).values - asset.cloud.means.median(dim=0).values
    assert middle.norm() < 0.1


def test_every_label_is_a_name_of_the_vocabulary() -> None:
    vocabulary, table = sets.vocabulary(objects=True), strangers.table()
    assert set(table.kinds) <= set(vocabulary.names)
    assert set(table.also) <= set(table.kinds) - {k.name for k in kinds.table().kinds.values() if k.shown and k.asset}
    names = [n for said in table.kinds.values() for n in said]
    assert len(names) == len(set(names))
    assert not set(table.calibrate) & set(table.measure)
    assert set(sets.vocabulary(objects=False).names) == set(renders.shown_kinds())


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.creation.box((1.0, 2.0, 0.5))  # 2 high, as y is up
    mesh.export(tmp_path / "a.glb")
    entry = {"file": "a.glb", "name": "crate", "pack": "some pack", "artist": "x", "licence": "CC0", "size_m": 0.6}
    other = entry | {"name": "zyzzyva", "pack": strangers.table().measure[0]}
    (tmp_path / "index.json").write_text(json.dumps([entry, other]))
    return tmp_path


def test_objects_by_others_stand_upright_in_metres(folder: Path) -> None:
    crate, unknown = strangers.listed(folder)
    assert (crate.label, strangers.use_of(crate)) == ("box", "train")
    assert (unknown.label, strangers.use_of(unknown)) == (strangers.UNNAMED, "measure")
    assert strangers.listed(folder, "train") == [crate]
    cloud = strangers.plain(crate)
    low, high = cloud.means.amin(dim=0), cloud.means.amax(dim=0)
    assert torch.allclose(high - low, torch.tensor([0.3, 0.15, 0.6]), atol=0.01)  # samples miss the corners by a little
    assert low[2].abs() < 1e-3


def test_things_of_others_are_a_function_of_the_seed(folder: Path) -> None:
    found = strangers.listed(folder, "train")
    first, second = (list(strangers.things(found, 3, 4)) for _ in range(2))
    assert [t.cloud.digest() for t in first] == [t.cloud.digest() for t in second]
    assert {t.label for t in first if t.state == renders.WHOLE} == {"box"}
