"""Laws of `slim`: the promise is kept from views that chose nothing, nothing is added, groups stay what they were."""

from __future__ import annotations

import io
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from three_balls import BALLS, RING, SIZE, balls

from scenewright.gaussians import files
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import CheckFailedError, UserError
from scenewright.gaussians.language.field.group_index import index_groups
from scenewright.gaussians.language.field.language_field import LanguageField
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.slim import Settings, Slimmed, slim
from scenewright.gaussians.slim.loss import Truth
from scenewright.gaussians.slim.reductions import KEPT_OF_GROUP
from scenewright.gaussians.slim.views import choose_views


@pytest.fixture(scope="module")
def scene() -> Scene:
    return balls()


@pytest.fixture(scope="module")
def slimmed(scene: Scene) -> Slimmed:
    return slim(scene, ".sog", Settings(32.0, SIZE), RING)


def written(scene: Scene, suffix: str) -> bytes:
    file = io.BytesIO()
    files.writer(Path(f"a{suffix}"))(scene, file)
    return file.getvalue()


def read(data: bytes, folder: Path, suffix: str) -> Scene:
    path = folder / f"a{suffix}"
    path.write_bytes(data)
    return files.load(path)


def test_at_infinite_psnr_the_scene_is_the_same(scene: Scene) -> None:
    done = slim(scene, ".ply", Settings(math.inf))
    assert done.scene.cloud.digest() == scene.cloud.digest()
    assert done.data == written(scene, ".ply")


@pytest.mark.parametrize("suffix", [".sog", ".spz", ".compressed.ply", ".splat"])
def test_a_format_that_loses_something_cannot_keep_every_bit(scene: Scene, suffix: str) -> None:
    with pytest.raises(CheckFailedError, match=r"only \.ply keeps every bit"):
        slim(scene, suffix, Settings(math.inf))


def test_a_format_that_is_too_coarse_says_what_it_keeps(scene: Scene) -> None:
    with pytest.raises(CheckFailedError, match=r"\.splat alone keeps \d+\.\d\d dB .* 90 were asked for"):
        slim(scene, ".splat", Settings(90.0, SIZE), RING)


def test_the_promise_is_kept_from_views_that_did_not_choose(scene: Scene, slimmed: Slimmed, tmp_path: Path) -> None:
    views = choose_views(scene, RING, SIZE)
    poses = {v.camera.world_to_camera.tobytes() for v in views.ranking}
    assert {v.camera.world_to_camera.tobytes() for v in views.choice} <= poses
    assert not poses & {v.camera.world_to_camera.tobytes() for v in views.held_out}
    loss = Truth(scene.cloud, views.held_out).loss(read(slimmed.data, tmp_path, ".sog").cloud)
    assert loss == slimmed.held_out
    assert loss.psnr >= 32.0


def test_a_file_gets_smaller_than_its_format_alone_makes_it(scene: Scene, slimmed: Slimmed) -> None:
    assert len(slimmed.data) < 0.8 * len(written(scene, ".sog"))


@pytest.mark.parametrize("suffix", [".spz", ".ply", ".compressed.ply"])
@pytest.mark.slow
def test_stronger_promises_take_more_bytes_and_no_count_is_raised(suffix: str) -> None:
    scene = balls(600, degree=1)
    done = [slim(scene, suffix, Settings(psnr, SIZE), RING) for psnr in (24.0, 36.0)]
    assert len(done[0].data) < len(done[1].data) <= len(written(scene, suffix))
    for psnr, one in zip((24.0, 36.0), done, strict=True):
        assert len(one.scene.cloud) <= len(scene.cloud)
        assert one.held_out is not None and one.held_out.psnr >= psnr


def test_equal_input_gives_equal_bytes(scene: Scene, slimmed: Slimmed) -> None:
    assert slim(balls(), ".sog", Settings(32.0, SIZE), RING).data == slimmed.data


def test_groups_after_are_the_image_of_groups_before(scene: Scene, slimmed: Slimmed, tmp_path: Path) -> None:
    kept = slimmed.scene.cloud.ids.numpy()
    assert len(np.unique(kept)) == len(kept)
    assert np.isin(kept, scene.cloud.ids.numpy()).all()
    before, after = index_groups(scene.cloud), index_groups(slimmed.scene.cloud)
    for group in range(-1, BALLS):
        image = np.intersect1d(before.ids_of([group]).numpy(), kept)
        assert (after.ids_of([group]).numpy() == image).all()
    rows = read(slimmed.data, tmp_path, ".sog").cloud  # a row of the file is the Gaussian that the map names
    off = (rows.means - scene.cloud.means[torch.from_numpy(kept)]).norm(dim=1)
    assert float(off.quantile(0.99)) < 0.05


def test_the_field_stays_and_its_counts_are_true(scene: Scene, slimmed: Slimmed) -> None:
    old, new = scene.language, slimmed.scene.language
    assert old is not None and new is not None
    assert (new.embeddings == old.embeddings).all() and new.encoder == old.encoder
    for a, b in zip(old.groups, new.groups, strict=True):
        assert replace(b, count=a.count) == a
        assert b.count == int((slimmed.scene.cloud.group == b.id).sum()) >= min(KEPT_OF_GROUP, a.count)
    assert slimmed.same_thing is not None and slimmed.same_thing > 0.9


def test_a_hidden_thing_stays_although_no_view_shows_it() -> None:
    scene = balls(1200)
    inside = scene.cloud.means - torch.tensor([0.0, 0.9, 0.5])
    hidden = inside.norm(dim=1) < 0.12
    assert scene.language is not None and int(hidden.sum()) >= KEPT_OF_GROUP
    group = torch.where(hidden, BALLS, scene.cloud.group).to(torch.int32)
    one = replace(scene.language.groups[1], id=BALLS, label="kernel", count=int(hidden.sum()))
    field = LanguageField((*scene.language.groups, one), np.eye(BALLS + 1, 4, dtype=np.float32), "test:1")
    done = slim(
        scene.replace(cloud=scene.cloud.replace(group=group), language=field), ".ply", Settings(25.0, SIZE), RING
    )
    assert done.scene.language is not None
    assert done.scene.language.groups[BALLS].count >= KEPT_OF_GROUP


def test_a_promise_must_be_a_positive_number() -> None:
    for wrong in (0.0, -3.0, math.nan):
        with pytest.raises(UserError, match="positive number of decibels"):
            Settings(wrong)


def test_an_empty_scene_is_refused() -> None:
    with pytest.raises(UserError, match="nothing to make smaller"):
        slim(Scene(GaussianCloud.empty()), ".ply", Settings())


@pytest.mark.slow
def test_without_cameras_views_are_computed(tmp_path: Path) -> None:
    scene = balls(400)
    done = slim(scene, ".compressed.ply", Settings(28.0, 32))
    assert done.cameras == "computed around and inside the scene"
    assert done.held_out is not None and done.held_out.psnr >= 28.0
    loss = Truth(scene.cloud, choose_views(scene, (), 32).held_out).loss(
        read(done.data, tmp_path, ".compressed.ply").cloud
    )
    assert loss == done.held_out


def test_without_a_field_too_the_map_of_ids_names_the_rows(tmp_path: Path) -> None:
    scene = balls(400).replace(language=None)
    done = slim(scene, ".sog", Settings(28.0, SIZE), RING)
    rows = read(done.data, tmp_path, ".sog").cloud
    off = (rows.means - scene.cloud.means[done.scene.cloud.ids]).norm(dim=1)
    assert float(off.quantile(0.99)) < 0.05
    assert done.same_thing is None
